//! Samples of `NumPy` arrays as they lie in memory, and decoded values.

use std::{array, borrow::Cow, ops};

use catalogue::run::{self, Calibrated, Codec, SampleType};
use lab::fit::{self, Range};
use lab::resolution::Resolution;
use numpy::PyReadonlyArrayDyn;
use numpy::ndarray::{ArrayView1, ArrayViewD, Axis, Ix1, Ix2, Slice};
use pyo3::prelude::*;

use crate::channel::Bad;
use crate::error::value;

/// Samples; time runs along the last axis, and what is before it are channels.
#[derive(FromPyObject)]
pub(crate) enum Samples<'py> {
    /// `float32`.
    F32(PyReadonlyArrayDyn<'py, f32>),
    /// `float64`.
    F64(PyReadonlyArrayDyn<'py, f64>),
    /// `int16`.
    I16(PyReadonlyArrayDyn<'py, i16>),
}

/// Samples of any number of channels, as those of [`Samples`].
pub(crate) enum View<'a> {
    /// `float32`.
    F32(ArrayViewD<'a, f32>),
    /// `float64`.
    F64(ArrayViewD<'a, f64>),
    /// `int16`.
    I16(ArrayViewD<'a, i16>),
}

/// The samples of one channel, perhaps with others between them.
#[derive(Clone, Copy)]
pub(crate) enum Lane<'a> {
    /// `float32`.
    F32(ArrayView1<'a, f32>),
    /// `float64`.
    F64(ArrayView1<'a, f64>),
    /// `int16`.
    I16(ArrayView1<'a, i16>),
}

impl Lane<'_> {
    /// How many samples there are.
    pub(crate) fn len(&self) -> usize {
        match self {
            Self::F32(lane) => lane.len(),
            Self::F64(lane) => lane.len(),
            Self::I16(lane) => lane.len(),
        }
    }

    /// Some of the samples.
    pub(crate) fn part(&self, range: ops::Range<usize>) -> Lane<'_> {
        let part = Slice::from(range);
        match self {
            Self::F32(lane) => Lane::F32(lane.slice_axis(Axis(0), part)),
            Self::F64(lane) => Lane::F64(lane.slice_axis(Axis(0), part)),
            Self::I16(lane) => Lane::I16(lane.slice_axis(Axis(0), part)),
        }
    }

    /// The samples as doubles, exactly.
    pub(crate) fn to_vec(self) -> Vec<f64> {
        match self {
            Self::F32(lane) => lane.iter().copied().map(f64::from).collect(),
            Self::F64(lane) => lane.to_vec(),
            Self::I16(lane) => lane.iter().copied().map(f64::from).collect(),
        }
    }

    /// The samples, if they are neighbours in memory.
    pub(crate) fn in_memory(&self) -> Option<run::Samples<'_>> {
        match self {
            Self::F32(lane) => lane.as_slice().map(run::Samples::F32),
            Self::F64(lane) => lane.as_slice().map(run::Samples::F64),
            Self::I16(lane) => lane.as_slice().map(run::Samples::I16),
        }
    }

    /// Adds the samples, which are good, to a calibration.
    pub(crate) fn observe(&self, calibrated: &mut Calibrated) {
        match self.in_memory() {
            Some(samples) => calibrated.observe_samples(samples),
            None => calibrated.observe(&self.to_vec()),
        }
    }

    /// Encodes the samples, which are good, into rows of cells, and returns how many rows that made.
    pub(crate) fn encode(&self, codec: &mut Codec, cells: &mut [i8]) -> usize {
        match (self.in_memory(), self) {
            (Some(samples), _) => codec.encode_cells(samples, cells),
            (None, Self::F32(lane)) => codec.encode_cells(run::Samples::F32(&lane.to_vec()), cells),
            (None, lane) => codec.encode_cells(run::Samples::F64(&lane.to_vec()), cells),
        }
    }

    /// How many samples lie outside the range of this type.
    fn beyond(&self, sample: SampleType) -> usize {
        let (low, high) = sample.range();
        let is_beyond = |value: f64| value < low || value > high;
        match self {
            Self::F32(lane) => lane.iter().filter(|value| is_beyond(f64::from(**value))).count(),
            Self::F64(lane) => lane.iter().filter(|value| is_beyond(**value)).count(),
            Self::I16(lane) => lane.iter().filter(|value| is_beyond(f64::from(**value))).count(),
        }
    }

    /// Says that the type is too coarse for the steps from sample to sample, if it is.
    fn lost(&self, sample: SampleType) -> Option<String> {
        let values = match (self, sample) {
            // A type of 16 bits or more holds what comes in it or in whole numbers of 16 bits, unless it clamps.
            (Self::I16(_), _) | (Self::F32(_), SampleType::F32) => return None,
            (Self::F64(lane), _) if lane.as_slice().is_some() => Cow::Borrowed(lane.as_slice()?),
            _ => Cow::Owned(self.to_vec()),
        };
        if is_surely_fine(&values, sample) {
            return None;
        }
        Resolution::of(sample, &values).lost()
    }

    /// Whether all samples are numbers within bounds.
    pub(crate) fn lies_in(&self, bounds: &Bounds) -> bool {
        match self.in_memory() {
            Some(samples) => lies_in(samples, bounds),
            None => lies_in(run::Samples::F64(&self.to_vec()), bounds),
        }
    }

    /// The first sample that an encoder of this type does not take: it is not finite, or becomes so in the type.
    pub(crate) fn bad(&self, sample: SampleType) -> Option<Bad> {
        match self {
            Self::F32(lane) => {
                let place = match lane.as_slice() {
                    Some(samples) => first_bad(samples, |value| *value),
                    None => lane.iter().position(|value| !value.is_finite()),
                }?;
                Some(Bad { sample: place, what: format!("{} is not finite", lane[place]) })
            }
            Self::F64(lane) => {
                let place = match lane.as_slice() {
                    Some(samples) => first_bad_double(samples, sample),
                    None => first_bad_double(&lane.to_vec(), sample),
                }?;
                let value = lane[place];
                let what = if value.is_finite() { "beyond f32" } else { "not finite" };
                Some(Bad { sample: place, what: format!("{value:?} is {what}") })
            }
            Self::I16(_) => None,
        }
    }
}

/// A layout of channels in memory with even steps and no gaps: sample `time` of channel `block * width + place` has the
/// index `block * block_step + place + time * step`.
#[derive(Clone, Copy)]
pub(crate) struct Grid<'a> {
    /// The samples, in the order in which they lie in memory.
    pub(crate) all: run::Samples<'a>,
    /// Number of channels whose samples of one time are neighbours.
    width: usize,
    block_step: usize,
    step: usize,
    /// Number of samples of a channel.
    length: usize,
}

impl<'a> Grid<'a> {
    /// Returns the first samples of these channels, up to `count` of each.
    pub(crate) fn firsts(&self, channels: ops::Range<usize>, count: usize) -> Vec<f64> {
        match self.all {
            run::Samples::F32(all) => self.firsts_of(all, channels, count),
            run::Samples::F64(all) => self.firsts_of(all, channels, count),
            run::Samples::I16(all) => self.firsts_of(all, channels, count),
        }
    }

    fn firsts_of<T: Copy + Into<f64>>(
        &self,
        all: &[T],
        channels: ops::Range<usize>,
        count: usize,
    ) -> Vec<f64> {
        let times = 0..count.min(self.length);
        let mut firsts = Vec::with_capacity(channels.len() * times.len());
        for start in channels.map(|channel| self.start(channel)) {
            firsts.extend(times.clone().map(|time| all[start + time * self.step].into()));
        }
        firsts
    }

    fn start(&self, channel: usize) -> usize {
        channel / self.width * self.block_step + channel % self.width
    }

    /// Returns the samples of these channels, one channel after the other: where they are, or copied to the tile.
    pub(crate) fn channels<'b>(
        &self,
        channels: ops::Range<usize>,
        tile: &'b mut Tile,
    ) -> run::Samples<'b>
    where
        'a: 'b,
    {
        let is_in_order = self.width == 1 && self.step == 1 && self.block_step == self.length;
        if is_in_order {
            return self.all.part(channels.start * self.length..channels.end * self.length);
        }
        match self.all {
            run::Samples::F32(all) => run::Samples::F32(self.copied(all, channels, &mut tile.f32)),
            run::Samples::F64(all) => run::Samples::F64(self.copied(all, channels, &mut tile.f64)),
            run::Samples::I16(all) => run::Samples::I16(self.copied(all, channels, &mut tile.i16)),
        }
    }

    /// Copies channels by time, as neighbours share the lines of the cache.
    fn copied<'b, T: Copy + Default>(
        &self,
        all: &[T],
        channels: ops::Range<usize>,
        tile: &'b mut Vec<T>,
    ) -> &'b [T] {
        tile.resize(channels.len() * self.length, T::default());
        let mut channel = channels.start;
        while channel < channels.end {
            let count = (self.width - channel % self.width).min(channels.end - channel).min(RUN);
            let start = self.start(channel);
            let lanes = (channel - channels.start) * self.length;
            let lanes = &mut tile[lanes..lanes + count * self.length];
            let mut copy = |time: usize| {
                let row = &all[start + time * self.step..][..count];
                for (place, sample) in row.iter().enumerate() {
                    lanes[place * self.length + time] = *sample;
                }
            };
            let whole = if count == RUN { self.length / TIMES * TIMES } else { 0 };
            (whole..self.length).for_each(&mut copy);
            for time in (0..whole).step_by(TIMES) {
                let rows = array::from_fn(|row| &all[start + (time + row) * self.step..][..RUN]);
                transpose(rows, time, self.length, lanes);
            }
            channel += count;
        }
        tile
    }
}

/// Number of neighbouring channels that are copied together: 16 samples of `float32` at one time are a line of the cache.
pub(crate) const RUN: usize = 16;

/// Number of neighbouring times that are copied together.
const TIMES: usize = 8;

/// Copies [`RUN`] channels, of which the rows have these times, to lanes of this length.
#[inline]
fn transpose<T: Copy>(rows: [&[T]; TIMES], time: usize, length: usize, lanes: &mut [T]) {
    for (place, lane) in lanes.chunks_exact_mut(length).enumerate() {
        for (room, row) in lane[time..][..TIMES].iter_mut().zip(rows) {
            *room = row[place];
        }
    }
}

/// Room for copies of channels whose samples lie apart in memory.
#[derive(Default)]
pub(crate) struct Tile {
    f32: Vec<f32>,
    f64: Vec<f64>,
    i16: Vec<i16>,
}

/// Returns the grid of an array whose last axis is time; `None` if its steps are not even.
fn grid<'a, T>(
    view: &ArrayViewD<'a, T>,
    kind: impl Fn(&'a [T]) -> run::Samples<'a>,
) -> Option<Grid<'a>> {
    if view.is_empty() {
        return None;
    }
    let time = Axis(view.ndim().checked_sub(1)?);
    let length = view.len_of(time);
    let step = if length == 1 { 0 } else { usize::try_from(view.stride_of(time)).ok()? };
    // Without the axis of time where its step is 0, as a repeated sample is stored once.
    let once =
        if step == 0 { view.clone().index_axis_move(time, 0).into_dyn() } else { view.clone() };
    let start = once.as_ptr();
    let all =
        once.to_slice_memory_order().filter(|all| all.as_ptr() == start && !all.is_empty())?;
    let (mut width, mut blocks, mut block_step) = (1, 1, 0);
    for axis in (0..time.index()).rev().map(Axis).filter(|axis| view.len_of(*axis) > 1) {
        let (count, stride) = (view.len_of(axis), usize::try_from(view.stride_of(axis)).ok()?);
        if block_step == 0 && stride == width {
            width *= count;
        } else if block_step == 0 {
            (blocks, block_step) = (count, stride);
        } else if stride == block_step * blocks {
            blocks *= count;
        } else {
            return None;
        }
    }
    Some(Grid { all: kind(all), width, block_step, step, length })
}

/// Returns the place of the first sample that `narrow` makes infinite, or no number. Looks at blocks at first, where
/// infinite exponents carry into the sign.
fn first_bad<T>(samples: &[T], narrow: impl Fn(&T) -> f32) -> Option<usize> {
    const BLOCK: usize = 512;
    let carry = |own: &T| (narrow(own).to_bits() & 0x7FFF_FFFF) + 0x0080_0000;
    let is_bad = |own: &[T]| own.iter().fold(0, |all, own| all | carry(own)) >> 31 != 0;
    let start = samples.chunks(BLOCK).position(is_bad)? * BLOCK;
    Some(start + samples[start..].iter().position(|own| !narrow(own).is_finite())?)
}

/// Returns whether the type is certain to be fine enough for the steps from sample to sample, by a bound that costs less
/// than a look at each step, and that most signals keep.
fn is_surely_fine(samples: &[f64], sample: SampleType) -> bool {
    /// Largest error, as a share of all steps, that is harmless for certain: half of what counts as a loss.
    const SURE: f64 = 0.05;
    const BLOCK: usize = 4096;
    let (mut moved, mut off, mut start) = (0.0, 0.0, 0);
    while start + 1 < samples.len() {
        let end = samples.len().min(start + BLOCK);
        // With the last sample of the block before, from which its first step starts.
        let block = &samples[start..end];
        let steps = sum_of_steps(block);
        // No sample is larger than the first one and all steps. Rounding changes a step by one spacing at most.
        let spacing = match sample.step() {
            0.0 => (block[0].abs() + steps) * f64::from(f32::EPSILON),
            step => step,
        };
        (moved, off) = (moved + steps, off + spacing * block.len() as f64);
        start = end - 1;
    }
    off <= SURE * moved
}

/// Returns the sum of the sizes of all steps from sample to sample, of which there is one at least.
fn sum_of_steps(samples: &[f64]) -> f64 {
    /// Number of sums side by side, which the processor adds at once. The order of a single one would be fixed.
    const SIDE: usize = 8;
    let later = samples.get(1..).unwrap_or_default();
    let (before, _) = samples[..later.len()].as_chunks::<SIDE>();
    let (after, rest) = later.as_chunks::<SIDE>();
    let mut sums = [0.0; SIDE];
    for (before, after) in before.iter().zip(after) {
        for ((sum, before), after) in sums.iter_mut().zip(before).zip(after) {
            *sum += (after - before).abs();
        }
    }
    let rest = &samples[samples.len() - rest.len() - 1..];
    let last: f64 = rest.windows(2).map(|step| (step[1] - step[0]).abs()).sum();
    sums.iter().sum::<f64>() + last
}

/// The range of a code as samples are compared with it before the sample type has rounded them.
#[derive(Clone, Copy)]
pub(crate) struct Bounds {
    low: f64,
    high: f64,
    is_single: bool,
}

impl Bounds {
    /// Returns the bounds of samples that lie within `min` to `max` once they are rounded, as these are.
    pub(crate) fn new(sample: SampleType, min: f64, max: f64) -> Self {
        // A sample that is half a step too large is rounded up, and one that is half a step too small, too.
        let half = sample.step() / 2.0;
        let high = if half > 0.0 { (max + half).next_down() } else { max };
        Self { low: min - half, high, is_single: sample == SampleType::F32 }
    }
}

/// Returns whether all samples are numbers within bounds. Doubles are compared as the `f32` that they become, so that ends
/// which are no `f32` are compared with what they became, too.
pub(crate) fn lies_in(samples: run::Samples, bounds: &Bounds) -> bool {
    let Bounds { low, high, is_single } = *bounds;
    if !is_single {
        return match samples {
            run::Samples::F32(all) => are_within(all, |own| f64::from(*own), low, high),
            run::Samples::F64(all) => are_within(all, |own| *own, low, high),
            run::Samples::I16(all) => are_within(all, |own| f64::from(*own), low, high),
        };
    }
    let (low, high) = (low as f32, high as f32);
    match samples {
        run::Samples::F32(all) => are_within(all, |own| *own, low, high),
        run::Samples::F64(all) => are_within(all, |own| *own as f32, low, high),
        run::Samples::I16(all) => are_within(all, |own| f32::from(*own), low, high),
    }
}

/// Looks at blocks, without a branch for each sample. What is no number compares as false, and lies outside.
fn are_within<T, N: Copy + PartialOrd>(
    samples: &[T],
    narrow: impl Fn(&T) -> N,
    low: N,
    high: N,
) -> bool {
    const BLOCK: usize = 512;
    let is_within = |own: &T| u32::from(narrow(own) >= low) & u32::from(narrow(own) <= high);
    samples.chunks(BLOCK).all(|block| block.iter().fold(1, |all, own| all & is_within(own)) == 1)
}

/// Returns whether an encoder of this type takes all of the samples.
pub(crate) fn are_good(samples: run::Samples, sample: SampleType) -> bool {
    match samples {
        run::Samples::F32(all) => first_bad(all, |value| *value).is_none(),
        run::Samples::F64(all) => first_bad_double(all, sample).is_none(),
        run::Samples::I16(_) => true,
    }
}

/// Returns the place of the first double that an encoder of this type does not take: it is not finite, or not so in `f32`
/// after rounding.
fn first_bad_double(samples: &[f64], sample: SampleType) -> Option<usize> {
    if sample == SampleType::F32 {
        first_bad(samples, |value| *value as f32)
    } else {
        first_bad(samples, |value| (value * 0.0) as f32)
    }
}

impl Samples<'_> {
    /// A view that threads may share.
    pub(crate) fn view(&self) -> View<'_> {
        match self {
            Self::F32(all) => View::F32(all.as_array()),
            Self::F64(all) => View::F64(all.as_array()),
            Self::I16(all) => View::I16(all.as_array()),
        }
    }
}

impl<'a> View<'a> {
    /// The first sample that an encoder of this type does not take, and its channel.
    pub(crate) fn bad(&self, sample: SampleType) -> Option<(usize, Bad)> {
        if self.grid().is_some_and(|grid| are_good(grid.all, sample)) {
            return None;
        }
        let lanes = self.lanes();
        lanes.iter().enumerate().find_map(|(channel, lane)| Some((channel, lane.bad(sample)?)))
    }

    /// Returns the layout of the samples in memory; `None` if their steps are not even.
    pub(crate) fn grid(&self) -> Option<Grid<'a>> {
        match self {
            Self::F32(all) => grid(all, run::Samples::F32),
            Self::F64(all) => grid(all, run::Samples::F64),
            Self::I16(all) => grid(all, run::Samples::I16),
        }
    }

    fn shape(&self) -> &[usize] {
        match self {
            Self::F32(all) => all.shape(),
            Self::F64(all) => all.shape(),
            Self::I16(all) => all.shape(),
        }
    }

    /// Number of channels.
    pub(crate) fn count(&self) -> usize {
        self.shape().split_last().map_or(0, |(_, outer)| outer.iter().product())
    }

    /// Number of samples of a channel.
    pub(crate) fn length(&self) -> usize {
        self.shape().last().copied().unwrap_or_default()
    }

    /// The channels, in the order of a C array. There is an axis at least.
    pub(crate) fn lanes(&self) -> Vec<Lane<'a>> {
        match self {
            Self::F32(all) => split(all.clone()).into_iter().map(Lane::F32).collect(),
            Self::F64(all) => split(all.clone()).into_iter().map(Lane::F64).collect(),
            Self::I16(all) => split(all.clone()).into_iter().map(Lane::I16).collect(),
        }
    }
}

/// Says what the sample type does to the samples, a sentence each: that it clamps some, or is too coarse for their steps.
#[pyfunction]
pub(crate) fn remarks(py: Python, sample: &str, samples: Samples) -> PyResult<Vec<String>> {
    let sample: SampleType = sample.parse().map_err(value)?;
    let lanes = samples.view().lanes();
    Ok(py.detach(|| {
        let mut remarks = Vec::new();
        if sample != SampleType::F32 {
            let count: usize = lanes.iter().map(|lane| lane.beyond(sample)).sum();
            remarks.extend(fit::cut(sample, count as u64));
        }
        for (place, lane) in lanes.iter().enumerate() {
            if let Some(lost) = lane.lost(sample) {
                let channel =
                    if lanes.len() > 1 { format!("channel {place}: ") } else { String::new() };
                remarks.push(channel + &lost);
                break; // other channels of one sensor lose the same
            }
        }
        remarks
    }))
}

/// Says which share of the samples lies outside the range of their code, if any does. A range for all channels, or one for
/// each, is its two ends.
#[pyfunction]
pub(crate) fn outside(
    py: Python,
    sample: &str,
    ranges: Vec<[f64; 2]>,
    samples: Samples,
) -> PyResult<Option<String>> {
    let sample: SampleType = sample.parse().map_err(value)?;
    let lanes = samples.view().lanes();
    Ok(py.detach(|| {
        let (mut count, mut total, mut odd) = (0, 0, None);
        for (lane, [min, max]) in lanes.iter().zip(ranges.iter().cycle()) {
            total += lane.len() as u64;
            let range = Range::new(sample, *min, *max);
            if !lane.lies_in(&Bounds::new(sample, *min, *max)) {
                let is_outside = |value: &&f64| !range.holds(**value);
                let outside = lane.to_vec().iter().filter(is_outside).count() as u64;
                count += outside;
                odd = odd.or((outside > 0).then_some(range));
            }
        }
        odd.and_then(|range| range.outside(count, total))
    }))
}

/// The rows along the last axis.
fn split<T>(view: ArrayViewD<'_, T>) -> Vec<ArrayView1<'_, T>> {
    let mut rows =
        Vec::with_capacity(view.len() / view.shape().last().map_or(1, |own| (*own).max(1)));
    append(view, &mut rows);
    rows
}

/// Appends the rows. A view of two axes is kept in fixed room, where a row costs little.
fn append<'a, T>(view: ArrayViewD<'a, T>, rows: &mut Vec<ArrayView1<'a, T>>) {
    let length = view.len_of(Axis(0));
    match view.ndim() {
        1 => rows.extend(view.into_dimensionality::<Ix1>()),
        2 => {
            let Ok(view) = view.into_dimensionality::<Ix2>() else { return };
            rows.extend((0..length).map(|row| view.index_axis_move(Axis(0), row)));
        }
        _ => (0..length).for_each(|part| append(view.clone().index_axis_move(Axis(0), part), rows)),
    }
}
