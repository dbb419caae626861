//! The paper's figure of its ROS package: a signal, what its spikes decode to, and the spikes.

use crate::{
    common::paths,
    figures::drawing::{Area, DECODED, DOWN, Drawn, FONT, LEFT, MARGIN, SIGNAL, UP, legend},
};
use anyhow::{Context, Result, ensure};
use plotters::prelude::*;
use std::{fs, ops::Range, path::Path};

pub const PAGE: &str = "docs/ros.svg";
const SIZE: (u32, u32) = (1000, 560);
const VALUES: Range<f64> = -3.6..4.0;

/// A message of the bag.
struct Sample {
    input: f64,
    spike: f64,
    decoded: f64,
}

/// Draws the table of a bag.
pub fn draw(table: &Path, picture: &Path) -> Result<()> {
    let samples = read(table)?;
    let root = SVGBackend::new(picture, SIZE).into_drawing_area();
    root.fill(&WHITE)?;
    let (head, body) = root.split_vertically(100);
    let (curves, spikes) = body.split_vertically(290);
    heading(&head, &samples)?;
    draw_curves(&curves, &samples)?;
    draw_spikes(&spikes, &samples)?;
    root.present()?;
    Ok(())
}

/// Fails if these lines of `index,value,time_us` have other values, as numbers of 32 bits.
pub fn ensure_decoded(lines: &str, table: &Path) -> Result<()> {
    let values = lines.lines().skip(1).map(|line| line.split(',').nth(1)?.parse::<f32>().ok());
    let values = values.collect::<Option<Vec<_>>>().context("the decoded values are no table")?;
    let wanted: Vec<f32> = read(table)?.iter().map(|sample| sample.decoded as f32).collect();
    ensure!(values == wanted, "`spikewire decode` and the node decode the bag to other values");
    println!("`spikewire decode` makes of the bag what the node decoded.");
    Ok(())
}

fn read(table: &Path) -> Result<Vec<Sample>> {
    let text = fs::read_to_string(table).with_context(|| table.display().to_string())?;
    let samples = text.lines().skip(1).map(sample).collect::<Option<Vec<_>>>();
    samples.with_context(|| format!("{} has other columns", table.display()))
}

/// Fails if the page has another picture.
pub fn ensure_drawn(picture: &Path) -> Result<()> {
    let kept = fs::read(paths::root().join(PAGE)).context(PAGE)?;
    let command = "cargo xtask write ros";
    ensure!(kept == fs::read(picture)?, "{PAGE} is another picture; `{command}` draws it");
    println!("{PAGE} is what a bag of the node gives.");
    Ok(())
}

/// `0.40458956360816956,0,0.40458956360816956`
fn sample(line: &str) -> Option<Sample> {
    let numbers = line.split(',').map(str::parse).collect::<Result<Vec<f64>, _>>().ok()?;
    let [input, spike, decoded] = numbers[..] else { return None };
    Some(Sample { input, spike, decoded })
}

/// Title and legend.
fn heading(area: &Area, samples: &[Sample]) -> Drawn {
    let title = "Step forward in ROS: three sines with noise, a threshold of 0.35";
    area.draw_text(title, &(FONT, 25).into_text_style(area), (LEFT, 14))?;
    let spikes = samples.iter().filter(|sample| sample.spike != 0.0).count();
    let subtitle = format!(
        "{} messages of the node, 100 a second, recorded by rosbag; {spikes} have a spike",
        samples.len()
    );
    area.draw_text(&subtitle, &(FONT, 17).into_text_style(area), (LEFT, 44))?;
    legend(area)
}

/// The signal, and over it what the decoder made of its spikes.
fn draw_curves(area: &Area, samples: &[Sample]) -> Drawn {
    let mut chart = ChartBuilder::on(area)
        .margin_left(MARGIN)
        .margin_right(MARGIN)
        .set_label_area_size(LabelAreaPosition::Left, LEFT - MARGIN)
        .build_cartesian_2d(0.0..samples.len() as f64, VALUES)?;
    chart
        .configure_mesh()
        .disable_x_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(BLACK.mix(0.12))
        .axis_style(TRANSPARENT)
        .y_labels(7)
        .y_label_formatter(&|value| format!("{value:.0}"))
        .label_style((FONT, 15))
        .draw()?;
    let line = |of: fn(&Sample) -> f64| -> Vec<(f64, f64)> {
        samples.iter().enumerate().map(|(index, sample)| (index as f64, of(sample))).collect()
    };
    chart.draw_series(LineSeries::new(line(|sample| sample.input), SIGNAL.stroke_width(4)))?;
    chart.draw_series(LineSeries::new(line(|sample| sample.decoded), DECODED.stroke_width(2)))?;
    Ok(())
}

/// A tick for each spike.
fn draw_spikes(area: &Area, samples: &[Sample]) -> Drawn {
    let mut chart = ChartBuilder::on(area)
        .margin_left(MARGIN)
        .margin_right(MARGIN)
        .margin_top(6)
        .set_label_area_size(LabelAreaPosition::Left, LEFT - MARGIN)
        .set_label_area_size(LabelAreaPosition::Bottom, 44)
        .build_cartesian_2d(0.0..samples.len() as f64, -1.15..1.15)?;
    chart
        .configure_mesh()
        .disable_mesh()
        .axis_style(BLACK.mix(0.4))
        .x_desc("messages, one every 0.01 s")
        .x_labels(9)
        .x_label_formatter(&|index| format!("{index:.0}"))
        .y_desc("spikes")
        .y_labels(0)
        .label_style((FONT, 15))
        .axis_desc_style((FONT, 16))
        .draw()?;
    let fired = samples.iter().enumerate().filter(|(_, sample)| sample.spike != 0.0);
    chart.draw_series(fired.map(|(index, sample)| {
        let colour = if sample.spike > 0.0 { UP } else { DOWN };
        PathElement::new(
            [(index as f64, 0.0), (index as f64, sample.spike)],
            colour.stroke_width(2),
        )
    }))?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::sample;

    #[test]
    fn a_line_of_the_table() {
        let read = sample("1.5,-1,0.25").unwrap();
        assert_eq!((read.input, read.spike, read.decoded), (1.5, -1.0, 0.25));
        assert!(sample("1.5,-1").is_none() && sample("a,b,c").is_none());
    }
}
