//! Gaussian receptive fields (GRF), one spike a sample, winner takes all.

use super::position::Position;

/// Gaussian receptive fields: every sample fires the neuron with the largest response.
///
/// Fields of equal width respond by distance alone, so the winner is the nearest centre and no
/// exponential is needed: this is [`Position`] under its other name, with [even
/// centres](Position::linear) `mu[i] = min + (2i - 1) / 2 * (max - min) / (M - 2)` as the
/// paper has them. A value far outside the range fires the neuron at that end, where the paper's
/// toolbox underflows to neuron 0.
///
/// - **Latency:** 0 samples. **Memory:** that of [`Position`].
/// - **Error:** at most half a spacing, `(max - min) / (2 (M - 2))`, inside the range.
///
/// Source: paper, section II-A, algorithm 2.
///
/// ```
/// use spikewire::{Scheme, population::Gaussian};
///
/// static TILT: Gaussian<f32, 20> = Gaussian::linear(-9.0..=9.0);
///
/// let neuron = TILT.encoder().encode(4.7);
/// assert_eq!(neuron.map(|n| n.index()), Some(14));
/// assert_eq!(TILT.decoder().decode(neuron), 4.5);
/// ```
pub type Gaussian<S, const M: usize> = Position<S, M>;
