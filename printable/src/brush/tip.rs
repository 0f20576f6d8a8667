//! What a brush puts down: a solid of any shape, in voxels.

use super::Dab;
use crate::GridShape;
use crate::voxels::{Bits, for_width, run_of_bits};
use blobtree::{Aabb, Field, ISO};
use glam::Vec3;
use std::ops::Range;
use std::sync::Arc;

/// The shape of a brush, of radius 1 around the origin; a dab scales and moves it.
#[derive(Clone)]
pub enum Tip {
    /// A ball.
    Ball,
    /// A cube with sides along the axes; half its width is the radius.
    Cube,
    /// An upright cylinder, as high as it is wide.
    Cylinder,
    /// Any solid: where the field is at least 0.5. A millimetre in the field is a radius.
    Solid(Arc<dyn Field>),
}

impl std::fmt::Debug for Tip {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Ball => "Ball",
            Self::Cube => "Cube",
            Self::Cylinder => "Cylinder",
            Self::Solid(_) => "Solid",
        })
    }
}

impl Tip {
    /// The voxels of a grid whose centres lie in the tip, its surface included.
    pub(super) fn stamp(&self, dab: &Dab, shape: &GridShape) -> Bits {
        let mut bits = Bits::new(shape.voxels());
        match self {
            Self::Ball => stamp_runs(&mut bits, dab, shape, |y, z| (1.0 - y * y - z * z).sqrt()),
            Self::Cube => stamp_runs(&mut bits, dab, shape, |y, z| box_run(y.abs().max(z.abs()))),
            Self::Cylinder => stamp_runs(&mut bits, dab, shape, |y, z| {
                if z.abs() <= 1.0 { (1.0 - y * y).sqrt() } else { f32::NAN }
            }),
            Self::Solid(field) => stamp_field(&mut bits, dab, shape, &**field),
        }
        bits
    }
}

/// Half the width of the unit box, where the farthest coordinate is `other`.
fn box_run(other: f32) -> f32 {
    if other <= 1.0 { 1.0 } else { f32::NAN }
}

/// The voxels along one axis whose centres lie within `half` of `middle`, all in voxels; none if `half` is no number.
fn centers_within(middle: f32, half: f32, count: usize) -> Range<usize> {
    if half.is_nan() || half < 0.0 {
        return 0..0;
    }
    let first = (middle - half - 0.5).ceil().max(0.0);
    let end = ((middle + half - 0.5).floor() + 1.0).min(count as f32);
    if first < end { first as usize..end as usize } else { 0..0 }
}

/// Sets a run of voxels in each row: `half_width(y, z)` is half its width, or not a number, all in radii.
fn stamp_runs(bits: &mut Bits, dab: &Dab, shape: &GridShape, half_width: impl Fn(f32, f32) -> f32) {
    let [nx, ny, nz] = shape.voxels();
    let middle = shape.in_voxels(dab.center());
    let wide = dab.radius() / shape.size().width();
    let high = dab.radius() / shape.size().height();
    let rows = centers_within(middle.y, wide, ny);
    for z in centers_within(middle.z, high, nz) {
        let up = (z as f32 + 0.5 - middle.z) / high;
        for_width!(bits.words, W => {
            let layer = &mut bits.layers[z];
            layer.keep::<W>(rows.clone());
            let (first, kept) = layer.rows_mut::<W>();
            for (n, row) in kept.iter_mut().enumerate() {
                let along = ((first + n) as f32 + 0.5 - middle.y) / wide;
                let run = centers_within(middle.x, half_width(along, up) * wide, nx);
                *row = run_of_bits(run.start, run.end);
            }
        });
    }
}

/// Sets the voxels whose centres lie in a field's solid.
fn stamp_field(bits: &mut Bits, dab: &Dab, shape: &GridShape, field: &dyn Field) {
    let support = field.support();
    if support.is_empty() {
        return;
    }
    let corner = |p: Vec3| shape.in_voxels(dab.center() + p * dab.radius());
    let reach = Aabb { min: corner(support.min), max: corner(support.max) };
    let along = |axis: usize| {
        let (middle, half) = (reach.center()[axis], reach.size()[axis] / 2.0);
        centers_within(middle, half, shape.voxels()[axis])
    };
    let (columns, rows) = (along(0), along(1));
    let mut sampler = field.sampler();
    sampler.enter(support);
    let (mut places, mut values) = (Vec::new(), vec![0.0; columns.len()]);
    for z in along(2) {
        for y in rows.clone() {
            places.clear();
            let place = |x: usize| (shape.center([x, y, z]) - dab.center()) / dab.radius();
            places.extend(columns.clone().map(|x| place(x).clamp(support.min, support.max)));
            sampler.values(&places, &mut values);
            for (x, _) in columns.clone().zip(&values).filter(|&(_, &value)| value >= ISO) {
                bits.set([x, y, z], true);
            }
        }
    }
}
