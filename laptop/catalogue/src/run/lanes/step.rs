//! Temporal contrast, step forward, moving window, and integrate and fire in lanes.

use pulp::Simd;
use spikewire::rate::IntegrateAndFire;

use super::{Code, Recordings, row, spikes};

/// Temporal contrast, whose spikes depend on two samples alone: the lanes are neighbouring samples of a recording.
#[inline(always)]
pub(super) fn contrast(recordings: Recordings, threshold: f32, cells: &mut [i8]) {
    let length = recordings.length;
    let all = recordings.samples.chunks_exact(length).zip(cells.chunks_exact_mut(length));
    for (lane, (samples, cells)) in all.enumerate() {
        let spike = |now: f32, before: f32| {
            let difference = now - before;
            i8::from(difference > threshold) - i8::from(difference < -threshold)
        };
        cells[0] = recordings.past(lane).last().map_or(0, |past| spike(samples[0], *past));
        for ((cell, now), before) in cells[1..].iter_mut().zip(&samples[1..]).zip(samples) {
            *cell = spike(*now, *before);
        }
    }
}

/// Step forward, with the baseline of each lane.
pub(super) struct StepForward<S: Simd> {
    threshold: S::f32s,
    base: S::f32s,
}

impl<S: Simd> StepForward<S> {
    #[inline(always)]
    pub(super) fn new(simd: S, threshold: f32, own: &Recordings) -> Self {
        // Without a past it starts at the first sample, which then has no spike.
        let first = |lane: usize| own.samples[lane * own.length];
        let base = |lane| own.past(lane).last().copied().unwrap_or_else(|| first(lane));
        let base = row(simd, own.count(), base);
        Self { threshold: simd.splat_f32s(threshold), base }
    }
}

impl<S: Simd> Code<S> for StepForward<S> {
    #[inline(always)]
    fn encode(&mut self, simd: S, _: usize, samples: &mut [S::f32s], room: &mut [S::f32s]) {
        let Self { threshold, mut base } = *self;
        for (sample, room) in samples.iter().zip(room) {
            let [lower, upper] = [simd.sub_f32s(base, threshold), simd.add_f32s(base, threshold)];
            let up = simd.greater_than_f32s(*sample, upper);
            let down = simd.less_than_f32s(*sample, lower);
            base = simd.select_f32s(up, upper, simd.select_f32s(down, lower, base));
            *room = spikes(simd, up, down);
        }
        self.base = base;
    }
}

/// Moving window, with what the crate's scheme keeps of each lane.
pub(super) struct MovingWindow<S: Simd> {
    count: S::f32s,
    margin: S::f32s,
    ring: Vec<S::f32s>,
    partial: S::f32s,
    next: usize,
    is_full: bool,
}

impl<S: Simd> MovingWindow<S> {
    #[inline(always)]
    pub(super) fn new(simd: S, threshold: f32, count: usize, own: &Recordings) -> Self {
        let zero = simd.splat_f32s(0.0);
        let mut new = Self {
            count: simd.splat_f32s(count as f32),
            margin: simd.splat_f32s(threshold * count as f32),
            ring: vec![zero; count],
            partial: zero,
            next: 0,
            is_full: false,
        };
        // A past shorter than the window is ignored.
        if let Some(start) = own.past(0).len().checked_sub(count) {
            for place in start..start + count {
                new.step(simd, row(simd, own.count(), |lane| own.past(lane)[place]));
            }
        }
        new
    }

    #[inline(always)]
    fn step(&mut self, simd: S, sample: S::f32s) -> S::f32s {
        let slot = &mut self.ring[self.next];
        let sum = simd.add_f32s(*slot, self.partial);
        self.partial = simd.add_f32s(self.partial, sample);
        *slot = sample;
        let difference = simd.sub_f32s(simd.mul_f32s(sample, self.count), sum);
        let margin = if self.is_full { self.margin } else { simd.splat_f32s(f32::INFINITY) };
        self.next += 1;
        if self.next == self.ring.len() {
            self.close_block(simd);
        }
        let up = simd.greater_than_f32s(difference, margin);
        let down = simd.less_than_f32s(difference, simd.neg_f32s(margin));
        spikes(simd, up, down)
    }

    #[inline(always)]
    fn close_block(&mut self, simd: S) {
        (self.next, self.is_full) = (0, true);
        let mut to_the_end = simd.splat_f32s(-0.0);
        for slot in self.ring.iter_mut().rev() {
            to_the_end = simd.add_f32s(to_the_end, *slot);
            *slot = to_the_end;
        }
        self.partial = simd.splat_f32s(0.0);
    }
}

impl<S: Simd> Code<S> for MovingWindow<S> {
    #[inline(always)]
    fn encode(&mut self, simd: S, _: usize, samples: &mut [S::f32s], room: &mut [S::f32s]) {
        for (sample, room) in samples.iter().zip(room) {
            *room = self.step(simd, *sample);
        }
    }
}

/// Integrate and fire with one spike a sample at most, with the potential of each lane; its samples are those above the
/// reference.
pub(super) struct Integrate<S: Simd> {
    threshold: S::f32s,
    /// The part of the potential that leaks; `None` if it does not leak.
    leak: Option<S::f32s>,
    potential: S::f32s,
}

impl<S: Simd> Integrate<S> {
    #[inline(always)]
    pub(super) fn new(simd: S, scheme: &IntegrateAndFire<f32, 127>) -> Self {
        // 2 to the power of `-power`, exactly.
        let part = f32::from_bits((127 - u32::from(scheme.power())) << 23);
        Self {
            threshold: simd.splat_f32s(scheme.threshold()),
            leak: scheme.is_leaky().then(|| simd.splat_f32s(part)),
            potential: simd.splat_f32s(0.0),
        }
    }
}

impl<S: Simd> Code<S> for Integrate<S> {
    #[inline(always)]
    fn encode(&mut self, simd: S, _: usize, samples: &mut [S::f32s], room: &mut [S::f32s]) {
        let Self { threshold, leak, mut potential } = *self;
        for (sample, room) in samples.iter().zip(room) {
            if let Some(part) = leak {
                potential = simd.sub_f32s(potential, simd.mul_f32s(potential, part));
            }
            potential = simd.add_f32s(potential, *sample);
            let up = simd.greater_than_or_equal_f32s(potential, threshold);
            let down = simd.less_than_or_equal_f32s(potential, simd.neg_f32s(threshold));
            let [lower, upper] =
                [simd.sub_f32s(potential, threshold), simd.add_f32s(potential, threshold)];
            potential = simd.select_f32s(up, lower, simd.select_f32s(down, upper, potential));
            *room = spikes(simd, up, down);
        }
        self.potential = potential;
    }

    /// A potential that is not finite stays so.
    #[inline(always)]
    fn is_sound(&self, simd: S) -> bool {
        let size = simd.abs_f32s(self.potential);
        let is_beyond = simd.not_m32s(simd.less_than_f32s(size, simd.splat_f32s(f32::INFINITY)));
        simd.first_true_m32s(is_beyond) == S::F32_LANES
    }
}
