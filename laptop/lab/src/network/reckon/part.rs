//! The neurons of the chip that together do what one neuron of the network does.

use super::super::controller::Reset;
use super::super::trained::Layer;

/// The part that a neuron of the chip has in a neuron of the network.
///
/// A neuron of the network is one neuron of the chip, [`Main`](Self::Main), unless its reset is
/// [`Reset::SubtractNoDelay`]. With a potential m, a share k that a step keeps, and a threshold θ, such a neuron
/// computes in each step:
/// ```text
/// over    = m > θ
/// next    = k m + drive
/// fires   = next - (θ if over) > θ
/// m       = next - (θ if fires)
/// ```
/// It compares twice: m alone, and then the potential with the drive of the step. It also subtracts θ for the second
/// comparison only. So it takes three neurons of the chip: [`Over`](Self::Over) holds m and compares it, one tick before
/// the inputs of the step. Its spike takes θ from [`Main`](Self::Main) for the comparison at the next tick, and
/// [`Return`](Self::Return) gives it back one tick later. In a recurrent layer a fourth neuron,
/// [`Relay`](Self::Relay), keeps the spikes that act in the next step from acting before the first comparison.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Part {
    /// Fires when the neuron of the network fires.
    Main,
    /// Fires if the potential is above the threshold at the beginning of a step.
    Over,
    /// Repeats the spikes of [`Over`](Self::Over) one tick later.
    Return,
    /// Repeats the spikes of [`Main`](Self::Main) one tick before the next comparison of `Main`.
    Relay,
}

impl Part {
    /// Returns the parts of a neuron of `layer`.
    pub(super) fn of(layer: &Layer) -> &'static [Self] {
        match layer.reset {
            Reset::SubtractNoDelay if layer.recurrent.is_empty() => {
                &[Self::Main, Self::Over, Self::Return]
            }
            Reset::SubtractNoDelay => &[Self::Main, Self::Over, Self::Return, Self::Relay],
            _ => &[Self::Main],
        }
    }

    /// Returns whether this part only repeats spikes of another part.
    pub(super) fn repeats(self) -> bool {
        matches!(self, Self::Return | Self::Relay)
    }

    /// Returns by how many ticks this part compares before [`Main`](Self::Main).
    pub(super) fn ahead(self) -> usize {
        usize::from(matches!(self, Self::Over | Self::Relay))
    }

    /// Returns the tick of a step at which this part compares, in the layer with index `layer`. A step has `ticks`
    /// ticks.
    pub(super) fn tick(self, layer: usize, ticks: usize) -> usize {
        (layer + ticks - self.ahead()) % ticks
    }
}

/// A neuron of the chip, as part of a neuron of the network.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Seat {
    /// Index of the layer.
    pub(super) layer: usize,
    pub(super) part: Part,
    /// Index of the neuron in the layer.
    pub(super) neuron: usize,
}

impl Seat {
    pub(super) fn main(layer: usize, neuron: usize) -> Self {
        Self { layer, part: Part::Main, neuron }
    }
}
