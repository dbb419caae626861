//! Spikes against error: the settings that no other one beats, a curve for each scheme.

use super::FONT;
use super::palette::{self, GRID, INK};
use super::title::{Drawn, TITLE, title};
use crate::scheme::Scheme;
use plotters::coord::Shift;
use plotters::prelude::*;

/// One channel.
pub(crate) struct Panel {
    /// Its name.
    pub title: String,
    /// What was done, in small letters.
    pub details: Vec<String>,
    /// The signal's unit, if it is known.
    pub unit: Option<String>,
    /// A curve for each scheme.
    pub curves: Vec<Curve>,
}

/// One scheme.
pub(crate) struct Curve {
    /// Which.
    pub scheme: Scheme,
    /// Efficiency and RMSE of each setting.
    pub points: Vec<(f64, f64)>,
    /// Those of the paper's setting.
    pub paper: Option<(f64, f64)>,
}

const LABELS: u32 = 74;
const LEGEND: i32 = 118;
/// A population with several spikes a sample goes below; the axis ends where most codes do.
const LOWEST: f64 = -100.0;

pub(super) fn draw<B: DrawingBackend>(area: &DrawingArea<B, Shift>, panel: &Panel) -> Drawn<B> {
    title(area, None, &panel.title, &panel.details)?;
    let all = || panel.curves.iter().flat_map(|curve| curve.points.iter().chain(&curve.paper));
    let (mut low, mut high) = (f64::INFINITY, 0.0_f64);
    for (_, error) in all().filter(|(_, error)| *error > 0.0) {
        (low, high) = (low.min(*error), high.max(*error));
    }
    if low > high {
        return Ok(());
    }
    let left = all().map(|(efficiency, _)| efficiency.max(LOWEST)).fold(0.0, f64::min).min(0.0);
    let mut chart = ChartBuilder::on(&area.margin(TITLE, 8, 4, LEGEND))
        .set_label_area_size(LabelAreaPosition::Left, LABELS)
        .set_label_area_size(LabelAreaPosition::Bottom, 42)
        .build_cartesian_2d(left..100.0, (low * 0.8..high * 1.25).log_scale())?;
    let unit = panel.unit.as_ref().map_or(String::new(), |unit| format!(", {unit}"));
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(GRID)
        .axis_style(GRID)
        .x_labels(6)
        .y_labels(6)
        .x_desc("spiking efficiency, %")
        .y_desc(format!("RMSE{unit}"))
        .x_label_formatter(&|value| format!("{value:.0}"))
        .y_label_formatter(&|value| crate::brief::short((value * 1e4).round() / 1e4))
        .axis_desc_style((FONT, 13).into_font().color(&INK))
        .label_style((FONT, 13).into_font().color(&INK))
        .draw()?;
    let (width, height) = area.dim_in_pixel();
    // Many schemes share what height there is.
    let row = ((height as i32 - TITLE as i32 - 20) / (panel.curves.len() as i32 + 1)).clamp(9, 17);
    let small = (FONT, row.min(12)).into_font().color(&INK);
    for (place, curve) in (1..).zip(&panel.curves) {
        let colour = palette::of(curve.scheme);
        let inside = |point: &&(f64, f64)| point.0 >= left && point.1 > 0.0;
        let points: Vec<(f64, f64)> = curve.points.iter().filter(inside).copied().collect();
        chart.draw_series(LineSeries::new(points, colour.stroke_width(2)))?;
        if let Some(paper) = curve.paper.as_ref().filter(inside) {
            chart.draw_series([Circle::new(*paper, 5, colour.filled())])?;
            chart.draw_series([Circle::new(*paper, 5, INK)])?;
        }
        let right = width as i32 - LEGEND + 6;
        let top = TITLE as i32 + row * place;
        area.draw(&PathElement::new(
            [(right, top + 6), (right + 18, top + 6)],
            colour.stroke_width(2),
        ))?;
        let name = curve.scheme.info().title;
        area.draw(&Text::new(name, (right + 24, top), small.clone()))?;
    }
    let (right, top) = (width as i32 - LEGEND + 6, TITLE as i32);
    area.draw(&Circle::new((right + 9, top + row / 2), 4, INK))?;
    area.draw(&Text::new("the paper's", (right + 24, top), small))?;
    Ok(())
}
