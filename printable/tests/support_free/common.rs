//! Scenes, and short referees.

use blobtree::build::{Build, cuboid, cylinder, point};
use blobtree::{BakeStore, Field, ISO, Node, NodeRef, SupportFree, SupportMode, Tree};
use glam::{Vec2, Vec3};
use printable::Rebaker;

/// A rule that trims.
pub fn trimming(overhang_degrees: f32, layer_height: f32) -> SupportFree {
    SupportFree { overhang_degrees, layer_height, ..SupportFree::default() }
}

/// A rule that grows.
pub fn growing(overhang_degrees: f32, layer_height: f32) -> SupportFree {
    SupportFree { mode: SupportMode::Grow, ..trimming(overhang_degrees, layer_height) }
}

/// A node made support-free, with its bakes.
pub fn baked(node: impl Into<NodeRef>, rule: SupportFree) -> (NodeRef, BakeStore) {
    let root: NodeRef = node.into().support_free(rule).into();
    let mut store = BakeStore::new();
    store.bake(&root, &Rebaker::new()).expect("it can be baked");
    (root, store)
}

/// The same, compiled.
pub fn constrained(node: impl Into<NodeRef>, rule: SupportFree) -> Tree {
    let (root, store) = baked(node, rule);
    store.compile(&root)
}

/// A post of 4 × 4 × 20 mm with a bar of 24 mm on its top, 4 mm thick.
pub fn letter_t() -> NodeRef {
    cuboid([0., 0., 8.], [4., 4., 16.]).union(cuboid([0., 0., 18.], [24., 4., 4.])).into()
}

/// A ball that stands on a stem: the trimmed ball is a cone from where the stem meets it.
pub fn ball_on_stem(stem: f32, ball: f32) -> Node {
    cylinder([0., 0., 0.], [0., 0., 12.], stem).union(point([0., 0., middle(ball)], ball))
}

fn middle(ball: f32) -> f32 {
    9.0 + ball
}

/// Where the ball comes out of the stem.
pub fn junction(stem: f32, ball: f32) -> f32 {
    middle(ball) - (ball * ball - stem * stem).sqrt()
}

/// How far a field is solid from the z axis, in this direction at this height, mm.
pub fn radius(tree: &Tree, direction: Vec2, z: f32, most: f32) -> f32 {
    let inside = |r: f32| tree.value((direction * r).extend(z)) >= ISO;
    assert!(inside(0.0) && !inside(most), "between 0 and {most} at {z}");
    let (mut lo, mut hi) = (0.0, most);
    for _ in 0..30 {
        let middle = 0.5 * (lo + hi);
        if inside(middle) { lo = middle } else { hi = middle }
    }
    lo
}

/// Slices of a field as squares of solid places, from the bed up.
pub struct Slices {
    pub pitch: f32,
    pub side: usize,
    pub layers: Vec<Vec<bool>>,
}

impl Slices {
    /// Slices at `offset` above the bed and every `layer_height` above, of all within `half` of the z axis.
    pub fn new(tree: &Tree, layer_height: f32, offset: f32, half: f32, top: f32, pitch: f32) -> Self {
        let side = (2.0 * half / pitch) as usize;
        let layers = (0..).map(|k| offset + k as f32 * layer_height).take_while(|z| *z < top);
        let mut sampler = tree.sampler();
        let layers = layers.map(|z| {
            let place = |i: usize| {
                let at = Vec2::new((i % side) as f32, (i / side) as f32) * pitch - half;
                at.extend(z)
            };
            let places: Vec<Vec3> = (0..side * side).map(place).collect();
            let mut values = vec![0.0; places.len()];
            sampler.values(&places, &mut values);
            values.iter().map(|value| *value >= ISO).collect()
        });
        Self { pitch, side, layers: layers.collect() }
    }

    /// Area that lies farther than `reach` from the layer below: the most in one layer, mm².
    pub fn unsupported(&self, reach: f32) -> f32 {
        let pairs = self.layers.windows(2);
        pairs.map(|pair| self.unsupported_in(&pair[0], &pair[1], reach)).fold(0.0, f32::max)
    }

    fn unsupported_in(&self, below: &[bool], above: &[bool], reach: f32) -> f32 {
        let steps = (reach / self.pitch).ceil() as isize;
        let side = self.side as isize;
        let carried = |i: usize| {
            let (x, y) = (i as isize % side, i as isize / side);
            (-steps..=steps).any(|dy| {
                (-steps..=steps).any(|dx| {
                    let (x, y) = (x + dx, y + dy);
                    let within = ((dx * dx + dy * dy) as f32).sqrt() * self.pitch <= reach;
                    within
                        && (0..side).contains(&x)
                        && (0..side).contains(&y)
                        && below[(x + y * side) as usize]
                })
            })
        };
        let hanging = (0..above.len()).filter(|i| above[*i] && !below[*i] && !carried(*i)).count();
        hanging as f32 * self.pitch * self.pitch
    }
}
