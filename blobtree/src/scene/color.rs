//! Colours as text: `#rrggbb`.

use crate::node::Color;
use std::fmt;
use std::str::FromStr;

/// A text that is not a colour.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is not a colour; one looks like #ff8800: red, green and blue as two hexadecimal digits each")]
pub struct ColorError(String);

impl fmt::Display for Color {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [r, g, b] = self.0;
        write!(f, "#{r:02x}{g:02x}{b:02x}")
    }
}

impl FromStr for Color {
    type Err = ColorError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let wrong = || ColorError(super::error::shortened(text));
        let digits = text.strip_prefix('#').ok_or_else(wrong)?;
        if digits.len() != 6 || !digits.bytes().all(|b| b.is_ascii_hexdigit()) {
            return Err(wrong());
        }
        let rgb = u32::from_str_radix(digits, 16).map_err(|_| wrong())?;
        let [_, r, g, b] = rgb.to_be_bytes();
        Ok(Self([r, g, b]))
    }
}
