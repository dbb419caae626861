//! Rank order coding: the nearest neurons fire, the nearest first.

use crate::common::{
    Drawn, cases, flight_channels, float, hostile_recordings, in_every_integer, ranges,
};
use host_tests::compare::{Wire, assert_same_values, decode, encode, whole};
use host_tests::reference::{nearest_first, rank_order_value};
use proptest::prelude::*;
use spikewire::population::{RankOrder, SlotSpikes};
use spikewire::{ConfigError, Scheme};

/// Neurons in the order of their slots.
fn order_of<const M: usize, const K: usize>(spikes: SlotSpikes<M, K>) -> Vec<usize> {
    let mut pairs: Vec<_> = spikes.iter().map(|(neuron, slot)| (slot, neuron)).collect();
    pairs.sort_unstable();
    pairs.into_iter().map(|(_, neuron)| neuron.into()).collect()
}

/// Encoder, decoder, and the decoder after any number of spikes, in integers.
fn check<S: Wire, const M: usize, const K: usize>(
    scheme: &RankOrder<S, M, K>,
    min: S,
    max: S,
    x: &[S],
) {
    let run = encode(scheme, x);
    let centres = scheme.centres().map(whole);
    let (low, high) = (whole(min), whole(max));
    let mut values = Vec::new();
    for (&x, &spikes) in x.iter().zip(&run.outputs) {
        let x = whole(x).clamp(low, high);
        let order = nearest_first(x, &centres, K);
        assert_eq!(order_of(spikes), order, "{x} of {centres:?}");
        let value = rank_order_value(&order, &centres, low, high).expect("of an encoder");
        values.push(S::from_bits32(value as u32).real());
        // Law A: the interval of all values with these spikes.
        let alike = |x: i64| nearest_first(x, &centres, K) == order;
        let reach = (x - value).abs();
        let mirrored = 2 * value - x;
        let is_within = reach <= 1
            || (low..=high).contains(&mirrored) && alike(mirrored)
            || alike((mirrored + (x - value).signum()).clamp(low, high));
        assert!(is_within, "{x}: {value} is not in the middle of {order:?}");
    }
    let decoder = scheme.decoder();
    assert_same_values(&decode(&decoder, &run.outputs), &values);
}

#[test]
fn the_printed_check_values() {
    const CENTRES: [i16; 5] = [0, 10, 30, 70, 150];
    fn check<const K: usize>(order: [usize; K], value: i16) {
        let scheme = RankOrder::<i16, 5, K>::new(CENTRES);
        let spikes = scheme.encoder().encode(37);
        assert_eq!(order_of(spikes), order);
        assert_eq!(scheme.decoder().decode(spikes), value);
    }
    check([2], 35);
    check([2, 1], 30);
    check([2, 1, 3], 38);
}

/// A chip that fires what no value explains, and losses on the way.
#[test]
fn spikes_that_no_value_explains_end_it() {
    let scheme = RankOrder::<i16, 5, 4>::new([0, 10, 30, 70, 150]);
    let value_of = |first, ranks: &[u8]| {
        let mut decoder = scheme.decoder();
        decoder.resync(-7);
        decoder.decode(SlotSpikes::new(first, ranks).unwrap())
    };
    let table: [(u16, &[u8], i16); 7] = [
        (2, &[0], 35),
        (1, &[1, 0], 30),
        (1, &[1, 0, 2], 38),
        (1, &[1, 0, 3], 30), // one lost
        (1, &[1, 0, 1], 30), // two at once: the lower, and the other too late
        (1, &[2, 1], -7),    // without a first
        (0, &[], -7),
    ];
    for (first, ranks, value) in table {
        assert_eq!(value_of(first, ranks), value, "{ranks:?} from {first}");
    }
    // Even centres: the last is nearest to no value of the range.
    let scheme = RankOrder::<i16, 5, 2>::linear(-300..=300);
    let mut decoder = scheme.decoder();
    assert_eq!(decoder.decode(SlotSpikes::new(4, &[0]).unwrap()), 0);
}

#[test]
fn readout_of_thorpe() {
    let spikes = RankOrder::<i16, 5, 3>::new([0, 10, 30, 70, 150]).encoder().encode(37);
    // Neurons 2, 1, 3: 4, 2, 1.
    assert_eq!(RankOrder::<i16, 5, 3>::readout(&spikes, &[100, 10, 1, -3, 100]), 4 + 20 - 3);
    assert_eq!(RankOrder::<i16, 5, 3>::readout(&SlotSpikes::EMPTY, &[1; 5]), 0);
}

#[test]
fn refusals() {
    let error = |result: Result<RankOrder<f32, 3, 2>, ConfigError>| result.unwrap_err().to_string();
    assert_eq!(
        error(RankOrder::try_new([0.0, 2.0, 1.0])),
        "centres must rise strictly, but number 2 is 1 after 2"
    );
    assert!(error(RankOrder::try_new([0.0, 2.0, 1e32])).starts_with("centre 1"));
    assert_eq!(error(RankOrder::try_linear(f32::NAN..=1.0)), "min NaN must be finite");
    let one = 1.0_f32;
    let close = [one.next_up(), one.next_up().next_up(), one.next_up().next_up().next_up()];
    assert!(matches!(RankOrder::<_, 3, 2>::try_new(close), Err(ConfigError::EmptyCell { .. })));
    // A middle that is rounded to the last centre is still a middle of its own.
    assert!(RankOrder::<_, 3, 2>::try_new([0.0, close[0], close[1]]).is_ok());
    for (spikes, neurons) in [(0, 5), (6, 5), (257, 300)] {
        let scheme =
            spikewire::dynamic::RankOrder::<i16>::try_linear(neurons, spikes, &(-3000..=3000));
        let most = neurons.min(256);
        let message = format!("spikes a sample {spikes} must lie in 1..={most}");
        assert_eq!(scheme.unwrap_err().to_string(), message);
    }
}

/// In a range so wide that its centres, rounded, have their middle below the minimum.
#[test]
fn what_lies_outside_is_the_end_of_the_range() {
    for max in [1e8, 3e8, 1e9, 3e30] {
        let scheme = RankOrder::<f32, 7, 3>::linear(1.0..=max);
        let encode = |x| scheme.encoder().encode(x);
        for x in [-max, -3.0, 0.0, 1.0_f32.next_down()] {
            assert_eq!(encode(x), encode(1.0), "{x} below 1..={max}");
        }
        assert_eq!(encode(2.0 * max), encode(max));
    }
}

/// Floats: the value with the same spikes lies in the same interval, and halves of a spacing are told apart.
#[test]
fn floats() {
    let scheme = RankOrder::<f32, 15, 3>::linear(-4.0..=4.0);
    let spacing = 8.0 / 13.0;
    for channel in flight_channels() {
        let run = encode(&scheme, &channel);
        let values = decode(&scheme.decoder(), &run.outputs);
        for (x, y) in channel.iter().zip(values) {
            assert!((x.clamp(-4.0, 4.0) - y).abs() <= spacing / 4.0 + 1e-6, "{x} {y}");
        }
    }
    for x in hostile_recordings() {
        for (&x, spikes) in x.iter().zip(encode(&scheme, &x).outputs) {
            assert_eq!(spikes.is_empty(), !x.is_finite());
        }
    }
    // The ends of the range, and -0 at a middle.
    let ends = [-4.0, 4.0, -0.0, 0.0].map(|x| scheme.decoder().decode(scheme.encoder().encode(x)));
    for (x, y) in [-4.0_f32, 4.0, 0.0, 0.0].into_iter().zip(ends) {
        assert!((x - y).abs() <= spacing / 4.0 + 1e-6, "{x} {y}");
    }
}

/// What is decoded has the spikes that it was decoded from.
#[test]
fn drawn_floats() {
    let list = proptest::collection::vec(-4.0_f32..4.0, 7);
    proptest!(cases(256), |(mut list in list, x in proptest::collection::vec(float(), 40))| {
        list.sort_by(f32::total_cmp);
        prop_assume!(list.windows(2).all(|pair| pair[1] - pair[0] > 1e-3));
        let centres: [f32; 7] = list.try_into().unwrap();
        let scheme = RankOrder::<f32, 7, 4>::new(centres);
        let run = encode(&scheme, &x);
        for (&x, &spikes) in x.iter().zip(&run.outputs).filter(|(x, _)| x.is_finite()) {
            let value = scheme.decoder().decode(spikes);
            assert_eq!(scheme.encoder().encode(value), spikes, "{x} {value}");
            let x = x.clamp(centres[0], centres[6]);
            let sorted = order_of(spikes);
            assert!(sorted.windows(2).all(|pair| {
                (x - centres[pair[0]]).abs() <= (x - centres[pair[1]]).abs() + 1e-6
            }));
        }
    });
}

fn check_centres<S: Wire, const K: usize>(centres: [S; 7], x: &[S]) {
    if let Ok(scheme) = RankOrder::<S, 7, K>::try_new(centres) {
        check(&scheme, centres[0], centres[6], x);
    }
}

fn drawn<S: Wire + Drawn + Ord>() {
    let list = proptest::collection::btree_set(S::value(), 7);
    proptest!(cases(96), |(set in list, mut x in S::recordings(), [min, max] in ranges::<S>())| {
        let list: Vec<_> = set.into_iter().collect();
        let centres: [S; 7] = list.try_into().unwrap();
        x.extend(centres);
        check_centres::<S, 1>(centres, &x);
        check_centres::<S, 4>(centres, &x);
        check_centres::<S, 7>(centres, &x);
        if let Ok(scheme) = RankOrder::<S, 15, 3>::try_linear(min..=max) {
            check(&scheme, min, max, &x);
        }
    });
}

#[test]
fn drawn_recordings() {
    in_every_integer!(drawn);
}

#[test]
fn all_65536_inputs() {
    let counts: Vec<_> = (i16::MIN..=i16::MAX).collect();
    check(&RankOrder::<i16, 15, 3>::linear(-20_000..=25_001), -20_000, 25_001, &counts);
    check(
        &RankOrder::<i16, 5, 5>::new([i16::MIN, -30_000, 0, 9, i16::MAX]),
        i16::MIN,
        i16::MAX,
        &counts,
    );
    // A quarter of a spacing, and a step.
    let scheme = RankOrder::<i16, 20, 2>::linear(-20_000..=25_001);
    let spacing = 45_001.0 / 18.0;
    for x in -20_000..=25_001 {
        let value = scheme.decoder().decode(scheme.encoder().encode(x));
        assert!(f64::from((x - value).abs()) <= spacing / 4.0 + 1.0, "{x} {value}");
    }
}
