//! A network for `ReckOn`, as constant data.

use crate::ChipError;
use crate::error::in_range;

/// The parameters that two neighbouring neurons share.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ReckOnPair {
    /// The part of the potential that stays in a time step, of 32 768: 28 672 (0.875) to 36 863 (1.125).
    pub keep: u16,
    /// The potential at which a neuron fires, 1 to 32 767.
    pub threshold: i16,
}

impl ReckOnPair {
    /// Neurons that keep their potential and hardly ever fire.
    pub const REST: Self = Self { keep: 1 << 15, threshold: i16::MAX };
}

/// The parameters that all neurons share.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ReckOnShared {
    /// Shifts left of the weights of inputs, neurons and outputs, 0 to 7 each.
    pub shifts: [u8; 3],
    /// The part of an output's potential that stays in a time step, of 128.
    pub keep: u8,
    /// Whether a neuron that fires returns to 0; else its threshold is subtracted.
    pub resets_to_zero: bool,
}

/// A network that [`Programmed::load`](super::Programmed::load) can write.
pub trait DescribeReckOn {
    /// The number of neurons, 1 to 256.
    fn neurons(&self) -> u16;
    /// The number of inputs, 1 to 256.
    fn inputs(&self) -> u16;
    /// The number of outputs, 1 to 16.
    fn outputs(&self) -> u16;
    /// The parameters that neurons `2 * pair` and `2 * pair + 1` share.
    fn pair(&self, pair: u16) -> ReckOnPair;
    /// The weight from an input to a neuron.
    fn input_weight(&self, input: u16, neuron: u16) -> i8;
    /// The weight from a neuron to a neuron.
    fn recurrent_weight(&self, from: u16, to: u16) -> i8;
    /// The weight from a neuron to an output.
    fn output_weight(&self, neuron: u16, output: u16) -> i8;
    /// The parameters that all neurons share.
    fn shared(&self) -> ReckOnShared;
}

/// A network as constant data: `IN` inputs, `N` neurons, `OUT` outputs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReckOnNetwork<const IN: usize, const N: usize, const OUT: usize> {
    /// The parameters that two neurons each share: `N / 2` pairs, rounded up.
    pub pairs: &'static [ReckOnPair],
    /// Weights from each input to the neurons.
    pub inputs: [[i8; N]; IN],
    /// Weights from each neuron to the neurons; empty if there are none.
    pub recurrent: &'static [[i8; N]],
    /// Weights from each neuron to the outputs.
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
        // More than the chip has stay more.
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
