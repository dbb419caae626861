//! Reals of 448 bits, for tables that have to be right to the last unit.

use std::cell::RefCell;
use std::ops::{Add, Div, Mul, Neg, Sub};

use astro_float_num::{BigFloat, Consts, RoundingMode, Sign};

const BITS: usize = 448;
const MODE: RoundingMode = RoundingMode::ToEven;

thread_local! {
    static CONSTANTS: RefCell<Consts> = RefCell::new(Consts::new().expect("memory"));
}

fn with_constants<T>(run: impl FnOnce(&mut Consts) -> T) -> T {
    CONSTANTS.with_borrow_mut(run)
}

/// A real.
#[derive(Clone, Debug)]
pub struct Precise(BigFloat);

impl<T: Into<f64>> From<T> for Precise {
    fn from(value: T) -> Self {
        Self(BigFloat::from_f64(value.into(), BITS))
    }
}

macro_rules! operator {
    ($($operator:ident $method:ident)*) => {
        $(
            impl<T: Into<Precise>> $operator<T> for Precise {
                type Output = Precise;
                fn $method(self, other: T) -> Precise {
                    Precise(BigFloat::$method(&self.0, &other.into().0, BITS, MODE))
                }
            }
        )*
    };
}
operator!(Add add Sub sub Mul mul Div div);

impl Neg for Precise {
    type Output = Precise;
    fn neg(self) -> Precise {
        Precise(self.0.neg())
    }
}

impl Precise {
    /// `self^exponent`, by the logarithm: the library's own power does not end where it is a power of 2.
    #[must_use]
    pub fn pow(&self, exponent: &Precise) -> Self {
        (self.ln() * exponent.clone()).exp()
    }

    /// The exponential.
    #[must_use]
    pub fn exp(&self) -> Self {
        with_constants(|constants| Self(self.0.exp(BITS, MODE, constants)))
    }

    /// The natural logarithm.
    #[must_use]
    pub fn ln(&self) -> Self {
        with_constants(|constants| Self(self.0.ln(BITS, MODE, constants)))
    }

    /// The square root.
    #[must_use]
    pub fn sqrt(&self) -> Self {
        Self(self.0.sqrt(BITS, MODE))
    }

    /// The arc cosine.
    #[must_use]
    pub fn acos(&self) -> Self {
        with_constants(|constants| Self(self.0.acos(BITS, MODE, constants)))
    }

    /// The sine of `self` times pi.
    #[must_use]
    pub fn sin_pi(&self) -> Self {
        with_constants(|constants| {
            let pi = constants.pi(BITS, MODE);
            Self(self.0.mul(&pi, BITS, MODE).sin(BITS, MODE, constants))
        })
    }

    /// The value, if a double holds it; or that of the two doubles around it whose last bit is 1. Compared with a
    /// sample, or rounded to one, it gives what the value gives. The last 128 bits are rounding errors.
    ///
    /// # Panics
    /// The value is not finite, or subnormal.
    pub fn to_f64(&self) -> f64 {
        let mut value = self.0.clone();
        value.set_precision(BITS - 128, MODE).expect("memory");
        if value.is_zero() {
            return 0.0;
        }
        let (words, _, sign, exponent, _) = value.as_raw_parts().expect("finite");
        let (&top, rest) = words.split_last().expect("words");
        let is_rounded = top << 53 != 0 || rest.iter().any(|&word| word != 0);
        let bits = top >> 11 | u64::from(is_rounded);
        assert!((-900..900).contains(&exponent), "{exponent}");
        let magnitude = bits as f64 * 2_f64.powi(exponent - 53);
        if sign == Sign::Neg { -magnitude } else { magnitude }
    }
}

#[cfg(test)]
mod tests {
    use super::Precise;

    #[test]
    fn rounds_to_odd() {
        let third = Precise::from(1.0) / 3.0;
        assert_eq!((third.clone() * 3.0).to_f64(), 1.0);
        assert_eq!(third.to_f64().to_bits(), (1.0_f64 / 3.0).to_bits());
        assert_eq!((-(third * 2.0)).to_f64(), -2.0 / 3.0);
        assert_eq!((Precise::from(1.0) / 5.0).to_f64(), 0.2_f64.next_down());
        assert_eq!(Precise::from(256.0).pow(&(Precise::from(5.0) / 8.0)).to_f64(), 32.0);
        assert_eq!(Precise::from(81.0).pow(&(Precise::from(1.0) / 4.0)).to_f64(), 3.0);
        assert_eq!((Precise::from(1.0) / 6.0).sin_pi().to_f64(), 0.5);
        assert_eq!(Precise::from(2.0).ln().exp().to_f64(), 2.0);
        assert_eq!((Precise::from(2.0).sqrt() * Precise::from(2.0).sqrt()).to_f64(), 2.0);
    }
}
