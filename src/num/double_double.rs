//! Reals of about 104 bits, for tables that are right to the last unit, also at compile time.

/// `high + low`, where `low` is at most half of the last place of `high`.
///
/// Only with `+ - * /`: the same bits at compile time, on the host and on the target. Each operation is off by a few
/// units of 2⁻¹⁰⁶ of its result, which `plus` has of its larger operand. For magnitudes from 1e-200 to 1e200, and 0.
///
/// The operations stay out of line: without an FPU for doubles each of them is a dozen calls.
///
/// Source: Dekker, *A floating-point technique for extending the available precision*, 1971; Joldes, Muller, Popescu,
/// *Tight and rigorous error bounds for basic building blocks of double-word arithmetic*, 2017.
#[derive(Clone, Copy)]
pub(crate) struct DoubleDouble {
    high: f64,
    low: f64,
}

impl DoubleDouble {
    pub(crate) const ZERO: Self = Self::new(0.0);
    pub(crate) const ONE: Self = Self::new(1.0);
    pub(super) const LN_2: Self =
        Self { high: core::f64::consts::LN_2, low: 2.319_046_813_846_299_6e-17 };
    pub(super) const PI: Self =
        Self { high: core::f64::consts::PI, low: 1.224_646_799_147_353_2e-16 };
    pub(super) const ROOT_TWO_PI: Self =
        Self { high: 2.506_628_274_631_000_7, low: -1.832_857_998_045_916_7e-16 };

    /// This value.
    pub(crate) const fn new(value: f64) -> Self {
        Self { high: value, low: 0.0 }
    }

    /// `a + b`, exactly.
    pub(crate) const fn sum(a: f64, b: f64) -> Self {
        let high = a + b;
        let rest = high - a;
        Self { high, low: (a - (high - rest)) + (b - rest) }
    }

    /// `a + b`, exactly, where `a` is the larger in magnitude.
    const fn ordered_sum(a: f64, b: f64) -> Self {
        let high = a + b;
        Self { high, low: b - (high - a) }
    }

    /// `a * b`, exactly.
    pub(crate) const fn product(a: f64, b: f64) -> Self {
        let high = a * b;
        Self { high, low: rest_of_product(a, b, high) }
    }

    #[inline(never)]
    pub(crate) const fn plus(self, other: Self) -> Self {
        // The exact sums of both parts, without calls: what is evaluated at compile time counts them.
        let high = self.high + other.high;
        let rest = high - self.high;
        let high_low = (self.high - (high - rest)) + (other.high - rest);
        let low = self.low + other.low;
        let rest = low - self.low;
        let low_low = (self.low - (low - rest)) + (other.low - rest);
        let middle = high_low + low;
        let sum = high + middle;
        let low = low_low + (middle - (sum - high));
        let high = sum + low;
        Self { high, low: low - (high - sum) }
    }

    pub(crate) const fn negated(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }

    pub(crate) const fn minus(self, other: Self) -> Self {
        self.plus(other.negated())
    }

    #[inline(never)]
    pub(crate) const fn times(self, other: Self) -> Self {
        let first = self.high * other.high;
        let rest = self.high * other.low + self.low * other.high;
        let rest = rest_of_product(self.high, other.high, first) + rest;
        let high = first + rest;
        Self { high, low: rest - (high - first) }
    }

    #[inline(never)]
    pub(crate) const fn over(self, other: Self) -> Self {
        let first = self.high / other.high;
        let rest = self.minus(other.times(Self::new(first)));
        let second = rest.high / other.high;
        let rest = rest.minus(other.times(Self::new(second)));
        let quotient = Self::ordered_sum(first, second);
        quotient.plus(Self::new(rest.high / other.high))
    }

    /// This value over a double, quicker.
    #[inline(never)]
    pub(crate) const fn over_double(self, other: f64) -> Self {
        let first = self.high / other;
        let product = first * other;
        let rest = (self.high - product) - rest_of_product(first, other, product) + self.low;
        let rest = rest / other;
        let high = first + rest;
        Self { high, low: rest - (high - first) }
    }

    /// Times a power of 2.
    pub(crate) const fn scaled(self, power: f64) -> Self {
        Self { high: self.high * power, low: self.low * power }
    }

    /// The square root of a value above 0, or 0.
    pub(crate) const fn sqrt(self) -> Self {
        let root = root(self.high);
        if root <= 0.0 {
            return Self::ZERO;
        }
        let rest = self.minus(Self::product(root, root));
        Self::ordered_sum(root, rest.high / (2.0 * root))
    }

    /// The nearest double.
    pub(crate) const fn nearest(self) -> f64 {
        self.high
    }

    /// Without digits below 2⁻⁹⁸ of the value, which are errors of the operations: for a result of functions that a
    /// double may hold, as `4^(1/2)`.
    pub(crate) const fn settled(self) -> Self {
        const ERROR: f64 = f64::from_bits((1023 - 98) << 52);
        if self.low.abs() <= self.high.abs() * ERROR { Self::new(self.high) } else { self }
    }

    /// Whether a double holds the value.
    pub(super) const fn is_double(self) -> bool {
        self.low == 0.0
    }

    /// The value, if a double holds it; or that of the two doubles around it whose last bit is 1. Rounding this
    /// double to a sample type gives what rounding the value gives: down, or to the nearest.
    pub(crate) const fn rounded(self) -> f64 {
        let Self { high, low } = self;
        let is_odd = high.to_bits() & 1 == 1;
        if low > 0.0 && !is_odd {
            high.next_up()
        } else if low < 0.0 && !is_odd {
            high.next_down()
        } else {
            high
        }
    }
}

/// `a * b - product`, exactly, of the rounded product.
const fn rest_of_product(a: f64, b: f64, product: f64) -> f64 {
    /// Cuts a double into halves of 26 bits.
    const CUT: f64 = 134_217_729.0;
    let (cut_a, cut_b) = (CUT * a, CUT * b);
    let (top_a, top_b) = (cut_a - (cut_a - a), cut_b - (cut_b - b));
    let (rest_a, rest_b) = (a - top_a, b - top_b);
    ((top_a * top_b - product) + top_a * rest_b + rest_a * top_b) + rest_a * rest_b
}

/// The square root of a normal `x > 0`, or 0.
const fn root(x: f64) -> f64 {
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
