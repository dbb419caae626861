//! `plot`: PNG and SVG show the same picture, long curves are decimated, and panels state units, parameters and
//! latency.

mod common;

use common::{file, flight, ran};
use std::fmt::Write;
use std::fs;
use tiny_skia::Pixmap;

/// Runs `plot`; returns the bytes of the picture, and standard error.
fn plot(options: &str, ending: &str) -> (Vec<u8>, String) {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("picture").with_extension(ending);
    let report = ran!("plot {options} -o {}", path.display()).stderr;
    (fs::read(path).unwrap(), report)
}

fn svg(options: &str) -> String {
    String::from_utf8(plot(options, "svg").0).unwrap()
}

/// Colour of the decoded curve, as red, green, blue.
const DECODED: [u8; 3] = [0xe8, 0x7d, 0x1e];

/// Returns the points of the longest curve of this colour in an SVG.
fn curve(svg: &str, colour: &str) -> Vec<(f64, f64)> {
    let lines = svg.lines().filter(|line| line.contains("<polyline") && line.contains(colour));
    let points = |line: &str| -> Vec<(f64, f64)> {
        let (_, points) = line.split_once("points=\"").unwrap();
        let points = points.split('"').next().unwrap().split_whitespace();
        points
            .map(|point| {
                let (x, y) = point.split_once(',').unwrap();
                (x.parse().unwrap(), y.parse().unwrap())
            })
            .collect()
    };
    lines.map(points).max_by_key(Vec::len).unwrap()
}

/// The PNG and the SVG of a plot show the same decoded curve. In the PNG, no pixel above the highest point of this
/// curve has the curve's colour.
#[test]
fn png_shows_what_svg_shows() {
    let hexarotor = flight("hexarotor.csv");
    for options in [
        format!("--scheme position --paper --column gyro_x {hexarotor}"),
        format!("--scheme sf --threshold 0.1 --column gyro_x --range 2350..2700 {hexarotor}"),
    ] {
        let curve = curve(&svg(&options), "#E87D1E");
        let pixels = Pixmap::decode_png(&plot(&options, "png").0).unwrap();
        let is_decoded = |x: f64, y: f64| {
            let near = |offset: f64| (-1..=1).map(move |step| offset.round() as i32 + step);
            near(x).any(|x| {
                near(y).any(|y| {
                    pixels.pixel(x as u32, y as u32).is_some_and(|pixel| {
                        let colours = [pixel.red(), pixel.green(), pixel.blue()];
                        colours
                            .iter()
                            .zip(DECODED)
                            .all(|(&ours, theirs)| ours.abs_diff(theirs) < 70)
                    })
                })
            })
        };
        let mut missing = 0;
        let mut looked = 0;
        for pair in curve.windows(2) {
            let ((x0, y0), (x1, y1)) = (pair[0], pair[1]);
            let steps = (x1 - x0).abs().max((y1 - y0).abs()).max(1.0);
            for step in 0..=steps as u32 {
                let part = f64::from(step) / steps;
                looked += 1;
                missing += u32::from(!is_decoded(x0 + part * (x1 - x0), y0 + part * (y1 - y0)));
            }
        }
        assert!(looked > 1000 && missing == 0, "{options}: {missing} of {looked}");
        let top = curve.iter().fold(f64::MAX, |top, point| top.min(point.1));
        let beyond = (60..top as u32 - 2).flat_map(|y| (70..pixels.width()).map(move |x| (x, y)));
        let beyond = beyond.filter(|&(x, y)| {
            let pixel = pixels.pixel(x, y).unwrap();
            [pixel.red(), pixel.green(), pixel.blue()] == DECODED
        });
        assert_eq!(beyond.count(), 0, "{options}");
    }
}

#[test]
fn a_long_recording_makes_a_small_picture_with_its_extremes() {
    let mut signal = "x\n".to_owned();
    for sample in 0..300_000 {
        let value = if sample == 123_456 { 50.0 } else { f64::from(sample % 97) / 10.0 };
        writeln!(signal, "{value}").unwrap();
    }
    let (_directory, path) = file("long.csv", signal);
    let text = svg(&format!("--scheme sf --threshold 0.05 --rate 1000 {path}"));
    assert!(text.len() < 600_000, "{}", text.len());
    let all = curve(&text, "#1F5FA8");
    let (low, high) = all
        .iter()
        .fold((f64::MIN, f64::MAX), |(low, high), point| (low.max(point.1), high.min(point.1)));
    assert_eq!(all.iter().filter(|point| point.1 == high).count(), 1, "the one peak");
    assert!(low - high > 200.0 && all.len() < 4 * 960, "{} points", all.len());
}

#[test]
fn panels_tell_unit_parameters_and_latency() {
    let hexarotor = flight("hexarotor.csv");
    let text =
        svg(&format!("--scheme sf --threshold 0.1 --unit rad/s --column gyro_x {hexarotor}"));
    for words in ["gyro_x, rad/s", "threshold=0.1", "time, s", "signal", "decoded"] {
        assert!(text.contains(words), "{words}");
    }
    assert!(!text.contains("latency"));
    let text = svg(&format!("--scheme hsa --filter triang:15 --column gyro_x {hexarotor}"));
    assert!(text.contains("15 taps, sum 8") && text.contains("without its latency of 14 samples"));
    let (_directory, path) = file("x.csv", "x\n0\n1\n0\n");
    assert!(svg(&format!("--scheme sf --threshold 0.5 {path}")).contains("\nsample\n"));
}

/// The legend stands above the highest point of the signal's curve.
#[test]
fn the_legend_is_off_the_curves() {
    let hexarotor = flight("hexarotor.csv");
    let text = svg(&format!("--scheme sf --threshold 0.1 --column gyro_x {hexarotor}"));
    let top = curve(&text, "#1F5FA8").iter().fold(f64::MAX, |top, point| top.min(point.1));
    let label = text.split("<text ").find(|text| text.contains("\ndecoded\n")).unwrap();
    let y: f64 = label.split("y=\"").nth(1).unwrap().split('"').next().unwrap().parse().unwrap();
    assert!(y + 13.0 < top, "{y} {top}");
}
