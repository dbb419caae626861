//! Gaussian receptive fields (GRF) with one spike a sample: the strongest response wins.

use super::position::Position;

/// Gaussian receptive fields: every sample fires the neuron with the largest response.
///
/// With fields of equal width the largest response is that of the nearest centre, so that no exponential is needed:
/// this is another name of [`Position`]. The paper takes [even centres](Position::linear),
/// `mu[i] = min + (2i - 1) / 2 * (max - min) / (M - 2)`. A value far outside the range fires the neuron at that end;
/// in the paper's toolbox all responses underflow there, and neuron 0 fires.
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
