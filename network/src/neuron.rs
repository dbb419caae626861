//! Neurons of all kinds, in one form.
//!
//! With a current: `I = a I + (x + bias)`, then `u = b v + (I + bias)`. Without: `u = b v + (x + bias)`. Then the
//! [rule](crate::Reset) decides whether `u` fires. `x` is the sum of the weights of the inputs that fired, `v` the
//! potential before, `a` and `b` are the decays. Gains (`R dt / tau`, `w_in`) must be multiplied into weights and
//! biases; a leak towards another value than 0 (`v_leak dt / tau`) must be added to the bias.

use crate::checksum::Checksum;
use crate::error::{ParameterError, unwrap};
use crate::integer;
use crate::number::{self, Number};
use crate::reset::{
    Reset, Subtract, SubtractLate, SubtractNoDelay, ToValue, ToValueHeld, ToValueLate,
};
use crate::sealed::Sealed;
use core::{fmt::Debug, marker::PhantomData};

/// A neuron's parameters, which may lie in flash.
pub trait Neuron: Copy + Debug + Sealed + 'static {
    /// The type of the potential.
    type Value: Number;
    /// The type of the current; empty for neurons whose inputs act for one step.
    type Current: Copy + Default + Debug;

    /// Whether the neuron ever fires.
    #[doc(hidden)]
    const FIRES: bool;
    /// Returns the constant that is added to the inputs in every step.
    #[doc(hidden)]
    fn bias(&self) -> Self::Value;
    /// Runs a step, given the sum of inputs and bias; returns whether the neuron fires.
    #[doc(hidden)]
    fn step(&self, v: &mut Self::Value, current: &mut Self::Current, input: Self::Value) -> bool;
    /// Returns a number above [`number::OUTSIDE`] if the current has left its range.
    #[doc(hidden)]
    fn outside(current: &Self::Current) -> u32;
    /// Clamps the current to its range; returns 1 if it was outside, or else 0.
    #[doc(hidden)]
    fn clamp(current: &mut Self::Current) -> u32;
    /// Adds the parameters to a checksum.
    #[doc(hidden)]
    fn add_to(&self, sum: &mut Checksum);
}

/// A leaky neuron that fires (LIF). With a decay of 1 it is a perfect integrator (IF).
#[derive(Clone, Copy, Debug)]
pub struct Lif<V: Number, R> {
    decay: V::Factor,
    bias: V,
    threshold: V,
    reset: V,
    rule: PhantomData<R>,
}

/// A leaky integrator that never fires (LI) and whose potential is read. With a decay of 1 it sums over all steps (I),
/// with a decay of 0 over one step only.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Li<V: Number> {
    decay: V::Factor,
    bias: V,
}

/// A neuron whose inputs form a current that decays by itself: `CubaLIF` with [`Lif`], `CubaLI` with [`Li`]. If `OLD`
/// is set, the potential takes the current of the step before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cuba<V: Number, N, const OLD: bool = false> {
    decay: V::Factor,
    bias: V,
    neuron: N,
}

/// A leaky neuron with a current (`CubaLIF`).
pub type CubaLif<V, R> = Cuba<V, Lif<V, R>>;

/// A leaky integrator with a current (`CubaLI`).
pub type CubaLi<V> = Cuba<V, Li<V>>;

impl<V: Number, R: Reset> Sealed for Lif<V, R> {}
impl<V: Number> Sealed for Li<V> {}
impl<V: Number, N, const OLD: bool> Sealed for Cuba<V, N, OLD> {}

impl<V: Number, R: Reset> Neuron for Lif<V, R> {
    type Value = V;
    type Current = ();
    const FIRES: bool = true;

    #[inline(always)]
    fn bias(&self) -> V {
        self.bias
    }

    #[inline(always)]
    fn step(&self, v: &mut V, (): &mut (), input: V) -> bool {
        R::fire(v, |v| v.scaled(self.decay).plus(input), self.threshold, self.reset)
    }

    #[inline(always)]
    fn outside((): &()) -> u32 {
        0
    }

    #[inline(always)]
    fn clamp((): &mut ()) -> u32 {
        0
    }

    fn add_to(&self, sum: &mut Checksum) {
        sum.add(V::word_of_factor(self.decay));
        for number in [self.bias, self.threshold, self.reset] {
            sum.add(number.word());
        }
    }
}

impl<V: Number> Neuron for Li<V> {
    type Value = V;
    type Current = ();
    const FIRES: bool = false;

    #[inline(always)]
    fn bias(&self) -> V {
        self.bias
    }

    #[inline(always)]
    fn step(&self, v: &mut V, (): &mut (), input: V) -> bool {
        *v = v.scaled(self.decay).plus(input);
        false
    }

    #[inline(always)]
    fn outside((): &()) -> u32 {
        0
    }

    #[inline(always)]
    fn clamp((): &mut ()) -> u32 {
        0
    }

    fn add_to(&self, sum: &mut Checksum) {
        sum.add(V::word_of_factor(self.decay));
        sum.add(self.bias.word());
    }
}

impl<V: Number, N: Neuron<Value = V, Current = ()>, const OLD: bool> Neuron for Cuba<V, N, OLD> {
    type Value = V;
    type Current = V;
    const FIRES: bool = N::FIRES;

    #[inline(always)]
    fn bias(&self) -> V {
        self.bias
    }

    #[inline(always)]
    fn step(&self, v: &mut V, current: &mut V, input: V) -> bool {
        let before = *current;
        *current = before.scaled(self.decay).plus(input);
        let taken = if OLD { before } else { *current };
        self.neuron.step(v, &mut (), taken.plus(self.neuron.bias()))
    }

    #[inline(always)]
    fn outside(current: &V) -> u32 {
        current.outside()
    }

    #[inline(always)]
    fn clamp(current: &mut V) -> u32 {
        current.clamp()
    }

    fn add_to(&self, sum: &mut Checksum) {
        sum.add(V::word_of_factor(self.decay));
        sum.add(self.bias.word());
        self.neuron.add_to(sum);
    }
}

impl<V: Number, N> Cuba<V, N> {
    /// Makes the potential take the current of the step before, as NIR's reference program does.
    pub const fn from_old_current(self) -> Cuba<V, N, true>
    where
        N: Copy,
    {
        let Self { decay, bias, neuron } = self;
        Cuba { decay, bias, neuron }
    }
}

/// Checks a potential in `f32`.
const fn float(parameter: &'static str, value: f32) -> Result<f32, ParameterError> {
    let (min, max) = (-number::LARGEST, number::LARGEST);
    if value >= min && value <= max {
        Ok(value)
    } else {
        Err(ParameterError { parameter, place: (0, 0), value, min, max })
    }
}

/// Checks a decay in `f32`.
const fn share(value: f32) -> Result<f32, ParameterError> {
    if value >= 0.0 && value <= 1.0 {
        Ok(value)
    } else {
        Err(ParameterError { parameter: "decay", place: (0, 0), value, min: 0.0, max: 1.0 })
    }
}

/// Checks a potential in `i32`.
const fn whole(parameter: &'static str, value: i32) -> Result<i32, ParameterError> {
    if value >= -integer::LARGEST && value <= integer::LARGEST {
        Ok(value)
    } else {
        let max = integer::LARGEST as f32;
        Err(ParameterError { parameter, place: (0, 0), value: value as f32, min: -max, max })
    }
}

/// Checks a decay, in units of 1/65 536, and returns it as products take it.
const fn part(value: u32) -> Result<u32, ParameterError> {
    if value <= integer::ONE {
        Ok(value << integer::DECAY_SHIFT)
    } else {
        let (value, max) = (value as f32, integer::ONE as f32);
        Err(ParameterError { parameter: "decay", place: (0, 0), value, min: 0.0, max })
    }
}

/// Returns the next smaller number.
const fn float_below(value: f32) -> f32 {
    value.next_down()
}

/// Returns the next smaller number.
const fn whole_below(value: i32) -> i32 {
    value.saturating_sub(1)
}

/// Writes the constructors, which are `const` and therefore cannot be generic over the number type.
macro_rules! constructors {
    (@returning $number:ty, $reset:ty, $help:literal) => {
        impl Lif<$number, $reset> {
            #[doc = $help]
            ///
            /// # Panics
            /// Panics if it is out of its range; at compile time where it initialises a constant.
            #[must_use]
            pub const fn with_reset(self, reset: $number) -> Self {
                self.returning(reset)
            }
        }
    };
    ($new:ident, $try_new:ident, $number:ty, $factor:ty, $share:ident, $check:ident, $below:ident, $zero:expr) => {
        impl<R: Reset> Lif<$number, R> {
            /// Makes a neuron that fires above `threshold`, and whose potential is multiplied by `decay` in each step.
            ///
            /// # Panics
            /// Panics if a parameter is out of its range; at compile time where it initialises a constant.
            pub const fn $new(decay: $factor, threshold: $number) -> Self {
                unwrap(Self::$try_new(decay, threshold))
            }

            /// Makes a neuron that fires above `threshold`, and whose potential is multiplied by `decay` in each step.
            ///
            /// # Errors
            /// Returns an error if a parameter is out of its range.
            pub const fn $try_new(
                decay: $factor,
                threshold: $number,
            ) -> Result<Self, ParameterError> {
                let reset = if R::SUBTRACTS { threshold } else { $zero };
                match ($share(decay), $check("threshold", threshold)) {
                    (Err(error), _) | (_, Err(error)) => Err(error),
                    (Ok(decay), _) => Ok(Self { decay, bias: $zero, threshold, reset, rule: PhantomData }),
                }
            }

            /// Makes the neuron fire at the threshold too (`>=`), as in `SpikingJelly`.
            #[must_use]
            pub const fn at_threshold(mut self) -> Self {
                self.threshold = $below(self.threshold);
                self
            }

            /// Sets the bias, a constant that is added to the inputs in every step; 0 by default.
            ///
            /// # Errors
            /// Returns an error if it is out of its range.
            pub const fn try_with_bias(mut self, bias: $number) -> Result<Self, ParameterError> {
                match $check("bias", bias) {
                    Ok(bias) => self.bias = bias,
                    Err(error) => return Err(error),
                }
                Ok(self)
            }

            /// Sets the bias, a constant that is added to the inputs in every step; 0 by default.
            ///
            /// # Panics
            /// Panics if it is out of its range; at compile time where it initialises a constant.
            #[must_use]
            pub const fn with_bias(self, bias: $number) -> Self {
                unwrap(self.try_with_bias(bias))
            }

            const fn returning(mut self, reset: $number) -> Self {
                self.reset = unwrap($check("reset", reset));
                self
            }
        }

        constructors!(@returning $number, ToValue, "Sets the potential to which it returns when it fires, 0 by default.");
        constructors!(@returning $number, ToValueLate, "Sets the potential to which it returns after it has fired, 0 by default.");
        constructors!(@returning $number, ToValueHeld, "Sets the potential at which it is held after it has fired, 0 by default.");
        constructors!(@returning $number, Subtract, "Sets the number that a spike subtracts, the threshold by default.");
        constructors!(@returning $number, SubtractLate, "Sets the number that a spike subtracts, the threshold by default.");
        constructors!(@returning $number, SubtractNoDelay, "Sets the number that a spike subtracts, the threshold by default.");

        impl Li<$number> {
            /// Makes an integrator whose potential is multiplied by `decay` in each step.
            ///
            /// # Panics
            /// Panics if it is out of its range; at compile time where it initialises a constant.
            pub const fn $new(decay: $factor) -> Self {
                unwrap(Self::$try_new(decay))
            }

            /// Makes an integrator whose potential is multiplied by `decay` in each step.
            ///
            /// # Errors
            /// Returns an error if it is out of its range.
            pub const fn $try_new(decay: $factor) -> Result<Self, ParameterError> {
                match $share(decay) {
                    Ok(decay) => Ok(Self { decay, bias: $zero }),
                    Err(error) => Err(error),
                }
            }

            /// Sets the bias, a constant that is added to the inputs in every step; 0 by default.
            ///
            /// # Panics
            /// Panics if it is out of its range; at compile time where it initialises a constant.
            #[must_use]
            pub const fn with_bias(mut self, bias: $number) -> Self {
                self.bias = unwrap($check("bias", bias));
                self
            }
        }

        impl<N: Neuron<Value = $number>> Cuba<$number, N> {
            /// Puts a current before a neuron; the current is multiplied by `decay` in each step. The neuron's own bias
            /// is added after the current.
            ///
            /// # Panics
            /// Panics if it is out of its range; at compile time where it initialises a constant.
            pub const fn $new(decay: $factor, neuron: N) -> Self {
                unwrap(Self::$try_new(decay, neuron))
            }

            /// Puts a current before a neuron; the current is multiplied by `decay` in each step.
            ///
            /// # Errors
            /// Returns an error if it is out of its range.
            pub const fn $try_new(decay: $factor, neuron: N) -> Result<Self, ParameterError> {
                match $share(decay) {
                    Ok(decay) => Ok(Self { decay, bias: $zero, neuron }),
                    Err(error) => Err(error),
                }
            }

            /// Sets a constant that is added to the current in every step; 0 by default.
            ///
            /// # Panics
            /// Panics if it is out of its range; at compile time where it initialises a constant.
            #[must_use]
            pub const fn with_bias(mut self, bias: $number) -> Self {
                self.bias = unwrap($check("bias", bias));
                self
            }
        }
    };
}

constructors!(new, try_new, f32, f32, share, float, float_below, 0.0);
constructors!(integer, try_integer, i32, u32, part, whole, whole_below, 0);
