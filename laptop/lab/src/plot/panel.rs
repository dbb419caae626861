//! Draws the panel of one trial: the signal and its reconstruction, above the spikes.

use super::decimate::{column, decimate};
use super::palette::{DECODED, DOWN, GRID, INK, QUIET, SIGNAL, UP};
use super::title::{Drawn, TITLE, legend, title};
use super::{FONT, Picture};
use crate::brief::brief;

use crate::trial::Trial;
use catalogue::run::Event;
use plotters::coord::Shift;
use plotters::prelude::*;
use spikewire::Polarity;
use std::collections::HashSet;
use std::ops::Range;

const LABELS: u32 = 64;
/// Share of a panel's height that the spikes take.
const SPIKES: f64 = 0.28;

pub(super) fn draw<B: DrawingBackend>(
    area: &DrawingArea<B, Shift>,
    picture: &Picture,
    trial: &Trial,
    letter: Option<char>,
) -> Drawn<B> {
    let spikes_shown =
        trial.events.iter().filter(|event| picture.shown.contains(&(event.sample as usize)));
    let count = spikes_shown.clone().count();
    let shown = picture.shown.len();
    let text = format!("{}   {count} spikes on {shown} samples", trial.scheme.info().title);
    let mut details = vec![brief(trial.settings.entries())];
    if trial.latency > 0 {
        details.push(format!("decoded shown without its latency of {} samples", trial.latency));
    }
    title(area, letter, &text, &details)?;
    legend(area)?;
    let (_, height) = area.dim_in_pixel();
    let (upper, lower) = area
        .margin(TITLE, 0, 4, 16)
        .split_vertically((f64::from(height - TITLE) * (1.0 - SPIKES)) as u32);

    let at = times(picture);
    let x_range = span(picture.shown.clone().map(&at));
    let signal = &picture.recording.values[picture.shown.clone()];
    let decoded = &trial.decoded[picture.shown.clone()];
    let (min, max) = bounds(signal.iter().chain(decoded));
    let mut chart = ChartBuilder::on(&upper)
        .set_label_area_size(LabelAreaPosition::Left, LABELS)
        .margin_top(4)
        .margin_bottom(8)
        .build_cartesian_2d(x_range.clone(), min..max)?;
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
    let columns = chart.plotting_area().dim_in_pixel().0;
    let segments = || {
        let shown = &picture.shown;
        let own =
            |segment: &Range<usize>| segment.start.max(shown.start)..segment.end.min(shown.end);
        picture.recording.segments.iter().map(own).filter(|own| !own.is_empty())
    };
    for later in segments().skip(1) {
        let start = at(later.start);
        chart
            .draw_series([PathElement::new([(start, min), (start, max)], QUIET.stroke_width(1))])?;
    }
    for (values, colour) in [(&picture.recording.values, SIGNAL), (&trial.decoded, DECODED)] {
        for segment in segments() {
            let points =
                segment.clone().zip(&values[segment]).map(|(own, value)| (at(own), *value));
            let points = decimate(points, &x_range, columns);
            chart.draw_series(LineSeries::new(points, colour.stroke_width(2)))?;
        }
    }
    spikes(&lower, picture, trial, x_range, spikes_shown)
}

fn spikes<'a, B: DrawingBackend>(
    area: &DrawingArea<B, Shift>,
    picture: &Picture,
    trial: &Trial,
    x_range: Range<f64>,
    events: impl Iterator<Item = &'a Event>,
) -> Drawn<B> {
    let at = times(picture);
    let neurons = trial.shape.neurons;
    let rows = match (trial.scheme.info().is_signed, neurons) {
        (true, _) => -1.25..1.25,
        (false, 1) => 0.0..1.25,
        (false, _) => -0.8..neurons as f64 - 0.2,
    };
    let is_population = neurons > 1;
    let mut chart = ChartBuilder::on(area)
        .set_label_area_size(LabelAreaPosition::Left, LABELS)
        .set_label_area_size(LabelAreaPosition::Bottom, 42)
        .build_cartesian_2d(x_range.clone(), rows)?;
    chart
        .configure_mesh()
        .disable_mesh()
        .x_labels(8)
        .y_labels(if is_population { 4 } else { 3 })
        .axis_style(GRID)
        .x_desc(match (picture.recording.rate, picture.recording.segments.len()) {
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
    let slots = trial.shape.slots as f64;
    let step = if slots > 1.0 { (at(1) - at(0)).max(0.0) / slots } else { 0.0 };
    let columns = chart.plotting_area().dim_in_pixel().0;
    let mut drawn = HashSet::new();
    for event in events {
        let x = at(event.sample as usize) + f64::from(event.slot) * step;
        let is_up = event.polarity == Polarity::Up;
        // Spikes of one neuron in one column of pixels share a stroke.
        if !drawn.insert((column(x, &x_range, columns), event.neuron, is_up)) {
            continue;
        }
        let (low, high) = match (is_population, is_up) {
            (true, _) => (f64::from(event.neuron) - 0.42, f64::from(event.neuron) + 0.42),
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
    let name = &picture.recording.name;
    picture.unit.map_or(name.clone(), |unit| format!("{name}, {unit}"))
}

/// Returns the function from a sample's index to its position on the time axis: seconds from the start, or the index
/// itself if neither times nor a rate are known.
fn times<'a>(picture: &'a Picture) -> impl Fn(usize) -> f64 + 'a {
    let recording = picture.recording;
    move |sample| match (recording.times.get(sample), recording.times.first(), recording.rate) {
        (Some(time), Some(first), _) => time.saturating_sub(*first) as f64 * 1e-6,
        (_, _, Some(rate)) => sample as f64 / rate,
        _ => sample as f64,
    }
}

/// Returns the range from the earliest to the latest of the times.
fn span(times: impl Iterator<Item = f64>) -> Range<f64> {
    let (min, max) =
        times.fold((f64::MAX, f64::MIN), |(min, max), time| (min.min(time), max.max(time)));
    min..max
}

/// Returns the range of the values, extended by a margin.
fn bounds<'a>(values: impl Iterator<Item = &'a f64>) -> (f64, f64) {
    let (min, max) =
        values.fold((f64::MAX, f64::MIN), |(min, max), &value| (min.min(value), max.max(value)));
    let air = if max > min { 0.06 * (max - min) } else { 1.0 };
    (min - air, max + air)
}

fn short(value: f64) -> String {
    let rounded = (value * 1000.0).round() / 1000.0;
    format!("{}", if rounded == 0.0 { 0.0 } else { rounded })
}
