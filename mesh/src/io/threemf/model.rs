//! One model part: its unit, objects, build items and metadata.

use std::collections::BTreeMap;

use glam::{DAffine3, DVec3, Vec3};
use quick_xml::escape::resolve_predefined_entity;
use quick_xml::events::{BytesRef, BytesStart, Event};

use super::super::builder::check;
use super::super::error::quoted;
use super::super::number::{AXES, coordinate};
use super::super::{Place, ReadError, ReadLimits};
use super::METADATA_NAMESPACE;
use super::package::PartReader;
use super::xml::{XmlPart, value_of};
use crate::Mesh;

/// Extensions a file may require: those that are read, and those that change only the looks.
const KNOWN_EXTENSIONS: [&str; 4] = [
    super::CORE,
    "http://schemas.microsoft.com/3dmanufacturing/production/2015/06",
    "http://schemas.microsoft.com/3dmanufacturing/material/2015/02",
    "http://schemas.microsoft.com/3dmanufacturing/trianglesets/2021/07",
];

/// Most metadata entries, and most bytes of one, that are kept.
const MAX_METADATA: usize = 10_000;
const MAX_METADATA_BYTES: usize = 1 << 20;

/// A unit of length.
#[derive(Clone, Copy, Debug)]
pub(super) struct Unit {
    pub(super) name: &'static str,
    pub(super) millimetres: f64,
}

const UNITS: [Unit; 6] = [
    Unit { name: "micron", millimetres: 0.001 },
    Unit { name: "millimeter", millimetres: 1.0 },
    Unit { name: "centimeter", millimetres: 10.0 },
    Unit { name: "inch", millimetres: 25.4 },
    Unit { name: "foot", millimetres: 304.8 },
    Unit { name: "meter", millimetres: 1000.0 },
];

/// A build item or component: which object goes where.
#[derive(Debug)]
pub(super) struct Reference {
    /// The model part the object is in, if it is another one.
    pub(super) path: Option<String>,
    /// The number of that part, once it is known.
    pub(super) part: usize,
    pub(super) object: u32,
    /// From the object to what refers to it, mm.
    pub(super) transform: DAffine3,
    /// Where it is in its part.
    pub(super) byte: u64,
}

#[derive(Debug, Default)]
pub(super) struct Object {
    /// False for supports and helpers.
    pub(super) is_model: bool,
    /// In mm.
    pub(super) mesh: Mesh,
    pub(super) components: Vec<Reference>,
}

#[derive(Debug)]
pub(super) struct Model {
    pub(super) name: String,
    pub(super) unit: Unit,
    /// Names 3MF defines or Trullo wrote, without prefix.
    pub(super) metadata: Vec<(String, String)>,
    pub(super) objects: BTreeMap<u32, Object>,
    pub(super) items: Vec<Reference>,
}

impl Model {
    pub(super) fn references_mut(&mut self) -> impl Iterator<Item = &mut Reference> {
        self.objects.values_mut().flat_map(|object| &mut object.components).chain(&mut self.items)
    }

    pub(super) fn place(&self, byte: u64) -> Place {
        Place::Part { name: self.name.clone(), byte }
    }
}

/// How much more may be read, over all model parts.
pub(super) struct Room {
    limits: ReadLimits,
    vertices: u64,
    triangles: u64,
    objects: u64,
    references: u64,
}

impl Room {
    pub(super) fn new(limits: &ReadLimits) -> Self {
        Self { limits: *limits, vertices: 0, triangles: 0, objects: 0, references: 0 }
    }
}

/// Most objects, and most components and build items together: a few hundred bytes of memory each.
const MAX_OBJECTS: u64 = 200_000;
const MAX_REFERENCES: u64 = 500_000;

/// The elements that are read; everything inside another one is passed over.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Within {
    Model,
    Metadata,
    Resources,
    Object,
    Mesh,
    Vertices,
    Triangles,
    Components,
    Build,
    Other,
}

pub(super) fn read(part: PartReader<'_>, name: &str, room: &mut Room) -> Result<Model, ReadError> {
    let mut xml = XmlPart::new(part, name);
    let model = Model {
        name: name.to_owned(),
        unit: UNITS[1],
        metadata: Vec::new(),
        objects: BTreeMap::new(),
        items: Vec::new(),
    };
    let mut reader = ModelReader {
        model,
        room,
        within: Vec::new(),
        core_prefix: String::new(),
        metadata_prefix: None,
        id: 0,
        object: Object::default(),
        entry: None,
    };
    loop {
        let (event, byte) = xml.next()?;
        match event {
            Event::Start(element) => {
                let within = reader.open(&element, byte)?;
                reader.within.push(within);
            }
            Event::Empty(element) => {
                let within = reader.open(&element, byte)?;
                reader.close(within);
            }
            Event::End(_) => {
                if let Some(within) = reader.within.pop() {
                    reader.close(within);
                }
            }
            Event::Text(text) => reader.text(&text.xml10_content()),
            Event::CData(text) => reader.text(&text.xml10_content()),
            Event::GeneralRef(entity) => reader.text(&resolved(&entity).unwrap_or_default()),
            Event::Eof => return Ok(reader.model),
            _ => {}
        }
    }
}

struct ModelReader<'a> {
    model: Model,
    room: &'a mut Room,
    within: Vec<Within>,
    /// What core elements begin with: nothing, or a prefix and a colon.
    core_prefix: String,
    metadata_prefix: Option<String>,
    /// The object being read.
    id: u32,
    object: Object,
    /// The metadata entry being read.
    entry: Option<(String, String)>,
}

impl ModelReader<'_> {
    /// Reads the beginning of an element; what its content is.
    fn open(&mut self, element: &BytesStart<'_>, byte: u64) -> Result<Within, ReadError> {
        let name = element.name().into_inner();
        let Some(&parent) = self.within.last() else {
            return self.open_model(element, name, byte);
        };
        let Some(name) = name.strip_prefix(&self.core_prefix) else {
            return Ok(Within::Other);
        };
        Ok(match (parent, name) {
            (Within::Model, "metadata") => {
                self.entry = self.attribute(element, byte, "name")?.map(|name| (name, String::new()));
                Within::Metadata
            }
            (Within::Model, "resources") => Within::Resources,
            (Within::Resources, "object") => {
                self.open_object(element, byte)?;
                Within::Object
            }
            (Within::Object, "mesh") => Within::Mesh,
            (Within::Mesh, "vertices") => Within::Vertices,
            (Within::Vertices, "vertex") => self.vertex(element, byte).map(|()| Within::Other)?,
            (Within::Mesh, "triangles") => Within::Triangles,
            (Within::Triangles, "triangle") => self.triangle(element, byte).map(|()| Within::Other)?,
            (Within::Object, "components") => Within::Components,
            (Within::Components, "component") => {
                let component = self.reference(element, byte)?;
                self.object.components.push(component);
                Within::Other
            }
            (Within::Model, "build") => Within::Build,
            (Within::Build, "item") => {
                let item = self.reference(element, byte)?;
                self.model.items.push(item);
                Within::Other
            }
            _ => Within::Other,
        })
    }

    fn close(&mut self, within: Within) {
        match within {
            Within::Object => {
                self.model.objects.insert(self.id, std::mem::take(&mut self.object));
            }
            Within::Metadata => {
                if let Some((name, value)) = self.entry.take() {
                    self.keep_metadata(name, value);
                }
            }
            _ => {}
        }
    }

    fn text(&mut self, text: &str) {
        if let (Some(Within::Metadata), Some((_, value))) = (self.within.last(), &mut self.entry)
            && value.len() + text.len() <= MAX_METADATA_BYTES
        {
            value.push_str(text);
        }
    }

    /// Keeps what 3MF defines and what Trullo wrote; other programs' entries say nothing about this mesh.
    fn keep_metadata(&mut self, name: String, value: String) {
        let name = match (name.split_once(':'), &self.metadata_prefix) {
            (None, _) => name,
            (Some((prefix, rest)), Some(ours)) if prefix == ours => rest.to_owned(),
            _ => return,
        };
        if self.model.metadata.len() < MAX_METADATA
            && self.model.metadata.iter().all(|(known, _)| *known != name)
        {
            self.model.metadata.push((name, value));
        }
    }

    fn open_model(&mut self, element: &BytesStart<'_>, name: &str, byte: u64) -> Result<Within, ReadError> {
        if element.local_name().as_ref() != "model" {
            return Err(self.malformed(byte, quoted(name.as_bytes()), "the element <model>"));
        }
        self.core_prefix = name.strip_suffix("model").unwrap_or_default().to_owned();
        let mut namespaces = BTreeMap::new();
        let mut required = String::new();
        let mut unit = None;
        self.attributes(element, byte, |key, value| match key {
            "unit" => unit = Some(value),
            "requiredextensions" => required = value,
            _ => {
                if let Some(prefix) = key.strip_prefix("xmlns:") {
                    namespaces.insert(prefix.to_owned(), value);
                }
            }
        })?;
        if let Some(unit) = unit {
            let known = UNITS.into_iter().find(|known| known.name == unit);
            let expected = "a unit: micron, millimeter, centimeter, inch, foot or meter";
            self.model.unit = known.ok_or_else(|| self.malformed(byte, quoted(unit.as_bytes()), expected))?;
        }
        for prefix in required.split_ascii_whitespace() {
            let namespace = namespaces.get(prefix).map_or(prefix, String::as_str);
            if !KNOWN_EXTENSIONS.contains(&namespace) {
                let what =
                    format!("the 3MF extension {}, which the file requires,", quoted(namespace.as_bytes()));
                let instead = "export it with plain meshes";
                return Err(ReadError::Unsupported { place: self.model.place(byte), what, instead });
            }
        }
        let ours = namespaces.into_iter().find(|(_, namespace)| namespace == METADATA_NAMESPACE);
        self.metadata_prefix = ours.map(|(prefix, _)| prefix);
        Ok(Within::Model)
    }

    fn open_object(&mut self, element: &BytesStart<'_>, byte: u64) -> Result<(), ReadError> {
        self.room.objects += 1;
        check(self.room.objects, MAX_OBJECTS, "objects", || self.model.place(byte))?;
        let (mut id, mut kind) = (None, None);
        self.attributes(element, byte, |key, value| match key {
            "id" => id = Some(value),
            "type" => kind = Some(value),
            _ => {}
        })?;
        self.id = self.number(id, byte, "an object's id, a number")?;
        if self.model.objects.contains_key(&self.id) {
            return Err(self.malformed(byte, format!("a second object {}", self.id), "every id once"));
        }
        let is_model = matches!(kind.as_deref(), None | Some("model" | "surface"));
        self.object = Object { is_model, ..Object::default() };
        Ok(())
    }

    fn vertex(&mut self, element: &BytesStart<'_>, byte: u64) -> Result<(), ReadError> {
        self.room.vertices += 1;
        check(self.room.vertices, self.room.limits.max_vertices, "vertices", || self.model.place(byte))?;
        let mut found = [None; 3];
        for attribute in element.attributes().with_checks(false) {
            let attribute =
                attribute.map_err(|error| self.malformed(byte, quoted_error(&error), ATTRIBUTES))?;
            if let Some(axis) = ["x", "y", "z"].iter().position(|name| attribute.key.as_ref() == *name) {
                let word = attribute.value.trim_ascii().as_bytes();
                found[axis] = Some(self.length(word, AXES[axis], byte)?);
            }
        }
        match found {
            [Some(x), Some(y), Some(z)] => self.object.mesh.positions.push(Vec3::new(x, y, z)),
            _ => return Err(self.malformed(byte, "a vertex without all of them".to_owned(), "x, y and z")),
        }
        Ok(())
    }

    /// A coordinate in mm. Those in millimetres are read to the nearest 32-bit float at once, so that what was
    /// written comes back exactly.
    fn length(&self, word: &[u8], axis: char, byte: u64) -> Result<f32, ReadError> {
        let place = || self.model.place(byte);
        let read = coordinate(word, axis, place)?;
        if self.model.unit.millimetres == 1.0 {
            return Ok(read);
        }
        let exact = std::str::from_utf8(word).ok().and_then(|text| text.parse::<f64>().ok());
        let value = (exact.unwrap_or(read.into()) * self.model.unit.millimetres) as f32;
        if value.is_finite() {
            return Ok(value);
        }
        let value = format!("{} {}", String::from_utf8_lossy(word), self.model.unit.name);
        Err(ReadError::NotFinite { place: place(), axis, value })
    }

    fn triangle(&mut self, element: &BytesStart<'_>, byte: u64) -> Result<(), ReadError> {
        self.room.triangles += 1;
        check(self.room.triangles, self.room.limits.max_triangles, "triangles", || self.model.place(byte))?;
        let vertices = self.object.mesh.positions.len();
        let mut found = [None; 3];
        for attribute in element.attributes().with_checks(false) {
            let attribute =
                attribute.map_err(|error| self.malformed(byte, quoted_error(&error), ATTRIBUTES))?;
            if let Some(corner) = ["v1", "v2", "v3"].iter().position(|name| attribute.key.as_ref() == *name) {
                let index = attribute.value.trim_ascii().parse::<i64>();
                let index = index.map_err(|_| {
                    self.malformed(
                        byte,
                        quoted(attribute.value.as_bytes()),
                        "a vertex number, counted from 0",
                    )
                })?;
                let known = u32::try_from(index).ok().filter(|&index| (index as usize) < vertices);
                let (place, vertices) = (|| self.model.place(byte), vertices as u64);
                let wrong = || ReadError::IndexOutOfRange { place: place(), index, vertices, first: 0 };
                found[corner] = Some(known.ok_or_else(wrong)?);
            }
        }
        match found {
            [Some(a), Some(b), Some(c)] => self.object.mesh.triangles.push([a, b, c]),
            _ => {
                return Err(self.malformed(
                    byte,
                    "a triangle without all of them".to_owned(),
                    "v1, v2 and v3",
                ));
            }
        }
        Ok(())
    }

    fn reference(&mut self, element: &BytesStart<'_>, byte: u64) -> Result<Reference, ReadError> {
        self.room.references += 1;
        check(self.room.references, MAX_REFERENCES, "components and build items", || self.model.place(byte))?;
        let (mut object, mut transform, mut path) = (None, None, None);
        self.attributes(element, byte, |key, value| match key {
            "objectid" => object = Some(value),
            "transform" => transform = Some(value),
            _ if key.ends_with(":path") => path = Some(value),
            _ => {}
        })?;
        let object = self.number(object, byte, "objectid, the number of an object")?;
        let transform = match transform {
            Some(text) => self.transform(&text, byte)?,
            None => DAffine3::IDENTITY,
        };
        Ok(Reference { path, part: 0, object, transform, byte })
    }

    /// Reads twelve numbers, rows of a matrix that points are multiplied to from the left.
    fn transform(&self, text: &str, byte: u64) -> Result<DAffine3, ReadError> {
        let mut numbers = [0.0; 12];
        let mut words = text.split_ascii_whitespace();
        let wrong = || self.malformed(byte, quoted(text.as_bytes()), "a transform, twelve finite numbers");
        for number in &mut numbers {
            let read = words.next().and_then(|word| word.parse::<f64>().ok());
            *number = read.filter(|number| number.is_finite()).ok_or_else(wrong)?;
        }
        if words.next().is_some() {
            return Err(wrong());
        }
        let [x, y, z, offset] =
            [0, 3, 6, 9].map(|at| DVec3::new(numbers[at], numbers[at + 1], numbers[at + 2]));
        let transform = DAffine3::from_cols(x, y, z, offset * self.model.unit.millimetres);
        if transform.matrix3.determinant() == 0.0 {
            return Err(self.malformed(
                byte,
                quoted(text.as_bytes()),
                "a transform that does not flatten the object",
            ));
        }
        Ok(transform)
    }

    fn number(&self, text: Option<String>, byte: u64, expected: &str) -> Result<u32, ReadError> {
        let number = text.as_deref().and_then(|text| text.trim_ascii().parse().ok());
        number.ok_or_else(|| {
            let found = text.map_or_else(|| "nothing".to_owned(), |text| quoted(text.as_bytes()));
            self.malformed(byte, found, expected)
        })
    }

    fn attribute(
        &self,
        element: &BytesStart<'_>,
        byte: u64,
        name: &str,
    ) -> Result<Option<String>, ReadError> {
        let mut found = None;
        self.attributes(element, byte, |key, value| {
            if key == name {
                found = Some(value);
            }
        })?;
        Ok(found)
    }

    fn attributes(
        &self,
        element: &BytesStart<'_>,
        byte: u64,
        mut take: impl FnMut(&str, String),
    ) -> Result<(), ReadError> {
        for attribute in element.attributes().with_checks(false) {
            let attribute =
                attribute.map_err(|error| self.malformed(byte, quoted_error(&error), ATTRIBUTES))?;
            let wrong = || self.malformed(byte, quoted(attribute.value.as_bytes()), "known entities only");
            take(attribute.key.as_ref(), value_of(&attribute).ok_or_else(wrong)?);
        }
        Ok(())
    }

    fn malformed(&self, byte: u64, found: String, expected: &str) -> ReadError {
        ReadError::Malformed { place: self.model.place(byte), found, expected: expected.to_owned() }
    }
}

const ATTRIBUTES: &str = "attributes like name=\"value\"";

fn quoted_error(error: &impl ToString) -> String {
    quoted(error.to_string().as_bytes())
}

/// The text a character or predefined entity stands for.
fn resolved(entity: &BytesRef<'_>) -> Option<String> {
    match entity.resolve_char_ref() {
        Ok(Some(character)) => Some(character.to_string()),
        _ => resolve_predefined_entity(&entity.xml10_content()).map(str::to_owned),
    }
}
