//! The zip package around a 3MF model: finding parts, and unpacking no more than is reasonable.

use std::collections::BTreeMap;
use std::io::{self, BufReader, Read, Seek, SeekFrom};

use quick_xml::events::Event;
use zip::ZipArchive;
use zip::result::ZipError;

use super::super::error::quoted;
use super::super::{Place, ReadError, ReadLimits};
use super::xml::XmlPart;
use super::{MODEL_RELATIONSHIP, PRESERVE_RELATIONSHIP, part_key};

/// A package may unpack to this many times its own size …
const MAX_RATIO: u64 = 100;
/// … or to this many bytes, whichever is more.
const ALWAYS_UNPACKED: u64 = 16 << 20;
/// Most parts; the index of a zip file costs memory for each.
const MAX_ENTRIES: u64 = 1 << 16;
/// The end of a zip file where its index is announced, with the longest comment.
const TAIL: u64 = (1 << 16) + 128;

pub(super) struct Package<R> {
    archive: ZipArchive<BufReader<R>>,
    /// Part names without case and leading slash, to their place in the archive.
    names: BTreeMap<String, usize>,
    /// Bytes that may still be unpacked.
    budget: u64,
}

/// What the package says about its parts.
#[derive(Default)]
pub(super) struct Roots {
    pub(super) model: Option<String>,
    pub(super) preserved: Vec<String>,
}

impl<R: Read + Seek> Package<R> {
    pub(super) fn open(mut reader: R, length: u64, limits: &ReadLimits) -> Result<Self, ReadError> {
        check_index(&mut reader, length)?;
        let archive =
            ZipArchive::new(BufReader::new(reader)).map_err(|error| zip_error(error, "the package"))?;
        let mut names = BTreeMap::new();
        for at in 0..archive.len() {
            if let Some(Ok(name)) = archive.name_for_index(at) {
                names.entry(part_key(&name)).or_insert(at);
            }
        }
        let budget = limits.max_bytes.min(length.saturating_mul(MAX_RATIO).max(ALWAYS_UNPACKED));
        Ok(Self { archive, names, budget })
    }

    /// Opens a part for reading, or `None` if there is no such part.
    pub(super) fn part(&mut self, name: &str) -> Result<Option<PartReader<'_>>, ReadError> {
        let Some(&at) = self.names.get(&part_key(name)) else {
            return Ok(None);
        };
        let file = self.archive.by_index(at).map_err(|error| zip_error(error, name))?;
        let (file, limit) = (Box::new(file), self.budget);
        Ok(Some(PartReader { file, left: &mut self.budget, limit }))
    }

    /// A whole part, or `None` if there is no such part.
    pub(super) fn bytes(&mut self, name: &str) -> Result<Option<Vec<u8>>, ReadError> {
        let Some(mut part) = self.part(name)? else {
            return Ok(None);
        };
        let mut bytes = Vec::new();
        let read = part.read_to_end(&mut bytes);
        read.map_err(|error| part_error(error, name, bytes.len() as u64))?;
        Ok(Some(bytes))
    }

    /// Reads the package's own relationships. Without any, the usual names are tried.
    pub(super) fn relationships(&mut self) -> Result<Roots, ReadError> {
        const NAME: &str = "_rels/.rels";
        let mut roots = Roots::default();
        let Some(part) = self.part(NAME)? else {
            return Ok(roots);
        };
        let mut xml = XmlPart::new(part, NAME);
        loop {
            match xml.next()?.0 {
                Event::Start(element) | Event::Empty(element)
                    if element.local_name().as_ref() == "Relationship" =>
                {
                    let (mut kind, mut target) = (None, None);
                    for attribute in element.attributes().with_checks(false).flatten() {
                        let value = || super::xml::value_of(&attribute);
                        match attribute.key.as_ref() {
                            "Type" => kind = value(),
                            "Target" => target = value(),
                            _ => {}
                        }
                    }
                    match (kind.as_deref(), target) {
                        (Some(MODEL_RELATIONSHIP), Some(target)) => {
                            roots.model.get_or_insert(target);
                        }
                        (Some(PRESERVE_RELATIONSHIP), Some(target)) => roots.preserved.push(target),
                        _ => {}
                    }
                }
                Event::Eof => return Ok(roots),
                _ => {}
            }
        }
    }
}

/// Unpacks a part; fails with [`io::ErrorKind::FileTooLarge`] once the package's budget is spent.
pub(super) struct PartReader<'a> {
    file: Box<dyn Read + 'a>,
    left: &'a mut u64,
    limit: u64,
}

impl Read for PartReader<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let read = self.file.read(buffer)?;
        match self.left.checked_sub(read as u64) {
            Some(left) => *self.left = left,
            None => return Err(io::Error::new(io::ErrorKind::FileTooLarge, self.limit.to_string())),
        }
        Ok(read)
    }
}

/// Tells an error that came up while unpacking a part.
pub(super) fn part_error(error: io::Error, name: &str, byte: u64) -> ReadError {
    let place = Place::Part { name: name.to_owned(), byte };
    match error.kind() {
        io::ErrorKind::FileTooLarge => {
            let limit = error.to_string().parse().unwrap_or(ALWAYS_UNPACKED);
            ReadError::TooLarge {
                place,
                what: "bytes or more in the unpacked package",
                found: limit + 1,
                limit,
            }
        }
        io::ErrorKind::InvalidData | io::ErrorKind::InvalidInput | io::ErrorKind::UnexpectedEof => {
            let (found, expected) = (quoted(error.to_string().as_bytes()), "intact packed data".to_owned());
            ReadError::Malformed { place, found, expected }
        }
        _ => ReadError::Io(error),
    }
}

fn zip_error(error: ZipError, name: &str) -> ReadError {
    let place = Place::Part { name: name.to_owned(), byte: 0 };
    match error {
        ZipError::Io(error) => part_error(error, name, 0),
        ZipError::UnsupportedArchive(_)
        | ZipError::CompressionMethodNotSupported(_)
        | ZipError::InvalidPassword => {
            let what = format!("this kind of zip file ({error})");
            ReadError::Unsupported {
                place,
                what,
                instead: "3MF parts are stored or deflated, and not encrypted",
            }
        }
        error => {
            let (found, expected) = (error.to_string(), "a zip package".to_owned());
            ReadError::Malformed { place, found, expected }
        }
    }
}

/// Checks that the file ends in a zip index of reasonable size before memory is set aside for it.
fn check_index(reader: &mut (impl Read + Seek), length: u64) -> Result<(), ReadError> {
    let start = length.saturating_sub(TAIL);
    reader.seek(SeekFrom::Start(start))?;
    let mut tail = Vec::new();
    reader.take(TAIL).read_to_end(&mut tail)?;
    let find = |mark: &'static [u8]| {
        tail.windows(4).enumerate().filter_map(move |(at, w)| (w == mark).then_some(at))
    };
    let broken = |found: &str, expected: &str| ReadError::Malformed {
        place: Place::File,
        found: found.to_owned(),
        expected: expected.to_owned(),
    };
    if !tail.starts_with(b"PK") && start == 0 {
        return Err(broken("no zip package", "a 3MF file, which is a zip package"));
    }
    if find(b"PK\x05\x06").next().is_none() {
        return Err(broken(
            "a zip package without its index at the end",
            "a whole file; this one may be cut off",
        ));
    }
    // Only the 64-bit index can announce more entries than fit into memory; a real one is near the end.
    for at in find(b"PK\x06\x06") {
        let count =
            tail.get(at + 32..at + 40).map(|b| u64::from_le_bytes(b.try_into().expect("eight bytes")));
        if let Some(found) = count.filter(|&count| count > MAX_ENTRIES) {
            let (place, what) = (Place::Byte(start + at as u64), "parts in the package");
            return Err(ReadError::TooLarge { place, what, found, limit: MAX_ENTRIES });
        }
    }
    if find(b"PK\x06\x07").next().is_some() && find(b"PK\x06\x06").next().is_none() {
        return Err(broken("a zip index away from the end of the file", "an index at the end"));
    }
    reader.rewind()?;
    Ok(())
}
