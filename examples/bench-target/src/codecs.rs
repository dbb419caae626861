//! Every codec, with the parameters of the paper's benchmark, beside its plain transcription.

use core::{
    fmt::{self, Write},
    hint::black_box,
    mem::size_of_val,
};

use board::stopwatch::instructions;
use rand_pcg::{Pcg32, rand_core::Rng};
use spikewire::{
    Calibration, ConfigError,
    population::{Centres, Gaussian, Position, Probabilistic, ReceptiveFields, Slots},
    rate::{Ben, BenToolbox, Hough, Scale, Shape, Taps, ThresholdHough},
    temporal::{MovingWindow, StepForward, TemporalContrast},
};

use crate::{
    measure::Subject,
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

    /// The same of a population code. It has no plain decoder.
    fn plain_population(&mut self, encode: impl FnOnce(&[S], &mut [i8])) -> (u32, u32) {
        let (signal, spikes) = self.slices();
        let encoding = instructions(|| encode(signal, spikes));
        (encoding, 0)
    }
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
    source.load(&mut buffers.signal);
    subject("tbr", 0, plain).measure(out, contrast, &buffers.signal)?;

    let threshold = part(0.5);
    let plain = buffers.plain(
        |signal, spikes| plain::step_forward(signal, threshold, spikes),
        |spikes, values| plain::step_decode(spikes, threshold, values),
    );
    source.load(&mut buffers.signal);
    subject("sf", 0, plain).measure(out, StepForward::new(threshold)?, &buffers.signal)?;

    moving_window::<S, 6>(out, subject("mw-5", 0, (0, 0)), part(0.25), source, buffers)?;
    moving_window::<S, 64>(out, subject("mw-63", 0, (0, 0)), part(0.25), source, buffers)?;

    let taps = Taps::<S, 15>::shaped(Shape::Triangular, Scale::Peak(part(1.0)))?;
    let plain = buffers.plain_rate(min, taps.as_array(), |signal, spikes| {
        plain::hough(signal, taps.as_array(), spikes)
    });
    source.load(&mut buffers.signal);
    subject("hsa-15", size_of_val(&taps), plain).measure(
        out,
        Hough::new(&taps).with_shift(min)?,
        &buffers.signal,
    )?;

    let threshold = part(0.85);
    let plain = buffers.plain_rate(min, taps.as_array(), |signal, spikes| {
        plain::threshold_hough(signal, taps.as_array(), threshold, spikes);
    });
    source.load(&mut buffers.signal);
    subject("t-hsa-15", size_of_val(&taps), plain).measure(
        out,
        ThresholdHough::new(&taps, threshold)?.with_shift(min)?,
        &buffers.signal,
    )?;

    // The filter's sum is what a spike at every sample decodes to.
    let taps = Taps::<S, 24>::shaped(Shape::Hann, Scale::Sum(S::from_f64(range)))?;
    let threshold = S::from_f64(0.955 * range);
    let plain = buffers.plain_rate(min, taps.as_array(), |signal, spikes| {
        plain::ben(signal, taps.as_array(), threshold, spikes);
    });
    source.load(&mut buffers.signal);
    subject("bsa-24", size_of_val(&taps), plain).measure(
        out,
        Ben::subtractive(&taps, threshold)?.with_shift(min)?,
        &buffers.signal,
    )?;
    // As the paper's signal meets a filter of unit sum: it spikes nearly always.
    let taps = Taps::<S, 24>::shaped(Shape::Hann, Scale::Sum(part(1.0)))?;
    let threshold = part(0.955);
    let plain = buffers.plain_rate(min, taps.as_array(), |signal, spikes| {
        plain::ben(signal, taps.as_array(), threshold, spikes);
    });
    source.load(&mut buffers.signal);
    subject("bsa-24-busy", size_of_val(&taps), plain).measure(
        out,
        Ben::subtractive(&taps, threshold)?.with_shift(min)?,
        &buffers.signal,
    )?;

    let taps = Taps::<S, 9>::shaped(Shape::Triangular, Scale::Peak(part(1.0)))?;
    let plain = buffers.plain_rate(min, taps.as_array(), |signal, spikes| {
        plain::ben_toolbox(signal, taps.as_array(), 1.15, spikes);
    });
    source.load(&mut buffers.signal);
    subject("bsa-toolbox-9", size_of_val(&taps), plain).measure(
        out,
        BenToolbox::new(&taps, 1.15)?.with_shift(min)?,
        &buffers.signal,
    )?;

    let centres = Centres::<S, 20>::new_gaussian_spaced(min, max)?;
    let plain = buffers
        .plain_population(|signal, neurons| plain::position(signal, centres.as_array(), neurons));
    subject("position-20", size_of_val(&centres), plain).measure(
        out,
        Position::new(&centres),
        &buffers.signal,
    )?;

    let centres = Centres::<S, 20>::new_linear(min, max)?;
    let sigma = (range / 18.0) as f32;
    let means = centres.as_array().map(|centre| centre.to_f64() as f32);
    let plain =
        buffers.plain_population(|signal, neurons| plain::gaussian(signal, &means, sigma, neurons));
    subject("grf-20", size_of_val(&centres), plain).measure(
        out,
        Gaussian::new(&centres),
        &buffers.signal,
    )?;

    slots(out, subject("grf-slots-15x10", 0, (0, 0)), (min, max), buffers)?;
    probabilistic(out, subject("grf-random-15x16", 0, (0, 0)), (min, max), buffers)
}

// Functions of their own, or their tables would all be on the stack together.

#[inline(never)]
fn slots<S: Measured>(
    out: &mut impl Write,
    subject: Subject<'_>,
    (min, max): (S, S),
    buffers: &mut Buffers<S>,
) -> Result<(), Failure> {
    let fields = ReceptiveFields::<S, 15, 10>::new(min, max, 1.5)?;
    let sigma = ((max.to_f64() - min.to_f64()) / (1.5 * 13.0)) as f32;
    let means = fields.centres().map(|centre| centre.to_f64() as f32);
    let plain =
        buffers.plain_population(|signal, slots| plain::slots(signal, &means, sigma, 10, slots));
    let subject = Subject { flash: size_of_val(&fields), plain, ..subject };
    Ok(subject.measure(out, Slots::new(&fields), &buffers.signal)?)
}

/// Not a scheme, as its encoder takes a generator, whose work is counted with it.
#[inline(never)]
fn probabilistic<S: Measured>(
    out: &mut impl Write,
    subject: Subject<'_>,
    (min, max): (S, S),
    buffers: &mut Buffers<S>,
) -> Result<(), Failure> {
    let fields = ReceptiveFields::<S, 15, 16>::new(min, max, 1.5)?;
    let sigma = ((max.to_f64() - min.to_f64()) / (1.5 * 13.0)) as f32;
    let means = fields.centres().map(|centre| centre.to_f64() as f32);
    let generator = || Pcg32::new(2, 2);
    let mut random = generator();
    let plain = buffers.plain_population(|signal, fired| {
        plain::probabilistic(signal, &means, sigma, || random.next_u32(), fired);
    });
    let scheme = Probabilistic::new(&fields);
    let subject = Subject { flash: size_of_val(&fields), plain, ..subject };
    Ok(subject.measure_codec(
        out,
        || scheme.encoder(generator()),
        || scheme.decoder(),
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
    source.load(&mut buffers.signal);
    let scheme = MovingWindow::<S, N>::new(threshold)?;
    Ok(Subject { plain, ..subject }.measure(out, scheme, &buffers.signal)?)
}
