//! Elementary functions for building tables, also at compile time, where `libm` cannot run.
//!
//! In double precision, with an error far below the last place of every sample type, and only with
//! `+ - * /`: the same bits at compile time, on the host and on the target.

/// `exp(x)`.
pub(crate) const fn exp(x: f64) -> f64 {
    const LN_2: f64 = core::f64::consts::LN_2;
    if x < -708.0 {
        return 0.0;
    }
    let halves = (x / LN_2) as i64;
    let rest = x - halves as f64 * LN_2;
    let mut term = 1.0;
    let mut sum = 1.0;
    let mut n = 1.0;
    while n < 24.0 {
        term *= rest / n;
        sum += term;
        n += 1.0;
    }
    sum * f64::from_bits((halves.wrapping_add(1023) as u64) << 52)
}

/// `ln(x)` for normal `x > 0`.
pub(crate) const fn ln(x: f64) -> f64 {
    let (exponent, mantissa) = ln_parts(x);
    exponent * core::f64::consts::LN_2 + mantissa
}

/// The exponent of a normal `x > 0` to the base 2, and `ln` of the rest: 0 for a power of 2.
const fn ln_parts(x: f64) -> (f64, f64) {
    const MANTISSA: u64 = (1 << 52) - 1;
    let mut exponent = (x.to_bits() >> 52) as i64 - 1023;
    let mut mantissa = f64::from_bits((x.to_bits() & MANTISSA) | (1023 << 52));
    if mantissa > core::f64::consts::SQRT_2 {
        mantissa /= 2.0;
        exponent += 1;
    }
    let s = (mantissa - 1.0) / (mantissa + 1.0);
    let square = s * s;
    let mut power = s;
    let mut sum = 0.0;
    let mut n = 1.0;
    while n < 30.0 {
        sum += power / n;
        power *= square;
        n += 2.0;
    }
    (exponent as f64, 2.0 * sum)
}

/// `base^(part/parts)` for normal `base > 0`; exact where base and result are powers of 2.
pub(crate) const fn power(base: f64, part: f64, parts: f64) -> f64 {
    let (exponent, mantissa) = ln_parts(base);
    let exponent = (exponent + mantissa / core::f64::consts::LN_2) * part / parts;
    let whole = exponent as i64;
    let rest = exp((exponent - whole as f64) * core::f64::consts::LN_2);
    if whole < -1022 {
        return 0.0;
    }
    rest * f64::from_bits((whole.wrapping_add(1023) as u64) << 52)
}

/// The square root of a normal `x > 0`, or 0.
pub(crate) const fn sqrt(x: f64) -> f64 {
    if x <= 0.0 {
        return 0.0;
    }
    let mut root = f64::from_bits((x.to_bits() >> 1) + (1023 << 51));
    let mut n = 0;
    while n < 6 {
        root = f64::midpoint(root, x / root);
        n += 1;
    }
    root
}

/// `sin(pi t)` for `t` in 0 to 1.
pub(crate) const fn sin_pi(t: f64) -> f64 {
    let t = if t > 0.5 { 1.0 - t } else { t };
    let x = core::f64::consts::PI * t;
    let mut term = x;
    let mut sum = x;
    let mut n = 2.0;
    while n < 30.0 {
        term *= -x * x / (n * (n + 1.0));
        sum += term;
        n += 2.0;
    }
    sum
}

/// The quantile of the standard normal distribution: the value that a variable exceeds with probability `1 - p`,
/// for `p` in 0.5 to 1 - 1e-6.
pub(crate) const fn normal_quantile(p: f64) -> f64 {
    const ROOT_TWO_PI: f64 = 2.506_628_274_631_000_7;
    let mut z = 0.0;
    let mut round = 0;
    // Newton's steps from 0 rise monotonically to the root, as the distribution is concave above 0.
    while round < 40 {
        let density = exp(-z * z / 2.0) / ROOT_TWO_PI;
        let mut term = z;
        let mut sum = z;
        let mut n = 3.0;
        while term > sum * 1e-17 {
            term *= z * z / n;
            sum += term;
            n += 2.0;
        }
        let step = (p - 0.5 - density * sum) / density;
        z += step;
        if step < 1e-15 {
            break;
        }
        round += 1;
    }
    z
}

#[cfg(test)]
mod tests {
    use super::*;

    fn assert_close(ours: f64, exact: f64) {
        assert!((ours - exact).abs() <= 1e-13 * exact.abs() + 1e-15, "{ours} for {exact}");
    }

    #[test]
    fn agrees_with_libm() {
        for i in 1..=1000 {
            let x = f64::from(i) * 0.037;
            assert_close(exp(-x), libm::exp(-x));
            assert_close(ln(x), libm::log(x));
            assert_close(sqrt(x), libm::sqrt(x));
            let t = f64::from(i) / 1000.0;
            assert_close(sin_pi(t), libm::sin(core::f64::consts::PI * t));
        }
    }

    #[test]
    fn powers() {
        for part in -8..=0 {
            assert_eq!(power(256.0, f64::from(part), 8.0), libm::exp2(f64::from(part)));
            assert_close(
                power(10_000.0, f64::from(part), 8.0),
                libm::pow(10.0, f64::from(part) / 2.0),
            );
        }
    }

    #[test]
    fn normal_quantiles_from_tables() {
        assert_close(normal_quantile(0.5), 0.0);
        assert_close(normal_quantile(0.75), 0.674_489_750_196_081_7);
        assert_close(normal_quantile(0.975), 1.959_963_984_540_054);
        assert_close(normal_quantile(0.999), 3.090_232_306_167_813);
    }
}
