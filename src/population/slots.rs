//! Gaussian receptive fields with sub-timesteps: the stronger the response, the earlier the spike.

use super::fields::ReceptiveFields;
use super::spaced::Distance;
use crate::error::{ConfigError, within};
use crate::sample::Tally;
use crate::spike::{Code, Firing, Polarity};
use crate::{Decoder, Encoder, Output, Sample, Scheme};

/// Gaussian receptive fields with `N` sub-timesteps, slots, a sample.
///
/// A response of level `k` (see [`ReceptiveFields`]) fires in slot `N - k`; a level below the floor
/// is silent.
///
/// - **Floor:** 1 to `N`; 1 unless [told](Self::with_floor).
/// - **Latency:** 0 samples, within which the slots last as long as the caller makes them.
///   **Memory:** 12 bytes an encoder; the fields are in flash, shared.
/// - **Work:** only neurons that respond, and one more at either end, are visited; no exponential.
/// - **Range:** a value so far outside the range that no neuron reaches the floor fires none.
/// - **Decoder:** the mean of the centres weighted by their levels, `N - slot`.
///
/// Source: Bohté et al. 2002; paper, section II-A.
///
/// ```
/// use spikewire::{Decoder, Encoder, Scheme, population::{ReceptiveFields, Slots}};
///
/// static FIELDS: ReceptiveFields<f32, 4, 100> = ReceptiveFields::<f32, _, _>::checked(0.0, 1.0, 1.5);
/// const TILT: Slots<f32, 4, 100> = Slots::new(&FIELDS);
///
/// let volley = TILT.encoder().encode(0.1);
/// assert!(volley.iter().eq([(0, 42), (1, 10), (2, 85)]));
/// assert!((TILT.decoder().decode(volley) - 0.1).abs() < 0.05);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Slots<'a, S: Sample, const M: usize, const N: usize> {
    fields: &'a ReceptiveFields<S, M, N>,
    floor: u16,
}

impl<'a, S: Sample, const M: usize, const N: usize> Slots<'a, S, M, N> {
    /// A scheme with these fields, in which every level from 1 fires.
    pub const fn new(fields: &'a ReceptiveFields<S, M, N>) -> Self {
        Self { fields, floor: 1 }
    }

    /// The same with silent neurons below this level.
    ///
    /// # Errors
    /// The floor is not within 1 to `N`.
    pub const fn with_floor(self, floor: u16) -> Result<Self, ConfigError> {
        match within("floor", floor as f64, 1.0, N as f32) {
            Ok(()) => Ok(Self { fields: self.fields, floor }),
            Err(error) => Err(error),
        }
    }
}

impl<S: Sample, const M: usize, const N: usize> Slots<'_, S, M, N> {
    /// The spikes of a finite sample, in an empty volley.
    #[inline]
    fn fire(&self, sample: S, volley: &mut Volley<M, N>) {
        if self.fields.is_near(sample) {
            self.fire_near(sample, volley);
        } else {
            self.fire_anywhere::<S::Reach>(sample, volley);
        }
    }

    #[inline(never)] // one copy, with the registers to itself
    fn fire_near(&self, sample: S, volley: &mut Volley<M, N>) {
        if !self.fire_from::<S::Short>(sample, self.fields.first(sample), volley) {
            self.fire_anywhere::<S::Short>(sample, volley);
        }
    }

    /// Where the first neuron does not fire, the next may.
    #[cold]
    #[inline(never)]
    fn fire_anywhere<D: Distance<S>>(&self, sample: S, volley: &mut Volley<M, N>) {
        let mut first = self.fields.first(sample);
        while !self.fire_from::<D>(sample, first, volley) && self.fields.is_above(sample, first) {
            first += 1;
        }
    }

    /// Fires the neurons from `first` on that have a finite sample within reach, and says whether any has.
    #[inline]
    fn fire_from<D: Distance<S>>(
        &self,
        sample: S,
        first: usize,
        volley: &mut Volley<M, N>,
    ) -> bool {
        let reach = self.fields.reach::<D>(self.floor.into());
        let distances = self.fields.distances::<D>(sample, first);
        let (Some(reach), Some(distances)) = (reach, distances) else { return false };
        let mut length = 0_usize;
        for (slot, distance) in volley.slots.iter_mut().zip(distances) {
            if distance > reach {
                break;
            }
            *slot = self.fields.slot(distance) as u8;
            length += 1;
        }
        if length > 0 {
            volley.first = first as u16;
            volley.length = length as u16;
        }
        length > 0
    }
}

impl<'a, S: Sample, const M: usize, const N: usize> Scheme for Slots<'a, S, M, N> {
    type Sample = S;
    type Encoder = SlotsEncoder<'a, S, M, N>;
    type Decoder = SlotsDecoder<'a, S, M, N>;

    const LATENCY: usize = 0;

    fn encoder(self) -> Self::Encoder {
        SlotsEncoder { scheme: self, tally: Tally::default() }
    }

    fn decoder(self) -> Self::Decoder {
        SlotsDecoder { fields: self.fields, value: self.fields.middle() }
    }
}

/// The spikes of one sample: neighbouring neurons, each in its slot of `N`.
///
/// `M + 4` bytes, rounded up to words.
#[repr(align(4))]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Volley<const M: usize, const N: usize> {
    first: u16,
    length: u16,
    slots: [u8; M],
}

impl<const M: usize, const N: usize> Volley<M, N> {
    /// No spike.
    pub const EMPTY: Self = Self { first: 0, length: 0, slots: [0; M] };

    /// Neighbouring neurons from `first` on, each in its slot, as they came over a link or from a file.
    ///
    /// `None` if they reach beyond the `M` neurons, or a slot is not below `N`.
    pub fn new(first: u16, slots: &[u8]) -> Option<Self> {
        let end = usize::from(first) + slots.len();
        if end > M || slots.iter().any(|&slot| usize::from(slot) >= N) {
            return None;
        }
        let mut volley = Self { first, length: slots.len() as u16, ..Self::EMPTY };
        for (known, &slot) in volley.slots.iter_mut().zip(slots) {
            *known = slot;
        }
        Some(volley)
    }

    /// The neurons that fire, by rising index, each with its slot.
    pub fn iter(&self) -> impl Iterator<Item = (u16, u16)> {
        (self.first..)
            .zip(self.slots.iter().take(self.length as usize))
            .map(|(neuron, &slot)| (neuron, slot.into()))
    }

    /// How many neurons fire.
    pub const fn len(&self) -> usize {
        self.length as usize
    }

    /// Whether none fires.
    pub const fn is_empty(&self) -> bool {
        self.length == 0
    }
}

impl<const M: usize, const N: usize> Code for Volley<M, N> {
    const NEURONS: usize = M;
    const SLOTS: usize = N;

    fn firings(&self) -> impl Iterator<Item = Firing> {
        self.iter().map(|(neuron, slot)| Firing { neuron, slot, polarity: Polarity::Up })
    }
}

impl<const M: usize, const N: usize> Output for Volley<M, N> {
    type Code = Self;

    fn code(self) -> Option<Self> {
        Some(self)
    }
}

/// The firing neurons, each with its slot: `[[0, 42], [1, 10]]`.
#[cfg(feature = "serde")]
impl<const M: usize, const N: usize> serde::Serialize for Volley<M, N> {
    fn serialize<Z: serde::Serializer>(&self, serializer: Z) -> Result<Z::Ok, Z::Error> {
        crate::serial::sequence(|| self.iter(), serializer)
    }
}

/// The encoder of [`Slots`].
#[derive(Clone, Copy, Debug)]
pub struct SlotsEncoder<'a, S: Sample, const M: usize, const N: usize> {
    scheme: Slots<'a, S, M, N>,
    tally: Tally,
}

impl<S: Sample, const M: usize, const N: usize> SlotsEncoder<'_, S, M, N> {
    /// Encodes into an empty volley.
    #[inline]
    fn encode_into(&mut self, sample: S, volley: &mut Volley<M, N>) {
        if sample.is_finite() {
            self.scheme.fire(sample, volley);
        } else {
            self.tally.reject();
        }
    }
}

impl<S: Sample, const M: usize, const N: usize> Encoder for SlotsEncoder<'_, S, M, N> {
    type Sample = S;
    type Output = Volley<M, N>;

    #[inline]
    fn encode(&mut self, sample: S) -> Volley<M, N> {
        let mut volley = Volley::EMPTY;
        self.encode_into(sample, &mut volley);
        volley
    }

    fn encode_slice(&mut self, samples: &[S], outputs: &mut [Volley<M, N>]) -> usize {
        for (volley, &sample) in outputs.iter_mut().zip(samples) {
            *volley = Volley::EMPTY;
            self.encode_into(sample, volley);
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

/// The decoder of [`Slots`].
///
/// Where no neuron fired it holds its value, at first the middle centre. One division a sample.
/// Fixed point gives the exact mean, rounded to the nearest, halves upwards. Memory: 8 bytes in
/// `f32`.
#[derive(Clone, Copy, Debug)]
pub struct SlotsDecoder<'a, S: Sample, const M: usize, const N: usize> {
    fields: &'a ReceptiveFields<S, M, N>,
    value: S,
}

impl<S: Sample, const M: usize, const N: usize> Decoder for SlotsDecoder<'_, S, M, N> {
    type Sample = S;
    type Code = Volley<M, N>;

    fn decode(&mut self, volley: Volley<M, N>) -> S {
        let slots = volley.slots.get(..volley.len()).unwrap_or(&volley.slots);
        let levels = slots.iter().map(|&slot| Some(N as u32 - u32::from(slot)));
        if let Some(mean) = self.fields.mean(volley.first.into(), levels) {
            self.value = mean;
        }
        self.value
    }

    fn resync(&mut self, value: S) {
        self.value = value;
    }

    fn reset(&mut self) {
        self.value = self.fields.middle();
    }
}
