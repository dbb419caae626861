//! Where the panels are.

use super::palette::INK;
use super::{FONT, Picture, panel};
use plotters::coord::Shift;
use plotters::prelude::*;

pub(super) type Drawn<B> = Result<(), DrawingAreaErrorKind<<B as DrawingBackend>::ErrorType>>;

const SINGLE: (u32, u32) = (960, 480);
const PANEL: (u32, u32) = (620, 330);
const COLUMNS: usize = 2;

/// The picture's width and height.
pub(super) fn size(picture: &Picture) -> (u32, u32) {
    if picture.trials.len() == 1 {
        return SINGLE;
    }
    let rows = (picture.trials.len() + 1).div_ceil(COLUMNS) as u32;
    (PANEL.0 * COLUMNS as u32, PANEL.1 * rows)
}

/// One trial alone, or all in a grid with the efficiencies last.
pub(super) fn fill<B: DrawingBackend>(area: &DrawingArea<B, Shift>, picture: &Picture) -> Drawn<B> {
    area.fill(&WHITE)?;
    if let [trial] = picture.trials {
        return panel::trial(area, picture, trial, None);
    }
    let rows = (picture.trials.len() + 1).div_ceil(COLUMNS);
    let areas = area.split_evenly((rows, COLUMNS));
    for ((area, trial), letter) in areas.iter().zip(picture.trials).zip('A'..) {
        panel::trial(area, picture, trial, Some(letter))?;
    }
    match areas.get(picture.trials.len()) {
        Some(last) => panel::efficiencies(last, picture.trials, 'H'),
        None => Ok(()),
    }
}

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
