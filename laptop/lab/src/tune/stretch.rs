//! Stretches of recordings, some to tune on and some held out.

use crate::resolution::held;
use crate::trial::Recording;
use anyhow::{Result, bail};
use catalogue::run::SampleType;
use std::ops::Range;

/// Samples in a row, coded from the first of them on.
#[derive(Clone, Debug)]
pub struct Stretch {
    /// The samples.
    pub values: Vec<f64>,
    /// Samples a second, if known.
    pub rate: Option<f64>,
}

impl Stretch {
    /// All of a recording, a stretch for each segment.
    pub fn whole(recording: &Recording) -> Vec<Self> {
        let stretch = |segment: &Range<usize>| Self {
            values: recording.values[segment.clone()].to_vec(),
            rate: recording.rate,
        };
        recording.segments.iter().map(stretch).collect()
    }

    /// The samples as a sample type holds them.
    pub fn rounded(&self, sample: SampleType) -> Vec<f64> {
        self.values.iter().map(|value| held(sample, *value)).collect()
    }
}

/// How much of a recording is held out.
#[derive(Clone, Copy, Debug)]
pub struct HoldOut {
    /// Number of blocks into which it is cut.
    pub blocks: usize,
    /// The part of the blocks that is held out.
    pub part: f64,
}

/// A block of fewer samples says nothing.
const SHORTEST: usize = 20;

/// The offset with which the blocks held out are evenly spread, and neither the first nor the last.
const OFFSET: f64 = 0.35;

/// The stretches to tune on, and those held out: blocks next to each other are one stretch.
///
/// # Errors
/// The blocks are too short, or none is left to tune on.
pub fn cut(recording: &Recording, hold_out: HoldOut) -> Result<(Vec<Stretch>, Vec<Stretch>)> {
    let HoldOut { blocks, part } = hold_out;
    let samples = recording.values.len();
    if part == 0.0 {
        return Ok((Stretch::whole(recording), Vec::new()));
    }
    if samples < blocks * SHORTEST {
        bail!(
            "{}: {samples} samples are too few to tune on some and hold out others; {} would do, or `hold_out` 0 \
             with nothing to check the settings on",
            recording.name,
            blocks * SHORTEST
        );
    }
    let before_it = |block: usize| (block as f64 * part + OFFSET).floor();
    let is_held_out = |block: usize| before_it(block + 1) > before_it(block);
    let (mut kept, mut kept_back) = (Vec::new(), Vec::new());
    let mut before = None;
    for block in 0..blocks {
        let (start, end) = (samples * block / blocks, samples * (block + 1) / blocks);
        let side = if is_held_out(block) { &mut kept_back } else { &mut kept };
        for segment in &recording.segments {
            let own = start.max(segment.start)..end.min(segment.end);
            if own.is_empty() {
                continue;
            }
            // A block goes on from the one before it, if both are of one segment.
            let goes_on = before == Some(is_held_out(block)) && own.start > segment.start;
            let values = &recording.values[own];
            match side.last_mut().filter(|_| goes_on) {
                Some(Stretch { values: last, .. }) => last.extend_from_slice(values),
                None => side.push(Stretch { values: values.to_vec(), rate: recording.rate }),
            }
            before = Some(is_held_out(block));
        }
    }
    if kept.is_empty() || kept_back.is_empty() {
        bail!("`hold_out` {part} of {blocks} blocks leaves none to tune on or none to check on");
    }
    Ok((kept, kept_back))
}
