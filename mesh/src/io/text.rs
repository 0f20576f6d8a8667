//! Lines and words of text formats, with their line numbers and bounded length.

use std::io::{BufRead, Read};
use std::ops::Range;

use super::error::quoted;
use super::number::coordinate;
use super::{Place, ReadError};

/// Longest line that is read, bytes: room for a polygon of 100,000 corners.
const MAX_LINE: u64 = 1 << 20;

/// Reads lines without their ends; `\n` and `\r\n` end a line.
pub(super) struct Lines<R> {
    reader: R,
    line: Vec<u8>,
    /// Number of the current line, from 1.
    pub(super) number: u64,
    /// Bytes read so far.
    pub(super) bytes: u64,
}

impl<R: BufRead> Lines<R> {
    pub(super) fn new(reader: R) -> Self {
        Self { reader, line: Vec::new(), number: 0, bytes: 0 }
    }

    /// The next line, or `None` at the end.
    pub(super) fn next(&mut self) -> Result<Option<&[u8]>, ReadError> {
        self.line.clear();
        Ok(self.append()?.then_some(&self.line))
    }

    /// The next line, joined with those that follow while it ends in a backslash.
    pub(super) fn next_continued(&mut self) -> Result<Option<&[u8]>, ReadError> {
        self.line.clear();
        if !self.append()? {
            return Ok(None);
        }
        while self.line.last() == Some(&b'\\') {
            self.line.pop();
            self.line.push(b' ');
            if !self.append()? {
                break;
            }
        }
        Ok(Some(&self.line))
    }

    /// The current line.
    pub(super) fn line(&self) -> &[u8] {
        &self.line
    }

    pub(super) fn place(&self) -> Place {
        Place::Line(self.number)
    }

    /// What follows the lines read so far.
    pub(super) fn into_inner(self) -> R {
        self.reader
    }

    /// Appends a line to the current one; false at the end of the file.
    fn append(&mut self) -> Result<bool, ReadError> {
        let room = (MAX_LINE + 1).saturating_sub(self.line.len() as u64);
        let read = self.reader.by_ref().take(room).read_until(b'\n', &mut self.line)?;
        if read == 0 && room > 0 {
            return Ok(false);
        }
        self.number += 1;
        self.bytes += read as u64;
        if self.line.len() as u64 > MAX_LINE {
            let (what, found) = ("bytes in one line", self.line.len() as u64);
            return Err(ReadError::TooLarge { place: self.place(), what, found, limit: MAX_LINE });
        }
        if self.line.last() == Some(&b'\n') {
            self.line.pop();
            if self.line.last() == Some(&b'\r') {
                self.line.pop();
            }
        }
        if self.line.contains(&0) {
            let (found, expected) = ("a zero byte".to_owned(), "text".to_owned());
            return Err(ReadError::Malformed { place: self.place(), found, expected });
        }
        Ok(true)
    }
}

/// Splits a line at blanks.
pub(super) fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty())
}

/// Reads words wherever the lines break.
pub(super) struct Words<R> {
    lines: Lines<R>,
    at: usize,
}

impl<R: BufRead> Words<R> {
    /// Goes on after the lines that were read.
    pub(super) fn new(lines: Lines<R>) -> Self {
        let at = lines.line().len();
        Self { lines, at }
    }

    /// The next word, or `None` at the end of the file.
    pub(super) fn next(&mut self) -> Result<Option<&[u8]>, ReadError> {
        Ok(self.advance()?.map(|word| &self.lines.line()[word]))
    }

    /// The next word. Errors: [`ReadError::Truncated`] at the end of the file.
    pub(super) fn need(&mut self, expected: &str) -> Result<&[u8], ReadError> {
        let word = self.need_range(expected)?;
        Ok(&self.lines.line()[word])
    }

    /// The next word as a finite coordinate.
    pub(super) fn coordinate(&mut self, axis: char) -> Result<f32, ReadError> {
        let word = self.need_range("a coordinate")?;
        coordinate(&self.lines.line()[word], axis, || self.place())
    }

    /// Takes a keyword in any case.
    pub(super) fn keyword(&mut self, expected: &str) -> Result<(), ReadError> {
        let word = self.need(expected)?;
        if word.eq_ignore_ascii_case(expected.as_bytes()) {
            return Ok(());
        }
        let found = quoted(word);
        Err(ReadError::Malformed { place: self.place(), found, expected: expected.to_owned() })
    }

    /// Skips what is left of the line.
    pub(super) fn skip_line(&mut self) {
        self.at = self.lines.line().len();
    }

    pub(super) fn place(&self) -> Place {
        self.lines.place()
    }

    pub(super) fn line_number(&self) -> u64 {
        self.lines.number
    }

    fn need_range(&mut self, expected: &str) -> Result<Range<usize>, ReadError> {
        self.advance()?.ok_or_else(|| {
            let missing = format!("{expected} should follow");
            ReadError::Truncated { place: self.place(), missing }
        })
    }

    fn advance(&mut self) -> Result<Option<Range<usize>>, ReadError> {
        loop {
            let rest = &self.lines.line()[self.at..];
            if let Some(start) = rest.iter().position(|byte| !byte.is_ascii_whitespace()) {
                let length =
                    rest[start..].iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len() - start);
                let begin = self.at + start;
                self.at = begin + length;
                return Ok(Some(begin..begin + length));
            }
            if self.lines.next()?.is_none() {
                self.at = 0;
                return Ok(None);
            }
            self.at = 0;
        }
    }
}
