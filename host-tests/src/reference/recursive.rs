//! The filters before a code: coefficients of 448 bits, the laws in plain arithmetic, and the textbook's form of the same
//! filters in doubles, which the laws must come near.

use super::Precise;

/// A filter, with its corner or centre over the rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// One pole, -3 dB at the corner.
    FirstOrder,
    /// Two poles, with this `q`.
    LowPass(f32),
    /// Two poles and two zeros, with this `q`.
    Notch(f32),
}

/// The poles and zeros of Robert Bristow-Johnson's cookbook: `b0 b1 b2` over `1 a1 a2`. The first order is not in it:
/// `y += g (x - y)`, where `g` solves `|H|² = 1/2` at the corner: `g²/(1 + (1-g)² - 2 (1-g) cos w) = 1/2`.
pub fn textbook(kind: Kind, ratio: f64) -> [f64; 5] {
    let (sine, cosine) = (std::f64::consts::TAU * ratio).sin_cos();
    let (q, zeros) = match kind {
        Kind::FirstOrder => {
            let lack = 1.0 - cosine;
            let gain = (lack * lack + 2.0 * lack).sqrt() - lack;
            return [gain, 0.0, 0.0, gain - 1.0, 0.0];
        }
        Kind::LowPass(q) => (q, [(1.0 - cosine) / 2.0, 1.0 - cosine, (1.0 - cosine) / 2.0]),
        Kind::Notch(q) => (q, [1.0, -2.0 * cosine, 1.0]),
    };
    let alpha = sine / (2.0 * f64::from(q));
    let [b0, b1, b2] = zeros.map(|b| b / (1.0 + alpha));
    [b0, b1, b2, -2.0 * cosine / (1.0 + alpha), (1.0 - alpha) / (1.0 + alpha)]
}

/// The textbook's filter of first direct form, in doubles, from the steady state of the first sample.
pub fn direct_form([b0, b1, b2, a1, a2]: [f64; 5], samples: &[f64]) -> Vec<f64> {
    let first = samples.first().copied().unwrap_or_default();
    let ([mut x1, mut x2], [mut y1, mut y2]) = ([first; 2], [first; 2]);
    let mut filter = |x: f64| {
        let y = b0 * x + b1 * x1 + b2 * x2 - a1 * y1 - a2 * y2;
        (x1, x2, y1, y2) = (x, x1, y, y1);
        y
    };
    samples.iter().map(|&x| filter(x)).collect()
}

/// The group delay at DC in samples, from the derivative of the phase: `sum k b[k] / sum b - sum k a[k] / sum a`.
pub fn delay_at_rest([b0, b1, b2, a1, a2]: [f64; 5]) -> f64 {
    (b1 + 2.0 * b2) / (b0 + b1 + b2) - (a1 + 2.0 * a2) / (1.0 + a1 + a2)
}

/// The coefficients of a filter in the form of the laws: `[gain, damping, tap]`, where the first order has a gain alone.
/// `b0` is the tap of integers, `b0 / gain` that of floats.
pub fn coefficients(kind: Kind, corner: f32, rate: f32, has_gain: bool) -> [Precise; 3] {
    let ratio = Precise::from(corner) / Precise::from(rate);
    let one = || Precise::from(1.0);
    let sine = ratio.sin_pi();
    let square = sine.clone() * sine.clone();
    let (q, is_notch) = match kind {
        Kind::FirstOrder => {
            let lack = square * 2.0;
            let root = (lack.clone() * lack.clone() + lack.clone() * 2.0).sqrt();
            return [root - lack, Precise::from(0.0), Precise::from(0.0)];
        }
        Kind::LowPass(q) => (q, false),
        Kind::Notch(q) => (q, true),
    };
    let alpha = (ratio * 2.0).sin_pi() / 2.0 / q;
    let whole = one() + alpha.clone();
    // 1 + a1 + a2 and 1 - a2 of the cookbook.
    let gain = square.clone() * 4.0 / whole.clone();
    let damping = alpha * 2.0 / whole.clone();
    let first = if is_notch { one() } else { square } / whole;
    let tap = if has_gain { first / gain.clone() } else { first };
    [gain, damping, tap]
}

/// The law in `f32`: every operation rounds once, from left to right. Samples that are not finite pass.
pub fn filter_floats(kind: Kind, coefficients: &[Precise; 3], samples: &[f32]) -> Vec<f32> {
    let [gain, damping, tap] = [0, 1, 2].map(|i| coefficients[i].to_f64() as f32);
    let step = |level: f32, slope: f32, x: f32| {
        let error = x - level;
        if kind == Kind::FirstOrder {
            let y = level + gain * error;
            return (y, y, 0.0);
        }
        let change = gain * error - damping * slope;
        (level + tap * change, level + (slope + change), slope + change)
    };
    let mut state: Option<(f32, f32)> = None;
    let mut filter = |x: f32| {
        if !x.is_finite() {
            return x;
        }
        let (level, slope) = state.unwrap_or((x, 0.0));
        let mut next = step(level, slope, x);
        if !next.0.is_finite() || !next.1.is_finite() {
            next = step(x, 0.0, x);
        }
        state = Some((next.1, next.2));
        next.0
    };
    samples.iter().map(|&x| filter(x)).collect()
}

/// The law in integers of 16 or 32 bits. Everything is a whole number of 128 bits: outputs in units of `2^-finer`, and
/// with 16 bits slopes, and outputs of first order, in units of `2^-29` of these.
pub fn filter_integers(
    kind: Kind,
    coefficients: &[Precise; 3],
    bits: u32,
    samples: &[i64],
) -> Vec<i64> {
    let (finer, kept) = if bits == 16 { (1_i128 << 11, 1_i128 << 29) } else { (1 << 24, 1) };
    let lost = (1 << 29) / kept;
    let floor = |value: i128, by: i128| value.div_euclid(by);
    let [gain, damping, tap] = [0, 1, 2].map(|i| {
        let scaled = coefficients[i].to_f64() * 536_870_912.0;
        (scaled + 0.5).floor() as i128
    });
    let [least, most] = [-1_i128 << (bits - 1), (1 << (bits - 1)) - 1];
    let Some(&first) = samples.first() else { return Vec::new() };
    let mut before = [i128::from(first); 2];
    let mut output = i128::from(first) * finer;
    let mut slope = 0;
    let mut fine_output = output * kept;
    let mut filter = |x: i128| {
        if kind == Kind::FirstOrder {
            fine_output += floor(gain * (x * finer - floor(fine_output, kept)), lost);
            output = floor(fine_output, kept);
            return floor(2 * output + finer, 2 * finer);
        }
        let error = before[0] * finer - output;
        let bend = (x - 2 * before[0] + before[1]) * finer;
        let damped = floor(damping * floor(slope, kept), lost);
        slope += floor(gain * error, lost) + floor(tap * bend, lost) - damped;
        before = [x, before[0]];
        let free = output + floor(slope, kept);
        // The outputs that round to the ends.
        let within = free.clamp(least * finer - finer / 2, most * finer + finer / 2 - 1);
        if within != free {
            slope = (within - output) * kept;
        }
        output = within;
        floor(2 * output + finer, 2 * finer)
    };
    samples.iter().map(|&x| filter(i128::from(x)) as i64).collect()
}
