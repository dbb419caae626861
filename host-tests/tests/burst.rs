//! Burst coding: the larger the value, the more spikes, and the closer together.

use crate::common::timing::{Lined, assert_law, beside, check, code_of};
use crate::common::{
    between, cases, drawn_recordings, flight_channels, hostile_recordings, ranges,
};
use fixed::types::I16F16;
use host_tests::reference::{Bursts, edge};
use proptest::prelude::*;
use spikewire::timing::{Burst, BurstSpikes};
use spikewire::{ConfigError, Scheme, dynamic};

fn check_bursts<S: Lined, const N: usize>(
    [min, max]: [S; 2],
    spikes: u8,
    [shortest, longest]: [u8; 2],
    x: &[S],
) {
    let law = Bursts { spikes: spikes.into(), intervals: shortest.into()..=longest.into() };
    let scheme = Burst::<S, N>::try_new(min..=max, spikes, shortest..=longest).unwrap();
    let (low, high) = (min.line(), max.line());
    let spikes = |x| Bursts::spikes(law.burst(x, low, high));
    check(&scheme, x, Some(min), spikes, |x| law.middle(x, low, high));
}

#[test]
fn check_values() {
    let scheme = Burst::<i16, 19>::new(0..=255, 5, 2..=10);
    let burst = scheme.encoder().encode(100);
    assert_eq!((burst.count(), burst.interval()), (2, 7));
    assert_eq!(scheme.decoder().decode(burst), 99);
    let burst = scheme.encoder().encode(255);
    assert_eq!((burst.count(), burst.interval()), (5, 2)); // slots 0 2 4 6 8
    assert_eq!(scheme.encoder().encode(0), BurstSpikes::SILENT);
}

/// What is not a code: a spike lost, one too many, an interval that no value has.
#[test]
fn any_spikes_are_decoded() {
    let table: [(&[u16], (u8, u8)); 8] = [
        (&[], (0, 0)),
        (&[3], (0, 0)),
        (&[0], (1, 0)),
        (&[0, 0, 0], (1, 0)),
        (&[6, 3, 0], (3, 3)),
        (&[0, 3, 9], (2, 3)),
        (&[0, 3, 6, 8], (3, 3)),
        (&[0, 25], (1, 0)),
    ];
    for (slots, expected) in table {
        let spikes: Vec<_> = slots.iter().map(|&slot| (0, slot)).collect();
        let burst: BurstSpikes<19> = code_of(&spikes);
        assert_eq!((burst.count(), burst.interval()), expected, "{slots:?}");
    }
    let scheme = Burst::<i16, 19>::new(0..=255, 5, 2..=10);
    let mut decoder = scheme.decoder();
    decoder.resync(7);
    for burst in [BurstSpikes::new(5, 1), BurstSpikes::new(3, 9), BurstSpikes::new(2, 2)] {
        assert_eq!(decoder.decode(burst.unwrap()), 7);
    }
    assert_eq!(BurstSpikes::<19>::new(3, 0), None);
    assert_eq!(BurstSpikes::<19>::new(3, 10), None);
}

#[test]
fn refusals() {
    let says = |result: Result<Burst<i16, 19>, ConfigError>| result.unwrap_err().to_string();
    assert_eq!(says(Burst::try_new(0..=99, 0, 2..=10)), "spikes 0 must lie in 1..=255");
    assert_eq!(says(Burst::try_new(0..=99, 5, 0..=10)), "shortest interval 0 must lie in 1..=10");
    let descending = std::hint::black_box(9)..=8;
    assert_eq!(
        says(Burst::try_new(0..=99, 5, descending)),
        "shortest interval 9 must lie in 1..=8"
    );
    assert_eq!(says(Burst::try_new(0..=99, 5, 3..=11)), "slots 19 must lie in 22..=256");
    assert_eq!(
        says(Burst::try_new(0..=99, 200, 1..=2)),
        "slots of the longest burst 395 must lie in 1..=256"
    );
    // In a range of one step every burst but the longest is of no value.
    assert_eq!(
        Burst::<i16, 2>::try_new(0..=1, 3, 1..=1).unwrap_err().to_string(),
        "slots 2 must lie in 3..=256"
    );
    assert!(says(Burst::try_new(9..=9, 5, 2..=10)).starts_with("min and max"));
    assert!(dynamic::Burst::<f32>::try_of(18, &(0.0..=1.0), 5, &(2..=10)).is_err());
    assert!(dynamic::Burst::<f32>::try_of(257, &(0.0..=1.0), 5, &(2..=10)).is_err());
    assert!(dynamic::Burst::<f32>::try_of(19, &(0.0..=1.0), 5, &(2..=10)).is_ok());
}

/// One sample in the cell, and both its edges in the gap above it: the cell ends with its count.
#[test]
fn edges_between_two_floats() {
    let samples: Vec<f32> = (0..4).map(|at| f32::from_bits(1.0_f32.to_bits() + at)).collect();
    let scheme = Burst::<f32, 16>::new(1.0..=samples[3], 3, 1..=3);
    let burst = scheme.encoder().encode(samples[1]);
    assert_eq!((burst.count(), burst.interval()), (1, 0));
    // Half a step above the minimum, rounded to even.
    assert_eq!(scheme.decoder().decode(burst), 1.0);
}

#[test]
fn flights_and_hostile_recordings() {
    for x in flight_channels() {
        check_bursts::<f32, 19>([-4.0, 4.0], 5, [2, 10], &x);
        let fixed: Vec<_> = x.iter().map(|&x| I16F16::from_num(x)).collect();
        check_bursts::<_, 100>([-4, 4].map(I16F16::from_num), 9, [1, 30], &fixed);
    }
    for x in hostile_recordings() {
        check_bursts::<f32, 19>([-1.0, 1.0], 5, [2, 10], &x);
        check_bursts::<f32, 64>([f32::MIN, f32::MAX], 7, [1, 13], &x);
        check_bursts::<f32, 19>([-0.0, 1.0], 5, [2, 10], &x);
    }
}

drawn_recordings!(S: Lined, 48, (x in S::recordings(), range in ranges::<S>()) => {
    // Where an `f32` is as coarse as the cells, two edges may be one.
    let [min, max] = range.map(spikewire::Sample::to_f64);
    prop_assume!(max - min > (min.abs().max(max.abs()) / 1024.0).max(1e-40));
    check_bursts::<S, 2>(range, 1, [1, 200], &x);
    check_bursts::<S, 17>(range, 2, [1, 30], &x);
    check_bursts::<S, 19>(range, 5, [2, 10], &x);
    check_bursts::<S, 64>(range, 7, [3, 3], &x);
    check_bursts::<S, 256>(range, 20, [1, 20], &x);
});

/// Ranges of few samples, where edges fall together: no shape takes more cells than slots.
#[test]
fn short_ranges() {
    for range in 1..=40_i16 {
        let all: Vec<_> = (-3..=range + 3).collect();
        for spikes in 1..=9 {
            for [shortest, longest] in [[1, 1], [1, 4], [2, 10], [3, 20]] {
                check_bursts::<i16, 256>([0, range], spikes, [shortest, longest], &all);
            }
        }
    }
}

/// The fewest slots that hold all bursts of a wide range are enough.
#[test]
fn fewest_slots() {
    for spikes in 1..=20_u8 {
        for (shortest, steps) in [(1, 0), (1, 1), (1, 9), (2, 8), (1, 30), (5, 17)] {
            let longest = shortest + steps;
            let range = 0.0..=1.0_f32;
            let of = |slots| dynamic::Burst::try_of(slots, &range, spikes, &(shortest..=longest));
            let least = (2..=256).find(|&slots| of(slots).is_ok());
            let longest_at = |k: u8| {
                u32::from(k)
                    * (u32::from(longest) - u32::from(steps) * u32::from(k) / u32::from(spikes))
            };
            let most = (0..spikes).map(longest_at).max().unwrap() + 1;
            assert_eq!(
                least.unwrap_or(257).min(257) as u32,
                most.clamp(2, 257),
                "{spikes} {shortest} {steps}"
            );
        }
    }
}

/// `f32` next to every edge.
#[test]
fn beside_the_edges() {
    proptest!(cases(128), |(min in -3.0_f32..3.0, width in between(0.01, 5.0))| {
        let range = [min, min + width];
        let counts = (0..5).map(|k| edge(range[0], range[1], k, 5));
        let intervals = (1..=8).map(|j| edge(range[0], range[1], j, 8));
        check_bursts::<f32, 19>(range, 5, [2, 10], &beside(counts.chain(intervals)));
    });
}

/// Every input of 16 bits: spikes, values, and the error's law.
#[test]
fn all_65536_inputs() {
    let all: Vec<_> = (i16::MIN..=i16::MAX).collect();
    for range in [[i16::MIN, i16::MAX], [0, 255], [-20_000, 25_001]] {
        let width = f64::from(range[1]) - f64::from(range[0]);
        check_bursts::<i16, 19>(range, 5, [2, 10], &all);
        let scheme = Burst::<i16, 19>::try_new(range[0]..=range[1], 5, 2..=10).unwrap();
        assert_law(&scheme, all.iter().copied(), range, |_| width / 10.0 + 1.0);
    }
}

#[test]
fn shapes_at_run_time() {
    let all: Vec<_> = (i16::MIN..=i16::MAX).collect();
    let scheme = dynamic::Burst::try_of(64, &(-20_000..=25_001), 7, &(1..=13)).unwrap();
    let law = Bursts { spikes: 7, intervals: 1..=13 };
    let spikes = |x| Bursts::spikes(law.burst(x, -20_000, 25_001));
    check(&scheme, &all, Some(-20_000), spikes, |x| law.middle(x, -20_000, 25_001));
}
