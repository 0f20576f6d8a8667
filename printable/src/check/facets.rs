//! Facets that lean out too far, and voids: what the triangles say without slicing.

use super::CheckSettings;
use glam::{DVec3, Vec3};
use mesh::{Body, Mesh};

/// Area of facets that lean out farther than the rule allows; what lies on the bed does not count.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Steep {
    /// On the outside, mm².
    pub outside: f64,
    /// In inner voids, mm².
    pub inside: f64,
    /// Largest overhang of any facet off the bed, radians from the vertical; negative if all face upwards, none if
    /// there are none.
    pub worst: Option<f64>,
    /// The middle of a facet with the largest overhang, mm.
    pub place: Option<DVec3>,
}

/// A closed void inside a part: what is in it stays in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Void {
    /// mm³.
    pub volume: f64,
    /// The middle of its box, mm.
    pub place: DVec3,
    /// Its lowest and highest point, mm.
    pub z: [f64; 2],
}

/// What the triangles say.
#[derive(Debug)]
pub(super) struct Facets {
    pub(super) steep: Steep,
    pub(super) voids: Vec<Void>,
}

/// Measures all facets. `bottom` is where the bed is, mm.
pub(super) fn look(mesh: &Mesh, bottom: f64, settings: &CheckSettings) -> Facets {
    let bodies = mesh.bodies();
    // A part that faces inward as a whole is meant the other way round.
    let sign = if bodies.iter().map(|body| body.volume).sum::<f64>() < 0.0 { -1.0 } else { 1.0 };
    let is_void = |body: &Body| body.closed && sign * body.volume < 0.0;
    let labels = mesh.components_by_edges().labels;
    let bed = bottom + f64::from(1e-6 * mesh.bounds().size().z).max(1e-4);
    let limit = (f64::from(settings.rule.overhang.radians()) + settings.angle_tolerance).sin();
    let (mut steep, mut worst) = (Steep::default(), f64::NEG_INFINITY);
    for (&triangle, &label) in mesh.triangles.iter().zip(&labels) {
        let Some(corners) = mesh.corners(triangle) else { continue };
        let [a, b, c] = corners.map(Vec3::as_dvec3);
        let doubled = (b - a).cross(c - a) * sign;
        let length = doubled.length();
        if a.z.max(b.z).max(c.z) <= bed || length == 0.0 {
            continue;
        }
        let leaning = -doubled.z / length;
        if leaning > worst {
            worst = leaning;
            steep.place = Some((a + b + c) / 3.0);
        }
        if leaning > limit {
            let sum = if is_void(&bodies[label as usize]) { &mut steep.inside } else { &mut steep.outside };
            *sum += 0.5 * length;
        }
    }
    steep.worst = (worst > f64::NEG_INFINITY).then(|| worst.clamp(-1.0, 1.0).asin());
    let voids = bodies.iter().filter(|body| is_void(body)).map(|body| Void {
        volume: body.volume.abs(),
        place: body.bounds.centre(),
        z: [body.bounds.min.z, body.bounds.max.z].map(f64::from),
    });
    Facets { steep, voids: voids.collect() }
}
