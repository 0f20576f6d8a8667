//! The implicit tree.

mod field;

pub use field::{Aabb, BRICK, BRICK_SAMPLES, Brick, Field, ISO, Interval, Sample, Sampler};
