//! What sketched primitives are made of: the drawing that the user keeps, and the template solved from it.

mod drawing;
mod field_image;
mod plane;
mod primitives;
mod template;

pub use drawing::{Drawing, DrawnPoint, DrawnStroke, Holes};
pub use field_image::FieldImage;
pub(crate) use field_image::{Reading, Rectangle};
pub use plane::SketchPlane;
pub use primitives::{Inflation, LinearSweep, PathSweep, Profile, Revolution, RevolutionAxis, Side};
pub use template::{Solved, Template};
