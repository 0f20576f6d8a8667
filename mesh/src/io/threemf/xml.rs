//! The XML of one part, event by event, with errors in our terms.

use std::io::BufReader;

use quick_xml::XmlVersion;
use quick_xml::events::Event;
use quick_xml::events::attributes::Attribute;
use quick_xml::reader::Reader;

use super::super::{Place, ReadError};
use super::package::{PartReader, part_error};

/// Deepest nesting of elements; core 3MF needs eight.
const MAX_DEPTH: usize = 256;

pub(super) struct XmlPart<'a> {
    reader: Reader<BufReader<PartReader<'a>>>,
    buffer: Vec<u8>,
    name: String,
    depth: usize,
    rooted: bool,
}

impl<'a> XmlPart<'a> {
    pub(super) fn new(part: PartReader<'a>, name: &str) -> Self {
        let reader = Reader::from_reader(BufReader::with_capacity(1 << 16, part));
        Self { reader, buffer: Vec::new(), name: name.to_owned(), depth: 0, rooted: false }
    }

    /// The next event, and the byte where it ends. Errors: XML that is not well-formed, too deep, with a document type, or cut off.
    pub(super) fn next(&mut self) -> Result<(Event<'_>, u64), ReadError> {
        self.buffer.clear();
        let place =
            |reader: &Reader<_>| Place::Part { name: self.name.clone(), byte: reader.error_position() };
        let event = match self.reader.read_event_into(&mut self.buffer) {
            Ok(event) => event,
            Err(quick_xml::Error::Io(error)) => {
                let error = std::io::Error::new(error.kind(), error.to_string());
                return Err(part_error(error, &self.name, self.reader.buffer_position()));
            }
            Err(error) => {
                let (found, expected) = (error.to_string(), "well-formed XML in UTF-8".to_owned());
                return Err(ReadError::Malformed { place: place(&self.reader), found, expected });
            }
        };
        match event {
            Event::Start(_) => (self.depth, self.rooted) = (self.depth + 1, true),
            Event::Empty(_) => self.rooted = true,
            Event::End(_) => self.depth = self.depth.saturating_sub(1),
            Event::DocType(_) => {
                let (found, expected) = ("a document type".to_owned(), "none; 3MF forbids it".to_owned());
                return Err(ReadError::Malformed { place: place(&self.reader), found, expected });
            }
            Event::Eof if self.depth > 0 || !self.rooted => {
                let missing = match self.rooted {
                    true => format!("{} elements are not closed", self.depth),
                    false => "there is no XML element".to_owned(),
                };
                return Err(ReadError::Truncated { place: place(&self.reader), missing });
            }
            _ => {}
        }
        if self.depth > MAX_DEPTH {
            let (found, limit) = (self.depth as u64, MAX_DEPTH as u64);
            let what = "XML elements inside each other";
            return Err(ReadError::TooLarge { place: place(&self.reader), what, found, limit });
        }
        Ok((event, self.reader.buffer_position()))
    }
}

/// An attribute's text with its entities resolved; `None` if one of them is unknown.
pub(super) fn value_of(attribute: &Attribute<'_>) -> Option<String> {
    attribute.normalized_value(XmlVersion::Explicit1_0).ok().map(|value| value.into_owned())
}
