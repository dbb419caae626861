//! What a spike does to its neuron's potential.

use crate::number::Number;
use crate::sealed::Sealed;
use core::fmt::Debug;

/// The rule by which a neuron fires and is reset. The file of a network does not contain it: choose that of the
/// framework in which the network was trained.
///
/// | rule | framework |
/// |---|---|
/// | [`ToValue`] | Norse, `SpikingJelly`, snnTorch's reader of NIR |
/// | [`ToValueLate`] | snnTorch's `Leaky` with `reset_mechanism="zero"` |
/// | [`ToValueHeld`] | snnTorch's `RLeaky`, `Synaptic` and `RSynaptic` with `reset_mechanism="zero"` |
/// | [`Subtract`] | Sinabs, Rockpool, `SpikingJelly` with a soft reset |
/// | [`SubtractLate`] | snnTorch |
/// | [`SubtractNoDelay`] | snnTorch with `reset_delay=False` |
/// | [`NoReset`] | snnTorch with `reset_mechanism="none"` |
pub trait Reset: Copy + Debug + Sealed + 'static {
    /// Whether a spike subtracts the threshold, rather than setting the potential.
    #[doc(hidden)]
    const SUBTRACTS: bool;

    /// Integrates the potential of the step before, and returns whether the neuron fires. Leaves the potential from
    /// which the next step continues.
    #[doc(hidden)]
    fn fire<V: Number>(
        potential: &mut V,
        integrate: impl FnOnce(V) -> V,
        threshold: V,
        reset: V,
    ) -> bool;
}

/// Sets a neuron that fires to a value, by default 0, in the same step.
#[derive(Clone, Copy, Debug)]
pub struct ToValue;

/// Lets a neuron that fires keep its potential, and starts the next step from a value, by default 0.
#[derive(Clone, Copy, Debug)]
pub struct ToValueLate;

/// Lets a neuron that fires keep its potential, and holds it at a value, by default 0, through the next step, whatever
/// its inputs.
#[derive(Clone, Copy, Debug)]
pub struct ToValueHeld;

/// Subtracts the threshold of a neuron that fires, in the same step.
#[derive(Clone, Copy, Debug)]
pub struct Subtract;

/// Lets a neuron that fires keep its potential, and subtracts the threshold in the next step, after decay and input.
#[derive(Clone, Copy, Debug)]
pub struct SubtractLate;

/// Subtracts the threshold in the same step, as snnTorch does with `reset_delay=False`. A neuron whose last potential
/// was above the threshold fires again only if its new potential minus the threshold is above the threshold.
#[derive(Clone, Copy, Debug)]
pub struct SubtractNoDelay;

/// Leaves the potential of a neuron that fires as it is.
#[derive(Clone, Copy, Debug)]
pub struct NoReset;

impl Sealed for ToValue {}
impl Sealed for ToValueLate {}
impl Sealed for ToValueHeld {}
impl Sealed for Subtract {}
impl Sealed for SubtractLate {}
impl Sealed for SubtractNoDelay {}
impl Sealed for NoReset {}

impl Reset for ToValue {
    const SUBTRACTS: bool = false;

    #[inline(always)]
    fn fire<V: Number>(v: &mut V, integrate: impl FnOnce(V) -> V, threshold: V, reset: V) -> bool {
        let integrated = integrate(*v);
        let fires = integrated > threshold;
        *v = if fires { reset } else { integrated };
        fires
    }
}

impl Reset for ToValueLate {
    const SUBTRACTS: bool = false;

    #[inline(always)]
    fn fire<V: Number>(v: &mut V, integrate: impl FnOnce(V) -> V, threshold: V, reset: V) -> bool {
        *v = integrate(if *v > threshold { reset } else { *v });
        *v > threshold
    }
}

impl Reset for ToValueHeld {
    const SUBTRACTS: bool = false;

    #[inline(always)]
    fn fire<V: Number>(v: &mut V, integrate: impl FnOnce(V) -> V, threshold: V, reset: V) -> bool {
        *v = if *v > threshold { reset } else { integrate(*v) };
        *v > threshold
    }
}

impl Reset for Subtract {
    const SUBTRACTS: bool = true;

    #[inline(always)]
    fn fire<V: Number>(v: &mut V, integrate: impl FnOnce(V) -> V, threshold: V, reset: V) -> bool {
        let integrated = integrate(*v);
        let fires = integrated > threshold;
        *v = if fires { integrated.minus(reset) } else { integrated };
        fires
    }
}

impl Reset for SubtractLate {
    const SUBTRACTS: bool = true;

    #[inline(always)]
    fn fire<V: Number>(v: &mut V, integrate: impl FnOnce(V) -> V, threshold: V, reset: V) -> bool {
        let integrated = integrate(*v);
        *v = if *v > threshold { integrated.minus(reset) } else { integrated };
        *v > threshold
    }
}

impl Reset for SubtractNoDelay {
    const SUBTRACTS: bool = true;

    #[inline(always)]
    fn fire<V: Number>(v: &mut V, integrate: impl FnOnce(V) -> V, threshold: V, reset: V) -> bool {
        let integrated = integrate(*v);
        let less = integrated.minus(reset);
        let fires = (if *v > threshold { less } else { integrated }) > threshold;
        *v = if fires { less } else { integrated };
        fires
    }
}

impl Reset for NoReset {
    const SUBTRACTS: bool = false;

    #[inline(always)]
    fn fire<V: Number>(v: &mut V, integrate: impl FnOnce(V) -> V, threshold: V, _reset: V) -> bool {
        *v = integrate(*v);
        *v > threshold
    }
}
