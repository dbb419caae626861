//! States that are written in flight and read back: every code and value after that is what it is without.

use std::fmt::Debug;

use catalogue::{Channel, Flight, State, Storable};
use fixed::types::{I8F8, I16F16};
use host_tests::flight;
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg32;
use spikewire::rate::{Average, BsaToolbox, Hough, IntegrateAndFire, Taps, Window};
use spikewire::temporal::{MovingWindow, StepForward};
use spikewire::{Code, ConfigError, NeuronSpike, Output, Recovery, Sample, Scheme, Start, dynamic};

/// Roll rate in flight, with a sample that is not finite where the type has such.
fn samples<S: Sample>() -> Vec<S> {
    // Counts of an inertial sensor.
    let unit = if S::KIND == i16::KIND { 1000.0 } else { 1.0 };
    let mut samples: Vec<S> = flight::flown(0, unit).into_iter().step_by(3).collect();
    samples[70] = S::from_f64(f64::NAN);
    samples
}

fn write(state: &impl State) -> Vec<u8> {
    postcard::to_allocvec(state).unwrap()
}

fn read<T: State>(bytes: &[u8]) -> T {
    let (state, rest) = postcard::take_from_bytes(bytes).unwrap();
    assert!(rest.is_empty());
    state
}

fn firings(code: impl Code) -> Vec<NeuronSpike> {
    code.firings().collect()
}

/// Codes the samples in pieces, and before each goes on from the states as they were, and from what was read back.
pub(crate) fn goes_on<P: Storable>(
    scheme: &P,
    mut encoder: P::EncoderState,
    samples: &[P::Sample],
) {
    let mut decoder = scheme.decoder_state();
    let mut rest = samples;
    for length in [0, 1, 2, 10, 57, 1, 300, 500, usize::MAX] {
        let (piece, after) = rest.split_at(length.min(rest.len()));
        rest = after;
        let mut again: P::EncoderState = read(&write(&encoder));
        let mut decoder_again: P::DecoderState = read(&write(&decoder));
        assert!(scheme.fits(&again) && scheme.fits_decoder(&decoder_again));
        let mut compare = |one: Option<P::Code>, other: Option<P::Code>| {
            assert_eq!(one.map(firings), other.map(firings));
            let value = one.map(|code| scheme.decode(&mut decoder, code).to_bits32());
            assert_eq!(
                value,
                other.map(|code| scheme.decode(&mut decoder_again, code).to_bits32())
            );
            let held = scheme.held(&decoder).map(P::Sample::to_bits32);
            assert!(held.is_none() || value.is_none() || held == value);
            for firing in one.map(firings).into_iter().flatten() {
                assert!(usize::from(firing.neuron) < scheme.neurons());
                assert!(usize::from(firing.slot) < scheme.slots());
            }
        };
        for &sample in piece {
            let code = scheme.encode(&mut encoder, sample).code();
            compare(code, scheme.encode(&mut again, sample).code());
        }
        if after.is_empty() {
            for _ in 0..=scheme.latency() {
                compare(scheme.finish_next(&mut encoder), scheme.finish_next(&mut again));
            }
        }
        assert_eq!(P::rejected(&encoder), P::rejected(&again));
        assert_eq!(write(&encoder), write(&again));
        assert_eq!(write(&decoder), write(&decoder_again));
    }
    assert!(rest.is_empty());
    let not_finite = samples.iter().filter(|sample| !sample.to_f64().is_finite()).count();
    assert_eq!(P::rejected(&encoder) as usize, not_finite);
    let holds = !matches!(P::RECOVERY, Recovery::Samples(_) | Recovery::Fading(_));
    assert!(!holds || scheme.held(&decoder).is_some());
    scheme.resync(&mut decoder, samples[0]);
    let held = scheme.held(&decoder).map(P::Sample::to_bits32);
    assert!(held.is_none_or(|held| held == samples[0].to_bits32()));
}

/// Goes on from states of which some bits, or all, are not what was written; it must end, and tells how many were read.
fn survives<P: Storable>(scheme: &P, mut encoder: P::EncoderState, samples: &[P::Sample]) -> usize {
    let mut decoder = scheme.decoder_state();
    for &sample in &samples[..50] {
        if let Some(code) = scheme.encode(&mut encoder, sample).code() {
            scheme.decode(&mut decoder, code);
        }
    }
    let (encoder, decoder) = (write(&encoder), write(&decoder));
    for short in [&encoder, &decoder].map(|bytes| &bytes[..bytes.len() - 1]) {
        assert!(postcard::from_bytes::<(P::EncoderState, P::DecoderState)>(short).is_err());
    }
    let mut random = Pcg32::seed_from_u64(9);
    let mut damage = |bytes: &[u8], times: usize| -> Vec<u8> {
        let mut bytes = bytes.to_vec();
        for _ in 0..times {
            let at = random.next_u32() as usize % bytes.len();
            bytes[at] ^= random.next_u32() as u8;
        }
        bytes
    };
    let mut read = 0;
    for round in 0..40 {
        let times = if round < 20 { 1 } else { 1000 };
        if let Ok(mut state) = postcard::from_bytes::<P::EncoderState>(&damage(&encoder, times)) {
            read += 1;
            let (one_by_one, slice) = samples[..200].split_at(50);
            let mut outputs: Vec<P::Output> =
                one_by_one.iter().map(|&sample| scheme.encode(&mut state, sample)).collect();
            outputs.resize(slice.len(), outputs[0]);
            scheme.encode_slice(&mut state, slice, &mut outputs);
            let _ = (scheme.keyframe(&state), scheme.fits(&state), P::rejected(&state));
            while scheme.finish_next(&mut state).is_some() {}
            scheme.prime(&mut state, samples);
        }
        if let Ok(mut state) = postcard::from_bytes::<P::DecoderState>(&damage(&decoder, times)) {
            read += 1;
            let mut encoder = postcard::from_bytes(&encoder).unwrap();
            for &sample in &samples[50..200] {
                if let Some(code) = scheme.encode(&mut encoder, sample).code() {
                    scheme.decode(&mut state, code);
                }
            }
            let _ = (scheme.held(&state), scheme.fits_decoder(&state));
            scheme.resync(&mut state, samples[0]);
        }
    }
    read
}

/// Takes every scheme through both.
struct Reboots<S> {
    samples: Vec<S>,
    schemes: usize,
}

impl<S: Sample> Flight for Reboots<S> {
    type Sample = S;
    type Error = ConfigError;

    fn visit<P: Storable<Sample = S>>(
        &mut self,
        name: &'static str,
        _: &'static str,
        scheme: &P,
        start: P::EncoderState,
    ) -> Result<(), ConfigError> {
        let fresh = write(&start);
        let first = scheme.encode(&mut read(&fresh), self.samples[0]);
        let taken = scheme.encode_slice(&mut read(&fresh), &self.samples[..9], &mut [first; 5]);
        assert_eq!(taken, 5, "{name}");
        goes_on(scheme, start, &self.samples);
        assert!(survives(scheme, read(&fresh), &self.samples) > 20, "{name}");
        self.schemes += 1;
        Ok(())
    }
}

fn every_scheme<S: Sample>() {
    let samples = samples::<S>();
    let channel = Channel::new(0, flight::calibrated(&samples));
    let mut visitor = Reboots { samples, schemes: 0 };
    catalogue::fly(&channel, &mut visitor).unwrap();
    assert!(visitor.schemes >= catalogue::INFO.len());
}

#[test]
fn every_scheme_goes_on_in_f32() {
    every_scheme::<f32>();
}

#[test]
fn every_scheme_goes_on_in_i16() {
    every_scheme::<i16>();
}

#[test]
fn every_scheme_goes_on_in_q8_8() {
    every_scheme::<I8F8>();
}

#[test]
fn every_scheme_goes_on_in_q16_16() {
    every_scheme::<I16F16>();
}

/// Of the schemes whose shape is chosen at run time those whose states have a length.
fn every_length<S: Sample>() {
    let samples = samples::<S>();
    let one = if S::KIND == i16::KIND { 1000.0 } else { 1.0 };
    let taps = [0.25, 0.5, 1.0, 0.5, 0.25].map(|tap| S::from_f64(tap * one));
    let taps = |length: usize| dynamic::Taps::try_new(&taps[..length]).unwrap();
    let hough = |length| dynamic::Hough::try_new(taps(length)).unwrap();
    let toolbox = |length| dynamic::BsaToolbox::try_new(taps(length), 1.1).unwrap();
    let window = |count| dynamic::MovingWindow::try_new(S::from_f64(0.25 * one), count).unwrap();

    goes_on(&hough(5), hough(5).state(), &samples);
    survives(&hough(5), hough(5).state(), &samples);
    assert!(!hough(5).fits(&hough(4).state()) && !hough(4).fits(&hough(5).state()));
    assert!(!hough(5).fits_decoder(&hough(4).decoder_state()));

    goes_on(&toolbox(5), toolbox(5).state(), &samples);
    survives(&toolbox(5), toolbox(5).state(), &samples);
    assert!(!toolbox(5).fits(&toolbox(4).state()));
    assert!(!toolbox(5).fits_decoder(&toolbox(4).decoder_state()));

    let range = S::from_f64(-4.0 * one)..=S::from_f64(4.0 * one);
    let centres: Vec<S> =
        [-4.0, -1.0, 0.0, 2.0, 3.0].map(|centre| S::from_f64(centre * one)).to_vec();
    let position = dynamic::Position::<S>::try_new(&centres).unwrap();
    goes_on(&position, position.state(), &samples);
    let slots = dynamic::Slots::<S>::try_new(7, 32, &range, 1.5).unwrap();
    goes_on(&slots, slots.state(), &samples);
    let ranks = dynamic::RankOrder::<S>::try_new(4, &centres).unwrap();
    goes_on(&ranks, ranks.state(), &samples);
    let fields = dynamic::NonLinearSlots::<S>::try_spaced(32, &centres, 1.5).unwrap();
    goes_on(&fields, fields.state(), &samples);

    goes_on(&window(6), window(6).state(), &samples);
    survives(&window(6), window(6).state(), &samples);
    assert!(!window(6).fits(&window(7).state()));
    let mut beyond = serde_json::to_value(window(6).state()).unwrap();
    beyond["next"] = 6.into();
    assert!(!window(6).fits(&serde_json::from_value(beyond).unwrap()));
}

#[test]
fn a_length_chosen_at_run_time_goes_on_and_is_compared() {
    every_length::<f32>();
    every_length::<i16>();
    every_length::<I8F8>();
    every_length::<I16F16>();
}

fn refused<T: State + Debug>(json: &serde_json::Value) -> String {
    serde_json::from_value::<T>(json.clone()).unwrap_err().to_string()
}

#[test]
fn a_length_that_is_not_the_types_is_refused() {
    type Long = MovingWindow<i16, 40>;
    let state = serde_json::to_value(Long::START).unwrap();
    assert!(serde_json::from_value::<<Long as Scheme>::EncoderState>(state.clone()).is_ok());
    for length in [0, 39, 41] {
        let mut other = state.clone();
        other["ring"] = vec![0; length].into();
        let message = format!("invalid length {length}, expected 40 items");
        assert_eq!(refused::<<Long as Scheme>::EncoderState>(&other), message);
    }
}

#[test]
fn a_position_outside_its_ring_does_not_fit() {
    let scheme = Hough::<f32, 5>::new(Taps::triangular(1.0));
    let fits = |key: &str, value: u16| {
        let mut state = serde_json::to_value(scheme.encoder().state()).unwrap();
        state["cursor"][key] = value.into();
        scheme.fits(&serde_json::from_value(state).unwrap())
    };
    assert!(fits("next", 4) && !fits("next", 5) && !fits("missing", 6));
    let mut decoder = serde_json::to_value(scheme.decoder().state()).unwrap();
    decoder["next"] = 5.into();
    assert!(!scheme.fits_decoder(&serde_json::from_value(decoder).unwrap()));

    let toolbox = BsaToolbox::<f32, 5>::new(Taps::triangular(1.0), 1.1);
    let mut state = serde_json::to_value(toolbox.encoder().state()).unwrap();
    assert!(toolbox.fits(&serde_json::from_value(state.clone()).unwrap()));
    state["registers"]["cursor"]["next"] = 5.into();
    assert!(!toolbox.fits(&serde_json::from_value(state).unwrap()));

    let scheme = MovingWindow::<f32, 6>::new(1.0);
    let mut state = serde_json::to_value(MovingWindow::<f32, 6>::START).unwrap();
    for (next, fits) in [(5, true), (6, false), (0x8005, true), (0x8006, false)] {
        state["next"] = next.into();
        assert_eq!(scheme.fits(&serde_json::from_value(state.clone()).unwrap()), fits, "{next}");
    }
}

/// As few bytes as the numbers need; the first four of a float are its own.
#[test]
fn bytes() {
    let mut encoder = const { &StepForward::new(0.5_f32) }.encoder();
    encoder.encode(1.0);
    assert_eq!(write(encoder.state()), [0, 0, 0x80, 0x3f, 1]);
    assert_eq!(write(&Hough::<f32, 15>::START).len(), 4 * 15 + 4);
    assert_eq!(write(&Hough::<i16, 15>::START).len(), 15 + 4);
    assert_eq!(write(&MovingWindow::<f32, 64>::START).len(), 4 * 64 + 9);
    assert_eq!(write(&IntegrateAndFire::<i16, 4>::START).len(), 2);
    let sigma_delta = |power| spikewire::rate::SigmaDelta::new(0..=255_i16, Average::new(power));
    assert_eq!(write(sigma_delta(4).decoder().state()).len(), 3);
    let window = spikewire::rate::SigmaDelta::new(0..=255_i16, <Window>::new(5));
    assert_eq!(write(window.decoder().state()).len(), 6);
}
