//! The inputs of a layer: spikes or values.

use crate::number::Number;
use crate::sealed::Sealed;
use crate::weights::Weights;
use core::{fmt::Debug, hint::black_box};
use heapless::Vec;

/// The kind of a layer's inputs.
pub trait Input<V: Number>: Copy + Debug + Sealed + 'static {
    /// The input of a step.
    type Of<const IN: usize>: ?Sized;
    /// The input of a step after it was checked. It is created empty, and filled in place.
    #[doc(hidden)]
    type Checked<'a, const IN: usize, const OUT: usize>: Default;

    #[doc(hidden)]
    fn check<'a, const IN: usize, const OUT: usize>(
        weights: &'a Weights<V, IN, OUT>,
        input: &'a Self::Of<IN>,
        checked: &mut Self::Checked<'a, IN, OUT>,
        rejected: &mut u32,
    );

    /// Returns the weights' rows of the inputs that fired, and further spikes, which are added after them.
    #[doc(hidden)]
    fn fired<'c, const IN: usize, const OUT: usize>(
        checked: &'c Self::Checked<'_, IN, OUT>,
    ) -> (&'c [&'c V::Row<OUT>], &'c [u16]);

    /// Adds weights times values to the sums of neurons, starting at neuron `first`.
    #[doc(hidden)]
    fn add_values<const IN: usize, const OUT: usize>(
        weights: &Weights<V, IN, OUT>,
        checked: &Self::Checked<'_, IN, OUT>,
        first: usize,
        sums: &mut [V],
    );
}

/// Spikes: the numbers of the inputs that fired. An input that occurs twice counts twice.
#[derive(Clone, Copy, Debug)]
pub struct Spiking;

/// Values, one for each input, for a first layer that takes measurements directly. Every weight is multiplied in each
/// step.
#[derive(Clone, Copy, Debug)]
pub struct Values;

impl Sealed for Spiking {}
impl Sealed for Values {}

/// The rows of weights of the inputs that fired, looked up once in a step rather than for each block of neurons.
#[derive(Debug)]
pub struct Fired<'a, V: Number, const IN: usize, const OUT: usize> {
    rows: Vec<&'a V::Row<OUT>, IN>,
    /// Spikes beyond the number of inputs; some inputs must have fired several times.
    rest: &'a [u16],
}

impl<V: Number, const IN: usize, const OUT: usize> Default for Fired<'_, V, IN, OUT> {
    #[inline(always)]
    fn default() -> Self {
        Self { rows: Vec::new(), rest: &[] }
    }
}

impl<'a, V: Number, const IN: usize, const OUT: usize> Fired<'a, V, IN, OUT> {
    /// Looks up the row of an input; returns 1 if it has none, or else 0.
    #[inline(always)]
    pub(crate) fn push(&mut self, weights: &'a Weights<V, IN, OUT>, spike: u16) -> u32 {
        let row = weights.rows.get(usize::from(spike));
        if let Some(row) = row {
            _ = self.rows.push(row);
        }
        row.is_none().into()
    }

    #[inline(always)]
    pub(crate) fn rows(&self) -> &[&'a V::Row<OUT>] {
        &self.rows
    }
}

impl<V: Number> Input<V> for Spiking {
    type Of<const IN: usize> = [u16];
    type Checked<'a, const IN: usize, const OUT: usize> = Fired<'a, V, IN, OUT>;

    #[inline(always)]
    fn check<'a, const IN: usize, const OUT: usize>(
        weights: &'a Weights<V, IN, OUT>,
        input: &'a [u16],
        checked: &mut Fired<'a, V, IN, OUT>,
        rejected: &mut u32,
    ) {
        let taken = input.get(..V::MOST_SPIKES).unwrap_or(input);
        let (first, rest) = taken.split_at_checked(IN).unwrap_or((taken, &[]));
        // Not `count`, which panics where overflow is checked.
        let mut unknown = input.len().saturating_sub(taken.len()) as u32;
        for &spike in first {
            unknown = unknown.wrapping_add(checked.push(weights, spike));
        }
        for &spike in rest {
            unknown = unknown.wrapping_add((usize::from(spike) >= IN).into());
            black_box(());
        }
        checked.rest = rest;
        *rejected = rejected.saturating_add(unknown);
    }

    #[inline(always)]
    fn fired<'c, const IN: usize, const OUT: usize>(
        checked: &'c Fired<'_, V, IN, OUT>,
    ) -> (&'c [&'c V::Row<OUT>], &'c [u16]) {
        (&checked.rows, checked.rest)
    }

    #[inline(always)]
    fn add_values<const IN: usize, const OUT: usize>(
        _weights: &Weights<V, IN, OUT>,
        _checked: &Fired<'_, V, IN, OUT>,
        _first: usize,
        _sums: &mut [V],
    ) {
    }
}

/// The values of a step, with 0 in place of each that is not accepted.
#[derive(Debug)]
pub struct Accepted<T, const IN: usize>([T; IN]);

impl<T: Copy + Default, const IN: usize> Default for Accepted<T, IN> {
    #[inline(always)]
    fn default() -> Self {
        Self([T::default(); IN])
    }
}

impl<V: Number> Input<V> for Values {
    type Of<const IN: usize> = [V::Value; IN];
    type Checked<'a, const IN: usize, const OUT: usize> = Accepted<V::Value, IN>;

    #[inline(always)]
    fn check<'a, const IN: usize, const OUT: usize>(
        _weights: &'a Weights<V, IN, OUT>,
        input: &'a [V::Value; IN],
        Accepted(accepted): &mut Accepted<V::Value, IN>,
        rejected: &mut u32,
    ) {
        for (accepted, &value) in accepted.iter_mut().zip(input) {
            match V::accept(value) {
                Some(value) => *accepted = value,
                None => *rejected = rejected.saturating_add(1),
            }
        }
    }

    #[inline(always)]
    fn fired<const IN: usize, const OUT: usize>(
        _checked: &Accepted<V::Value, IN>,
    ) -> (&[&V::Row<OUT>], &[u16]) {
        (&[], &[])
    }

    #[inline(always)]
    fn add_values<const IN: usize, const OUT: usize>(
        weights: &Weights<V, IN, OUT>,
        Accepted(values): &Accepted<V::Value, IN>,
        first: usize,
        sums: &mut [V],
    ) {
        V::add_values(&weights.rows, weights.scale, values, first, sums);
    }
}
