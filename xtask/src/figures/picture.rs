//! Draws the picture of `cargo demo`: a signal, its spikes and its reconstruction, for three kinds of code.

use crate::figures::drawing::{Area, DECODED, DOWN, Drawn, FONT, LEFT, MARGIN, SIGNAL, UP};
use crate::figures::{flown::Flown, names::full_name, signal::Signal};
use anyhow::{Context, Result};
use plotters::prelude::*;
use std::{ops::Range, path::Path};

const SIZE: (u32, u32) = (1000, 1180);
/// Time range in seconds: a turn, a fall, and a hard landing.
const SHOWN: Range<f64> = 11.2..13.2;
/// Range of the axis, in rad/s.
const RATES: Range<f64> = -4.4..1.5;
/// A scheme of each family.
const SCHEMES: [&str; 3] = ["sf", "bsa", "position"];

pub fn draw(path: &Path, signal: &Signal, flown: &[Flown]) -> Result<()> {
    let root = SVGBackend::new(path, SIZE).into_drawing_area();
    root.fill(&WHITE)?;
    let (head, panels) = root.split_vertically(100);
    heading(&head)?;
    for (panel, name) in panels.split_evenly((SCHEMES.len(), 1)).iter().zip(SCHEMES) {
        let flown = flown.iter().find(|flown| flown.scheme == name).context("no such scheme")?;
        let (head, body) = panel.split_vertically(38);
        let (curves, spikes) = body.split_vertically(200);
        caption(&head, signal, flown)?;
        draw_curves(&curves, signal, flown)?;
        draw_spikes(&spikes, signal, flown)?;
    }
    root.present()?;
    Ok(())
}

/// Draws title and legend.
fn heading(area: &Area) -> Drawn {
    let title = "A hexarotor's yaw rate in three spike codes";
    area.draw_text(title, &(FONT, 28).into_text_style(area), (LEFT, 14))?;
    let subtitle =
        "Turning, falling, hitting the ground; encoded and decoded on an emulated STM32F405";
    area.draw_text(subtitle, &(FONT, 17).into_text_style(area), (LEFT, 46))?;
    legend(area)
}

/// Draws the legend, in the last line of a heading of 100 pixels.
fn legend(area: &Area) -> Drawn {
    let style = (FONT, 16).into_text_style(area);
    for (x, label, colour, width) in
        [(LEFT, "signal", SIGNAL, 4), (LEFT + 120, "decoded from the spikes", DECODED, 2)]
    {
        area.draw(&PathElement::new([(x, 83), (x + 32, 83)], colour.stroke_width(width)))?;
        area.draw_text(label, &style, (x + 40, 76))?;
    }
    for (x, label, colour) in [(LEFT + 365, "spike up", UP), (LEFT + 480, "spike down", DOWN)] {
        area.draw(&PathElement::new([(x, 76), (x, 91)], colour.stroke_width(2)))?;
        area.draw_text(label, &style, (x + 10, 76))?;
    }
    Ok(())
}

/// Writes what the panel shows, and its error.
fn caption(area: &Area, signal: &Signal, flown: &Flown) -> Drawn {
    let shown = shown(signal);
    let spikes: usize = flown.steps[shown.clone()].iter().map(|step| step.firings.len()).sum();
    let latency = match flown.latency {
        0 => "no latency".into(),
        late => {
            format!("shown without its latency of {:.0} ms", late as f64 * signal.interval() * 1e3)
        }
    };
    let name = full_name(&flown.scheme);
    let (first, rest) = name.split_at(1);
    let text = format!(
        "{}{rest}: {spikes} spikes for {} samples, {latency}",
        first.to_uppercase(),
        shown.len()
    );
    area.draw_text(&text, &(FONT, 19).into_text_style(area), (LEFT, 14))
}

/// Draws the signal, and over it the decoded values.
fn draw_curves(area: &Area, signal: &Signal, flown: &Flown) -> Drawn {
    let mut chart = ChartBuilder::on(area)
        .margin_left(MARGIN)
        .margin_right(MARGIN)
        .set_label_area_size(LabelAreaPosition::Left, LEFT - MARGIN)
        .build_cartesian_2d(SHOWN, RATES)?;
    chart
        .configure_mesh()
        .disable_x_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(BLACK.mix(0.12))
        .axis_style(TRANSPARENT)
        .y_labels(7)
        .y_label_formatter(&|rate| format!("{rate:.0}"))
        .y_desc("yaw rate, rad/s")
        .label_style((FONT, 15))
        .axis_desc_style((FONT, 16))
        .draw()?;
    let shown = shown(signal);
    let times = || signal.times[shown.clone()].iter().copied();
    let samples = times().zip(signal.rates[shown.clone()].iter().map(|rate| f64::from(*rate)));
    chart.draw_series(LineSeries::new(samples, SIGNAL.stroke_width(4)))?;
    let decoded = times().zip(flown.steps[shown.clone()].iter().map(|step| step.value().into()));
    chart.draw_series(LineSeries::new(decoded, DECODED.stroke_width(2)))?;
    Ok(())
}

/// Draws a tick for each spike; beside its neuron if there are several.
fn draw_spikes(area: &Area, signal: &Signal, flown: &Flown) -> Drawn {
    let shown = shown(signal);
    let steps = || signal.times[shown.clone()].iter().zip(&flown.steps[shown.clone()]);
    let firings =
        || steps().flat_map(|(time, step)| step.firings.iter().map(move |one| (*time, one)));
    let neurons = flown.steps.iter().flat_map(|step| &step.firings).map(|one| one.neuron).max();
    let neurons = f64::from(neurons.unwrap_or_default() + 1);
    let falls = firings().any(|(_, one)| !one.up);

    let range = if falls { -1.15..1.15 } else { -0.2..neurons + 0.2 };
    let mut chart = ChartBuilder::on(area)
        .margin_left(MARGIN)
        .margin_right(MARGIN)
        .margin_top(6)
        .set_label_area_size(LabelAreaPosition::Left, LEFT - MARGIN)
        .set_label_area_size(LabelAreaPosition::Bottom, 44)
        .build_cartesian_2d(SHOWN, range)?;
    chart
        .configure_mesh()
        .disable_mesh()
        .axis_style(BLACK.mix(0.4))
        .x_desc("time, s")
        .y_desc(if neurons > 1.0 { "neuron" } else { "spikes" })
        .y_labels(if neurons > 1.0 { 5 } else { 0 })
        .y_label_formatter(&|neuron| format!("{neuron:.0}"))
        .label_style((FONT, 15))
        .axis_desc_style((FONT, 16))
        .draw()?;
    chart.draw_series(firings().map(|(time, one)| {
        let foot = f64::from(one.neuron);
        let (head, colour) = if one.up { (foot + 1.0, UP) } else { (foot - 1.0, DOWN) };
        PathElement::new([(time, foot), (time, head)], colour.stroke_width(2))
    }))?;
    Ok(())
}

/// Returns the range of samples that are shown.
fn shown(signal: &Signal) -> Range<usize> {
    let at = |time: f64| signal.times.partition_point(|&sample| sample < time);
    at(SHOWN.start)..at(SHOWN.end)
}
