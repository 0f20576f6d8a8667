//! `trullo support-free`.

use super::values::{length, point};
use super::{Common, ResolutionArgs};
use clap::{Args, ValueEnum};
use glam::Vec3;
use std::path::PathBuf;

/// `trullo support-free`.
#[derive(Debug, Args)]
pub struct SupportFreeArgs {
    /// The scene or mesh.
    pub input: PathBuf,
    /// The scene to write, a .trullo file, or a mesh: .stl, .obj, .ply or .3mf.
    #[arg(short, long, value_name = "OUT")]
    pub output: PathBuf,
    /// What happens where supports would be needed.
    #[arg(long, value_name = "OPERATOR", value_enum, default_value_t)]
    pub operator: SupportOperator,
    /// Height of a layer, mm: 0.02 to 2.
    #[arg(long, value_name = "MM", default_value_t = 0.25)]
    pub layer_height: f32,
    /// The largest overhang that prints, degrees from the vertical: 20 to 70.
    #[arg(long, value_name = "DEGREES", default_value_t = 45.0)]
    pub max_overhang: f32,
    /// Scale a mesh to this height, mm.
    #[arg(long, value_name = "MM", value_parser = length)]
    pub height: Option<f64>,
    /// Lift or lower the shape so that its lowest point lies on the bed.
    #[arg(long)]
    pub drop: bool,
    /// Also say why matter was taken away or added at this place of the result, mm; can be given several times.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = point)]
    pub why: Vec<Vec3>,
    #[command(flatten)]
    pub resolution: ResolutionArgs,
    #[command(flatten)]
    pub common: Common,
}

/// What happens where supports would be needed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum SupportOperator {
    /// What the layer below cannot carry is taken away.
    #[default]
    Trim,
    /// Matter grows below it.
    Grow,
}

impl SupportOperator {
    /// As in `--operator`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Trim => "trim",
            Self::Grow => "grow",
        }
    }
}

impl From<SupportOperator> for blobtree::SupportMode {
    fn from(operator: SupportOperator) -> Self {
        match operator {
            SupportOperator::Trim => Self::Trim,
            SupportOperator::Grow => Self::Grow,
        }
    }
}
