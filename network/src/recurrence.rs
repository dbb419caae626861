//! What leads a layer's spikes back to it, a step later.

use crate::number::Number;
use crate::sealed::Sealed;
use crate::spikes::Spikes;
use crate::weights::Weights;
use core::fmt::Debug;

/// What a layer's spikes of the step before add to its neurons.
pub trait Recurrence<V: Number, const OUT: usize>: Copy + Debug + Sealed {
    /// What is known of the step before.
    #[doc(hidden)]
    type Before: Copy + Debug;
    #[doc(hidden)]
    const START: Self::Before;

    #[doc(hidden)]
    fn begin(before: &mut Self::Before, fired: &[u16]);

    #[doc(hidden)]
    fn add<const W: usize>(&self, before: &Self::Before, first: usize, sums: &mut [[V; 4]; W]);

    #[doc(hidden)]
    fn add_to_one(&self, before: &Self::Before, neuron: usize, sum: &mut V);
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
    type Before = ();
    const START: () = ();

    #[inline(always)]
    fn begin((): &mut (), _fired: &[u16]) {}

    #[inline(always)]
    fn add<const W: usize>(&self, (): &(), _first: usize, _sums: &mut [[V; 4]; W]) {}

    #[inline(always)]
    fn add_to_one(&self, (): &(), _neuron: usize, _sum: &mut V) {}
}

impl<V: Number, const OUT: usize> Recurrence<V, OUT> for Full<'_, V, OUT> {
    type Before = Spikes<OUT>;
    const START: Spikes<OUT> = Spikes::new();

    #[inline(always)]
    fn begin(before: &mut Spikes<OUT>, fired: &[u16]) {
        copy(before, fired);
    }

    #[inline(always)]
    fn add<const W: usize>(&self, before: &Spikes<OUT>, first: usize, sums: &mut [[V; 4]; W]) {
        V::add_spikes(&self.0.rows, self.0.shift, before.as_slice(), first, sums);
    }

    #[inline(always)]
    fn add_to_one(&self, before: &Spikes<OUT>, neuron: usize, sum: &mut V) {
        V::add_spikes_to_one(&self.0.rows, self.0.shift, before.as_slice(), neuron, sum);
    }
}

impl<V: Number, const OUT: usize> Recurrence<V, OUT> for OneToOne<'_, V, OUT> {
    type Before = Spikes<OUT>;
    const START: Spikes<OUT> = Spikes::new();

    #[inline(always)]
    fn begin(before: &mut Spikes<OUT>, fired: &[u16]) {
        copy(before, fired);
    }

    #[inline(always)]
    fn add<const W: usize>(&self, before: &Spikes<OUT>, first: usize, sums: &mut [[V; 4]; W]) {
        let mut neuron = first.wrapping_mul(4);
        for sum in sums.as_flattened_mut() {
            self.add_to_one(before, neuron, sum);
            neuron = neuron.wrapping_add(1);
        }
    }

    #[inline(always)]
    fn add_to_one(&self, before: &Spikes<OUT>, neuron: usize, sum: &mut V) {
        if before.as_slice().binary_search(&(neuron as u16)).is_ok() {
            V::add_spikes_to_one(&self.0.rows, self.0.shift, &[0], neuron, sum);
        }
    }
}

#[inline(always)]
fn copy<const OUT: usize>(before: &mut Spikes<OUT>, fired: &[u16]) {
    before.clear();
    for &neuron in fired {
        before.append(neuron);
    }
}
