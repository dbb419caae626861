//! What serde writes for public data: the parameters as a person would, no tables, no references.

use fixed::types::I8F8;
use rand_pcg::Pcg32;
use serde::Serialize;
use serde_json::json;
use spikewire::{
    Calibration, ConfigError, Event, Histogram, NeuronSpike, Polarity, SampleKind, Scheme, Spike,
    filter::{Biquad, FirstOrder},
    population::{
        FiredNeurons, Neuron, NeuronSlots, NonLinearSlots, Position, Probabilistic, RankOrder,
        Slots,
    },
    rate::{Bsa, BsaToolbox, Criterion, Hough, Scale, Shape, Taps, ThresholdHough},
    temporal::{MovingWindow, StepForward, TemporalContrast},
    timing::{
        Burst, BurstSpikes, FirstSpike, LatencyPhase, PhaseBits, PhaseSpikes, Slot, WeightedPhase,
    },
};

const TAPS: Taps<f32, 3> = Taps::triangular(1.0);
static SLOTS: Slots<f32, 4, 128> = Slots::new(0.0..=1.0, 1.5);

#[track_caller]
fn assert_json(data: impl Serialize, expected: &serde_json::Value) {
    assert_eq!(serde_json::to_value(data).unwrap(), *expected);
}

#[test]
fn spikes_and_firings() {
    assert_json([Spike::Down, Spike::None, Spike::Up], &json!(["Down", "None", "Up"]));
    let event = Event { tick: 5.into(), address: 2, polarity: Polarity::Down };
    assert_json(event, &json!({ "tick": 5, "address": 2, "polarity": "Down" }));
    let firing = NeuronSpike { neuron: 1, slot: 3, polarity: Polarity::Up };
    assert_json(firing, &json!({ "neuron": 1, "slot": 3, "polarity": "Up" }));
    assert_json(SampleKind::F32, &json!("F32"));
    assert_json(SampleKind::Fixed32 { fraction: 16 }, &json!({ "Fixed32": { "fraction": 16 } }));
}

#[test]
fn population_codes() {
    assert_json(Neuron::<4>::new(2), &json!(2));
    let spikes = SLOTS.encoder().encode(0.5);
    let pairs: Vec<(u16, u16)> = spikes.iter().collect();
    assert_eq!(pairs.len(), 4);
    assert_json(spikes, &json!(pairs));
    assert_json(FiredNeurons::<4>::EMPTY, &json!([]));
    assert_json(NeuronSlots::<4, 9>::new([(0, 8), (3, 0)]), &json!([[0, 8], [3, 0]]));
}

#[test]
fn temporal_schemes() {
    let scheme = TemporalContrast::new(3_i16).with_step(6);
    assert_json(scheme, &json!({ "threshold": 3, "step": 6 }));
    assert_json(StepForward::new(0.25_f32), &json!({ "threshold": 0.25 }));
    let scheme = MovingWindow::<I8F8, 4>::new(I8F8::from_bits(64));
    assert_json(scheme, &json!({ "threshold": { "bits": 64 } }));
}

#[test]
fn filters_before_schemes() {
    // A quarter of the rate: s² is 1/2, and s c / q is 1.
    let section = json!({ "gain": 1.0, "damping": 1.0, "tap": 0.25 });
    let filtered = Biquad::low_pass_with_q(1.0, 4.0, 0.5).before(StepForward::new(0.25_f32));
    assert_json(filtered, &json!({ "filter": section, "scheme": { "threshold": 0.25 } }));
    assert_json(Biquad::<i16>::low_pass_with_q(1.0, 4.0, 0.5), &section);
    assert_json(
        Biquad::<i16>::notch(1.0, 4.0, 0.5),
        &json!({ "gain": 1.0, "damping": 1.0, "tap": 0.5 }),
    );
    // A sixth of the rate: s is 1/2, and the gain sqrt(5)/2 - 1/2.
    let gain = ((1.25_f64.sqrt() - 0.5) * 536_870_912.0).round() / 536_870_912.0;
    assert_json(FirstOrder::<i16>::low_pass(1.0, 6.0), &json!({ "gain": gain }));
}

#[test]
fn rate_schemes_with_their_filter() {
    let taps = [0.5, 1.0, 0.5];
    assert_json(TAPS, &json!(taps));
    assert_json(Hough::new(TAPS), &json!({ "taps": taps, "shift": 0.0 }));
    let scheme = ThresholdHough::new(TAPS, 0.25);
    assert_json(scheme, &json!({ "taps": taps, "threshold": 0.25, "shift": 0.0 }));
    let scheme = Bsa::subtractive(TAPS, 0.5).with_shift(-1.0);
    assert_json(
        scheme,
        &json!({ "taps": taps, "criterion": { "Subtractive": 0.5 }, "shift": -1.0 }),
    );
    let scheme = Bsa::multiplicative(TAPS, 0.5);
    assert_json(
        scheme,
        &json!({ "taps": taps, "criterion": { "Multiplicative": 0.5 }, "shift": 0.0 }),
    );
    let scheme = BsaToolbox::new(TAPS, 1.5);
    assert_json(scheme, &json!({ "taps": taps, "threshold": 1.5, "shift": 0.0 }));
}

#[test]
fn population_schemes_with_their_neurons() {
    let scheme = Position::new([-1.5_f32, 0.0, 2.0]);
    assert_json(scheme, &json!({ "centres": [-1.5, 0.0, 2.0] }));
    let fields =
        json!({ "centres": [-0.25, 0.25, 0.75, 1.25], "min": 0.0, "max": 1.0, "beta": 1.5 });
    assert_json(SLOTS, &json!({ "fields": fields, "floor": 1 }));
    let scheme = NonLinearSlots::<i16, 3, 8>::spaced([-9, 0, 20], 1.5).with_floor(2);
    assert_json(scheme, &json!({ "centres": [-9, 0, 20], "floor": 2 }));
    let scheme = RankOrder::<i16, 3, 2>::new([-9, 0, 20]);
    assert_json(scheme, &json!({ "centres": [-9, 0, 20], "min": -9, "max": 20 }));
    let scheme = Probabilistic::<f32, Pcg32, 4, 128>::new(0.0..=1.0, 1.5);
    assert_json(scheme, &json!({ "fields": fields }));
}

#[test]
fn timing_codes_and_schemes() {
    assert_json(Slot::<4>::new(2), &json!(2));
    assert_json(PhaseBits::<4>::new(11), &json!(11));
    assert_json(PhaseSpikes::<2, 16, 4>::new([None, Some(9)]), &json!([[1, 9]]));
    assert_json(BurstSpikes::<19>::new(2, 7), &json!({ "count": 2, "interval": 7 }));

    let scheme = FirstSpike::new(0.0_f32..=3.0, [1.0, 2.0]);
    let silence = json!({ "last": 1.0, "value": 0.5 });
    assert_json(scheme, &json!({ "cells": [1.5, 2.5], "silence": silence, "slots": 2 }));
    let scheme = WeightedPhase::<i16, 4>::new(0..=999);
    assert_json(scheme, &json!({ "min": 0, "max": 999, "slots": 4 }));
    let scheme = LatencyPhase::<i16, 2, 2, 4>::new(0..=9, 2);
    let cells = json!([0, 5]);
    assert_json(
        scheme,
        &json!({
            "cells": cells, "max": 9, "width": 2, "period": 4, "neurons": 2, "spacing": 2, "phase": 0
        }),
    );
    let scheme = Burst::<i16, 2>::new(0..=9, 1, 1..=1);
    assert_json(
        scheme,
        &json!({ "cells": [5, 0], "bursts": [[1, 0], [1, 0]], "count": 1, "min": 0 }),
    );
}

#[test]
fn what_is_set_up_from() {
    assert_json(Shape::Gaussian { alpha: 2.5 }, &json!({ "Gaussian": { "alpha": 2.5 } }));
    assert_json(Scale::Sum(1.0_f32), &json!({ "Sum": 1.0 }));
    assert_json(Criterion::<f32>::Multiplicative(0.5), &json!({ "Multiplicative": 0.5 }));
    let error = ConfigError::AllZero { parameter: "filter taps" };
    assert_json(error, &json!({ "AllZero": { "parameter": "filter taps" } }));
    let mut calibration = Calibration::<f32>::new();
    for sample in [1.0, 2.0, 4.0] {
        calibration.observe(sample);
    }
    assert_json(calibration.differences().unwrap().mean, &json!(1.5));
    assert_eq!(serde_json::to_value(calibration).unwrap()["max"], json!(4.0));
    let histogram = Histogram::<i16, 2>::new(0..=9, 100);
    assert_json(
        histogram,
        &json!({
            "min": 0, "max": 9, "limit": 100, "total": 0, "counts": [0, 0], "seen": 0, "rejected": 0
        }),
    );
}
