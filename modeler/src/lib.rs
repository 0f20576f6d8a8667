//! The modeler without its window: what is on the table, what the hand and the pen do, and the panels around it.
//!
//! It draws on egui alone, so all of it can be tested without a screen or a graphics card. Two things come from the
//! program around it: a [`desk::Desk`], which opens and writes files, and a [`stage::Stage`], which draws triangles.
//!
//! The way of the data, in each frame: what the background threads have made is taken in; keys, panels and the hand
//! in the view do things to the [`workbench::Workbench`], whose every step is in the [`journal`] first; what has
//! changed is asked of the background threads, [`solid`] for the surface and [`expecting`] for the sketch; files are read
//! and written in an [`errand`]. The frame itself waits for none of them.

mod brought;
pub mod camera;
pub mod cutting;
pub mod desk;
pub mod dialog;
pub mod errand;
pub mod expecting;
mod extent;
pub mod form;
mod ground;
mod help;
pub mod journal;
pub mod kept;
pub mod keys;
mod known;
pub mod lens;
pub mod lesson;
mod lowest;
mod meshes;
mod modeler;
mod newest;
pub mod notices;
pub mod pad;
mod panels;
pub mod pen;
pub mod placing;
mod pointing;
mod portraits;
pub mod seams;
pub mod settings;
pub mod several;
pub mod solid;
pub mod stage;
mod theme;
pub mod thumbnail;
pub mod trace;
pub mod variants;
mod view;
pub mod workbench;

pub use modeler::{Fetched, How, Modeler, Newcomer};
