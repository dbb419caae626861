//! Pictures of trials, as SVG or PNG.

mod bitmap;
mod efficiencies;
mod layout;
mod palette;
mod panel;
mod thin;
mod title;

use crate::trial::{Recording, Trial};
use anyhow::{Context, Result, anyhow, bail};
use bitmap::Bitmap;
use plotters::prelude::*;
use plotters::style::{FontStyle, register_font};
use std::io::Write;
use std::ops::Range;
use std::path::Path;
use tiny_skia::{Color, Pixmap};

use crate::output::Output;

/// What is drawn.
pub(crate) struct Picture<'a> {
    /// The signal.
    pub recording: &'a Recording,
    /// One panel each.
    pub trials: &'a [Trial],
    /// The unit of the signal, if it is known.
    pub unit: Option<&'a str>,
    /// The samples to show.
    pub shown: Range<usize>,
}

/// The name that the embedded font goes by. In an SVG the viewer takes its own of that kind.
const FONT: &str = "sans-serif";

/// Draws into a file, by its ending.
///
/// # Errors
/// The ending is neither `.svg` nor `.png`, or the file cannot be written or is the input.
pub(crate) fn draw(path: &Path, input: &Path, picture: &Picture) -> Result<()> {
    for style in [FontStyle::Normal, FontStyle::Bold] {
        register_font(FONT, style, epaint_default_fonts::UBUNTU_LIGHT)
            .map_err(|_| anyhow!("the font does not load"))?;
    }
    let size = layout::size(picture);
    let bytes = match path.extension().and_then(|extension| extension.to_str()) {
        Some("svg") => {
            let mut text = String::new();
            fill(&SVGBackend::with_string(&mut text, size).into_drawing_area(), picture)?;
            // As in PNG: a bend does not stick out beyond the data.
            text.replacen("<svg ", "<svg stroke-linejoin=\"round\" ", 1).into_bytes()
        }
        Some("png") => png(size, picture)?,
        _ => bail!("{}: a picture ends in .svg or .png", path.display()),
    };
    let mut output = Output::open(Some(path), input)?;
    output.write_all(&bytes)?;
    output.finish()
}

fn png((width, height): (u32, u32), picture: &Picture) -> Result<Vec<u8>> {
    let mut pixels = Pixmap::new(width, height).context("the picture has no size")?;
    pixels.fill(Color::WHITE);
    fill(&Bitmap::new(&mut pixels).into_drawing_area(), picture)?;
    Ok(pixels.encode_png()?)
}

fn fill<B: DrawingBackend>(
    area: &DrawingArea<B, plotters::coord::Shift>,
    picture: &Picture,
) -> Result<()> {
    let drawn = layout::fill(area, picture).and_then(|()| area.present());
    drawn.map_err(|error| anyhow!("the picture cannot be drawn: {error}"))
}
