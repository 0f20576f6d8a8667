//! 3MF core packages, with the production extension's split models.
//!
//! Reading places every build item, with its transform and unit, into one mesh; writing makes one object in
//! millimetres, with base materials if triangles have some. Materials, textures and slices are not read; extensions
//! that change the shape are refused by name.
//!
//! **Source:** 3MF Core Specification 1.4, 3MF Production Extension 1.2.

mod assemble;
mod model;
mod package;
mod write;
mod xml;

use std::collections::BTreeMap;
use std::io::{Read, Seek};

use super::builder::{MeshBuilder, check};
use super::{Attachments, Format, Loaded, Notice, Place, ReadError, ReadLimits};
use model::{Model, Room};
use package::Package;

pub(super) use write::write;

/// The core specification's namespace.
const CORE: &str = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02";
/// The relationship from the package to its model.
const MODEL_RELATIONSHIP: &str = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel";
/// The relationship that asks other programs to keep a part they do not know.
const PRESERVE_RELATIONSHIP: &str =
    "http://schemas.openxmlformats.org/package/2006/relationships/mustpreserve";
/// Where Trullo keeps the scene.
const SCENE_PART: &str = "Metadata/scene.trullo";
/// Where models are when no relationship says otherwise.
const MODEL_PART: &str = "3D/3dmodel.model";
/// The namespace of metadata that 3MF does not define.
const METADATA_NAMESPACE: &str = "urn:trullo:metadata";

/// Most model parts of one package; real ones have one, or one for every object of a plate.
const MAX_PARTS: u64 = 10_000;

pub(super) fn read<R: Read + Seek>(reader: R, length: u64, limits: &ReadLimits) -> Result<Loaded, ReadError> {
    let mut package = Package::open(reader, length, limits)?;
    let roots = package.relationships()?;
    let root = roots.model.unwrap_or_else(|| MODEL_PART.to_owned());
    let mut models = read_models(&mut package, &root, limits)?;

    let mut notices = Vec::new();
    let unit = models[0].unit;
    if unit.millimetres != 1.0 {
        notices.push(Notice::Converted { unit: unit.name, millimetres: unit.millimetres });
    }
    let mut attachments = attachments_of(&mut models[0]);
    let scene = roots.preserved.iter().find(|part| part.to_ascii_lowercase().ends_with(".trullo"));
    attachments.scene = package.bytes(scene.map_or(SCENE_PART, String::as_str))?;

    let mut builder = MeshBuilder::new(limits);
    assemble::assemble(models, limits, &mut builder, &mut notices)?;
    let hint = || "its build section places no object with a mesh".to_owned();
    let mut loaded = builder.finish(Format::ThreeMf, notices, hint)?;
    loaded.attachments = attachments;
    Ok(loaded)
}

/// Reads the root model and every model part that it refers to, the root first.
fn read_models<R: Read + Seek>(
    package: &mut Package<R>,
    root: &str,
    limits: &ReadLimits,
) -> Result<Vec<Model>, ReadError> {
    let mut known = BTreeMap::from([(part_key(root), 0)]);
    let mut wanted = vec![root.to_owned()];
    let mut models: Vec<Model> = Vec::new();
    let mut room = Room::new(limits);
    while let Some(name) = wanted.get(models.len()) {
        let Some(part) = package.part(name)? else {
            let missing =
                format!("the package has no part {name}, the model; it may be no 3MF file or cut off");
            return Err(ReadError::Truncated { place: Place::File, missing });
        };
        let mut model = model::read(part, name, &mut room)?;
        for reference in model.references_mut() {
            let Some(path) = &reference.path else {
                reference.part = models.len();
                continue;
            };
            reference.part = *known.entry(part_key(path)).or_insert_with(|| {
                wanted.push(path.clone());
                wanted.len() - 1
            });
        }
        check(wanted.len() as u64, MAX_PARTS, "model parts", || Place::File)?;
        models.push(model);
    }
    Ok(models)
}

/// Part names are compared without case, as the Open Packaging Conventions ask.
fn part_key(name: &str) -> String {
    name.trim_start_matches('/').to_ascii_lowercase()
}

fn attachments_of(root: &mut Model) -> Attachments {
    let mut metadata = std::mem::take(&mut root.metadata);
    let title = metadata.iter().position(|(name, _)| name == "Title").map(|at| metadata.remove(at).1);
    metadata.retain(|(name, _)| name != "Application" && name != "Title");
    Attachments { title, metadata, ..Attachments::default() }
}
