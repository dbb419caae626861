//! Draws trials and Pareto fronts, as SVG or PNG.

mod bitmap;
mod decimate;
mod efficiencies;
pub mod front;
mod layout;
mod palette;
mod panel;
mod picture;
mod title;

use crate::error::At;
use crate::output::OutputKind;
use crate::{Error, Result};
use bitmap::Bitmap;
use plotters::prelude::*;
use plotters::style::{FontStyle, register_font};
use std::io::Write;
use std::path::Path;
use tiny_skia::{Color, Pixmap};

use crate::output::Output;

pub use picture::{Picture, Read, read};

/// Name of the embedded font. In an SVG, the viewer's own sans-serif font takes its place.
const FONT: &str = "sans-serif";

/// Draws trials to a file, as SVG or PNG by the file's ending.
///
/// # Errors
/// Returns an error if the ending is neither `.svg` nor `.png`, if the file cannot be written, or if the file is the
/// input.
pub fn draw(path: &Path, input: &Path, picture: &Picture) -> Result<()> {
    write(path, input, layout::size(picture), Drawing::Trials(picture))
}

/// Draws Pareto fronts to a file, as SVG or PNG by the file's ending.
///
/// # Errors
/// See [`draw`].
pub fn draw_fronts(path: &Path, input: &Path, panels: &[front::Panel]) -> Result<()> {
    write(path, input, layout::fronts_size(panels), Drawing::Fronts(panels))
}

/// The trials or the Pareto fronts to draw.
#[derive(Clone, Copy)]
enum Drawing<'a> {
    Trials(&'a Picture),
    Fronts(&'a [front::Panel]),
}

fn write(path: &Path, input: &Path, size: (u32, u32), drawing: Drawing) -> Result<()> {
    let ending = path.extension().and_then(|extension| extension.to_str());
    let bytes = drawn(ending.unwrap_or_default(), size, drawing).at(|| path)?;
    let mut output = Output::open(Some(path), input)?;
    output.write_all(&bytes)?;
    output.finish()
}

/// Returns a picture of trials as the bytes of an SVG or PNG file. `ending` is `svg` or `png`.
///
/// # Errors
/// Returns an error if the ending is neither `svg` nor `png`.
pub fn bytes(ending: &str, picture: &Picture) -> Result<Vec<u8>> {
    drawn(ending, layout::size(picture), Drawing::Trials(picture))
}

fn drawn(ending: &str, size: (u32, u32), drawing: Drawing) -> Result<Vec<u8>> {
    for style in [FontStyle::Normal, FontStyle::Bold] {
        register_font(FONT, style, epaint_default_fonts::UBUNTU_LIGHT)
            .map_err(|_| OutputKind::NoFont)?;
    }
    match ending {
        "svg" => {
            let mut text = String::new();
            fill(&SVGBackend::with_string(&mut text, size).into_drawing_area(), drawing)?;
            // Round joins, as in PNG: a sharp join would stick out beyond the data.
            Ok(text.replacen("<svg ", "<svg stroke-linejoin=\"round\" ", 1).into_bytes())
        }
        "png" => png(size, drawing),
        _ => Err(OutputKind::PictureEnding.into()),
    }
}

fn png((width, height): (u32, u32), drawing: Drawing) -> Result<Vec<u8>> {
    let mut pixels = Pixmap::new(width, height).ok_or(OutputKind::NoSize)?;
    pixels.fill(Color::WHITE);
    fill(&Bitmap::new(&mut pixels).into_drawing_area(), drawing)?;
    pixels.encode_png().map_err(Error::other)
}

fn fill<B: DrawingBackend>(
    area: &DrawingArea<B, plotters::coord::Shift>,
    drawing: Drawing,
) -> Result<()> {
    let filled = match drawing {
        Drawing::Trials(picture) => layout::fill(area, picture),
        Drawing::Fronts(panels) => layout::fill_fronts(area, panels),
    };
    let drawn = filled.and_then(|()| area.present());
    drawn.map_err(|error| OutputKind::NotDrawn { why: error.to_string() }.into())
}
