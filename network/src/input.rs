//! What a layer takes: spikes or values.

use crate::number::Number;
use crate::sealed::Sealed;
use crate::weights::Weights;
use core::{fmt::Debug, hint::black_box, slice};
use heapless::Vec;

/// What a layer takes in a step.
pub trait Input<V: Number>: Copy + Debug + Sealed + 'static {
    /// The input of a step.
    type Of<const IN: usize>: ?Sized;
    /// The same, checked: by default nothing, to be filled in place.
    #[doc(hidden)]
    type Checked<'a, const IN: usize, const OUT: usize>: Default;

    #[doc(hidden)]
    fn check<'a, const IN: usize, const OUT: usize>(
        weights: &'a Weights<V, IN, OUT>,
        input: &'a Self::Of<IN>,
        checked: &mut Self::Checked<'a, IN, OUT>,
        rejected: &mut u32,
    );

    #[doc(hidden)]
    fn add<const W: usize, const IN: usize, const OUT: usize>(
        weights: &Weights<V, IN, OUT>,
        checked: &Self::Checked<'_, IN, OUT>,
        first: usize,
        sums: &mut [[V; 4]; W],
    );

    #[doc(hidden)]
    fn add_to_one<const IN: usize, const OUT: usize>(
        weights: &Weights<V, IN, OUT>,
        checked: &Self::Checked<'_, IN, OUT>,
        neuron: usize,
        sum: &mut V,
    );
}

/// Spikes: the numbers of the inputs that fired. An input that is named twice counts twice.
#[derive(Clone, Copy, Debug)]
pub struct Spiking;

/// Values, a number for each input: a first layer that takes measurements as they are. All weights are multiplied.
#[derive(Clone, Copy, Debug)]
pub struct Values;

impl Sealed for Spiking {}
impl Sealed for Values {}

/// The rows of weights of the inputs that fired: looked up once a step, and not once for each block of neurons.
#[derive(Debug)]
pub struct Fired<'a, V: Number, const IN: usize, const OUT: usize> {
    rows: Vec<&'a V::Row<OUT>, IN>,
    /// Spikes beyond as many as there are inputs, some of which are named several times.
    rest: &'a [u16],
}

impl<V: Number, const IN: usize, const OUT: usize> Default for Fired<'_, V, IN, OUT> {
    #[inline(always)]
    fn default() -> Self {
        Self { rows: Vec::new(), rest: &[] }
    }
}

impl<'a, V: Number, const IN: usize, const OUT: usize> Fired<'a, V, IN, OUT> {
    /// Looks up the row of an input, and returns 1 if it has none.
    #[inline(always)]
    pub(crate) fn push(&mut self, weights: &'a Weights<V, IN, OUT>, spike: u16) -> u32 {
        let row = weights.rows.get(usize::from(spike));
        if let Some(row) = row {
            _ = self.rows.push(row);
        }
        black_box(()); // keeps the compiler from unrolling loops of this
        row.is_none().into()
    }

    #[inline(always)]
    pub(crate) fn add<const W: usize>(
        &self,
        weights: &Weights<V, IN, OUT>,
        first: usize,
        sums: &mut [[V; 4]; W],
    ) {
        V::add_rows(&self.rows, weights.shift, first, sums);
        if !self.rest.is_empty() {
            // A copy, so that the sums have no address and stay in registers.
            let mut copy = *sums;
            self.add_rest(weights, first.wrapping_mul(4), copy.as_flattened_mut());
            *sums = copy;
        }
    }

    #[inline(always)]
    pub(crate) fn add_to_one(&self, weights: &Weights<V, IN, OUT>, neuron: usize, sum: &mut V) {
        V::add_rows_to_one(&self.rows, weights.shift, neuron, sum);
        if !self.rest.is_empty() {
            self.add_rest(weights, neuron, slice::from_mut(sum));
        }
    }

    #[cold]
    #[inline(never)]
    fn add_rest(&self, weights: &Weights<V, IN, OUT>, first: usize, sums: &mut [V]) {
        for row in self.rest.iter().filter_map(|&spike| weights.rows.get(usize::from(spike))) {
            for (sum, neuron) in sums.iter_mut().zip(first..) {
                V::add_rows_to_one(&[row], weights.shift, neuron, sum);
            }
        }
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
    fn add<const W: usize, const IN: usize, const OUT: usize>(
        weights: &Weights<V, IN, OUT>,
        checked: &Fired<'_, V, IN, OUT>,
        first: usize,
        sums: &mut [[V; 4]; W],
    ) {
        checked.add(weights, first, sums);
    }

    #[inline(always)]
    fn add_to_one<const IN: usize, const OUT: usize>(
        weights: &Weights<V, IN, OUT>,
        checked: &Fired<'_, V, IN, OUT>,
        neuron: usize,
        sum: &mut V,
    ) {
        checked.add_to_one(weights, neuron, sum);
    }
}

/// Values of which those that are not accepted are 0.
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
    fn add<const W: usize, const IN: usize, const OUT: usize>(
        weights: &Weights<V, IN, OUT>,
        Accepted(values): &Accepted<V::Value, IN>,
        first: usize,
        sums: &mut [[V; 4]; W],
    ) {
        const {
            assert!(
                IN <= 128,
                "a layer takes 128 values at most, so that sums of them fit 32 bits"
            );
        };
        V::add_values(&weights.rows, weights.shift, values, first, sums);
    }

    #[inline(always)]
    fn add_to_one<const IN: usize, const OUT: usize>(
        weights: &Weights<V, IN, OUT>,
        Accepted(values): &Accepted<V::Value, IN>,
        neuron: usize,
        sum: &mut V,
    ) {
        V::add_values_to_one(&weights.rows, weights.shift, values, neuron, sum);
    }
}
