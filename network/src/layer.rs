//! Layers: weights, neurons and recurrence.

use crate::chain::{Network, State, Then};
use crate::checksum::Checksum;
use crate::input::{Input, Spiking, Values};
use crate::neuron::Neuron;
use crate::number::{IS_SMALL, Number, OUTSIDE};
use crate::recurrence::{Forward, Recurrence};
use crate::spikes::Spikes;
use crate::weights::Weights;
use core::{fmt::Debug, hint::black_box, slice};

/// `OUT` neurons and the weights that lead to them from `IN` inputs, as references to data in flash.
///
/// - **Order of additions:** first a neuron's bias; then the weights of the inputs, in the order of the list (or of
///   values, in the order of the inputs); then the weights of the neurons of this layer that fired in the step before, in
///   rising order. Each addition and product is rounded by itself.
/// - **Size:** a layer of values has 128 inputs at most; a layer with weights of 8 bits has 4096 inputs at most, those of
///   its own spikes included. Others fail the build where they are made.
/// - **Work:** a step adds a row for each spike, for up to 16 neurons at a time, and visits each neuron once. If there are
///   more spikes than inputs, as some inputs fire several times, the additional ones take about twice as long.
/// - **Memory:** potentials, currents, two bytes for each neuron in a list of spikes, and 24 bytes. On the stack: four bytes for each
///   input, and four for each neuron if the layer is recurrent.
#[derive(Clone, Copy, Debug)]
pub struct Layer<'a, N: Neuron, const IN: usize, const OUT: usize, I = Spiking, R = Forward> {
    weights: &'a Weights<N::Value, IN, OUT>,
    neurons: &'a [N; OUT],
    recurrence: R,
    input: I,
}

/// The state of a layer between steps.
#[derive(Clone, Copy, Debug)]
pub struct LayerState<V, C, const OUT: usize> {
    potentials: [V; OUT],
    currents: [C; OUT],
    spikes: Spikes<OUT>,
    rejected: u32,
    saturated: u32,
    /// The layer to which the state belongs.
    owner: Owner,
}

/// Addresses of a layer's weights and neurons, which tell it from others of its type.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Owner(usize, usize);

impl<'a, N: Neuron, const IN: usize, const OUT: usize> Layer<'a, N, IN, OUT> {
    /// Makes a layer whose inputs are spikes.
    pub const fn new(weights: &'a Weights<N::Value, IN, OUT>, neurons: &'a [N; OUT]) -> Self {
        const { assert!(OUT >= 1 && OUT <= 1 << 16, "numbers of neurons have 16 bits") };
        Self { weights, neurons, recurrence: Forward, input: Spiking }
    }

    /// Makes the layer take a value for each of up to 128 inputs, instead of spikes.
    pub const fn of_values(self) -> Layer<'a, N, IN, OUT, Values> {
        const {
            assert!(
                IN <= 128,
                "a layer takes 128 values at most, so that sums of them fit 32 bits"
            );
        };
        let Self { weights, neurons, .. } = self;
        Layer { weights, neurons, recurrence: Forward, input: Values }
    }
}

impl<'a, N: Neuron, const IN: usize, const OUT: usize, I: Copy> Layer<'a, N, IN, OUT, I> {
    /// Makes the layer recurrent: its spikes act on it in the next step, by [`Full`](crate::Full) or
    /// [`OneToOne`](crate::OneToOne) weights.
    pub const fn recurrent<R: Recurrence<N::Value, OUT>>(
        self,
        recurrence: R,
    ) -> Layer<'a, N, IN, OUT, I, R> {
        const {
            assert!(
                R::HAS_OWN || IN + OUT <= N::Value::MOST_SPIKES,
                "a recurrent layer of 8-bit weights has 4096 inputs and neurons at most, so that sums fit 32 bits"
            );
        };
        let Self { weights, neurons, input, .. } = self;
        Layer { weights, neurons, recurrence, input }
    }
}

impl<N: Neuron, const IN: usize, const OUT: usize, I, R> Layer<'_, N, IN, OUT, I, R>
where
    Self: Network,
{
    /// Returns a network of this layer, followed by another network.
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
    type State = LayerState<N::Value, N::Current, OUT>;
    const INPUTS: usize = IN;
    const OUTPUTS: usize = OUT;

    fn state(&self) -> Self::State {
        LayerState {
            potentials: [N::Value::default(); OUT],
            currents: [N::Current::default(); OUT],
            spikes: Spikes::new(),
            rejected: 0,
            saturated: 0,
            owner: self.owner(),
        }
    }

    #[inline(never)] // so that the lists of two layers take the same stack
    fn step<'s>(&self, state: &'s mut Self::State, input: &I::Of<IN>) -> &'s [u16] {
        if state.owner != self.owner() {
            self.adopt(state);
        }
        let LayerState { potentials, currents, spikes, rejected, saturated, .. } = state;
        let (mut checked, mut before) = (I::Checked::default(), R::Before::default());
        I::check(self.weights, input, &mut checked, rejected);
        self.recurrence.begin(spikes, &mut before);
        spikes.clear();
        let (checked, before) = (&checked, &before);
        let mut step = Step { layer: self, checked, before, spikes, saturated, done: 0 };

        let all = (&mut potentials[..], &mut currents[..], &self.neurons[..]);
        let rest = match N::Value::BLOCK {
            1 => all,
            2 => step.blocks::<2>(all),
            3 => step.blocks::<3>(all),
            _ => step.blocks::<4>(all),
        };
        let (potentials, currents, neurons) = step.blocks::<1>(rest);
        let each = potentials.iter_mut().zip(currents).zip(neurons);
        for (((v, current), neuron), number) in each.zip(OUT / 4 * 4..) {
            step.one(number, v, current, neuron);
        }
        spikes.as_slice()
    }

    fn checksum(&self) -> u32 {
        let mut sum = Checksum::new();
        // The compiler knows what constants hold, and would work out their checksum instead of reading them.
        black_box(self.weights).add_to(&mut sum);
        self.recurrence.add_to(&mut sum);
        for neuron in black_box(self.neurons) {
            neuron.add_to(&mut sum);
        }
        sum.end()
    }
}

impl<N: Neuron, const IN: usize, const OUT: usize, I, R> Layer<'_, N, IN, OUT, I, R> {
    fn owner(&self) -> Owner {
        Owner(core::ptr::from_ref(self.weights).addr(), core::ptr::from_ref(self.neurons).addr())
    }

    /// Brings the state of another layer to rest, in place, and counts it.
    #[cold]
    #[inline(never)]
    fn adopt(&self, state: &mut LayerState<N::Value, N::Current, OUT>) {
        state.potentials.fill(N::Value::default());
        state.currents.fill(N::Current::default());
        state.spikes.clear();
        state.rejected = state.rejected.saturating_add(1);
        state.owner = self.owner();
    }
}

/// Potentials, currents and neurons.
type Parts<'p, N> = (&'p mut [<N as Neuron>::Value], &'p mut [<N as Neuron>::Current], &'p [N]);

/// A step that a layer is running.
struct Step<'s, L, I, B, const OUT: usize> {
    layer: L,
    checked: &'s I,
    before: &'s B,
    spikes: &'s mut Spikes<OUT>,
    saturated: &'s mut u32,
    /// Number of groups of four neurons that are done.
    done: usize,
}

impl<N, I, R, const IN: usize, const OUT: usize>
    Step<'_, &Layer<'_, N, IN, OUT, I, R>, I::Checked<'_, IN, OUT>, R::Before<'_>, OUT>
where
    N: Neuron,
    I: Input<N::Value>,
    R: Recurrence<N::Value, OUT>,
{
    /// Runs as many blocks of `W` groups of four neurons as there are, and returns the neurons that are left.
    #[inline(always)]
    fn blocks<'p, const W: usize>(
        &mut self,
        (potentials, currents, neurons): Parts<'p, N>,
    ) -> Parts<'p, N> {
        let whole = potentials.len() / (4 * W) * (4 * W);
        let (potentials, last_potentials) = potentials.split_at_mut(whole);
        let (currents, last_currents) = currents.split_at_mut(whole);
        let (neurons, last_neurons) = neurons.split_at(whole);
        let potentials = potentials.as_chunks_mut::<4>().0.as_chunks_mut::<W>().0;
        let currents = currents.as_chunks_mut::<4>().0.as_chunks_mut::<W>().0;
        let neurons = neurons.as_chunks::<4>().0.as_chunks::<W>().0;
        let Layer { weights, recurrence, .. } = self.layer;
        let ((rows, rest), (own, own_scale)) =
            (I::fired(self.checked), recurrence.fired(self.before));
        let scale = if rows.is_empty() { own_scale } else { weights.scale };
        let is_alike = own.is_empty() || scale == own_scale;
        let is_few = rows.len().wrapping_add(own.len()) <= N::Value::MOST_ROWS;
        let is_plain = is_alike && is_few && rest.is_empty();
        let mut first = self.done;
        for ((potentials, currents), neurons) in potentials.iter_mut().zip(currents).zip(neurons) {
            let neuron = first.wrapping_mul(4);
            let start = || {
                let mut sums = [[N::Value::default(); 4]; W];
                let each = sums.as_flattened_mut().iter_mut().zip(neurons.as_flattened());
                each.for_each(|(sum, neuron)| *sum = neuron.bias());
                I::add_values(weights, self.checked, neuron, sums.as_flattened_mut());
                sums
            };
            let mut sums = if is_plain {
                N::Value::sums(start, [rows, own], scale, first)
            } else {
                self.sums_of_many(start(), first)
            };
            if R::HAS_OWN {
                for (sum, neuron) in sums.as_flattened_mut().iter_mut().zip(neuron..) {
                    recurrence.add_own(self.before, neuron, sum);
                }
            }

            let mut append = |number: u32| {
                self.spikes.append(neuron.wrapping_add(number as usize) as u16);
            };
            let (mut outside, mut fired, mut bit) = (0, 0_u32, 1_u32);
            let fours = potentials.iter_mut().zip(currents.iter_mut()).zip(neurons).zip(&sums);
            for (((potentials, currents), neurons), sums) in fours {
                let each = potentials.iter_mut().zip(currents).zip(neurons).zip(sums);
                for (((v, current), neuron), sum) in each {
                    // A copy's numbers are read at once, by fewer instructions, if there are registers for them.
                    let copy = *neuron;
                    let neuron = if IS_SMALL { neuron } else { &copy };
                    if neuron.step(v, current, *sum) && N::FIRES {
                        if IS_SMALL {
                            append(bit.trailing_zeros());
                        } else {
                            fired |= bit;
                        }
                    }
                    outside |= v.outside() | N::outside(current);
                    bit <<= 1;
                    if IS_SMALL {
                        black_box(()); // one neuron after the other, as there are few registers
                    }
                }
            }
            if outside > OUTSIDE {
                let count = clamp::<N>(potentials.as_flattened_mut(), currents.as_flattened_mut());
                *self.saturated = self.saturated.saturating_add(count);
            }
            while fired != 0 {
                append(fired.trailing_zeros());
                fired &= fired.wrapping_sub(1);
            }
            first = first.wrapping_add(W);
        }
        self.done = first;
        (last_potentials, last_currents, last_neurons)
    }

    /// Adds to the sums when the rows cannot be added at once: inputs fired several times, or there are too many rows,
    /// or the recurrent weights have another scale.
    #[cold]
    #[inline(never)]
    fn sums_of_many<const W: usize>(
        &self,
        mut sums: [[N::Value; 4]; W],
        first: usize,
    ) -> [[N::Value; 4]; W] {
        let Layer { weights, recurrence, .. } = self.layer;
        let (rows, rest) = I::fired(self.checked);
        let (own, own_scale) = recurrence.fired(self.before);
        let mut rest = rest.iter().filter_map(|&spike| weights.rows.get(usize::from(spike)));
        let mut several = rows.chunks(N::Value::MOST_ROWS);
        let mut one;
        loop {
            let list = if let Some(list) = several.next() {
                list
            } else if let Some(row) = rest.next() {
                one = [row];
                &one
            } else {
                break;
            };
            sums = N::Value::sums(|| sums, [list, &[]], weights.scale, first);
        }
        for list in own.chunks(N::Value::MOST_ROWS) {
            sums = N::Value::sums(|| sums, [list, &[]], own_scale, first);
        }
        sums
    }

    /// Runs a step of one neuron.
    #[inline(always)]
    fn one(&mut self, number: usize, v: &mut N::Value, current: &mut N::Current, neuron: &N) {
        let mut sum = neuron.bias();
        let Layer { weights, recurrence, .. } = self.layer;
        I::add_values(weights, self.checked, number, slice::from_mut(&mut sum));
        let (rows, rest) = I::fired(self.checked);
        N::Value::add_rows_to_one(rows, weights.scale, number, &mut sum);
        for row in rest.iter().filter_map(|&spike| weights.rows.get(usize::from(spike))) {
            N::Value::add_rows_to_one(&[row], weights.scale, number, &mut sum);
        }
        let (rows, scale) = recurrence.fired(self.before);
        N::Value::add_rows_to_one(rows, scale, number, &mut sum);
        recurrence.add_own(self.before, number, &mut sum);
        if neuron.step(v, current, sum) && N::FIRES {
            self.spikes.append(number as u16);
        }
        let count = v.clamp().wrapping_add(N::clamp(current));
        *self.saturated = self.saturated.saturating_add(count);
    }
}

/// Clamps potentials and currents to their range; returns how many were outside.
#[cold]
fn clamp<N: Neuron>(potentials: &mut [N::Value], currents: &mut [N::Current]) -> u32 {
    let potentials = potentials.iter_mut().map(Number::clamp);
    potentials.chain(currents.iter_mut().map(N::clamp)).fold(0, u32::saturating_add)
}

impl<V: Number, C: Copy + Debug, const OUT: usize> State for LayerState<V, C, OUT> {
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

impl<V, C, const OUT: usize> LayerState<V, C, OUT> {
    /// Returns the neurons' currents, which are empty for neurons without.
    pub fn currents(&self) -> &[C; OUT] {
        &self.currents
    }
}
