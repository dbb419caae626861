//! The arguments of initialisations: what C passes, and what a scheme takes.

use fixed::FixedI16;
use fixed::FixedI32;
use fixed::types::extra::{LeEqU16, LeEqU32, U8, U16};
use spikewire::rate::Shape;
use spikewire::{Calibration, Sample};

use crate::calibration::Calibrating;
use crate::kept::Kept;
use crate::{Status, pointer};

/// How C declares an argument.
#[derive(Clone, Copy, Debug)]
pub enum Declared {
    /// A number of this type.
    Number(&'static str),
    /// This many numbers of this type.
    List(&'static str, usize),
    /// A calibration of this sample type.
    Calibration(&'static str),
}

/// An argument of an initialisation.
pub trait Argument: Sized {
    /// What C passes.
    type C;
    /// How C declares it.
    const DECLARED: Declared;

    /// Which of a list's numbers is the first that is not finite.
    fn not_finite(&self) -> Option<usize> {
        None
    }

    /// What the scheme takes.
    ///
    /// # Errors
    /// A pointer is bad, or a number names no choice.
    ///
    /// # Safety
    /// C's promise of [`pointer`].
    unsafe fn taken(c: Self::C) -> Result<Self, Status>;
}

/// A number that C has too.
pub trait Number: Copy {
    /// What C calls it.
    const TYPE: &'static str;

    /// Whether it is a number: integers always are.
    fn is_finite(self) -> bool {
        true
    }
}

/// A sample type that can be calibrated.
pub trait CSample: Sample + Number {
    /// How the names of its functions end.
    const SUFFIX: &'static str;
}

macro_rules! numbers {
    ($($type:ty, $c:literal $(, $suffix:literal)?; $is_finite:expr;)*) => {
        $(
            impl Number for $type {
                const TYPE: &'static str = $c;

                fn is_finite(self) -> bool {
                    ($is_finite)(self)
                }
            }

            impl Argument for $type {
                type C = Self;
                const DECLARED: Declared = Declared::Number($c);

                unsafe fn taken(c: Self) -> Result<Self, Status> {
                    Ok(c)
                }
            }

            $(
                impl CSample for $type {
                    const SUFFIX: &'static str = $suffix;
                }
            )?
        )*
    };
}

numbers! {
    u8, "uint8_t"; |_| true;
    u16, "uint16_t"; |_| true;
    f32, "float", "f32"; f32::is_finite;
    i16, "int16_t", "i16"; |_| true;
}

/// Fixed point is an integer in C, whatever its fraction; two have names there.
macro_rules! fixed {
    ($($type:ident, $most:ident, $c:literal, $named:literal: $name:literal, $fraction:ident, $suffix:literal;)*) => {
        $(
            impl<Frac: $most + 'static> Number for $type<Frac> {
                const TYPE: &'static str = if Self::FRAC_NBITS == $named { $name } else { $c };
            }

            impl<Frac: $most + 'static> Argument for $type<Frac> {
                type C = Self;
                const DECLARED: Declared = Declared::Number(Self::TYPE);

                unsafe fn taken(c: Self) -> Result<Self, Status> {
                    Ok(c)
                }
            }

            impl CSample for $type<$fraction> {
                const SUFFIX: &'static str = $suffix;
            }
        )*
    };
}

fixed! {
    FixedI16, LeEqU16, "int16_t", 8: "sw_q8_8", U8, "q8_8";
    FixedI32, LeEqU32, "int32_t", 16: "sw_q16_16", U16, "q16_16";
}

impl<T: Number, const N: usize> Argument for [T; N] {
    type C = *const [T; N];
    const DECLARED: Declared = Declared::List(T::TYPE, N);

    fn not_finite(&self) -> Option<usize> {
        self.iter().position(|number| !number.is_finite())
    }

    unsafe fn taken(c: Self::C) -> Result<Self, Status> {
        // SAFETY: C's promise; any bytes are numbers.
        unsafe { pointer::shared(c) }.copied()
    }
}

/// The shape of a filter by its number: `SW_TRIANGULAR`, `SW_HANN`, `SW_GAUSSIAN`.
impl Argument for Shape {
    type C = u8;
    const DECLARED: Declared = Declared::Number("uint8_t");

    unsafe fn taken(c: u8) -> Result<Self, Status> {
        match c {
            0 => Ok(Self::Triangular),
            1 => Ok(Self::Hann),
            2 => Ok(Self::Gaussian { alpha: 2.5 }),
            _ => Err(Status::BAD_CHOICE),
        }
    }
}

impl<S: CSample> Argument for Calibration<S> {
    type C = *const Calibrating<S>;
    const DECLARED: Declared = Declared::Calibration(S::SUFFIX);

    unsafe fn taken(c: Self::C) -> Result<Self, Status> {
        // SAFETY: C's promise.
        unsafe { Kept::shared(c) }.copied()
    }
}
