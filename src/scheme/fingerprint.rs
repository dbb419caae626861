//! Fingerprints: 32 bits of a description of schemes, by which a receiver knows whether it has the sender's.

use core::fmt;

use crate::{Sample, SampleKind};

/// 32 bits of a description: of a scheme with its parameters, of a bank of channels, or of a whole flight.
///
/// A fingerprint is the CRC-32/ISO-HDLC, that of zlib, of the bytes of the description. Two descriptions of the same
/// length that differ in one parameter of up to 32 bits never share a fingerprint; any other two share one by a chance of
/// 1 in 2³². The [specification](#specification) says which bytes these are.
///
/// A [`Transmitter`](crate::link::Transmitter::for_bank) sends the fingerprint of its bank, and a
/// [`Receiver`](crate::link::Receiver) compares it with that of its own schemes.
///
/// - **Memory:** 4 bytes. **Work:** about 50 instructions for each byte of the description, for set-up.
///
/// ```
/// use spikewire::{Bank, Fingerprint, SampleKind, Scheme, temporal::StepForward};
///
/// static GYRO: StepForward<i16> = StepForward::new(120);
/// let scheme = GYRO.fingerprint();
/// assert_eq!(scheme, Fingerprint::new("StepForward").sample(120_i16));
/// assert_ne!(scheme, StepForward::<i16>::new(60).fingerprint());
///
/// let bank = Bank::<_, 2>::new(&GYRO).fingerprint();
/// let kind = SampleKind::Fixed16 { fraction: 0 };
/// assert_eq!(bank, Fingerprint::of_bank(kind, 0, 0, &[scheme; 2]));
/// assert_ne!(bank, bank.labelled("gyro.x rad/s, gyro.y rad/s")); // names and units, as both ends have them
/// ```
///
/// # Specification
///
/// All numbers are little endian. A *number* has 4 bytes. A *sample* has 4 bytes: the bits of an `f32`, or of an integer of
/// 32 bits; of an integer of 16 bits two bytes, and two bytes 0. A *list* is the number of its items, then each item. A
/// *text* is the number of its bytes, then the bytes in UTF-8.
///
/// - **A scheme** is its type's name as a text, then its parameters in the order of the table.
/// - **A filter before a scheme** is `Biquad` and gain, damping and tap, or `FirstOrder` and gain: doubles of 8 bytes each.
///   Both together have the filter's fingerprint, continued with that of the scheme as a number.
/// - **A bank** is the sample type as a number ([`SampleKind::to_byte`]), the first address and the length of a
///   sub-timestep in µs as numbers, for each channel the fingerprint of its scheme as a number, and how many channels
///   there are as a number.
/// - **Joined banks** are the text `Joint`, the fingerprint of each bank as a number, and how many banks there are as a number.
/// - **A label**, of which both ends only need to have the same, is a text. A bank with a label has the bank's
///   fingerprint, continued with that of the label as a number.
///
/// | scheme | parameters |
/// |---|---|
/// | `StepForward` | threshold |
/// | `SendOnDelta` | threshold; most spikes, a number |
/// | `AdaptiveStepForward` | threshold; doublings, run, numbers |
/// | `TemporalContrast` | threshold, step |
/// | `AdaptiveContrast` | threshold; doublings, a number |
/// | `MovingWindow` | threshold; samples of the window, a number |
/// | `Hough` | list of taps, shift |
/// | `ThresholdHough` | threshold, list of taps, shift |
/// | `Bsa` | 0 and the threshold, or 1 and the bits of the factor, numbers; list of taps, shift |
/// | `BsaToolbox` | bits of the factor, a number; list of taps, shift |
/// | `SigmaDelta`, `Bernoulli` | min, max; the decoder's mean: 0 for a window, 1 for an average, and its power, numbers |
/// | `WeightedBurst` | min, max, weight; doublings, a number; the decoder's mean |
/// | `IntegrateAndFire` | threshold, reference; power, 1 if leaky, most spikes, numbers |
/// | `Position` | list of centres, list of the edges between them |
/// | `Slots` | list of centres, min, max; bits of beta, levels, floor, numbers |
/// | `Probabilistic` | list of centres, min, max; bits of beta, levels, numbers |
/// | `NonLinearSlots` | list of centres; list of the fields' scales as the crate computes them, of 4 bytes in `f32` and 8 otherwise; list of their reaches, numbers; levels, a number |
/// | `RankOrder` | list of centres, min, max; spikes, a number |
/// | `FirstSpike` | list of values, list of the edges between them; 1, the largest silent sample and the value of silence, or 0 |
/// | `LatencyPhase` | list of the cells' lowest samples, max; latencies, period, neurons, spacing, phase, numbers |
/// | `WeightedPhase` | min, max; slots, a number |
/// | `Burst` | list of values, list of the edges between them, min; spikes and interval of each cell, numbers |
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[must_use]
pub struct Fingerprint(u32);

impl Fingerprint {
    /// The fingerprint of a description that begins with this name.
    pub const fn new(name: &str) -> Self {
        Self(0).text(name)
    }

    /// The fingerprint of these bits.
    pub const fn from_bits(bits: u32) -> Self {
        Self(bits)
    }

    /// The bits.
    pub const fn bits(self) -> u32 {
        self.0
    }

    /// The fingerprint of a bank whose channels have schemes with these fingerprints.
    pub const fn of_bank(
        kind: SampleKind,
        first_address: u16,
        slot_ticks: u32,
        schemes: &[Self],
    ) -> Self {
        let mut bank = Self::bank(kind, first_address, slot_ticks);
        let mut rest = schemes;
        while let [scheme, others @ ..] = rest {
            bank = bank.and(*scheme);
            rest = others;
        }
        bank.number(schemes.len() as u32)
    }

    /// The beginning of a bank's description, before its channels.
    pub(crate) const fn bank(kind: SampleKind, first_address: u16, slot_ticks: u32) -> Self {
        Self(0).number(kind.to_byte() as u32).number(first_address as u32).number(slot_ticks)
    }

    /// This fingerprint with a label that both ends share: names, units, the period, and whatever else they must agree on.
    pub const fn labelled(self, label: &str) -> Self {
        self.and(Self::new(label))
    }

    /// The description goes on with another's fingerprint, a number.
    pub const fn and(self, other: Self) -> Self {
        self.number(other.0)
    }

    /// The description goes on with a number.
    pub const fn number(self, number: u32) -> Self {
        self.bytes(&number.to_le_bytes())
    }

    /// The description goes on with a text.
    pub const fn text(self, text: &str) -> Self {
        self.number(text.len() as u32).bytes(text.as_bytes())
    }

    /// The description goes on with a sample.
    pub fn sample<S: Sample>(self, sample: S) -> Self {
        self.number(sample.to_bits32())
    }

    /// The description goes on with a list of samples.
    pub fn samples<S: Sample>(self, samples: &[S]) -> Self {
        let count = self.number(samples.len() as u32);
        samples.iter().fold(count, |description, &sample| description.sample(sample))
    }

    /// The description goes on with a double.
    pub const fn double(self, value: f64) -> Self {
        self.bytes(&value.to_bits().to_le_bytes())
    }

    /// The description goes on with these bytes.
    pub const fn bytes(self, bytes: &[u8]) -> Self {
        // Bit by bit: descriptions are short, and a table would take a kilobyte of flash.
        let mut crc = !self.0;
        let mut rest = bytes;
        while let [byte, others @ ..] = rest {
            crc ^= *byte as u32;
            let mut bit = 0;
            while bit < 8 {
                let low = crc & 1;
                crc >>= 1;
                if low == 1 {
                    crc ^= 0xEDB8_8320;
                }
                bit += 1;
            }
            rest = others;
        }
        Self(!crc)
    }
}

/// Eight hexadecimal digits.
impl fmt::Display for Fingerprint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:08x}", self.0)
    }
}
