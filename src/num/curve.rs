//! Elementary functions for building tables, also at compile time, where `libm` cannot run.
//!
//! Off by less than 2⁻⁹⁶ of the result.

use super::DoubleDouble;

/// `exp(x)`, 0 below -690.
#[inline(never)]
pub(crate) const fn exp(x: DoubleDouble) -> DoubleDouble {
    if x.nearest() < -690.0 {
        return DoubleDouble::ZERO;
    }
    let whole = (x.nearest() / core::f64::consts::LN_2) as i64;
    let rest = x.minus(DoubleDouble::LN_2.times(DoubleDouble::new(whole as f64)));
    exp_less_one(rest).plus(DoubleDouble::ONE).scaled(power_of_two(whole))
}

/// `2^exponent`, for exponents of normal doubles.
const fn power_of_two(exponent: i64) -> f64 {
    f64::from_bits((exponent.wrapping_add(1023) as u64) << 52)
}

/// `exp(x) - 1`, for `x` up to 1: all its digits also near 0.
#[inline(never)]
const fn exp_less_one(x: DoubleDouble) -> DoubleDouble {
    let part = x.scaled(1.0 / 256.0);
    let mut term = part;
    let mut sum = part;
    let mut n = 2.0;
    while n < 12.0 {
        term = term.times(part).over_double(n);
        sum = sum.plus(term);
        n += 1.0;
    }
    // Eight times `exp(2x) - 1 = 2y + y^2` of `y = exp(x) - 1`.
    while n < 20.0 {
        sum = sum.scaled(2.0).plus(sum.times(sum));
        n += 1.0;
    }
    sum
}

/// `ln(x)` for normal `x > 0`.
pub(crate) const fn ln(x: DoubleDouble) -> DoubleDouble {
    let (exponent, mantissa) = ln_parts(x);
    DoubleDouble::LN_2.times(DoubleDouble::new(exponent)).plus(mantissa)
}

/// The exponent of a normal `x > 0` to the base 2, and `ln` of the rest: 0 for a power of 2.
const fn ln_parts(x: DoubleDouble) -> (f64, DoubleDouble) {
    let mut exponent = (x.nearest().to_bits() >> 52) as i64 - 1023;
    let mantissa = x.scaled(power_of_two(exponent.wrapping_neg()));
    let is_large = mantissa.nearest() > core::f64::consts::SQRT_2;
    if is_large {
        exponent += 1;
    }
    let mantissa = if is_large { mantissa.scaled(0.5) } else { mantissa };
    (exponent as f64, ln_one_and(mantissa.minus(DoubleDouble::ONE)))
}

/// `ln(1 + x)` for `x` within -0.3 to 0.42: all its digits also near 0.
#[inline(never)]
const fn ln_one_and(x: DoubleDouble) -> DoubleDouble {
    let s = x.over(x.plus(DoubleDouble::new(2.0)));
    let square = s.times(s);
    let mut power = s;
    let mut sum = s;
    let mut n = 3.0;
    while n < 45.0 {
        power = power.times(square);
        sum = sum.plus(power.over_double(n));
        n += 2.0;
    }
    sum.scaled(2.0)
}

/// `base^(part/parts)` for normal `base > 0` and a power up to 1; exact where a double holds it.
pub(crate) const fn power(base: DoubleDouble, part: usize, parts: usize) -> DoubleDouble {
    if part == parts {
        return base;
    }
    let (part, parts) = (part as f64, parts as f64);
    let (exponent, mantissa) = ln_parts(base);
    let exponent = exponent * part;
    let whole = (exponent / parts) as i64;
    let rest = DoubleDouble::LN_2.times(DoubleDouble::new(exponent - whole as f64 * parts));
    let rest = rest.plus(mantissa.times(DoubleDouble::new(part)));
    exp(rest.over(DoubleDouble::new(parts))).scaled(power_of_two(whole)).settled()
}

/// `(1 + x)^(part/parts) - 1` for `x > 0` and a power up to 1: all its digits also near 0.
pub(crate) const fn growth(x: f64, part: usize, parts: usize) -> DoubleDouble {
    if part == parts {
        return DoubleDouble::new(x);
    }
    if x > 0.25 {
        return power(DoubleDouble::sum(1.0, x), part, parts).minus(DoubleDouble::ONE);
    }
    let [part, parts] = [DoubleDouble::new(part as f64), DoubleDouble::new(parts as f64)];
    let growth = exp_less_one(ln_one_and(DoubleDouble::new(x)).times(part).over(parts));
    let power = growth.plus(DoubleDouble::ONE).settled().minus(DoubleDouble::ONE);
    // No root of what is nearer to 1 is a double.
    if x > 1e-9 && power.is_double() { power } else { growth }
}

/// `sin(pi part/parts)` for a part up to `parts`.
pub(crate) const fn sin_pi(part: usize, parts: usize) -> DoubleDouble {
    let rest = parts.saturating_sub(part);
    let part = if part < rest { part } else { rest };
    sin_pi_at(DoubleDouble::new(part as f64).over(DoubleDouble::new(parts as f64)))
}

/// `sin(pi t)` for `t` within 0 to 0.5.
pub(crate) const fn sin_pi_at(t: DoubleDouble) -> DoubleDouble {
    let x = DoubleDouble::PI.times(t);
    let square = x.times(x).negated();
    let mut term = x;
    let mut sum = x;
    let mut n = 2.0;
    while n < 32.0 {
        term = term.times(square).over_double(n * (n + 1.0));
        sum = sum.plus(term);
        n += 2.0;
    }
    sum
}

/// The quantile of the standard normal distribution: the value that a variable exceeds with probability
/// `1 - part/parts`, for a probability within 0.5 to 1 - 1e-6. The search begins `from` a lower quantile.
pub(crate) const fn normal_quantile(part: usize, parts: usize, from: DoubleDouble) -> DoubleDouble {
    /// Terms below this part of the sum change no digit of it.
    const LEAST: f64 = f64::from_bits((1023 - 108) << 52);
    let above_middle = DoubleDouble::new(part as f64).over_double(parts as f64);
    let above_middle = above_middle.plus(DoubleDouble::new(-0.5));
    let mut z = from;
    let mut round = 0;
    // Newton's steps rise monotonically to the root, as the distribution is concave above 0. A step below 1e-15
    // leaves an error of about its square.
    while round < 40 {
        let square = z.times(z);
        let density = exp(square.scaled(-0.5)).over(DoubleDouble::ROOT_TWO_PI);
        let mut term = z;
        let mut sum = z;
        let mut n = 3.0;
        while term.nearest() > sum.nearest() * LEAST {
            term = term.times(square).over_double(n);
            sum = sum.plus(term);
            n += 2.0;
        }
        let step = above_middle.minus(density.times(sum)).over(density);
        z = z.plus(step);
        if step.nearest() < 1e-15 {
            break;
        }
        round += 1;
    }
    z
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dd(value: f64) -> DoubleDouble {
        DoubleDouble::new(value)
    }

    fn assert_close(ours: DoubleDouble, exact: f64) {
        let ours = ours.nearest();
        assert!((ours - exact).abs() <= 1e-15 * exact.abs(), "{ours} for {exact}");
    }

    /// Asserts that two ways to a number meet in all its digits.
    fn assert_same(one: DoubleDouble, other: DoubleDouble) {
        let difference = one.minus(other).nearest();
        assert!(difference.abs() <= 1e-28 * other.nearest().abs(), "{difference}");
    }

    #[test]
    fn agrees_with_libm() {
        for i in 1..=1000 {
            let x = f64::from(i) * 0.037;
            assert_close(exp(dd(-x)), libm::exp(-x));
            assert_close(ln(dd(x)), libm::log(x));
            assert_close(dd(x).sqrt(), libm::sqrt(x));
            assert_close(growth(x / 1e5, 1, 3), libm::expm1(libm::log1p(x / 1e5) / 3.0));
        }
    }

    #[test]
    fn inverses_meet_in_all_digits() {
        for i in 1..=1000_usize {
            let x = dd(i as f64).over(dd(27.0));
            assert_same(exp(ln(x)), x);
            let root = power(x, 1, 3);
            assert_same(root.times(root).times(root), x);
            assert_same(x.sqrt().times(x.sqrt()), x);
            assert_same(dd(3.0).times(x).over(dd(3.0)), x);
            let cosine = sin_pi(i.abs_diff(500), 1000);
            assert_same(sin_pi(i, 1000).times(sin_pi(i, 1000)).plus(cosine.times(cosine)), dd(1.0));
            let grown = DoubleDouble::ONE.plus(growth(i as f64 / 1e3, 1, 2));
            assert_same(grown.times(grown), DoubleDouble::sum(1.0, i as f64 / 1e3));
        }
    }

    #[test]
    fn exact_powers() {
        for part in 0..=8 {
            assert_eq!(power(dd(256.0), part, 8).rounded(), libm::exp2(part as f64));
            assert_eq!(power(dd(1e8), part, 8).rounded(), libm::pow(10.0, part as f64));
            assert_eq!(power(dd(6561.0), part, 8).rounded(), libm::pow(3.0, part as f64));
        }
        assert_eq!(growth(3.0, 1, 2).rounded(), 1.0);
        assert_eq!(growth(0.5625, 1, 2).rounded(), 0.25);
        assert_eq!(growth(129.0 / 4096.0, 1, 2).rounded(), 1.0 / 64.0);
    }

    #[test]
    fn rounds_to_odd() {
        let (even, odd) = (1.5_f64, 1.5_f64.next_up());
        for (high, low, rounded) in [
            (even, 0.0, even),
            (even, 1e-17, odd),
            (even, -1e-17, even.next_down()),
            (odd, 1e-17, odd),
            (odd, -1e-17, odd),
            (even, 1e-31, odd),
        ] {
            assert_eq!(DoubleDouble::sum(high, low).rounded(), rounded);
        }
        assert_eq!(DoubleDouble::sum(even, 1e-31).settled().rounded(), even);
    }

    #[test]
    fn normal_quantiles_from_tables() {
        assert_eq!(normal_quantile(1, 2, DoubleDouble::ZERO).nearest(), 0.0);
        assert_close(normal_quantile(3, 4, DoubleDouble::ZERO), 0.674_489_750_196_081_7);
        assert_close(normal_quantile(39, 40, dd(1.9)), 1.959_963_984_540_054);
        assert_close(normal_quantile(999, 1000, dd(0.5)), 3.090_232_306_167_813);
    }
}
