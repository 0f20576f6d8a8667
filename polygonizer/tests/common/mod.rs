//! What the tests share: analytic fields, a referee for meshes, and seeded noise.
#![allow(dead_code, reason = "each test file uses its own part")]

use std::collections::HashMap;

use blobtree::{Aabb, BRICK, BRICK_SAMPLES, Brick, Field, ISO, Interval, Sample, Sampler};
use glam::{Quat, Vec3};
use mesh::Mesh;

/// A signed distance (negative inside, not steeper than 1 per mm) with its gradient.
pub type Distance = Box<dyn Fn(Vec3) -> (f32, Vec3) + Send + Sync>;

/// A field that falls off from a signed distance as the tree's primitives do.
pub struct Solid {
    pub distance: Distance,
    pub bounds: Aabb,
    /// Width of the falloff, mm.
    pub reach: f32,
    pub creased: bool,
}

impl Solid {
    pub fn new(bounds: Aabb, creased: bool, distance: Distance) -> Self {
        Self { distance, bounds, reach: 4.0, creased }
    }

    /// Distance within the falloff at which the value is [`ISO`].
    fn iso_distance(&self) -> f32 {
        self.reach * (1.0 - ISO.cbrt()).sqrt()
    }

    fn falloff(&self, distance: f32) -> (f32, f32) {
        let d = distance + self.iso_distance();
        if d <= 0.0 {
            (1.0, 0.0)
        } else if d >= self.reach {
            (0.0, 0.0)
        } else {
            let u = 1.0 - (d / self.reach).powi(2);
            (u.powi(3), -6.0 * d / self.reach.powi(2) * u * u)
        }
    }

    fn at(&self, p: Vec3) -> Sample {
        let (distance, direction) = (self.distance)(p);
        let (value, slope) = self.falloff(distance);
        Sample { value, gradient: direction * slope, ..Sample::default() }
    }
}

impl Field for Solid {
    fn support(&self) -> Aabb {
        self.bounds.grown(self.reach)
    }

    fn sampler(&self) -> Box<dyn Sampler + '_> {
        Box::new(SolidSampler { solid: self, regions: Vec::new() })
    }
}

struct SolidSampler<'a> {
    solid: &'a Solid,
    regions: Vec<Aabb>,
}

impl SolidSampler<'_> {
    fn check(&self, p: Vec3) {
        if let Some(region) = self.regions.last() {
            assert!(region.contains(p), "{p} is outside {region:?}");
        }
    }
}

impl Sampler for SolidSampler<'_> {
    fn enter(&mut self, region: Aabb) -> Interval {
        if let Some(outer) = self.regions.last() {
            assert!(outer.contains(region.min) && outer.contains(region.max), "{region:?} in {outer:?}");
        }
        self.regions.push(region);
        let (middle, _) = (self.solid.distance)(region.center());
        let radius = 0.5 * region.size().length() * 1.001;
        Interval { lo: self.solid.falloff(middle + radius).0, hi: self.solid.falloff(middle - radius).0 }
    }

    fn leave(&mut self) {
        self.regions.pop().expect("leave matches enter");
    }

    fn creased(&self) -> bool {
        self.solid.creased
    }

    fn fill(&mut self, brick: &Brick, values: &mut [f32; BRICK_SAMPLES]) {
        for (i, value) in values.iter_mut().enumerate() {
            let p = brick.point([i % BRICK, i / BRICK % BRICK, i / BRICK / BRICK]);
            self.check(p);
            *value = self.solid.at(p).value;
        }
    }

    fn values(&mut self, points: &[Vec3], values: &mut [f32]) {
        for (&p, value) in points.iter().zip(values) {
            self.check(p);
            *value = self.solid.at(p).value;
        }
    }

    fn samples(&mut self, points: &[Vec3], samples: &mut [Sample]) {
        for (&p, sample) in points.iter().zip(samples) {
            self.check(p);
            *sample = self.solid.at(p);
        }
    }
}

pub fn ball(center: Vec3, radius: f32) -> Solid {
    let distance = move |p: Vec3| ((p - center).length() - radius, (p - center).normalize_or_zero());
    Solid::new(Aabb::around(center, Vec3::splat(radius)), false, Box::new(distance))
}

/// Ring around z.
pub fn torus(center: Vec3, major: f32, minor: f32) -> Solid {
    let distance = move |p: Vec3| {
        let p = p - center;
        let ring = Vec3::new(p.x, p.y, 0.0).normalize_or_zero() * major;
        ((p - ring).length() - minor, (p - ring).normalize_or_zero())
    };
    let half = Vec3::new(major + minor, major + minor, minor);
    Solid::new(Aabb::around(center, half), false, Box::new(distance))
}

/// The intersection of half-spaces, each a point on its border and its outward unit normal.
pub fn polytope(bounds: Aabb, faces: Vec<(Vec3, Vec3)>) -> Solid {
    let distance = move |p: Vec3| {
        faces
            .iter()
            .map(|&(point, normal)| ((p - point).dot(normal), normal))
            .max_by(|a, b| a.0.total_cmp(&b.0))
            .expect("faces")
    };
    Solid::new(bounds, true, Box::new(distance))
}

/// A box with its middle, turn and half sizes.
#[derive(Clone, Copy, Debug)]
pub struct TurnedBox {
    pub center: Vec3,
    pub turn: Quat,
    pub half: Vec3,
}

impl TurnedBox {
    pub fn corners(&self) -> [Vec3; 8] {
        Aabb::around(Vec3::ZERO, self.half).corners().map(|c| self.center + self.turn * c)
    }

    /// The ends of its edges.
    pub fn edges(&self) -> Vec<[Vec3; 2]> {
        let corners = self.corners();
        let pairs = (0..8).flat_map(|i| (0..3).map(move |a| (i, i | 1 << a)));
        pairs.filter(|(i, j)| i != j).map(|(i, j)| [corners[i], corners[j]]).collect()
    }

    fn bounds(&self) -> Aabb {
        Aabb::of_points(self.corners())
    }

    /// As an intersection of half-spaces: creases reach beyond the solid.
    pub fn as_planes(&self) -> Solid {
        let axes = [Vec3::X, Vec3::Y, Vec3::Z, Vec3::NEG_X, Vec3::NEG_Y, Vec3::NEG_Z];
        let faces = axes.map(|a| (self.center + self.turn * (a * self.half), self.turn * a)).to_vec();
        polytope(self.bounds(), faces)
    }

    /// By true distance: round outside, sharp at the surface.
    pub fn as_distance(&self) -> Solid {
        let Self { center, turn, half } = *self;
        let distance = move |p: Vec3| {
            let p = turn.inverse() * (p - center);
            let q = p.abs() - half;
            let out = q.max(Vec3::ZERO);
            let sign = Vec3::ONE.copysign(p);
            if out.length() > 0.0 {
                (out.length(), turn * (out.normalize_or_zero() * sign))
            } else {
                let axis = (0..3).max_by(|&a, &b| q[a].total_cmp(&q[b])).expect("three axes");
                (q[axis], turn * (Vec3::AXES[axis] * sign))
            }
        };
        Solid::new(self.bounds(), true, Box::new(distance))
    }
}

/// Cylinder around z: a disc swept.
pub fn cylinder(center: Vec3, radius: f32, half_height: f32) -> Solid {
    let distance = move |p: Vec3| {
        let p = p - center;
        let flat = Vec3::new(p.x, p.y, 0.0);
        let side = (flat.length() - radius, flat.normalize_or_zero());
        let cap = (p.z.abs() - half_height, Vec3::Z.copysign(Vec3::splat(p.z)) * Vec3::Z);
        if side.0 > cap.0 { side } else { cap }
    };
    Solid::new(Aabb::around(center, Vec3::new(radius, radius, half_height)), true, Box::new(distance))
}

/// Cone with its apex above its base, around z.
pub fn cone(base: Vec3, radius: f32, height: f32) -> Solid {
    let slant = radius.hypot(height);
    let distance = move |p: Vec3| {
        let p = p - base;
        let flat = Vec3::new(p.x, p.y, 0.0);
        let side = ((flat.length() - radius) * height + p.z * radius) / slant;
        let normal = (flat.normalize_or_zero() * height + Vec3::Z * radius) / slant;
        if side > -p.z { (side, normal) } else { (-p.z, Vec3::NEG_Z) }
    };
    let bounds =
        Aabb { min: base - Vec3::new(radius, radius, 0.0), max: base + Vec3::new(radius, radius, height) };
    Solid::new(bounds, true, Box::new(distance))
}

pub fn union(a: Solid, b: Solid) -> Solid {
    let bounds = a.bounds.union(&b.bounds);
    let distance = move |p: Vec3| {
        let (a, b) = ((a.distance)(p), (b.distance)(p));
        if a.0 < b.0 { a } else { b }
    };
    Solid::new(bounds, true, Box::new(distance))
}

pub fn difference(a: Solid, b: Solid) -> Solid {
    let bounds = a.bounds;
    let distance = move |p: Vec3| {
        let (a, (db, gb)) = ((a.distance)(p), (b.distance)(p));
        if a.0 > -db { a } else { (-db, -gb) }
    };
    Solid::new(bounds, true, Box::new(distance))
}

/// A lattice field without any order: inside or outside by chance, in `size`³ lattice points of 1 mm.
///
/// Linear between nothing: values anywhere else are those of the nearest lattice point.
pub struct Noise {
    pub seed: u64,
    pub size: i32,
    /// Share of the points that are inside.
    pub density: f32,
    pub creased: bool,
}

impl Noise {
    fn at(&self, p: Vec3) -> f32 {
        let index = p.round().as_ivec3();
        if index.cmplt(glam::IVec3::ZERO).any() || index.cmpge(glam::IVec3::splat(self.size)).any() {
            return 0.0;
        }
        let key = index.to_array().iter().fold(self.seed, |k, &i| Random(k ^ i as u64).next());
        let unit = Random(key).unit();
        if unit < self.density { 0.5 + unit } else { 0.4 * unit }
    }
}

impl Field for Noise {
    fn support(&self) -> Aabb {
        Aabb { min: Vec3::splat(-0.5), max: Vec3::splat(self.size as f32 - 0.5) }
    }

    fn sampler(&self) -> Box<dyn Sampler + '_> {
        Box::new(NoiseSampler(self))
    }
}

struct NoiseSampler<'a>(&'a Noise);

impl Sampler for NoiseSampler<'_> {
    fn enter(&mut self, _: Aabb) -> Interval {
        Interval { lo: 0.0, hi: 1.5 }
    }

    fn leave(&mut self) {}

    fn creased(&self) -> bool {
        self.0.creased
    }

    fn fill(&mut self, brick: &Brick, values: &mut [f32; BRICK_SAMPLES]) {
        for (i, value) in values.iter_mut().enumerate() {
            *value = self.0.at(brick.point([i % BRICK, i / BRICK % BRICK, i / BRICK / BRICK]));
        }
    }

    fn values(&mut self, points: &[Vec3], values: &mut [f32]) {
        for (&p, value) in points.iter().zip(values) {
            *value = self.0.at(p);
        }
    }

    fn samples(&mut self, points: &[Vec3], samples: &mut [Sample]) {
        for (&p, sample) in points.iter().zip(samples) {
            let mut random = Random(u64::from(p.x.to_bits()) << 32 | u64::from(p.z.to_bits()));
            let gradient = random.direction() * random.unit();
            *sample = Sample { value: self.0.at(p), gradient, ..Sample::default() };
        }
    }
}

/// A small seeded generator (splitmix64).
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }

    /// From 0 up to 1.
    pub fn unit(&mut self) -> f32 {
        (self.next() >> 40) as f32 / (1_u64 << 24) as f32
    }

    pub fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit()
    }

    pub fn point(&mut self, half: f32) -> Vec3 {
        Vec3::from_array([(); 3].map(|()| self.between(-half, half)))
    }

    pub fn direction(&mut self) -> Vec3 {
        loop {
            let p = self.point(1.0);
            if (0.01..1.0).contains(&p.length()) {
                return p / p.length();
            }
        }
    }

    pub fn turn(&mut self) -> Quat {
        Quat::from_axis_angle(self.direction(), self.between(0.0, std::f32::consts::TAU))
    }
}

/// Panics unless `mesh` is closed, edge- and vertex-manifold, oriented, and every triangle has an area.
pub fn assert_sound(mesh: &Mesh, name: &str) {
    let mut next = HashMap::new();
    for t in &mesh.triangles {
        for i in 0..3 {
            let (a, b, c) = (t[i], t[(i + 1) % 3], t[(i + 2) % 3]);
            assert!(next.insert((a, b), c).is_none(), "{name}: edge {a}-{b} is used twice");
        }
        let [a, b, c] = t.map(|i| mesh.positions[i as usize].as_dvec3());
        let longest = (b - a).length().max((c - b).length()).max((a - c).length());
        let height = (b - a).cross(c - a).length() / longest;
        assert!(height > 0.0, "{name}: triangle {t:?} is flat");
    }
    let mut triangles_of = vec![0_usize; mesh.positions.len()];
    let mut some_edge = vec![None; mesh.positions.len()];
    for &(a, b) in next.keys() {
        assert!(next.contains_key(&(b, a)), "{name}: edge {a}-{b} is open");
        triangles_of[a as usize] += 1;
        some_edge[a as usize] = Some(b);
    }
    for (v, edge) in some_edge.iter().enumerate() {
        let first = edge.unwrap_or_else(|| panic!("{name}: vertex {v} is unused"));
        let (mut at, mut count) = (first, 0);
        loop {
            at = next[&(v as u32, at)];
            count += 1;
            if at == first {
                break;
            }
        }
        assert_eq!(count, triangles_of[v], "{name}: vertex {v} joins several fans");
    }
}

pub fn volume(mesh: &Mesh) -> f64 {
    let p = |i: u32| mesh.positions[i as usize].as_dvec3();
    mesh.triangles.iter().map(|t| p(t[0]).dot(p(t[1]).cross(p(t[2]))) / 6.0).sum()
}

pub fn area(mesh: &Mesh) -> f64 {
    let p = |i: u32| mesh.positions[i as usize].as_dvec3();
    mesh.triangles.iter().map(|t| (p(t[1]) - p(t[0])).cross(p(t[2]) - p(t[0])).length() / 2.0).sum()
}

/// Distance from a point to a triangle (Ericson, *Real-Time Collision Detection*, 5.1.5).
pub fn distance_to_triangle(p: Vec3, [a, b, c]: [Vec3; 3]) -> f32 {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    let (bp, cp) = (p - b, p - c);
    let (d3, d4, d5, d6) = (ab.dot(bp), ac.dot(bp), ab.dot(cp), ac.dot(cp));
    let (va, vb, vc) = (d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2);
    let nearest = if d1 <= 0.0 && d2 <= 0.0 {
        a
    } else if d3 >= 0.0 && d4 <= d3 {
        b
    } else if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        a + ab * (d1 / (d1 - d3))
    } else if d6 >= 0.0 && d5 <= d6 {
        c
    } else if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        a + ac * (d2 / (d2 - d6))
    } else if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)))
    } else {
        a + ab * (vb / (va + vb + vc)) + ac * (vc / (va + vb + vc))
    };
    p.distance(nearest)
}

/// Distance from a point to a mesh, by trying all triangles.
pub fn distance_to_mesh(p: Vec3, mesh: &Mesh) -> f32 {
    let corners = |t: &[u32; 3]| t.map(|i| mesh.positions[i as usize]);
    mesh.triangles.iter().map(|t| distance_to_triangle(p, corners(t))).fold(f32::INFINITY, f32::min)
}
