//! The trait of a catalogue entry, and those of its visitors.

use spikewire::population::Position;
use spikewire::{ConfigError, Sample, Scheme, Spike, Start};

use crate::plain::{self, Plain};
use crate::{Channel, InC, Info, Scaled, Storable};

/// A scheme of the catalogue.
pub trait Entry {
    /// The description of the scheme.
    const INFO: Info;

    /// The scheme's forms in C; empty if its encoders need a random generator.
    const IN_C: &'static [InC];

    /// Passes the instances that fly the recorded flight to a visitor.
    ///
    /// # Errors
    /// Returns the visitor's errors, and an error if the channel's calibration gives an invalid parameter.
    fn fly<V: Flight>(channel: &Channel<V::Sample>, visitor: &mut V) -> Result<(), V::Error>;

    /// Passes the instances whose instructions are counted to a visitor.
    ///
    /// # Errors
    /// Returns the visitor's errors, and an error if the signal gives an invalid parameter.
    fn count<V: Count>(signal: &Scaled<V::Sample>, visitor: &mut V) -> Result<(), V::Error>;
}

/// A visitor of the instances that fly.
pub trait Flight {
    /// The sample type of the instances.
    type Sample: Sample;
    /// The visitor's error type.
    type Error: From<ConfigError>;

    /// Visits one instance, with its name, its name in words, and the state in which its encoder starts.
    ///
    /// # Errors
    /// Returns the visitor's errors.
    fn visit<P: Storable<Sample = Self::Sample>>(
        &mut self,
        name: &'static str,
        words: &'static str,
        scheme: &P,
        start: P::EncoderState,
    ) -> Result<(), Self::Error>;
}

/// A visitor of the instances whose instructions are counted, and of their plain transcriptions. These write a number
/// of spikes, a neuron or a slot as one `i8`.
pub trait Count {
    /// Number of parts into which the catalogue is divided, if a program with all schemes does not fit a small core's
    /// flash.
    const PARTS: usize = 1;
    /// Index of the part to visit.
    const PART: usize = 0;

    /// The sample type of the instances.
    type Sample: Plain;
    /// The visitor's error type.
    type Error: From<ConfigError>;

    /// Visits a code with one `i8` for each sample. `encode` is the transcription of its encoder, `decode` that of its
    /// decoder.
    ///
    /// # Errors
    /// Returns the visitor's errors.
    fn coded<P: Start<Sample = Self::Sample>>(
        &mut self,
        name: &'static str,
        scheme: &P,
        to_plain: impl Fn(P::Code) -> i8,
        of_plain: impl Fn(i8) -> P::Code,
        encode: impl FnOnce(&[Self::Sample], &mut [i8]),
        decode: impl FnOnce(&[i8], &mut [Self::Sample]),
    ) -> Result<(), Self::Error> {
        self.coded_from(name, scheme, &|| P::START, to_plain, of_plain, encode, decode)
    }

    /// Visits a code with one `i8` for each sample, whose encoders start in the states that `start` makes.
    ///
    /// # Errors
    /// Returns the visitor's errors.
    #[allow(clippy::too_many_arguments)]
    fn coded_from<P: Scheme<Sample = Self::Sample>>(
        &mut self,
        name: &'static str,
        scheme: &P,
        start: &impl Fn() -> P::EncoderState,
        to_plain: impl Fn(P::Code) -> i8,
        of_plain: impl Fn(i8) -> P::Code,
        encode: impl FnOnce(&[Self::Sample], &mut [i8]),
        decode: impl FnOnce(&[i8], &mut [Self::Sample]),
    ) -> Result<(), Self::Error>;

    /// Visits a rate code. `encode` works in place on the signal minus the shift. `agreeing` is the scheme with exactly
    /// the parameters of the transcription, for cases in which the counted scheme cannot have them.
    ///
    /// # Errors
    /// Returns the visitor's errors.
    fn rate<P: Start<Sample = Self::Sample, Code = Spike>>(
        &mut self,
        name: &'static str,
        scheme: &P,
        agreeing: &P,
        taps: &[Self::Sample],
        shift: Self::Sample,
        encode: impl FnOnce(&mut [Self::Sample], &mut [i8]),
    ) -> Result<(), Self::Error>;

    /// Visits a code in which one of `M` neurons wins, with a transcription that compares exponentials. Rounding may
    /// make it choose a neighbouring neuron.
    ///
    /// # Errors
    /// Returns the visitor's errors.
    fn winner<const M: usize>(
        &mut self,
        name: &'static str,
        scheme: &Position<Self::Sample, M>,
        means: &[f32; M],
        sigmas: &[f32; M],
        encode: impl FnOnce(&[Self::Sample], &mut [i8]),
    ) -> Result<(), Self::Error>;

    /// Visits a code with one `i8` for each of `M` neurons; decoded values may differ by rounding. `decode` is given
    /// the value before the first.
    ///
    /// # Errors
    /// Returns the visitor's errors.
    fn neurons<P: Scheme<Sample = Self::Sample, Code: PartialEq>, const M: usize>(
        &mut self,
        name: &'static str,
        scheme: &P,
        start: &impl Fn() -> P::EncoderState,
        code: impl Fn(&[i8]) -> P::Code,
        encode: impl FnMut(&[Self::Sample], &mut [i8]),
        decode: impl Fn(&[i8], Self::Sample, &mut [Self::Sample]),
    ) -> Result<(), Self::Error>;

    /// Visits a temporal code whose decoder adds up steps of size `step`.
    ///
    /// # Errors
    /// Returns the visitor's errors.
    fn steps<P: Start<Sample = Self::Sample, Code = Spike>>(
        &mut self,
        name: &'static str,
        scheme: &P,
        step: Self::Sample,
        encode: impl FnOnce(&[Self::Sample], &mut [i8]),
    ) -> Result<(), Self::Error> {
        self.coded(name, scheme, Spike::sign, spike_of, encode, |spikes, values| {
            plain::step_decode(spikes, step, values);
        })
    }
}

/// Converts a sign to a spike.
pub(crate) fn spike_of(sign: i8) -> Spike {
    match sign {
        1 => Spike::Up,
        0 => Spike::None,
        _ => Spike::Down,
    }
}
