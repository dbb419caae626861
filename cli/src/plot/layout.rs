//! Where the panels are.

use super::title::Drawn;
use super::{Picture, efficiencies, front, panel};
use plotters::coord::Shift;
use plotters::prelude::*;

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
        return panel::draw(area, picture, trial, None);
    }
    let rows = (picture.trials.len() + 1).div_ceil(COLUMNS);
    let areas = area.split_evenly((rows, COLUMNS));
    for ((area, trial), letter) in areas.iter().zip(picture.trials).zip('A'..) {
        panel::draw(area, picture, trial, Some(letter))?;
    }
    match areas.get(picture.trials.len()) {
        Some(last) => efficiencies::draw(last, picture.trials, 'H'),
        None => Ok(()),
    }
}

/// The size of so many fronts.
pub(super) fn fronts_size(panels: usize) -> (u32, u32) {
    if panels == 1 {
        return SINGLE;
    }
    (PANEL.0 * COLUMNS as u32, PANEL.1 * panels.div_ceil(COLUMNS) as u32)
}

/// One front alone, or all in a grid.
pub(super) fn fill_fronts<B: DrawingBackend>(
    area: &DrawingArea<B, Shift>,
    panels: &[front::Panel],
) -> Drawn<B> {
    area.fill(&WHITE)?;
    if let [panel] = panels {
        return front::draw(area, panel);
    }
    let areas = area.split_evenly((panels.len().div_ceil(COLUMNS), COLUMNS));
    areas.iter().zip(panels).try_for_each(|(area, panel)| front::draw(area, panel))
}
