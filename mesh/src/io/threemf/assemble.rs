//! Placing 3MF objects: build items and components, with their transforms, into one mesh.

use std::collections::BTreeMap;

use glam::DAffine3;

use super::super::builder::{MeshBuilder, check};
use super::super::{Notice, Place, ReadError, ReadLimits};
use super::model::{Model, Object, Reference};

/// Deepest nesting of components.
const MAX_DEPTH: usize = 64;
/// Most meshes placed: more than any plate holds, and few enough to be placed in a moment.
const MAX_PLACED: u64 = 100_000;

/// What placing an object once adds to the mesh.
#[derive(Clone, Copy, Default)]
struct Load {
    vertices: u64,
    triangles: u64,
    /// Meshes with triangles.
    meshes: u64,
    /// Objects that are not part of the model.
    skipped: u64,
}

impl Load {
    fn plus(self, other: Self) -> Self {
        Self {
            vertices: self.vertices.saturating_add(other.vertices),
            triangles: self.triangles.saturating_add(other.triangles),
            meshes: self.meshes.saturating_add(other.meshes),
            skipped: self.skipped.saturating_add(other.skipped),
        }
    }
}

/// Places every build item of the first model; without any, every object that no other one uses.
///
/// What is placed is weighed before any of it is, so that copies of copies cannot fill the memory.
pub(super) fn assemble(
    mut models: Vec<Model>,
    limits: &ReadLimits,
    builder: &mut MeshBuilder,
    notices: &mut Vec<Notice>,
) -> Result<(), ReadError> {
    let items = std::mem::take(&mut models[0].items);
    let items = if items.is_empty() {
        notices.push(Notice::NothingBuilt);
        unused_objects(&models[0])
    } else {
        items
    };
    let mut scales = Scales { models: &models, loads: BTreeMap::new() };
    let mut total = Load::default();
    for item in &items {
        total = total.plus(scales.weigh(0, item, 0)?);
    }
    let loads = scales.loads;
    let place = || models[0].place(items.first().map_or(0, |item| item.byte));
    check(total.triangles, limits.max_triangles, "triangles in all copies", place)?;
    check(total.vertices, limits.max_vertices, "vertices in all copies", place)?;
    check(total.meshes, MAX_PLACED, "copies of objects", place)?;
    if total.skipped > 0 {
        notices.push(Notice::SkippedObjects { count: total.skipped });
    }
    builder.mesh.positions.reserve_exact(total.vertices as usize);
    builder.mesh.triangles.reserve_exact(total.triangles as usize);
    items.iter().try_for_each(|item| put(&models, &loads, item, DAffine3::IDENTITY, builder))
}

/// References to the objects that are no component of another one, in the order of their ids.
fn unused_objects(model: &Model) -> Vec<Reference> {
    let mut ids: BTreeMap<u32, bool> = model.objects.keys().map(|&id| (id, true)).collect();
    for component in model.objects.values().flat_map(|object| &object.components) {
        if component.part == 0 {
            ids.insert(component.object, false);
        }
    }
    let unused = ids.into_iter().filter(|&(_, unused)| unused);
    let reference =
        |(object, _)| Reference { path: None, part: 0, object, transform: DAffine3::IDENTITY, byte: 0 };
    unused.map(reference).collect()
}

struct Scales<'a> {
    models: &'a [Model],
    /// Weighed objects by part and id; `None` while one is being weighed.
    loads: BTreeMap<(usize, u32), Option<Load>>,
}

impl Scales<'_> {
    fn weigh(&mut self, from: usize, reference: &Reference, depth: usize) -> Result<Load, ReadError> {
        let key = (reference.part, reference.object);
        let models = self.models;
        let wrong = |found: String, expected: &str| ReadError::Malformed {
            place: models[from].place(reference.byte),
            found,
            expected: expected.to_owned(),
        };
        match self.loads.get(&key) {
            Some(Some(load)) => return Ok(*load),
            Some(None) => {
                let found = format!("object {} inside itself", reference.object);
                return Err(wrong(found, "components without a circle"));
            }
            None => {}
        }
        if depth > MAX_DEPTH {
            let (found, limit, what) = (depth as u64, MAX_DEPTH as u64, "components inside each other");
            let place = models[from].place(reference.byte);
            return Err(ReadError::TooLarge { place, what, found, limit });
        }
        let Some(object) = models[reference.part].objects.get(&reference.object) else {
            let found = format!("object {}", reference.object);
            return Err(wrong(found, "the id of an object in the same model part"));
        };
        self.loads.insert(key, None);
        let mut load = own_load(object);
        for component in &object.components {
            load = load.plus(self.weigh(reference.part, component, depth + 1)?);
        }
        self.loads.insert(key, Some(load));
        Ok(load)
    }
}

/// What an object adds without its components.
fn own_load(object: &Object) -> Load {
    let triangles = object.mesh.triangles.len() as u64;
    match (triangles, object.is_model) {
        (0, _) => Load::default(),
        (_, false) => Load { skipped: 1, ..Load::default() },
        (_, true) => Load { vertices: object.mesh.positions.len() as u64, triangles, meshes: 1, skipped: 0 },
    }
}

fn put(
    models: &[Model],
    loads: &BTreeMap<(usize, u32), Option<Load>>,
    reference: &Reference,
    outer: DAffine3,
    builder: &mut MeshBuilder,
) -> Result<(), ReadError> {
    // Passing over what adds nothing keeps the work in proportion to the meshes placed.
    let load = loads.get(&(reference.part, reference.object)).copied().flatten().unwrap_or_default();
    let Some(object) = models[reference.part].objects.get(&reference.object).filter(|_| load.meshes > 0)
    else {
        return Ok(());
    };
    let transform = outer * reference.transform;
    if own_load(object).meshes > 0 {
        put_mesh(object, transform, builder, || models[reference.part].place(0))?;
    }
    object.components.iter().try_for_each(|component| put(models, loads, component, transform, builder))
}

fn put_mesh(
    object: &Object,
    transform: DAffine3,
    builder: &mut MeshBuilder,
    place: impl Fn() -> Place,
) -> Result<(), ReadError> {
    let first = builder.vertices() as u32;
    let unmoved = transform == DAffine3::IDENTITY;
    for &position in &object.mesh.positions {
        let placed =
            if unmoved { position } else { transform.transform_point3(position.as_dvec3()).as_vec3() };
        let placed = super::super::number::finite(placed, &place)?;
        builder.vertex(placed, &place)?;
    }
    let mirrored = transform.matrix3.determinant() < 0.0;
    for corners in &object.mesh.triangles {
        let [a, b, c] = corners.map(|index| index + first);
        // A mirrored solid must not turn inside out.
        builder.triangle(if mirrored { [a, c, b] } else { [a, b, c] }, &place)?;
    }
    Ok(())
}
