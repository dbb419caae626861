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

    /// The rows of weights of the neurons that fired.
    #[doc(hidden)]
    fn fired<'c>(&'c self, before: &'c Self::Before<'_>) -> (&'c [&'c V::Row<OUT>], V::Scale);

    /// Adds to the sum of a neuron what it leads back to itself.
    #[doc(hidden)]
    #[inline(always)]
    fn add_own(&self, _before: &Self::Before<'_>, _neuron: usize, _sum: &mut V) {}

    /// Whether `add_own` does anything.
    #[doc(hidden)]
    const HAS_OWN: bool = false;
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
    fn fired<'c>(&'c self, (): &'c ()) -> (&'c [&'c V::Row<OUT>], V::Scale) {
        (&[], V::Scale::default())
    }
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
    fn fired<'c>(
        &'c self,
        before: &'c Fired<'_, V, OUT, OUT>,
    ) -> (&'c [&'c V::Row<OUT>], V::Scale) {
        (before.rows(), self.0.scale)
    }
}

impl<V: Number, const OUT: usize> Recurrence<V, OUT> for OneToOne<'_, V, OUT> {
    const HAS_OWN: bool = true;
    type Before<'a>
        = Spikes<OUT>
    where
        Self: 'a;

    #[inline(always)]
    fn begin(&self, fired: &Spikes<OUT>, before: &mut Spikes<OUT>) {
        for &neuron in fired.as_slice() {
            before.append(neuron);
        }
    }

    #[inline(always)]
    fn fired<'c>(&'c self, _before: &'c Spikes<OUT>) -> (&'c [&'c V::Row<OUT>], V::Scale) {
        (&[], self.0.scale)
    }

    #[inline(always)]
    fn add_own(&self, before: &Spikes<OUT>, neuron: usize, sum: &mut V) {
        let Weights { rows: [row], scale } = self.0;
        if before.as_slice().binary_search(&(neuron as u16)).is_ok() {
            V::add_rows_to_one(&[row], *scale, neuron, sum);
        }
    }
}
