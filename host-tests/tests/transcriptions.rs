//! The plain transcriptions of the pseudo-code, beside which the instruction counts stand, against the codecs: on the
//! signals and with the parameters that are counted, in every sample type.
//!
//! Spikes and values are the same, to the bit, with two exceptions that are said at their comparison: the winner by
//! exponentials where two of them differ by rounding only, and fixed-point means of centres, whose last place may differ.

use crate::signal;

use catalogue::{plain, schemes};
use fixed::types::{I8F8, I16F16};
use host_tests::compare::{Wire, decode, encode, run, signs_of, spikes_of};
use host_tests::reference::even_centres;
use rand_pcg::{Pcg32, rand_core::Rng};
use signal::{LENGTH, Measured, Signal};
use spikewire::population::{FiredNeurons, Neuron, Position, Probabilistic, SlotSpikes, Slots};
use spikewire::rate::{
    Bsa, BsaToolbox, Hough, RateDecoderState, Scale, Shape, Taps, ThresholdHough,
};
use spikewire::temporal::{MovingWindow, StepForward, StepState, TemporalContrast};
use spikewire::{Calibration, Scheme, Spike, Start};

/// A signal in a sample type, with what it is scaled by.
struct Recording<S> {
    samples: [S; LENGTH],
    calibration: Calibration<S>,
    min: S,
    max: S,
    range: f64,
}

impl<S: Measured> Recording<S> {
    fn new(signal: Signal) -> Self {
        let mut samples = [S::default(); LENGTH];
        signal.load(&mut samples);
        let mut calibration = Calibration::new();
        for &sample in &samples {
            calibration.observe(sample);
        }
        let (min, max) = (calibration.min().unwrap(), calibration.max().unwrap());
        Self { samples, calibration, min, max, range: max.to_f64() - min.to_f64() }
    }

    /// A parameter for the paper's signal, of range 5.8, scaled to this one.
    fn part(&self, value: f64) -> S {
        S::from_f64(value / 5.8 * self.range)
    }

    /// The means of the receptive fields, which are not rounded to whole numbers.
    fn means<const M: usize>(&self) -> [f32; M] {
        let centres = even_centres(self.min.to_f64(), self.max.to_f64(), M);
        std::array::from_fn(|i| centres[i] as f32)
    }

    fn shifted(&self) -> [S; LENGTH] {
        self.samples.map(|sample| S::narrow(sample.into() - self.min.into()))
    }
}

/// Where two lists differ.
fn differing<T: PartialEq>(ours: &[T], plain: &[T]) -> Vec<usize> {
    assert_eq!(ours.len(), plain.len());
    (0..ours.len()).filter(|&i| ours[i] != plain[i]).collect()
}

const NOWHERE: [usize; 0] = [];

/// A temporal code, both ways.
fn temporal<S, P>(
    recording: &Recording<S>,
    scheme: &P,
    step: S,
    plain: impl Fn(&[S], &mut [i8]),
) -> Vec<usize>
where
    S: Measured + Wire,
    P: Start<Sample = S, Code = Spike, Output = Spike, DecoderState = StepState<S>>,
{
    let mut spikes = [0; LENGTH];
    plain(&recording.samples, &mut spikes);
    let mut values = [S::default(); LENGTH];
    plain::step_decode(&spikes, step, &mut values);
    assert!(spikes.contains(&1) && spikes.contains(&-1));
    assert_eq!(differing(&decode(&scheme.decoder(), &spikes_of(&spikes)), &values), NOWHERE);
    differing(&signs_of(&encode(scheme, &recording.samples).outputs), &spikes)
}

/// A rate code, both ways, to the recording's end.
fn rate<S, P, const F: usize>(
    recording: &Recording<S>,
    scheme: &P,
    taps: &Taps<S, F>,
    plain: impl Fn(&mut [S], &[S], &mut [i8]),
) -> Vec<usize>
where
    S: Measured + Wire,
    P: Start<
            Sample = S,
            Code = Spike,
            Output = Option<Spike>,
            DecoderState = RateDecoderState<S, F>,
        >,
{
    let mut spikes = [0; LENGTH];
    plain(&mut recording.shifted(), taps.as_array(), &mut spikes);
    let mut values = [S::default(); LENGTH];
    plain::rate_decode(&spikes, taps.as_array(), recording.min, &mut values);
    assert_eq!(differing(&decode(&scheme.decoder(), &spikes_of(&spikes)), &values), NOWHERE);
    differing(&signs_of(&encode(scheme, &recording.samples).codes()), &spikes)
}

fn check_temporal<S: Measured + Wire>(signal: Signal) {
    let recording = Recording::<S>::new(signal);
    let scheme = TemporalContrast::from_magnitudes(&recording.calibration, 0.5).unwrap();
    let threshold = scheme.threshold();
    let plain = |x: &[S], spikes: &mut [i8]| schemes::tbr::transcribed(x, threshold, spikes);
    assert_eq!(temporal(&recording, &scheme, scheme.step(), plain), NOWHERE);

    let threshold = recording.part(0.5);
    let plain = |x: &[S], spikes: &mut [i8]| schemes::sf::transcribed(x, threshold, spikes);
    let scheme = StepForward::new(threshold);
    assert_eq!(temporal(&recording, &scheme, threshold, plain), NOWHERE);

    let threshold = recording.part(0.25);
    let plain = |x: &[S], spikes: &mut [i8]| schemes::mw::transcribed(x, 6, threshold, spikes);
    let scheme = MovingWindow::<S, 6>::new(threshold);
    assert_eq!(temporal(&recording, &scheme, threshold, plain), NOWHERE);
    let plain = |x: &[S], spikes: &mut [i8]| schemes::mw::transcribed(x, 64, threshold, spikes);
    let scheme = MovingWindow::<S, 64>::new(threshold);
    assert_eq!(temporal(&recording, &scheme, threshold, plain), NOWHERE);
}

fn check_rate<S: Measured + Wire>(signal: Signal) {
    let recording = Recording::<S>::new(signal);
    let min = recording.min;
    let peak = Scale::Peak(recording.part(1.0));
    let taps = Taps::<S, 15>::shaped(Shape::Triangular, peak);
    let scheme = Hough::new(taps).with_shift(min);
    assert_eq!(rate(&recording, &scheme, &taps, schemes::hsa::transcribed), NOWHERE);

    let threshold = recording.part(0.85);
    let scheme = ThresholdHough::new(taps, threshold).with_shift(min);
    let plain =
        |x: &mut [S], h: &[S], s: &mut [i8]| schemes::t_hsa::transcribed(x, h, threshold, s);
    assert_eq!(rate(&recording, &scheme, &taps, plain), NOWHERE);

    let whole = S::from_f64(recording.range);
    for (sum, threshold) in [
        (whole, S::from_f64(0.955 * recording.range)),
        (recording.part(1.0), recording.part(0.955)),
    ] {
        let taps = Taps::<S, 24>::shaped(Shape::Hann, Scale::Sum(sum));
        let scheme = Bsa::subtractive(taps, threshold).with_shift(min);
        let plain =
            |x: &mut [S], h: &[S], s: &mut [i8]| schemes::bsa::transcribed(x, h, threshold, s);
        assert_eq!(rate(&recording, &scheme, &taps, plain), NOWHERE);
    }

    let taps = Taps::<S, 9>::shaped(Shape::Triangular, peak);
    // The transcription's 1.15, in 128ths.
    let scheme = BsaToolbox::new(taps, 147.0 / 128.0).with_shift(min);
    let plain =
        |x: &mut [S], h: &[S], s: &mut [i8]| schemes::bsa::transcribed_toolbox(x, h, 1.15, s);
    assert_eq!(rate(&recording, &scheme, &taps, plain), NOWHERE);
}

/// The winner of the receptive fields and position coding, both ways.
fn nearest<S: Measured + Wire, const M: usize>(
    recording: &Recording<S>,
    scheme: &Position<S, M>,
    plain: impl Fn(&[S], &mut [i8]),
) -> (Vec<Option<Neuron<M>>>, Vec<Option<Neuron<M>>>) {
    let mut neurons = [0; LENGTH];
    plain(&recording.samples, &mut neurons);
    let mut values = [S::default(); LENGTH];
    plain::position_decode(&neurons, scheme.centres(), &mut values);
    let codes = neurons.map(|neuron| Neuron::new(neuron as u16)).to_vec();
    assert_eq!(differing(&decode(&scheme.decoder(), &codes), &values), NOWHERE);
    (encode(scheme, &recording.samples).outputs, codes)
}

fn check_nearest<S: Measured + Wire>(signal: Signal) {
    let recording = Recording::<S>::new(signal);
    let (min, max) = (recording.min, recording.max);
    let scheme = Position::<S, 20>::gaussian_spaced(min..=max);
    let plain =
        |x: &[S], neurons: &mut [i8]| schemes::position::transcribed(x, scheme.centres(), neurons);
    let (ours, plain) = nearest(&recording, &scheme, plain);
    assert_eq!(differing(&ours, &plain), NOWHERE);

    let scheme = Position::<S, 20>::linear(min..=max);
    let means = recording.means::<20>();
    let sigma = (recording.range / 18.0) as f32;
    let plain = |x: &[S], neurons: &mut [i8]| schemes::grf::transcribed(x, &means, sigma, neurons);
    let (ours, plain) = nearest(&recording, &scheme, plain);
    // Halfway between two neurons the rounding of the exponentials may decide.
    for i in differing(&ours, &plain) {
        let x = recording.samples[i].to_f64() as f32;
        let [ours, plain] = [ours[i], plain[i]]
            .map(|neuron| plain::response(x, means[usize::from(neuron.unwrap().index())], sigma));
        assert!((ours - plain).abs() <= 2.0 * f32::EPSILON, "{x}: {ours} and {plain}");
    }
}

/// Means of centres: the same bits in `f32`, the last place apart where they are not whole.
fn assert_means<S: Measured>(ours: &[S], plain: &[S]) {
    for (ours, plain) in ours.iter().zip(plain) {
        assert!((ours.to_f64() - plain.to_f64()).abs() <= S::MEAN, "{ours:?} and {plain:?}");
    }
}

fn check_slots<S: Measured + Wire>(signal: Signal) {
    let recording = Recording::<S>::new(signal);
    let scheme = Slots::<S, 15, 10>::new(recording.min..=recording.max, 1.5);
    let sigma = (recording.range / (1.5 * 13.0)) as f32;
    let mut slots = vec![0; 15 * LENGTH];
    schemes::grf_slots::transcribed(
        &recording.samples,
        &recording.means::<15>(),
        sigma,
        10,
        &mut slots,
    );
    let mut values = [S::default(); LENGTH];
    schemes::grf_slots::transcribed_decoder(
        &slots,
        scheme.centres(),
        10,
        scheme.centres()[7],
        &mut values,
    );

    let spikes = |slots: &[i8]| {
        let first = slots.iter().position(|&slot| slot >= 0).unwrap_or(0);
        let fired: Vec<_> = slots.iter().filter_map(|&slot| u8::try_from(slot).ok()).collect();
        SlotSpikes::new(first as u16, &fired).unwrap()
    };
    let codes: Vec<_> = slots.chunks(15).map(spikes).collect();
    assert_eq!(differing(&encode(&scheme, &recording.samples).outputs, &codes), NOWHERE);
    assert_means(&decode(&scheme.decoder(), &codes), &values);
}

fn check_probabilistic<S: Measured + Wire>(signal: Signal) {
    let recording = Recording::<S>::new(signal);
    let scheme = Probabilistic::<S, Pcg32, 15, 16>::new(recording.min..=recording.max, 1.5);
    let sigma = (recording.range / (1.5 * 13.0)) as f32;
    let mut random = Pcg32::new(2, 2);
    let mut fired = vec![0; 15 * LENGTH];
    let (means, draw) = (recording.means::<15>(), || random.next_u32());
    schemes::grf_prob::transcribed(&recording.samples, &means, sigma, 16, draw, &mut fired);
    let mut values = [S::default(); LENGTH];
    schemes::grf_prob::transcribed_decoder(
        &fired,
        scheme.centres(),
        scheme.centres()[7],
        &mut values,
    );

    let neurons = |fired: &[i8]| {
        FiredNeurons::<15>::new((0..15).filter(|&i| fired[usize::from(i)] == 1)).unwrap()
    };
    let codes: Vec<_> = fired.chunks(15).map(neurons).collect();
    let ours = run(&scheme.encoder(Pcg32::new(2, 2)), &recording.samples).outputs;
    assert_eq!(differing(&ours, &codes), NOWHERE);
    assert_means(&decode(&scheme.decoder(), &codes), &values);
}

/// Every sample type, on every signal.
macro_rules! everywhere {
    ($($test:ident: $check:ident),*) => {$(
        #[test]
        fn $test() {
            for signal in [Signal::Paper, Signal::Flight] {
                $check::<f32>(signal);
                $check::<I16F16>(signal);
                $check::<I8F8>(signal);
                $check::<i16>(signal);
            }
        }
    )*};
}
everywhere! {
    temporal_codes: check_temporal,
    rate_codes: check_rate,
    nearest_neuron: check_nearest,
    slots: check_slots,
    probabilistic: check_probabilistic
}
