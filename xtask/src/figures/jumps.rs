//! Draws the hardest second of the flight in three step codes with one threshold, and how far each lags behind.

use crate::common::paths;
use crate::figures::drawing::{Area, Drawn, FONT, LEFT, MARGIN, SIGNAL};
use crate::figures::{drawing, signal::Signal};
use anyhow::{Result, ensure};
use plotters::prelude::*;
use spikewire::{
    Code, Output, Start,
    temporal::{AdaptiveStepForward, SendOnDelta, StepForward},
};
use std::{ops::Range, path::PathBuf};

const PAGE: &str = "docs/jumps.svg";
const SIZE: (u32, u32) = (1000, 760);
/// Time range in seconds: a fall that ends on the ground.
const SHOWN: Range<f64> = 11.6..12.6;
/// Threshold, in rad/s.
const THRESHOLD: f32 = 0.1;
/// Maximum number of spikes in a sample: more thresholds than the signal ever moves between samples.
const SPIKES: usize = 24;

/// Colours of Okabe and Ito, which remain distinct to the colour-blind.
const COLOURS: [RGBColor; 3] = [RGBColor(213, 94, 0), RGBColor(0, 114, 178), RGBColor(0, 158, 115)];

/// The values of a code during the second.
struct Followed {
    name: String,
    values: Vec<f32>,
    spikes: usize,
    /// Largest difference from the signal.
    behind: f32,
}

/// Draws the picture below the target directory; returns its path.
pub fn jumps() -> Result<PathBuf> {
    let path = paths::target().join("jumps.svg");
    let signal = Signal::read();
    let shown = shown(&signal);
    let schemes = (
        StepForward::new(THRESHOLD),
        AdaptiveStepForward::new(THRESHOLD, 3).with_run(1),
        SendOnDelta::<f32, SPIKES>::new(THRESHOLD),
    );
    let all = [
        follow("step forward", &schemes.0, &signal, &shown),
        follow("adaptive step forward", &schemes.1, &signal, &shown),
        follow("send-on-delta", &schemes.2, &signal, &shown),
    ];
    draw(&path, &signal, &shown, &all)?;
    for Followed { name, spikes, behind, .. } in &all {
        println!("{name:22} {spikes:>4} spikes, {behind:.2} rad/s behind at most");
    }
    println!("The picture: {}", path.display());

    let moved = signal.rates.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f32::max);
    let [step, adaptive, delta] = &all;
    ensure!(moved <= SPIKES as f32 * THRESHOLD, "the signal moves by {moved} rad/s in one sample");
    ensure!(delta.behind <= THRESHOLD * 1.0001, "send-on-delta leaves its law");
    ensure!(step.behind > 2.0 && adaptive.behind < step.behind, "another second is harder now");
    Ok(path)
}

/// Draws the picture into the documentation.
pub fn write() -> Result<()> {
    drawing::keep(&jumps()?, PAGE)
}

/// Runs the whole flight through a code, and keeps the second.
fn follow<P: Start<Sample = f32>>(
    name: &str,
    scheme: &P,
    signal: &Signal,
    shown: &Range<usize>,
) -> Followed {
    let (mut encoder, mut decoder) = (scheme.encoder(), scheme.decoder());
    signal.rates.first().into_iter().for_each(|&first| decoder.resync(first));
    let codes = signal.rates.iter().filter_map(|&rate| encoder.encode(rate).code());
    let all: Vec<_> = codes.map(|code| (decoder.decode(code), code.firings().count())).collect();
    let kept = &all[shown.clone()];
    let behind = kept.iter().zip(&signal.rates[shown.clone()]);
    let behind = behind.map(|((value, _), rate)| (value - rate).abs()).fold(0.0, f32::max);
    Followed {
        name: name.to_owned(),
        values: kept.iter().map(|(value, _)| *value).collect(),
        spikes: kept.iter().map(|(_, spikes)| spikes).sum(),
        behind,
    }
}

fn draw(
    path: &std::path::Path,
    signal: &Signal,
    shown: &Range<usize>,
    all: &[Followed; 3],
) -> Result<()> {
    let root = SVGBackend::new(path, SIZE).into_drawing_area();
    root.fill(&WHITE)?;
    let (head, panels) = root.split_vertically(134);
    heading(&head, all)?;
    let (curves, behind) = panels.split_vertically(350);
    let rates = &signal.rates[shown.clone()];
    let lines = || COLOURS.iter().zip(all);
    let points = |values: Vec<f32>| -> Vec<(f64, f64)> {
        let times = signal.times[shown.clone()].iter().copied();
        times.zip(values.into_iter().map(f64::from)).collect()
    };

    let signal = (&SIGNAL, points(rates.to_vec()), 4);
    let values = lines().map(|(colour, followed)| (colour, points(followed.values.clone()), 2));
    chart(&curves, -4.2..1.4, "yaw rate, rad/s", None, [signal].into_iter().chain(values))?;
    let distances = lines().map(|(colour, followed)| {
        let distances = followed.values.iter().zip(rates).map(|(value, rate)| value - rate);
        (colour, points(distances.collect()), 2)
    });
    chart(&behind, -2.6..2.6, "decoded less signal", Some("time, s"), distances)?;
    root.present()?;
    Ok(())
}

/// Draws title and legend.
fn heading(area: &Area, all: &[Followed; 3]) -> Drawn {
    let title = "The flight's hardest second: three step codes with a threshold of 0.1 rad/s";
    area.draw_text(title, &(FONT, 25).into_text_style(area), (LEFT, 14))?;
    let style = (FONT, 16).into_text_style(area);
    let labels = all.iter().map(|Followed { name, spikes, behind, .. }| {
        format!("{name}: {spikes} spikes, {behind:.2} rad/s away at most")
    });
    let lines = [("signal".to_owned(), SIGNAL, 4)];
    let lines =
        lines.into_iter().chain(labels.zip(COLOURS).map(|(label, colour)| (label, colour, 2)));
    for ((label, colour, width), (column, row)) in lines.zip([(0, 0), (0, 1), (1, 0), (1, 1)]) {
        let (x, y) = (LEFT + 440 * column, 68 + 32 * row);
        area.draw(&PathElement::new([(x, y), (x + 32, y)], colour.stroke_width(width)))?;
        area.draw_text(&label, &style, (x + 40, y - 8))?;
    }
    Ok(())
}

/// Draws lines over the second, each with its colour and width.
fn chart<'a>(
    area: &Area,
    range: Range<f64>,
    what: &str,
    time: Option<&str>,
    lines: impl Iterator<Item = (&'a RGBColor, Vec<(f64, f64)>, u32)>,
) -> Drawn {
    let mut chart = ChartBuilder::on(area)
        .margin_left(MARGIN)
        .margin_right(MARGIN)
        .margin_bottom(8)
        .set_label_area_size(LabelAreaPosition::Left, LEFT - MARGIN)
        .set_label_area_size(LabelAreaPosition::Bottom, if time.is_some() { 44 } else { 8 })
        .build_cartesian_2d(SHOWN, range)?;
    let mut mesh = chart.configure_mesh();
    mesh.disable_x_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(BLACK.mix(0.12))
        .axis_style(BLACK.mix(0.3))
        .x_labels(if time.is_some() { 11 } else { 0 })
        .y_labels(6)
        .x_label_formatter(&|time| format!("{time:.1}"))
        .y_label_formatter(&|rate| format!("{rate:.0}"))
        .y_desc(what)
        .label_style((FONT, 15))
        .axis_desc_style((FONT, 16));
    if let Some(time) = time {
        mesh.x_desc(time);
    }
    mesh.draw()?;
    for (colour, points, width) in lines {
        chart.draw_series(LineSeries::new(points, colour.stroke_width(width)))?;
    }
    Ok(())
}

/// Returns the range of samples in the second.
fn shown(signal: &Signal) -> Range<usize> {
    let at = |time: f64| signal.times.partition_point(|&sample| sample < time);
    at(SHOWN.start)..at(SHOWN.end)
}
