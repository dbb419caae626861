//! Populations of every size at which a width changes: 255, 256 and 257 neurons, and on to 1024.
//!
//! The neuron of a value is the number of edges below it, `min + i (max - min) / (M - 2)`: here in whole numbers
//! for integers, and in whole numbers of 2⁻¹⁴⁹ for floats.
#![allow(clippy::cast_possible_wrap, reason = "there are at most 1024 neurons")]

use crate::common::{between, cases};
use host_tests::compare::{Wire, check_position};
use host_tests::reference::{even_centres, nearest_even};
use num_bigint::BigInt;
use proptest::prelude::*;
use spikewire::Scheme;
use spikewire::population::{FiredNeurons, Gaussian, Neuron, Position, SlotSpikes, Slots};
use spikewire::{Code, NeuronSpike, Polarity};

/// Calls a generic check with every size.
macro_rules! every_size {
    ($check:ident($($argument:expr),*)) => {{
        $check::<3>($($argument),*);
        $check::<4>($($argument),*);
        $check::<255>($($argument),*);
        $check::<256>($($argument),*);
        $check::<257>($($argument),*);
        $check::<511>($($argument),*);
        $check::<512>($($argument),*);
        $check::<1023>($($argument),*);
        $check::<1024>($($argument),*);
    }};
}

/// Overflow panics where these tests run, or they would not see one; the sweeps are optimised, and do not look.
#[test]
#[cfg(debug_assertions)]
#[should_panic(expected = "attempt to add with overflow")]
fn overflow_is_checked() {
    let largest = std::hint::black_box(u8::MAX);
    std::hint::black_box(largest + 1);
}

/// Asserts the neuron of every value, one by one and as a slice.
fn check_all<S: Wire, const M: usize>(scheme: &Position<S, M>, x: &[S], neurons: &[usize]) {
    let expected: Vec<_> = neurons.iter().map(|&neuron| Neuron::new(neuron as u16)).collect();
    let mut encoder = scheme.encoder();
    for (&x, &expected) in x.iter().zip(&expected) {
        assert_eq!(encoder.encode(x), expected, "{x:?} of {M}");
    }
    let mut outputs = vec![None; x.len()];
    encoder.encode_slice(x, &mut outputs);
    assert!(outputs == expected, "{M} as a slice");
    assert_eq!(encoder.rejected(), 0);
}

/// The neurons of values that rise.
fn rising<const M: usize>(x: &[i16], min: i16, max: i16) -> Vec<usize> {
    let [min, max, parts] = [i64::from(min), i64::from(max), M as i64 - 2];
    let mut edge = 0;
    let next = |&x: &i16| {
        while edge < M - 1 && (i64::from(x) - min) * parts > edge as i64 * (max - min) {
            edge += 1;
        }
        edge
    };
    x.iter().map(next).collect()
}

/// All 65 536 values, in a range of whole counts.
fn sweep<const M: usize>(min: i16, max: i16) {
    let scheme = Gaussian::<i16, M>::try_linear(min..=max).unwrap();
    let all: Vec<_> = (i16::MIN..=i16::MAX).collect();
    check_all(&scheme, &all, &rising::<M>(&all, min, max));
}

#[test]
fn all_values_of_16_bits() {
    every_size!(sweep(i16::MIN, i16::MAX));
    every_size!(sweep(-1000, 1000));
    every_size!(sweep(-20_000, 25_001));
    every_size!(sweep(-30_000, -28_001));
}

/// The finest ranges of a size: one, two or three counts from centre to centre, and a little more or less.
#[test]
fn the_finest_ranges() {
    fn finest<const M: usize>(start: i16) {
        let spacing = M as i16 - 2;
        for width in [spacing, spacing + 1, 2 * spacing - 1] {
            sweep::<M>(start, start + width);
        }
        let too_fine = Gaussian::<i16, M>::try_linear(start..=start + (spacing - 1).max(1));
        assert!(M == 3 || too_fine.is_err(), "{M}");
    }
    every_size!(finest(-517));
    finest::<257>(28_000);
}

/// Any range: the values at every edge, and next to it.
#[test]
fn ranges_of_every_width() {
    fn check<const M: usize>(min: i16, max: i16) {
        let Ok(scheme) = Gaussian::<i16, M>::try_linear(min..=max) else {
            // Half a spacing beyond the type, the last two centres may be one.
            assert!(i32::from(max) - i32::from(min) < M as i32 || min < -32_000 || max > 32_000);
            return;
        };
        let [low, high, parts] = [i64::from(min), i64::from(max), M as i64 - 2];
        let edges = (0..M as i64 - 1).map(|i| low + i * (high - low) / parts);
        let near = edges.flat_map(|edge| edge - 1..=edge + 2).chain([-32_768, 32_767]);
        let mut x: Vec<_> = near.filter_map(|x| i16::try_from(x).ok()).collect();
        x.sort_unstable();
        check_all(&scheme, &x, &rising::<M>(&x, min, max));
    }
    proptest!(cases(48), |(min in -32_768..31_000_i32, width in 1..65_535_i32)| {
        let max = (min + width).min(32_767);
        every_size!(check(min as i16, max as i16));
    });
}

/// A finite float in units of 2⁻¹⁴⁹, of which each is a whole number.
fn units(value: f32) -> BigInt {
    let (bits, exponent) = (value.to_bits() & 0x007f_ffff, value.to_bits() >> 23 & 0xff);
    assert!(exponent < 0xff, "{value} is not finite");
    let mantissa = if exponent > 0 { bits | 0x0080_0000 } else { bits };
    let magnitude = BigInt::from(mantissa) << exponent.saturating_sub(1);
    if value < 0.0 { -magnitude } else { magnitude }
}

/// The neuron of a float in `min..=max`: how many `i` from 0 to `m - 2` are less than
/// `(m - 2) (x - min) / (max - min)`.
fn exact(x: f32, min: f32, max: f32, m: usize) -> usize {
    let [x, min, max] = [x, min, max].map(units);
    let (above, range) = ((x - &min) * (m - 2), max - min);
    let below: BigInt = (above + &range - 1) / range;
    usize::try_from(below.clamp(BigInt::ZERO, BigInt::from(m - 1))).unwrap()
}

#[test]
fn units_are_exact() {
    for value in [1e-45, -1e-45, 1.0, -3.5, 0.0, -0.0, f32::MAX, f32::MIN_POSITIVE] {
        let digits = units(value).to_string().parse::<f64>().unwrap();
        assert_eq!(digits * 2.0_f64.powi(-149), f64::from(value));
    }
    let neurons = [-9.0, 0.0, 0.1, 0.5, 0.6, 1.0, 1.1, 9.0].map(|x| exact(x, 0.0, 1.0, 4));
    assert_eq!(neurons, [0, 0, 1, 1, 2, 2, 3, 3]);
}

/// `count` floats from one on.
fn floats_from(first: f32, count: u32) -> Vec<f32> {
    (0..count)
        .scan(first, |x, _| {
            let value = *x;
            *x = x.next_up();
            Some(value)
        })
        .collect()
}

/// Ranges far from 0, of a few last places from centre to centre: all floats within and a little beyond.
#[test]
fn float_ranges_far_from_zero() {
    fn check<const M: usize>(start: f32, places: u32, more: u32) {
        let count = places * M as u32 + more;
        let x = floats_from(start, count);
        let (min, max) = (x[count as usize / 8], x[count as usize * 7 / 8]);
        if let Ok(scheme) = Gaussian::<f32, M>::try_linear(min..=max) {
            let neurons: Vec<_> = x.iter().map(|&x| exact(x, min, max, M)).collect();
            check_all(&scheme, &x, &neurons);
        } else {
            assert!(places < 4, "{M}: {min}..={max}");
        }
    }
    let start =
        prop_oneof![1.0_f32..9.0, between(1e3, 1e7), between(1e30, 1e38), between(1e-30, 1e-20)];
    proptest!(cases(6), |(start in start, places in 1..9_u32, more in 0..99_u32)| {
        for start in [start, -start] {
            every_size!(check(start, places, more));
        }
    });
}

/// The floats at every edge and next to it, of any range: with ends of very different magnitude, where no double
/// holds the edges.
fn check_edges<const M: usize>(min: f32, max: f32) {
    let scheme = Gaussian::<f32, M>::try_linear(min..=max).unwrap();
    let [from, to] = [min, max].map(f64::from);
    let mut x: Vec<f32> = (0..M - 1)
        .flat_map(|i| {
            let near = (from + i as f64 * (to - from) / (M as f64 - 2.0)) as f32;
            let (down, up) = (near.next_down(), near.next_up());
            [down.next_down(), down, near, up, up.next_up()]
        })
        .chain([min, max, 0.0, -0.0, 1e-45, -1e-45, f32::MIN, f32::MAX])
        .filter(|x| x.is_finite())
        .collect();
    x.sort_by(f32::total_cmp);
    let expected: Vec<_> = x.iter().map(|&x| exact(x, min, max, M)).collect();
    assert_eq!(nearest_even(&x, min, max, M), expected, "the reference: {min:e}..={max:e}");
    let values: Vec<_> = even_centres(from, to, M).into_iter().map(|value| value as f32).collect();
    check_position(&scheme, &x, &values, |x| nearest_even(x, min, max, M));
    for (&x, &neuron) in x.iter().zip(&expected) {
        let output = scheme.encoder().encode(x).map(|neuron| usize::from(neuron.index()));
        assert_eq!(output, Some(neuron), "{x:e} in {min:e}..={max:e}");
    }
}

#[test]
fn ends_of_very_different_magnitude() {
    for large in [1.1e29_f32, 6.9e10, 1e38] {
        for small in [0.15_f32, 1e-45, 3.0] {
            for [min, max] in [[-large, -small], [-large, small], [small, large], [-small, large]] {
                check_edges::<3>(min, max);
                check_edges::<4>(min, max);
                check_edges::<5>(min, max);
                check_edges::<20>(min, max);
                check_edges::<33>(min, max);
            }
        }
    }
}

/// An end of -0 is one of 0: neither 0 lies beyond it.
#[test]
fn an_end_of_minus_zero() {
    for [min, max] in [[-1.0, -0.0], [-0.0, 1.0], [-0.0, 1e-30], [-1e30, -0.0]] {
        check_edges::<3>(min, max);
        check_edges::<20>(min, max);
        check_edges::<257>(min, max);
    }
}

#[test]
fn drawn_ends() {
    let end = || {
        prop_oneof![
            any::<u32>().prop_map(f32::from_bits).prop_filter("finite", |x| x.abs() < 1e38),
            -9.0_f32..9.0,
        ]
    };
    proptest!(cases(96), |(a in end(), b in end())| {
        let (min, max) = if a < b { (a, b) } else { (b, a) };
        if Gaussian::<f32, 7>::try_linear(min..=max).is_ok() {
            check_edges::<7>(min, max);
        }
        if Gaussian::<f32, 20>::try_linear(min..=max).is_ok() {
            check_edges::<20>(min, max);
        }
    });
}

/// Receptive fields of many neurons: the spikes of a value are those of its neighbourhood, shifted.
#[test]
fn fields_of_many_neurons() {
    fn check<const M: usize>(unit: i16) {
        let many = Slots::<i16, M, 16>::try_new(0..=unit * (M as i16 - 2), 1.5).unwrap();
        let few = Slots::<i16, 16, 16>::try_new(0..=unit * 14, 1.5).unwrap();
        let (mut encoder, mut decoder) = (many.encoder(), many.decoder());
        for x in 0..=unit * (M as i16 - 2) {
            // The same place between the same neurons, in the middle of the few.
            let left = (x / unit).min(M as i16 - 9).max(7) - 7;
            let expected = few.encoder().encode(x - left * unit);
            let spikes = encoder.encode(x);
            if M > 16 && x > 8 * unit && x < unit * (M as i16 - 10) {
                let expected = expected.iter().map(|(i, slot)| (i + left as u16, slot));
                assert!(spikes.iter().eq(expected), "{x} of {M}");
            }
            assert!((i32::from(decoder.decode(spikes)) - i32::from(x)).abs() <= i32::from(unit));
        }
    }
    check::<255>(10);
    check::<256>(10);
    check::<257>(10);
    check::<512>(10);
    check::<1023>(10);
    check::<1024>(10);
}

/// A code goes through its firings and back, the last neuron and the last slot included.
#[test]
fn codes_of_many_neurons() {
    let fired = |neuron, slot| NeuronSpike { neuron, slot, polarity: Polarity::Up };
    for neuron in [0, 254, 255, 256, 1022, 1023] {
        let code = Neuron::<1024>::new(neuron);
        assert_eq!(code.map(Neuron::index), Some(neuron));
        assert_eq!(Option::<Neuron<1024>>::assemble(code.firings()), code);
        let code = FiredNeurons::<1024>::new([neuron, 7]).unwrap();
        assert_eq!(FiredNeurons::assemble(code.firings()), code);
    }
    for slots in [&[255_u8][..], &[0, 255], &[254, 255, 255], &[255, 254, 253, 255]] {
        for first in [0, 255, 1020] {
            let code = SlotSpikes::<1024, 256>::new(first, slots).unwrap();
            assert_eq!(code.len(), slots.len());
            assert_eq!(SlotSpikes::assemble(code.firings()), code, "{slots:?} at {first}");
            assert!(
                code.iter().map(|(_, slot)| slot).eq(slots.iter().map(|&slot| u16::from(slot)))
            );
        }
    }
    let silent = SlotSpikes::<5, 256>::assemble([fired(2, 256), fired(5, 0)].into_iter());
    assert_eq!(silent, SlotSpikes::EMPTY);
    let last = SlotSpikes::<5, 256>::assemble([fired(4, 255)].into_iter());
    assert!(last.iter().eq([(4, 255)]));
}

/// Slot 255 of 256 takes part in the value.
#[test]
fn the_last_slot_of_256() {
    let scheme = Slots::<f32, 5, 256>::try_new(0.0..=3.0, 1.5).unwrap();
    let mut last = 0;
    for x in -2000..=5000 {
        let spikes = scheme.encoder().encode(x as f32 / 1000.0);
        last += spikes.iter().filter(|&(_, slot)| slot == 255).count();
        let whole = SlotSpikes::assemble(spikes.firings());
        assert_eq!(whole, spikes);
        let levels = spikes.iter().map(|(i, slot)| (scheme.centres()[usize::from(i)], 256 - slot));
        let (mut sum, mut total) = (0.0, 0.0);
        for (centre, level) in levels {
            sum += centre * f32::from(level);
            total += f32::from(level);
        }
        if total > 0.0 {
            assert_eq!(scheme.decoder().decode(whole), sum / total);
        }
    }
    assert!(last > 50, "{last} spikes came in the last slot");
}
