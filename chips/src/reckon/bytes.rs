//! Networks for `ReckOn` as bytes, from a file or received by radio, for programs that know the network only at run
//! time.

use super::network::check;
use super::{DescribeReckOn, ReckOnPair, ReckOnShared};
use crate::FormatError;

const MAGIC: [u8; 4] = *b"SWN1";
const KIND: u8 = 3;
const HEADER: usize = 16;
const RECURRENT: u8 = 1;
const ZERO: u8 = 2;

/// A network for `ReckOn` as bytes, for programs that know the network only at run time.
///
/// | bytes | content |
/// |---|---|
/// | 4 | `SWN1` |
/// | 1 | the chip: 3 |
/// | 1 | bit 0: the network is recurrent; bit 1: a neuron that fires returns to 0 |
/// | 2, 2, 2 | numbers of neurons, inputs and outputs |
/// | 1, 1, 1 | left shifts of the weights from inputs, between neurons and to outputs |
/// | 1 | factor by which a step multiplies an output's potential, in units of 1/128 |
/// | 2, 2 for each pair of neurons | factor by which a step multiplies a potential, in units of 1/32 768; threshold |
/// | a row for each input | the weights to all neurons |
/// | a row for each neuron | the weights to all neurons; left out if the network is not recurrent |
/// | a row for each neuron | the weights to all outputs |
///
/// A row has one byte for each weight, a signed number.
///
/// Numbers of two bytes are little-endian. There is no checksum; [`Programmed::load`](super::Programmed::load) compares
/// the chip's memory with these bytes.
#[derive(Clone, Copy, Debug)]
pub struct ReckOnBytes<'a> {
    sizes: [u16; 3],
    shared: ReckOnShared,
    pairs: &'a [u8],
    inputs: &'a [u8],
    recurrent: &'a [u8],
    outputs: &'a [u8],
}

/// Returns the lengths in bytes of the four tables. In this order: decay and threshold, an entry for each pair of
/// neurons; weights of inputs; weights of connections between neurons; weights of outputs.
fn lengths([neurons, inputs, outputs]: [u16; 3], is_recurrent: bool) -> [usize; 4] {
    let [pairs, neurons, inputs, outputs] =
        [neurons.div_ceil(2), neurons, inputs, outputs].map(usize::from);
    let own = if is_recurrent { neurons } else { 0 };
    [4 * pairs, inputs * neurons, own * neurons, neurons * outputs]
}

fn check_sizes([neurons, inputs, outputs]: [u16; 3]) -> Result<(), FormatError> {
    let is_in = |size: u16, most: u16| (1..=most).contains(&size);
    if is_in(neurons, 256) && is_in(inputs, 256) && is_in(outputs, 16) {
        Ok(())
    } else {
        Err(FormatError::Size)
    }
}

impl<'a> ReckOnBytes<'a> {
    /// Borrows a network from bytes, after checking their header, their length and every value.
    ///
    /// # Errors
    /// Returns an error if the bytes do not contain a network for this chip.
    pub fn new(bytes: &'a [u8]) -> Result<Self, FormatError> {
        let (header, rest) = bytes.split_at_checked(HEADER).ok_or(FormatError::Magic)?;
        let &[a, b, c, d, kind, flags, n0, n1, i0, i1, o0, o1, s0, s1, s2, keep] = header else {
            return Err(FormatError::Magic);
        };
        if [a, b, c, d] != MAGIC {
            return Err(FormatError::Magic);
        }
        if kind != KIND || flags & !(RECURRENT | ZERO) != 0 {
            return Err(FormatError::Chip);
        }
        let sizes = [[n0, n1], [i0, i1], [o0, o1]].map(u16::from_le_bytes);
        check_sizes(sizes)?;
        let lengths = lengths(sizes, flags & RECURRENT != 0);
        let needed = lengths.iter().fold(HEADER, |sum, length| sum.wrapping_add(*length));
        let length = FormatError::Length { needed, given: bytes.len() };
        if bytes.len() != needed {
            return Err(length);
        }
        let [pairs, inputs, recurrent, _] = lengths;
        let (pairs, rest) = rest.split_at_checked(pairs).ok_or(length)?;
        let (inputs, rest) = rest.split_at_checked(inputs).ok_or(length)?;
        let (recurrent, outputs) = rest.split_at_checked(recurrent).ok_or(length)?;
        let shared = ReckOnShared { shifts: [s0, s1, s2], keep, resets_to_zero: flags & ZERO != 0 };
        let network = Self { sizes, shared, pairs, inputs, recurrent, outputs };
        check::<(), ()>(&network).map_err(|_| FormatError::Value)?;
        Ok(network)
    }

    /// Writes a network to a buffer; returns the length in bytes.
    ///
    /// # Errors
    /// Returns an error if the buffer is too small, or if the network has a value out of its range.
    pub fn write(network: &impl DescribeReckOn, buffer: &mut [u8]) -> Result<usize, FormatError> {
        let sizes = [network.neurons(), network.inputs(), network.outputs()];
        check_sizes(sizes)?;
        check::<(), ()>(network).map_err(|_| FormatError::Value)?;
        let [neurons, inputs, outputs] = sizes;
        let is_recurrent =
            (0..neurons).any(|from| (0..neurons).any(|to| network.recurrent_weight(from, to) != 0));
        let lengths = lengths(sizes, is_recurrent);
        let needed = lengths.iter().fold(HEADER, |sum, length| sum.wrapping_add(*length));
        let given = buffer.len();
        let target = buffer.get_mut(..needed).ok_or(FormatError::Length { needed, given })?;
        let mut bytes = target.iter_mut();
        let mut put = |byte: u8| {
            if let Some(target) = bytes.next() {
                *target = byte;
            }
        };
        let ReckOnShared { shifts, keep, resets_to_zero } = network.shared();
        MAGIC.into_iter().for_each(&mut put);
        put(KIND);
        put(u8::from(is_recurrent) | u8::from(resets_to_zero) << 1);
        sizes.into_iter().flat_map(u16::to_le_bytes).for_each(&mut put);
        shifts.into_iter().for_each(&mut put);
        put(keep);
        for pair in 0..neurons.div_ceil(2) {
            let ReckOnPair { keep, threshold } = network.pair(pair);
            keep.to_le_bytes().into_iter().chain(threshold.to_le_bytes()).for_each(&mut put);
        }
        for input in 0..inputs {
            (0..neurons).for_each(|to| put(network.input_weight(input, to) as u8));
        }
        for from in 0..if is_recurrent { neurons } else { 0 } {
            (0..neurons).for_each(|to| put(network.recurrent_weight(from, to) as u8));
        }
        for from in 0..neurons {
            (0..outputs).for_each(|to| put(network.output_weight(from, to) as u8));
        }
        Ok(needed)
    }
}

/// Returns the weight in row `row` and column `column` of a table whose rows have `length` weights; 0 outside the
/// table.
fn weight(rows: &[u8], length: u16, row: u16, column: u16) -> i8 {
    let at = usize::from(row).wrapping_mul(length.into()).wrapping_add(column.into());
    rows.get(at).filter(|_| column < length).map_or(0, |&byte| byte as i8)
}

impl DescribeReckOn for ReckOnBytes<'_> {
    fn neurons(&self) -> u16 {
        let [neurons, ..] = self.sizes;
        neurons
    }

    fn inputs(&self) -> u16 {
        let [_, inputs, _] = self.sizes;
        inputs
    }

    fn outputs(&self) -> u16 {
        let [.., outputs] = self.sizes;
        outputs
    }

    fn pair(&self, pair: u16) -> ReckOnPair {
        let (pairs, _) = self.pairs.as_chunks();
        pairs.get(usize::from(pair)).map_or(ReckOnPair::REST, |&[k0, k1, t0, t1]| ReckOnPair {
            keep: u16::from_le_bytes([k0, k1]),
            threshold: i16::from_le_bytes([t0, t1]),
        })
    }

    fn input_weight(&self, input: u16, neuron: u16) -> i8 {
        weight(self.inputs, self.neurons(), input, neuron)
    }

    fn recurrent_weight(&self, from: u16, to: u16) -> i8 {
        weight(self.recurrent, self.neurons(), from, to)
    }

    fn output_weight(&self, neuron: u16, output: u16) -> i8 {
        weight(self.outputs, self.outputs(), neuron, output)
    }

    fn shared(&self) -> ReckOnShared {
        self.shared
    }
}
