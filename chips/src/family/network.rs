//! Networks for chips of the ODIN family: their trait, and networks as constant data.

use super::{AerPort, Input};
use crate::ChipError;
use spikewire::{Code, Event, Polarity, Scheme, Tick};

/// The neurons and weights of a network, as [constant data](Network) or as [bytes](super::NetworkBytes).
/// [`Gated::load`](super::Gated::load) writes the network to the chip.
///
/// The network's neurons are the chip's neurons from 0 on. An input is either a row of synapses onto all neurons, or a
/// virtual event for one neuron. If the network is not recurrent, the inputs have the chip's rows of synapses from row
/// 0 on. If it is recurrent, the neurons have the first rows, and the rows of the inputs follow.
pub trait Describe<I: Input> {
    /// Returns the number of neurons, 1 to 256.
    fn neurons(&self) -> u16;

    /// Returns the parameters of a neuron. If the network has no neuron of this number, returns the parameters of a
    /// [disabled](Input::DISABLED) neuron.
    fn neuron(&self, neuron: u8) -> I::Neuron;

    /// Returns the number of inputs.
    fn inputs(&self) -> u16;

    /// Returns the neuron and the weight of an input that is a virtual event; `None` if the input has a row of
    /// synapses.
    fn virtual_input(&self, input: u16) -> Option<(u8, i8)>;

    /// Returns the weight from input `input` to neuron `post`. Used only for an input that has a row of synapses.
    fn input_weight(&self, input: u16, post: u8) -> i8;

    /// Returns whether the spikes of neurons reach other neurons.
    fn is_recurrent(&self) -> bool;

    /// Returns the weight from neuron `pre` to neuron `post`.
    fn weight(&self, pre: u8, post: u8) -> i8;

    /// Returns the number of the output that carries the spikes of `neuron`; `None` if the neuron is not an output.
    fn output(&self, neuron: u8) -> Option<u16>;

    /// Returns the chip's input for an event of an encoder, or `None` if the network has no such input. The first
    /// argument is the encoder's scheme.
    ///
    /// An event with address `n` goes to input `n` of the network, unless the code of the scheme is
    /// [signed](Code::IS_SIGNED). A signed code, such as that of step-forward, takes two inputs for each address: input
    /// `2 n` for [`Polarity::Up`], and input `2 n + 1` for [`Polarity::Down`]. Rate codes are signed, too, but never
    /// send [`Polarity::Down`]. Their odd inputs therefore stay silent.
    ///
    /// ```
    /// use spikewire_chips::{Describe, Inputs, TinyOdinInput, TinyOdinNetwork, TinyOdinNeuron, neurons_from};
    /// use spikewire::{Event, Polarity, Tick, temporal::StepForward};
    ///
    /// static RATE: StepForward<f32> = StepForward::new(0.1);
    /// /// Rises and falls of three axes.
    /// static NETWORK: TinyOdinNetwork<6, 6, 6> = TinyOdinNetwork {
    ///     neurons: [TinyOdinNeuron { threshold: 20, leak: 1, ..TinyOdinNeuron::REST }; 6],
    ///     inputs: Inputs::one_to_one(7),
    ///     recurrent: &[],
    ///     outputs: neurons_from::<0, 6>(),
    /// };
    ///
    /// let yaw = |polarity| Event { tick: Tick::from_micros(0), address: 2, polarity };
    /// let [rises, falls] = [Polarity::Up, Polarity::Down].map(|polarity| NETWORK.input_for(&RATE, yaw(polarity)));
    /// assert_eq!(rises, NETWORK.input(4));
    /// assert_eq!(falls, NETWORK.input(5));
    /// // In flight: `chip.feed(events.waiting(), |event| NETWORK.input_for(&RATE, event), on_output)`.
    /// ```
    fn input_for<P: Scheme>(&self, _scheme: &P, event: Event) -> Option<I> {
        if !P::Code::IS_SIGNED {
            return self.input(event.address);
        }
        let falls = u16::from(event.polarity == Polarity::Down);
        self.input(event.address.checked_mul(2)?.checked_add(falls)?)
    }

    /// Returns the chip's input that acts as input `input` of the network, or `None` if the network has no such input.
    /// The number of an input is not the address of an event: see [`input_for`](Self::input_for).
    fn input(&self, input: u16) -> Option<I> {
        if input >= self.inputs() {
            return None;
        }
        match self.virtual_input(input) {
            Some((neuron, weight)) => Some(I::virtual_event(neuron, weight)),
            None => u8::try_from(self.first_input_row().saturating_add(input)).ok().map(I::spike),
        }
    }

    /// Returns a callback for the argument `on_output` of [`Running::poll`](super::Running::poll) and of other calls.
    /// These calls pass the number of each neuron that fires to the callback. If the neuron is an output of the
    /// network, the callback passes an event to `sink`, with the time `tick` and the output's number as its address.
    /// The callback ignores all other neurons.
    fn answers(&self, tick: Tick, mut sink: impl FnMut(Event)) -> impl FnMut(u8) {
        move |neuron| {
            if let Some(address) = self.output(neuron) {
                sink(Event { tick, address, polarity: Polarity::Up });
            }
        }
    }

    /// Returns the registers with which to [run](super::Gated::run) the network. The loop is closed if the network is
    /// recurrent, otherwise open. The output bus carries the spikes of neurons. Neurons beyond the network are not in
    /// use.
    fn registers(&self) -> I::Registers {
        let mut inhibitory = [0; 16];
        for row in 0..self.rows() {
            let inhibits = (0..self.neurons()).any(|post| self.row_weight(row, post as u8) < 0);
            if let Some(word) = inhibitory.get_mut(usize::from(row >> 4)) {
                *word |= u16::from(inhibits) << (row & 15);
            }
        }
        I::registers(self.neurons().saturating_sub(1) as u8, !self.is_recurrent(), inhibitory)
    }

    /// Returns the number of the first row of synapses that belongs to an input.
    fn first_input_row(&self) -> u16 {
        if self.is_recurrent() { self.neurons() } else { 0 }
    }

    /// Returns the number of rows of synapses that the network uses, from row 0 on.
    fn rows(&self) -> u16 {
        let is_virtual = self.virtual_input(0).is_some();
        self.first_input_row().saturating_add(if is_virtual { 0 } else { self.inputs() })
    }

    /// Returns the weight of the synapse in row `row` onto neuron `post`.
    fn row_weight(&self, row: u16, post: u8) -> i8 {
        match row.checked_sub(self.first_input_row()) {
            Some(input) => self.input_weight(input, post),
            None => self.weight(row as u8, post),
        }
    }
}

/// The connections from a network's inputs to its neurons.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Inputs<const IN: usize, const N: usize> {
    /// A row of synapses for each input: the weights from that input to all neurons.
    Rows([[i8; N]; IN]),
    /// A virtual event for each input. It acts on one neuron without a synapse. An entry is that neuron and the weight.
    /// In tinyODIN only the first 16 neurons can receive virtual events.
    Virtual([(u8, i8); IN]),
}

impl<const IN: usize, const N: usize> Inputs<IN, N> {
    /// Connects input `n` to neuron `n` with this weight. Each input gets a row of synapses; its other weights are 0.
    #[must_use]
    pub const fn one_to_one(weight: i8) -> Self {
        let mut rows = [[0; N]; IN];
        let mut n = 0;
        while n < IN && n < N {
            #[allow(clippy::indexing_slicing)] // n is below both
            {
                rows[n][n] = weight;
            }
            n += 1;
        }
        Self::Rows(rows)
    }
}

/// Returns the neurons `FIRST`, `FIRST + 1` and so on, `OUT` in all, for [`Network::outputs`].
#[must_use]
pub const fn neurons_from<const FIRST: u8, const OUT: usize>() -> [u8; OUT] {
    const { assert!(FIRST as usize + OUT <= 256, "a chip has 256 neurons") };
    let mut neurons = [0; OUT];
    let mut n = 0;
    while n < OUT {
        #[allow(clippy::indexing_slicing)] // n is below
        {
            neurons[n] = FIRST + n as u8;
        }
        n += 1;
    }
    neurons
}

/// A network of `N` neurons, with `IN` inputs and `OUT` outputs, as constant data.
///
/// Weights are -7 to 7, for tinyODIN also -8. In ODIN all weights from one input or neuron must have the same sign.
///
/// **Memory:** one byte for each weight; [`NetworkBytes`](super::NetworkBytes) take half of that.
///
/// ```
/// use spikewire_chips::{Describe, Inputs, TinyOdinInput, TinyOdinNetwork, TinyOdinNeuron, neurons_from};
///
/// // Each of four inputs drives a neuron of its own and holds down the others.
/// static NETWORK: TinyOdinNetwork<4, 4, 4> = TinyOdinNetwork {
///     neurons: [TinyOdinNeuron { threshold: 20, leak: 1, ..TinyOdinNeuron::REST }; 4],
///     inputs: Inputs::Rows([[7, -1, -1, -1], [-1, 7, -1, -1], [-1, -1, 7, -1], [-1, -1, -1, 7]]),
///     recurrent: &[],
///     outputs: neurons_from::<0, 4>(),
/// };
/// assert_eq!(NETWORK.input(2), Some(TinyOdinInput::Spike { pre: 2 }));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Network<I: Input, const IN: usize, const N: usize, const OUT: usize> {
    /// The neurons, in the order of the chip's neurons.
    pub neurons: [I::Neuron; N],
    /// The inputs, and their weights.
    pub inputs: Inputs<IN, N>,
    /// The weights between neurons: row `n` has the weights from neuron `n` to all neurons. Neurons without a row have
    /// no effect on other neurons. If there are no rows, the chip runs in open loop: spikes of neurons go only to the
    /// output bus.
    pub recurrent: &'static [[i8; N]],
    /// For each output, the number of the neuron whose spikes are this output.
    pub outputs: [u8; OUT],
}

impl<I: Input, const IN: usize, const N: usize, const OUT: usize> Describe<I>
    for Network<I, IN, N, OUT>
{
    fn neurons(&self) -> u16 {
        const { assert!(N >= 1 && N <= 256, "a chip has 256 neurons") };
        N as u16
    }

    fn neuron(&self, neuron: u8) -> I::Neuron {
        self.neurons.get(usize::from(neuron)).copied().unwrap_or(I::DISABLED)
    }

    fn inputs(&self) -> u16 {
        const { assert!(IN <= 256, "a chip has 256 rows of synapses") };
        IN as u16
    }

    fn virtual_input(&self, input: u16) -> Option<(u8, i8)> {
        match &self.inputs {
            Inputs::Virtual(inputs) => inputs.get(usize::from(input)).copied(),
            Inputs::Rows(_) => None,
        }
    }

    fn input_weight(&self, input: u16, post: u8) -> i8 {
        match &self.inputs {
            Inputs::Rows(rows) => at(rows, input.into(), post),
            Inputs::Virtual(_) => 0,
        }
    }

    fn is_recurrent(&self) -> bool {
        !self.recurrent.is_empty()
    }

    fn weight(&self, pre: u8, post: u8) -> i8 {
        at(self.recurrent, pre.into(), post)
    }

    fn output(&self, neuron: u8) -> Option<u16> {
        let at = self.outputs.iter().position(|&output| output == neuron)?;
        Some(at as u16)
    }
}

fn at<const N: usize>(rows: &[[i8; N]], row: usize, post: u8) -> i8 {
    rows.get(row).and_then(|row| row.get(usize::from(post))).copied().unwrap_or(0)
}

/// Returns an error unless the network fits the chip and all of its values are in range.
pub(super) fn check<I: Input, B, P: AerPort>(
    network: &impl Describe<I>,
) -> Result<(), ChipError<B, P::Error>> {
    let out_of_range = |what, value: u16, max: u16| {
        if value > max {
            return Err(ChipError::OutOfRange {
                what,
                value: value.into(),
                min: 0,
                max: max.into(),
            });
        }
        Ok(())
    };
    out_of_range("neurons", network.neurons(), 256)?;
    out_of_range("rows of synapses", network.rows(), 256)?;
    for neuron in 0..network.neurons() {
        I::neuron_bytes(&network.neuron(neuron as u8))?;
    }
    for input in 0..network.inputs() {
        if let Some(input) = network.input(input) {
            input.word()?;
        }
    }
    for row in 0..network.rows() {
        let weights = || (0..network.neurons()).map(|post| network.row_weight(row, post as u8));
        for weight in weights() {
            I::weight_bits(weight)?;
        }
        if I::SIGNS_BY_ROW && weights().any(|w| w < 0) && weights().any(|w| w > 0) {
            return Err(ChipError::MixedSigns { pre: row as u8 });
        }
    }
    Ok(())
}
