//! Position coding: the neuron with the nearest centre fires; halfway the lower one, outside the one
//! at that end. GRF with one spike is the same with even centres: the nearest has the largest response.

use crate::common::{
    Drawn, HOSTILE, between, cases, flights, float, hostile_recordings, in_every_integer, ranges,
};
use fixed::types::{I1F15, I8F8, I16F16, I32F0};
use host_tests::compare::{Wire, check_position, encode, reals};
use host_tests::reference::{
    even_centres, gaussian_centres, nearest, nearest_even, receptive_field_width,
};
use proptest::prelude::*;
use spikewire::Scheme;
use spikewire::population::{Gaussian, Neuron, Position};

/// The user's centres against the reference.
fn check<S: Wire, const M: usize>(values: [S; M], x: &[S]) {
    let scheme = Position::try_new(values).unwrap();
    let values = reals(&values);
    check_position(&scheme, x, &values, |x| nearest(x, &values));
}

/// Linear centres against the reference.
fn check_linear<S: Wire, const M: usize>(min: S, max: S, x: &[S]) {
    let scheme = Position::<S, M>::try_linear(min..=max).unwrap();
    let (min, max) = (min.real(), max.real());
    let values = even_centres(min.into(), max.into(), M);
    let values: Vec<_> = values.into_iter().map(|value| S::nearest(value).real()).collect();
    check_position(&scheme, x, &values, |x| nearest_even(x, min, max, M));
}

/// Gaussian-spaced centres against the reference.
fn check_gaussian_spaced<S: Wire, const M: usize>(min: S, max: S, x: &[S]) {
    let scheme = Position::<S, M>::try_gaussian_spaced(min..=max).unwrap();
    let values = gaussian_centres(min.to_f64(), max.to_f64(), M);
    let values: Vec<_> = values.into_iter().map(|value| S::nearest(value).real()).collect();
    check_position(&scheme, x, &values, |x| nearest(x, &values));
}

/// Linear centres, if the type is fine enough for them.
fn check_linear_if_fine<S: Wire, const M: usize>([min, max]: [S; 2], x: &[S]) {
    if Position::<S, M>::try_linear(min..=max).is_ok() {
        check_linear::<S, M>(min, max, x);
    }
}

/// Each value, and its neighbours to either side.
fn around(values: impl IntoIterator<Item = f64>) -> Vec<f32> {
    let neighbours = |value: f64| {
        let value = value as f32;
        let (up, down) = (value.next_up(), value.next_down());
        [value, up, down, up.next_up(), down.next_down()]
    };
    values.into_iter().flat_map(neighbours).collect()
}

/// Halfway between each two values.
fn halves(values: &[f64]) -> Vec<f64> {
    values.windows(2).map(|pair| f64::midpoint(pair[0], pair[1])).collect()
}

#[test]
fn cases_by_hand() {
    let scheme = Position::try_new([-2.0_f32, 0.0, 0.5, 4.0]).unwrap();
    let table = [
        ("on a centre", 0.5, Some(2)),
        ("near one", 0.4, Some(2)),
        ("halfway belongs to the lower", 0.25, Some(1)),
        ("halfway, below 0", -1.0, Some(0)),
        ("just above halfway", (-1.0_f32).next_up(), Some(1)),
        ("below all", -1e30, Some(0)),
        ("above all", 1e30, Some(3)),
        ("minus 0 is 0", -0.0, Some(1)),
        ("the lowest float", f32::MIN, Some(0)),
        ("not a number", f32::NAN, None),
        ("infinity", f32::INFINITY, None),
    ];
    for (name, x, neuron) in table {
        let output = scheme.encoder().encode(x);
        assert_eq!(output.map(Neuron::index), neuron, "{name}");
    }
}

#[test]
fn the_decoder_starts_in_the_middle_and_holds() {
    let scheme = Position::try_new([-2.0_f32, 0.0, 0.5, 4.0]).unwrap();
    let mut decoder = scheme.decoder();
    let neuron = |index| Some(Neuron::new(index).unwrap());
    let values = [None, neuron(3), None, neuron(0), None].map(|code| decoder.decode(code));
    assert_eq!(values, [0.5, 4.0, 4.0, -2.0, -2.0]);
    assert_eq!(Neuron::<4>::new(4), None);
}

#[test]
fn linear_centres() {
    let scheme = Position::<i16, 5>::try_linear(-300..=300).unwrap();
    assert_eq!(*scheme.centres(), [-400, -200, 0, 200, 400]);
    // Halfway between rounded centres is not halfway between centres: -2.5, 0, 2.5.
    let scheme = Position::<i16, 3>::try_linear(-1..=1).unwrap();
    assert_eq!(*scheme.centres(), [-2, 0, 2]);
    let scheme = Position::<i16, 4>::try_linear(0..=5).unwrap();
    assert_eq!(*scheme.centres(), [-1, 1, 4, 6]); // -1.25, 1.25, 3.75, 6.25
    let neurons = encode(&scheme, &[-9, 0, 1, 2, 3, 4, 5, 6, 9]).outputs;
    let neurons: Vec<_> = neurons.into_iter().map(|neuron| neuron.unwrap().index()).collect();
    assert_eq!(neurons, [0, 0, 1, 1, 2, 2, 2, 3, 3]);
}

/// Gaussian-spaced centres in 32 bits are exact centres, rounded once.
#[test]
fn gaussian_spaced_centres_are_exact() {
    fn check<const M: usize>(min: I32F0, max: I32F0) {
        let Ok(scheme) = Position::<I32F0, M>::try_gaussian_spaced(min..=max) else { return };
        let exact = gaussian_centres(min.to_num(), max.to_num(), M);
        for (&ours, exact) in scheme.centres().iter().zip(exact) {
            assert_eq!(ours, I32F0::nearest(exact));
        }
    }
    proptest!(cases(64), |([min, max] in ranges::<I32F0>())| {
        check::<3>(min, max);
        check::<20>(min, max);
        check::<101>(min, max);
    });
}

/// What is built at compile time is what is built in flight.
#[test]
fn constants() {
    static LINEAR: Position<f32, 20> = Position::linear(-9.0..=9.1);
    static SPACED: Position<f32, 21> = Position::gaussian_spaced(-0.3..=0.7);
    static OWN: Position<I8F8, 3> = Position::new([I8F8::NEG_ONE, I8F8::DELTA, I8F8::MAX]);
    static COUNTS: Position<i16, 20> = Position::linear(-30_000..=20_001);
    static WORDS: Position<I16F16, 9> = Position::gaussian_spaced(I16F16::ZERO..=I16F16::MAX);
    assert_eq!(LINEAR, Position::try_linear(-9.0..=9.1).unwrap());
    assert_eq!(SPACED, Position::try_gaussian_spaced(-0.3..=0.7).unwrap());
    assert_eq!(OWN, Position::try_new([I8F8::NEG_ONE, I8F8::DELTA, I8F8::MAX]).unwrap());
    assert_eq!(COUNTS, Position::try_linear(-30_000..=20_001).unwrap());
    assert_eq!(WORDS, Position::try_gaussian_spaced(I16F16::ZERO..=I16F16::MAX).unwrap());
}

/// Of fields of one width the strongest response, wherever the responses do not underflow, is that of the nearest centre.
#[test]
fn the_nearest_centre_has_the_strongest_response() {
    const M: usize = 20;
    let (min, max) = (-9.0_f32, 9.1_f32);
    let scheme = Gaussian::<f32, M>::try_linear(min..=max).unwrap();
    let mu = even_centres(min.into(), max.into(), M);
    let sigma = receptive_field_width(min.into(), max.into(), M, 1.5);
    let x: Vec<_> = (-1000..=1000).map(|i| i as f32 * 0.01).collect();
    for (x, neuron) in x.iter().zip(encode(&scheme, &x).outputs) {
        let response = |mu: f64| (-(f64::from(*x) - mu).powi(2) / (2.0 * sigma.powi(2))).exp();
        let winner = response(mu[usize::from(neuron.unwrap().index())]);
        assert!(mu.iter().all(|&mu| response(mu) <= winner), "{x}");
    }
}

flights!(S: Wire, |x, unit| {
    let at = |value: f64| S::from_f64(value * unit);
    check_linear::<S, 20>(at(-9.0), at(9.0), &x);
    check_linear::<S, 15>(at(-1.0), at(2.0), &x);
    check_gaussian_spaced::<S, 21>(at(-9.0), at(9.0), &x);
});

#[test]
fn hostile() {
    for x in hostile_recordings() {
        check([-1.0, -1e-45, 0.0, 1e-45, 1e38], &x);
        check([f32::MIN, 0.0, f32::MAX], &x);
        check_linear::<f32, 3>(f32::MIN / 2.0, f32::MAX / 2.0, &x);
        check_linear::<f32, 4>(0.0, 1.0, &x);
        check_linear::<f32, 20>(-1e-38, 1e-38, &x);
        check_linear_if_fine::<f32, 20>([-1e-40, 1e-40], &x);
        check_gaussian_spaced::<f32, 5>(f32::MIN, f32::MAX, &x);
    }
}

fn rising(count: usize) -> impl Strategy<Value = Vec<f32>> {
    let value = prop_oneof![-4.0_f32..4.0, (-40..40_i8).prop_map(f32::from), f32::value()];
    proptest::collection::vec(value, count..4 * count).prop_filter_map("rising", move |mut list| {
        list.sort_by(f32::total_cmp);
        list.dedup_by(|a, b| a == b);
        list.truncate(count);
        (list.len() == count).then_some(list)
    })
}

/// Exactly nearest, at each edge and at the floats next to it.
#[test]
fn edges() {
    proptest!(cases(512), |(list in rising(7))| {
        let values: [f32; 7] = list.try_into().unwrap();
        let doubles = values.map(f64::from);
        let mut x = around(halves(&doubles));
        x.extend(around(doubles));
        check(values, &x);
    });
}

/// An edge at 0, which -0 does not lie beyond, among centres too close for cells, and among others.
#[test]
fn edges_at_zero() {
    let x = [-0.0, 0.0, 1e-45, -1e-45, 1.0, -1.0, 100.0];
    check([-1.0, 1.0, 1.001, 1.002, 1.003, 100.0], &x);
    check([-1.0, 1.0, 3.0], &x);
    check([-1e-45, 0.0, 1e-45, 1.0, 100.0], &x);
    check_linear::<f32, 4>(-1.0, 1.0, &x);
}

/// Even where one centre is too small to move the sum of both in double precision.
#[test]
fn edges_of_centres_of_any_size() {
    for (tiny, neurons) in [(-1e-30_f32, [1, 2, 2]), (1e-30, [1, 1, 2])] {
        let scheme = Position::try_new([-9.0, tiny, 1.0]).unwrap();
        let x = [0.5_f32.next_down(), 0.5, 0.5_f32.next_up()];
        let outputs = encode(&scheme, &x).outputs;
        let ours: Vec<_> = outputs.into_iter().map(|neuron| neuron.unwrap().index()).collect();
        assert_eq!(ours, neurons, "{tiny}");
    }
}

/// The edges of a linear population, and the values within two last places of each.
fn around_edges<S: Wire>(min: S, max: S, m: usize) -> Vec<S> {
    let (min, max) = (min.to_f64(), max.to_f64());
    let steps = if size_of::<S>() == 2 { 65_535.0 } else { 4_294_967_295.0 };
    let unit = (S::ends()[1].into() - S::ends()[0].into()) / steps;
    halves(&even_centres(min, max, m))
        .into_iter()
        .flat_map(|edge| (-2..=2).map(move |i| S::nearest(edge + f64::from(i) * unit)))
        .collect()
}

/// The same in integers, with ranges from the finest to the widest, and any samples.
fn drawn_edges<S: Wire + Drawn>() {
    fn check<S: Wire, const M: usize>([min, max]: [S; 2], x: &[S]) {
        let edges = around_edges(min, max, M).into_iter().step_by(1 + M / 64);
        check_linear_if_fine::<S, M>(
            [min, max],
            &edges.chain(x.iter().copied()).collect::<Vec<_>>(),
        );
    }
    proptest!(cases(48), |(range in ranges::<S>(), x in S::recordings())| {
        check::<S, 3>(range, &x);
        check::<S, 4>(range, &x);
        check::<S, 20>(range, &x);
        check::<S, 65>(range, &x);
        check::<S, 1000>(range, &x);
    });
}

#[test]
fn edges_of_integer_ranges() {
    in_every_integer!(drawn_edges);
}

/// Ranges so fine that a spacing is a few last places of a float: all floats within.
#[test]
fn spacings_of_a_few_last_places() {
    proptest!(cases(256), |(min in prop_oneof![-9.0_f32..9.0, between(1e-40, 1e-36)], last in 20..400_u32)| {
        let mut x = vec![min];
        x.extend((0..last).scan(min, |x, _| {
            *x = x.next_up();
            Some(*x)
        }));
        let max = x[x.len() - 1];
        check_linear_if_fine::<f32, 20>([min, max], &x);
        check_linear_if_fine::<f32, 65>([min, max], &x);
    });
}

/// Ranges of every size, from subnormals to half of all floats.
#[test]
fn ranges_of_every_size() {
    proptest!(cases(256), |([min, max] in ranges::<f32>(), mut x in f32::recordings())| {
        x.extend(around(halves(&even_centres(min.into(), max.into(), 20))));
        x.extend(HOSTILE);
        check_linear_if_fine::<f32, 3>([min, max], &x);
        check_linear_if_fine::<f32, 20>([min, max], &x);
    });
}

/// The same with linear and Gaussian-spaced centres.
#[test]
fn edges_of_ranges() {
    fn check_both<const M: usize>(min: f32, max: f32) {
        let linear = even_centres(min.into(), max.into(), M);
        check_linear::<f32, M>(min, max, &around(halves(&linear)));
        let spaced = gaussian_centres(min.into(), max.into(), M);
        let spaced: Vec<_> = spaced.into_iter().map(|value| f64::from(value as f32)).collect();
        check_gaussian_spaced::<f32, M>(min, max, &around(halves(&spaced)));
    }
    proptest!(cases(128), |(min in -100.0_f32..100.0, width in between(0.01, 100.0))| {
        let max = min + width;
        check_both::<3>(min, max);
        check_both::<4>(min, max);
        check_both::<15>(min, max);
        check_both::<20>(min, max);
        check_both::<65>(min, max);
    });
    check_both::<1024>(-9.0, 9.1);
}

fn integers<S: Wire + Drawn + Ord>() {
    let list = proptest::collection::btree_set(S::value(), 5);
    proptest!(cases(128), |(set in list, x in S::recordings())| {
        let list: Vec<_> = set.into_iter().collect();
        let values: [S; 5] = list.try_into().unwrap();
        check(values, &x);
    });
}

#[test]
fn drawn_recordings() {
    let floats = proptest::collection::vec(float(), 0..60);
    proptest!(cases(256), |(list in rising(5), x in floats)| {
        let values: [f32; 5] = list.try_into().unwrap();
        check(values, &x);
    });
    in_every_integer!(integers);
}

#[test]
fn all_65536_inputs() {
    let counts: Vec<_> = (i16::MIN..=i16::MAX).collect();
    check([i16::MIN, -30_000, -1, 0, 2, 5, i16::MAX], &counts);
    check_linear::<_, 20>(-20_000_i16, 25_001, &counts);
    check_linear::<_, 3>(i16::MIN + 1, i16::MAX, &counts);
    check_linear::<_, 64>(i16::MIN + 1000, i16::MAX - 1000, &counts);
    check_gaussian_spaced::<_, 21>(-20_000_i16, 25_001, &counts);
    let bits: Vec<_> = counts.iter().copied().map(I8F8::from_bits).collect();
    check_linear::<_, 20>(I8F8::from_num(-9), I8F8::from_num(9.1), &bits);
    check_gaussian_spaced::<_, 20>(I8F8::from_num(-9), I8F8::from_num(9.1), &bits);
    let bits: Vec<_> = counts.iter().copied().map(I1F15::from_bits).collect();
    check_linear::<_, 15>(I1F15::from_num(-0.5), I1F15::from_num(0.7), &bits);
    check([I1F15::MIN, I1F15::from_bits(-7), I1F15::from_bits(-6), I1F15::MAX], &bits);
}
