//! Draws the panel of spiking efficiencies, with a bar for each scheme. The efficiency is the share of samples without
//! a spike.

use super::FONT;
use super::palette::{self, GRID, INK};
use super::picture::Panel;
use super::title::{Drawn, TITLE, title};
use crate::scheme::Scheme;
use plotters::coord::Shift;
use plotters::prelude::*;

pub(super) fn draw<B: DrawingBackend>(
    area: &DrawingArea<B, Shift>,
    panels: &[Panel],
    letter: char,
) -> Drawn<B> {
    let details = ["of the whole recording".to_owned()];
    title(area, Some(letter), "Spiking efficiency, % of samples without a spike", &details)?;
    let mut ranked: Vec<(Scheme, f64)> =
        panels.iter().map(|panel| (panel.scheme, panel.efficiency)).collect();
    ranked.sort_by(|a, b| a.1.total_cmp(&b.1));
    let area = area.margin(TITLE, 12, 16, 40);
    let rows = ranked.len() as f64;
    let mut chart = ChartBuilder::on(&area)
        .set_label_area_size(LabelAreaPosition::Left, 60)
        .set_label_area_size(LabelAreaPosition::Bottom, 26)
        .build_cartesian_2d(0.0..100.0, 0.0..rows)?;
    chart
        .configure_mesh()
        .disable_y_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(GRID)
        .axis_style(GRID)
        .x_labels(6)
        .y_labels(0)
        .x_label_formatter(&|value| format!("{value:.0}"))
        .label_style((FONT, 13).into_font().color(&INK))
        .draw()?;
    for (row, (scheme, efficiency)) in ranked.iter().enumerate() {
        let (low, high) = (row as f64 + 0.18, row as f64 + 0.82);
        let bar = Rectangle::new(
            [(0.0, low), (efficiency.max(0.0), high)],
            palette::of(*scheme).filled(),
        );
        chart.draw_series([bar])?;
        let middle = row as f64 + 0.5;
        let label = |text: String, x: f64, offset: (i32, i32)| {
            EmptyElement::at((x, middle))
                + Text::new(text, offset, (FONT, 14).into_font().color(&INK))
        };
        chart.draw_series([
            label(scheme.info().title.to_owned(), 0.0, (-54, -8)),
            label(format!("{efficiency:.1}"), efficiency.max(0.0), (6, -8)),
        ])?;
    }
    Ok(())
}
