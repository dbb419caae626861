//! Codes of several channels at once, each channel in a lane of the processor's vectors, with the spikes that the crate's
//! encoder of one channel gives, bit for bit.

// What is not inlined is compiled for a processor without wide vectors.
#![allow(clippy::inline_always)]

mod filter;
mod step;

use std::any::Any;

use pulp::{Arch, Simd, WithSimd};
use spikewire::Scheme;
use spikewire::dynamic::{Bsa, Hough, MovingWindow, ThresholdHough};
use spikewire::rate::{Criterion, IntegrateAndFire};
use spikewire::temporal::{StepForward, TemporalContrast};

use filter::{Filter, Fits};

/// A code with its parameters.
pub(super) struct Lanes {
    rule: Rule,
    taps: Vec<f32>,
    shift: f32,
    arch: Arch,
    /// Rows of a number of each channel, oldest first: what past spikes have left of the samples, and the spikes.
    residuals: Vec<f32>,
    spikes: Vec<f32>,
}

/// When a sample spikes.
#[derive(Clone, Copy)]
enum Rule {
    Hough,
    ThresholdHough(f32),
    Bsa(Criterion<f32>),
    TemporalContrast(f32),
    StepForward(f32),
    MovingWindow { threshold: f32, count: usize },
    Integrate(IntegrateAndFire<f32, 127>),
}

/// The largest threshold of T-HSA of which the double is surely finite.
const LARGEST: f32 = 1e38;

impl Rule {
    /// Returns the rule of a scheme, and what it subtracts from its samples; `None` if it has no lanes.
    fn of(scheme: &dyn Any) -> Option<(Self, &[f32], f32)> {
        if let Some(own) = scheme.downcast_ref::<Hough<f32>>() {
            return Some((Self::Hough, own.taps().as_slice(), own.shift()));
        }
        if let Some(own) = scheme.downcast_ref::<ThresholdHough<f32>>() {
            let rule = Self::ThresholdHough(own.threshold());
            return (own.threshold() <= LARGEST)
                .then(|| (rule, own.taps().as_slice(), own.shift()));
        }
        if let Some(own) = scheme.downcast_ref::<Bsa<f32>>() {
            return Some((Self::Bsa(own.criterion()), own.taps().as_slice(), own.shift()));
        }
        if let Some(own) = scheme.downcast_ref::<TemporalContrast<f32>>() {
            return Some((Self::TemporalContrast(own.threshold()), &[], 0.0));
        }
        if let Some(own) = scheme.downcast_ref::<StepForward<f32>>() {
            return Some((Self::StepForward(own.threshold()), &[], 0.0));
        }
        if let Some(own) = scheme.downcast_ref::<MovingWindow<f32>>() {
            let rule = Self::MovingWindow { threshold: own.threshold(), count: own.count() };
            return Some((rule, &[], 0.0));
        }
        let own = scheme.downcast_ref::<IntegrateAndFire<f32, 127>>()?;
        (own.slots() == 1).then(|| (Self::Integrate(*own), &[][..], own.reference()))
    }
}

impl Lanes {
    /// Returns the lanes of a scheme; `None` if it has none, or the processor no wide vectors.
    pub(super) fn of(scheme: &dyn Any) -> Option<Self> {
        let (rule, taps, shift) = Rule::of(scheme)?;
        let (taps, arch) = (taps.to_vec(), Arch::new());
        let own = Self { rule, taps, shift, arch, residuals: Vec::new(), spikes: Vec::new() };
        (arch.dispatch(Width) > 1).then_some(own)
    }

    /// Returns how many channels take less time at once than one after the other.
    pub(super) fn least(&self) -> usize {
        match self.rule {
            Rule::MovingWindow { .. } | Rule::Integrate(_) => 3,
            _ => 2,
        }
    }

    /// Returns whether one channel after the other takes less time where there are few spikes: step forward, which
    /// compares several samples of a channel at once as long as none leaves the band.
    pub(super) fn is_slow_at_rest(&self) -> bool {
        matches!(self.rule, Rule::StepForward(_))
    }

    /// Encodes recordings into cells that are all 0. Returns false, with some of the cells written, if a potential exceeds
    /// all numbers, so that a sample must be rejected.
    pub(super) fn encode(&mut self, recordings: Recordings, cells: &mut [i8]) -> bool {
        self.arch.dispatch(Call { lanes: self, recordings, cells })
    }
}

/// The number of lanes.
struct Width;

impl WithSimd for Width {
    type Output = usize;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> usize {
        S::F32_LANES
    }
}

/// Recordings of one length, one after the other.
#[derive(Clone, Copy)]
pub(super) struct Recordings<'a> {
    /// Samples, all finite.
    pub(super) samples: &'a [f32],
    /// Number of samples of a recording.
    pub(super) length: usize,
    /// Number of its own samples from which the encoder of a recording starts; `None` if all start from `past`.
    pub(super) begins_with: Option<usize>,
    pub(super) past: &'a [f32],
}

impl Recordings<'_> {
    /// Returns the samples from which the encoder of a recording starts.
    fn past(&self, lane: usize) -> &[f32] {
        let Some(count) = self.begins_with else { return self.past };
        let own = &self.samples[lane * self.length..][..self.length];
        &own[..count.min(self.length)]
    }

    fn count(&self) -> usize {
        self.samples.len() / self.length
    }
}

/// Returns a row of a number of each lane.
#[inline(always)]
fn row<S: Simd>(_: S, count: usize, number: impl Fn(usize) -> f32) -> S::f32s {
    const MOST: usize = 16;
    let mut row = [0.0; MOST];
    for (lane, own) in row.iter_mut().enumerate().take(count) {
        *own = number(lane);
    }
    S::as_simd_f32s(&row).0[0]
}

/// A code with the state of its lanes.
trait Code<S: Simd> {
    /// Number of samples that a sample's spike waits for.
    fn look_ahead(&self) -> usize {
        0
    }

    /// Writes the spikes of the first rows: the bits of 1 for up, all bits for down, none without. `samples` are these rows
    /// and the look-ahead, as far as the recording goes. The first row is that of the samples of number `at`.
    fn encode(&mut self, simd: S, at: usize, samples: &mut [S::f32s], spikes: &mut [S::f32s]);

    /// Whether all numbers were finite.
    fn is_sound(&self, _: S) -> bool {
        true
    }
}

/// Returns the spikes of a row.
#[inline(always)]
fn spikes<S: Simd>(simd: S, up: S::m32s, down: S::m32s) -> S::f32s {
    let [none, one, all] = [0, 1, u32::MAX].map(|bits| simd.splat_f32s(f32::from_bits(bits)));
    simd.select_f32s(up, one, simd.select_f32s(down, all, none))
}

/// The call of [`Lanes::encode`].
struct Call<'a> {
    lanes: &'a mut Lanes,
    recordings: Recordings<'a>,
    cells: &'a mut [i8],
}

impl WithSimd for Call<'_> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> bool {
        match self.lanes.rule {
            Rule::Hough => self.filter(simd, filter::Hough),
            Rule::ThresholdHough(threshold) => self.filter(simd, filter::Short(threshold)),
            Rule::Bsa(Criterion::Subtractive(by)) => self.filter(simd, filter::Less(by)),
            Rule::Bsa(Criterion::Multiplicative(by)) => self.filter(simd, filter::Part(by)),
            Rule::TemporalContrast(threshold) => {
                step::contrast(self.recordings, threshold, self.cells);
                true
            }
            Rule::StepForward(threshold) => {
                let code = step::StepForward::new;
                self.encode(
                    simd,
                    #[inline(always)]
                    |_, own| code(simd, threshold, own),
                )
            }
            Rule::MovingWindow { threshold, count } => {
                let code = step::MovingWindow::new;
                self.encode(
                    simd,
                    #[inline(always)]
                    |_, own| code(simd, threshold, count, own),
                )
            }
            Rule::Integrate(scheme) => {
                let code = step::Integrate::new;
                self.encode(
                    simd,
                    #[inline(always)]
                    |_, _| code(simd, &scheme),
                )
            }
        }
    }
}

impl Call<'_> {
    #[inline(always)]
    fn filter<S: Simd>(self, simd: S, rule: impl Fits) -> bool {
        self.encode(
            simd,
            #[inline(always)]
            |taps, _| Filter::new(rule, taps),
        )
    }

    /// Encodes as many recordings at once as there are lanes.
    #[inline(always)]
    fn encode<S: Simd, C: Code<S>>(
        self,
        simd: S,
        code: impl Fn(Vec<f32>, &Recordings) -> C,
    ) -> bool {
        // Never reached: it spares compiling the rest without vectors.
        if S::F32_LANES == 1 {
            return false;
        }
        let Self { lanes, recordings, cells } = self;
        let (length, group) = (recordings.length, recordings.length * S::F32_LANES);
        let groups = recordings.samples.chunks(group).zip(cells.chunks_mut(group));
        let mut are_sound = true;
        for (samples, cells) in groups {
            let own = Recordings { samples, ..recordings };
            let mut code = code(lanes.taps.clone(), &own);
            encode_group(simd, lanes, &mut code, samples, length, cells);
            are_sound &= code.is_sound(simd);
        }
        are_sound
    }
}

/// Encodes as many recordings as there are lanes at most.
#[inline(always)]
fn encode_group<S: Simd>(
    simd: S,
    lanes: &mut Lanes,
    code: &mut impl Code<S>,
    samples: &[f32],
    length: usize,
    cells: &mut [i8],
) {
    /// Number of samples of each channel that are encoded before the next ones are read.
    const BLOCK: usize = 512;
    let Lanes { shift, residuals, spikes, .. } = lanes;
    let (width, ahead) = (S::F32_LANES, code.look_ahead());
    let residuals = room(residuals, (ahead + BLOCK) * width);
    let (mut kept, mut done) = (0, 0);
    while done < length {
        let taken = (length - done - kept).min(BLOCK);
        for (lane, samples) in samples.chunks(length).enumerate() {
            let samples = &samples[done + kept..][..taken];
            for (row, sample) in residuals[kept * width..].chunks_exact_mut(width).zip(samples) {
                row[lane] = sample - *shift;
            }
        }
        kept += taken;
        let is_end = done + kept == length;
        let count = if is_end { kept } else { kept.saturating_sub(ahead) };
        let spikes = room(spikes, count * width);
        let rows = S::as_mut_simd_f32s(&mut residuals[..kept * width]).0;
        code.encode(simd, done, rows, S::as_mut_simd_f32s(spikes).0);
        for (lane, cells) in cells.chunks_mut(length).enumerate() {
            for (cell, row) in cells[done..].iter_mut().zip(spikes.chunks_exact(width)) {
                *cell = row[lane].to_bits() as i8;
            }
        }
        residuals.copy_within(count * width..kept * width, 0);
        (kept, done) = (kept - count, done + count);
    }
}

/// Makes room for so many numbers, from the start of a line of the cache on, so that no row lies in two.
fn room(numbers: &mut Vec<f32>, count: usize) -> &mut [f32] {
    const LINE: usize = 64;
    const MOST: usize = LINE / size_of::<f32>();
    numbers.resize(count + MOST, 0.0);
    let start = numbers.as_ptr().align_offset(LINE).min(MOST);
    &mut numbers[start..][..count]
}
