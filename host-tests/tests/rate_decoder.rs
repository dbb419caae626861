//! The decoder of the rate codes with a filter, in long slices: a core with vectors decodes many values at once.

use crate::common::rate::{first_taps, taps};
use crate::common::{Drawn, cases, in_every_type};
use host_tests::compare::{Wire, assert_same_values, reals, saturated, signs_of};
use host_tests::reference::rate_decode;
use proptest::collection::vec;
use proptest::prelude::*;
use spikewire::rate::{Hough, Taps};
use spikewire::{Scheme, Spike};

/// A recording in one slice, in two and in three, each into a buffer with room for more.
fn check<S: Wire, const F: usize>(taps: &Taps<S, F>, shift: S, spikes: &[Spike]) {
    let scheme = Hough::new(*taps).try_with_shift(shift).unwrap();
    let signs: Vec<_> = signs_of(spikes).into_iter().map(|sign| sign.max(0)).collect();
    let expected = saturated::<S>(&rate_decode(&signs, &reals(taps.as_array()), shift.real()));
    for pieces in 1..=3 {
        let mut decoder = scheme.decoder();
        let mut values = Vec::new();
        for piece in spikes.chunks(spikes.len().div_ceil(pieces).max(1)) {
            let mut buffer = vec![S::default(); piece.len() + 200];
            assert_eq!(decoder.decode_slice(piece, &mut buffer), piece.len());
            assert!(buffer.split_off(piece.len()).iter().all(|&value| value == S::default()));
            values.append(&mut buffer);
        }
        assert_same_values(&values, &expected);
    }
}

fn spikes(most: usize) -> impl Strategy<Value = Vec<Spike>> {
    let dense = prop_oneof![Just(Spike::None), Just(Spike::Up), Just(Spike::Down)];
    let sparse = prop_oneof![20 => Just(Spike::None), 1 => Just(Spike::Up), 1 => Just(Spike::Down)];
    let mixed = (vec(dense.clone(), 0..most / 2), vec(sparse.clone(), 0..most / 2));
    prop_oneof![
        vec(dense, 0..most),
        vec(sparse, 0..most),
        mixed.prop_map(|(dense, sparse)| [dense, sparse].concat()),
        vec(Just(Spike::Up), 0..most)
    ]
}

/// Filters that are shorter and longer than the groups in which taps are taken.
fn drawn_slices<S: Wire + Drawn>() {
    proptest!(cases(64), |(taps in taps::<S>(), shift in S::shift(), spikes in spikes(900))| {
        check::<S, 1>(&first_taps(&taps), shift, &spikes);
        check::<S, 2>(&first_taps(&taps), shift, &spikes);
        check::<S, 16>(&first_taps(&taps), shift, &spikes);
        check::<S, 17>(&first_taps(&taps), shift, &spikes);
        check::<S, 24>(&first_taps(&taps), shift, &spikes);
    });
}

#[test]
fn slices_give_the_sums_of_the_reference() {
    in_every_type!(drawn_slices);
}

/// A sum of 0 keeps its sign, and a tap of -0 changes none.
#[test]
fn zeros() {
    for (shift, period) in [(0.0, 7), (-0.0, 7), (0.0, 40), (-0.0, 40)] {
        let fired = |i: usize| if i % period < 3 { Spike::Up } else { Spike::None };
        let spikes: Vec<_> = (0..600).map(fired).collect();
        check(&Taps::try_new([-0.0_f32, 1.0, -1.0, -0.0]).unwrap(), shift, &spikes);
        check(&Taps::try_new([1.0_f32, -1.0]).unwrap(), shift, &spikes);
    }
}

/// As many values as there are codes and room for.
#[test]
fn the_shorter_slice_ends_it() {
    let scheme = Hough::new(Taps::<f32, 3>::triangular(1.0));
    let spikes = [Spike::Up; 500];
    let mut values = [9.0; 500];
    assert_eq!(scheme.decoder().decode_slice(&spikes, &mut values[..300]), 300);
    assert!(values[2..300].iter().all(|&value| value == 2.0));
    assert!(values[300..].iter().all(|&value| value == 9.0));
}
