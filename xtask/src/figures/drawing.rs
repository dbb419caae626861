//! Shared by the pictures: colours, margins, and their places in the documentation.
//!
//! The colours are Okabe and Ito's, which remain distinct to the colour-blind; polarity is also shown as a direction.

use crate::common::paths;
use anyhow::{Context, Result, ensure};
use plotters::{coord::Shift, prelude::*};
use std::{fs, path::Path};

pub const SIGNAL: RGBColor = RGBColor(165, 165, 165);
pub const DECODED: RGBColor = RGBColor(0, 114, 178);
pub const UP: RGBColor = RGBColor(213, 94, 0);
pub const DOWN: RGBColor = RGBColor(0, 0, 0);
/// Pixels to the left of the curves.
pub const LEFT: i32 = 76;
pub const MARGIN: i32 = 16;
pub const FONT: &str = "sans-serif";

pub type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
pub type Drawn = std::result::Result<(), DrawingAreaErrorKind<std::io::Error>>;

/// Copies a picture into the documentation.
pub fn keep(picture: &Path, page: &str) -> Result<()> {
    fs::copy(picture, paths::root().join(page)).with_context(|| page.to_owned())?;
    println!("{page} has it.");
    Ok(())
}

/// Fails if the documentation has another picture.
pub fn ensure_kept(picture: &Path, page: &str, command: &str) -> Result<()> {
    let kept = fs::read(paths::root().join(page)).with_context(|| page.to_owned())?;
    ensure!(kept == fs::read(picture)?, "{page} is another picture; `{command}` draws it");
    Ok(())
}
