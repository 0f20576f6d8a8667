//! `trullo render`.

use super::values::{color, picture_size};
use super::{Common, ConstraintArgs, ReadingArgs};
use clap::Args;
use std::path::PathBuf;

/// `trullo render`.
#[derive(Debug, Args)]
pub struct RenderArgs {
    /// The scene or mesh to draw.
    pub input: PathBuf,
    /// The picture to write, a .png file.
    #[arg(short, long, value_name = "OUT.png")]
    pub output: PathBuf,
    /// From where to look: `iso`, `front`, `back`, `left`, `right`, `top`, `bottom`, or AZIMUTH,ELEVATION in
    /// degrees, where 0,0 is the front and 90,0 the right.
    #[arg(long, default_value = "iso", allow_hyphen_values = true, value_parser = crate::render::View::parse)]
    pub view: crate::render::View,
    /// The size of the picture in pixels, each side 16 to 4096, at most 8 million in all.
    #[arg(long, value_name = "WxH", default_value = "1200x900", value_parser = picture_size)]
    pub size: [u32; 2],
    /// The colour behind everything, `#rrggbb`; a soft grey if not given.
    #[arg(long, value_name = "COLOUR", value_parser = color)]
    pub background: Option<blobtree::Color>,
    #[command(flatten)]
    pub reading: ReadingArgs,
    #[command(flatten)]
    pub constraint: ConstraintArgs,
    #[command(flatten)]
    pub common: Common,
}
