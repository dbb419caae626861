//! Arranges the panels of a picture in a grid.

use super::title::Drawn;
use super::{Picture, efficiencies, front, panel};
use plotters::coord::Shift;
use plotters::prelude::*;

const SINGLE: (u32, u32) = (960, 480);
const PANEL: (u32, u32) = (480, 310);
const COLUMNS: usize = 2;

/// Returns the width and height of a picture of trials, in pixels.
pub(super) fn size(picture: &Picture) -> (u32, u32) {
    if !picture.is_grid {
        return SINGLE;
    }
    let rows = (picture.panels.len() + 1).div_ceil(COLUMNS) as u32;
    (PANEL.0 * COLUMNS as u32, PANEL.1 * rows)
}

/// Returns the number of columns of pixels of a panel's time axis.
pub(super) fn columns(is_grid: bool) -> u32 {
    panel::columns(if is_grid { PANEL.0 } else { SINGLE.0 })
}

/// Draws a single trial alone, or several trials in a grid whose last panel shows the efficiencies.
pub(super) fn fill<B: DrawingBackend>(area: &DrawingArea<B, Shift>, picture: &Picture) -> Drawn<B> {
    area.fill(&WHITE)?;
    let panels = &picture.panels;
    if let ([panel], false) = (&panels[..], picture.is_grid) {
        return panel::draw(area, picture, panel, None);
    }
    let rows = (panels.len() + 1).div_ceil(COLUMNS);
    let areas = area.split_evenly((rows, COLUMNS));
    for ((area, panel), letter) in areas.iter().zip(panels).zip('A'..) {
        panel::draw(area, picture, panel, Some(letter))?;
    }
    match areas.get(panels.len()) {
        Some(last) => {
            let letter = ('A'..).nth(panels.len()).unwrap_or('H');
            efficiencies::draw(last, panels, letter)
        }
        None => Ok(()),
    }
}

const FRONT: (u32, u32) = (400, 340);

/// Returns the number of columns and the number of rows of a grid of `panels` panels.
fn fronts_grid(panels: usize) -> (usize, usize) {
    let columns = panels.clamp(1, COLUMNS);
    (columns, panels.div_ceil(columns))
}

/// Returns the width and height of a picture of fronts with its legend, in pixels.
pub(super) fn fronts_size(panels: &[front::Panel]) -> (u32, u32) {
    let (_, rows) = fronts_grid(panels.len());
    let width = FRONT.0 * COLUMNS as u32;
    (width, front::legend_height(&front::named(panels), width) + FRONT.1 * rows as u32)
}

/// Draws a legend, and below it a grid of panels, one for each channel. A panel shows the schemes' Pareto fronts.
pub(super) fn fill_fronts<B: DrawingBackend>(
    area: &DrawingArea<B, Shift>,
    panels: &[front::Panel],
) -> Drawn<B> {
    area.fill(&WHITE)?;
    let named = front::named(panels);
    let width = area.dim_in_pixel().0;
    let (top, below) = area.split_vertically(front::legend_height(&named, width));
    front::legend(&top, &named)?;
    let (columns, rows) = fronts_grid(panels.len());
    let areas = below.split_evenly((rows, columns));
    areas.iter().zip(panels).try_for_each(|(area, panel)| front::draw(area, panel, &named))
}
