//! Keyframes: the value that a channel's decoder should hold at one point of the stream.

use super::Tick;
use crate::{Sample, SampleKind};

/// The value that the decoder of an address should hold between the events before the keyframe and those after it.
///
/// 12 bytes. It makes the decoder of a temporal code exact again after a loss.
///
/// ```
/// use spikewire::{Keyframe, SampleKind, Tick};
///
/// let keyframe = Keyframe::new(Tick::from_micros(1_000), 2, 0.5_f32);
/// assert_eq!(keyframe.kind, SampleKind::F32);
/// assert_eq!(keyframe.value::<f32>(), Some(0.5));
/// assert_eq!(keyframe.value::<i16>(), None); // another sample type
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Keyframe {
    /// The tick of the sample after which the value holds.
    pub tick: Tick,
    /// The address of the channel's first neuron.
    pub address: u16,
    /// The sample type.
    pub kind: SampleKind,
    /// The sample's bits; those of a 16-bit sample in the low half.
    pub bits: u32,
}

impl Keyframe {
    /// The keyframe of an address whose decoder should hold this sample.
    pub fn new<S: Sample>(tick: Tick, address: u16, sample: S) -> Self {
        Self { tick, address, kind: S::KIND, bits: sample.to_bits32() }
    }

    /// The sample; `None` if it has another type than `S`.
    pub fn value<S: Sample>(&self) -> Option<S> {
        (self.kind == S::KIND).then(|| S::from_bits32(self.bits))
    }
}
