//! The recurrence of a layer: how its spikes act on it in the next step.

use crate::checksum::Checksum;
use crate::input::Fired;
use crate::number::Number;
use crate::sealed::Sealed;
use crate::spikes::Spikes;
use crate::weights::Weights;
use core::{fmt::Debug, hint::black_box};

/// The weights by which a layer's spikes act on its neurons in the next step.
pub trait Recurrence<V: Number, const OUT: usize>: Copy + Debug + Sealed {
    /// The spikes of the step before. It is created empty, and filled in place.
    #[doc(hidden)]
    type Before<'a>: Default
    where
        Self: 'a;

    #[doc(hidden)]
    fn begin<'a>(&'a self, fired: &Spikes<OUT>, before: &mut Self::Before<'a>);

    /// Returns the weights' rows of the neurons that fired, and their scale.
    #[doc(hidden)]
    fn fired<'c>(&'c self, before: &'c Self::Before<'_>) -> (&'c [&'c V::Row<OUT>], V::Scale);

    /// Adds to a neuron's sum the weight that leads from it to itself, if it fired.
    #[doc(hidden)]
    #[inline(always)]
    fn add_own(&self, _before: &Self::Before<'_>, _neuron: usize, _sum: &mut V) {}

    /// Adds the weights to a checksum.
    #[doc(hidden)]
    fn add_to(&self, _sum: &mut Checksum) {}

    /// Whether `add_own` has an effect.
    #[doc(hidden)]
    const HAS_OWN: bool = false;
}

/// No recurrence.
#[derive(Clone, Copy, Debug)]
pub struct Forward;

/// Weights from every neuron to every neuron.
#[derive(Clone, Copy, Debug)]
pub struct Full<'a, V: Number, const OUT: usize>(pub &'a Weights<V, OUT, OUT>);

/// A weight from every neuron to itself only.
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

    fn add_to(&self, sum: &mut Checksum) {
        black_box(self.0).add_to(sum);
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

    fn add_to(&self, sum: &mut Checksum) {
        black_box(self.0).add_to(sum);
    }

    #[inline(always)]
    fn add_own(&self, before: &Spikes<OUT>, neuron: usize, sum: &mut V) {
        let Weights { rows: [row], scale } = self.0;
        if before.as_slice().binary_search(&(neuron as u16)).is_ok() {
            V::add_rows_to_one(&[row], *scale, neuron, sum);
        }
    }
}
