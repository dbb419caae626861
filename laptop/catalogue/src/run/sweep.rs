//! Compares many values of one parameter of a rate code in one pass over a signal.

use super::Piece;

/// Number of values that are compared in a pass; they fit a few vector registers.
pub const LANES: usize = 16;

/// A number for each value that is compared.
type Lane = [f32; LANES];

/// The rule by which a rate code spikes, applied to the rest of the signal in the filter's window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rule {
    /// No sample is below its tap, and the window does not extend beyond the end.
    Hough,
    /// The samples are below their taps by no more than the threshold, in total.
    ThresholdHough,
    /// Subtracting the taps reduces the sum of the magnitudes by at least the threshold.
    Bsa,
}

/// Codes pieces with `LANES` pairs of a factor of the taps and a threshold at once; returns the number of spikes and
/// the sum of squared errors of the scored samples for each pair. The rest of a sample after all spikes is its error, so nothing is decoded.
/// It computes in `f32`, with sums in another order than the codec's: use it to choose settings, not to report them.
pub fn sweep(
    rule: Rule,
    pieces: &[Piece],
    (taps, shift): (&[f64], f64),
    factors: &[f64; LANES],
    thresholds: &[f64; LANES],
) -> [(usize, f64); LANES] {
    let taps: Vec<Lane> =
        taps.iter().map(|tap| factors.map(|factor| (tap * factor) as f32)).collect();
    let limits: Lane = thresholds.map(|threshold| match rule {
        Rule::Hough => 0.0,
        Rule::ThresholdHough => threshold as f32,
        Rule::Bsa => -threshold as f32,
    });
    let mut found = [(0, 0.0); LANES];
    for piece in pieces {
        let mut left: Vec<Lane> =
            piece.values.iter().map(|value| [(value - shift) as f32; LANES]).collect();
        let mut window = left.as_mut_slice();
        for is_scored in piece.mask() {
            let mut unscored = [(0, 0.0); LANES];
            let found = if is_scored { &mut found } else { &mut unscored };
            if rule != Rule::Hough || window.len() >= taps.len() {
                spike(rule, window, &taps, &limits, found);
            }
            let Some((done, later)) = window.split_first_mut() else { break };
            for ((_, squares), error) in found.iter_mut().zip(done) {
                *squares += f64::from(*error) * f64::from(*error);
            }
            window = later;
        }
    }
    found
}

/// Decides the first sample of a window in all lanes, and subtracts the taps in those that spike.
fn spike(
    rule: Rule,
    window: &mut [Lane],
    taps: &[Lane],
    limits: &Lane,
    found: &mut [(usize, f64); LANES],
) {
    let mut sums = [0.0_f32; LANES];
    for (left, tap) in window.iter().zip(taps) {
        for ((sum, left), tap) in sums.iter_mut().zip(left).zip(tap) {
            *sum += match rule {
                Rule::Bsa => (left - tap).abs() - left.abs(),
                _ => (tap - left).max(0.0),
            };
        }
    }
    let mut is_spiking = [0.0_f32; LANES];
    for (((is_spiking, sum), limit), (spikes, _)) in
        is_spiking.iter_mut().zip(sums).zip(limits).zip(found)
    {
        if sum <= *limit {
            *is_spiking = 1.0;
            *spikes += 1;
        }
    }
    if is_spiking.iter().any(|own| *own > 0.0) {
        for (left, tap) in window.iter_mut().zip(taps) {
            for ((left, tap), is_spiking) in left.iter_mut().zip(tap).zip(is_spiking) {
                *left -= is_spiking * tap;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{LANES, Piece, Rule, sweep};
    use crate::schemes::{bsa, hsa, t_hsa};

    /// Each lane agrees with the transcription of the paper's pseudo-code.
    #[test]
    fn lanes_are_the_transcriptions() {
        let signal: Vec<f64> = (0..300)
            .map(|i| 2.0 + (f64::from(i) * 0.07).sin() + 0.3 * (f64::from(i) * 0.9).cos())
            .collect();
        let taps = [0.1, 0.3, 0.4, 0.25, 0.1];
        let thresholds: [f64; LANES] = std::array::from_fn(|lane| lane as f64 * 0.07);
        let factors: [f64; LANES] = std::array::from_fn(|lane| 0.5 + lane as f64 * 0.13);
        for rule in [Rule::Hough, Rule::ThresholdHough, Rule::Bsa] {
            let scored = [0..120, 200..300];
            let piece = Piece { values: &signal, scored: &scored };
            let all = sweep(rule, &[piece], (&taps, 0.5), &factors, &thresholds);
            for (lane, (spikes, squares)) in all.into_iter().enumerate() {
                let mut left: Vec<f32> = signal.iter().map(|own| (own - 0.5) as f32).collect();
                let taps: Vec<f32> = taps.iter().map(|tap| (tap * factors[lane]) as f32).collect();
                let (threshold, mut coded) = (thresholds[lane] as f32, vec![0; left.len()]);
                match rule {
                    Rule::Hough => hsa::transcribed(&mut left, &taps, &mut coded),
                    Rule::ThresholdHough => {
                        t_hsa::transcribed(&mut left, &taps, threshold, &mut coded);
                    }
                    Rule::Bsa => bsa::transcribed(&mut left, &taps, threshold, &mut coded),
                }
                let places = || scored.iter().cloned().flatten();
                let count = places().filter(|place| coded[*place] == 1).count();
                assert_eq!(spikes, count, "{rule:?} {lane}");
                let expected: f64 = places().map(|place| f64::from(left[place]).powi(2)).sum();
                assert!((squares - expected).abs() < 1e-3 * expected, "{rule:?} {lane}");
            }
        }
    }
}
