//! Mesh files from outside: round trips, what other programs write, and what is broken.

mod broken;
mod cracks;
mod roundtrip;
mod support;
mod text;
mod threemf;
