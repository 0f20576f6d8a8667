//! Prints the scene `examples/forest.trullo`: a wood of 40 trees, made of 1,000 blobs.
//!
//! ```text
//! cargo run -p blobtree --example forest > examples/forest.trullo
//! ```
//!
//! Each tree is a part of its own: a sum of blobs, so that they melt into each other, but not into the next
//! tree. Five groves of eight trees each stand side by side.

use blobtree::build::*;
use blobtree::{Node, Scene, SceneError};
use fastrand::Rng;

const GROVES: usize = 5;
const TREES_IN_A_GROVE: usize = 8;
const TRUNK_BLOBS: usize = 5;
const CROWN_BLOBS: usize = 20;

/// Distance between neighbouring trees, mm.
const SPACING: f32 = 15.0;

/// How far the blobs' influence reaches, mm: enough to close the gaps, too little to swell.
const FALLOFF: f32 = 1.2;

fn main() -> Result<(), SceneError> {
    let mut rng = Rng::with_seed(1907);
    let groves = (0..GROVES).map(|grove| {
        let trees = (0..TREES_IN_A_GROVE).map(|number| {
            let x = SPACING * (number as f32 - (TREES_IN_A_GROVE - 1) as f32 / 2.0) + jitter(&mut rng, 2.0);
            let y = SPACING * (grove as f32 - (GROVES - 1) as f32 / 2.0) + jitter(&mut rng, 2.0);
            tree(&mut rng, x, y).named(format!("tree {}", grove * TREES_IN_A_GROVE + number + 1))
        });
        union(trees.collect::<Vec<_>>()).named(format!("grove {}", grove + 1))
    });
    let wood = union(groves.collect::<Vec<_>>()).named("wood");
    let ground = half_space([0., 0., 0.], [0., 0., 1.]).named("below the bed");
    let scene = Scene::new(wood.subtract(ground)).titled("Forest of a thousand blobs");
    print!("{}", scene.to_text()?);
    Ok(())
}

/// A tree with its foot at this place on the bed, 20 to 35 mm high.
fn tree(rng: &mut Rng, x: f32, y: f32) -> Node {
    let height = 20.0 + 12.0 * rng.f32();
    let is_fir = rng.bool();
    let trunk_top = if is_fir { 0.3 } else { 0.5 } * height;
    let lean = jitter(rng, 1.0);
    let trunk = (0..TRUNK_BLOBS).map(|i| {
        let t = i as f32 / (TRUNK_BLOBS - 1) as f32;
        blob([x + lean * t, y, 1.0 + trunk_top * t], 2.2 - 0.6 * t)
    });
    let trunk = sum(trunk.collect::<Vec<_>>()).named("trunk").colored("#7a5230");
    let crown: Vec<Node> = (0..CROWN_BLOBS)
        .map(|i| {
            // From the bottom up, each blob a golden angle further round.
            let t = (i as f32 + 0.5) / CROWN_BLOBS as f32;
            let angle = 2.399_963 * i as f32;
            let width = if is_fir { 4.2 * (1.0 - t) } else { 4.0 * (1.0 - (2.0 * t - 1.0).powi(2)).sqrt() };
            let z = trunk_top + (height - trunk_top) * t;
            let radius = if is_fir { 2.8 - 1.4 * t } else { 2.6 } + jitter(rng, 0.3);
            blob([x + lean + width * angle.cos(), y + width * angle.sin(), z], radius)
        })
        .collect();
    let greens = if is_fir { ["#1f5f3f", "#2c6e49", "#245c3c"] } else { ["#6aa84f", "#88b04b", "#a3b83c"] };
    let crown = sum(crown).named("crown").colored(greens[rng.usize(..greens.len())]);
    sum([trunk, crown])
}

/// A blob with its numbers rounded to hundredths, so that the file stays readable.
fn blob(center: [f32; 3], radius: f32) -> Node {
    let rounded = |v: f32| (v * 100.0).round() / 100.0;
    point(center.map(rounded), rounded(radius)).with_falloff(FALLOFF)
}

/// A number between `-most` and `most`.
fn jitter(rng: &mut Rng, most: f32) -> f32 {
    most * (2.0 * rng.f32() - 1.0)
}
