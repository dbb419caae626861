//! Time to first spike: slot `N - 1 - cell`, of even points, or of what lies above thresholds.

use crate::common::timing::{Lined, assert_law, beside, check};
use crate::common::{
    between, cases, drawn_recordings, flight_channels, hostile_recordings, ranges,
};
use fixed::types::{I16F16, I32F0};
use host_tests::reference::{edge, first_spike_above, first_spike_linear, log_thresholds};
use proptest::prelude::*;
use spikewire::timing::{FirstSpike, Slot};
use spikewire::{ConfigError, Scheme, dynamic};

/// Linear slots; without a scheme where the type is too coarse.
fn check_linear<S: Lined, const N: usize>([min, max]: [S; 2], x: &[S]) {
    let reference = |x| first_spike_linear(x, min.line(), max.line(), N as u32);
    match FirstSpike::<S, N>::try_linear(min..=max) {
        Ok(scheme) => check(&scheme, x, None, |x| reference(x).spikes(), |x| reference(x).value()),
        Err(error) => {
            assert!(matches!(error, ConfigError::EmptyCell { cells, .. } if cells == N), "{error}");
        }
    }
}

/// Logarithmic slots; without a scheme where the type is too coarse.
fn check_log<S: Lined, const N: usize>([min, max]: [S; 2], ratio: f32, x: &[S]) {
    let thresholds = log_thresholds(min.line(), max.line(), N as u32, ratio);
    let Ok(scheme) = FirstSpike::<S, N>::try_logarithmic(min..=max, ratio) else { return };
    let reference = |x| first_spike_above(x, min.line(), max.line(), &thresholds);
    let silence = S::on(reference(min.line()).value());
    check(&scheme, x, Some(silence), |x| reference(x).spikes(), |x| reference(x).value());
}

#[test]
fn check_values() {
    let scheme = FirstSpike::<I32F0, 8>::logarithmic(I32F0::ZERO..=I32F0::from_bits(65_535), 256.0);
    let spike = scheme.encoder().encode(I32F0::from_bits(600));
    assert_eq!(spike, Slot::new(6));
    assert_eq!(scheme.decoder().decode(spike), 767);
    let edges = [255, 511, 1023, 2047, 4095, 8191, 16_383, 32_767];
    for (slot, edge) in (0..8_u16).rev().zip(edges) {
        let slot_of = |x| scheme.encoder().encode(I32F0::from_bits(x)).map(Slot::index);
        assert_eq!(slot_of(edge), (slot < 7).then_some(slot + 1), "{edge}");
        assert_eq!(slot_of(edge + 1), Some(slot), "{edge}");
    }
    // Points 0, 63.75, 127.5, 191.25 and 255, with the edges 31 95 159 223.
    let scheme = FirstSpike::<i16, 5>::linear(0..=255);
    let slots = [-1, 0, 31, 32, 95, 96, 159, 160, 223, 224, 255, 256];
    let slots = slots.map(|x| scheme.encoder().encode(x).map(Slot::index));
    assert_eq!(slots.map(Option::unwrap), [4, 4, 4, 3, 3, 2, 2, 1, 1, 0, 0, 0]);
}

/// Decades are whole, whatever the logarithm makes of them.
#[test]
fn whole_thresholds() {
    let scheme = FirstSpike::<i16, 4>::logarithmic(0..=10_000, 10_000.0);
    let slots = [1, 2, 10, 11, 100, 101, 1000, 1001].map(|x| scheme.encoder().encode(x));
    let slots = slots.map(|slot| slot.map(Slot::index));
    assert_eq!(slots, [None, Some(3), Some(3), Some(2), Some(2), Some(1), Some(1), Some(0)]);
}

/// A threshold 0.00011 below a whole number, beside which an error of 1e-13 would take the next one.
#[test]
fn thresholds_close_to_whole_numbers() {
    let range = [12, 1_993_552_906].map(I32F0::from_bits);
    check_log::<I32F0, 11>(range, 172.1448, &[I32F0::from_bits(781_810_686)]);
}

#[test]
fn silence_is_a_value_below_thresholds_and_none_without() {
    let linear = FirstSpike::<f32, 4>::linear(0.0..=3.0);
    let mut decoder = linear.decoder();
    decoder.resync(2.5);
    assert_eq!(decoder.decode(linear.encoder().encode(f32::NAN)), 2.5);
    let above = FirstSpike::<f32, 3>::new(0.0..=3.0, [1.0, 1.5, 2.5]);
    let slots = [0.5, 1.0, 1.2, 1.5, 2.0, 2.75, 9.0, f32::NAN].map(|x| above.encoder().encode(x));
    let slots = slots.map(|slot| slot.map(Slot::index));
    assert_eq!(slots, [None, None, Some(2), Some(2), Some(1), Some(0), Some(0), None]);
    let mut decoder = above.decoder();
    let values = [None, Slot::new(2), Slot::new(1), Slot::new(0), None].map(|x| decoder.decode(x));
    assert_eq!(values, [0.5, 1.25, 2.0, 2.75, 0.5]);
}

/// Where silence has no value, a decoder starts from the middle.
#[test]
fn before_its_first_spike_a_decoder_has_the_middle_cell() {
    let scheme = FirstSpike::<i16, 5>::linear(0..=40);
    assert_eq!(*scheme.values(), [2, 10, 20, 30, 38]);
    assert_eq!(scheme.decoder().held(), Some(20));
}

/// Neither 0 exceeds an edge of -0.
#[test]
fn an_edge_of_minus_zero() {
    let scheme = FirstSpike::<f32, 2>::new(-1.0..=1.0, [-0.5, -0.0]);
    let slots = [-0.0, 0.0, 1e-45].map(|x| scheme.encoder().encode(x).map(Slot::index));
    assert_eq!(slots, [Some(1), Some(1), Some(0)]);
}

/// A leaky integrate-and-fire neuron at a constant input, step by step.
#[test]
fn a_neuron_with_a_leak() {
    let (theta, tau, slots) = (1.0_f64, 3.0_f64, 12_u8);
    let decay = (-1.0 / tau).exp();
    let threshold = |t: u8| (theta / (1.0 - (-f64::from(t + 1) / tau).exp())) as f32;
    let thresholds: [f32; 12] = std::array::from_fn(|i| threshold(slots - 1 - i as u8));
    let scheme = FirstSpike::<f32, 12>::new(0.0..=4.0, thresholds);
    for x in (0..400_u16).map(|i| f32::from(i) / 100.0 + 0.003) {
        let mut v = 0.0;
        let fires = (0..slots).position(|_| {
            v = v * decay + f64::from(x) * (1.0 - decay);
            v > theta
        });
        let slot = scheme.encoder().encode(x).map(|slot| usize::from(slot.index()));
        assert_eq!(slot, fires, "{x}");
    }
}

#[test]
fn refusals() {
    let empty = |cell, cells| Some(ConfigError::EmptyCell { cell, cells });
    let error = |result: Result<FirstSpike<i16, 4>, _>| result.err();
    let names = |result: Result<FirstSpike<i16, 4>, ConfigError>| {
        result.unwrap_err().to_string().split(' ').next().unwrap().to_owned()
    };
    assert_eq!(error(FirstSpike::try_linear(0..=2)), empty(2, 4));
    assert_eq!(error(FirstSpike::try_new(0..=9, [-1, 2, 3, 4])), empty(0, 5));
    assert_eq!(error(FirstSpike::try_new(0..=9, [1, 2, 3, 9])), empty(4, 5));
    assert_eq!(error(FirstSpike::try_logarithmic(0..=100, 1000.0)), empty(1, 5));
    assert_eq!(names(FirstSpike::try_new(0..=9, [1, 2, 2, 4])), "edges");
    assert_eq!(
        error(FirstSpike::try_new(0..=9, [1, 3, 2, 4])),
        Some(ConfigError::NotRising { parameter: "edges", index: 2, value: 2.0, previous: 3.0 })
    );
    assert_eq!(names(FirstSpike::try_linear(3..=3)), "min");
    for ratio in [1.0, 0.0, -2.0, f32::NAN, f32::INFINITY] {
        assert_eq!(names(FirstSpike::try_logarithmic(0..=9999, ratio)), "dynamic");
    }
    for [min, max] in [[f32::NAN, 1.0], [0.0, f32::INFINITY], [1.0, 0.0]] {
        assert!(FirstSpike::<f32, 4>::try_linear(min..=max).is_err());
        assert!(FirstSpike::<f32, 4>::try_logarithmic(min..=max, 9.0).is_err());
    }
    assert!(FirstSpike::<f32, 2>::try_new(0.0..=1.0, [0.5, f32::NAN]).is_err());
    for slots in [0, 1, 257] {
        assert!(dynamic::FirstSpike::<f32>::try_linear_of(slots, &(0.0..=1.0)).is_err());
    }
}

#[test]
fn flights_and_hostile_recordings() {
    for x in flight_channels() {
        check_linear::<f32, 16>([-4.0, 4.0], &x);
        check_log::<f32, 16>([-4.0, 4.0], 256.0, &x);
        let fixed: Vec<_> = x.iter().map(|&x| I16F16::from_num(x)).collect();
        check_linear::<_, 100>([-4, 4].map(I16F16::from_num), &fixed);
        check_log::<_, 100>([-4, 4].map(I16F16::from_num), 77.0, &fixed);
    }
    for x in hostile_recordings() {
        check_linear::<f32, 16>([-1.0, 1.0], &x);
        check_linear::<f32, 7>([f32::MIN, f32::MAX], &x);
        check_linear::<f32, 7>([-1e-40, 1e-40], &x);
        check_log::<f32, 8>([0.0, f32::MAX], 256.0, &x);
    }
    // Drawn once, and wrong then.
    check_log::<f32, 11>([2.332_518_9e-35, 2.693_714_6], 346.597_08, &[0.25, 1.25, 1.125, 0.625]);
    check_log::<f32, 11>([-1e38, 3.119_407e-39], 642.818_05, &[0.0]);
}

drawn_recordings!(S: Lined, 48, (x in S::recordings(), range in ranges::<S>(), ratio in between(1.5, 999.0)) => {
    check_linear::<S, 2>(range, &x);
    check_linear::<S, 13>(range, &x);
    check_linear::<S, 256>(range, &x);
    check_log::<S, 2>(range, 16.0, &x);
    check_log::<S, 16>(range, 256.0, &x);
    check_log::<S, 11>(range, ratio, &x);
});

/// `f32` next to every edge.
#[test]
fn beside_the_edges() {
    proptest!(cases(128), |(min in -3.0_f32..3.0, width in between(0.01, 5.0))| {
        let range = [min, min + width];
        let edges = (1..16).map(|c| edge(range[0], range[1], 2 * c - 1, 30));
        check_linear::<f32, 16>(range, &beside(edges));
        let edges = log_thresholds(range[0], range[1], 16, 256.0);
        check_log::<f32, 16>(range, 256.0, &beside(edges.into_iter()));
    });
}

/// Every input of 16 bits: spikes, values, and the error's law.
#[test]
fn all_65536_inputs() {
    let all: Vec<_> = (i16::MIN..=i16::MAX).collect();
    for range in [[i16::MIN, i16::MAX], [0, 255], [-20_000, 25_001]] {
        let width = f64::from(range[1]) - f64::from(range[0]);
        check_linear::<i16, 16>(range, &all);
        check_linear::<i16, 256>(range, &all);
        check_log::<i16, 8>(range, 256.0, &all);
        let scheme = FirstSpike::<i16, 16>::try_linear(range[0]..=range[1]).unwrap();
        let samples = || all.iter().copied();
        assert_law(&scheme, samples(), range, |_| width / 30.0 + 1.0);
        let Ok(scheme) = FirstSpike::<i16, 8>::try_logarithmic(range[0]..=range[1], 256.0) else {
            continue;
        };
        let growth = 256.0_f64.powf(1.0 / 8.0) - 1.0;
        let lowest = width / 256.0;
        assert_law(&scheme, samples(), range, |x| {
            let above = x - f64::from(range[0]);
            if above > lowest { above * growth / 2.0 + 1.0 } else { lowest / 2.0 + 1.0 }
        });
    }
}

/// What has its shape at run time gives the bits of what has it at compile time.
#[test]
fn shapes_at_run_time() {
    let all: Vec<_> = (i16::MIN..=i16::MAX).collect();
    let range = -20_000..=25_001_i16;
    let linear = dynamic::FirstSpike::try_linear_of(37, &range).unwrap();
    let reference = |x| first_spike_linear(x, -20_000, 25_001, 37);
    check(&linear, &all, None, |x| reference(x).spikes(), |x| reference(x).value());
    let log = dynamic::FirstSpike::try_logarithmic_of(11, &range, 99.0).unwrap();
    let thresholds = log_thresholds(-20_000_i64, 25_001, 11, 99.0);
    let reference = |x| first_spike_above(x, -20_000, 25_001, &thresholds);
    let silence = Some(reference(-20_000).value() as i16);
    check(&log, &all, silence, |x| reference(x).spikes(), |x| reference(x).value());
    let user = dynamic::FirstSpike::try_new_of(&[-100, 7, 300], &range).unwrap();
    let reference = |x| first_spike_above(x, -20_000, 25_001, &[-100.0, 7.0, 300.0]);
    let silence = Some(reference(-20_000).value() as i16);
    check(&user, &all, silence, |x| reference(x).spikes(), |x| reference(x).value());
}

/// What is built at compile time is what is built in flight.
#[test]
fn constants() {
    static COUNTS: FirstSpike<i16, 16> = FirstSpike::logarithmic(-30_000..=7, 300.0);
    static FLOATS: FirstSpike<f32, 16> = FirstSpike::linear(-0.3..=0.7);
    assert_eq!(COUNTS, FirstSpike::try_logarithmic(-30_000..=7, 300.0).unwrap());
    assert_eq!(FLOATS, FirstSpike::try_linear(-0.3..=0.7).unwrap());
    assert_eq!(FLOATS.values().len(), 16);
}
