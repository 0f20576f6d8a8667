//! Trullo's own strokes; the format is described at [`super::FileFormat::Strokes`].

use super::error::{ReadError, ReadProblem, json};
use super::{MAX_SAMPLES, MAX_STROKES};
use crate::stroke::{PenSample, Stroke};
use serde::de::value::MapAccessDeserializer;
use serde::de::{self, Deserializer, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Serialize};
use std::fmt;

/// The version of the format that is read and written.
pub const STROKES_VERSION: u64 = 1;

const FORMAT: &str = "trullo-strokes";

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct File<'a> {
    format: &'a str,
    version: u64,
    #[serde(deserialize_with = "bounded_strokes")]
    strokes: Vec<FileStroke>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct FileStroke {
    #[serde(deserialize_with = "bounded_samples")]
    samples: Vec<FileSample>,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    eraser: bool,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct SampleFields {
    x: f32,
    y: f32,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    time: Option<f32>,
    #[serde(default = "full")]
    pressure: f32,
    #[serde(default)]
    tilt: [f32; 2],
}

fn full() -> f32 {
    1.0
}

struct FileSample(PenSample);

/// The strokes in the text. Errors: as [`super::read`].
pub(super) fn strokes(text: &str) -> Result<Vec<Stroke>, ReadError> {
    #[derive(Deserialize)]
    struct Head {
        format: Option<serde_json::Value>,
        version: Option<u64>,
    }
    // What the file says of itself comes first: a newer one may have fields that we do not know.
    if text.trim_start().starts_with('[') {
        // serde would take a list for the object whose fields it holds in order.
        return Err(ReadProblem::OtherFormat("missing".into()).into());
    }
    let head: Head = serde_json::from_str(text).map_err(|error| json(&error, 0))?;
    match head.format {
        Some(format) if format == FORMAT => {}
        Some(format) => return Err(ReadProblem::OtherFormat(format.to_string()).into()),
        None => return Err(ReadProblem::OtherFormat("missing".into()).into()),
    }
    if let Some(version) = head.version.filter(|version| *version != STROKES_VERSION) {
        return Err(ReadProblem::OtherVersion(version).into());
    }
    let file: File = serde_json::from_str(text).map_err(|error| json(&error, 0))?;
    let stroke = |stroke: FileStroke| Stroke {
        samples: stroke.samples.into_iter().map(|sample| sample.0).collect(),
        eraser: stroke.eraser,
    };
    Ok(file.strokes.into_iter().map(stroke).collect())
}

/// The strokes as text in Trullo's own format, which [`super::read`] gives back.
///
/// Samples whose place is not finite are left out: the format has no word for them.
pub fn write_strokes(strokes: &[Stroke]) -> String {
    let usable = |sample: &&PenSample| sample.place().is_finite();
    let strokes = strokes
        .iter()
        .map(|stroke| FileStroke {
            samples: stroke.samples.iter().filter(usable).map(|sample| FileSample(*sample)).collect(),
            eraser: stroke.eraser,
        })
        .collect();
    let file = File { format: FORMAT, version: STROKES_VERSION, strokes };
    serde_json::to_string(&file).expect("plain numbers and lists can be written")
}

fn bounded_strokes<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<FileStroke>, D::Error> {
    from.deserialize_seq(Bounded { most: MAX_STROKES, what: "strokes", of: std::marker::PhantomData })
}

fn bounded_samples<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<FileSample>, D::Error> {
    from.deserialize_seq(Bounded { most: MAX_SAMPLES, what: "samples", of: std::marker::PhantomData })
}

/// A list that is refused as soon as it is too long.
struct Bounded<T> {
    most: usize,
    what: &'static str,
    of: std::marker::PhantomData<T>,
}

impl<'de, T: Deserialize<'de>> Visitor<'de> for Bounded<T> {
    type Value = Vec<T>;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "a list of {}", self.what)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Vec<T>, A::Error> {
        let mut items = Vec::new();
        while let Some(item) = list.next_element()? {
            if items.len() == self.most {
                return Err(de::Error::custom(format!("more than {} {}", self.most, self.what)));
            }
            items.push(item);
        }
        Ok(items)
    }
}

impl<'de> Deserialize<'de> for FileSample {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(SampleVisitor)
    }
}

struct SampleVisitor;

impl<'de> Visitor<'de> for SampleVisitor {
    type Value = FileSample;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a sample: {\"x\": …, \"y\": …} or [x, y], [x, y, time] or [x, y, time, pressure]")
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<FileSample, A::Error> {
        let SampleFields { x, y, time, pressure, tilt } =
            SampleFields::deserialize(MapAccessDeserializer::new(map))?;
        Ok(FileSample(PenSample { x, y, time, pressure, tilt }))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<FileSample, A::Error> {
        let mut count = 0;
        let mut numbers = [0.0f32; 4];
        while let Some(number) = list.next_element()? {
            if count == numbers.len() {
                return Err(de::Error::invalid_length(count + 1, &self));
            }
            numbers[count] = number;
            count += 1;
        }
        if count < 2 {
            return Err(de::Error::invalid_length(count, &self));
        }
        let [x, y, time, pressure] = numbers;
        let time = (count > 2).then_some(time);
        let pressure = if count > 3 { pressure } else { full() };
        Ok(FileSample(PenSample { x, y, time, pressure, tilt: [0.0; 2] }))
    }
}

impl Serialize for FileSample {
    fn serialize<S: serde::Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let PenSample { x, y, time, pressure, tilt } = self.0;
        let time = time.filter(|time| time.is_finite());
        let known = |number: f32, otherwise: f32| if number.is_finite() { number } else { otherwise };
        let (pressure, tilt) = (known(pressure, full()), tilt.map(|degrees| known(degrees, 0.0)));
        SampleFields { x, y, time, pressure, tilt }.serialize(to)
    }
}
