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
                expect(
                    codec,
                    i,
                    encode_sample(scheme, &mut encoder, sample).code() == Some(code(spikes)),
                )?;
            }
            decoding += instructions(|| decode(spikes, before, samples));
            before = samples[CHUNK - 1];
            for (i, (&value, spikes)) in samples.iter().zip(spikes.chunks(M)).enumerate() {
                let error =
                    decode_sample(scheme, &mut decoder, code(spikes)).to_f64() - value.to_f64();
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

/// What is measured on one signal, and where it goes.
struct Bench<'a, S, W> {
    out: &'a mut W,
    sample: &'a str,
    source: Signal,
    buffers: &'a mut Buffers<S>,
    calibration: Calibration<S>,
    min: S,
    max: S,
}

impl<'a, S: Measured, W: Write> Bench<'a, S, W> {
    fn new(out: &'a mut W, sample: &'a str, source: Signal, buffers: &'a mut Buffers<S>) -> Self {
        let mut calibration = Calibration::<S>::new();
        source.load(&mut buffers.signal);
        buffers.signal.iter().for_each(|&sample| calibration.observe(sample));
        let min = calibration.min().unwrap_or_default();
        let max = calibration.max().unwrap_or_default();
        Self { out, sample, source, buffers, calibration, min, max }
    }

    fn range(&self) -> f64 {
        self.max.to_f64() - self.min.to_f64()
    }

    /// The paper's parameters are for its own signal, of range 5.8; others are scaled to theirs.
    fn part(&self, value: f64) -> S {
        S::from_f64(value / 5.8 * self.range())
    }

    fn subject<P>(&self, codec: &'a str, scheme: &P, plain: (u32, u32)) -> Subject<'a> {
        let flash = size_of_val(scheme);
        Subject { signal: self.source.name(), codec, sample: self.sample, flash, plain }
    }

    /// Measures a scheme on the signal, which is in its buffer.
    fn measure<P: Start<Sample = S>>(
        &mut self,
        codec: &'a str,
        scheme: &P,
        plain: (u32, u32),
    ) -> Result<(), Failure> {
        let subject = self.subject(codec, scheme, plain);
        Ok(subject.measure(self.out, scheme, &self.buffers.signal)?)
    }

    /// Measures a scheme whose spikes are those of its transcription, which are in their buffer.
    fn measure_signs<P: Start<Sample = S, Code = Spike>>(
        &mut self,
        codec: &'static str,
        scheme: &P,
        plain: (u32, u32),
    ) -> Result<(), Failure> {
        self.buffers.agree_signs(codec, self.source, scheme)?;
        self.measure(codec, scheme, plain)
    }
}

fn all<S: Measured>(
    out: &mut impl Write,
    sample: &str,
    source: Signal,
    buffers: &mut Buffers<S>,
) -> Result<(), Failure> {
    let mut bench = Bench::new(out, sample, source, buffers);
    let bench = &mut bench;
    contrast(bench)?;
    step_forward(bench)?;
    moving_window::<S, 6>("mw-5", bench)?;
    moving_window::<S, 64>("mw-63", bench)?;
    hough(bench)?;
    threshold_hough(bench)?;
    // The filter's sum is what a spike at every sample decodes to.
    let range = bench.range();
    bsa("bsa-24", S::from_f64(range), S::from_f64(0.955 * range), bench)?;
    // As the paper's signal meets a filter of unit sum: it spikes nearly always.
    bsa("bsa-24-busy", bench.part(1.0), bench.part(0.955), bench)?;
    bsa_toolbox(bench)?;
    position(bench)?;
    gaussian(bench)?;
    slots(bench)?;
    probabilistic(bench)
}

// Functions of their own, or their schemes would all be on the stack together.

#[inline(never)]
fn contrast<S: Measured>(bench: &mut Bench<S, impl Write>) -> Result<(), Failure> {
    let scheme = TemporalContrast::from_magnitudes(&bench.calibration, 0.5)?;
    let (threshold, step) = (scheme.threshold(), scheme.step());
    let plain = bench.buffers.plain(
        |signal, spikes| plain::temporal_contrast(signal, threshold, spikes),
        |spikes, values| plain::step_decode(spikes, step, values),
    );
    bench.measure_signs("tbr", &scheme, plain)
}

#[inline(never)]
fn step_forward<S: Measured>(bench: &mut Bench<S, impl Write>) -> Result<(), Failure> {
    let threshold = bench.part(0.5);
    let plain = bench.buffers.plain(
        |signal, spikes| plain::step_forward(signal, threshold, spikes),
        |spikes, values| plain::step_decode(spikes, threshold, values),
    );
    bench.measure_signs("sf", &StepForward::try_new(threshold)?, plain)
}

#[inline(never)]
fn moving_window<S: Measured, const N: usize>(
    codec: &'static str,
    bench: &mut Bench<S, impl Write>,
) -> Result<(), Failure> {
    let threshold = bench.part(0.25);
    let plain = bench.buffers.plain(
        |signal, spikes| plain::moving_window(signal, N, threshold, spikes),
        |spikes, values| plain::step_decode(spikes, threshold, values),
    );
    bench.measure_signs(codec, &MovingWindow::<S, N>::try_new(threshold)?, plain)
}

#[inline(never)]
fn hough<S: Measured>(bench: &mut Bench<S, impl Write>) -> Result<(), Failure> {
    let taps = Taps::<S, 15>::try_shaped(Shape::Triangular, Scale::Peak(bench.part(1.0)))?;
    let plain = bench.buffers.plain_rate(bench.min, taps.as_array(), |signal, spikes| {
        plain::hough(signal, taps.as_array(), spikes)
    });
    let scheme = Hough::new(taps).try_with_shift(bench.min)?;
    bench.measure_signs("hsa-15", &scheme, plain)
}

#[inline(never)]
fn threshold_hough<S: Measured>(bench: &mut Bench<S, impl Write>) -> Result<(), Failure> {
    let taps = Taps::<S, 15>::try_shaped(Shape::Triangular, Scale::Peak(bench.part(1.0)))?;
    let threshold = bench.part(0.85);
    let plain = bench.buffers.plain_rate(bench.min, taps.as_array(), |signal, spikes| {
        plain::threshold_hough(signal, taps.as_array(), threshold, spikes);
    });
    let scheme = ThresholdHough::try_new(taps, threshold)?.try_with_shift(bench.min)?;
    bench.measure_signs("t-hsa-15", &scheme, plain)
}

/// A filter of this sum.
#[inline(never)]
fn bsa<S: Measured>(
    codec: &'static str,
    sum: S,
    threshold: S,
    bench: &mut Bench<S, impl Write>,
) -> Result<(), Failure> {
    let taps = Taps::<S, 24>::try_shaped(Shape::Hann, Scale::Sum(sum))?;
    let plain = bench.buffers.plain_rate(bench.min, taps.as_array(), |signal, spikes| {
        plain::ben(signal, taps.as_array(), threshold, spikes);
    });
    let scheme = Bsa::try_subtractive(taps, threshold)?.try_with_shift(bench.min)?;
    bench.measure_signs(codec, &scheme, plain)
}

#[inline(never)]
fn bsa_toolbox<S: Measured>(bench: &mut Bench<S, impl Write>) -> Result<(), Failure> {
    let taps = Taps::<S, 9>::try_shaped(Shape::Triangular, Scale::Peak(bench.part(1.0)))?;
    let plain = bench.buffers.plain_rate(bench.min, taps.as_array(), |signal, spikes| {
        plain::ben_toolbox(signal, taps.as_array(), 1.15, spikes);
    });
    let with_threshold =
        |threshold| BsaToolbox::try_new(taps, threshold)?.try_with_shift(bench.min);
    let scheme = with_threshold(1.15)?;
    // The transcription has the ratio in 128ths.
    let rounded = with_threshold(147.0 / 128.0)?;
    bench.buffers.agree_signs("bsa-toolbox-9", bench.source, &rounded)?;
    bench.measure("bsa-toolbox-9", &scheme, plain)
}

#[inline(never)]
fn position<S: Measured>(bench: &mut Bench<S, impl Write>) -> Result<(), Failure> {
    let scheme = Position::<S, 20>::try_gaussian_spaced(bench.min..=bench.max)?;
    let plain = bench.buffers.plain(
        |signal, neurons| plain::position(signal, scheme.centres(), neurons),
        |neurons, values| plain::position_decode(neurons, scheme.centres(), values),
    );
    bench.buffers.agree_neurons("position-20", bench.source, &scheme)?;
    bench.measure("position-20", &scheme, plain)
}

#[inline(never)]
fn gaussian<S: Measured>(bench: &mut Bench<S, impl Write>) -> Result<(), Failure> {
    let scheme = Gaussian::<S, 20>::try_linear(bench.min..=bench.max)?;
    let range = bench.range();
    let (sigma, means) = ((range / 18.0) as f32, means::<20>(bench.min.to_f64(), range));
    let (signal, neurons) = bench.buffers.slices();
    let encoding = instructions(|| plain::gaussian(signal, &means, sigma, neurons));
    settle(signal, neurons, &means, sigma, &scheme);
    let decoding = instructions(|| plain::position_decode(neurons, scheme.centres(), signal));
    bench.buffers.agree_neurons("grf-20", bench.source, &scheme)?;
    bench.measure("grf-20", &scheme, (encoding, decoding))
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

#[inline(never)]
fn slots<S: Measured>(bench: &mut Bench<S, impl Write>) -> Result<(), Failure> {
    let (min, max) = (bench.min, bench.max);
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
    let plain = bench.buffers.plain_neurons::<_, 15>(
        "grf-slots-15x10",
        (&scheme, Slots::<S, 15, 10>::START, scheme.centres()[7]),
        spikes_of,
        |signal, slots| plain::slots(signal, &means, sigma, 10, slots),
        |slots, before, values| plain::slots_decode(slots, scheme.centres(), 10, before, values),
    )?;
    bench.source.load(&mut bench.buffers.signal);
    bench.measure("grf-slots-15x10", &scheme, plain)
}

/// Not a scheme, as its encoder takes a generator, whose work is counted with it.
#[inline(never)]
fn probabilistic<S: Measured>(bench: &mut Bench<S, impl Write>) -> Result<(), Failure> {
    let (min, max) = (bench.min, bench.max);
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
    let plain = bench.buffers.plain_neurons::<_, 15>(
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
    bench.source.load(&mut bench.buffers.signal);
    let subject = bench.subject("grf-random-15x16", &scheme, plain);
    Ok(subject.measure_codec(bench.out, &scheme, &start, &bench.buffers.signal)?)
}
