//! Latency-phase: neurons fire at the first peak of their oscillation from the latency on.

use crate::common::timing::{Lined, assert_law, beside, check, code_of, spikes_of};
use crate::common::{
    between, cases, drawn_recordings, flight_channels, hostile_recordings, ranges,
};
use fixed::types::I16F16;
use host_tests::reference::{Oscillation, edge, latency_phase, latency_phase_decode};
use proptest::prelude::*;
use spikewire::timing::{LatencyPhase, PhaseSpikes};
use spikewire::{ConfigError, Scheme, dynamic};

/// The ends of cells as a scheme keeps them: `f32` rounds them.
fn rounded(end: f64) -> f64 {
    (end as f32).into()
}

fn check_phases<S: Lined, const M: usize, const W: usize, const P: usize>(
    [min, max]: [S; 2],
    spacing: u16,
    phase: u16,
    x: &[S],
) {
    let of = Oscillation { neurons: M as u16, width: W as u16, period: P as u16, spacing, phase };
    let scheme = match LatencyPhase::<S, M, W, P>::try_new(min..=max, spacing) {
        Ok(scheme) => scheme.try_with_phase(phase).unwrap(),
        Err(error) => {
            assert!(matches!(error, ConfigError::EmptyCell { cells, .. } if cells == W), "{error}");
            return;
        }
    };
    let (low, high) = (min.line(), max.line());
    let spikes = |x| latency_phase(x, low, high, of);
    check(&scheme, x, None, spikes, |x| {
        for (neuron, slot) in spikes(x) {
            assert_eq!(scheme.neuron_at(slot), Some(neuron));
        }
        let value = latency_phase_decode(&spikes(x), low, high, of, rounded);
        value.expect("a latency explains the spikes of a value")
    });
}

#[test]
fn check_values() {
    let scheme = LatencyPhase::<i16, 4, 16, 4>::new(0..=255, 1);
    let spikes = scheme.encoder().encode(100);
    assert!(spikes.iter().eq([(0, 12), (1, 9), (2, 10), (3, 11)]));
    // One channel each.
    for (phase, slot, value) in [(0, 12, 79), (1, 9, 127), (2, 10, 111), (3, 11, 95)] {
        let one = LatencyPhase::<i16, 1, 16, 4>::new(0..=255, 1).with_phase(phase);
        let spikes = one.encoder().encode(100);
        assert!(spikes.iter().eq([(0, slot)]));
        assert_eq!(one.decoder().decode(spikes), value);
        assert_eq!(scheme.neuron_at(slot), Some(phase));
    }
}

/// Some of the spikes lost, or slots that contradict each other.
#[test]
fn any_spikes_are_decoded() {
    let range = [0_i16, 255];
    let of = Oscillation { neurons: 4, width: 16, period: 4, spacing: 1, phase: 0 };
    let scheme = LatencyPhase::<i16, 4, 16, 4>::new(0..=255, 1);
    let slot = proptest::option::of(0..19_u16);
    proptest!(cases(2048), |(slots in proptest::array::uniform4(slot))| {
        let spikes = PhaseSpikes::<4, 16, 4>::new(slots).unwrap();
        let listed = spikes_of(&spikes);
        prop_assert_eq!(code_of::<PhaseSpikes<4, 16, 4>>(&listed), spikes);
        let mut decoder = scheme.decoder();
        decoder.resync(7);
        let value = latency_phase_decode(&listed, range[0].line(), range[1].line(), of, rounded);
        prop_assert_eq!(i64::from(decoder.decode(spikes)), value.unwrap_or(7));
    });
    assert_eq!(PhaseSpikes::<1, 16, 4>::new([Some(19)]), None);
    assert_eq!(code_of::<PhaseSpikes<1, 16, 4>>(&[(0, 19)]), PhaseSpikes::SILENT);
    // Before its first spikes a decoder has the lower end of the middle cell.
    assert_eq!(scheme.decoder().held(), Some(scheme.starts()[8]));
}

#[test]
fn refusals() {
    let says =
        |result: Result<LatencyPhase<i16, 2, 16, 4>, ConfigError>| result.unwrap_err().to_string();
    assert_eq!(says(LatencyPhase::try_new(0..=99, 0)), "spacing 0 must lie in 1..=2");
    assert_eq!(says(LatencyPhase::try_new(0..=99, 3)), "spacing 3 must lie in 1..=2");
    let phased = LatencyPhase::try_new(0..=99, 1).unwrap().try_with_phase(4);
    assert_eq!(says(phased), "phase 4 must lie in 0..=3");
    let coarse = LatencyPhase::<i16, 2, 16, 4>::try_new(0..=9, 1);
    assert_eq!(coarse.err(), Some(ConfigError::EmptyCell { cell: 2, cells: 16 }));
    let of = |neurons, latencies, period| {
        dynamic::LatencyPhase::<f32>::try_of(neurons, latencies, period, &(0.0..=1.0), 1)
            .unwrap_err()
            .to_string()
    };
    assert_eq!(of(1, 1, 4), "latencies 1 must lie in 2..=256");
    assert_eq!(of(1, 16, 6), "period 6 must lie in 4..=4");
    assert_eq!(of(1, 250, 8), "period 8 must lie in 1..=7");
    assert_eq!(of(5, 16, 4), "neurons 5 must lie in 1..=4");
    assert_eq!(of(0, 16, 4), "neurons 0 must lie in 1..=4");
}

#[test]
fn flights_and_hostile_recordings() {
    for x in flight_channels() {
        check_phases::<f32, 4, 32, 4>([-4.0, 4.0], 1, 0, &x);
        let fixed: Vec<_> = x.iter().map(|&x| I16F16::from_num(x)).collect();
        check_phases::<_, 2, 100, 8>([-4, 4].map(I16F16::from_num), 3, 5, &fixed);
    }
    for x in hostile_recordings() {
        check_phases::<f32, 1, 16, 4>([-1.0, 1.0], 1, 2, &x);
        check_phases::<f32, 3, 7, 8>([f32::MIN, f32::MAX], 2, 1, &x);
        // Cells whose ends are subnormal.
        check_phases::<f32, 2, 7, 8>([f32::from_bits(5), f32::from_bits(106)], 2, 1, &x);
        check_phases::<f32, 3, 20, 16>([-f32::MIN_POSITIVE, 1e-40], 5, 1, &x);
    }
}

drawn_recordings!(S: Lined, 48, (x in S::recordings(), range in ranges::<S>(), phase in 0..4_u16) => {
    check_phases::<S, 1, 2, 1>(range, 1, 0, &x);
    check_phases::<S, 1, 16, 4>(range, 4, phase, &x);
    check_phases::<S, 4, 16, 4>(range, 1, phase, &x);
    check_phases::<S, 3, 20, 16>(range, 5, phase, &x);
    check_phases::<S, 2, 129, 128>(range, 64, phase, &x);
});

/// `f32` next to every edge.
#[test]
fn beside_the_edges() {
    proptest!(cases(128), |(min in -3.0_f32..3.0, width in between(0.01, 5.0))| {
        let range = [min, min + width];
        let edges = (1..32).map(|c| edge(range[0], range[1], c, 32));
        check_phases::<f32, 4, 32, 4>(range, 1, 0, &beside(edges));
    });
}

/// Every input of 16 bits: spikes, values, and the error's law of one neuron and of all that a period holds.
#[test]
fn all_65536_inputs() {
    let all: Vec<_> = (i16::MIN..=i16::MAX).collect();
    for range in [[i16::MIN, i16::MAX], [0, 255], [-20_000, 25_001]] {
        let width = f64::from(range[1]) - f64::from(range[0]);
        let samples = || all.iter().copied();
        check_phases::<i16, 1, 32, 8>(range, 1, 3, &all);
        let one = LatencyPhase::<i16, 1, 32, 8>::try_new(range[0]..=range[1], 1).unwrap();
        assert_law(&one, samples(), range, |_| 8.0 * width / 64.0 + 1.0);
        let four = LatencyPhase::<i16, 4, 32, 8>::try_new(range[0]..=range[1], 2).unwrap();
        assert_law(&four, samples(), range, |_| 2.0 * width / 64.0 + 1.0);
        let eight = LatencyPhase::<i16, 8, 32, 8>::try_new(range[0]..=range[1], 1).unwrap();
        assert_law(&eight, samples(), range, |_| width / 64.0 + 1.0);
    }
}

#[test]
fn shapes_at_run_time() {
    let all: Vec<_> = (i16::MIN..=i16::MAX).step_by(7).collect();
    let scheme = dynamic::LatencyPhase::try_of(3, 33, 16, &(-20_000..=25_001), 5).unwrap();
    let of = Oscillation { neurons: 3, width: 33, period: 16, spacing: 5, phase: 0 };
    let spikes = |x| latency_phase(x, -20_000, 25_001, of);
    let value = |x| latency_phase_decode(&spikes(x), -20_000, 25_001, of, rounded).unwrap();
    check(&scheme, &all, None, spikes, value);
}
