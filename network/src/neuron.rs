//! Neurons: one form for all of them.
//!
//! `I = a I + (x + bias)` with a current only, then `u = b v + (I + bias)` or `u = b v + (x + bias)`, then the
//! [rule](crate::Reset) by which `u` fires. `x` is the sum of the weights of what came in. Gains (`R dt / tau`, `w_in`)
//! belong in the weights and biases, a leak to another value than 0 (`v_leak dt / tau`) in the bias.

use crate::error::{ParameterError, unwrap};
use crate::integer;
use crate::number::{self, Number};
use crate::reset::{Reset, ToValue, ToValueHeld, ToValueLate};
use crate::sealed::Sealed;
use core::{fmt::Debug, marker::PhantomData};

/// A neuron's parameters, which may lie in flash.
pub trait Neuron: Copy + Debug + Sealed + 'static {
    /// The type of its potential.
    type Value: Number;
    /// Its current: nothing, unless inputs last longer than a step.
    type Current: Copy + Default + Debug;

    /// Whether it ever fires.
    #[doc(hidden)]
    const FIRES: bool;
    /// What is added to its inputs in every step.
    #[doc(hidden)]
    fn bias(&self) -> Self::Value;
    /// Takes a step with the sum of its inputs and bias, and tells if it fires.
    #[doc(hidden)]
    fn step(&self, v: &mut Self::Value, current: &mut Self::Current, input: Self::Value) -> bool;
    /// A number above [`number::OUTSIDE`] if the current has left its range.
    #[doc(hidden)]
    fn outside(current: &Self::Current) -> u32;
    /// Brings the current into its range, and returns 1 if it was outside.
    #[doc(hidden)]
    fn clamp(current: &mut Self::Current) -> u32;
}

/// A leaky neuron that fires (LIF); with a decay of 1 a perfect integrator (IF).
#[derive(Clone, Copy, Debug)]
pub struct Lif<V: Number, R> {
    decay: V::Factor,
    bias: V,
    threshold: V,
    reset: V,
    rule: PhantomData<R>,
}

/// A leaky integrator that never fires (LI), whose potential is read; with a decay of 1 a sum over all steps (I), with 0
/// the sum of this step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Li<V: Number> {
    decay: V::Factor,
    bias: V,
}

/// A neuron whose inputs are a current that decays by itself: `CubaLIF` with [`Lif`], `CubaLI` with [`Li`]. `OLD` ones
/// take the current of the step before.
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

/// Checks a decay in parts of 65 536, and returns it as products take it.
const fn part(value: u32) -> Result<u32, ParameterError> {
    if value <= integer::ONE {
        Ok(value << integer::DECAY_SHIFT)
    } else {
        let (value, max) = (value as f32, integer::ONE as f32);
        Err(ParameterError { parameter: "decay", place: (0, 0), value, min: 0.0, max })
    }
}

/// The largest number below.
const fn float_below(value: f32) -> f32 {
    value.next_down()
}

/// The largest number below.
const fn whole_below(value: i32) -> i32 {
    value.saturating_sub(1)
}

/// Constructors, which are `const` and so cannot be generic over the number.
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
            /// A neuron that fires above `threshold` and keeps the share `decay` of its potential in a step.
            ///
            /// # Panics
            /// Panics if a parameter is out of its range; at compile time where it initialises a constant.
            pub const fn $new(decay: $factor, threshold: $number) -> Self {
                unwrap(Self::$try_new(decay, threshold))
            }

            /// A neuron that fires above `threshold` and keeps the share `decay` of its potential in a step.
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

            /// Makes it fire at the threshold already (`>=`), as in `SpikingJelly`.
            #[must_use]
            pub const fn at_threshold(mut self) -> Self {
                self.threshold = $below(self.threshold);
                self
            }

            /// Sets what is added to the inputs in every step, 0 by default.
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

            /// Sets what is added to the inputs in every step, 0 by default.
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

        impl Li<$number> {
            /// An integrator that keeps the share `decay` of its potential in a step.
            ///
            /// # Panics
            /// Panics if it is out of its range; at compile time where it initialises a constant.
            pub const fn $new(decay: $factor) -> Self {
                unwrap(Self::$try_new(decay))
            }

            /// An integrator that keeps the share `decay` of its potential in a step.
            ///
            /// # Errors
            /// Returns an error if it is out of its range.
            pub const fn $try_new(decay: $factor) -> Result<Self, ParameterError> {
                match $share(decay) {
                    Ok(decay) => Ok(Self { decay, bias: $zero }),
                    Err(error) => Err(error),
                }
            }

            /// Sets what is added to the inputs in every step, 0 by default.
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
            /// A neuron behind a current that keeps the share `decay` of itself in a step. The neuron's own bias is added
            /// behind the current.
            ///
            /// # Panics
            /// Panics if it is out of its range; at compile time where it initialises a constant.
            pub const fn $new(decay: $factor, neuron: N) -> Self {
                unwrap(Self::$try_new(decay, neuron))
            }

            /// A neuron behind a current that keeps the share `decay` of itself in a step.
            ///
            /// # Errors
            /// Returns an error if it is out of its range.
            pub const fn $try_new(decay: $factor, neuron: N) -> Result<Self, ParameterError> {
                match $share(decay) {
                    Ok(decay) => Ok(Self { decay, bias: $zero, neuron }),
                    Err(error) => Err(error),
                }
            }

            /// Sets what is added to the current in every step, 0 by default.
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
