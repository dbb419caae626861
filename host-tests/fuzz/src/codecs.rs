//! Codecs: arbitrary parameters and signals, against the independent reference, and against themselves when cut.

use catalogue::run::{Asked, Calibrated, Event, Known, SampleType};
use fixed::types::{I8F8, I16F16};
use host_tests::compare::{
    Wire, assert_step_spikes, check_position, check_rate, check_step_decoder, encode, finite,
    reals, run, signs_of,
};
use host_tests::reference::{
    ben_multiplicative, ben_subtractive, ben_toolbox, even_centres, hough, moving_window, nearest,
    nearest_even, step_forward, temporal_contrast, threshold_hough,
};
use spikewire::population::{Gaussian, Position};
use spikewire::rate::{Bsa, BsaToolbox, Hough, Taps, ThresholdHough};
use spikewire::temporal::{MovingWindow, StepForward, TemporalContrast};
use spikewire::{Sample, Scheme};

use crate::script::Script;

/// Longest signals, in samples.
const LONGEST: usize = 200;

/// A scheme in a sample type, both chosen by the first byte; every spike and every decoded bit is the reference's, and
/// parameters that make no sense are refused.
pub fn reference(bytes: &[u8]) {
    let mut script = Script::new(bytes);
    let scheme = script.below(9);
    match script.below(4) {
        0 => in_type::<f32>(scheme, &mut script),
        1 => in_type::<i16>(scheme, &mut script),
        2 => in_type::<I8F8>(scheme, &mut script),
        _ => in_type::<I16F16>(scheme, &mut script),
    }
}

fn signal<S: Sample>(script: &mut Script) -> Vec<S> {
    let mut samples = Vec::new();
    while !script.is_over() && samples.len() < LONGEST {
        samples.push(script.sample());
    }
    samples
}

fn in_type<S: Wire>(scheme: usize, script: &mut Script) {
    let parameters: [S; 2] = [script.sample(), script.sample()];
    match scheme {
        0 => forward(parameters, &signal(script)),
        1 => contrast(parameters, &signal(script)),
        2 => {
            window::<S, 1>(parameters, &signal(script));
        }
        3 => window::<S, 5>(parameters, &signal(script)),
        4 => filters::<S, 3>(parameters, script),
        5 => filters::<S, 8>(parameters, script),
        6 => own_centres::<S>(script),
        7 => even::<S, 5>(parameters, &signal(script)),
        _ => even::<S, 20>(parameters, &signal(script)),
    }
}

fn forward<S: Wire>([threshold, primed]: [S; 2], x: &[S]) {
    let Ok(scheme) = StepForward::try_new(threshold) else {
        let number = threshold.to_f64();
        assert!(!(number > 0.0 && number <= 1e31), "{number} is a threshold");
        return;
    };
    let recording = finite(x);
    let expected = step_forward(&recording.accepted, threshold.real(), None);
    let unprimed = encode(&scheme, x);
    assert_step_spikes(&unprimed, &recording, &expected);
    if !primed.to_f64().is_finite() {
        return;
    }
    check_step_decoder(&scheme, &signs_of(&unprimed.outputs), threshold, primed);
    let mut encoder = scheme.encoder();
    encoder.prime(&[primed]);
    let expected = step_forward(&recording.accepted, threshold.real(), Some(primed.real()));
    assert_step_spikes(&run(&encoder, x), &recording, &expected);
}

fn contrast<S: Wire>([threshold, step]: [S; 2], x: &[S]) {
    let Ok(scheme) = TemporalContrast::try_new(threshold) else { return };
    let Ok(scheme) = scheme.try_with_step(step) else { return };
    let recording = finite(x);
    let expected = temporal_contrast(&recording.accepted, threshold.real(), None);
    let unprimed = encode(&scheme, x);
    assert_step_spikes(&unprimed, &recording, &expected);
    check_step_decoder(&scheme, &signs_of(&unprimed.outputs), step, S::default());
}

fn window<S: Wire, const N: usize>([threshold, _]: [S; 2], x: &[S]) {
    let Ok(scheme) = MovingWindow::<S, N>::try_new(threshold) else { return };
    let recording = finite(x);
    let expected = moving_window(&recording.accepted, N, threshold.real(), None);
    let unprimed = encode(&scheme, x);
    assert_step_spikes(&unprimed, &recording, &expected);
    check_step_decoder(&scheme, &signs_of(&unprimed.outputs), threshold, threshold);
}

fn filters<S: Wire, const F: usize>([threshold, shift]: [S; 2], script: &mut Script) {
    let ratio = script.float();
    let taps: [S; F] = std::array::from_fn(|_| script.sample());
    let x = signal(script);
    let Ok(taps) = Taps::try_new(taps) else { return };
    let h = reals(taps.as_array());
    if let Ok(scheme) = Hough::new(taps).try_with_shift(shift) {
        check_rate(&scheme, &x, &taps, shift, |r, shift, finish| hough(r, &h, shift, finish));
    }
    let scheme = ThresholdHough::try_new(taps, threshold);
    if let Ok(scheme) = scheme.and_then(|scheme| scheme.try_with_shift(shift)) {
        check_rate(&scheme, &x, &taps, shift, |r, shift, finish| {
            threshold_hough(r, &h, shift, threshold.real(), finish)
        });
    }
    let scheme = Bsa::try_subtractive(taps, threshold);
    if let Ok(scheme) = scheme.and_then(|scheme| scheme.try_with_shift(shift)) {
        check_rate(&scheme, &x, &taps, shift, |r, shift, finish| {
            ben_subtractive(r, &h, shift, threshold.real(), finish)
        });
    }
    let scheme = Bsa::try_multiplicative(taps, ratio);
    if let Ok(scheme) = scheme.and_then(|scheme| scheme.try_with_shift(shift)) {
        check_rate(&scheme, &x, &taps, shift, |r, shift, finish| {
            ben_multiplicative(r, &h, shift, S::ratio(ratio), finish)
        });
    }
    let scheme = BsaToolbox::try_new(taps, ratio);
    if let Ok(scheme) = scheme.and_then(|scheme| scheme.try_with_shift(shift)) {
        check_rate(&scheme, &x, &taps, shift, |r, shift, finish| {
            ben_toolbox(r, &h, shift, S::ratio(ratio), finish)
        });
    }
}

fn own_centres<S: Wire>(script: &mut Script) {
    let centres: [S; 5] = std::array::from_fn(|_| script.sample());
    let x = signal(script);
    let Ok(scheme) = Position::try_new(centres) else { return };
    let centres = reals(&centres);
    check_position(&scheme, &x, &centres, |x| nearest(x, &centres));
}

fn even<S: Wire, const M: usize>([min, max]: [S; 2], x: &[S]) {
    let (low, high) = (min.real(), max.real());
    let nearest_even = |x: &[S::Real]| nearest_even(x, low, high, M);
    let Ok(scheme) = Position::<S, M>::try_linear(min..=max) else { return };
    let values = even_centres(low.into(), high.into(), M);
    let values: Vec<_> = values.into_iter().map(|value| S::nearest(value).real()).collect();
    check_position(&scheme, x, &values, nearest_even);
    if let Ok(scheme) = Gaussian::<S, M>::try_linear(min..=max) {
        let run = encode(&scheme, x);
        assert_eq!(run.outputs, encode(&scheme, x).outputs);
    }
}

/// Every scheme of the catalogue, with parameters from text: it is refused, or codes any signal, cut anywhere alike, and
/// decodes its own spikes to as many values.
pub fn catalogue(bytes: &[u8]) {
    const SAMPLES: [SampleType; 4] = [
        SampleType::F32,
        SampleType::Fixed16 { fraction: 8 },
        SampleType::Fixed16 { fraction: 0 },
        SampleType::Fixed32 { fraction: 16 },
    ];
    let mut script = Script::new(bytes);
    let scheme = catalogue::ALL[script.below(catalogue::ALL.len())];
    let sample = SAMPLES[script.below(SAMPLES.len())];
    let cut = 1 + script.below(40);
    let mut asked = Asked::default();
    asked.paper = script.below(4) > 0;
    for parameter in scheme.info().parameters {
        let length = match script.below(6) {
            0 => script.below(12),
            _ => continue,
        };
        let text: Vec<u8> = (0..length).map(|_| b"0123456789.,-e: "[script.below(16)]).collect();
        // Large sizes take memory and time, and nothing else.
        let text = String::from_utf8(text).expect("ASCII");
        if let Ok(value) = parameter.read(&text)
            && value.number().is_none_or(|number| number.abs() < 300.0)
        {
            asked.set(parameter.name, value);
        }
    }
    let mut signal: Vec<f64> = Vec::new();
    while !script.is_over() && signal.len() < LONGEST {
        signal.push(f64::from(script.float()).clamp(-1e30, 1e30));
    }
    signal.retain(|value| value.is_finite());
    let mut calibrated = Calibrated::new(sample);
    calibrated.observe(&signal);
    let known = Known { calibrated: Some(&calibrated), first: &signal, can_calibrate: true };
    let Ok(settings) = scheme.resolve(sample, &asked, &known) else { return };
    if scheme.shape(&settings).is_ok_and(|shape| shape.neurons * shape.slots > 40_000) {
        return;
    }
    let coded = |pieces: usize| -> Option<Vec<Event>> {
        let mut codec = scheme.codec(&settings).ok()?;
        let mut events = Vec::new();
        for piece in signal.chunks(pieces) {
            codec.encode(piece, &mut events);
        }
        codec.finish(&mut events);
        Some(events)
    };
    let Some(whole) = coded(signal.len().max(1)) else { return };
    assert_eq!(Some(&whole), coded(cut).as_ref(), "{}, cut into {cut}", scheme.info().name);
    let mut decoder = scheme.codec(&settings).expect("it was built before");
    let mut values = Vec::new();
    decoder.decode(signal.len(), &whole, &mut values).expect("an encoder's own events");
    assert_eq!(values.len(), signal.len(), "{}", scheme.info().name);
    assert!(values.iter().all(|value| !value.is_nan()), "{}", scheme.info().name);
}
