//! `trullo slice`.

use super::values::{layer_height, length};
use super::{Bed, Common, ShapeArgs};
use clap::{Args, ValueEnum};
use printable::LayerHeight;
use std::path::PathBuf;

/// `trullo slice`.
#[derive(Debug, Args)]
pub struct SliceArgs {
    /// The mesh or scene to slice.
    pub input: PathBuf,
    /// The .svg file or the folder to write. A folder must be new or empty.
    #[arg(short, long, value_name = "DIR|FILE.svg")]
    pub output: PathBuf,
    /// Height of a layer, mm.
    #[arg(long, value_name = "MM", default_value = "0.25", value_parser = layer_height)]
    pub layer_height: LayerHeight,
    /// Where the first layer begins.
    #[arg(long, value_enum, default_value_t)]
    pub bed: Bed,
    /// What the files in a folder are.
    #[arg(long = "as", value_name = "KIND", value_enum, default_value_t)]
    pub kind: LayerKind,
    /// How wide a pixel of a PNG file is, mm.
    #[arg(long, value_name = "MM", default_value = "0.1", value_parser = length)]
    pub pixel: f64,
    #[command(flatten)]
    pub shape: ShapeArgs,
    #[command(flatten)]
    pub common: Common,
}

/// What the files of layers are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum LayerKind {
    /// Outlines in mm.
    #[default]
    Svg,
    /// Pictures, white where the layer is solid.
    Png,
}
