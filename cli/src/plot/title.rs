//! What stands over every panel.

use super::FONT;
use super::palette::INK;
use plotters::coord::Shift;
use plotters::prelude::*;

pub(super) type Drawn<B> = Result<(), DrawingAreaErrorKind<<B as DrawingBackend>::ErrorType>>;

/// Its height.
pub(super) const TITLE: u32 = 34;

/// The title of a panel, behind its letter.
pub(super) fn title<B: DrawingBackend>(
    area: &DrawingArea<B, Shift>,
    letter: Option<char>,
    text: &str,
) -> Drawn<B> {
    let bold = (FONT, 19).into_font().style(FontStyle::Bold).color(&INK);
    let plain = (FONT, 16).into_font().color(&INK);
    let mut left = 14;
    if let Some(letter) = letter {
        area.draw(&Text::new(letter.to_string(), (left, 9), bold))?;
        left += 24;
    }
    area.draw(&Text::new(text.to_owned(), (left, 11), plain))
}
