//! The trait of a catalogue entry, for visitors.

use spikewire::population::Position;
use spikewire::{ConfigError, Sample, Scheme, Spike, Start};

use crate::plain::{self, Plain};
use crate::{Channel, InC, Info, Scaled, State};

/// A scheme of the catalogue.
pub trait Entry {
    /// The description of the scheme, without running it.
    const INFO: Info;

    /// The scheme's forms in C; empty if its encoders need a generator.
    const IN_C: &'static [InC];

    /// Hands the instances that fly the recorded flight to a visitor.
    ///
    /// # Errors
    /// Those of the visitor, and parameters that the channel's calibration makes bad.
    fn fly<V: Flight>(channel: &Channel<V::Sample>, visitor: &mut V) -> Result<(), V::Error>;

    /// Hands the instances whose instructions are counted to a visitor.
    ///
    /// # Errors
    /// Those of the visitor, and parameters that the signal makes bad.
    fn count<V: Count>(signal: &Scaled<V::Sample>, visitor: &mut V) -> Result<(), V::Error>;
}

/// Takes schemes as they fly.
pub trait Flight {
    /// The sample type that it wants.
    type Sample: Sample;
    /// Why it stops.
    type Error: From<ConfigError>;

    /// Takes one instance, by its name and its name in words, with the state from which its encoder starts.
    ///
    /// # Errors
    /// The visitor's own.
    fn visit<P: Scheme<Sample = Self::Sample, EncoderState: State, DecoderState: State>>(
        &mut self,
        name: &'static str,
        words: &'static str,
        scheme: &P,
        start: P::EncoderState,
    ) -> Result<(), Self::Error>;
}

/// Takes schemes with their plain transcriptions, which write a number of spikes, a neuron or a slot as one `i8`.
pub trait Count {
    /// How many parts the catalogue is taken in, where a program of all does not fit a small core's flash.
    const PARTS: usize = 1;
    /// The index of the part that it wants.
    const PART: usize = 0;

    /// The sample type that it wants.
    type Sample: Plain;
    /// Why it stops.
    type Error: From<ConfigError>;

    /// A code of one `i8` a sample. `encode` is the transcription of its encoder, `decode` of its decoder.
    ///
    /// # Errors
    /// The visitor's own.
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

    /// A code of one `i8` a sample, whose encoders start so.
    ///
    /// # Errors
    /// The visitor's own.
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

    /// A rate code. `encode` works in place on the signal less the shift. `agreeing` is the scheme with the very
    /// parameters of the transcription, where that cannot have those of the one that is counted.
    ///
    /// # Errors
    /// The visitor's own.
    fn rate<P: Start<Sample = Self::Sample, Code = Spike>>(
        &mut self,
        name: &'static str,
        scheme: &P,
        agreeing: &P,
        taps: &[Self::Sample],
        shift: Self::Sample,
        encode: impl FnOnce(&mut [Self::Sample], &mut [i8]),
    ) -> Result<(), Self::Error>;

    /// The winner of `M` neurons by their exponentials, which rounding may decide between two neurons.
    ///
    /// # Errors
    /// The visitor's own.
    fn winner<const M: usize>(
        &mut self,
        name: &'static str,
        scheme: &Position<Self::Sample, M>,
        means: &[f32; M],
        sigmas: &[f32; M],
        encode: impl FnOnce(&[Self::Sample], &mut [i8]),
    ) -> Result<(), Self::Error>;

    /// A code that says something of each of `M` neurons, one `i8` each; a value decoded may be off by rounding.
    /// `decode` takes the value before the first.
    ///
    /// # Errors
    /// The visitor's own.
    fn neurons<P: Scheme<Sample = Self::Sample, Code: PartialEq>, const M: usize>(
        &mut self,
        name: &'static str,
        scheme: &P,
        start: &impl Fn() -> P::EncoderState,
        code: impl Fn(&[i8]) -> P::Code,
        encode: impl FnMut(&[Self::Sample], &mut [i8]),
        decode: impl Fn(&[i8], Self::Sample, &mut [Self::Sample]),
    ) -> Result<(), Self::Error>;

    /// A temporal code whose decoder adds up steps of this size.
    ///
    /// # Errors
    /// The visitor's own.
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

/// The spike of a sign.
pub(crate) fn spike_of(sign: i8) -> Spike {
    match sign {
        1 => Spike::Up,
        0 => Spike::None,
        _ => Spike::Down,
    }
}
