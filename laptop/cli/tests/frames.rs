//! `frames`: the same brightness gives the same events in every format of video.

mod common;

use common::{file, ran};

/// Returns 8 frames whose pixels have brightnesses of 0 to 219, mapped to grey levels by `level`. Video of full range
/// (0 to 255) and of limited range (16 to 235) can both express 220 brightnesses, and so show the same pictures.
fn frames(level: impl Fn(u32) -> u8) -> Vec<Vec<u8>> {
    let frame =
        |frame: u32| (0..64 * 48).map(|pixel| level((pixel * 7 + frame * 61) % 220)).collect();
    (0..8).map(frame).collect()
}

/// Converts a YUV4MPEG2 video with the given header parameters to events, as CSV. `chroma` is the number of chroma
/// bytes after each frame; all of them are 128, grey.
fn events(header: &str, chroma: usize, frames: &[Vec<u8>]) -> String {
    let mut video = format!("YUV4MPEG2 W64 H48 F25:1 {header}\n").into_bytes();
    for frame in frames {
        video.extend(b"FRAME\n");
        video.extend(frame);
        video.extend(vec![128; chroma]);
    }
    let (directory, path) = file("x.y4m", video);
    let output = directory.path().join("x.csv");
    ran!("frames {path} --threshold 10 -o {}", output.display());
    std::fs::read_to_string(output).unwrap()
}

#[test]
fn full_and_limited_range_give_the_same_events() {
    const CHROMA: usize = 2 * 32 * 24;
    let full = frames(|step| ((step.min(219) * 255 + 109) / 219) as u8);
    let limited = frames(|step| 16 + step.min(219) as u8);
    let grey = events("Cmono", 0, &full);
    assert!(grey.lines().count() > 1000);
    assert_eq!(events("C420jpeg XCOLORRANGE=FULL", CHROMA, &full), grey);
    assert_eq!(events("C420jpeg XCOLORRANGE=LIMITED", CHROMA, &limited), grey);
    assert_eq!(events("C420mpeg2", CHROMA, &limited), grey);
}
