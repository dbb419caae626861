//! Schemes are constants and statics, encoders and decoders are named fields, states are as small as documented.

use std::sync::Mutex;

use fixed::types::{I8F8, I16F16};
use rand_pcg::Pcg32;
use spikewire::population::{Gaussian, Position, Probabilistic, Slots};
use spikewire::rate::{Bsa, BsaToolbox, Hough, Scale, Shape, Taps, ThresholdHough};
use spikewire::temporal::{MovingWindow, StepForward, TemporalContrast};
use spikewire::{Calibration, Decoder, Encoder, Scheme, Spike, Start};

static CONTRAST: TemporalContrast<i16> = TemporalContrast::new(5).with_step(10);
static STEP: StepForward<f32> = StepForward::new(0.35);
static WINDOW: MovingWindow<I8F8, 6> = MovingWindow::new(I8F8::ONE);
static LIFT: Hough<f32, 15> = Hough::new(Taps::triangular(1.0)).with_shift(-3.0);
static NEARLY: ThresholdHough<I16F16, 15> =
    ThresholdHough::new(Taps::triangular(I16F16::ONE), I16F16::ONE).with_shift(I16F16::NEG_ONE);
static HANN: Bsa<f32, 24> = Bsa::subtractive(Taps::shaped(Shape::Hann, Scale::Sum(1.0)), 0.955);
static TABLES: BsaToolbox<f32, 9> = BsaToolbox::new(Taps::triangular(1.0), 1.15);
static ERROR: Position<f32, 20> = Position::gaussian_spaced(-1.0..=1.0);
static TILT: Gaussian<i16, 20> = Gaussian::linear(-300..=300);
static SLOTS: Slots<f32, 15, 10> = Slots::new(-1.0..=1.0, 1.5).with_floor(2);
static RANDOM: Probabilistic<f32, Pcg32, 15, 16> = Probabilistic::new(-1.0..=1.0, 1.5);

/// A channel as a program holds it.
struct Channel {
    encoder: Encoder<'static, Hough<f32, 15>>,
    decoder: Decoder<'static, Hough<f32, 15>>,
}

static ENCODER: Mutex<Encoder<'static, Hough<f32, 15>>> = Mutex::new(Encoder::new(&LIFT));

#[test]
fn an_encoder_in_a_field_and_in_a_static() {
    let mut channel = Channel { encoder: LIFT.encoder(), decoder: LIFT.decoder() };
    let Channel { encoder, decoder } = &mut channel;
    let spikes: Vec<_> = (0..60).filter_map(|_| encoder.encode(2.0)).collect();
    let mut fixed = ENCODER.lock().unwrap();
    assert!((0..60).filter_map(|_| fixed.encode(2.0)).eq(spikes.iter().copied()));
    assert_eq!(spikes.len(), 60 - LIFT.latency());
    let values: Vec<_> = spikes.iter().map(|&spike| decoder.decode(spike)).collect();
    assert!(spikes.contains(&Spike::Up) && values.iter().all(|&value| value <= 2.0));
    assert!(values[20..].iter().all(|&value| value > -3.0));
}

/// Several channels share one scheme, and threads do.
#[test]
fn one_scheme_for_all_channels() {
    let alone = |scale: f32| {
        let mut encoder = STEP.encoder();
        (0..500).map(|i| encoder.encode((i as f32 * 0.1).sin() * scale)).collect::<Vec<_>>()
    };
    let mut together = [STEP.encoder(); 6];
    let mut spikes = vec![Vec::new(); 6];
    for i in 0..500 {
        for (channel, encoder) in together.iter_mut().enumerate() {
            spikes[channel].push(encoder.encode((i as f32 * 0.1).sin() * channel as f32));
        }
    }
    let threads: Vec<_> =
        (0..6_u8).map(|scale| std::thread::spawn(move || alone(scale.into()))).collect();
    for (thread, spikes) in threads.into_iter().zip(spikes) {
        assert_eq!(thread.join().unwrap(), spikes);
    }
}

/// Bytes of a channel that encodes and of one that decodes, as each scheme's documentation says.
#[test]
fn sizes() {
    fn state<P: Start>(_: &P) -> [usize; 2] {
        [size_of::<P::EncoderState>(), size_of::<P::DecoderState>()]
    }
    assert_eq!(state(&CONTRAST), [8, 2]);
    assert_eq!(state(&TemporalContrast::new(1.0_f32)), [8, 4]);
    assert_eq!(state(&STEP), [8, 4]);
    assert_eq!(state(&MovingWindow::<f32, 6>::new(1.0)), [4 * 6 + 12, 4]);
    assert_eq!(state(&MovingWindow::<f32, 64>::new(1.0)), [4 * 64 + 12, 4]);
    assert_eq!(state(&WINDOW), [2 * 6 + 12, 2]);
    assert_eq!(state(&LIFT), [4 * 15 + 8, 4 * 15 + 4]);
    assert_eq!(state(&NEARLY), [4 * 15 + 8, 4 * 15 + 4]);
    assert_eq!(state(&HANN), [4 * 24 + 8, 4 * 24 + 4]);
    assert_eq!(state(&TABLES), [4 * 9 + 12, 4 * 9 + 4]);
    assert_eq!(state(&ERROR), [4, 4]);
    assert_eq!(state(&TILT), [4, 2]);
    assert_eq!(state(&SLOTS), [4, 4]);
    assert_eq!(size_of::<Calibration<f32>>(), 48);
    assert_eq!(size_of_val(&STEP), 4);
    assert_eq!(size_of_val(&ERROR), 10 * 20 + 8);
    assert_eq!(size_of_val(&SLOTS), 4 * 15 + 4 * 10 + 32);
    assert_eq!(size_of_val(&RANDOM), 4 * 15 + 4 * 16 + 28);
    assert_eq!(size_of::<Taps<f32, 15>>(), 8 * 15 + 4);
}
