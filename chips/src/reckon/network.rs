//! Networks for `ReckOn`: their trait, and networks as constant data.

use crate::ChipError;
use crate::error::in_range;

/// The parameters that neurons `2 n` and `2 n + 1` share.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ReckOnPair {
    /// Factor by which a time step multiplies a potential, in units of 1/32 768: 28 672 (0.875) to 36 863 (1.125).
    pub keep: u16,
    /// Potential at which the two neurons fire, 1 to 32 767.
    pub threshold: i16,
}

impl ReckOnPair {
    /// Parameters of neurons that keep their potential and practically never fire.
    pub const REST: Self = Self { keep: 1 << 15, threshold: i16::MAX };
}

/// The parameters that all neurons share.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ReckOnShared {
    /// Left shifts of the weights, 0 to 7 each. In this order: weights of inputs, of connections between neurons, of
    /// outputs.
    pub shifts: [u8; 3],
    /// Factor by which a time step multiplies an output's potential, in units of 1/128.
    pub keep: u8,
    /// Whether a neuron that fires returns to potential 0. If false, its threshold is subtracted from its potential.
    pub resets_to_zero: bool,
}

/// The sizes, parameters and weights of a network, as [`Programmed::load`](super::Programmed::load) writes them to the
/// chip.
pub trait DescribeReckOn {
    /// Returns the number of neurons, 1 to 256.
    fn neurons(&self) -> u16;
    /// Returns the number of inputs, 1 to 256.
    fn inputs(&self) -> u16;
    /// Returns the number of outputs, 1 to 16.
    fn outputs(&self) -> u16;
    /// Returns the parameters of neurons `2 * pair` and `2 * pair + 1`.
    fn pair(&self, pair: u16) -> ReckOnPair;
    /// Returns the weight from an input to a neuron.
    fn input_weight(&self, input: u16, neuron: u16) -> i8;
    /// Returns the weight from neuron `from` to neuron `to`.
    fn recurrent_weight(&self, from: u16, to: u16) -> i8;
    /// Returns the weight from a neuron to an output.
    fn output_weight(&self, neuron: u16, output: u16) -> i8;
    /// Returns the parameters that all neurons share.
    fn shared(&self) -> ReckOnShared;
}

/// A network with `IN` inputs, `N` neurons and `OUT` outputs, as constant data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReckOnNetwork<const IN: usize, const N: usize, const OUT: usize> {
    /// Parameters of each pair of neurons. Entry `n` is for neurons `2 n` and `2 n + 1`. There are `N / 2` entries,
    /// rounded up.
    pub pairs: &'static [ReckOnPair],
    /// Weights from each input to all neurons, with a row for each input.
    pub inputs: [[i8; N]; IN],
    /// Weights from each neuron to all neurons, with a row for each sending neuron; empty if the network is not
    /// recurrent.
    pub recurrent: &'static [[i8; N]],
    /// Weights from each neuron to all outputs, with a row for each neuron.
    pub outputs: [[i8; OUT]; N],
    /// The parameters that all neurons share.
    pub shared: ReckOnShared,
}

fn weight<const N: usize>(rows: &[[i8; N]], row: u16, column: u16) -> i8 {
    let row = rows.get(usize::from(row));
    row.and_then(|row| row.get(usize::from(column))).copied().unwrap_or(0)
}

impl<const IN: usize, const N: usize, const OUT: usize> DescribeReckOn
    for ReckOnNetwork<IN, N, OUT>
{
    fn neurons(&self) -> u16 {
        // Saturates instead of wrapping, so that a number that is too large stays too large.
        N.min(usize::from(u16::MAX)) as u16
    }

    fn inputs(&self) -> u16 {
        IN.min(usize::from(u16::MAX)) as u16
    }

    fn outputs(&self) -> u16 {
        OUT.min(usize::from(u16::MAX)) as u16
    }

    fn pair(&self, pair: u16) -> ReckOnPair {
        self.pairs.get(usize::from(pair)).copied().unwrap_or(ReckOnPair::REST)
    }

    fn input_weight(&self, input: u16, neuron: u16) -> i8 {
        weight(&self.inputs, input, neuron)
    }

    fn recurrent_weight(&self, from: u16, to: u16) -> i8 {
        weight(self.recurrent, from, to)
    }

    fn output_weight(&self, neuron: u16, output: u16) -> i8 {
        weight(&self.outputs, neuron, output)
    }

    fn shared(&self) -> ReckOnShared {
        self.shared
    }
}

pub(super) fn check<B, P>(network: &impl DescribeReckOn) -> Result<(), ChipError<B, P>> {
    in_range("neurons", network.neurons().into(), 1, 256)?;
    in_range("inputs", network.inputs().into(), 1, 256)?;
    in_range("outputs", network.outputs().into(), 1, 16)?;
    for pair in 0..network.neurons().div_ceil(2) {
        let ReckOnPair { keep, threshold } = network.pair(pair);
        in_range("keep", keep.into(), 7 << 12, 0x8FFF)?;
        in_range("threshold", threshold.into(), 1, i16::MAX.into())?;
    }
    for shift in network.shared().shifts {
        in_range("shift", shift.into(), 0, 7)?;
    }
    Ok(())
}
