//! The values after a PLY header, whichever way they are encoded.

use std::io::BufRead;

use super::super::error::quoted;
use super::super::text::{Lines, Words};
use super::super::{Place, ReadError};
use super::header::{Element, Encoding, Kind, Scalar};

/// Reads values one after the other.
pub(super) enum Data<R> {
    Text { words: Words<R>, left: u64 },
    Binary { reader: R, big_endian: bool, at: u64, length: u64 },
}

/// A number as its type holds it.
enum Value {
    Integer(i64),
    Real(f64),
}

impl<R: BufRead> Data<R> {
    pub(super) fn new(lines: Lines<R>, encoding: Encoding, length: u64) -> Self {
        let at = lines.bytes;
        match encoding {
            Encoding::Ascii => Self::Text { words: Words::new(lines), left: length.saturating_sub(at) },
            _ => {
                let big_endian = encoding == Encoding::BigEndian;
                Self::Binary { reader: lines.into_inner(), big_endian, at, length }
            }
        }
    }

    /// Where the reader is: the line of the last value, or the byte of the next.
    pub(super) fn place(&self) -> Place {
        match self {
            Self::Text { words, .. } => words.place(),
            Self::Binary { at, .. } => Place::Byte(*at),
        }
    }

    /// Refuses an element that cannot fit into what is left of the file, whatever its values are.
    pub(super) fn check_announced(&self, element: &Element) -> Result<(), ReadError> {
        let (encoding, left) = match self {
            // The last value needs no blank behind it.
            Self::Text { left, .. } => (Encoding::Ascii, left + 1),
            Self::Binary { at, length, .. } => (Encoding::LittleEndian, length - at),
        };
        let Element { name, count, .. } = element;
        if element.properties.is_empty() && *count > 0 {
            return Err(element.lacks("at least one property"));
        }
        let least = element.least_size(encoding).saturating_mul(*count);
        if least > left {
            let missing = format!("{count} of element {name} take at least {least} bytes, {left} are left");
            return Err(ReadError::Truncated { place: element.place.clone(), missing });
        }
        Ok(())
    }

    /// A coordinate, as it is; whether it is finite in 32 bits is for the caller to check in a binary file.
    pub(super) fn coordinate(&mut self, kind: Scalar, axis: char) -> Result<f32, ReadError> {
        if let Self::Text { words, .. } = self {
            return words.coordinate(axis);
        }
        Ok(match self.binary(kind)? {
            Value::Integer(value) => value as f32,
            Value::Real(value) => value as f32,
        })
    }

    /// A whole number and where it is.
    pub(super) fn integer(&mut self, kind: Scalar, expected: &str) -> Result<(i64, Place), ReadError> {
        let before = self.place();
        let (value, found, place) = match self {
            Self::Text { words, .. } => {
                let word = words.need(expected)?;
                let value = std::str::from_utf8(word).ok().and_then(|text| text.parse().ok());
                (value, if value.is_none() { quoted(word) } else { String::new() }, words.place())
            }
            Self::Binary { .. } => match self.binary(kind)? {
                Value::Integer(value) => (Some(value), String::new(), before),
                Value::Real(value) => (None, value.to_string(), before),
            },
        };
        match value {
            Some(value) => Ok((value, place)),
            None => Err(ReadError::Malformed { place, found, expected: expected.to_owned() }),
        }
    }

    /// The length of a list, not longer than what is left of the file allows, and where it is.
    pub(super) fn list_length(&mut self, count: Scalar, item: Scalar) -> Result<(u64, Place), ReadError> {
        let (announced, place) = self.integer(count, "the length of a list")?;
        let Ok(announced) = u64::try_from(announced) else {
            let (found, expected) = (announced.to_string(), "the length of a list, 0 or more".to_owned());
            return Err(ReadError::Malformed { place, found, expected });
        };
        let (least, left) = match self {
            Self::Text { left, .. } => (2, *left + 1),
            Self::Binary { at, length, .. } => (item.size(), *length - *at),
        };
        if announced.saturating_mul(least) > left {
            let missing = format!("a list announces {announced} values, {left} bytes are left");
            return Err(ReadError::Truncated { place, missing });
        }
        Ok((announced, place))
    }

    /// Steps over a property.
    pub(super) fn skip(&mut self, kind: Kind) -> Result<(), ReadError> {
        let (count, item) = match kind {
            Kind::Scalar(item) => (1, item),
            Kind::List { count, item } => (self.list_length(count, item)?.0, item),
        };
        match self {
            Self::Text { words, .. } => (0..count).try_for_each(|_| words.need("a value").map(|_| ())),
            Self::Binary { .. } => self.skip_bytes(count * item.size()),
        }
    }

    /// Steps over all of an element.
    pub(super) fn skip_element(&mut self, element: &Element) -> Result<(), ReadError> {
        let has_lists = element.properties.iter().any(|property| matches!(property.kind, Kind::List { .. }));
        if matches!(self, Self::Binary { .. }) && !has_lists {
            // That this does not overflow was seen when the announced count was checked.
            return self.skip_bytes(element.count * element.least_size(Encoding::LittleEndian));
        }
        for _ in 0..element.count {
            for property in &element.properties {
                self.skip(property.kind)?;
            }
        }
        Ok(())
    }

    fn skip_bytes(&mut self, mut count: u64) -> Result<(), ReadError> {
        if let Self::Binary { reader, at, .. } = self {
            while count > 0 {
                let ready = reader.fill_buf()?.len() as u64;
                let step = ready.min(count);
                if step == 0 {
                    return Err(self.cut_off());
                }
                reader.consume(step as usize);
                *at += step;
                count -= step;
            }
        }
        Ok(())
    }

    /// A value of a binary file.
    fn binary(&mut self, kind: Scalar) -> Result<Value, ReadError> {
        let mut bytes = [0; 8];
        let size = kind.size() as usize;
        if let Self::Binary { reader, big_endian, at, length } = self {
            if at.saturating_add(size as u64) > *length {
                return Err(self.cut_off());
            }
            match reader.fill_buf()?.get(..size) {
                Some(ready) => {
                    bytes[..size].copy_from_slice(ready);
                    reader.consume(size);
                }
                None => reader.read_exact(&mut bytes[..size])?,
            }
            if *big_endian {
                bytes[..size].reverse();
            }
            *at += size as u64;
        }
        let word = u64::from_le_bytes(bytes);
        // Each cast keeps the low bytes that were read, with their sign.
        Ok(match kind {
            Scalar::I8 => Value::Integer((word as i8).into()),
            Scalar::U8 => Value::Integer((word as u8).into()),
            Scalar::I16 => Value::Integer((word as i16).into()),
            Scalar::U16 => Value::Integer((word as u16).into()),
            Scalar::I32 => Value::Integer((word as i32).into()),
            Scalar::U32 => Value::Integer((word as u32).into()),
            Scalar::F32 => Value::Real(f32::from_bits(word as u32).into()),
            Scalar::F64 => Value::Real(f64::from_bits(word)),
        })
    }

    fn cut_off(&self) -> ReadError {
        ReadError::Truncated { place: self.place(), missing: "the last values are cut off".to_owned() }
    }
}
