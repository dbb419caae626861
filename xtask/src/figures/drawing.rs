//! What the pictures share: colours, margins, and the legend of a signal, its spikes and what they decode to.
//!
//! The colours are Okabe and Ito's, which colour-blind people tell apart; polarity is also a direction.

use crate::common::paths;
use anyhow::{Context, Result};
use plotters::{coord::Shift, prelude::*};
use std::{fs, path::Path};

pub const SIGNAL: RGBColor = RGBColor(165, 165, 165);
pub const DECODED: RGBColor = RGBColor(0, 114, 178);
pub const UP: RGBColor = RGBColor(213, 94, 0);
pub const DOWN: RGBColor = RGBColor(0, 0, 0);
/// Pixels beside the curves.
pub const LEFT: i32 = 76;
pub const MARGIN: i32 = 16;
pub const FONT: &str = "sans-serif";

pub type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
pub type Drawn = std::result::Result<(), DrawingAreaErrorKind<std::io::Error>>;

/// The last line of a heading of 100 pixels.
pub fn legend(area: &Area) -> Drawn {
    let style = (FONT, 16).into_text_style(area);
    for (x, label, colour, width) in
        [(LEFT, "signal", SIGNAL, 4), (LEFT + 120, "decoded from the spikes", DECODED, 2)]
    {
        area.draw(&PathElement::new([(x, 83), (x + 32, 83)], colour.stroke_width(width)))?;
        area.draw_text(label, &style, (x + 40, 76))?;
    }
    for (x, label, colour) in [(LEFT + 365, "spike up", UP), (LEFT + 480, "spike down", DOWN)] {
        area.draw(&PathElement::new([(x, 76), (x, 91)], colour.stroke_width(2)))?;
        area.draw_text(label, &style, (x + 10, 76))?;
    }
    Ok(())
}

/// Puts a picture into the pages.
pub fn keep(picture: &Path, page: &str) -> Result<()> {
    fs::copy(picture, paths::root().join(page)).with_context(|| page.to_owned())?;
    println!("{page} has it.");
    Ok(())
}
