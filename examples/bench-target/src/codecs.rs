//! Every counted scheme of the catalogue beside its plain transcription, with which it must agree: spikes and values
//! are compared before anything is counted.

use core::{
    fmt::{self, Write},
    hint::black_box,
    mem::size_of_val,
};

use board::stopwatch::{Count as Cost, instructions};
use catalogue::{
    Count, Scaled,
    plain::{self, response},
};
use spikewire::{
    Calibration, ConfigError, Output, Scheme, Spike, Start,
    population::{Neuron, Position},
};

use crate::{
    in_c,
    measure::{CHUNK, Subject, decode_sample, encode_sample},
    signal::{LENGTH, Measured, Signal},
};

/// Measures the codecs of one half of the catalogue in one sample type on one signal.
pub fn measure<S: Measured, const HALF: usize>(
    out: &mut impl Write,
    sample: &str,
    source: Signal,
) -> fmt::Result {
    let mut counter = Counter::<S, _, HALF> {
        out,
        sample,
        source,
        scaled: None,
        signal: [S::default(); LENGTH],
        spikes: [0; LENGTH],
    };
    counter.load();
    let mut calibration = Calibration::<S>::new();
    counter.signal.iter().for_each(|&sample| calibration.observe(sample));
    let scaled = Scaled::new(calibration);
    counter.scaled = Some(scaled);
    catalogue::count(&scaled, &mut counter).map_err(|failure| {
        let _ = writeln!(counter.out, "{failure:?}");
        fmt::Error
    })
}

/// Either a bad parameter or a console that fails.
#[derive(Debug)]
enum Failure {
    #[allow(dead_code)] // read by Debug
    Config(ConfigError),
    /// A codec and its plain transcription, at this sample.
    #[allow(dead_code)]
    Differ(&'static str, usize),
    Console,
}

impl From<ConfigError> for Failure {
    fn from(error: ConfigError) -> Self {
        Self::Config(error)
    }
}

impl From<fmt::Error> for Failure {
    fn from(_: fmt::Error) -> Self {
        Self::Console
    }
}

/// Room for the signal and for what it becomes; a Cortex-M0 has no more.
struct Counter<'a, S, W, const HALF: usize> {
    out: &'a mut W,
    sample: &'a str,
    source: Signal,
    /// Once the signal is known.
    scaled: Option<Scaled<S>>,
    signal: [S; LENGTH],
    spikes: [i8; LENGTH],
}

impl<S: Measured, W: Write, const HALF: usize> Counter<'_, S, W, HALF> {
    fn load(&mut self) {
        self.source.load(&mut self.signal);
    }

    /// The compiler must not know their lengths, as it does not know those that the codecs get.
    fn slices(&mut self) -> (&mut [S], &mut [i8]) {
        self.spikes.fill(0);
        (black_box(&mut self.signal[..]), black_box(&mut self.spikes[..]))
    }

    fn subject<'s>(
        sample: &'s str,
        source: Signal,
        codec: &'s str,
        scheme: &impl Scheme,
        plain: (u32, u32),
        in_c: Cost,
    ) -> Subject<'s> {
        Subject { signal: source.name(), codec, sample, flash: size_of_val(scheme), plain, in_c }
    }

    /// Returns the cost of the encoder in C and a digest of its spikes, if there is one.
    fn in_c(&mut self, codec: &str, taps: &[S]) -> Option<(Cost, u32)> {
        let scaled = self.scaled?;
        let (signal, spikes) = self.slices();
        let cost = in_c::encode(codec, &scaled, taps, signal, spikes)?;
        Some((cost, self.digest()))
    }

    fn digest(&self) -> u32 {
        self.spikes
            .iter()
            .fold(0, |sum: u32, &spike| sum.wrapping_mul(31).wrapping_add(spike as u32))
    }

    /// Fails unless the codec's spikes and values are those of the transcription, which the buffers hold. Loads the
    /// signal again.
    fn agree<P: Scheme<Sample = S>>(
        &mut self,
        codec: &'static str,
        scheme: &P,
        start: &impl Fn() -> P::EncoderState,
        to_plain: impl Fn(P::Code) -> i8,
        of_plain: impl Fn(i8) -> P::Code,
    ) -> Result<(), Failure> {
        let mut decoder = scheme.decoder_state();
        for (i, (&value, &spike)) in self.signal.iter().zip(&self.spikes).enumerate() {
            expect(codec, i, decode_sample(scheme, &mut decoder, of_plain(spike)) == value)?;
        }
        self.load();
        let mut encoder = start();
        let mut spikes = self.spikes.iter().enumerate();
        let mut check = |code| match spikes.next() {
            Some((i, &spike)) => expect(codec, i, to_plain(code) == spike),
            None => expect(codec, LENGTH, false),
        };
        for &sample in &self.signal {
            encode_sample(scheme, &mut encoder, sample).code().map_or(Ok(()), &mut check)?;
        }
        while let Some(code) = scheme.finish_next(&mut encoder) {
            check(code)?;
        }
        expect(codec, LENGTH, spikes.next().is_none())
    }

    fn finish<P: Scheme<Sample = S>>(
        &mut self,
        codec: &'static str,
        scheme: &P,
        start: &impl Fn() -> P::EncoderState,
        plain: (u32, u32),
        in_c: Cost,
    ) -> Result<(), Failure> {
        let subject = Self::subject(self.sample, self.source, codec, scheme, plain, in_c);
        Ok(subject.measure(self.out, scheme, start, &self.signal)?)
    }
}

fn expect(codec: &'static str, sample: usize, agrees: bool) -> Result<(), Failure> {
    if agrees { Ok(()) } else { Err(Failure::Differ(codec, sample)) }
}

impl<S: Measured, W: Write, const HALF: usize> Count for Counter<'_, S, W, HALF> {
    const PARTS: usize = 2;
    const PART: usize = HALF;

    type Sample = S;
    type Error = Failure;

    fn coded_from<P: Scheme<Sample = S>>(
        &mut self,
        name: &'static str,
        scheme: &P,
        start: &impl Fn() -> P::EncoderState,
        to_plain: impl Fn(P::Code) -> i8,
        of_plain: impl Fn(i8) -> P::Code,
        encode: impl FnOnce(&[S], &mut [i8]),
        decode: impl FnOnce(&[i8], &mut [S]),
    ) -> Result<(), Failure> {
        let in_c = self.in_c(name, &[]);
        let (signal, spikes) = self.slices();
        let encoding = instructions(|| encode(signal, spikes));
        expect(name, LENGTH, in_c.is_none_or(|(_, digest)| digest == self.digest()))?;
        let (signal, spikes) = (&mut self.signal[..], &self.spikes[..]);
        let decoding = instructions(|| decode(spikes, signal));
        self.agree(name, scheme, start, to_plain, of_plain)?;
        self.finish(name, scheme, start, (encoding, decoding), in_c.unwrap_or_default().0)
    }

    fn rate<P: Start<Sample = S, Code = Spike>>(
        &mut self,
        name: &'static str,
        scheme: &P,
        agreeing: &P,
        taps: &[S],
        shift: S,
        encode: impl FnOnce(&mut [S], &mut [i8]),
    ) -> Result<(), Failure> {
        let below = |sample: &mut S| *sample = S::narrow((*sample).into() - shift.into());
        self.signal.iter_mut().for_each(below);
        let in_c = self.in_c(name, taps);
        self.load();
        self.signal.iter_mut().for_each(below);
        let (signal, spikes) = self.slices();
        let encoding = instructions(|| encode(signal, spikes));
        expect(name, LENGTH, in_c.is_none_or(|(_, digest)| digest == self.digest()))?;
        let (signal, spikes) = (&mut self.signal[..], &self.spikes[..]);
        let decoding = instructions(|| plain::rate_decode(spikes, taps, shift, signal));
        self.agree(name, agreeing, &|| P::START, Spike::sign, |sign| match sign {
            1 => Spike::Up,
            _ => Spike::None,
        })?;
        let in_c = in_c.unwrap_or_default().0;
        self.finish(name, scheme, &|| P::START, (encoding, decoding), in_c)
    }

    /// Between two neurons, so close to halfway that rounding decides which exponential is the larger, the
    /// transcription may say either: it is set right.
    fn winner<const M: usize>(
        &mut self,
        name: &'static str,
        scheme: &Position<S, M>,
        means: &[f32; M],
        sigmas: &[f32; M],
        encode: impl FnOnce(&[S], &mut [i8]),
    ) -> Result<(), Failure> {
        let (signal, neurons) = self.slices();
        let encoding = instructions(|| encode(signal, neurons));
        let mut state = Position::<S, M>::START;
        for (&sample, neuron) in signal.iter().zip(neurons.iter_mut()) {
            let Some(nearest) = encode_sample(scheme, &mut state, sample) else { continue };
            let response = |i: usize| response(sample.to_f64() as f32, means[i], sigmas[i]);
            let (ours, plain) = (response(nearest.index().into()), response(*neuron as usize));
            if (ours - plain).abs() <= 2.0 * f32::EPSILON {
                *neuron = nearest.index() as i8;
            }
        }
        let decoding = instructions(|| plain::position_decode(neurons, scheme.centres(), signal));
        let index = |neuron: Option<Neuron<M>>| neuron.map_or(-1, |neuron| neuron.index() as i8);
        self.agree(name, scheme, &|| Position::<S, M>::START, index, |index| {
            Neuron::new(index as u16)
        })?;
        let plain = (encoding, decoding);
        self.finish(name, scheme, &|| Position::<S, M>::START, plain, Cost::default())
    }

    /// As many samples at once as the spikes have room for.
    fn neurons<P: Scheme<Sample = S, Code: PartialEq>, const M: usize>(
        &mut self,
        name: &'static str,
        scheme: &P,
        start: &impl Fn() -> P::EncoderState,
        code: impl Fn(&[i8]) -> P::Code,
        mut encode: impl FnMut(&[S], &mut [i8]),
        decode: impl Fn(&[i8], S, &mut [S]),
    ) -> Result<(), Failure> {
        let (mut encoding, mut decoding) = (0, 0);
        let (mut encoder, mut decoder) = (start(), scheme.decoder_state());
        let mut before = scheme.held(&decoder).unwrap_or_default();
        for chunk in self.signal.chunks_exact_mut(CHUNK) {
            let (samples, spikes) = (black_box(chunk), black_box(&mut self.spikes[..CHUNK * M]));
            encoding += instructions(|| encode(samples, spikes));
            for (i, (&sample, spikes)) in samples.iter().zip(spikes.chunks(M)).enumerate() {
                let ours = encode_sample(scheme, &mut encoder, sample).code();
                expect(name, i, ours == Some(code(spikes)))?;
            }
            decoding += instructions(|| decode(spikes, before, samples));
            before = samples[CHUNK - 1];
            for (i, (&value, spikes)) in samples.iter().zip(spikes.chunks(M)).enumerate() {
                let ours = decode_sample(scheme, &mut decoder, code(spikes));
                expect(name, i, (ours.to_f64() - value.to_f64()).abs() <= S::MEAN)?;
            }
        }
        self.load();
        let plain = (encoding, decoding);
        let (sample, source) = (self.sample, self.source);
        let subject = Self::subject(sample, source, name, scheme, plain, Cost::default());
        Ok(subject.measure(self.out, scheme, start, &self.signal)?)
    }
}
