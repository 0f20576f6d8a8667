//! Coordinates as text, both ways.

use std::io::{self, Write};

use glam::Vec3;

use super::error::quoted;
use super::{Place, ReadError};

pub(super) const AXES: [char; 3] = ['x', 'y', 'z'];

/// Reads one finite coordinate. NaN, infinities and numbers beyond a 32-bit float are refused with their text.
pub(super) fn coordinate(word: &[u8], axis: char, place: impl FnOnce() -> Place) -> Result<f32, ReadError> {
    match std::str::from_utf8(word).ok().and_then(|text| text.parse::<f32>().ok()) {
        Some(value) if value.is_finite() => Ok(value),
        Some(_) => {
            let value = String::from_utf8_lossy(&word[..word.len().min(32)]).into_owned();
            Err(ReadError::NotFinite { place: place(), axis, value })
        }
        None => Err(ReadError::Malformed {
            place: place(),
            found: quoted(word),
            expected: format!("the {axis} coordinate, a number like 12.5 or -3e-2"),
        }),
    }
}

/// Checks that a position from a binary file is finite.
pub(super) fn finite(position: Vec3, place: impl FnOnce() -> Place) -> Result<Vec3, ReadError> {
    match position.to_array().into_iter().position(|value| !value.is_finite()) {
        None => Ok(position),
        Some(bad) => {
            let value = position[bad].to_string();
            Err(ReadError::NotFinite { place: place(), axis: AXES[bad], value })
        }
    }
}

/// Writes the shortest text that reads back as the same number, without dozens of zeros for the very large and
/// very small. Every format here allows an exponent.
pub(super) fn write_number(out: &mut impl Write, value: f32) -> io::Result<()> {
    let size = value.abs();
    if size == 0.0 || (1e-4..1e9).contains(&size) { write!(out, "{value}") } else { write!(out, "{value:e}") }
}

/// Writes three numbers, a blank before each.
pub(super) fn write_point(out: &mut impl Write, point: Vec3) -> io::Result<()> {
    for value in point.to_array() {
        out.write_all(b" ")?;
        write_number(out, value)?;
    }
    Ok(())
}
