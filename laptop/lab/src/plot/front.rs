//! Draws Pareto fronts of spikes against error. The front of a scheme consists of the settings that no other settings
//! of the scheme beat in both spikes and error. The common front consists of the settings that no settings of any
//! scheme beat. A scheme that forms part of the common front has a colour, and a name beside its line. All other
//! schemes are grey.

use super::FONT;
use super::palette::{DISTINCT, GRID, INK, OTHERS};
use super::title::Drawn;
use crate::scheme::Scheme;
use crate::tune::Curve;
use plotters::coord::Shift;
use plotters::prelude::*;

/// The Pareto fronts of all schemes on one channel. A front holds the best trade-offs of spikes against error.
pub struct Panel {
    /// Name of the channel.
    pub title: String,
    /// The signal's unit, if it is known.
    pub unit: Option<String>,
    /// The Pareto front of each scheme: its best settings, by spikes and error.
    pub curves: Vec<Curve>,
}

/// Font size of a panel's title, legible when the picture is as narrow as a phone.
const TITLE: i32 = 22;
/// Font size in pixels of all text except the titles of panels. The text is legible when the picture is as narrow as a
/// phone.
const TEXT: i32 = 19;
const HEAD: i32 = 34;
const LABELS: u32 = 84;
/// Height of a line of the legend, in pixels.
const LINE: i32 = 28;
/// Efficiency at the lower end of the axis, in percent. It stands for 2 spikes a sample. Population codes with more
/// spikes a sample are not drawn.
const LOWEST: f64 = -100.0;
/// Number of steps into which the efficiency axis is divided to compare schemes.
const STEPS: usize = 400;

/// A scheme that forms part of the common front, and the colour of its line. The common front gives the least error of
/// all schemes at each efficiency.
pub(super) type Named = (Scheme, RGBColor);

/// Returns the efficiency, in percent, at the given step along the axis, from 0 to [`STEPS`].
fn efficiency_at(step: usize) -> f64 {
    let part = step as f64 / STEPS as f64;
    LOWEST + part * (100.0 - LOWEST)
}

impl Panel {
    /// Returns the common front, with one entry for each step along the efficiency axis. An entry holds the scheme, the
    /// efficiency and the error of one point. This point has the least error among all points with at least the step's
    /// efficiency. The entry is `None` if no scheme reaches the step's efficiency.
    fn front(&self) -> Vec<Option<(Scheme, f64, f64)>> {
        let best = |step| {
            let at = efficiency_at(step);
            let points = self.curves.iter().flat_map(|curve| {
                let allowed = curve.points.iter().filter(move |point| point.0 >= at);
                allowed.map(move |point| (curve.scheme, point.0, point.1))
            });
            points.filter(|point| point.2 > 0.0).min_by(|a, b| a.2.total_cmp(&b.2))
        };
        (0..=STEPS).map(best).collect()
    }
}

/// Chooses the schemes that are drawn with a name and a colour, and gives each of them a colour. Counts how many points
/// each scheme has on the common fronts of all channels. Returns the schemes with the most points, in descending order.
/// Leaves out schemes with few points, and schemes for which no colour is left.
pub(super) fn named(panels: &[Panel]) -> Vec<Named> {
    /// Limit on the share of a scheme in the points of all common fronts. A scheme whose share is at or below the limit
    /// gets no name and no colour.
    const PART: f64 = 0.03;
    let mut shares: Vec<(Scheme, usize)> = Vec::new();
    for (scheme, ..) in panels.iter().flat_map(Panel::front).flatten() {
        match shares.iter_mut().find(|(known, _)| *known == scheme) {
            Some((_, share)) => *share += 1,
            None => shares.push((scheme, 1)),
        }
    }
    let all: usize = shares.iter().map(|(_, share)| share).sum();
    shares.sort_by_key(|(_, share)| std::cmp::Reverse(*share));
    let large = shares.into_iter().filter(|(_, share)| *share as f64 > PART * all as f64);
    large.map(|(scheme, _)| scheme).zip(DISTINCT).collect()
}

/// Returns the height in pixels of a legend that is `width` pixels wide. The legend lists the schemes in `named`.
pub(super) fn legend_height(named: &[Named], width: u32) -> u32 {
    let columns = (width as i32 / ENTRY).max(1);
    (((named.len() as i32 + 2 + columns - 1) / columns) * LINE + 12) as u32
}

/// Width of an entry of the legend, in pixels.
const ENTRY: i32 = 260;

/// Draws the legend for all panels.
pub(super) fn legend<B: DrawingBackend>(area: &DrawingArea<B, Shift>, named: &[Named]) -> Drawn<B> {
    let columns = (area.dim_in_pixel().0 as i32 / ENTRY).max(1);
    let text = (FONT, TEXT).into_font().color(&INK);
    let corner = |number: i32| (14 + number % columns * ENTRY, 8 + number / columns * LINE);
    let lines = named.iter().map(|(scheme, colour)| (scheme.info().title, colour, 4));
    for (number, (name, colour, width)) in (0..).zip(lines.chain([("other schemes", &OTHERS, 2)])) {
        let (left, top) = corner(number);
        let stroke = colour.stroke_width(width);
        area.draw(&PathElement::new([(left, top + 11), (left + 30, top + 11)], stroke))?;
        area.draw(&Text::new(name, (left + 40, top), text.clone()))?;
    }
    let (left, top) = corner(named.len() as i32 + 1);
    area.draw(&Circle::new((left + 15, top + 11), 6, INK.stroke_width(2)))?;
    area.draw(&Text::new("the paper's settings", (left + 40, top), text))?;
    Ok(())
}

/// Draws the fronts of one channel.
pub(super) fn draw<B: DrawingBackend>(
    area: &DrawingArea<B, Shift>,
    panel: &Panel,
    named: &[Named],
) -> Drawn<B> {
    let unit = panel.unit.as_ref().map_or(String::new(), |unit| format!(", {unit}"));
    let title = (FONT, TITLE).into_font().color(&INK);
    area.draw(&Text::new(format!("{}: RMSE{unit}", panel.title), (14, 6), title))?;
    let colour = |scheme: Scheme| named.iter().find(|(own, _)| *own == scheme).map(|own| own.1);
    let all = || panel.curves.iter().flat_map(|curve| &curve.points).filter(|own| own.0 >= LOWEST);
    let (mut low, mut high) = (f64::INFINITY, 0.0_f64);
    for (_, error) in all().filter(|(_, error)| *error > 0.0) {
        (low, high) = (low.min(*error), high.max(*error));
    }
    if low > high {
        return Ok(());
    }
    let left = all().map(|(efficiency, _)| *efficiency).fold(0.0, f64::min);
    let (low, high) = (low * 0.6, high * 1.25);
    let text = (FONT, TEXT).into_font().color(&INK);
    let mut chart = ChartBuilder::on(&area.margin(HEAD, 4, 4, 16))
        .set_label_area_size(LabelAreaPosition::Left, LABELS)
        .set_label_area_size(LabelAreaPosition::Bottom, 60)
        .build_cartesian_2d(left..100.0, (low..high).log_scale())?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(GRID)
        .axis_style(GRID)
        .x_labels(5)
        .y_labels(4)
        .x_desc("samples without a spike, %")
        .x_label_formatter(&|value| format!("{value:.0}"))
        .y_label_formatter(&|value| crate::brief::short((value * 1e4).round() / 1e4))
        .axis_desc_style(text.clone())
        .label_style(text.clone())
        .draw()?;
    let inside = |point: &&(f64, f64)| point.0 >= left && point.1 > 0.0;
    let mut sorted: Vec<&Curve> = panel.curves.iter().collect();
    sorted.sort_by_key(|curve| colour(curve.scheme).is_some());
    for curve in sorted {
        let points: Vec<(f64, f64)> = curve.points.iter().filter(inside).copied().collect();
        let stroke = colour(curve.scheme).map_or(OTHERS.stroke_width(1), |own| own.stroke_width(4));
        if let Some(own) = colour(curve.scheme) {
            let dot = |point: &(f64, f64)| Circle::new(*point, 3, own.filled());
            chart.draw_series(points.iter().map(dot))?;
        }
        chart.draw_series(LineSeries::new(points, stroke))?;
        let paper = curve.paper.as_ref().filter(inside).filter(|own| own.1 < high && own.1 > low);
        if let (Some(paper), Some(own)) = (paper, colour(curve.scheme)) {
            chart.draw_series([Circle::new(*paper, 6, own.filled())])?;
            chart.draw_series([Circle::new(*paper, 6, INK.stroke_width(2))])?;
        }
    }
    let (columns, rows) = chart.plotting_area().dim_in_pixel();
    let mut taken: Vec<(i32, i32)> = Vec::new();
    for (scheme, colour) in named {
        let Some(at) = own_middle(panel, *scheme, left) else { continue };
        let name = scheme.info().title;
        let style = (FONT, TEXT).into_font().style(FontStyle::Bold).color(colour);
        let (width, height) = area.estimate_text_size(name, &style)?;
        let (mut x, mut y) = chart.plotting_area().map_coordinate(&at);
        let (x_range, y_range) = chart.plotting_area().get_pixel_range();
        // The name stands below its line, where no setting lies, clear of other names and within the axes.
        x = (x + 6)
            .clamp(x_range.start + 4, (x_range.start + columns as i32 - width as i32 - 4).max(0));
        y += 6;
        while taken.iter().any(|(_, other)| (other - y).abs() < height as i32) {
            y += 2;
        }
        y = y.clamp(y_range.start, y_range.start + rows as i32 - height as i32);
        taken.push((x, y));
        let (left, top) = area.get_base_pixel();
        area.draw(&Text::new(name, (x - left, y - top), style))?;
    }
    Ok(())
}

/// Returns the efficiency and error of the point at which the name of `scheme` is drawn. It is the middle one of the
/// scheme's points on the common front, which [`Panel::front`] defines. Points with an efficiency below `left` percent
/// are ignored. Returns `None` if no point remains.
fn own_middle(panel: &Panel, scheme: Scheme, left: f64) -> Option<(f64, f64)> {
    let own = panel.front().into_iter().flatten().filter(|(own, ..)| *own == scheme);
    let points: Vec<(f64, f64)> =
        own.map(|(_, efficiency, error)| (efficiency, error)).filter(|own| own.0 >= left).collect();
    points.get(points.len() / 2).copied()
}

#[cfg(test)]
mod tests {
    use super::{Curve, Panel, named};
    use crate::scheme::Scheme;

    #[test]
    fn the_schemes_that_make_the_front_have_names() {
        let curve = |name: &str, points: &[(f64, f64)]| Curve {
            scheme: Scheme::named(name).unwrap(),
            points: points.to_vec(),
            paper: None,
        };
        let panel = Panel {
            title: "x".to_owned(),
            unit: None,
            curves: vec![
                curve("tbr", &[(0.0, 0.9), (90.0, 2.0)]),
                curve("sf", &[(50.0, 0.2), (80.0, 0.3), (99.0, 0.8)]),
                curve("weighted-phase", &[(-80.0, 0.001), (-10.0, 0.1)]),
            ],
        };
        let named: Vec<&str> =
            named(&[panel]).into_iter().map(|(scheme, _)| scheme.name()).collect();
        assert_eq!(named, ["sf", "weighted-phase"]);
    }
}
