//! What a check said, as text that travels with the part.

use super::{CheckSettings, PrintCheck};
use crate::slices::Bottom;
use crate::{RuleError, SupportRule};
use std::fmt::{self, Write};
use std::str::FromStr;

/// The first line of the text.
const HEADING: &str = "support-free 1";
/// Areas may differ by this much, mm², or by a thousandth, whichever is more: numbers in files are rounded.
const SAME: f64 = 0.01;
/// Most layers a certificate tells of: its text stays below a mebibyte, the most that is read back from a 3MF file.
const MOST_LAYERS: usize = 20_000;

/// A claim that a part prints without supports, with what every layer looked like.
///
/// As text: a heading, one line for the rule (`layer height 0.25 mm, overhang 45°, tolerance 0.01 mm, from the lowest
/// point`), and for every layer a line with its area and its unsupported area in mm².
#[derive(Clone, Debug, PartialEq)]
pub struct Certificate {
    /// Layer height and largest overhang.
    pub rule: SupportRule,
    /// Where the bed is.
    pub bottom: Bottom,
    /// What is added to the rule's reach, mm.
    pub tolerance_mm: f64,
    /// Area and unsupported area of each layer, mm².
    pub layers: Vec<[f64; 2]>,
}

/// Why a certificate does not hold.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Doubt {
    /// The part has another number of layers.
    LayerCount {
        /// In the certificate.
        claimed: usize,
        /// In the part.
        found: usize,
    },
    /// A layer is not the certified one.
    Area {
        /// The layer, counted from 0.
        layer: usize,
        /// In the certificate, mm².
        claimed: f64,
        /// In the part, mm².
        found: f64,
    },
    /// The part needs supports.
    NeedsSupports {
        /// Unsupported area, mm².
        unsupported: f64,
        /// Regions with nothing below them.
        islands: usize,
    },
}

impl fmt::Display for Doubt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::LayerCount { claimed, found } => {
                write!(f, "it speaks of {claimed} layers, the part has {found}")
            }
            Self::Area { layer, claimed, found } => {
                write!(f, "it says that layer {layer} has {claimed:.3} mm², but it has {found:.3} mm²")
            }
            Self::NeedsSupports { unsupported, islands } => {
                write!(
                    f,
                    "{unsupported:.2} mm² hang in the air and {islands} islands begin with nothing below"
                )
            }
        }
    }
}

/// Why a text is no certificate.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CertificateError {
    /// The text does not begin as certificates do, or has a version that is not known.
    #[error("a certificate begins with `{HEADING}`")]
    Heading,
    /// A line is not what it should be.
    #[error("line {line} of the certificate should be {expected}")]
    Line {
        /// Counted from 1.
        line: usize,
        /// What it should be.
        expected: &'static str,
    },
    /// The rule is out of range.
    #[error("the certificate's rule: {0}")]
    Rule(#[from] RuleError),
    /// More layers than a certificate can tell of.
    #[error("{0} layers are more than the {MOST_LAYERS} that a certificate can tell of")]
    TooLong(usize),
}

impl Certificate {
    /// What to certify of a part that passed its check; none for one that did not.
    ///
    /// Errors: more than 20,000 layers.
    pub fn of(check: &PrintCheck) -> Result<Option<Self>, CertificateError> {
        let count = check.layers.len();
        if count > MOST_LAYERS {
            return Err(CertificateError::TooLong(count));
        }
        let CheckSettings { rule, bottom, tolerance_mm, .. } = check.settings;
        let layers = check.layers.iter().map(|layer| [layer.area, layer.unsupported]).collect();
        Ok(check.is_printable().then_some(Self { rule, bottom, tolerance_mm, layers }))
    }

    /// How to check a part against this certificate.
    pub fn settings(&self) -> CheckSettings {
        CheckSettings {
            rule: self.rule,
            bottom: self.bottom,
            tolerance_mm: self.tolerance_mm,
            ..CheckSettings::default()
        }
    }

    /// Why it does not hold for a part that was checked with [`Self::settings`]; nothing if it holds.
    pub fn doubts(&self, check: &PrintCheck) -> Vec<Doubt> {
        let mut doubts = Vec::new();
        let (claimed, found) = (self.layers.len(), check.layers.len());
        if claimed != found {
            doubts.push(Doubt::LayerCount { claimed, found });
        }
        let mut layers = self.layers.iter().zip(&check.layers).enumerate();
        doubts.extend(layers.find_map(|(layer, (&[claimed, _], found))| {
            let found = found.area;
            ((claimed - found).abs() > SAME.max(1e-3 * found)).then_some(Doubt::Area {
                layer,
                claimed,
                found,
            })
        }));
        if !check.is_printable() {
            let (unsupported, islands) = (check.unsupported(), check.islands());
            doubts.push(Doubt::NeedsSupports { unsupported, islands });
        }
        doubts
    }
}

impl fmt::Display for Certificate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let bottom = match self.bottom {
            Bottom::LowestPoint => "lowest",
            Bottom::Bed => "bed",
        };
        let (height, degrees) = (self.rule.layer_height.mm(), self.rule.overhang.degrees());
        writeln!(f, "{HEADING}")?;
        writeln!(f, "layer_height_mm {height}")?;
        writeln!(f, "overhang_degrees {degrees}")?;
        writeln!(f, "tolerance_mm {}", self.tolerance_mm)?;
        writeln!(f, "bottom {bottom}")?;
        f.write_str("layers area_mm2 unsupported_mm2")?;
        let mut text = String::new();
        for [area, unsupported] in &self.layers {
            text.clear();
            write!(text, "\n{area:.4} {unsupported:.4}")?;
            f.write_str(&text)?;
        }
        Ok(())
    }
}

impl FromStr for Certificate {
    type Err = CertificateError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let mut lines = text.trim().lines().map(str::trim).zip(1..);
        if lines.next().is_none_or(|(heading, _)| heading != HEADING) {
            return Err(CertificateError::Heading);
        }
        let mut named = |line, name: &str, expected| {
            let value = lines.next().and_then(|(text, _)| text.strip_prefix(name)).map(str::trim);
            value.ok_or(CertificateError::Line { line, expected })
        };
        let height = number(named(2, "layer_height_mm ", HEIGHT)?, 2, HEIGHT)?;
        let degrees = number(named(3, "overhang_degrees ", OVERHANG)?, 3, OVERHANG)?;
        let tolerance_mm = number(named(4, "tolerance_mm ", TOLERANCE)?, 4, TOLERANCE)?;
        if !(0.0..=0.1).contains(&tolerance_mm) {
            return Err(CertificateError::Line { line: 4, expected: TOLERANCE });
        }
        let bottom = match named(5, "bottom ", BOTTOM)? {
            "lowest" => Bottom::LowestPoint,
            "bed" => Bottom::Bed,
            _ => return Err(CertificateError::Line { line: 5, expected: BOTTOM }),
        };
        named(6, "layers", "`layers` and what their columns are")?;
        let mut layers = Vec::new();
        for (text, line) in lines {
            if layers.len() == MOST_LAYERS {
                return Err(CertificateError::TooLong(MOST_LAYERS + 1));
            }
            let (area, unsupported) =
                text.split_once(' ').ok_or(CertificateError::Line { line, expected: LAYER })?;
            layers.push([number(area, line, LAYER)?, number(unsupported, line, LAYER)?]);
        }
        let rule = SupportRule::new(height as f32, degrees as f32)?;
        Ok(Self { rule, bottom, tolerance_mm, layers })
    }
}

const HEIGHT: &str = "`layer_height_mm` and a length";
const OVERHANG: &str = "`overhang_degrees` and an angle";
const TOLERANCE: &str = "`tolerance_mm` and a length from 0 to 0.1";
const BOTTOM: &str = "`bottom lowest` or `bottom bed`";
const LAYER: &str = "a layer's area and unsupported area";

/// A finite number.
fn number(text: &str, line: usize, expected: &'static str) -> Result<f64, CertificateError> {
    let number = text.parse().ok().filter(|number: &f64| number.is_finite());
    number.ok_or(CertificateError::Line { line, expected })
}
