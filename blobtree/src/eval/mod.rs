//! Evaluation: a tree compiled to a program, specialised to regions, run over batches of places.
//!
//! [`Tree`] is the [`Field`](crate::Field) of a node. Its sampler narrows the program from coarse to fine
//! regions (`specialise`), runs it for values over bricks or clouds of points (`values`), for values with
//! gradients (`slopes`), and one point at a time with any kind of number (`point`).

mod cached;
mod loops;
mod places;
mod point;
mod program;
mod sampler;
mod scratch;
mod slopes;
mod specialise;
mod values;
mod warped;

pub use program::{Tree, support};
pub(crate) use program::{warp_map, warped_region};
pub(crate) use sampler::TreeSampler;
pub(crate) use specialise::Crease;
