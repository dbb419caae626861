//! Draws the title of a panel.

use super::FONT;
use super::palette::{DECODED, INK, QUIET, SIGNAL};
use plotters::coord::Shift;
use plotters::prelude::*;

pub(super) type Drawn<B> = Result<(), DrawingAreaErrorKind<<B as DrawingBackend>::ErrorType>>;

/// Height of a panel's title with its details, in pixels.
pub(super) const TITLE: u32 = 52;

/// Draws the title of a panel, with the panel's letter in front. Below the title, draws up to two lines of details in
/// small print.
pub(super) fn title<B: DrawingBackend>(
    area: &DrawingArea<B, Shift>,
    letter: Option<char>,
    text: &str,
    details: &[String],
) -> Drawn<B> {
    let bold = (FONT, 19).into_font().style(FontStyle::Bold).color(&INK);
    let plain = (FONT, 16).into_font().color(&INK);
    let small = (FONT, 12).into_font().color(&QUIET);
    let mut left = 14;
    if let Some(letter) = letter {
        area.draw(&Text::new(letter.to_string(), (left, 5), bold))?;
        left += 24;
    }
    area.draw(&Text::new(text.to_owned(), (left, 7), plain))?;
    for (top, line) in [25, 38].into_iter().zip(details) {
        area.draw(&Text::new(line.clone(), (left, top), small.clone()))?;
    }
    Ok(())
}

/// Draws the legend, which shows the colours of the signal and of the decoded values. The legend stands above the
/// curves, to the right of the title.
pub(super) fn legend<B: DrawingBackend>(area: &DrawingArea<B, Shift>) -> Drawn<B> {
    let width = area.dim_in_pixel().0 as i32;
    let small = (FONT, 13).into_font().color(&INK);
    for (label, colour, left) in [("signal", SIGNAL, width - 176), ("decoded", DECODED, width - 96)]
    {
        area.draw(&PathElement::new([(left, 14), (left + 18, 14)], colour.stroke_width(2)))?;
        area.draw(&Text::new(label, (left + 24, 8), small.clone()))?;
    }
    Ok(())
}
