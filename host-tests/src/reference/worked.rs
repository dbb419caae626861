//! The printed check values of the schemes, worked in both number types.

use super::{
    Real, ben_subtractive, doubles, hann, levels_exp, rate_decode, rounded, scaled_to_sum,
    slots_by_distance, slots_exp,
};

/// `0.5+0.4 sin(2π·0.01 i)`, 1000 samples, 24 taps `sin²(π(k+1)/25)` of unit sum, no shift: the root
/// mean square error over samples 30..970 and the spikes, at one threshold.
fn ben_on_a_sine<T: Real>(threshold: f64) -> (f64, usize) {
    let signal: Vec<f64> = (0..1000)
        .map(|i| 0.5 + 0.4 * (std::f64::consts::TAU * 0.01 * f64::from(i)).sin())
        .collect();
    let x: Vec<T> = rounded(&signal);
    let taps: Vec<T> = rounded(&doubles(&scaled_to_sum(&hann(24), 1.0)));
    let spikes = ben_subtractive(&x, &taps, T::ZERO, T::rounded(threshold), true);
    let decoded = rate_decode(&spikes, &taps, T::ZERO);
    let squares: f64 = (30..970)
        .map(|i| {
            let (value, decoded): (f64, f64) = (x[i].into(), decoded[i].into());
            (value - decoded).powi(2)
        })
        .sum();
    let count = spikes.iter().filter(|&&spike| spike != 0).count();
    ((squares / 940.0).sqrt(), count)
}

#[test]
fn ben_subtractive_on_a_sine() {
    let printed = [
        (0.0, 0.2425, 713, 5e-5),
        (0.5, 0.1222, 598, 5e-5),
        (0.9, 0.0183, 505, 5e-5),
        (0.955, 0.00707, 493, 5e-6),
    ];
    for (threshold, error, spikes, half_a_digit) in printed {
        for (measured, count) in [ben_on_a_sine::<f64>(threshold), ben_on_a_sine::<f32>(threshold)]
        {
            assert!(
                (measured - error).abs() <= half_a_digit,
                "threshold {threshold}: {measured} with {count} spikes"
            );
            assert_eq!(count, spikes, "threshold {threshold}");
        }
    }
}

#[test]
fn slots_of_four_neurons() {
    let printed = [
        (0.1, [Some(42), Some(10), Some(85), None]),
        (0.5, [Some(92), Some(25), Some(25), Some(92)]),
        (0.9, [None, Some(85), Some(10), Some(42)]),
    ];
    for (x, slots) in printed {
        assert_eq!(slots_exp(x, 0.0, 1.0, 4, 1.5, 100, 1), slots);
        assert_eq!(slots_by_distance(x, 0.0, 1.0, 4, 1.5, 100, 1), slots);
        let single = x as f32;
        assert_eq!(slots_by_distance(single, 0.0, 1.0, 4, 1.5, 100, 1), slots);
    }
    assert_eq!(levels_exp(0.1, 0.0, 1.0, 4, 1.5, 100), [58, 90, 15, 0]);
}
