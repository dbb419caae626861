//! A layer: weights, neurons, and what leads back.

use crate::chain::{Network, State, Then};
use crate::input::{Input, Spiking, Values};
use crate::neuron::Neuron;
use crate::number::{Number, OUTSIDE};
use crate::recurrence::{Forward, Recurrence};
use crate::spikes::Spikes;
use crate::weights::Weights;
use core::fmt::Debug;

/// `OUT` neurons and the weights that lead to them from `IN` inputs: references to data in flash.
///
/// - **Order of additions:** a neuron's bias, then the weights of the inputs in the order of the list (or of values in
///   the order of the inputs), then those of the neurons of the layer that fired in the step before, by rising number. Each
///   addition and product is rounded by itself.
/// - **Work:** a step adds a row for each spike, 16 neurons at a time, and visits each neuron once.
/// - **Memory:** potentials, currents, and two bytes a neuron for a list of spikes; twice that if spikes lead back.
#[derive(Clone, Copy, Debug)]
pub struct Layer<'a, N: Neuron, const IN: usize, const OUT: usize, I = Spiking, R = Forward> {
    weights: &'a Weights<N::Value, IN, OUT>,
    neurons: &'a [N; OUT],
    recurrence: R,
    input: I,
}

/// The state of a layer: what it keeps from step to step.
#[derive(Clone, Copy, Debug)]
pub struct LayerState<V, C, B, const OUT: usize> {
    potentials: [V; OUT],
    currents: [C; OUT],
    spikes: Spikes<OUT>,
    before: B,
    rejected: u32,
    saturated: u32,
}

impl<'a, N: Neuron, const IN: usize, const OUT: usize> Layer<'a, N, IN, OUT> {
    /// A layer that takes spikes.
    pub const fn new(weights: &'a Weights<N::Value, IN, OUT>, neurons: &'a [N; OUT]) -> Self {
        const { assert!(OUT >= 1 && OUT <= 1 << 16, "numbers of neurons have 16 bits") };
        Self { weights, neurons, recurrence: Forward, input: Spiking }
    }

    /// Makes the layer take values: a number for each input, and not spikes.
    pub const fn of_values(self) -> Layer<'a, N, IN, OUT, Values> {
        let Self { weights, neurons, .. } = self;
        Layer { weights, neurons, recurrence: Forward, input: Values }
    }
}

impl<'a, N: Neuron, const IN: usize, const OUT: usize, I: Copy> Layer<'a, N, IN, OUT, I> {
    /// Leads the layer's spikes back to it, a step later: [`Full`](crate::Full) or [`OneToOne`](crate::OneToOne).
    pub const fn recurrent<R: Copy>(self, recurrence: R) -> Layer<'a, N, IN, OUT, I, R> {
        let Self { weights, neurons, input, .. } = self;
        Layer { weights, neurons, recurrence, input }
    }
}

impl<N: Neuron, const IN: usize, const OUT: usize, I, R> Layer<'_, N, IN, OUT, I, R>
where
    Self: Network,
{
    /// A network of this layer and, behind it, another.
    pub const fn then<B: Network<Input = [u16]>>(self, next: B) -> Then<Self, B> {
        Then::new(self, next)
    }
}

impl<N, const IN: usize, const OUT: usize, I, R> Network for Layer<'_, N, IN, OUT, I, R>
where
    N: Neuron,
    I: Input<N::Value>,
    R: Recurrence<N::Value, OUT>,
{
    type Input = I::Of<IN>;
    type State = LayerState<N::Value, N::Current, R::Before, OUT>;
    const INPUTS: usize = IN;
    const OUTPUTS: usize = OUT;

    fn state(&self) -> Self::State {
        LayerState {
            potentials: [N::Value::default(); OUT],
            currents: [N::Current::default(); OUT],
            spikes: Spikes::new(),
            before: R::START,
            rejected: 0,
            saturated: 0,
        }
    }

    fn step<'s>(&self, state: &'s mut Self::State, input: &I::Of<IN>) -> &'s [u16] {
        let LayerState { potentials, currents, spikes, before, rejected, saturated } = state;
        let input = I::check(input, rejected);
        R::begin(before, spikes.as_slice());
        spikes.clear();
        let mut step = Step { layer: self, input, before, spikes, saturated };

        let (potentials, last_potentials) = potentials.as_chunks_mut();
        let (currents, last_currents) = currents.as_chunks_mut();
        let (neurons, last_neurons) = self.neurons.as_chunks();
        let (blocks, fours) = potentials.as_chunks_mut();
        let (current_blocks, current_fours) = currents.as_chunks_mut();
        let (neuron_blocks, neuron_fours) = neurons.as_chunks();
        step.blocks::<BLOCK>(0, blocks, current_blocks, neuron_blocks);
        let first = OUT / (4 * BLOCK) * BLOCK;
        let ((fours, _), (current_fours, _), (neuron_fours, _)) =
            (fours.as_chunks_mut(), current_fours.as_chunks_mut(), neuron_fours.as_chunks());
        step.blocks::<1>(first, fours, current_fours, neuron_fours);
        let ones = last_potentials.iter_mut().zip(last_currents).zip(last_neurons);
        let mut number = OUT / 4 * 4;
        for ((v, current), neuron) in ones {
            step.one(number, v, current, neuron);
            // Not `enumerate`, which panics where overflow is checked.
            number = number.wrapping_add(1);
        }
        spikes.as_slice()
    }
}

/// Fours of neurons that are summed at once over all spikes of a step. A Cortex-M0 has few registers; it is known by its
/// lack of a compare-and-swap. No bit depends on it.
const BLOCK: usize = if cfg!(target_has_atomic = "ptr") { 4 } else { 2 };

/// A step of a layer.
struct Step<'s, L, I, B, const OUT: usize> {
    layer: L,
    input: I,
    before: &'s B,
    spikes: &'s mut Spikes<OUT>,
    saturated: &'s mut u32,
}

impl<N, I, R, const IN: usize, const OUT: usize>
    Step<'_, &Layer<'_, N, IN, OUT, I, R>, I::Checked<'_, IN>, R::Before, OUT>
where
    N: Neuron,
    I: Input<N::Value>,
    R: Recurrence<N::Value, OUT>,
{
    /// Steps blocks of `W` fours of neurons, the first of them being the `first` four.
    #[inline(always)]
    fn blocks<const W: usize>(
        &mut self,
        mut first: usize,
        potentials: &mut [[[N::Value; 4]; W]],
        currents: &mut [[[N::Current; 4]; W]],
        neurons: &[[[N; 4]; W]],
    ) {
        let blocks = potentials.iter_mut().zip(currents).zip(neurons);
        for ((potentials, currents), neurons) in blocks {
            let Weights { rows, shift } = self.layer.weights;
            let mut sums = [[N::Value::default(); 4]; W];
            for (sum, neuron) in sums.as_flattened_mut().iter_mut().zip(neurons.as_flattened()) {
                *sum = neuron.bias();
            }
            I::add(rows, *shift, self.input, first, &mut sums);
            self.layer.recurrence.add(self.before, first, &mut sums);

            let (mut outside, mut number) = (0, first.wrapping_mul(4) as u16);
            let all = potentials.as_flattened_mut().iter_mut().zip(currents.as_flattened_mut());
            let all = all.zip(neurons.as_flattened()).zip(sums.as_flattened());
            for (((v, current), neuron), sum) in all {
                if neuron.step(v, current, *sum) && N::FIRES {
                    self.spikes.append(number);
                }
                outside |= v.outside() | N::outside(current);
                number = number.wrapping_add(1);
            }
            if outside > OUTSIDE {
                let count = clamp::<N>(potentials.as_flattened_mut(), currents.as_flattened_mut());
                *self.saturated = self.saturated.saturating_add(count);
            }
            first = first.wrapping_add(W);
        }
    }

    /// Steps one neuron.
    #[inline(always)]
    fn one(&mut self, number: usize, v: &mut N::Value, current: &mut N::Current, neuron: &N) {
        let Weights { rows, shift } = self.layer.weights;
        let mut sum = neuron.bias();
        I::add_to_one(rows, *shift, self.input, number, &mut sum);
        self.layer.recurrence.add_to_one(self.before, number, &mut sum);
        if neuron.step(v, current, sum) && N::FIRES {
            self.spikes.append(number as u16);
        }
        let count = v.clamp().wrapping_add(N::clamp(current));
        *self.saturated = self.saturated.saturating_add(count);
    }
}

/// Brings potentials and currents into their range, and returns how many were outside.
#[cold]
fn clamp<N: Neuron>(potentials: &mut [N::Value], currents: &mut [N::Current]) -> u32 {
    let potentials = potentials.iter_mut().map(Number::clamp);
    potentials.chain(currents.iter_mut().map(N::clamp)).fold(0, u32::saturating_add)
}

impl<V: Number, C: Copy + Debug, B: Copy + Debug, const OUT: usize> State
    for LayerState<V, C, B, OUT>
{
    type Value = V;

    fn spikes(&self) -> &[u16] {
        self.spikes.as_slice()
    }

    fn values(&self) -> &[V] {
        &self.potentials
    }

    fn rejected(&self) -> u32 {
        self.rejected
    }

    fn saturated(&self) -> u32 {
        self.saturated
    }
}

impl<V, C, B, const OUT: usize> LayerState<V, C, B, OUT> {
    /// Returns the neurons' currents; of neurons without, nothing.
    pub fn currents(&self) -> &[C; OUT] {
        &self.currents
    }
}
