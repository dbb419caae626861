//! Every codec, with the parameters of the paper's benchmark, beside its plain transcription, with which it must agree:
//! spikes and values are compared before anything is counted.

use core::{
    fmt::{self, Write},
    hint::black_box,
    mem::size_of_val,
};

use board::stopwatch::instructions;
use rand_pcg::{Pcg32, rand_core::Rng};
use spikewire::{
    Calibration, ConfigError, Output, Scheme, Spike, Start,
    population::{FiredNeurons, Gaussian, Neuron, Position, Probabilistic, SlotSpikes, Slots},
    rate::{Bsa, BsaToolbox, Hough, Scale, Shape, Taps, ThresholdHough},
    temporal::{MovingWindow, StepForward, TemporalContrast},
};

use crate::{
    measure::{CHUNK, Subject, decode_sample, encode_sample},
    plain,
    signal::{LENGTH, Measured, Signal},
};

/// Room for the signal and for what it becomes; a Cortex-M0 has no more.
struct Buffers<S> {
    signal: [S; LENGTH],
    spikes: [i8; LENGTH],
}

/// Measures every codec in one sample type on one signal.
pub fn measure<S: Measured>(out: &mut impl Write, sample: &str, signal: Signal) -> fmt::Result {
    let mut buffers = Buffers { signal: [S::default(); LENGTH], spikes: [0; LENGTH] };
    all(out, sample, signal, &mut buffers).map_err(|error| {
        let _ = writeln!(out, "{error:?}");
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

impl<S: Measured> Buffers<S> {
    /// The compiler must not know their lengths, as it does not know those that the codecs get.
    fn slices(&mut self) -> (&mut [S], &mut [i8]) {
        self.spikes.fill(0);
        (black_box(&mut self.signal[..]), black_box(&mut self.spikes[..]))
    }

    /// The plain transcription of a code on the raw signal, encoding and decoding.
    fn plain(
        &mut self,
        encode: impl FnOnce(&[S], &mut [i8]),
        decode: impl FnOnce(&[i8], &mut [S]),
    ) -> (u32, u32) {
        let (signal, spikes) = self.slices();
        let encoding = instructions(|| encode(signal, spikes));
        let decoding = instructions(|| decode(spikes, signal));
        (encoding, decoding)
    }

    /// The same of a rate code, which takes the minimum off first and works in place.
    fn plain_rate(
        &mut self,
        shift: S,
        taps: &[S],
        encode: impl FnOnce(&mut [S], &mut [i8]),
    ) -> (u32, u32) {
        for sample in &mut self.signal {
            *sample = S::narrow((*sample).into() - shift.into());
        }
        let (signal, spikes) = self.slices();
        let encoding = instructions(|| encode(signal, spikes));
        let decoding = instructions(|| plain::rate_decode(spikes, taps, shift, signal));
        (encoding, decoding)
    }

    /// The same of a code that says something of every neuron: as many samples at once as the spikes have room for.
    /// Fails unless the codec does the same, and its values are off by no more than rounding.
    fn plain_neurons<P, const M: usize>(
        &mut self,
        codec: &'static str,
        (scheme, mut encoder, middle): (&P, P::EncoderState, S),
        code: impl Fn(&[i8]) -> P::Code,
        mut encode: impl FnMut(&[S], &mut [i8]),
        decode: impl Fn(&[i8], S, &mut [S]),
    ) -> Result<(u32, u32), Failure>
    where
        P: Scheme<Sample = S, Code: PartialEq>,
    {
        let mut decoder = scheme.decoder_state();
        let (mut encoding, mut decoding) = (0, 0);
        let mut before = middle;
        for chunk in self.signal.chunks_exact_mut(CHUNK) {
            let (samples, spikes) = (black_box(chunk), black_box(&mut self.spikes[..CHUNK * M]));
            encoding += instructions(|| encode(samples, spikes));
            for (i, (&sample, spikes)) in samples.iter().zip(spikes.chunks(M)).enumerate() {
                expect(codec, i, encode_sample(scheme, &mut encoder, sample).code() == Some(code(spikes)))?;
            }
            decoding += instructions(|| decode(spikes, before, samples));
            before = samples[CHUNK - 1];
            for (i, (&value, spikes)) in samples.iter().zip(spikes.chunks(M)).enumerate() {
                let error = decode_sample(scheme, &mut decoder, code(spikes)).to_f64() - value.to_f64();
                expect(codec, i, error.abs() <= S::MEAN)?;
            }
        }
        Ok((encoding, decoding))
    }

    /// Fails unless the codec's spikes and values are those of the transcription, which the buffers hold. Loads the
    /// signal again.
    fn agree<P: Start<Sample = S>>(
        &mut self,
        codec: &'static str,
        source: Signal,
        scheme: &P,
        to_plain: impl Fn(P::Code) -> i8,
        of_plain: impl Fn(i8) -> P::Code,
    ) -> Result<(), Failure> {
        let mut decoder = scheme.decoder_state();
        for (i, (&value, &spike)) in self.signal.iter().zip(&self.spikes).enumerate() {
            expect(codec, i, decode_sample(scheme, &mut decoder, of_plain(spike)) == value)?;
        }
        source.load(&mut self.signal);
        let mut encoder = P::START;
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

    /// The same where spikes are 1, 0 and -1.
    fn agree_signs<P: Start<Sample = S, Code = Spike>>(
        &mut self,
        codec: &'static str,
        source: Signal,
        scheme: &P,
    ) -> Result<(), Failure> {
        let spike = |sign| match sign {
            1 => Spike::Up,
            0 => Spike::None,
            _ => Spike::Down,
        };
        self.agree(codec, source, scheme, Spike::sign, spike)
    }

    /// The same where a neuron is its index.
    fn agree_neurons<const M: usize>(
        &mut self,
        codec: &'static str,
        source: Signal,
        scheme: &Position<S, M>,
    ) -> Result<(), Failure> {
        let index = |neuron: Option<Neuron<M>>| neuron.map_or(-1, |neuron| neuron.index() as i8);
        self.agree(codec, source, scheme, index, |index| Neuron::new(index as u16))
    }
}

fn expect(codec: &'static str, sample: usize, agrees: bool) -> Result<(), Failure> {
    if agrees { Ok(()) } else { Err(Failure::Differ(codec, sample)) }
}

fn all<S: Measured>(
    out: &mut impl Write,
    sample: &str,
    source: Signal,
    buffers: &mut Buffers<S>,
) -> Result<(), Failure> {
    let mut calibration = Calibration::<S>::new();
    source.load(&mut buffers.signal);
    buffers.signal.iter().for_each(|&sample| calibration.observe(sample));
    let (min, max) = (calibration.min().unwrap_or_default(), calibration.max().unwrap_or_default());
    // The paper's parameters are for its own signal, of range 5.8; others are scaled to theirs.
    let range = max.to_f64() - min.to_f64();
    let part = |value: f64| S::from_f64(value / 5.8 * range);

    let subject =
        |codec, flash, plain| Subject { signal: source.name(), codec, sample, flash, plain };

    let contrast = TemporalContrast::from_magnitudes(&calibration, 0.5)?;
    let (threshold, step) = (contrast.threshold(), contrast.step());
    let plain = buffers.plain(
        |signal, spikes| plain::temporal_contrast(signal, threshold, spikes),
        |spikes, values| plain::step_decode(spikes, step, values),
    );
    buffers.agree_signs("tbr", source, &contrast)?;
    subject("tbr", size_of_val(&contrast), plain).measure(out, &contrast, &buffers.signal)?;

    let threshold = part(0.5);
    let plain = buffers.plain(
        |signal, spikes| plain::step_forward(signal, threshold, spikes),
        |spikes, values| plain::step_decode(spikes, threshold, values),
    );
    let scheme = StepForward::try_new(threshold)?;
    buffers.agree_signs("sf", source, &scheme)?;
    subject("sf", size_of_val(&scheme), plain).measure(out, &scheme, &buffers.signal)?;

    moving_window::<S, 6>(out, subject("mw-5", 0, (0, 0)), part(0.25), source, buffers)?;
    moving_window::<S, 64>(out, subject("mw-63", 0, (0, 0)), part(0.25), source, buffers)?;

    let taps = Taps::<S, 15>::try_shaped(Shape::Triangular, Scale::Peak(part(1.0)))?;
    let plain = buffers.plain_rate(min, taps.as_array(), |signal, spikes| {
        plain::hough(signal, taps.as_array(), spikes)
    });
    let scheme = Hough::new(taps).try_with_shift(min)?;
    buffers.agree_signs("hsa-15", source, &scheme)?;
    subject("hsa-15", size_of_val(&scheme), plain).measure(out, &scheme, &buffers.signal)?;

    let threshold = part(0.85);
    let plain = buffers.plain_rate(min, taps.as_array(), |signal, spikes| {
        plain::threshold_hough(signal, taps.as_array(), threshold, spikes);
    });
    let scheme = ThresholdHough::try_new(taps, threshold)?.try_with_shift(min)?;
    buffers.agree_signs("t-hsa-15", source, &scheme)?;
    subject("t-hsa-15", size_of_val(&scheme), plain).measure(out, &scheme, &buffers.signal)?;

    // The filter's sum is what a spike at every sample decodes to.
    let taps = Taps::<S, 24>::try_shaped(Shape::Hann, Scale::Sum(S::from_f64(range)))?;
    let threshold = S::from_f64(0.955 * range);
    let plain = buffers.plain_rate(min, taps.as_array(), |signal, spikes| {
        plain::ben(signal, taps.as_array(), threshold, spikes);
    });
    let scheme = Bsa::try_subtractive(taps, threshold)?.try_with_shift(min)?;
    buffers.agree_signs("bsa-24", source, &scheme)?;
    subject("bsa-24", size_of_val(&scheme), plain).measure(out, &scheme, &buffers.signal)?;
    // As the paper's signal meets a filter of unit sum: it spikes nearly always.
    let taps = Taps::<S, 24>::try_shaped(Shape::Hann, Scale::Sum(part(1.0)))?;
    let threshold = part(0.955);
    let plain = buffers.plain_rate(min, taps.as_array(), |signal, spikes| {
        plain::ben(signal, taps.as_array(), threshold, spikes);
    });
    let scheme = Bsa::try_subtractive(taps, threshold)?.try_with_shift(min)?;
    buffers.agree_signs("bsa-24-busy", source, &scheme)?;
    subject("bsa-24-busy", size_of_val(&scheme), plain).measure(out, &scheme, &buffers.signal)?;

    let taps = Taps::<S, 9>::try_shaped(Shape::Triangular, Scale::Peak(part(1.0)))?;
    let plain = buffers.plain_rate(min, taps.as_array(), |signal, spikes| {
        plain::ben_toolbox(signal, taps.as_array(), 1.15, spikes);
    });
    // The transcription has the ratio in 128ths.
    let scheme = BsaToolbox::try_new(taps, 147.0 / 128.0)?.try_with_shift(min)?;
    buffers.agree_signs("bsa-toolbox-9", source, &scheme)?;
    subject("bsa-toolbox-9", size_of_val(&scheme), plain).measure(
        out,
        &BsaToolbox::try_new(taps, 1.15)?.try_with_shift(min)?,
        &buffers.signal,
    )?;

    let scheme = Position::<S, 20>::try_gaussian_spaced(min..=max)?;
    let plain = buffers.plain(
        |signal, neurons| plain::position(signal, scheme.centres(), neurons),
        |neurons, values| plain::position_decode(neurons, scheme.centres(), values),
    );
    buffers.agree_neurons("position-20", source, &scheme)?;
    subject("position-20", size_of_val(&scheme), plain).measure(out, &scheme, &buffers.signal)?;

    let scheme = Gaussian::<S, 20>::try_linear(min..=max)?;
    let (sigma, means) = ((range / 18.0) as f32, means::<20>(min.to_f64(), range));
    let (signal, neurons) = buffers.slices();
    let encoding = instructions(|| plain::gaussian(signal, &means, sigma, neurons));
    settle(signal, neurons, &means, sigma, &scheme);
    let decoding = instructions(|| plain::position_decode(neurons, scheme.centres(), signal));
    buffers.agree_neurons("grf-20", source, &scheme)?;
    let plain = (encoding, decoding);
    subject("grf-20", size_of_val(&scheme), plain).measure(out, &scheme, &buffers.signal)?;

    slots(out, subject("grf-slots-15x10", 0, (0, 0)), (min, max), source, buffers)?;
    probabilistic(out, subject("grf-random-15x16", 0, (0, 0)), (min, max), source, buffers)
}

/// The means of receptive fields, which are not rounded to whole numbers.
fn means<const M: usize>(min: f64, range: f64) -> [f32; M] {
    core::array::from_fn(|i| {
        (min + (2.0 * i as f64 - 1.0) * range / (2.0 * (M as f64 - 2.0))) as f32
    })
}

/// Between two neurons, so close to halfway that rounding decides which exponential is the larger, the transcription may
/// say either: it is set right.
#[inline(never)]
fn settle<S: Measured>(
    signal: &[S],
    neurons: &mut [i8],
    means: &[f32; 20],
    sigma: f32,
    scheme: &Gaussian<S, 20>,
) {
    let mut encoder = Gaussian::<S, 20>::START;
    for (&sample, neuron) in signal.iter().zip(neurons) {
        let Some(nearest) = encode_sample(scheme, &mut encoder, sample) else { continue };
        let response = |i: usize| plain::response(sample.to_f64() as f32, means[i], sigma);
        let (ours, plain) = (response(nearest.index().into()), response(*neuron as usize));
        if (ours - plain).abs() <= 2.0 * f32::EPSILON {
            *neuron = nearest.index() as i8;
        }
    }
}

// Functions of their own, or their tables would all be on the stack together.

#[inline(never)]
fn slots<S: Measured>(
    out: &mut impl Write,
    subject: Subject<'_>,
    (min, max): (S, S),
    source: Signal,
    buffers: &mut Buffers<S>,
) -> Result<(), Failure> {
    let scheme = Slots::<S, 15, 10>::try_new(min..=max, 1.5)?;
    let range = max.to_f64() - min.to_f64();
    let (sigma, means) = ((range / (1.5 * 13.0)) as f32, means::<15>(min.to_f64(), range));
    let spikes_of = |slots: &[i8]| {
        let mut fired = [0; 15];
        let mut length = 0;
        for &slot in slots.iter().filter(|&&slot| slot >= 0) {
            fired[length] = slot as u8;
            length += 1;
        }
        let first = slots.iter().take_while(|&&slot| slot < 0).count();
        let first = if length == 0 { 0 } else { first };
        SlotSpikes::new(first as u16, &fired[..length]).unwrap_or(SlotSpikes::EMPTY)
    };
    let plain = buffers.plain_neurons::<_, 15>(
        "grf-slots-15x10",
        (&scheme, Slots::<S, 15, 10>::START, scheme.centres()[7]),
        spikes_of,
        |signal, slots| plain::slots(signal, &means, sigma, 10, slots),
        |slots, before, values| plain::slots_decode(slots, scheme.centres(), 10, before, values),
    )?;
    source.load(&mut buffers.signal);
    let subject = Subject { flash: size_of_val(&scheme), plain, ..subject };
    Ok(subject.measure(out, &scheme, &buffers.signal)?)
}

/// Not a scheme, as its encoder takes a generator, whose work is counted with it.
#[inline(never)]
fn probabilistic<S: Measured>(
    out: &mut impl Write,
    subject: Subject<'_>,
    (min, max): (S, S),
    source: Signal,
    buffers: &mut Buffers<S>,
) -> Result<(), Failure> {
    let scheme = Probabilistic::<S, Pcg32, 15, 16>::try_new(min..=max, 1.5)?;
    let range = max.to_f64() - min.to_f64();
    let (sigma, means) = ((range / (1.5 * 13.0)) as f32, means::<15>(min.to_f64(), range));
    let generator = || Pcg32::new(2, 2);
    let start = || Probabilistic::<S, Pcg32, 15, 16>::state(generator());
    let mut random = generator();
    let fired_of = |fired: &[i8]| {
        let neurons = (0..).zip(fired).filter(|&(_, &fired)| fired == 1).map(|(i, _)| i);
        FiredNeurons::new(neurons).unwrap_or(FiredNeurons::EMPTY)
    };
    let plain = buffers.plain_neurons::<_, 15>(
        "grf-random-15x16",
        (&scheme, start(), scheme.centres()[7]),
        fired_of,
        |signal, fired| {
            plain::probabilistic(signal, &means, sigma, 16, || random.next_u32(), fired)
        },
        |fired, before, values| {
            plain::probabilistic_decode(fired, scheme.centres(), before, values)
        },
    )?;
    source.load(&mut buffers.signal);
    let subject = Subject { flash: size_of_val(&scheme), plain, ..subject };
    Ok(subject.measure_codec(
        out,
        &scheme,
        &start,
        &buffers.signal,
    )?)
}

fn moving_window<S: Measured, const N: usize>(
    out: &mut impl Write,
    subject: Subject<'_>,
    threshold: S,
    source: Signal,
    buffers: &mut Buffers<S>,
) -> Result<(), Failure> {
    let plain = buffers.plain(
        |signal, spikes| plain::moving_window(signal, N, threshold, spikes),
        |spikes, values| plain::step_decode(spikes, threshold, values),
    );
    let scheme = MovingWindow::<S, N>::try_new(threshold)?;
    buffers.agree_signs("mw", source, &scheme)?;
    Ok(Subject { plain, flash: size_of_val(&scheme), ..subject }.measure(out, &scheme, &buffers.signal)?)
}
