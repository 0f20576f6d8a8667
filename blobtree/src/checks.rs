//! Legal ranges of parameters, in one place.

use glam::{Vec2, Vec3};
use std::fmt::Debug;

/// Shortest length that a shape may have, mm.
pub const SHORTEST: f32 = 1e-3;
/// Longest length that a shape may have, mm.
pub const LONGEST: f32 = 1e5;

/// A parameter outside its legal range.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{field}` is {value}, not {expected}")]
pub struct ParameterError {
    /// The parameter's name in scene files.
    pub field: String,
    /// Its value as given.
    pub value: String,
    /// What would be right.
    pub expected: String,
}

impl ParameterError {
    pub(crate) fn new(field: &str, value: impl Debug, expected: &str) -> Self {
        Self { field: field.into(), value: format!("{value:?}").replace('"', ""), expected: expected.into() }
    }
}

/// Parameters that know their legal ranges.
pub(crate) trait Checked {
    fn check(&self) -> Result<(), ParameterError>;
}

/// A length of a shape: 0.001 to 100,000 mm.
pub(crate) fn length(field: &str, value: f32) -> Result<(), ParameterError> {
    number(field, value, SHORTEST, LONGEST, "mm")
}

/// A number in a closed range.
pub(crate) fn number(field: &str, value: f32, lo: f32, hi: f32, of: &str) -> Result<(), ParameterError> {
    if (lo..=hi).contains(&value) {
        Ok(())
    } else {
        Err(ParameterError::new(field, value, format!("{lo} to {hi} {of}").trim_end()))
    }
}

/// A place in space: each coordinate within 100,000 mm of the origin.
pub(crate) fn place(field: &str, value: Vec3) -> Result<(), ParameterError> {
    if value.is_finite() && value.abs().max_element() <= LONGEST {
        Ok(())
    } else {
        Err(ParameterError::new(field, value, "three coordinates of -100000 to 100000 mm"))
    }
}

/// A place in a drawing: each coordinate within 100,000 mm of the origin.
pub(crate) fn place_in_plane(field: &str, value: Vec2) -> Result<(), ParameterError> {
    if value.is_finite() && value.abs().max_element() <= LONGEST {
        Ok(())
    } else {
        Err(ParameterError::new(field, value, "two coordinates of -100000 to 100000 mm"))
    }
}

/// A direction of any length but 0.
pub(crate) fn unit(field: &str, value: Vec3) -> Result<(), ParameterError> {
    if value.is_finite() && value.abs().max_element() <= LONGEST && value.length() >= 1e-6 {
        Ok(())
    } else {
        Err(ParameterError::new(field, value, "a direction: three numbers, not all 0"))
    }
}

/// A list with a legal number of items.
pub(crate) fn one_of_length(field: &str, len: usize, lo: usize, hi: usize) -> Result<(), ParameterError> {
    if (lo..=hi).contains(&len) {
        Ok(())
    } else {
        Err(ParameterError::new(field, format!("a list of {len}"), &format!("a list of {lo} to {hi}")))
    }
}
