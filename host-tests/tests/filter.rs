//! Filters before a code: the laws bit by bit, the textbook's response, and a filtered scheme end to end.

use crate::common::{
    between, drawn_recordings, flight_channels, flights, hostile_recordings, in_every_type,
};
use crate::states::goes_on;
use fixed::types::{I8F8, I16F16};
use host_tests::compare::{Wire, assert_same_values, encode, whole};
use host_tests::reference::{
    Kind, Precise, coefficients, delay_at_rest, direct_form, filter_floats, filter_integers,
    textbook,
};
use proptest::prelude::*;
use rand_core::Rng;
use rand_pcg::Pcg32;
use spikewire::filter::{Biquad, Filter, Filtered, FirstOrder};
use spikewire::link::{Coding, MAX_FRAME, Reader, Receiver, Session, Transmitter};
use spikewire::rate::{Hough, Taps};
use spikewire::temporal::{MovingWindow, SendOnDelta, StepForward};
use spikewire::{Bank, ConfigError, EventQueue, Overflow, Sample, SampleKind, Scheme, Start, Tick};

const RATE: f32 = 1000.0;
const KINDS: [Kind; 6] = [
    Kind::FirstOrder,
    Kind::LowPass(std::f32::consts::FRAC_1_SQRT_2),
    Kind::LowPass(0.1),
    Kind::LowPass(100.0),
    Kind::Notch(2.0),
    Kind::Notch(100.0),
];
const CORNERS: [f32; 7] = [1.0, 2.5, 10.0, 80.0, 250.0, 400.0, 490.0];

fn every_filter() -> impl Iterator<Item = (Kind, f32)> {
    KINDS.into_iter().flat_map(|kind| CORNERS.map(|corner| (kind, corner)))
}

/// Any of the filters, so that one test takes them all.
#[derive(Clone, Copy, Debug)]
enum Any<S: Sample> {
    First(FirstOrder<S>),
    Second(Biquad<S>),
}

impl<S: Sample> Any<S> {
    fn new(kind: Kind, corner: f32) -> Self {
        match kind {
            Kind::FirstOrder => Self::First(FirstOrder::try_low_pass(corner, RATE).unwrap()),
            Kind::LowPass(q) => Self::Second(Biquad::try_low_pass_with_q(corner, RATE, q).unwrap()),
            Kind::Notch(q) => Self::Second(Biquad::try_notch(corner, RATE, q).unwrap()),
        }
    }

    fn delay(&self) -> f32 {
        match self {
            Self::First(filter) => filter.delay(),
            Self::Second(filter) => filter.delay(),
        }
    }

    /// Filters by samples, and in slices of several lengths in turn with samples. All must agree.
    fn run(&self, samples: &[S]) -> Vec<S> {
        match self {
            Self::First(filter) => run(filter, samples),
            Self::Second(filter) => run(filter, samples),
        }
    }
}

fn run<F: Filter>(filter: &F, samples: &[F::Sample]) -> Vec<F::Sample> {
    let mut state = F::START;
    let expected: Vec<_> = samples.iter().map(|&x| filter.filter(&mut state, x)).collect();
    for length in [samples.len().max(1), 1, 3, 7, 33] {
        let mut state = F::START;
        let mut outputs = Vec::new();
        for (turn, chunk) in samples.chunks(length).enumerate() {
            if turn % 3 == 2 {
                outputs.extend(chunk.iter().map(|&x| filter.filter(&mut state, x)));
                continue;
            }
            // Too much room, or too little, as the shorter slice ends it.
            let mut room = vec![F::Sample::default(); chunk.len() + 1];
            let (first, rest) = chunk.split_at(chunk.len() / 2);
            assert_eq!(
                filter.filter_slice(&mut state, chunk, &mut room[..first.len()]),
                first.len()
            );
            outputs.extend(&room[..first.len()]);
            assert_eq!(filter.filter_slice(&mut state, rest, &mut room), rest.len());
            outputs.extend(&room[..rest.len()]);
        }
        let bits = |list: &[F::Sample]| list.iter().map(|x| x.to_bits32()).collect::<Vec<_>>();
        assert_eq!(bits(&outputs), bits(&expected), "slices of {length}");
    }
    expected
}

/// The law's outputs, as the reference has them.
fn law<S: Wire>(kind: Kind, corner: f32, samples: &[S]) -> Vec<f64> {
    let has_gain = S::KIND == SampleKind::F32;
    let coefficients: [Precise; 3] = coefficients(kind, corner, RATE, has_gain);
    if has_gain {
        let samples: Vec<f32> = samples.iter().map(|&x| x.to_f64() as f32).collect();
        return filter_floats(kind, &coefficients, &samples).into_iter().map(f64::from).collect();
    }
    let bits = 8 * size_of::<S>() as u32;
    let samples: Vec<i64> = samples.iter().copied().map(whole).collect();
    let outputs = filter_integers(kind, &coefficients, bits, &samples);
    outputs.into_iter().map(|output| output as f64).collect()
}

/// Every bit against the law.
fn check<S: Wire>(kind: Kind, corner: f32, samples: &[S]) {
    let outputs = Any::new(kind, corner).run(samples);
    let expected = law(kind, corner, samples);
    if S::KIND == SampleKind::F32 {
        let expected: Vec<f32> = expected.into_iter().map(|x| x as f32).collect();
        let outputs: Vec<f32> = outputs.iter().map(|x| x.to_f64() as f32).collect();
        assert_same_values(&outputs, &expected);
    } else {
        let outputs: Vec<f64> = outputs.into_iter().map(|x| whole(x) as f64).collect();
        assert_eq!(outputs, expected, "{kind:?} {corner}");
    }
}

#[test]
fn cases_by_hand() {
    // A quarter of the rate and q of 1/2: gain and damping are 1, so that two poles lie at 0 and the output is
    // (x + 2 x[i-1] + x[i-2]) / 4.
    let filter = Biquad::<f32>::low_pass_with_q(250.0, RATE, 0.5);
    assert_eq!(run(&filter, &[0.0, 8.0, 0.0, 0.0, 0.0]), [0.0, 2.0, 4.0, 2.0, 0.0]);
    assert_eq!(run(&filter, &[8.0; 3]), [8.0; 3], "steady from the first sample");
    let filter = Biquad::<i16>::low_pass_with_q(250.0, RATE, 0.5);
    assert_eq!(run(&filter, &[0, 8, 0, 0, 0]), [0, 2, 4, 2, 0]);
    assert_eq!(run(&filter, &[0, 1, 1, 0, 0]), [0, 0, 1, 1, 0], "halves upwards");
    // The same poles, and zeros at a quarter of the rate: (x + x[i-2]) / 2.
    let filter = Biquad::<i16>::notch(250.0, RATE, 0.5);
    assert_eq!(run(&filter, &[0, 8, 0, 0, 0]), [0, 4, 0, 4, 0]);
    assert_eq!(run(&filter, &[0, 8, 0, -8, 0, 8])[2..], [0, 0, 0, 0]);
    let filter = Biquad::<I16F16>::low_pass_with_q(250.0, RATE, 0.5);
    let step = [0, 4, 4, 4].map(I16F16::from_bits);
    assert_eq!(run(&filter, &step), [0, 1, 3, 4].map(I16F16::from_bits));
    // A sixth of the rate: a gain of sqrt(5)/2 - 1/2.
    let filter = FirstOrder::<i16>::low_pass(RATE / 6.0, RATE);
    assert_eq!(run(&filter, &[0, 1000, 1000, 1000]), [0, 618, 854, 944]);
}

/// What is not finite passes, and leaves no trace.
#[test]
fn not_finite() {
    let bad = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
    for (kind, corner) in every_filter() {
        let filter = Any::<f32>::new(kind, corner);
        let good: Vec<f32> = (0..40).map(|i| (i as f32).sin()).collect();
        let expected = filter.run(&good);
        let mut faulty: Vec<f32> = bad.to_vec();
        for &sample in &good {
            faulty.push(sample);
            faulty.extend(bad);
        }
        let outputs = filter.run(&faulty);
        let same = |(a, b): (&f32, &f32)| a.is_finite() || a.to_bits() == b.to_bits();
        assert!(faulty.iter().zip(&outputs).all(same), "as they are");
        let finite: Vec<f32> = outputs.into_iter().filter(|x| x.is_finite()).collect();
        assert_eq!(finite, expected, "{kind:?} {corner}");
    }
}

/// A finite sample gives a finite output, whatever came before; and the filter is never stuck.
#[test]
fn floats_that_overflow() {
    let (most, least) = (f32::MAX, f32::MIN);
    for (kind, corner) in every_filter() {
        let filter = Any::<f32>::new(kind, corner);
        for pattern in [[most, least], [most, most], [most, 0.0], [most / 2.0, least / 2.0]] {
            let mut samples = pattern.repeat(40);
            samples.extend([1.0; 400]);
            let outputs = filter.run(&samples);
            assert!(outputs.iter().all(|x| x.is_finite()), "{kind:?} {corner} {pattern:?}");
            check(kind, corner, &samples);
        }
    }
    // One overflow, and the filter starts anew.
    let filter = FirstOrder::<f32>::low_pass(80.0, RATE);
    assert_eq!(run(&filter, &[most, least, least]), [most, least, least]);
}

fn constants_of<S: Wire>() {
    let mut random = Pcg32::new(7, 1);
    let ends = S::ends().map(Into::<f64>::into);
    let span = if S::KIND == SampleKind::F32 { 100.0 } else { ends[1] };
    for (kind, corner) in every_filter() {
        let mut draw = || S::from_f64((f64::from(random.next_u32()) / 2_f64.powi(31) - 1.0) * span);
        let mut samples: Vec<S> = (0..200).map(|_| draw()).collect();
        let constant = draw();
        // As long as the slowest pole takes to forget 40 bits.
        let section = textbook(kind, f64::from(corner) / f64::from(RATE));
        samples.resize(200 + (50.0 / (1.0 - slowest_pole(section))) as usize, constant);
        let filter = Any::<S>::new(kind, corner);
        let last = match &filter {
            Any::First(filter) => last_outputs(filter, &samples),
            Any::Second(filter) => last_outputs(filter, &samples),
        };
        for output in last {
            if S::KIND == SampleKind::F32 {
                // Steps below half of the last place are lost: 1 / (2 damping) of these, or of the gain.
                let near = 2e-4 * constant.to_f64().abs();
                assert!((output.to_f64() - constant.to_f64()).abs() <= near, "{kind:?} {corner}");
            } else {
                assert_eq!(output, constant, "{kind:?} {corner}");
            }
        }
    }
}

/// The larger magnitude of two poles.
fn slowest_pole([.., a1, a2]: [f64; 5]) -> f64 {
    let root = a1 * a1 / 4.0 - a2;
    if root < 0.0 { a2.sqrt() } else { (a1 / 2.0).abs() + root.sqrt() }
}

/// The last 20 outputs.
fn last_outputs<F: Filter>(filter: &F, samples: &[F::Sample]) -> Vec<F::Sample> {
    let mut outputs = vec![F::Sample::default(); samples.len()];
    filter.filter_slice(&mut F::START.clone(), samples, &mut outputs);
    outputs.split_off(samples.len() - 20)
}

/// After any past a constant comes out as it is: in fixed point to the last bit.
#[test]
fn constants() {
    in_every_type!(constants_of);
}

/// Amplitude of a sine of this frequency behind a filter, once the start is forgotten.
fn amplitude<S: Sample>(filter: &Any<S>, frequency: f64, peak: f64, samples: usize) -> f64 {
    let turn = std::f64::consts::TAU * frequency / f64::from(RATE);
    let sine = |i: usize| (turn * i as f64).sin() * peak;
    let input: Vec<S> = (0..2 * samples).map(|i| S::from_f64(sine(i))).collect();
    let output = filter.run(&input);
    // Correlation with both phases over the second half.
    let [mut real, mut imaginary] = [0.0; 2];
    for (i, value) in output.iter().enumerate().skip(samples) {
        real += value.to_f64() * (turn * i as f64).cos();
        imaginary += value.to_f64() * (turn * i as f64).sin();
    }
    2.0 * real.hypot(imaginary) / samples as f64 / peak
}

/// -3 dB at the corner, `q` at the corner of another filter, nothing at the centre of a notch, -3 dB at its sides.
fn response_of<S: Wire>() {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let is_i16 = size_of::<S>() == 2;
    let peak = if S::KIND == SampleKind::F32 { 1.0 } else { S::ends()[1].into() * 0.4 };
    let near = if is_i16 { 1e-3 } else { 1e-4 };
    for corner in [5.0, 40.0, 125.0, 250.0, 375.0] {
        let of =
            |kind, frequency: f64| amplitude(&Any::<S>::new(kind, corner), frequency, peak, 6000);
        let corner = f64::from(corner);
        let butterworth = Kind::LowPass(std::f32::consts::FRAC_1_SQRT_2);
        for (kind, frequency, expected) in [
            (Kind::FirstOrder, corner, half),
            (butterworth, corner, half),
            (Kind::LowPass(0.5), corner, 0.5),
            (Kind::LowPass(2.0), corner, 2.0),
            (Kind::Notch(2.0), corner, 0.0),
            (Kind::Notch(10.0), corner, 0.0),
        ] {
            let seen = of(kind, frequency);
            assert!((seen - expected).abs() < near, "{kind:?} {corner}: {seen}");
        }
        // Between the corner and half the rate, as the textbook has it.
        for kind in [Kind::FirstOrder, butterworth, Kind::Notch(2.0)] {
            for frequency in [corner / 5.0, corner / 2.0, f64::midpoint(corner, 500.0)] {
                let [seen, expected] = [of(kind, frequency), response(kind, corner, frequency)];
                assert!((seen - expected).abs() < near, "{kind:?} {corner} {frequency}: {seen}");
            }
        }
    }
}

/// The gain of the textbook's filter.
fn response(kind: Kind, corner: f64, frequency: f64) -> f64 {
    let [b0, b1, b2, a1, a2] = textbook(kind, corner / f64::from(RATE));
    let turn = std::f64::consts::TAU * frequency / f64::from(RATE);
    let at = |c: [f64; 3]| {
        let real = c[0] + c[1] * turn.cos() + c[2] * (2.0 * turn).cos();
        let imaginary = c[1] * turn.sin() + c[2] * (2.0 * turn).sin();
        real.hypot(imaginary)
    };
    at([b0, b1, b2]) / at([1.0, a1, a2])
}

#[test]
fn frequency_response() {
    response_of::<f32>();
    response_of::<i16>();
    response_of::<I16F16>();
}

/// A ramp comes out as late as the delay says.
#[test]
fn delays() {
    for (kind, corner) in every_filter() {
        let expected = delay_at_rest(textbook(kind, f64::from(corner) / f64::from(RATE)));
        for delay in [
            Any::<f32>::new(kind, corner).delay(),
            Any::<i16>::new(kind, corner).delay(),
            Any::<I16F16>::new(kind, corner).delay(),
        ] {
            let near = 1e-5_f64.max(expected.abs() * 1e-4);
            assert!((f64::from(delay) - expected).abs() < near, "{kind:?} {corner}: {delay}");
        }
    }
    for kind in [Kind::FirstOrder, Kind::LowPass(0.7), Kind::Notch(1.0)] {
        let filter = Any::<I16F16>::new(kind, 40.0);
        let ramp: Vec<_> = (0..2000).map(|i| I16F16::from_num(f64::from(i) / 8.0)).collect();
        let late = (ramp[1999] - filter.run(&ramp)[1999]).to_num::<f64>() * 8.0;
        assert!((late - f64::from(filter.delay())).abs() < 1e-3, "{kind:?}: {late}");
    }
    // 40 Hz at 500 samples a second.
    let [first, second] = [
        FirstOrder::<f32>::low_pass(40.0, 500.0).delay(),
        Biquad::<f32>::low_pass(40.0, 500.0).delay(),
    ];
    assert_eq!([first, second].map(|delay| (delay * 20.0).round()), [31.0, 55.0]); // tenths of ms
}

/// Recorded flights: each bit as the law says, each value beside the textbook's.
fn check_flown<S: Wire>(samples: &[S]) {
    for (kind, corner) in [
        (Kind::FirstOrder, 40.0),
        (Kind::LowPass(std::f32::consts::FRAC_1_SQRT_2), 40.0),
        (Kind::Notch(3.0), 120.0),
    ] {
        check(kind, corner, samples);
        let filter = textbook(kind, f64::from(corner) / f64::from(RATE));
        let doubles: Vec<f64> = samples.iter().map(|x| x.to_f64()).collect();
        let largest = doubles.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
        // Half of a last place, and a little for coefficients of 29 fraction bits.
        let is_float = S::KIND == SampleKind::F32;
        let near = if is_float { 2e-6 * largest } else { 0.6 * S::from_bits32(1).to_f64() };
        let outputs = Any::<S>::new(kind, corner).run(samples);
        for (output, exact) in outputs.iter().zip(direct_form(filter, &doubles)) {
            assert!((output.to_f64() - exact).abs() <= near, "{kind:?}: {output:?} {exact}");
        }
    }
}

flights!(S: Wire, |x, _unit| check_flown(&x[..x.len().min(700)]));

#[test]
fn hostile() {
    for samples in hostile_recordings() {
        for (kind, corner) in every_filter().step_by(3) {
            check(kind, corner, &samples);
        }
    }
}

/// Ends of the type, at every pace: sums must not wrap, and outputs saturate.
fn ends_of<S: Wire>() {
    let [least, most] = S::ends().map(|end| S::from_f64(end.into()));
    for (kind, corner) in every_filter() {
        for pace in [1, 2, 3, 5, 50, 500] {
            let samples: Vec<S> =
                (0..1500).map(|i| if i / pace % 2 == 0 { most } else { least }).collect();
            check(kind, corner, &samples);
        }
    }
}

#[test]
fn ends() {
    ends_of::<i16>();
    ends_of::<I8F8>();
    ends_of::<I16F16>();
}

/// At its own corner a sharp filter rises beyond the type: it stays at the ends, and comes back.
#[test]
fn saturation() {
    let filter = Biquad::<i16>::low_pass_with_q(250.0, RATE, 100.0);
    let mut samples = [0, i16::MAX, 0, i16::MIN].repeat(100);
    samples.extend([100; 6000]);
    let outputs = run(&filter, &samples);
    assert!(outputs.contains(&i16::MAX) && outputs.contains(&i16::MIN));
    assert_eq!(outputs[6300..], [100; 100]);
}

/// Poles stay within the unit circle over all corners, as rounded: an impulse fades.
#[test]
fn stability() {
    for q in [0.1, 0.5, 10.0, 100.0] {
        for step in 0..200 {
            // Denser at both ends.
            let place = f64::from(step) / 199.0;
            let corner = (0.001 + 0.489 * (3.0 - 2.0 * place) * place * place) * f64::from(RATE);
            let corner = (corner as f32).clamp(1.0, 490.0);
            for kind in [Kind::LowPass(q), Kind::Notch(q)] {
                let pole = slowest_pole(textbook(kind, f64::from(corner) / f64::from(RATE)));
                let mut samples = vec![0.0_f32; (20.0 / (1.0 - pole)) as usize + 20];
                samples[1] = 1.0;
                let Any::Second(filter) = Any::<f32>::new(kind, corner) else { unreachable!() };
                let last = last_outputs(&filter, &samples);
                assert!(last.iter().all(|x| x.abs() < 1e-6), "{kind:?} {corner}: {last:?}");
            }
        }
    }
}

fn kinds() -> impl Strategy<Value = Kind> {
    let q = || between(0.1, 100.0).prop_map(|q| q.clamp(0.1, 100.0));
    prop_oneof![
        Just(Kind::FirstOrder),
        q().prop_map(Kind::LowPass),
        q().prop_map(Kind::Notch),
        between(0.3, 3.0).prop_map(Kind::LowPass),
        between(0.3, 10.0).prop_map(Kind::Notch),
    ]
}

drawn_recordings!(S: Wire, 128, (x in S::recordings(), kind in kinds(), corner in between(1.0, 490.0)) => check(kind, corner, &x));

/// The codes of a filtered scheme are those of the scheme on filtered samples.
fn filtered_of<S: Wire, P>(scheme: P, samples: &[S])
where
    P: Start<Sample = S, Output: std::fmt::Debug + PartialEq, Code: std::fmt::Debug + PartialEq>,
{
    let (notch, low_pass) = (Biquad::notch(120.0, RATE, 3.0), Biquad::low_pass(60.0, RATE));
    let expected = encode(&scheme, &run(&low_pass, &run(&notch, samples)));
    let filtered = notch.before(low_pass.before(scheme));
    assert_eq!(encode(&filtered, samples), expected);
    assert_eq!((filtered.latency(), filtered.neurons()), (P::LATENCY, filtered.scheme().neurons()));
    assert_eq!(filtered.holds_keyframes(), filtered.scheme().holds_keyframes());
}

#[test]
fn filtered_schemes() {
    for mut samples in flight_channels().into_iter().step_by(4) {
        samples.truncate(1000);
        filtered_of(StepForward::new(0.05_f32), &samples);
        filtered_of(Hough::<f32, 7>::new(Taps::triangular(0.2)).with_shift(-2.0), &samples);
        samples[300] = f32::NAN;
        filtered_of(SendOnDelta::<f32, 4>::new(0.05), &samples);
        filtered_of(MovingWindow::<f32, 6>::new(0.05), &samples);
        let counts: Vec<i16> = samples.iter().map(|&x| (x * 1000.0) as i16).collect();
        filtered_of(SendOnDelta::<i16, 16>::new(30), &counts);
    }
    for samples in hostile_recordings() {
        filtered_of(StepForward::new(0.5_f32), &samples);
    }
}

/// A past goes through the filter, also one longer than what the scheme gets.
#[test]
fn priming() {
    let (filter, scheme) = (Biquad::low_pass(40.0, RATE), StepForward::new(0.1_f32));
    let filtered = filter.before(scheme);
    for length in [1, 5, 64, 65, 200] {
        let past: Vec<f32> = (0..length).map(|i| (i as f32 * 0.4).sin()).collect();
        let mut primed = filtered.encoder();
        for i in 0..9 {
            primed.encode(i as f32); // forgotten
        }
        primed.prime(&past);
        assert_eq!(primed.keyframe(), run(&filter, &past).last().copied());
        let samples: Vec<f32> = (length..length + 50).map(|i| (i as f32 * 0.4).sin()).collect();
        let together = run(&filter, &[past.clone(), samples.clone()].concat());
        let mut plain = scheme.encoder();
        plain.prime(&together[..past.len()]);
        for (&sample, &expected) in samples.iter().zip(&together[past.len()..]) {
            assert_eq!(primed.encode(sample), plain.encode(expected));
        }
    }
    let window = filter.before(MovingWindow::<f32, 4>::new(0.1));
    let mut primed = window.encoder();
    primed.prime(&[1.0, 1.0, 1.0, 1.0]);
    assert_eq!(primed.keyframe(), Some(1.0));

    // A past that ends in what is not finite is rejected, and the filter stays as it was.
    let mut encoder = filtered.encoder();
    encoder.prime(&[]);
    encoder.encode(1.0);
    encoder.prime(&[5.0, f32::NAN]);
    assert_eq!((encoder.rejected(), encoder.keyframe()), (1, Some(1.0)));
    assert!(!encoder.encode(1.0).is_fired());
}

/// Two channels, from bank to receiver over queue and link.
#[test]
fn end_to_end() {
    static ROLL: Filtered<Biquad<i16>, SendOnDelta<i16, 16>> =
        Biquad::low_pass(40.0, 500.0).before(SendOnDelta::new(98));
    static QUEUE: EventQueue<64> = EventQueue::new(Overflow::DropOldest);
    let mut bank = Bank::<_, 2>::new(&ROLL);
    let mut link = Transmitter::new(Coding::for_channels(2, 2_000), Session::counted(1));
    let (mut reader, mut receiver) = (Reader::<MAX_FRAME>::new(), Receiver::<_, 2>::new(&ROLL));
    let mut alone = Receiver::<_, 2>::new(ROLL.scheme());
    let mut queue = QUEUE.consumer().unwrap();
    let mut spikes = [0; 2]; // filtered, and without
    let mut plain = [ROLL.scheme().encoder(); 2];
    let mut last = [[0.0_f64; 2]; 2];
    for i in 0..2000_u32 {
        let tick = Tick::from_micros(u64::from(i) * 2_000);
        // Roll and pitch at 1 Hz, and rotors at 220 Hz.
        let [slow, fast] = [1.0, 220.0].map(|hz| std::f64::consts::TAU * hz / 500.0 * f64::from(i));
        let wanted = [2000.0 * slow.sin(), 1500.0 * slow.cos()];
        let samples = wanted.map(|value| (value + 500.0 * fast.sin()) as i16);
        bank.encode_into(tick, samples, &QUEUE);
        if i % 20 == 0 {
            bank.keyframe_into(tick, &QUEUE);
        }
        for (encoder, sample) in plain.iter_mut().zip(samples) {
            spikes[1] += u32::from(encoder.encode(sample).count().unsigned_abs());
        }
        let mut buffer = [0; MAX_FRAME];
        while let Some(mut bytes) = link.next_frame(&mut queue, &mut buffer).unwrap() {
            while let Some(received) = reader.next_frame(&mut bytes) {
                receiver.apply(&received, |_, _, _| spikes[0] += 1);
                alone.apply(&received, |_, _, _| ());
            }
        }
        for channel in 0..2 {
            let exact = receiver.exact(channel);
            assert_eq!(exact, bank.keyframe(channel.into()));
            assert_eq!(exact, alone.exact(channel), "the filter is the sender's alone");
            // As late as the filter, which is less than two samples at 1 Hz from the last one.
            let away = (f64::from(exact.unwrap()) - last[0][usize::from(channel)]).abs();
            assert!(i < 50 || away < 2.0 * 98.0 + 40.0, "{i}: {away}");
        }
        last = [last[1], wanted];
    }
    assert_eq!((QUEUE.lost(), bank.rejected()), (0, 0));
    assert!(spikes[0] * 10 < spikes[1], "{spikes:?}");
}

/// A scheme that passes over what is not finite, and whose receiver counts samples, is told of each.
#[test]
fn breaks() {
    let scheme: Filtered<FirstOrder<f32>, Hough<f32, 3>> =
        FirstOrder::low_pass(40.0, 500.0).before(Hough::new(Taps::triangular(1.0)));
    let queue = EventQueue::<64>::new(Overflow::Refuse);
    let mut bank = Bank::<_, 1>::new(&scheme);
    for (i, sample) in [f32::MAX, f32::MIN, f32::NAN, f32::MAX, 1.0].into_iter().enumerate() {
        bank.encode_into(Tick::from_micros(i as u64), [sample], &queue);
    }
    let mut consumer = queue.consumer().unwrap();
    let items: Vec<_> = std::iter::from_fn(|| spikewire::Source::take(&mut consumer))
        .map(|taken| taken.item)
        .collect();
    let breaks = items.iter().filter(|item| matches!(item, spikewire::Item::Break(_)));
    assert_eq!((breaks.count(), bank.rejected()), (1, 1));
}

fn refused<T>(result: Result<T, ConfigError>) -> String {
    result.err().expect("it must be refused").to_string()
}

#[test]
fn bad_parameters() {
    for bad in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        let says = |name| format!("{name} {bad} must be above 0 and finite");
        assert_eq!(refused(Biquad::<f32>::try_low_pass(bad, RATE)), says("corner"));
        assert_eq!(refused(Biquad::<i16>::try_low_pass(10.0, bad)), says("rate"));
        assert_eq!(refused(FirstOrder::<i16>::try_low_pass(bad, RATE)), says("corner"));
        assert_eq!(refused(Biquad::<f32>::try_notch(bad, RATE, 1.0)), says("centre"));
    }
    for corner in [490.1, 500.0, 0.999, 1e-45] {
        let says = |name| format!("{name} {corner} must lie in 1..=490");
        assert_eq!(refused(Biquad::<f32>::try_low_pass(corner, RATE)), says("corner"));
        assert_eq!(refused(FirstOrder::<f32>::try_low_pass(corner, RATE)), says("corner"));
        assert_eq!(refused(Biquad::<f32>::try_notch(corner, RATE, 1.0)), says("centre"));
    }
    for q in [0.099, 100.1, -1.0, f32::NAN] {
        let says = format!("q {q} must lie in 0.1..=100");
        assert_eq!(refused(Biquad::<f32>::try_low_pass_with_q(10.0, RATE, q)), says);
        assert_eq!(refused(Biquad::<f32>::try_notch(10.0, RATE, q)), says);
    }
    assert!(Biquad::<f32>::try_low_pass(1e-45, 1e-45).is_err());
    assert!(Biquad::<f32>::try_low_pass(1e38, 3e38).is_ok());
}

/// As their documentation says.
#[test]
fn sizes() {
    fn of<F: Filter>() -> [usize; 2] {
        [size_of::<F>(), size_of::<F::State>()]
    }
    assert_eq!([of::<FirstOrder<f32>>(), of::<Biquad<f32>>()], [[8, 4], [16, 8]]);
    assert_eq!([of::<FirstOrder<i16>>(), of::<Biquad<i16>>()], [[8, 8], [16, 16]]);
    assert_eq!([of::<FirstOrder<I16F16>>(), of::<Biquad<I16F16>>()], [[8, 8], [16, 24]]);
}

/// States are written in flight and read back.
#[test]
fn states() {
    fn check<S: Sample>(threshold: S, unit: f64) {
        let scheme = Biquad::low_pass(40.0, RATE).before(StepForward::try_new(threshold).unwrap());
        goes_on(&scheme, *scheme.encoder().state(), &host_tests::flight::flown(0, unit));
    }
    check(0.05_f32, 1.0);
    check(50_i16, 1000.0);
    check(I16F16::from_num(0.05), 1.0);
}
