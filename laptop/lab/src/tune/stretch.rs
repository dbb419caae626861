//! Cuts recordings into stretches to tune on and stretches to hold out.

use super::RequestKind;
use crate::Result;
use crate::resolution::held;
use crate::trial::Recording;
use catalogue::run::{Event, Given, SampleType};
use std::ops::Range;

/// Consecutive samples that are coded in one piece. Only the samples in the ranges `scored` are scored.
#[derive(Clone, Debug)]
pub struct Stretch {
    /// The samples that are coded.
    pub values: Vec<f64>,
    /// Sample rate in Hz, if known.
    pub rate: Option<f64>,
    /// Index ranges of the samples that are scored, in order and disjoint.
    pub scored: Vec<Range<usize>>,
    /// Index of the log that the samples are from.
    pub flight: usize,
}

impl Stretch {
    /// Makes one stretch of each segment of a recording. A restart of the recorder's clock begins a new segment.
    pub fn whole(recording: &Recording) -> Vec<Self> {
        let stretch = |own: &Range<usize>| {
            let scored = std::iter::once(0..own.len()).collect();
            Self::scored(recording, own, scored)
        };
        recording.segments.iter().map(stretch).collect()
    }

    /// Makes a stretch of the recording's samples in the index range `own`. The ranges in `scored` are relative to the
    /// start of `own`.
    fn scored(recording: &Recording, own: &Range<usize>, scored: Vec<Range<usize>>) -> Self {
        let values = recording.values[own.clone()].to_vec();
        Self { values, rate: recording.rate, scored, flight: 0 }
    }

    /// Returns each range of samples that are scored.
    pub fn scored_values(&self) -> impl Iterator<Item = &[f64]> {
        self.scored.iter().filter_map(|own| self.values.get(own.clone()))
    }

    /// Returns the number of samples that are scored.
    pub fn samples(&self) -> usize {
        self.scored.iter().map(Range::len).sum()
    }

    /// Returns the duration of the scored samples in seconds, if the rate is known.
    pub fn seconds(&self) -> Option<f64> {
        self.rate.map(|rate| self.samples() as f64 / rate)
    }

    /// Returns the events of each range of samples that are scored. `events` must be in the order of their samples.
    pub fn scored_events<'a>(&'a self, events: &'a [Event]) -> impl Iterator<Item = &'a [Event]> {
        let before = move |sample: usize| events.partition_point(|own| own.sample < sample as u64);
        self.scored.iter().map(move |own| &events[before(own.start)..before(own.end)])
    }

    /// Returns the samples, each rounded to the nearest value that the sample type `sample` can hold.
    pub fn rounded(&self, sample: SampleType) -> Vec<f64> {
        self.values.iter().map(|value| held(sample, *value)).collect()
    }
}

/// The part of the recordings that is held out.
#[derive(Clone, Copy, Debug)]
pub struct HoldOut {
    /// Number of blocks into which a single recording is cut.
    pub blocks: usize,
    /// Share that is held out: of several logs or, if there is only one, of its blocks.
    pub part: f64,
}

/// Minimum number of samples in each block of a recording.
const SHORTEST: usize = 20;

/// Offset of the held-out blocks, which are spread evenly. Block `i` is held out if `floor((i + 1) * part + OFFSET)` is
/// greater than `floor(i * part + OFFSET)`, where `part` is the share of held-out blocks. If 30 % of 20 blocks are held
/// out, this offset leaves both the first and the last block for tuning.
const OFFSET: f64 = 0.35;

/// Cuts a recording into blocks. Returns the stretches whose blocks to tune on are scored, and the stretches whose
/// held-out blocks are scored.
///
/// All blocks are coded as in flight: each segment is coded in one piece, and either the blocks to tune on or the
/// held-out blocks are scored. If each block were coded alone, a code that drifts would start it from the right value,
/// and its drift would not show.
///
/// # Errors
/// Returns an error if the blocks are too short, or if no block is left to tune on.
pub fn cut(recording: &Recording, hold_out: HoldOut) -> Result<(Vec<Stretch>, Vec<Stretch>)> {
    let HoldOut { blocks, part } = hold_out;
    let samples = recording.values.len();
    if part == 0.0 {
        return Ok((Stretch::whole(recording), Vec::new()));
    }
    if samples < blocks * SHORTEST {
        let kind = RequestKind::TooShort { samples, enough: blocks * SHORTEST };
        return Err(kind.at(&recording.name));
    }
    let before_it = |block: usize| (block as f64 * part + OFFSET).floor();
    let is_held_out = |block: usize| before_it(block + 1) > before_it(block);
    let (mut tuned_on, mut checked) = (Vec::new(), Vec::new());
    for segment in &recording.segments {
        let mut sides: [Vec<Range<usize>>; 2] = Default::default();
        for block in 0..blocks {
            let (start, end) = (samples * block / blocks, samples * (block + 1) / blocks);
            let own = start.max(segment.start)..end.min(segment.end);
            if own.is_empty() {
                continue;
            }
            sides[usize::from(is_held_out(block))].push(own);
        }
        for (side, all) in sides.into_iter().zip([&mut tuned_on, &mut checked]) {
            if !side.is_empty() {
                let from_start =
                    |own: &Range<usize>| own.start - segment.start..own.end - segment.start;
                let scored = side.iter().map(from_start).collect();
                all.push(Stretch::scored(recording, segment, scored));
            }
        }
    }
    if tuned_on.is_empty() || checked.is_empty() {
        return Err(RequestKind::LeavesNone { blocks }.of(Given::new("hold_out", part)));
    }
    Ok((tuned_on, checked))
}

#[cfg(test)]
mod tests {
    use super::{HoldOut, Stretch, cut};
    use crate::trial::Recording;

    /// If 40 % of 5 blocks are held out, these are the second and the fifth block. All blocks are coded in one piece.
    #[test]
    fn all_blocks_are_coded_in_one_piece() {
        let values: Vec<f64> = (0..200).map(f64::from).collect();
        let recording = Recording::of("x".to_owned(), values.clone(), Some(100.0));
        let (kept, held_out) = cut(&recording, HoldOut { blocks: 5, part: 0.4 }).unwrap();
        let [Stretch { values: coded, scored, .. }] = &kept[..] else { panic!("{kept:?}") };
        assert_eq!((coded, &scored[..]), (&values, &[0..40, 80..120, 120..160][..]));
        let [Stretch { values: coded, scored, .. }] = &held_out[..] else { panic!("{held_out:?}") };
        assert_eq!((coded, &scored[..]), (&values, &[40..80, 160..200][..]));
        assert_eq!((held_out[0].samples(), held_out[0].seconds()), (80, Some(0.8)));
    }
}
