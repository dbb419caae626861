//! Step codes against their laws in plain arithmetic, in every state that samples of few bits can bring them to, and with
//! each of these samples there.
//!
//! The states of encoder, decoder and law together are explored until there is none that was not seen: what holds in all of
//! them holds for recordings of any length. Samples lie in the middle of `i16` and at both of its ends, where it saturates.

use std::collections::HashSet;
use std::fmt::Debug;
use std::hash::Hash;
use std::ops::RangeInclusive;

use catalogue::State;
use host_tests::reference::{moving_window, step_forward, temporal_contrast};
use spikewire::temporal::{
    AdaptiveContrast, AdaptiveStepForward, MovingWindow, SendOnDelta, StepForward, TemporalContrast,
};
use spikewire::{Code, Output, Polarity, Recovery, Start};

/// What a law makes of a sample: the number of spikes, negative if they go down.
trait Law: Clone + Eq + Hash + Debug {
    fn step(&mut self, sample: i16) -> i8;

    /// The encoder's base, where the decoder follows it from the first keyframe on.
    fn base(&self) -> Option<i16> {
        None
    }
}

/// How many states there are, and how many transitions between them.
type Found = (usize, usize);

/// Explores all states. A decoder is beside the encoder only where it follows a base; it starts at the first keyframe.
fn explore<P, L>(scheme: &P, law: L, samples: RangeInclusive<i16>) -> Found
where
    P: Start<Sample = i16, EncoderState: State, DecoderState: State>,
    L: Law,
{
    let bytes = |state: &P::EncoderState| postcard::to_allocvec(state).unwrap();
    let start = (P::START, scheme.decoder_state(), law);
    let mut seen = HashSet::from([(bytes(&start.0), start.2.clone(), Vec::new())]);
    let mut waiting = vec![start];
    let mut transitions = 0;
    while let Some((state, decoder, law)) = waiting.pop() {
        for sample in samples.clone() {
            transitions += 1;
            let (mut state, mut decoder, mut law) = (state, decoder.clone(), law.clone());
            let had_keyframe = law.base().is_some();
            let code = scheme.encode(&mut state, sample).code().unwrap();
            let count = code.firings().fold(0, |count, firing| match firing.polarity {
                Polarity::Up => count + 1,
                Polarity::Down => count - 1,
            });
            assert_eq!(count, law.step(sample), "{sample} in {law:?}");
            let mut held = Vec::new();
            if let Some(base) = law.base() {
                if had_keyframe {
                    scheme.decode(&mut decoder, code);
                } else {
                    scheme.resync(&mut decoder, base);
                }
                assert_eq!(scheme.held(&decoder), Some(base), "{sample} to {law:?}");
                if P::RECOVERY == Recovery::Keyframe {
                    assert_eq!(scheme.keyframe(&state), Some(base));
                }
                held = postcard::to_allocvec(&decoder).unwrap();
            }
            if seen.insert((bytes(&state), law.clone(), held)) {
                waiting.push((state, decoder, law));
            }
        }
    }
    (seen.len(), transitions)
}

/// Step forward, by the independent reference.
#[derive(Clone, PartialEq, Eq, Hash, Debug)]
struct StepForwardLaw {
    threshold: i16,
    base: Option<i16>,
}

impl Law for StepForwardLaw {
    fn step(&mut self, sample: i16) -> i8 {
        let Some(base) = self.base else {
            self.base = Some(sample);
            return 0;
        };
        let spikes = step_forward(&[f64::from(sample)], self.threshold.into(), Some(base.into()));
        self.base = Some(base + i16::from(spikes[0]) * self.threshold);
        spikes[0]
    }

    fn base(&self) -> Option<i16> {
        self.base
    }
}

/// Send-on-delta: as many steps as are needed, and no more than allowed.
#[derive(Clone, PartialEq, Eq, Hash, Debug)]
struct SendOnDeltaLaw {
    threshold: i32,
    most: i32,
    base: Option<i32>,
}

impl Law for SendOnDeltaLaw {
    fn step(&mut self, sample: i16) -> i8 {
        let base = *self.base.get_or_insert(sample.into());
        // The largest number of steps that is still strictly less than the way.
        let way = i32::from(sample) - base;
        let steps = ((way.abs() - 1).max(0) / self.threshold).min(self.most) * way.signum();
        self.base = Some(base + steps * self.threshold);
        steps as i8
    }

    fn base(&self) -> Option<i16> {
        self.base.map(|base| base as i16)
    }
}

/// Adaptive step forward, with the exponent of its step and the run of spikes, which counts up to 127.
#[derive(Clone, PartialEq, Eq, Hash, Debug)]
struct AdaptiveLaw {
    threshold: i32,
    doublings: u32,
    needed: u32,
    base: Option<i32>,
    exponent: u32,
    run: i32,
}

impl Law for AdaptiveLaw {
    fn step(&mut self, sample: i16) -> i8 {
        let Some(base) = self.base else {
            self.base = Some(sample.into());
            return 0;
        };
        let step = self.threshold << self.exponent;
        let way = i32::from(sample) - base;
        let spike = if way.abs() > step { way.signum() } else { 0 };
        self.base = Some(base + spike * step);
        let goes_on = spike != 0 && self.run.signum() != -spike;
        self.run = if goes_on { (self.run + spike).clamp(-128, 127) } else { spike };
        self.exponent = if self.run.unsigned_abs() >= self.needed {
            (self.exponent + 1).min(self.doublings)
        } else {
            self.exponent.saturating_sub(1)
        };
        spike as i8
    }

    fn base(&self) -> Option<i16> {
        self.base.map(|base| base as i16)
    }
}

/// Temporal contrast, by the independent reference.
#[derive(Clone, PartialEq, Eq, Hash, Debug)]
struct ContrastLaw {
    threshold: i16,
    previous: Option<i16>,
}

impl Law for ContrastLaw {
    fn step(&mut self, sample: i16) -> i8 {
        let previous = self.previous.replace(sample).map(f64::from);
        temporal_contrast(&[f64::from(sample)], self.threshold.into(), previous)[0]
    }
}

/// Adaptive contrast, with which of the last 16 samples had a spike, the newest first.
#[derive(Clone, PartialEq, Eq, Hash, Debug)]
struct AdaptiveContrastLaw {
    threshold: i32,
    doublings: usize,
    previous: Option<i16>,
    spikes: [bool; 16],
}

impl Law for AdaptiveContrastLaw {
    fn step(&mut self, sample: i16) -> i8 {
        let count = self.spikes.iter().filter(|&&had_spike| had_spike).count();
        let exponent = (count * (self.doublings + 1) / 16).min(self.doublings);
        let way = i32::from(sample) - i32::from(self.previous.replace(sample).unwrap_or(sample));
        let spike = if way.abs() > self.threshold << exponent { way.signum() } else { 0 };
        self.spikes.rotate_right(1);
        self.spikes[0] = spike != 0;
        spike as i8
    }
}

/// The moving window, by the independent reference. Where the window begins in the ring is part of the encoder's state.
#[derive(Clone, PartialEq, Eq, Hash, Debug)]
struct WindowLaw<const N: usize> {
    threshold: i16,
    window: Vec<i16>,
}

impl<const N: usize> Law for WindowLaw<N> {
    fn step(&mut self, sample: i16) -> i8 {
        let is_full = self.window.len() == N;
        self.window.push(sample);
        if !is_full {
            return 0;
        }
        let window: Vec<f64> = self.window.iter().copied().map(f64::from).collect();
        self.window.remove(0);
        moving_window(&window[N..], N, self.threshold.into(), Some(&window[..N]))[0]
    }
}

/// Samples of so many bits, in the middle of the type and at both ends.
fn places(bits: u32) -> [RangeInclusive<i16>; 3] {
    let count = 1_i16 << bits;
    let half = count / 2;
    [-half..=half - 1, i16::MIN..=i16::MIN + (count - 1), i16::MAX - (count - 1)..=i16::MAX]
}

/// The sum over several explorations, of which each came to its end.
fn sum(name: &str, found: impl Iterator<Item = Found>) -> Found {
    let total = found.fold((0, 0), |sum, found| (sum.0 + found.0, sum.1 + found.1));
    println!("{name}: {} states, {} transitions", total.0, total.1);
    total
}

fn follow(bits: u32, thresholds: &[i16]) -> [Found; 3] {
    let cases = || {
        places(bits)
            .into_iter()
            .flat_map(|place| thresholds.iter().map(move |&one| (place.clone(), one)))
    };
    let forward = cases().map(|(place, threshold)| {
        explore(&StepForward::new(threshold), StepForwardLaw { threshold, base: None }, place)
    });
    let delta = cases().map(|(place, one)| {
        let law = SendOnDeltaLaw { threshold: one.into(), most: 4, base: None };
        explore(&SendOnDelta::<_, 4>::new(one), law, place)
    });
    let adaptive = cases().filter(|(_, one)| *one < 1_000).map(|(place, one)| {
        let law = AdaptiveLaw {
            threshold: one.into(),
            doublings: 4,
            needed: 2,
            base: None,
            exponent: 0,
            run: 0,
        };
        explore(&AdaptiveStepForward::new(one, 4), law, place)
    });
    [
        sum("step forward", forward),
        sum("send-on-delta, 4 spikes", delta),
        sum("adaptive step forward, 4 doublings", adaptive),
    ]
}

fn contrast(bits: u32, thresholds: &[i16]) -> Found {
    let cases = places(bits)
        .into_iter()
        .flat_map(|place| thresholds.iter().map(move |&one| (place.clone(), one)));
    sum(
        "temporal contrast",
        cases.map(|(place, threshold)| {
            explore(
                &TemporalContrast::new(threshold),
                ContrastLaw { threshold, previous: None },
                place,
            )
        }),
    )
}

fn adaptive_contrast(places: impl IntoIterator<Item = RangeInclusive<i16>>) -> Found {
    let (scheme, spikes) = (AdaptiveContrast::new(1, 2), [false; 16]);
    let law = AdaptiveContrastLaw { threshold: 1, doublings: 2, previous: None, spikes };
    let found = places.into_iter().map(|place| explore(&scheme, law.clone(), place));
    sum("adaptive contrast, 2 doublings", found)
}

fn window<const N: usize>(bits: u32, threshold: i16) -> Found {
    let law = WindowLaw::<N> { threshold, window: Vec::new() };
    let found = places(bits)
        .into_iter()
        .map(|place| explore(&MovingWindow::<_, N>::new(threshold), law.clone(), place));
    sum(&format!("moving window of {N}"), found)
}

#[test]
fn step_codes_of_few_bits_are_their_laws_in_every_state() {
    let thresholds = [1, 3, 40, 1_000, i16::MAX];
    let totals = follow(6, &thresholds);
    assert!(totals.iter().all(|found| found.0 > 500));
    contrast(6, &thresholds);
    adaptive_contrast([0..=2]);
    window::<2>(4, 1);
    window::<2>(3, i16::MAX);
    window::<3>(3, 1);
}

/// All thresholds, on samples of 8 bits; windows and histories, whose states are many more, on fewer.
#[test]
#[ignore = "minutes"]
fn step_codes_of_8_bits_are_their_laws_in_every_state() {
    let thresholds: Vec<i16> = (1..=255).chain([1_000]).collect();
    follow(8, &thresholds);
    contrast(8, &thresholds);
    adaptive_contrast(places(4));
    window::<2>(7, 3);
    window::<3>(5, 1);
    window::<4>(4, 1);
}
