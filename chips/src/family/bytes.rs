//! Networks as bytes, from a file or received by radio, for programs that know the network only at run time.

use core::fmt;
use core::marker::PhantomData;

use super::{Describe, Input};

const MAGIC: [u8; 4] = *b"SWN1";
const HEADER: usize = 12;
const RECURRENT: u8 = 1;
const VIRTUAL: u8 = 2;

/// The reason that bytes could not be read as a network, or that a network could not be written as bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum FormatError {
    /// The bytes do not begin with `SWN1`.
    Magic,
    /// The bytes contain a network for a different chip, or a flag that this version does not know.
    Chip,
    /// The network has no neurons, or more than 256 neurons, inputs or rows of synapses. If the chip is `ReckOn`, this
    /// error can also mean that the network has no inputs, no outputs, or more than 16 outputs.
    Size,
    /// The bytes or the buffer have the wrong length.
    Length {
        /// Length that the network needs, in bytes.
        needed: usize,
        /// Length of the bytes or the buffer given.
        given: usize,
    },
    /// A weight or a field of a neuron is out of its range, an output is not a neuron of the network, or two outputs
    /// are the same neuron.
    Value,
}

impl fmt::Display for FormatError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Magic => write!(f, "the bytes do not begin with SWN1"),
            Self::Chip => write!(f, "the network is for another chip"),
            Self::Size => write!(f, "the network has no neurons, or more neurons or rows than 256"),
            Self::Length { needed, given } => {
                write!(f, "the network takes {needed} bytes, not {given}")
            }
            Self::Value => write!(f, "a neuron or a weight has a value that there is not"),
        }
    }
}

impl core::error::Error for FormatError {}

/// A network as bytes, for programs that know the network only at run time. The bytes take about half the memory of a
/// [`Network`](super::Network).
///
/// | bytes | content |
/// |---|---|
/// | 4 | `SWN1` |
/// | 1 | the chip: 1 is tinyODIN, 2 is ODIN (3 is `ReckOn`, see [`ReckOnBytes`](crate::ReckOnBytes)) |
/// | 1 | bit 0: the network is recurrent; bit 1: the inputs are virtual events |
/// | 2, 2, 2 | numbers of neurons, inputs and outputs |
/// | 4 or 16 for each neuron | the neuron as in the memory of tinyODIN (4 bytes) or ODIN (16 bytes) |
/// | a row for each input | the weights to all neurons; for a virtual event instead 2 bytes, the neuron and the weight |
/// | a row for each neuron | the weights to all neurons; left out if the network is not recurrent |
/// | 1 for each output | the neuron whose spikes are this output |
///
/// A row consists of signed weights of 4 bits, two in each byte, the first in the low half.
///
/// Numbers of two bytes are little-endian. There is no checksum; [`Gated::load`](super::Gated::load) compares the
/// chip's memory with these bytes.
#[derive(Clone, Copy, Debug)]
pub struct NetworkBytes<'a, I> {
    shape: Shape,
    neurons: &'a [u8],
    inputs: &'a [u8],
    recurrent: &'a [u8],
    outputs: &'a [u8],
    input: PhantomData<I>,
}

#[derive(Clone, Copy, Debug)]
struct Shape {
    neurons: u16,
    inputs: u16,
    outputs: u16,
    is_recurrent: bool,
    is_virtual: bool,
}

impl Shape {
    /// Returns the lengths in bytes of the four tables: neurons, weights from inputs, weights between neurons, and
    /// outputs.
    fn lengths<I: Input>(self) -> [usize; 4] {
        let row = usize::from(self.neurons.div_ceil(2));
        let (neurons, inputs) = (usize::from(self.neurons), usize::from(self.inputs));
        [
            neurons * usize::from(I::NEURON_BYTES),
            inputs * if self.is_virtual { 2 } else { row },
            if self.is_recurrent { neurons * row } else { 0 },
            self.outputs.into(),
        ]
    }

    fn check(self) -> Result<(), FormatError> {
        let first = if self.is_recurrent { self.neurons } else { 0 };
        let rows = first.saturating_add(if self.is_virtual { 0 } else { self.inputs });
        if (1..=256).contains(&self.neurons) && rows <= 256 && self.inputs <= 256 {
            Ok(())
        } else {
            Err(FormatError::Size)
        }
    }
}

impl<'a, I: Input> NetworkBytes<'a, I> {
    /// Borrows a network from bytes, after checking their header and length.
    ///
    /// # Errors
    /// Returns an error if the bytes do not contain a network for this chip.
    pub fn new(bytes: &'a [u8]) -> Result<Self, FormatError> {
        let (header, rest) = bytes.split_at_checked(HEADER).ok_or(FormatError::Magic)?;
        let &[a, b, c, d, kind, flags, n0, n1, i0, i1, o0, o1] = header else {
            return Err(FormatError::Magic);
        };
        if [a, b, c, d] != MAGIC {
            return Err(FormatError::Magic);
        }
        if kind != I::KIND || flags & !(RECURRENT | VIRTUAL) != 0 {
            return Err(FormatError::Chip);
        }
        let shape = Shape {
            neurons: u16::from_le_bytes([n0, n1]),
            inputs: u16::from_le_bytes([i0, i1]),
            outputs: u16::from_le_bytes([o0, o1]),
            is_recurrent: flags & RECURRENT != 0,
            is_virtual: flags & VIRTUAL != 0,
        };
        shape.check()?;
        let lengths = shape.lengths::<I>();
        let needed = HEADER + lengths.iter().sum::<usize>();
        let length = FormatError::Length { needed, given: bytes.len() };
        if bytes.len() != needed {
            return Err(length);
        }
        let [neurons, inputs, recurrent, _] = lengths;
        let (neurons, rest) = rest.split_at_checked(neurons).ok_or(length)?;
        let (inputs, rest) = rest.split_at_checked(inputs).ok_or(length)?;
        let (recurrent, outputs) = rest.split_at_checked(recurrent).ok_or(length)?;
        Ok(Self { shape, neurons, inputs, recurrent, outputs, input: PhantomData })
    }

    /// Writes a network to a buffer; returns the length in bytes.
    ///
    /// # Errors
    /// Returns an error if the buffer is too small, or if the network has a value out of its range.
    pub fn write(network: &impl Describe<I>, buffer: &mut [u8]) -> Result<usize, FormatError> {
        let shape = Shape {
            neurons: network.neurons(),
            inputs: network.inputs(),
            outputs: outputs_of(network).count() as u16,
            is_recurrent: network.is_recurrent(),
            is_virtual: network.virtual_input(0).is_some(),
        };
        shape.check()?;
        // The format lists one neuron for each output, so every output number that a neuron has must be one of the
        // listed.
        let is_listed = |neuron| network.output(neuron).is_none_or(|output| output < shape.outputs);
        if !(0..shape.neurons).all(|neuron| is_listed(neuron as u8)) {
            return Err(FormatError::Value);
        }
        let lengths = shape.lengths::<I>();
        // Not `sum`, which can panic in builds that check for overflow.
        let needed = lengths.iter().fold(HEADER, |sum, length| sum.saturating_add(*length));
        let given = buffer.len();
        let target = buffer.get_mut(..needed).ok_or(FormatError::Length { needed, given })?;
        let mut bytes = target.iter_mut();
        let mut put = |byte: u8| {
            if let Some(target) = bytes.next() {
                *target = byte;
            }
        };
        MAGIC.into_iter().for_each(&mut put);
        put(I::KIND);
        let recurrent = if shape.is_recurrent { RECURRENT } else { 0 };
        put(recurrent | if shape.is_virtual { VIRTUAL } else { 0 });
        for number in [shape.neurons, shape.inputs, shape.outputs] {
            number.to_le_bytes().into_iter().for_each(&mut put);
        }
        for neuron in 0..shape.neurons {
            let neuron = I::neuron_bytes::<(), ()>(&network.neuron(neuron as u8));
            let bytes = neuron.map_err(|_| FormatError::Value)?;
            bytes.into_iter().take(I::NEURON_BYTES.into()).for_each(&mut put);
        }
        let weights = |row| (0..shape.neurons).map(move |post| network.row_weight(row, post as u8));
        let first = network.first_input_row();
        if shape.is_virtual {
            for input in 0..shape.inputs {
                let (neuron, weight) = network.virtual_input(input).ok_or(FormatError::Value)?;
                let word = I::virtual_event(neuron, weight).word::<(), ()>();
                word.map_err(|_| FormatError::Value)?;
                put(neuron);
                put(weight as u8);
            }
        } else {
            for row in first..network.rows() {
                pack::<I>(weights(row), &mut put)?;
            }
        }
        for row in 0..first {
            pack::<I>(weights(row), &mut put)?;
        }
        outputs_of(network).for_each(put);
        Ok(needed)
    }

    fn row(&self, rows: &[u8], row: usize, post: u8) -> i8 {
        let length = usize::from(self.shape.neurons.div_ceil(2));
        let is_known = u16::from(post) < self.shape.neurons;
        let byte = rows.get(row * length + usize::from(post >> 1)).filter(|_| is_known);
        let byte = byte.copied().unwrap_or(0);
        (if post & 1 == 0 { byte << 4 } else { byte }) as i8 >> 4
    }
}

/// Returns the neuron of each output, in the order of the outputs.
fn outputs_of<I: Input>(network: &impl Describe<I>) -> impl Iterator<Item = u8> {
    let neuron_of = move |output| {
        (0..network.neurons()).map(|n| n as u8).find(|&n| network.output(n) == Some(output))
    };
    (0..256).map_while(neuron_of)
}

/// Packs two weights into each byte, the first in the low half, and passes each byte to `put`.
fn pack<I: Input>(
    mut weights: impl Iterator<Item = i8>,
    put: &mut impl FnMut(u8),
) -> Result<(), FormatError> {
    while let Some(low) = weights.next() {
        let high = weights.next().unwrap_or(0);
        for weight in [low, high] {
            I::weight_bits::<(), ()>(weight).map_err(|_| FormatError::Value)?;
        }
        put((high << 4) as u8 | low as u8 & 0xF);
    }
    Ok(())
}

impl<I: Input> Describe<I> for NetworkBytes<'_, I> {
    fn neurons(&self) -> u16 {
        self.shape.neurons
    }

    fn neuron(&self, neuron: u8) -> I::Neuron {
        let length = usize::from(I::NEURON_BYTES);
        let first = usize::from(neuron) * length;
        let Some(stored) = self.neurons.get(first..first + length) else { return I::DISABLED };
        let mut bytes = [0; 16];
        bytes.iter_mut().zip(stored).for_each(|(byte, &stored)| *byte = stored);
        I::neuron(bytes)
    }

    fn inputs(&self) -> u16 {
        self.shape.inputs
    }

    fn virtual_input(&self, input: u16) -> Option<(u8, i8)> {
        let first = 2 * usize::from(input);
        match self.inputs.get(first..first + 2) {
            Some(&[neuron, weight]) if self.shape.is_virtual => Some((neuron, weight as i8)),
            _ => None,
        }
    }

    fn input_weight(&self, input: u16, post: u8) -> i8 {
        if self.shape.is_virtual { 0 } else { self.row(self.inputs, input.into(), post) }
    }

    fn is_recurrent(&self) -> bool {
        self.shape.is_recurrent
    }

    fn weight(&self, pre: u8, post: u8) -> i8 {
        self.row(self.recurrent, pre.into(), post)
    }

    fn output(&self, neuron: u8) -> Option<u16> {
        let at = self.outputs.iter().position(|&output| output == neuron)?;
        Some(at as u16)
    }
}
