//! Pictures of trials, as SVG or PNG.

mod efficiencies;
mod layout;
mod palette;
mod panel;
mod title;

use crate::trial::{Recording, Trial};
use anyhow::{Result, anyhow, bail};
use plotters::prelude::*;
use plotters::style::{FontStyle, register_font};
use std::fs;
use std::io::Write;
use std::ops::Range;
use std::path::Path;

use crate::output::Output;

/// What is drawn.
pub(crate) struct Picture<'a> {
    /// The signal.
    pub recording: &'a Recording,
    /// One panel each.
    pub trials: &'a [Trial],
    /// The samples to show.
    pub shown: Range<usize>,
}

/// The name that the embedded font goes by. In an SVG the viewer takes its own of that kind.
const FONT: &str = "sans-serif";

/// Draws into a file, by its ending.
///
/// # Errors
/// The ending is neither `.svg` nor `.png`, or the file cannot be written.
pub(crate) fn draw(path: &Path, picture: &Picture) -> Result<()> {
    for style in [FontStyle::Normal, FontStyle::Bold] {
        register_font(FONT, style, epaint_default_fonts::UBUNTU_LIGHT)
            .map_err(|_| anyhow!("the font does not load"))?;
    }
    let size = layout::size(picture);
    let bytes = match path.extension().and_then(|extension| extension.to_str()) {
        Some("svg") => {
            let mut text = String::new();
            fill(&SVGBackend::with_string(&mut text, size).into_drawing_area(), picture)?;
            text.into_bytes()
        }
        Some("png") => png(size, picture)?,
        _ => bail!("{}: a picture ends in .svg or .png", path.display()),
    };
    let mut output = Output::open(Some(path))?;
    output.write_all(&bytes)?;
    output.finish()
}

/// The encoder of the bitmap backend writes files only.
fn png(size: (u32, u32), picture: &Picture) -> Result<Vec<u8>> {
    let file = tempfile::Builder::new().suffix(".png").tempfile()?;
    fill(&BitMapBackend::new(file.path(), size).into_drawing_area(), picture)?;
    Ok(fs::read(file.path())?)
}

fn fill<B: DrawingBackend>(
    area: &DrawingArea<B, plotters::coord::Shift>,
    picture: &Picture,
) -> Result<()> {
    let drawn = layout::fill(area, picture).and_then(|()| area.present());
    drawn.map_err(|error| anyhow!("the picture cannot be drawn: {error}"))
}
