//! Position coding: the neuron whose centre is nearest fires.

use core::num::NonZeroU16;

use super::centres::Centres;
use crate::sample::Tally;
use crate::spike::{Code, Firing, Polarity};
use crate::{Decoder, Encoder, Output, Sample, Scheme};

/// Position coding: every sample fires the one neuron whose centre is nearest.
///
/// - **Centres:** [linear](Centres::linear), [Gaussian-spaced](Centres::gaussian_spaced) or the
///   user's. A value halfway between two fires the lower; a value outside fires the neuron at that
///   end.
/// - **Latency:** 0 samples. **Memory:** 8 bytes an encoder; the centres are in flash, shared.
/// - **Exactness:** the nearest centre exactly, in every sample type.
/// - **Error:** at most half the distance between two centres, inside the centres' range.
///
/// Source: paper, section II-A, algorithm 1.
///
/// ```
/// use spikewire::{Decoder, Encoder, Scheme, population::{Centres, Position}};
///
/// static CENTRES: Centres<f32, 5> = Centres::<f32, _>::checked([-2.0, -0.5, 0.0, 0.5, 2.0]);
/// const ERROR: Position<f32, 5> = Position::new(&CENTRES);
///
/// let neuron = ERROR.encoder().encode(0.2);
/// assert_eq!(neuron.map(|n| n.index()), Some(2));
/// assert_eq!(ERROR.decoder().decode(neuron), 0.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Position<'a, S, const M: usize> {
    centres: &'a Centres<S, M>,
}

impl<'a, S, const M: usize> Position<'a, S, M> {
    /// A scheme with these centres.
    pub const fn new(centres: &'a Centres<S, M>) -> Self {
        Self { centres }
    }
}

impl<'a, S: Sample, const M: usize> Scheme for Position<'a, S, M> {
    type Sample = S;
    type Encoder = PositionEncoder<'a, S, M>;
    type Decoder = PositionDecoder<'a, S, M>;

    const LATENCY: usize = 0;

    fn encoder(self) -> Self::Encoder {
        PositionEncoder { centres: self.centres, tally: Tally::default() }
    }

    fn decoder(self) -> Self::Decoder {
        PositionDecoder { centres: self.centres, value: self.centres.middle() }
    }
}

/// One of `M` neurons.
///
/// Two bytes, and no more where there may be none.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct Neuron<const M: usize>(NonZeroU16);

impl<const M: usize> Neuron<M> {
    /// The neuron with this index, if there is one.
    pub const fn new(index: u16) -> Option<Self> {
        if (index as usize) < M { Self::counted(index + 1) } else { None }
    }

    /// Its index, 0 to `M - 1`.
    pub const fn index(self) -> u16 {
        self.0.get() - 1
    }

    /// The first is 1; 0 is none.
    const fn counted(number: u16) -> Option<Self> {
        match NonZeroU16::new(number) {
            Some(number) => Some(Self(number)),
            None => None,
        }
    }
}

impl<const M: usize> core::fmt::Debug for Neuron<M> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_tuple("Neuron").field(&self.index()).finish()
    }
}

#[cfg(feature = "defmt")]
impl<const M: usize> defmt::Format for Neuron<M> {
    fn format(&self, f: defmt::Formatter<'_>) {
        defmt::write!(f, "Neuron({})", self.index());
    }
}

/// Its index.
#[cfg(feature = "serde")]
impl<const M: usize> serde::Serialize for Neuron<M> {
    fn serialize<Z: serde::Serializer>(&self, serializer: Z) -> Result<Z::Ok, Z::Error> {
        serializer.serialize_newtype_struct("Neuron", &self.index())
    }
}

/// `None` for a sample that was not finite: no neuron fires.
impl<const M: usize> Code for Option<Neuron<M>> {
    const NEURONS: usize = M;

    fn firings(&self) -> impl Iterator<Item = Firing> {
        self.map(|neuron| Firing { neuron: neuron.index(), slot: 0, polarity: Polarity::Up })
            .into_iter()
    }
}

impl<const M: usize> Output for Option<Neuron<M>> {
    type Code = Self;

    fn code(self) -> Option<Self> {
        Some(self)
    }
}

/// The encoder of [`Position`] and [`Gaussian`](super::Gaussian).
#[derive(Clone, Copy, Debug)]
pub struct PositionEncoder<'a, S, const M: usize> {
    centres: &'a Centres<S, M>,
    tally: Tally,
}

impl<S: Sample, const M: usize> PositionEncoder<'_, S, M> {
    /// Apart, so that the usual path stays small.
    #[cold]
    #[inline(never)]
    fn search_each(&mut self, samples: &[S], outputs: &mut [Option<Neuron<M>>]) {
        for (output, &sample) in outputs.iter_mut().zip(samples) {
            *output = None;
            if sample.is_finite() {
                *output = Neuron::counted(self.centres.by_search(sample) as u16);
            } else {
                self.tally.reject();
            }
        }
    }
}

impl<S: Sample, const M: usize> Encoder for PositionEncoder<'_, S, M> {
    type Sample = S;
    type Output = Option<Neuron<M>>;

    #[inline]
    fn encode(&mut self, sample: S) -> Option<Neuron<M>> {
        if !sample.is_finite() {
            self.tally.reject();
            return None;
        }
        Neuron::counted(self.centres.nearest(sample) as u16)
    }

    fn encode_slice(&mut self, samples: &[S], outputs: &mut [Option<Neuron<M>>]) -> usize {
        let centres = self.centres;
        let mut taint = S::ZERO;
        if centres.has_cells() {
            // As if all were finite; if one was not, all over again.
            for (output, &sample) in outputs.iter_mut().zip(samples) {
                taint = taint.taint(sample);
                *output = Neuron::counted(centres.by_cell(sample) as u16);
            }
        }
        if !centres.has_cells() || !taint.is_finite() {
            self.search_each(samples, outputs);
        }
        samples.len().min(outputs.len())
    }

    fn reset(&mut self) {
        self.tally = Tally::default();
    }

    fn rejected(&self) -> u32 {
        self.tally.rejected()
    }
}

/// The decoder of [`Position`] and [`Gaussian`](super::Gaussian): the centre of the neuron.
///
/// Where none fired it holds its value, at first the middle centre. Memory: 8 bytes in `f32`.
#[derive(Clone, Copy, Debug)]
pub struct PositionDecoder<'a, S, const M: usize> {
    centres: &'a Centres<S, M>,
    value: S,
}

impl<S: Sample, const M: usize> PositionDecoder<'_, S, M> {
    #[inline]
    fn centre(&self, neuron: Option<Neuron<M>>) -> Option<S> {
        neuron.and_then(|Neuron(number)| self.centres.get(usize::from(number.get()) - 1))
    }
}

impl<S: Sample, const M: usize> Decoder for PositionDecoder<'_, S, M> {
    type Sample = S;
    type Code = Option<Neuron<M>>;

    #[inline]
    fn decode(&mut self, neuron: Option<Neuron<M>>) -> S {
        self.value = self.centre(neuron).unwrap_or(self.value);
        self.value
    }

    fn decode_slice(&mut self, neurons: &[Option<Neuron<M>>], values: &mut [S]) -> usize {
        let mut decoded = self.value;
        for (value, &neuron) in values.iter_mut().zip(neurons) {
            decoded = self.centre(neuron).unwrap_or(decoded);
            *value = decoded;
        }
        self.value = decoded;
        neurons.len().min(values.len())
    }

    fn resync(&mut self, value: S) {
        self.value = value;
    }

    fn reset(&mut self) {
        self.value = self.centres.middle();
    }
}
