//! One trial's panel: signal and reconstruction over spikes.

use super::palette::{DECODED, DOWN, GRID, INK, SIGNAL, UP};
use super::title::{Drawn, TITLE, title};
use super::{FONT, Picture};
use crate::codec::Event;
use crate::trial::Trial;
use plotters::coord::Shift;
use plotters::prelude::*;
use spikewire::Polarity;

const LABELS: u32 = 46;
/// The part of a panel that the spikes take.
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
    title(area, letter, &format!("{}   {count} spikes on {shown} samples", trial.scheme.title()))?;
    let (_, height) = area.dim_in_pixel();
    let (upper, lower) = area
        .margin(TITLE, 0, 4, 16)
        .split_vertically((f64::from(height - TITLE) * (1.0 - SPIKES)) as u32);

    let at = times(picture);
    let x_range = at(picture.shown.start)..at(picture.shown.end - 1);
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
        .label_style((FONT, 13).into_font().color(&INK))
        .draw()?;
    let points = |values: &[f64]| -> Vec<(f64, f64)> {
        picture.shown.clone().zip(values).map(|(sample, &value)| (at(sample), value)).collect()
    };
    chart
        .draw_series(LineSeries::new(points(signal), SIGNAL.stroke_width(2)))?
        .label("signal")
        .legend(|(x, y)| PathElement::new([(x, y), (x + 16, y)], SIGNAL.stroke_width(2)));
    chart
        .draw_series(LineSeries::new(points(decoded), DECODED.stroke_width(2)))?
        .label("decoded")
        .legend(|(x, y)| PathElement::new([(x, y), (x + 16, y)], DECODED.stroke_width(2)));
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperRight)
        .background_style(WHITE.mix(0.8))
        .margin(4)
        .legend_area_size(20)
        .label_font((FONT, 13).into_font().color(&INK))
        .draw()?;
    spikes(&lower, picture, trial, x_range, spikes_shown)
}

fn spikes<'a, B: DrawingBackend>(
    area: &DrawingArea<B, Shift>,
    picture: &Picture,
    trial: &Trial,
    x_range: std::ops::Range<f64>,
    events: impl Iterator<Item = &'a Event>,
) -> Drawn<B> {
    let at = times(picture);
    let neurons = trial.settings.neurons();
    let rows = match (trial.scheme.is_signed(), neurons) {
        (true, _) => -1.25..1.25,
        (false, 1) => 0.0..1.25,
        (false, _) => -0.8..neurons as f64 - 0.2,
    };
    let is_population = neurons > 1;
    let unit = if picture.recording.rate.is_some() { " s" } else { "" };
    let mut chart = ChartBuilder::on(area)
        .set_label_area_size(LabelAreaPosition::Left, LABELS)
        .set_label_area_size(LabelAreaPosition::Bottom, 30)
        .build_cartesian_2d(x_range, rows)?;
    chart
        .configure_mesh()
        .disable_mesh()
        .x_labels(8)
        .y_labels(if is_population { 4 } else { 3 })
        .axis_style(GRID)
        .x_label_formatter(&|value| format!("{}{unit}", short(*value)))
        .y_label_formatter(&|value| {
            if is_population {
                format!("{value:.0}")
            } else {
                format!("{value:+.0}").replace("+0", "0")
            }
        })
        .label_style((FONT, 13).into_font().color(&INK))
        .draw()?;
    let slots = trial.settings.slots() as f64;
    chart.draw_series(events.map(|event| {
        let x = at(event.sample as usize)
            + f64::from(event.slot) / slots
                * (at(1) - at(0)).max(0.0)
                * f64::from(u8::from(slots > 1.0));
        let (low, high) = match (is_population, event.polarity) {
            (true, _) => (f64::from(event.neuron) - 0.42, f64::from(event.neuron) + 0.42),
            (false, Polarity::Up) => (0.0, 1.0),
            (false, Polarity::Down) => (-1.0, 0.0),
        };
        let colour = if event.polarity == Polarity::Up { UP } else { DOWN };
        PathElement::new([(x, low), (x, high)], colour.stroke_width(1))
    }))?;
    Ok(())
}

/// When a sample is, in seconds from the start, or else its number.
fn times<'a>(picture: &'a Picture) -> impl Fn(usize) -> f64 + 'a {
    let recording = picture.recording;
    move |sample| match (recording.times.get(sample), recording.times.first(), recording.rate) {
        (Some(time), Some(first), _) => (time - first) as f64 * 1e-6,
        (_, _, Some(rate)) => sample as f64 / rate,
        _ => sample as f64,
    }
}

/// The range of the values, with some air.
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
