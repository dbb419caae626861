//! GRF with one spike: the neuron with the largest response fires, which is the one with the nearest
//! of `M` even centres.

use crate::common::{Drawn, cases, flight_channels, hostile_recordings, in_every_type};
use fixed::types::{I1F15, I8F8, I16F16};
use host_tests::compare::{Wire, check_position, encode};
use host_tests::reference::{even_centres, nearest_even, receptive_field_width};
use proptest::prelude::*;
use spikewire::population::Gaussian;

/// Encoder and decoder against the reference.
fn check<S: Wire, const M: usize>(min: S, max: S, x: &[S]) {
    let Ok(scheme) = Gaussian::<S, M>::try_linear(min..=max) else {
        return; // too coarse for the type
    };
    let (min, max) = (min.real(), max.real());
    let values = even_centres(min.into(), max.into(), M);
    let values: Vec<_> = values.into_iter().map(|value| S::nearest(value).real()).collect();
    check_position(&scheme, x, &values, |x| nearest_even(x, min, max, M));
}

#[test]
fn cases_by_hand() {
    // Centres -0.25, 0.25, 0.75, 1.25.
    let scheme = Gaussian::<f32, 4>::try_linear(0.0..=1.0).unwrap();
    let x = [-1e30, -0.1, 0.0, 0.1, 0.5, 0.500_001, 1.0, 1.000_001, 1e30, f32::NAN];
    let neurons: Vec<_> = encode(&scheme, &x)
        .outputs
        .iter()
        .map(|neuron| neuron.map_or(-1, |neuron| neuron.index().into()))
        .collect::<Vec<i32>>();
    assert_eq!(neurons, [0, 0, 0, 1, 1, 2, 2, 3, 3, -1]);
}

/// The winner's response is the largest, wherever the responses do not underflow.
#[test]
fn the_winner_takes_all() {
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

#[test]
fn flights() {
    for channel in flight_channels() {
        check::<f32, 20>(-9.0, 9.0, &channel);
        check::<f32, 15>(-0.1, 0.2, &channel);
        let fixed: Vec<_> = channel.iter().map(|&x| I8F8::from_num(x)).collect();
        check::<I8F8, 20>(I8F8::from_num(-9), I8F8::from_num(9), &fixed);
        let fixed: Vec<_> = channel.iter().map(|&x| I16F16::from_num(x)).collect();
        check::<I16F16, 20>(I16F16::from_num(-9), I16F16::from_num(9), &fixed);
    }
}

#[test]
fn hostile() {
    for x in hostile_recordings() {
        check::<f32, 4>(0.0, 1.0, &x);
        check::<f32, 20>(-1e-40, 1e-40, &x);
        check::<f32, 20>(-1e38, 1e38, &x);
    }
}

fn drawn<S: Wire + Drawn>() {
    let cases = &cases(128);
    proptest!(cases, |((x, a, b) in (S::recordings(), S::value(), S::value()))| {
        let (min, max) = if a < b { (a, b) } else { (b, a) };
        prop_assume!(min < max);
        check::<S, 3>(min, max, &x);
        check::<S, 4>(min, max, &x);
        check::<S, 20>(min, max, &x);
        check::<S, 64>(min, max, &x);
    });
}

#[test]
fn drawn_recordings() {
    in_every_type!(drawn);
}

#[test]
fn all_65536_inputs() {
    let counts: Vec<_> = (i16::MIN..=i16::MAX).collect();
    check::<_, 3>(-20_000_i16, 25_001, &counts);
    check::<_, 64>(i16::MIN + 1000, i16::MAX - 1000, &counts);
    let bits: Vec<_> = counts.iter().copied().map(I8F8::from_bits).collect();
    check::<_, 20>(I8F8::from_num(-9), I8F8::from_num(9.1), &bits);
    let bits: Vec<_> = counts.iter().copied().map(I1F15::from_bits).collect();
    check::<_, 15>(I1F15::from_num(-0.5), I1F15::from_num(0.7), &bits);
}
