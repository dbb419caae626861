//! Schemes whose shape is chosen at run time give the bits of those whose shape is a constant.

use fixed::types::{I8F8, I16F16};
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg32;
use spikewire::rate::{Criterion, Scale, Shape, Taps};
use spikewire::{
    Code, Fingerprint, Output, Sample, Scheme, Start, dynamic, population, rate, temporal,
};

/// With room for any number of neurons.
type AnyPosition<S> = dynamic::Position<S>;
type AnySlots<S> = dynamic::Slots<S>;
type AnyProbabilistic<S> = dynamic::Probabilistic<S, Pcg32>;

/// A signal for a scheme of so many neurons: fewer samples where each asks many of them.
fn signal_for<S: Sample>(neurons: usize, seed: u64, reach: f64) -> Vec<S> {
    let mut signal = signal(seed, reach);
    signal.truncate(if neurons > 64 { 750 } else { signal.len() });
    signal
}

/// A signal that wanders over ±`reach`, holds still, jumps, and has ties with whole eighths of it.
fn signal<S: Sample>(seed: u64, reach: f64) -> Vec<S> {
    let mut generator = Pcg32::seed_from_u64(seed);
    let mut unit = || f64::from(generator.next_u32()) / f64::from(u32::MAX) * 2.0 - 1.0;
    let mut value = 0.0;
    let samples = (0..3000).map(|at| {
        match at % 7 {
            0 => value = unit() * reach,
            1 | 2 => value += unit() * reach / 20.0,
            3 => value = (value / reach * 8.0).round() * reach / 8.0,
            _ => value *= 0.97,
        }
        S::from_f64(value)
    });
    samples.collect()
}

/// Everything that a scheme says of a signal: events of each code, the tail, the values decoded.
#[derive(Debug, PartialEq)]
struct Said {
    fingerprint: Fingerprint,
    latency: usize,
    codes: Vec<Option<Vec<(u16, u16, bool)>>>,
    keyframes: Vec<Option<u32>>,
    values: Vec<u32>,
    rejected: u32,
    neurons: usize,
    slots: usize,
    /// What the decoder holds at the end, and after it was told a value.
    held: [Option<u32>; 2],
}

fn said<P: Scheme>(
    scheme: &P,
    mut state: P::EncoderState,
    past: &[P::Sample],
    signal: &[P::Sample],
) -> Said {
    let firings = |code: &P::Code| {
        code.firings()
            .map(|firing| (firing.neuron, firing.slot, firing.polarity == spikewire::Polarity::Up))
            .collect()
    };
    scheme.prime(&mut state, past);
    let mut decoder = scheme.decoder_state();
    let (mut codes, mut keyframes, mut values) = (Vec::new(), Vec::new(), Vec::new());
    let mut take = |code: Option<P::Code>| {
        codes.push(code.as_ref().map(firings));
        values.extend(code.map(|code| scheme.decode(&mut decoder, code).to_bits32()));
    };
    for &sample in signal {
        take(scheme.encode(&mut state, sample).code());
        keyframes.push(scheme.keyframe(&state).map(Sample::to_bits32));
    }
    while let Some(code) = scheme.finish_next(&mut state) {
        take(Some(code));
    }
    let last = scheme.held(&decoder).map(Sample::to_bits32);
    scheme.resync(&mut decoder, signal[0]);
    let held = [last, scheme.held(&decoder).map(Sample::to_bits32)];
    let (neurons, slots) = (scheme.neurons(), scheme.slots());
    let (latency, rejected) = (scheme.latency(), P::rejected(&state));
    let fingerprint = scheme.fingerprint();
    Said { fingerprint, latency, codes, keyframes, values, rejected, neurons, slots, held }
}

/// Compares both on signals with and without a past, and says how many samples fired.
fn compare<A: Start, B: Scheme<Sample = A::Sample>>(
    what: &str,
    fixed: &A,
    any: &B,
    start: impl Fn() -> B::EncoderState,
    reach: f64,
) -> usize {
    let mut fires = 0;
    for seed in 0..2 {
        let mut signal = signal_for::<A::Sample>(any.neurons(), seed, reach);
        let past = if seed == 1 { signal.len() / 5 } else { 0 };
        let (past, now) = signal.split_at_mut(past);
        // Not finite in `f32`, and a number in fixed point.
        now[now.len() / 3] = A::Sample::from_f64(f64::NAN);
        let (one, other) = (said(fixed, A::START, past, now), said(any, start(), past, now));
        assert!(one == other, "{what}, seed {seed}");
        fires += one.codes.iter().flatten().filter(|code| !code.is_empty()).count();
    }
    fires
}

fn rates<S: Sample, const F: usize>(one: f64) {
    let at = |value: f64| S::from_f64(value * one);
    let longest = at(2.0 / F as f64);
    let signed: [S; F] = core::array::from_fn(|tap| {
        // Some taps below 0, and the first is not.
        let sign = if tap % 3 == 1 { -0.25 } else { 1.0 };
        S::from_f64(longest.to_f64().max(one / 8.0) * sign)
    });
    let all = [
        Taps::<S, F>::try_shaped(Shape::Triangular, Scale::Peak(at(0.5))),
        Taps::try_shaped(Shape::Hann, Scale::Peak(at(0.3))),
        Taps::try_new(signed),
    ];
    let mut fires = [0; 4];
    for (number, taps) in all.into_iter().enumerate() {
        // Too many taps for a type to hold their sum are refused by both.
        let Ok(taps) = taps else {
            continue;
        };
        let any = || dynamic::Taps::try_new(taps.as_array()).unwrap();
        let (shift, what) = (at(-2.0), format!("{F} taps, filter {number}, {:?}", S::KIND));
        let scheme = rate::Hough::new(taps).try_with_shift(shift).unwrap();
        let other = dynamic::Hough::try_new(any()).unwrap().try_with_shift(shift).unwrap();
        if number < 2 {
            fires[0] +=
                compare(&format!("hough, {what}"), &scheme, &other, || other.state(), 2.0 * one);
        }
        for threshold in [0.0, 0.85, 3.0] {
            let threshold = at(threshold);
            let scheme = rate::ThresholdHough::try_new(taps, threshold).unwrap();
            let scheme = scheme.try_with_shift(shift).unwrap();
            let other = dynamic::ThresholdHough::try_new(any(), threshold).unwrap();
            let other = other.try_with_shift(shift).unwrap();
            if number < 2 {
                fires[1] += compare(
                    &format!("t-hsa, {what}"),
                    &scheme,
                    &other,
                    || other.state(),
                    2.0 * one,
                );
            }
        }
        for criterion in [
            Criterion::Subtractive(at(0.0)),
            Criterion::Subtractive(at(0.2)),
            Criterion::Multiplicative(0.9),
        ] {
            let scheme = rate::Bsa::try_new(taps, criterion).unwrap();
            let scheme = scheme.try_with_shift(shift).unwrap();
            let other = dynamic::Bsa::try_new(any(), criterion).unwrap();
            let other = other.try_with_shift(shift).unwrap();
            fires[2] +=
                compare(&format!("bsa, {what}"), &scheme, &other, || other.state(), 2.0 * one);
        }
        let scheme = rate::BsaToolbox::try_new(taps, 1.15).unwrap();
        let scheme = scheme.try_with_shift(shift).unwrap();
        let other = dynamic::BsaToolbox::try_new(any(), 1.15).unwrap();
        let other = other.try_with_shift(shift).unwrap();
        fires[3] +=
            compare(&format!("toolbox, {what}"), &scheme, &other, || other.state(), 2.0 * one);
    }
    assert!(fires.iter().all(|&fires| fires > 10), "{F} taps, {:?}: {fires:?} fired", S::KIND);
}

fn windows<S: Sample, const N: usize>(one: f64) {
    let threshold = S::from_f64(0.25 * one);
    let scheme = temporal::MovingWindow::<S, N>::try_new(threshold).unwrap();
    let other = dynamic::MovingWindow::try_new(threshold, N).unwrap();
    let what = format!("{N} samples, {:?}", S::KIND);
    let fires = compare(&what, &scheme, &other, || other.state(), 2.0 * one);
    assert!(fires > 100, "{what}: {fires} fired");
}

fn populations<S: Sample, const M: usize>(one: f64) {
    let range = || S::from_f64(-1.7 * one)..=S::from_f64(1.6 * one);
    let what = format!("{M} neurons, {:?}", S::KIND);
    let scheme = population::Position::<S, M>::try_linear(range()).unwrap();
    let other = AnyPosition::try_linear(M, &range()).unwrap();
    assert_eq!(scheme.centres(), other.centres());
    compare(&what, &scheme, &other, || other.state(), 2.0 * one);

    let scheme = population::Position::<S, M>::try_gaussian_spaced(range());
    let other = AnyPosition::try_gaussian_spaced(M, &range());
    assert_eq!(scheme.as_ref().err(), other.as_ref().err(), "{what}");
    if let (Ok(scheme), Ok(other)) = (scheme, other) {
        compare(&what, &scheme, &other, || other.state(), 2.0 * one);
        let listed = AnyPosition::try_new(scheme.centres()).unwrap();
        compare(&what, &scheme, &listed, || listed.state(), 2.0 * one);
    }

    slots::<S, M, 10>(one);
    slots::<S, M, 256>(one);
    nonlinear::<S, M, 10>(one);
    rank_order::<S, M, 3>(one);

    let scheme = population::Probabilistic::<S, Pcg32, M, 256>::try_new(range(), 1.5).unwrap();
    let other = AnyProbabilistic::<S>::try_new(M, &range(), 1.5).unwrap();
    let state = || Pcg32::seed_from_u64(7);
    let mut signal = signal_for::<S>(M, 7, 2.0 * one);
    let middle = signal.len() / 3;
    signal[middle] = S::from_f64(f64::NAN);
    let one =
        said(&scheme, population::Probabilistic::<S, _, M, 256>::state(state()), &[], &signal);
    let two = said(&other, AnyProbabilistic::<S>::state(state()), &[], &signal);
    assert!(one == two, "probabilistic, {what}");
    assert!(one.codes.iter().flatten().any(|code| code.len() > 1), "probabilistic, {what}");
}

fn slots<S: Sample, const M: usize, const N: usize>(one: f64) {
    let range = || S::from_f64(-1.7 * one)..=S::from_f64(1.6 * one);
    for (beta, floor) in [(1.5, 1), (0.3, 1), (1.5, N as u16 / 2), (4.0, N as u16)] {
        let scheme = population::Slots::<S, M, N>::try_new(range(), beta).unwrap();
        let scheme = scheme.try_with_floor(floor).unwrap();
        let other = AnySlots::try_new(M, N, &range(), beta).unwrap();
        let other = other.try_with_floor(floor).unwrap();
        assert_eq!(scheme.centres(), other.centres());
        let what = format!("{M} neurons, {N} slots, beta {beta}, floor {floor}, {:?}", S::KIND);
        let signal = signal_for::<S>(M, 5, 2.0 * one);
        let signal = &signal[..signal.len() / 3];
        let fixed = said(&scheme, population::Slots::<S, M, N>::START, &[], signal);
        let any = said(&other, other.state(), &[], signal);
        assert!(fixed == any, "{what}");
    }
}

fn nonlinear<S: Sample, const M: usize, const N: usize>(one: f64) {
    let range = || S::from_f64(-1.7 * one)..=S::from_f64(1.6 * one);
    let what = format!("{M} non-linear fields, {N} slots, {:?}", S::KIND);
    let scheme = population::Position::<S, M>::try_companded(range(), 1.0);
    let other = AnyPosition::try_companded(M, &range(), 1.0);
    assert_eq!(scheme.as_ref().err(), other.as_ref().err(), "{what}");
    let (Ok(scheme), Ok(other)) = (scheme, other) else { return };
    compare(&what, &scheme, &other, || other.state(), 2.0 * one);
    let (centres, widths) = (*scheme.centres(), [(0.3 * one) as f32; M]);
    let scheme = population::Position::<S, M>::try_with_widths(centres, widths).unwrap();
    let other = AnyPosition::try_with_widths(&centres, &widths).unwrap();
    compare(&what, &scheme, &other, || other.state(), 2.0 * one);

    let signal = signal_for::<S>(M, 9, 2.0 * one);
    let check = |scheme: population::NonLinearSlots<S, M, N>, other: dynamic::NonLinearSlots<S>| {
        for floor in [1, N as u16 / 2] {
            let scheme = scheme.try_with_floor(floor).unwrap();
            let other = other.clone().try_with_floor(floor).unwrap();
            assert_eq!(scheme.centres(), other.centres());
            let fixed = said(&scheme, population::NonLinearSlots::<S, M, N>::START, &[], &signal);
            assert!(fixed == said(&other, other.state(), &[], &signal), "{what}, floor {floor}");
            assert!(fixed.codes.iter().flatten().any(|code| !code.is_empty()), "{what}");
        }
    };
    check(
        population::NonLinearSlots::try_companded(range(), 1.0, 1.5).unwrap(),
        dynamic::NonLinearSlots::try_companded(M, N, &range(), 1.0, 1.5).unwrap(),
    );
    check(
        population::NonLinearSlots::try_new(centres, widths).unwrap(),
        dynamic::NonLinearSlots::try_new(N, &centres, &widths).unwrap(),
    );
    let error = dynamic::NonLinearSlots::<S>::try_new(N, &centres, &widths[1..]).unwrap_err();
    assert!(error.to_string().starts_with("number of widths "), "{error}");
}

fn rank_order<S: Sample, const M: usize, const K: usize>(one: f64) {
    let range = || S::from_f64(-1.7 * one)..=S::from_f64(1.6 * one);
    let what = format!("{K} of {M} neurons in order, {:?}", S::KIND);
    let scheme = population::RankOrder::<S, M, K>::try_linear(range()).unwrap();
    let other = dynamic::RankOrder::<S>::try_linear(M, K, &range()).unwrap();
    assert_eq!(scheme.centres(), other.centres());
    compare(&what, &scheme, &other, || other.state(), 2.0 * one);
    let scheme = population::RankOrder::<S, M, K>::try_new(*scheme.centres()).unwrap();
    let other = dynamic::RankOrder::<S>::try_new(K, scheme.centres()).unwrap();
    compare(&what, &scheme, &other, || other.state(), 2.0 * one);
}

/// What a 1 is in each sample type's unit, so that raw counts have some range.
macro_rules! for_all_types {
    ($test:ident, $($shape:literal)*) => {
        $(
            $test::<f32, $shape>(1.0);
            $test::<i16, $shape>(4096.0);
            $test::<I8F8, $shape>(8.0);
            $test::<I16F16, $shape>(1.0);
        )*
    };
}

#[test]
fn filters_of_any_length() {
    for_all_types!(rates, 1 2 9 24 65);
}

#[test]
fn windows_of_any_length() {
    for_all_types!(windows, 1 2 8 9 65);
}

#[test]
fn populations_of_any_size() {
    for_all_types!(populations, 3 15);
    // Where a neuron's number no longer fits a byte, and the most: sizes are the matter of one type each.
    populations::<f32, 255>(1.0);
    populations::<i16, 256>(4096.0);
    populations::<I8F8, 257>(8.0);
    populations::<I16F16, 1024>(1.0);
}

#[test]
fn shapes_that_there_are_not() {
    let message = |error: spikewire::ConfigError| error.to_string();
    let (none, many) = (dynamic::Taps::<f32>::try_new(&[]), vec![1.0_f32; 4097]);
    assert_eq!(message(none.unwrap_err()), "filter length 0 must lie in 1..=4096");
    assert!(dynamic::Taps::try_new(&many[1..]).is_ok());
    assert!(dynamic::Taps::try_new(&many).is_err());
    for (count, is_good) in [(0, false), (1, true), (16_384, true), (16_385, false)] {
        assert_eq!(dynamic::MovingWindow::try_new(1.0_f32, count).is_ok(), is_good, "{count}");
    }
    for (neurons, is_good) in [(0, false), (2, false), (3, true), (1024, true), (1025, false)] {
        assert_eq!(AnyPosition::try_linear(neurons, &(0.0..=1.0)).is_ok(), is_good);
        assert_eq!(AnySlots::try_new(neurons, 2, &(0.0..=1.0), 1.5).is_ok(), is_good);
        let centres: Vec<f32> = (0..neurons).map(|centre| centre as f32).collect();
        assert_eq!(AnyPosition::try_new(&centres).is_ok(), is_good);
    }
    for (slots, is_good) in [(0, false), (1, false), (2, true), (256, true), (257, false)] {
        assert_eq!(AnySlots::try_new(15, slots, &(0.0..=1.0), 1.5).is_ok(), is_good);
    }
}
