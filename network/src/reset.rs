//! What a spike does to its neuron.

use crate::number::Number;
use crate::sealed::Sealed;
use core::fmt::Debug;

/// The rule by which a neuron fires and returns. A file of a network does not tell it: take that of the framework in
/// which the network was trained.
///
/// | rule | of |
/// |---|---|
/// | [`ToValue`] | Norse, `SpikingJelly`, snnTorch's reader of NIR |
/// | [`ToValueLate`] | snnTorch's `Leaky` with `reset_mechanism="zero"` |
/// | [`ToValueHeld`] | its `RLeaky`, `Synaptic` and `RSynaptic` with that |
/// | [`Subtract`] | Sinabs, Rockpool, `SpikingJelly` with a soft reset |
/// | [`SubtractLate`] | snnTorch |
/// | [`SubtractNoDelay`] | snnTorch with `reset_delay=False` |
pub trait Reset: Copy + Debug + Sealed + 'static {
    /// Whether a spike subtracts the threshold, rather than set the potential.
    #[doc(hidden)]
    const SUBTRACTS: bool;

    /// Integrates the potential of the step before, tells if the neuron fires, and leaves what the next step goes on from.
    #[doc(hidden)]
    fn fire<V: Number>(
        potential: &mut V,
        integrate: impl FnOnce(V) -> V,
        threshold: V,
        reset: V,
    ) -> bool;
}

/// A neuron that fires returns to a value, 0 unless told, in the same step.
#[derive(Clone, Copy, Debug)]
pub struct ToValue;

/// A neuron that fires keeps its potential, and begins the next step from a value, 0 unless told.
#[derive(Clone, Copy, Debug)]
pub struct ToValueLate;

/// A neuron that fires keeps its potential, and is at a value, 0 unless told, through the next step, whatever comes in.
#[derive(Clone, Copy, Debug)]
pub struct ToValueHeld;

/// A neuron that fires subtracts its threshold, in the same step.
#[derive(Clone, Copy, Debug)]
pub struct Subtract;

/// A neuron that fires keeps its potential, and the next step subtracts the threshold after decay and input.
#[derive(Clone, Copy, Debug)]
pub struct SubtractLate;

/// snnTorch's subtraction with `reset_delay=False`: a neuron whose last potential is above the threshold fires only if it
/// would still be above it less the threshold. One that fires subtracts its threshold in the same step.
#[derive(Clone, Copy, Debug)]
pub struct SubtractNoDelay;

impl Sealed for ToValue {}
impl Sealed for ToValueLate {}
impl Sealed for ToValueHeld {}
impl Sealed for Subtract {}
impl Sealed for SubtractLate {}
impl Sealed for SubtractNoDelay {}

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
