//! Is a mesh the surface of a printable solid, and if not, where and why not.
//!
//! [`Mesh::is_closed_manifold`] is the quick yes or no; [`Mesh::validity`] counts everything and lists places. Vertices
//! are compared by index: a mesh whose triangles do not share vertices (as read from an STL) must be welded first.
//! Not looked for: triangles that overlap in one plane, walls too thin to print, bad proportions.

use std::fmt;

use glam::Vec3;

use crate::Mesh;
use crate::bvh::Bvh;
use crate::components::{Body, Components, DisjointSets, bodies_of, components_of};
use crate::crossings::Crossings;
use crate::edges::{EdgeTable, is_collapsed};
use crate::winding::Winding;
use rayon::prelude::*;

/// Places listed of each kind of finding; the counts go on.
pub const MOST_PLACES: usize = 100;

/// What can be wrong with a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum Fault {
    /// A triangle names a vertex that does not exist.
    MissingVertex,
    /// A vertex coordinate is NaN or infinite.
    NotFinite,
    /// A triangle names a vertex twice.
    CollapsedTriangle,
    /// A triangle's height is within the rounding of its own coordinates.
    ZeroArea,
    /// A triangle has the same three vertices as an earlier one, in any order.
    DuplicateTriangle,
    /// No triangle uses the vertex.
    UnusedVertex,
    /// An edge has one triangle only: the rim of a hole.
    BoundaryEdge,
    /// An edge has three or more triangles.
    NonManifoldEdge,
    /// As many triangles on the edge as should be, but they do not run in opposite directions.
    MisorientedEdge,
    /// The triangles around the vertex fall into several fans.
    NonManifoldVertex,
    /// A closed part faces inward without lying inside a solid.
    InvertedBody,
    /// A closed part lies inside another solid part: harmless but superfluous.
    RedundantBody,
    /// Two triangles cross.
    Crossing,
}

impl Fault {
    /// Every fault, from the most basic to the most derived.
    pub const ALL: [Self; 13] = [
        Self::MissingVertex,
        Self::NotFinite,
        Self::CollapsedTriangle,
        Self::ZeroArea,
        Self::DuplicateTriangle,
        Self::UnusedVertex,
        Self::BoundaryEdge,
        Self::NonManifoldEdge,
        Self::MisorientedEdge,
        Self::NonManifoldVertex,
        Self::InvertedBody,
        Self::RedundantBody,
        Self::Crossing,
    ];
}

/// What a finding points at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Element {
    /// A vertex index.
    Vertex(u32),
    /// Two vertex indices, the smaller first.
    Edge([u32; 2]),
    /// A triangle index.
    Triangle(u32),
    /// Two triangle indices, the smaller first.
    Pair([u32; 2]),
    /// A part, by its first triangle.
    Body(u32),
}

/// One thing wrong, and where. Its `Display` says both in words.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Finding {
    /// What is wrong.
    pub fault: Fault,
    /// At which element.
    pub element: Element,
    /// At which point, mm. Not finite when the vertex itself is not.
    pub place: Vec3,
}

/// Whether to look for triangles that cross, which costs more than everything else together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SelfIntersections {
    /// Look for them.
    Search,
    /// Do not; [`Validity::crossings`] stays empty.
    Skip,
}

/// Everything [`Mesh::validity`] found out.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Validity {
    /// Triangles in the mesh.
    pub triangles: usize,
    /// Edges whose triangles do not cancel in direction: what bounds the surface as the winding number sees it.
    pub unbalanced_edges: usize,
    /// Parts connected across edges.
    pub bodies: usize,
    /// Closed parts that face inward inside a solid: cavities. No fault.
    pub voids: usize,
    /// Pairs of triangles that cross; none if they were not looked for.
    pub crossings: Option<Crossings>,
    counts: [usize; Fault::ALL.len()],
    listed: Vec<Finding>,
}

impl Validity {
    /// How many there are of one fault, listed or not.
    pub fn count(&self, fault: Fault) -> usize {
        self.counts[fault as usize]
    }

    /// Whether there are triangles and no edge has only one.
    pub fn is_closed(&self) -> bool {
        let unusable = self.count(Fault::CollapsedTriangle) + self.count(Fault::MissingVertex);
        self.triangles > unusable && self.count(Fault::BoundaryEdge) == 0
    }

    /// Whether no edge has more than two triangles.
    pub fn is_edge_manifold(&self) -> bool {
        self.count(Fault::NonManifoldEdge) == 0
    }

    /// Whether neighbouring triangles run in opposite directions along every shared edge.
    pub fn is_oriented(&self) -> bool {
        self.count(Fault::MisorientedEdge) == 0
    }

    /// Whether the mesh is the boundary of a solid as every slicer understands it: closed, edge-manifold, oriented,
    /// finite, all parts facing the right way, and no crossings where those were looked for.
    ///
    /// Vertices where two solids touch, superfluous parts, triangles without area and unused vertices are let pass.
    pub fn is_printable_solid(&self) -> bool {
        self.is_closed()
            && self.is_edge_manifold()
            && self.is_oriented()
            && [Fault::MissingVertex, Fault::NotFinite, Fault::InvertedBody, Fault::Crossing]
                .into_iter()
                .all(|fault| self.count(fault) == 0)
            && self.crossings.as_ref().is_none_or(|c| c.complete)
    }

    /// The findings, kind by kind in the order of [`Fault::ALL`], at most [`MOST_PLACES`] of each kind.
    pub fn findings(&self) -> impl Iterator<Item = &Finding> {
        self.listed.iter()
    }

    /// Counts one more and lists it if there is room.
    fn note(&mut self, fault: Fault, element: Element, place: Vec3) {
        self.counts[fault as usize] += 1;
        if self.count(fault) <= MOST_PLACES {
            self.listed.push(Finding { fault, element, place });
        }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::MissingVertex => "triangle with a vertex that does not exist",
            Self::NotFinite => "vertex that is not finite",
            Self::CollapsedTriangle => "triangle with a repeated vertex",
            Self::ZeroArea => "triangle without area",
            Self::DuplicateTriangle => "duplicate triangle",
            Self::UnusedVertex => "unused vertex",
            Self::BoundaryEdge => "open edge (rim of a hole)",
            Self::NonManifoldEdge => "edge with more than two triangles",
            Self::MisorientedEdge => "edge between triangles facing opposite ways",
            Self::NonManifoldVertex => "vertex where separate surfaces touch",
            Self::InvertedBody => "part facing inward",
            Self::RedundantBody => "part inside another solid part",
            Self::Crossing => "crossing triangles",
        })
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Vec3 { x, y, z } = self.place;
        write!(f, "{} at ({x:.3}, {y:.3}, {z:.3}) mm, ", self.fault)?;
        match self.element {
            Element::Vertex(v) => write!(f, "vertex {v}"),
            Element::Edge([a, b]) => write!(f, "vertices {a} and {b}"),
            Element::Triangle(t) => write!(f, "triangle {t}"),
            Element::Pair([a, b]) => write!(f, "triangles {a} and {b}"),
            Element::Body(t) => write!(f, "the part of triangle {t}"),
        }
    }
}

impl Mesh {
    /// Whether the mesh has triangles, all sound, and every edge has exactly two running in opposite directions.
    /// O(n log n).
    pub fn is_closed_manifold(&self) -> bool {
        self.is_closed_manifold_unless(&|| false).expect("nobody stops it")
    }

    /// The same; none if `cancelled` says so meanwhile.
    pub fn is_closed_manifold_unless(&self, cancelled: &(dyn Fn() -> bool + Sync)) -> Option<bool> {
        let sound = |t: &[u32; 3]| self.corners(*t).is_some() && !is_collapsed(*t);
        if self.triangles.is_empty() || !self.triangles.iter().all(sound) {
            return (!cancelled()).then_some(false);
        }
        let shares = EdgeTable::in_shares(self);
        let is_closed = |edges: &EdgeTable| edges.iter().all(|e| e.halves.len() == 2 && e.balance() == 0);
        let closed =
            shares.into_par_iter().map(|share| !cancelled() && is_closed(&share.sorted())).all(|is| is);
        (!cancelled()).then_some(closed)
    }

    /// Counts and places everything that is wrong. O(n log n) for ordinary meshes; no input makes it panic.
    pub fn validity(&self, self_intersections: SelfIntersections) -> Validity {
        let mut report = Validity { triangles: self.triangles.len(), ..Validity::default() };
        check_triangles(self, &mut report);
        let edges = EdgeTable::new(self);
        check_edges(self, &edges, &mut report);
        for v in vertices_with_several_fans(self, &edges) {
            report.note(Fault::NonManifoldVertex, Element::Vertex(v), self.positions[v as usize]);
        }
        check_bodies(self, &edges, &mut report);
        if self_intersections == SelfIntersections::Search {
            let crossings = self.crossings();
            for &(pair, place) in &crossings.pairs {
                report.note(Fault::Crossing, Element::Pair(pair), place);
            }
            report.counts[Fault::Crossing as usize] = crossings.count;
            report.crossings = Some(crossings);
        }
        report.listed.sort_by_key(|finding| finding.fault);
        report
    }
}

fn check_triangles(mesh: &Mesh, report: &mut Validity) {
    let mut used = vec![false; mesh.positions.len()];
    let mut sorted = Vec::with_capacity(mesh.triangles.len());
    for (t, &triangle) in (0u32..).zip(&mesh.triangles) {
        for v in triangle {
            used.get_mut(v as usize).into_iter().for_each(|u| *u = true);
        }
        let Some(corners) = mesh.corners(triangle) else {
            report.note(Fault::MissingVertex, Element::Triangle(t), some_corner(mesh, triangle));
            continue;
        };
        if is_collapsed(triangle) {
            report.note(Fault::CollapsedTriangle, Element::Triangle(t), corners[0]);
            continue;
        }
        if has_no_area(corners) {
            report.note(Fault::ZeroArea, Element::Triangle(t), middle(corners));
        }
        let mut key = triangle;
        key.sort_unstable();
        sorted.push((key, t));
    }
    sorted.sort_unstable();
    for pair in sorted.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
        let place = mesh.corners(pair[1].0).map_or(Vec3::ZERO, middle);
        report.note(Fault::DuplicateTriangle, Element::Triangle(pair[1].1), place);
    }
    for ((v, &p), used) in (0u32..).zip(&mesh.positions).zip(used) {
        if !p.is_finite() {
            report.note(Fault::NotFinite, Element::Vertex(v), p);
        }
        if !used {
            report.note(Fault::UnusedVertex, Element::Vertex(v), p);
        }
    }
}

fn some_corner(mesh: &Mesh, triangle: [u32; 3]) -> Vec3 {
    triangle.iter().find_map(|&v| mesh.positions.get(v as usize)).copied().unwrap_or(Vec3::ZERO)
}

fn middle([a, b, c]: [Vec3; 3]) -> Vec3 {
    a / 3.0 + b / 3.0 + c / 3.0
}

/// Height over the longest side within one rounding step of the largest coordinate.
pub(crate) fn has_no_area(corners: [Vec3; 3]) -> bool {
    let largest = corners.iter().fold(0.0, |m: f32, p| m.max(p.abs().max_element()));
    let [a, b, c] = corners.map(Vec3::as_dvec3);
    let doubled = (b - a).cross(c - a).length();
    let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
    doubled <= longest * f64::from(largest) * f64::from(f32::EPSILON)
}

fn check_edges(mesh: &Mesh, edges: &EdgeTable, report: &mut Validity) {
    for edge in edges.iter() {
        let balanced = edge.balance() == 0;
        report.unbalanced_edges += usize::from(!balanced);
        let [a, b] = edge.ends();
        let place = mesh.positions[a as usize].midpoint(mesh.positions[b as usize]);
        let mut note = |fault| report.note(fault, Element::Edge([a, b]), place);
        match edge.halves.len() {
            1 => note(Fault::BoundaryEdge),
            2 => {}
            _ => note(Fault::NonManifoldEdge),
        }
        if edge.halves.len() % 2 == 0 && !balanced {
            note(Fault::MisorientedEdge);
        }
    }
}

/// The vertices whose triangles fall into several fans: joins the corners of neighbouring triangles and looks for
/// vertices with more than one group of corners.
pub(crate) fn vertices_with_several_fans(mesh: &Mesh, edges: &EdgeTable) -> Vec<u32> {
    let mut fans = DisjointSets::new(3 * mesh.triangles.len());
    for edge in edges.iter() {
        let [a, b] = edge.halves else { continue };
        for v in edge.ends() {
            let corner = |triangle: u32| {
                let at = mesh.triangles[triangle as usize].iter().position(|&w| w == v).unwrap_or(0);
                3 * triangle + at as u32
            };
            fans.join(corner(a.triangle), corner(b.triangle));
        }
    }
    let mut fan_of = vec![u32::MAX; mesh.positions.len()];
    let mut several = vec![false; mesh.positions.len()];
    for (t, &triangle) in (0u32..).zip(&mesh.triangles) {
        if mesh.corners(triangle).is_none() || is_collapsed(triangle) {
            continue;
        }
        for (corner, v) in (3 * t..).zip(triangle) {
            let fan = fans.root(corner);
            let known = &mut fan_of[v as usize];
            if *known == u32::MAX {
                *known = fan;
            } else if *known != fan {
                several[v as usize] = true;
            }
        }
    }
    (0u32..).zip(several).filter(|(_, several)| *several).map(|(v, _)| v).collect()
}

fn check_bodies(mesh: &Mesh, edges: &EdgeTable, report: &mut Validity) {
    let components = components_of(mesh.triangles.len(), edges);
    let bodies = bodies_of(mesh, edges, &components);
    // Unusable triangles are parts of one.
    report.bodies =
        bodies.len() - report.count(Fault::CollapsedTriangle) - report.count(Fault::MissingVertex);
    let lone_outward = bodies.len() == 1 && bodies[0].volume > 0.0;
    if lone_outward || bodies.iter().all(|b| !b.closed) {
        return;
    }
    let bvh = Bvh::new(mesh);
    let winding = Winding::new(&bvh);
    let spots = spots_of(mesh, &components, bodies.len());
    for (body, spots) in bodies.iter().zip(&spots).filter(|(body, _)| body.closed) {
        let around = wrapped_by_others(&bvh, &winding, body, spots);
        let place = spots.first().map_or(Vec3::ZERO, |s| s.middle);
        let element = Element::Body(body.first_triangle);
        if body.volume < 0.0 && around >= 1 {
            report.voids += 1;
        } else if body.volume < 0.0 {
            report.note(Fault::InvertedBody, element, place);
        } else if around >= 1 {
            report.note(Fault::RedundantBody, element, place);
        }
    }
}

/// A place on a part's surface: the middle of a triangle, and a step off it along its normal, well beyond what
/// rounding can move the middle.
#[derive(Clone, Copy)]
struct Spot {
    area: f64,
    middle: Vec3,
    step: Vec3,
}

/// Spots on a few triangles of every part, largest triangle first.
fn spots_of(mesh: &Mesh, components: &Components, count: usize) -> Vec<Vec<Spot>> {
    const SPOTS: usize = 8;
    let mut spots: Vec<Vec<Spot>> = vec![Vec::new(); count];
    for (&triangle, &label) in mesh.triangles.iter().zip(&components.labels) {
        let Some(corners) = mesh.corners(triangle) else { continue };
        let [a, b, c] = corners.map(Vec3::as_dvec3);
        let normal = (b - a).cross(c - a);
        let area = normal.length();
        let list = &mut spots[label as usize];
        let at = list.partition_point(|s| s.area >= area);
        if at < SPOTS {
            let largest = corners.iter().fold(0.0, |m: f32, p| m.max(p.abs().max_element()));
            let step = normal.normalize_or_zero().as_vec3() * (8.0 * f32::EPSILON * largest);
            list.insert(at, Spot { area, middle: middle(corners), step });
            list.truncate(SPOTS);
        }
    }
    spots
}

/// How many times the other parts wrap around a closed part. Just outside and just inside of its own surface the part
/// itself counts one half in the mean; where another part touches, the sum is no whole number plus a half, and another
/// spot is asked.
fn wrapped_by_others(bvh: &Bvh, winding: &Winding, body: &Body, spots: &[Spot]) -> i64 {
    let own = if body.volume < 0.0 { -0.5 } else { 0.5 };
    let around = |spot: &Spot| {
        let sides = [spot.middle + spot.step, spot.middle - spot.step].map(|p| winding.at(bvh, p));
        (sides[0] + sides[1]) / 2.0 - own
    };
    let others: Vec<f64> = spots.iter().map(around).collect();
    let clear = others.iter().find(|w| (*w - w.round()).abs() < 0.2);
    clear.or(others.first()).map_or(0, |w| w.round() as i64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::{cuboid, ico_sphere, torus, uv_sphere};

    fn report(mesh: &Mesh) -> Validity {
        mesh.validity(SelfIntersections::Search)
    }

    fn faults(mesh: &Mesh) -> Vec<(Fault, usize)> {
        let report = report(mesh);
        Fault::ALL.into_iter().map(|f| (f, report.count(f))).filter(|f| f.1 > 0).collect()
    }

    #[test]
    fn sound_solids_have_no_findings() {
        for mesh in [cuboid(Vec3::ZERO, Vec3::ONE), torus(Vec3::ZERO, 5.0, 2.0, 24, 12)] {
            assert_eq!(faults(&mesh), []);
            assert!(report(&mesh).is_printable_solid() && mesh.is_closed_manifold());
        }
    }

    #[test]
    fn faults_are_numbered_as_they_are_listed() {
        assert!(Fault::ALL.into_iter().enumerate().all(|(i, fault)| fault as usize == i));
    }

    #[test]
    fn a_hole_shows_its_rim() {
        let mut mesh = cuboid(Vec3::ZERO, Vec3::ONE);
        mesh.triangles.pop();
        assert_eq!(faults(&mesh), [(Fault::BoundaryEdge, 3)]);
        let report = report(&mesh);
        assert!(!report.is_closed() && !report.is_printable_solid() && report.unbalanced_edges == 3);
        let first = report.findings().next().expect("the rim is listed").to_string();
        assert_eq!(first, "open edge (rim of a hole) at (0.000, 0.500, 1.000) mm, vertices 4 and 6");
    }

    #[test]
    fn boxes_sharing_an_edge_a_corner_or_a_face_are_told_apart() {
        let one = cuboid(Vec3::ZERO, Vec3::ONE);
        let welded = |offset: Vec3| {
            let mut mesh = one.clone();
            mesh.append(&cuboid(offset, offset + Vec3::ONE));
            let first_at =
                |p: Vec3| mesh.positions.iter().position(|&q| q == p).expect("p is a vertex") as u32;
            mesh.triangles =
                mesh.triangles.iter().map(|t| t.map(|v| first_at(mesh.positions[v as usize]))).collect();
            mesh
        };
        let without_unused =
            |mesh: &Mesh| faults(mesh).into_iter().filter(|f| f.0 != Fault::UnusedVertex).collect::<Vec<_>>();
        assert_eq!(without_unused(&welded(Vec3::ONE)), [(Fault::NonManifoldVertex, 1)]);
        assert_eq!(
            without_unused(&welded(Vec3::new(1.0, 1.0, 0.0))),
            [(Fault::NonManifoldEdge, 1), (Fault::NonManifoldVertex, 2)]
        );
        let face = report(&welded(Vec3::X));
        assert_eq!(face.count(Fault::DuplicateTriangle), 2);
        assert_eq!(face.count(Fault::NonManifoldEdge), 5);
        assert_eq!(face.unbalanced_edges, 0);
    }

    #[test]
    fn a_flipped_triangle_has_three_misoriented_edges() {
        let mut mesh = cuboid(Vec3::ZERO, Vec3::ONE);
        mesh.triangles[5].swap(0, 1);
        assert_eq!(faults(&mesh), [(Fault::MisorientedEdge, 3)]);
        assert!(!report(&mesh).is_oriented());
    }

    #[test]
    fn voids_inverted_and_superfluous_bodies_are_told_apart() {
        let shell = |size: f32, outward: bool| {
            let mut mesh = cuboid(Vec3::splat(-size), Vec3::splat(size));
            if !outward {
                mesh.flip();
            }
            mesh
        };
        let nest = |outward: &[bool]| {
            let mut mesh = Mesh::default();
            for (i, &o) in outward.iter().enumerate() {
                mesh.append(&shell(8.0 - i as f32, o));
            }
            mesh
        };
        let hollow = report(&nest(&[true, false, true, false]));
        assert_eq!((hollow.voids, hollow.findings().count(), hollow.bodies), (2, 0, 4));
        assert!(hollow.is_printable_solid());
        assert_eq!(faults(&nest(&[false])), [(Fault::InvertedBody, 1)]);
        assert_eq!(faults(&nest(&[true, true])), [(Fault::RedundantBody, 1)]);
        assert_eq!(faults(&nest(&[false, false])), [(Fault::InvertedBody, 2)]);
        // A void that touches the outer wall from inside is still a void.
        let mut touching = shell(8.0, true);
        let mut void = cuboid(Vec3::new(-8.0, -2.0, -2.0), Vec3::new(2.0, 2.0, 2.0));
        void.flip();
        touching.append(&void);
        assert_eq!((report(&touching).voids, report(&touching).findings().count()), (1, 0));
    }

    #[test]
    fn small_turned_bodies_far_away_are_not_taken_for_superfluous() {
        for i in 0..40 {
            let (sin, cos) = (i as f32).sin_cos();
            let away = Vec3::new(400.0 * cos, 300.0 * sin, 170.0 - 9.0 * i as f32);
            let mut mesh = ico_sphere(Vec3::ZERO, 12.0, 2);
            mesh.append(&ico_sphere(away, 1.0, 1));
            mesh.append(&ico_sphere(-away, 1.0, 1));
            assert_eq!(faults(&mesh), [], "away by {away}");
            mesh.append(&ico_sphere(away, 0.3, 1));
            assert_eq!(faults(&mesh), [(Fault::RedundantBody, 1)], "away by {away}");
        }
    }

    #[test]
    fn crossing_bodies_are_not_printable_and_the_search_can_be_left_out() {
        let mut mesh = uv_sphere(Vec3::ZERO, 5.0, 24, 12);
        mesh.append(&uv_sphere(Vec3::new(5.0, 0.3, 0.2), 5.0, 24, 12));
        assert!(!report(&mesh).is_printable_solid());
        let skipped = mesh.validity(SelfIntersections::Skip);
        assert!(skipped.is_printable_solid() && skipped.crossings.is_none());
        assert!(report(&mesh).findings().any(|f| f.fault == Fault::Crossing));
    }

    #[test]
    fn broken_triangles_are_counted_once_each_and_lists_are_bounded() {
        let mut mesh = cuboid(Vec3::ZERO, Vec3::ONE);
        mesh.positions.extend([Vec3::NAN, Vec3::new(0.5, 0.0, 0.0)]);
        mesh.triangles.extend([[0, 0, 1], [0, 1, 77], [3, 3, 3]]);
        mesh.triangles.extend([[0, 1, 9]; 300]);
        let report = report(&mesh);
        assert_eq!(report.count(Fault::CollapsedTriangle), 2);
        assert_eq!(report.count(Fault::MissingVertex), 1);
        assert_eq!(report.count(Fault::NotFinite), 1);
        assert_eq!(report.count(Fault::UnusedVertex), 1);
        assert_eq!(report.count(Fault::ZeroArea), 300);
        assert_eq!(report.count(Fault::DuplicateTriangle), 299);
        assert_eq!(report.findings().filter(|f| f.fault == Fault::ZeroArea).count(), MOST_PLACES);
        assert!(!Mesh::default().validity(SelfIntersections::Search).is_printable_solid());
    }
}
