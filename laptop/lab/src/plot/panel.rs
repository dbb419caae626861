//! Draws the panel of one trial: the signal and its reconstruction, above the spikes.

use super::palette::{DECODED, DOWN, GRID, INK, QUIET, SIGNAL, UP};
use super::picture::{Curve, Panel, Spike};
use super::title::{Drawn, TITLE, legend, title};
use super::{FONT, Picture};
use crate::brief::brief;
use plotters::coord::Shift;
use plotters::prelude::*;

const LABELS: u32 = 64;
/// Margins of a panel to its left and right.
const MARGINS: (u32, u32) = (4, 16);
/// Share of a panel's height that the spikes take.
const SPIKES: f64 = 0.28;

/// Returns the number of columns of pixels of the time axis, in a panel that is `width` pixels wide.
pub(super) fn columns(width: u32) -> u32 {
    width - MARGINS.0 - MARGINS.1 - LABELS
}

pub(super) fn draw<B: DrawingBackend>(
    area: &DrawingArea<B, Shift>,
    picture: &Picture,
    panel: &Panel,
    letter: Option<char>,
) -> Drawn<B> {
    let (count, shown) = (panel.count, picture.axis.shown.len());
    let text = format!("{}   {count} spikes on {shown} samples", panel.scheme.info().title);
    let mut details = vec![brief(panel.settings.entries())];
    if panel.latency > 0 {
        details.push(format!("decoded shown without its latency of {} samples", panel.latency));
    }
    title(area, letter, &text, &details)?;
    legend(area)?;
    let (_, height) = area.dim_in_pixel();
    let (upper, lower) = area
        .margin(TITLE, 0, MARGINS.0, MARGINS.1)
        .split_vertically((f64::from(height - TITLE) * (1.0 - SPIKES)) as u32);

    let (min, max) = bounds([&picture.signal, &panel.decoded]);
    let mut chart = ChartBuilder::on(&upper)
        .set_label_area_size(LabelAreaPosition::Left, LABELS)
        .margin_top(4)
        .margin_bottom(8)
        .build_cartesian_2d(picture.axis.range.clone(), min..max)?;
    chart
        .configure_mesh()
        .disable_x_axis()
        .y_labels(5)
        .x_labels(8)
        .light_line_style(TRANSPARENT)
        .bold_line_style(GRID)
        .axis_style(GRID)
        .y_label_formatter(&|value| short(*value))
        .y_desc(y_label(picture))
        .axis_desc_style((FONT, 13).into_font().color(&INK))
        .label_style((FONT, 13).into_font().color(&INK))
        .draw()?;
    debug_assert_eq!(chart.plotting_area().dim_in_pixel().0, columns(area.dim_in_pixel().0));
    for later in picture.signal.lines.iter().skip(1) {
        let start = later.first().map_or(0.0, |(x, _)| *x);
        chart
            .draw_series([PathElement::new([(start, min), (start, max)], QUIET.stroke_width(1))])?;
    }
    for (curve, colour) in [(&picture.signal, SIGNAL), (&panel.decoded, DECODED)] {
        for line in &curve.lines {
            chart.draw_series(LineSeries::new(line.iter().copied(), colour.stroke_width(2)))?;
        }
    }
    spikes(&lower, picture, panel)
}

fn spikes<B: DrawingBackend>(
    area: &DrawingArea<B, Shift>,
    picture: &Picture,
    panel: &Panel,
) -> Drawn<B> {
    let neurons = panel.shape.neurons;
    let rows = match (panel.scheme.info().is_signed, neurons) {
        (true, _) => -1.25..1.25,
        (false, 1) => 0.0..1.25,
        (false, _) => -0.8..neurons as f64 - 0.2,
    };
    let is_population = neurons > 1;
    let mut chart = ChartBuilder::on(area)
        .set_label_area_size(LabelAreaPosition::Left, LABELS)
        .set_label_area_size(LabelAreaPosition::Bottom, 42)
        .build_cartesian_2d(picture.axis.range.clone(), rows)?;
    chart
        .configure_mesh()
        .disable_mesh()
        .x_labels(8)
        .y_labels(if is_population { 4 } else { 3 })
        .axis_style(GRID)
        .x_desc(match (picture.axis.rate, picture.segments) {
            (None, _) => "sample".to_owned(),
            (Some(_), 0 | 1) => "time, s".to_owned(),
            (Some(_), many) => format!("time, s, of {many} segments one after the other"),
        })
        .y_desc(if is_population { "neuron" } else { "spikes" })
        .axis_desc_style((FONT, 13).into_font().color(&INK))
        .x_label_formatter(&|value| short(*value))
        .y_label_formatter(&|value| {
            if is_population {
                format!("{value:.0}")
            } else {
                match *value {
                    0.0 => "0".to_owned(),
                    whole if whole.fract() == 0.0 => format!("{whole:+.0}"),
                    _ => String::new(),
                }
            }
        })
        .label_style((FONT, 13).into_font().color(&INK))
        .draw()?;
    for &Spike { x, neuron, is_up } in &panel.spikes {
        let (low, high) = match (is_population, is_up) {
            (true, _) => (f64::from(neuron) - 0.42, f64::from(neuron) + 0.42),
            (false, true) => (0.0, 1.0),
            (false, false) => (-1.0, 0.0),
        };
        let colour = if is_up { UP } else { DOWN };
        let stroke = PathElement::new([(x, low), (x, high)], colour.stroke_width(1));
        chart.draw_series([stroke])?;
    }
    Ok(())
}

/// Returns the label of the y axis: the signal's name and unit.
fn y_label(picture: &Picture) -> String {
    let Picture { name, unit, .. } = picture;
    unit.as_ref().map_or(name.clone(), |unit| format!("{name}, {unit}"))
}

/// Returns the range of the values of both curves, extended by a margin.
fn bounds([one, other]: [&Curve; 2]) -> (f64, f64) {
    let (min, max) = (one.bounds.0.min(other.bounds.0), one.bounds.1.max(other.bounds.1));
    let air = if max > min { 0.06 * (max - min) } else { 1.0 };
    (min - air, max + air)
}

fn short(value: f64) -> String {
    let rounded = (value * 1000.0).round() / 1000.0;
    format!("{}", if rounded == 0.0 { 0.0 } else { rounded })
}
