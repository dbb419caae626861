//! What leads a layer's spikes back to it, a step later.

use crate::input::Fired;
use crate::number::Number;
use crate::sealed::Sealed;
use crate::spikes::Spikes;
use crate::weights::Weights;
use core::fmt::Debug;

/// What a layer's spikes of the step before add to its neurons.
pub trait Recurrence<V: Number, const OUT: usize>: Copy + Debug + Sealed {
    /// What is known of the step before: by default nothing, to be filled in place.
    #[doc(hidden)]
    type Before<'a>: Default
    where
        Self: 'a;

    #[doc(hidden)]
    fn begin<'a>(&'a self, fired: &Spikes<OUT>, before: &mut Self::Before<'a>);

    #[doc(hidden)]
    fn add<const W: usize>(
        &self,
        before: &Self::Before<'_>,
        first: usize,
        sums: &mut [[V; 4]; W],
    );

    #[doc(hidden)]
    fn add_to_one(&self, before: &Self::Before<'_>, neuron: usize, sum: &mut V);
}

/// Nothing leads back.
#[derive(Clone, Copy, Debug)]
pub struct Forward;

/// Every neuron leads back to every neuron.
#[derive(Clone, Copy, Debug)]
pub struct Full<'a, V: Number, const OUT: usize>(pub &'a Weights<V, OUT, OUT>);

/// Every neuron leads back to itself alone, with this weight.
#[derive(Clone, Copy, Debug)]
pub struct OneToOne<'a, V: Number, const OUT: usize>(pub &'a Weights<V, 1, OUT>);

impl Sealed for Forward {}
impl<V: Number, const OUT: usize> Sealed for Full<'_, V, OUT> {}
impl<V: Number, const OUT: usize> Sealed for OneToOne<'_, V, OUT> {}

impl<V: Number, const OUT: usize> Recurrence<V, OUT> for Forward {
    type Before<'a> = ();

    #[inline(always)]
    fn begin(&self, _fired: &Spikes<OUT>, (): &mut ()) {}

    #[inline(always)]
    fn add<const W: usize>(&self, (): &(), _first: usize, _sums: &mut [[V; 4]; W]) {}

    #[inline(always)]
    fn add_to_one(&self, (): &(), _neuron: usize, _sum: &mut V) {}
}

impl<V: Number, const OUT: usize> Recurrence<V, OUT> for Full<'_, V, OUT> {
    type Before<'a>
        = Fired<'a, V, OUT, OUT>
    where
        Self: 'a;

    #[inline(always)]
    fn begin<'a>(&'a self, fired: &Spikes<OUT>, before: &mut Fired<'a, V, OUT, OUT>) {
        for &neuron in fired.as_slice() {
            before.push(self.0, neuron);
        }
    }

    #[inline(always)]
    fn add<const W: usize>(
        &self,
        before: &Fired<'_, V, OUT, OUT>,
        first: usize,
        sums: &mut [[V; 4]; W],
    ) {
        before.add(self.0, first, sums);
    }

    #[inline(always)]
    fn add_to_one(&self, before: &Fired<'_, V, OUT, OUT>, neuron: usize, sum: &mut V) {
        before.add_to_one(self.0, neuron, sum);
    }
}

impl<V: Number, const OUT: usize> Recurrence<V, OUT> for OneToOne<'_, V, OUT> {
    type Before<'a>
        = Spikes<OUT>
    where
        Self: 'a;

    #[inline(always)]
    fn begin<'a>(&'a self, fired: &Spikes<OUT>, before: &mut Spikes<OUT>) {
        for &neuron in fired.as_slice() {
            before.append(neuron);
        }
    }

    #[inline(always)]
    fn add<const W: usize>(&self, before: &Spikes<OUT>, first: usize, sums: &mut [[V; 4]; W]) {
        for (sum, neuron) in sums.as_flattened_mut().iter_mut().zip(first.wrapping_mul(4)..) {
            self.add_to_one(before, neuron, sum);
        }
    }

    #[inline(always)]
    fn add_to_one(&self, before: &Spikes<OUT>, neuron: usize, sum: &mut V) {
        let Weights { rows: [row], shift } = self.0;
        if before.as_slice().binary_search(&(neuron as u16)).is_ok() {
            V::add_rows_to_one(&[row], *shift, neuron, sum);
        }
    }
}
