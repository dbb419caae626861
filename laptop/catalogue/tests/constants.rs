//! Rust constants of schemes: what is written compiles, and gives the same spikes as the settings.

#![cfg(feature = "run")]
#![allow(clippy::unreadable_literal)] // as they are written

use std::collections::BTreeSet;

use catalogue::run::{Asked, Calibrated, Event, Known, SampleType};
use spikewire::{Code, NeuronSpike, Output, Sample, Start};

/// Lists constants by scheme, sample type and options, both as text and as code for the compiler.
macro_rules! constants {
    ($($name:literal $sample:literal [$($option:literal: $text:literal),*] $scheme:ty = $value:expr;)*) => {
        fn every(mut check: impl FnMut(&'static str)) {
            $({
                const OWN: $scheme = $value;
                let written = [stringify!($scheme), stringify!($value)];
                compare($name, $sample, &[$(($option, $text)),*], written, &OWN);
                check($name);
            })*
        }
    };
}

constants! {
    "tbr" "f32" ["threshold": "0.1", "start": "0"]
        spikewire::temporal::TemporalContrast<f32> = spikewire::temporal::TemporalContrast::new(0.1).with_step(0.1);
    "atbr" "f32" ["threshold": "0.05", "doublings": "3", "start": "0"]
        spikewire::temporal::AdaptiveContrast<f32> = spikewire::temporal::AdaptiveContrast::new(0.05, 3);
    "mw" "i16" ["threshold": "200", "window": "4", "start": "0"]
        spikewire::temporal::MovingWindow<i16, 5> = spikewire::temporal::MovingWindow::new(200);
    "sf" "q16.16" ["threshold": "0.5", "start": "0"]
        spikewire::temporal::StepForward<fixed::types::I16F16>
            = spikewire::temporal::StepForward::new(fixed::types::I16F16::from_bits(32768));
    "sod" "q8.8" ["threshold": "0.5", "spikes": "4", "start": "0"]
        spikewire::temporal::SendOnDelta<fixed::types::I8F8, 4>
            = spikewire::temporal::SendOnDelta::new(fixed::types::I8F8::from_bits(128));
    "asf" "i16" ["threshold": "100", "doublings": "3", "run": "1", "start": "0"]
        spikewire::temporal::AdaptiveStepForward<i16>
            = spikewire::temporal::AdaptiveStepForward::new(100, 3).with_run(1);
    "bsa" "f32" ["filter": "0.5,1,0.5", "shift": "-2.5", "threshold": "0.5"]
        spikewire::rate::Bsa<f32, 3>
            = spikewire::rate::Bsa::subtractive(spikewire::rate::Taps::new([0.5, 1.0, 0.5]), 0.5).with_shift(-2.5);
    "hsa" "i16" ["filter": "500,1000,500", "shift": "-2500"]
        spikewire::rate::Hough<i16, 3>
            = spikewire::rate::Hough::new(spikewire::rate::Taps::new([500, 1000, 500])).with_shift(-2500);
    "t-hsa" "q16.16" ["filter": "0.5,1,0.5", "shift": "-2.5", "threshold": "0.25"]
        spikewire::rate::ThresholdHough<fixed::types::I16F16, 3>
            = spikewire::rate::ThresholdHough::new(
                spikewire::rate::Taps::new([
                    fixed::types::I16F16::from_bits(32768),
                    fixed::types::I16F16::from_bits(65536),
                    fixed::types::I16F16::from_bits(32768)
                ]),
                fixed::types::I16F16::from_bits(16384)
            ).with_shift(fixed::types::I16F16::from_bits(-163840));
    "if" "f32" ["threshold": "0.8", "reference": "0.25", "power": "3", "spikes": "4"]
        spikewire::rate::IntegrateAndFire<f32, 4>
            = spikewire::rate::IntegrateAndFire::new(0.8, 3).with_reference(0.25);
    "lif" "i16" ["threshold": "800", "power": "3", "spikes": "2"]
        spikewire::rate::IntegrateAndFire<i16, 2>
            = spikewire::rate::IntegrateAndFire::new(800, 3).leaky().with_reference(0);
    "sigma-delta" "f32" ["min": "-2.5", "max": "2.5", "power": "4"]
        spikewire::rate::SigmaDelta<f32, spikewire::rate::Average>
            = spikewire::rate::SigmaDelta::new(-2.5..=2.5, spikewire::rate::Average::new(4));
    "sigma-delta" "i16" ["min": "-2500", "max": "2500", "mean": "window", "power": "6"]
        spikewire::rate::SigmaDelta<i16, spikewire::rate::Window<2>>
            = spikewire::rate::SigmaDelta::new(-2500..=2500, spikewire::rate::Window::new(6));
    "burst-weighted" "f32" ["min": "-2.5", "max": "2.5", "weight": "1", "doublings": "3", "mean": "window", "power": "3"]
        spikewire::rate::WeightedBurst<f32, spikewire::rate::Window<1>>
            = spikewire::rate::WeightedBurst::new(-2.5..=2.5, 1.0, 3, spikewire::rate::Window::new(3));
    "position" "f32" ["centres": "gaussian", "neurons": "12", "min": "-2.5", "max": "2.5"]
        spikewire::population::Position<f32, 12> = spikewire::population::Position::gaussian_spaced(-2.5..=2.5);
    "position" "i16" ["centres": "-2000,-500,0,500,2000"]
        spikewire::population::Position<i16, 5>
            = spikewire::population::Position::new([-2000, -500, 0, 500, 2000]);
    "grf" "i16" ["neurons": "12", "min": "-2500", "max": "2500"]
        spikewire::population::Gaussian<i16, 12> = spikewire::population::Gaussian::linear(-2500..=2500);
    "grf-slots" "f32" ["neurons": "9", "min": "-2.5", "max": "2.5", "slots": "8", "beta": "1.2", "floor": "2"]
        spikewire::population::Slots<f32, 9, 8>
            = spikewire::population::Slots::new(-2.5..=2.5, 1.2).with_floor(2);
    "grf-nonlinear" "f32" ["neurons": "12", "companding": "20", "min": "-2.5", "max": "2.5"]
        spikewire::population::Gaussian<f32, 12> = spikewire::population::Gaussian::companded(-2.5..=2.5, 20.0);
    "grf-nonlinear" "i16" ["centres": "-2000,-500,0,500,2000"]
        spikewire::population::Gaussian<i16, 5>
            = spikewire::population::Gaussian::spaced([-2000, -500, 0, 500, 2000]);
    "grf-nonlinear" "f32" ["centres": "-2,0,0.5,2", "widths": "0.5"]
        spikewire::population::Gaussian<f32, 4>
            = spikewire::population::Gaussian::with_widths([-2.0, 0.0, 0.5, 2.0], [0.5, 0.5, 0.5, 0.5]);
    "grf-nonlinear" "q8.8" ["centres": "-2,0,2", "widths": "0.5,1,0.5"]
        spikewire::population::Gaussian<fixed::types::I8F8, 3>
            = spikewire::population::Gaussian::with_widths(
                [
                    fixed::types::I8F8::from_bits(-512),
                    fixed::types::I8F8::from_bits(0),
                    fixed::types::I8F8::from_bits(512)
                ],
                [0.5, 1.0, 0.5]
            );
    "grf-nonlinear-slots" "f32" ["neurons": "9", "companding": "20", "min": "-2.5", "max": "2.5", "slots": "8", "beta": "1.5"]
        spikewire::population::NonLinearSlots<f32, 9, 8>
            = spikewire::population::NonLinearSlots::companded(-2.5..=2.5, 20.0, 1.5).with_floor(1);
    "grf-nonlinear-slots" "i16" ["centres": "-2000,-500,0,500,2000", "slots": "8", "beta": "1.5"]
        spikewire::population::NonLinearSlots<i16, 5, 8>
            = spikewire::population::NonLinearSlots::spaced([-2000, -500, 0, 500, 2000], 1.5).with_floor(1);
    "grf-nonlinear-slots" "f32" ["centres": "-2,0,0.5,2", "widths": "0.5,0.25,0.25,0.5", "slots": "8", "floor": "2"]
        spikewire::population::NonLinearSlots<f32, 4, 8>
            = spikewire::population::NonLinearSlots::new([-2.0, 0.0, 0.5, 2.0], [0.5, 0.25, 0.25, 0.5]).with_floor(2);
    "rank-order" "f32" ["neurons": "9", "min": "-2.5", "max": "2.5", "spikes": "3"]
        spikewire::population::RankOrder<f32, 9, 3> = spikewire::population::RankOrder::linear(-2.5..=2.5);
    "rank-order" "i16" ["centres": "-2000,-500,0,500,2000", "spikes": "2"]
        spikewire::population::RankOrder<i16, 5, 2>
            = spikewire::population::RankOrder::new([-2000, -500, 0, 500, 2000]);
    "ttfs" "i16" ["slots": "12", "min": "-2500", "max": "2500"]
        spikewire::timing::FirstSpike<i16, 12> = spikewire::timing::FirstSpike::linear(-2500..=2500);
    "ttfs" "f32" ["edges": "log", "ratio": "20", "slots": "12", "min": "-2.5", "max": "2.5"]
        spikewire::timing::FirstSpike<f32, 12> = spikewire::timing::FirstSpike::logarithmic(-2.5..=2.5, 20.0);
    "ttfs" "f32" ["edges": "-1,0,0.5,2", "min": "-2.5", "max": "2.5"]
        spikewire::timing::FirstSpike<f32, 4> = spikewire::timing::FirstSpike::new(-2.5..=2.5, [-1.0, 0.0, 0.5, 2.0]);
    "latency-phase" "f32" ["neurons": "2", "latencies": "20", "period": "8", "spacing": "3", "min": "-2.5", "max": "2.5"]
        spikewire::timing::LatencyPhase<f32, 2, 20, 8> = spikewire::timing::LatencyPhase::new(-2.5..=2.5, 3);
    "weighted-phase" "i16" ["slots": "6", "min": "-2500", "max": "2500"]
        spikewire::timing::WeightedPhase<i16, 6> = spikewire::timing::WeightedPhase::new(-2500..=2500);
    "burst" "f32" ["slots": "19", "spikes": "5", "shortest": "2", "longest": "4", "min": "-2.5", "max": "2.5"]
        spikewire::timing::Burst<f32, 19> = spikewire::timing::Burst::new(-2.5..=2.5, 5, 2..=4);
}

/// Compares the text that options are written as, without spaces, and the spikes of the constant with those of the
/// settings.
fn compare<P: Start>(
    name: &str,
    sample: &str,
    given: &[(&str, &str)],
    written: [&str; 2],
    own: &P,
) {
    let sample: SampleType = sample.parse().unwrap();
    let scheme = catalogue::ALL.iter().find(|scheme| scheme.info().name == name).unwrap();
    let mut options = Asked::default();
    for (name, text) in given {
        let parameter = scheme.info().parameter(name).unwrap();
        options.set(parameter.name, parameter.read(text).unwrap());
    }
    let scale = if sample.step() == 1.0 { 1000.0 } else { 1.0 };
    let signal: Vec<f64> = (0..2000)
        .map(|i| (f64::from(i) * 0.02).sin() * 2.0 + (f64::from(i) * 0.31).cos() * 0.5)
        .map(|value| value * scale)
        .collect();
    let mut calibrated = Calibrated::new(sample);
    calibrated.observe(&signal);
    let known = Known { calibrated: Some(&calibrated), first: &signal, can_calibrate: true };
    let settings = scheme.resolve(sample, &options, &known).unwrap();

    let constant = scheme.constant(&settings).unwrap();
    let bare = |text: &str| text.split_whitespace().collect::<String>();
    assert_eq!([bare(&constant.scheme), bare(&constant.value)], written.map(bare), "{name}");

    let mut events = Vec::new();
    scheme.codec(&settings).unwrap().encode(&signal, &mut events);
    let mut state = P::START;
    own.prime(&mut state, &vec![P::Sample::from_f64(0.0); scheme.looks_back(&options)]);
    let codes = signal
        .iter()
        .filter_map(|value| own.encode(&mut state, P::Sample::from_f64(*value)).code());
    let own_events = codes.enumerate().flat_map(|(place, code)| {
        let event = |NeuronSpike { neuron, slot, polarity }| Event {
            sample: place as u64,
            neuron,
            slot,
            polarity,
        };
        code.firings().map(event).collect::<Vec<_>>()
    });
    assert!(!events.is_empty(), "{name}");
    assert_eq!(own_events.collect::<Vec<_>>(), events, "{name}");
}

/// All schemes are tested except those that need a random generator, which the user supplies.
#[test]
fn constants_spike_as_their_settings() {
    let mut seen = BTreeSet::from(["bernoulli", "grf-prob"]);
    every(|name| {
        seen.insert(name);
    });
    let all: BTreeSet<&str> = catalogue::INFO.iter().map(|info| info.name).collect();
    assert_eq!(seen, all);
}
