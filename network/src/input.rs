//! What a layer takes: spikes or values.

use crate::number::Number;
use crate::sealed::Sealed;
use core::fmt::Debug;

/// What a layer takes in a step.
pub trait Input<V: Number>: Copy + Debug + Sealed + 'static {
    /// The input of a step.
    type Of<const IN: usize>: ?Sized;
    /// The same, checked.
    #[doc(hidden)]
    type Checked<'a, const IN: usize>: Copy;

    #[doc(hidden)]
    fn check<'a, const IN: usize>(
        input: &'a Self::Of<IN>,
        rejected: &mut u32,
    ) -> Self::Checked<'a, IN>;

    #[doc(hidden)]
    fn add<const W: usize, const IN: usize, const OUT: usize>(
        rows: &[V::Row<OUT>; IN],
        shift: V::Shift,
        input: Self::Checked<'_, IN>,
        first: usize,
        sums: &mut [[V; 4]; W],
    );

    #[doc(hidden)]
    fn add_to_one<const IN: usize, const OUT: usize>(
        rows: &[V::Row<OUT>; IN],
        shift: V::Shift,
        input: Self::Checked<'_, IN>,
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

impl<V: Number> Input<V> for Spiking {
    type Of<const IN: usize> = [u16];
    type Checked<'a, const IN: usize> = &'a [u16];

    #[inline(always)]
    fn check<'a, const IN: usize>(input: &'a [u16], rejected: &mut u32) -> &'a [u16] {
        let taken = input.get(..V::MOST_SPIKES).unwrap_or(input);
        // Not `count`, which panics where overflow is checked.
        let unknown = |sum: u32, &spike: &u16| sum.wrapping_add((usize::from(spike) >= IN).into());
        let beyond = input.len().saturating_sub(taken.len()) as u32;
        *rejected = rejected.saturating_add(taken.iter().fold(beyond, unknown));
        taken
    }

    #[inline(always)]
    fn add<const W: usize, const IN: usize, const OUT: usize>(
        rows: &[V::Row<OUT>; IN],
        shift: V::Shift,
        input: &[u16],
        first: usize,
        sums: &mut [[V; 4]; W],
    ) {
        V::add_spikes(rows, shift, input, first, sums);
    }

    #[inline(always)]
    fn add_to_one<const IN: usize, const OUT: usize>(
        rows: &[V::Row<OUT>; IN],
        shift: V::Shift,
        input: &[u16],
        neuron: usize,
        sum: &mut V,
    ) {
        V::add_spikes_to_one(rows, shift, input, neuron, sum);
    }
}

impl<V: Number> Input<V> for Values {
    type Of<const IN: usize> = [V::Value; IN];
    type Checked<'a, const IN: usize> = [V::Value; IN];

    #[inline(always)]
    fn check<const IN: usize>(input: &[V::Value; IN], rejected: &mut u32) -> [V::Value; IN] {
        input.map(|value| {
            V::accept(value).unwrap_or_else(|| {
                *rejected = rejected.saturating_add(1);
                V::Value::default()
            })
        })
    }

    #[inline(always)]
    fn add<const W: usize, const IN: usize, const OUT: usize>(
        rows: &[V::Row<OUT>; IN],
        shift: V::Shift,
        input: [V::Value; IN],
        first: usize,
        sums: &mut [[V; 4]; W],
    ) {
        const {
            assert!(
                IN <= 128,
                "a layer takes 128 values at most, so that sums of them fit 32 bits"
            );
        };
        V::add_values(rows, shift, &input, first, sums);
    }

    #[inline(always)]
    fn add_to_one<const IN: usize, const OUT: usize>(
        rows: &[V::Row<OUT>; IN],
        shift: V::Shift,
        input: [V::Value; IN],
        neuron: usize,
        sum: &mut V,
    ) {
        V::add_values_to_one(rows, shift, &input, neuron, sum);
    }
}
