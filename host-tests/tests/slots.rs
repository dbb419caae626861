//! GRF with sub-timesteps: a response of level `k` of `N` fires in slot `N - k`.

use crate::common::fields::Fields;
use crate::common::{between, cases, drawn_recordings, flights, float, hostile_recordings, ranges};
use fixed::types::{I1F15, I8F8, I16F16, I32F0};
use host_tests::compare::{assert_same_values, decode, encode, finite, reals};
use host_tests::reference::{Precise, slots_of_levels};
use proptest::prelude::*;
use spikewire::Scheme;
use spikewire::population::{Position, SlotSpikes, Slots};

/// Spikes, neuron by neuron.
fn listed<const M: usize, const N: usize>(spikes: SlotSpikes<M, N>) -> Vec<Option<u16>> {
    let mut slots = vec![None; M];
    for (neuron, slot) in spikes.iter() {
        slots[usize::from(neuron)] = Some(slot);
    }
    assert_eq!(spikes.len(), slots.iter().flatten().count());
    assert_eq!(spikes.is_empty(), slots.iter().all(Option::is_none));
    slots
}

/// Encoder and decoder against the reference; without fields where the type is too coarse for them.
fn check<S: Fields, const M: usize, const N: usize>(
    min: S,
    max: S,
    beta: f32,
    floor: u16,
    x: &[S],
) {
    let Ok(scheme) = Slots::<S, M, N>::try_new(min..=max, beta) else {
        assert!(Position::<S, M>::try_linear(min..=max).is_err());
        return;
    };
    let scheme = scheme.try_with_floor(floor).unwrap();
    let run = encode(&scheme, x);
    let recording = finite(x);
    assert!(run.tail.is_empty());
    assert_eq!(run.rejected as usize, recording.rejected.len());

    let n = N as u16;
    let mut value = scheme.centres()[M / 2];
    let mut values = Vec::new();
    for (&x, &spikes) in x.iter().zip(&run.outputs) {
        let mut levels =
            if x.real().into().is_finite() { x.levels(min, max, M, beta, n) } else { vec![0; M] };
        assert_eq!(listed(spikes), slots_of_levels(&levels, n, floor), "{x:?} in {min:?}..{max:?}");
        for level in &mut levels {
            *level = if *level < floor { 0 } else { *level };
        }
        value = S::weighted_mean(&levels, min, max, n).unwrap_or(value);
        values.push(value.real());
    }
    let mut decoder = scheme.decoder();
    assert_same_values(&decode(&decoder, &run.outputs), &values);
    decoder.resync(max);
    assert_eq!(decoder.held(), Some(max));
    assert_eq!(decoder.decode(SlotSpikes::EMPTY), max);
    decoder.reset();
    assert_same_values(&decode(&decoder, &run.outputs), &values);
}

/// Several numbers of neurons and slots.
fn check_all<S: Fields>(min: S, max: S, beta: f32, x: &[S]) {
    check::<S, 3, 2>(min, max, beta, 1, x);
    check::<S, 4, 100>(min, max, beta, 7, x);
    check::<S, 15, 10>(min, max, beta, 1, x);
    check::<S, 5, 256>(min, max, beta, 256, x);
}

#[test]
fn the_printed_check_values() {
    let scheme = Slots::<f32, 4, 100>::try_new(0.0..=1.0, 1.5).unwrap();
    let table = [
        (0.1, [Some(42), Some(10), Some(85), None]),
        (0.5, [Some(92), Some(25), Some(25), Some(92)]),
        (0.9, [None, Some(85), Some(10), Some(42)]),
    ];
    for (x, slots) in table {
        assert_eq!(listed(scheme.encoder().encode(x)), slots);
        check::<f32, 4, 100>(0.0, 1.0, 1.5, 1, &[x]);
    }
    let scheme = Slots::<I16F16, 4, 100>::try_new(I16F16::ZERO..=I16F16::ONE, 1.5).unwrap();
    for (x, slots) in table {
        let x = I16F16::from_num(x);
        assert_eq!(listed(scheme.encoder().encode(x)), slots);
    }
}

#[test]
fn cases_by_hand() {
    // Centres -0.25, 0.25, 0.75, 1.25.
    let all = Slots::<f32, 4, 100>::try_new(0.0..=1.0, 1.5).unwrap();
    let some = all.try_with_floor(75).unwrap();
    let table = [
        ("on a centre: at once", all, 0.25, vec![(0, 68), (1, 0), (2, 68), (3, 99)]),
        ("below the floor: silent", some, 0.5, vec![(1, 25), (2, 25)]),
        ("far outside: silent", all, 9.0, vec![]),
        ("not a number: silent", all, f32::NAN, vec![]),
    ];
    for (name, scheme, x, expected) in table {
        assert!(scheme.encoder().encode(x).iter().eq(expected), "{name}");
    }
}

/// What is built at compile time is what is built in flight.
#[test]
fn constants() {
    static FLOATS: Slots<f32, 15, 10> = Slots::new(-0.3..=0.7, 1.5).with_floor(3);
    static COUNTS: Slots<i16, 15, 256> = Slots::new(-30_000..=7, 0.9);
    static WORDS: Slots<I16F16, 4, 100> = Slots::new(I16F16::MIN..=I16F16::DELTA, 3.0);
    let floats = Slots::try_new(-0.3..=0.7, 1.5).unwrap();
    assert_eq!(FLOATS, floats.try_with_floor(3).unwrap());
    assert_eq!(COUNTS, Slots::try_new(-30_000..=7, 0.9).unwrap());
    assert_eq!(WORDS, Slots::try_new(I16F16::MIN..=I16F16::DELTA, 3.0).unwrap());
    assert_eq!(reals(FLOATS.centres()), *FLOATS.centres());
}

flights!(S: Fields, |x, unit| {
    let [min, max] = [-4.0, 4.0].map(|end| S::from_f64(end * unit));
    check_all(min, max, 1.5, &x);
});

#[test]
fn hostile() {
    for x in hostile_recordings() {
        check_all(0.0_f32, 1.0, 1.5, &x);
        check_all(-1e-40_f32, 1e-40, 1.5, &x);
        check_all(-1e37_f32, 1e38, 0.7, &x);
    }
}

drawn_recordings!(S: Fields, 64, (x in S::recordings(), [min, max] in ranges::<S>(), beta in prop_oneof![Just(1.5_f32), between(0.3, 4.0)]) => {
    check_all(min, max, beta, &x);
});

/// Samples within the range, and next to the edges between neurons.
#[test]
fn within_the_range() {
    let x = proptest::collection::vec(-0.5_f32..1.5, 40);
    proptest!(cases(128), |(x in x, min in -3.0_f32..3.0, width in between(0.1, 5.0))| {
        let max = min + width;
        let mut x: Vec<_> = x.into_iter().map(|x| min + x * width).collect();
        x.extend((0..=13_u8).map(|i| min + f32::from(i) * width / 13.0));
        check_all(min, max, 1.5, &x);
    });
}

/// Fields so narrow that the floor is reached just halfway between two centres: there the rounding
/// of either distance decides who fires, whichever neuron is the nearest.
#[test]
fn a_floor_halfway_between_two_neurons() {
    let halfway = |n: f64, floor: f64| 2.0 * (2.0 * (n / (floor - 0.5)).ln()).sqrt();
    proptest!(cases(512), |(min in -3.0_f32..3.0, width in between(0.1, 5.0))| {
        let max = min + width;
        let edges = (0..=3_u8).map(|i| min + f32::from(i) * (max - min) / 3.0);
        let x: Vec<_> = edges.flat_map(|x| [x.next_down(), x, x.next_up()]).collect();
        let beta = halfway(10.0, 4.0) as f32;
        for beta in [beta.next_down(), beta, beta.next_up()] {
            check::<f32, 5, 10>(min, max, beta, 4, &x);
        }
    });
}

/// Fields that reach so far that an `f32` there does not tell the neurons apart.
#[test]
fn fields_far_wider_than_their_range() {
    for beta in [1e-8, 1e-7, 1e-5] {
        let last = (1.0 / f64::from(beta) * (2.0 * 16.0_f64.ln()).sqrt()) as f32;
        let up: Vec<_> =
            std::iter::successors(Some(last), |x| Some(x.next_up())).take(40).collect();
        let down = std::iter::successors(Some(last), |x| Some(x.next_down())).take(40);
        let x: Vec<_> = down.chain(up).flat_map(|x| [x, -x]).collect();
        check::<f32, 5, 8>(0.0, 3.0, beta, 1, &x);
    }
}

/// Fields that reach so far that their first bin would begin beyond 32 bits.
#[test]
fn fields_far_wider_than_16_bits() {
    let x = [i16::MIN, -2, -1, 0, i16::MAX];
    for beta in [1e-8, 1e-6, 1e-4] {
        check_all(i16::MIN, i16::MAX, beta, &x);
    }
}

/// Fields whose distances do not fit 32 bits, over a range whose distances do.
#[test]
fn wide_fields_over_a_short_range() {
    let [min, max] = [0, 65_536].map(I32F0::from_bits);
    let x: Vec<_> = (-20..=20).map(|x| I32F0::from_bits(x * 10_000)).collect();
    check::<I32F0, 5, 8>(min, max, 1e-4, 1, &x);
}

/// Ranges of a few steps, where a spacing of centres has a fraction.
#[test]
fn short_ranges() {
    let x: Vec<i16> = (-120..=140).collect();
    let words: Vec<_> = x.iter().map(|&x| I32F0::from_bits(x.into())).collect();
    for (min, width) in [-5, 0, 7_i16].into_iter().flat_map(|min| (2..=40).map(move |w| (min, w))) {
        for beta in [0.5, 1.5, 3.0] {
            check_all(min, min + width, beta, &x);
            // Both types have the same steps: where a range begins is the matter of one.
            if min == 0 {
                let ends = [min, min + width].map(|end| I32F0::from_bits(end.into()));
                check_all(ends[0], ends[1], beta, &words);
            }
        }
    }
}

/// Levels that end a two-thousandth of a step above a sample, where a bin of values must not begin.
#[test]
fn levels_that_end_next_to_a_sample() {
    let x: Vec<i16> = (-80..=80).collect();
    let words: Vec<_> = x.iter().map(|&x| I32F0::from_bits(x.into())).collect();
    for (min, width, beta) in [
        (7, 4, 3.262_031_3),
        (0, 10, 0.741_707_74),
        (7, 10, 0.339_957_74),
        (0, 20, 0.815_895_2),
        (7, 20, 0.494_486_8),
    ] {
        check::<i16, 5, 10>(min, min + width, beta, 1, &x);
        let ends = [min, min + width].map(|end| I32F0::from_bits(end.into()));
        check::<I32F0, 5, 10>(ends[0], ends[1], beta, 1, &words);
    }
}

/// Ranges whose distances just fit 32 bits, and just do not; values up to where they leave them.
#[test]
fn distances_about_32_bits_long() {
    let range = (20..30_u32, 0..1_000_000).prop_map(|(bits, more)| (1 << bits) + more);
    proptest!(cases(128), |(min in -1_000_000..1_000_000_i32, range in range, beta in between(0.3, 4.0))| {
        let x: Vec<_> = (-64..=64_i32)
            .flat_map(|part| [min.saturating_add(part.saturating_mul(range >> 4)), part << 24])
            .map(I32F0::from_bits)
            .collect();
        let (min, max) = (I32F0::from_bits(min), I32F0::from_bits(min.saturating_add(range)));
        check_all(min, max, beta, &x);
    });
}

/// Each neuron's farthest sample of each level, and the one beyond, in 32 bits.
#[test]
fn the_ends_of_levels() {
    let end = || proptest::num::i32::ANY;
    proptest!(cases(32), |(a in end(), b in end(), beta in between(0.3, 4.0))| {
        let [min, max] = if a < b { [a, b] } else { [b, a] };
        let ends = [min, max].map(I32F0::from_bits);
        let Ok(scheme) = Slots::<I32F0, 5, 10>::try_new(ends[0]..=ends[1], beta) else { return Ok(()) };
        let third = (Precise::from(max) - f64::from(min)) / 3.0;
        for (neuron, level) in (0..5_u16).flat_map(|neuron| (1..=10_u16).map(move |k| (neuron, k))) {
            let centre = third.clone() * (f64::from(neuron) - 0.5) + f64::from(min);
            let response = Precise::from(10.0) / (f64::from(level) - 0.5);
            let radius = (response.ln() * 2.0).sqrt() * third.clone() / f64::from(beta);
            let last = (centre + radius).to_f64().floor();
            for (x, is_within) in [(last, true), (last + 1.0, false)] {
                if x == f64::from(x as i32) {
                    let spikes = listed(scheme.encoder().encode(I32F0::from_bits(x as i32)));
                    let is_fired = spikes[usize::from(neuron)].is_some_and(|slot| 10 - slot >= level);
                    assert_eq!(is_fired, is_within, "{neuron} {level} {x}");
                }
            }
        }
    });
}

#[test]
fn drawn_floors() {
    proptest!(cases(64), |(x in proptest::collection::vec(float(), 40), floor in 1..=10_u16)| {
        check::<f32, 15, 10>(-4.0, 4.0, 1.5, floor, &x);
    });
}

#[test]
fn all_65536_inputs() {
    let counts: Vec<_> = (i16::MIN..=i16::MAX).collect();
    check::<_, 4, 10>(-20_000_i16, 25_001, 1.5, 1, &counts);
    check::<_, 3, 256>(i16::MIN, i16::MAX, 1.5, 1, &counts);
    let bits: Vec<_> = counts.iter().copied().map(I8F8::from_bits).collect();
    check::<_, 4, 100>(I8F8::from_num(-9), I8F8::from_num(9.1), 1.5, 3, &bits);
    let bits: Vec<_> = counts.iter().copied().map(I1F15::from_bits).collect();
    check::<_, 5, 10>(I1F15::from_num(-0.5), I1F15::from_num(0.7), 2.5, 1, &bits);
}
