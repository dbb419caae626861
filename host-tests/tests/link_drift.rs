//! The paper's second figure: TBR and MW drift without bound. With a keyframe a second they do not.

use rand_core::Rng;
use rand_pcg::Pcg32;
use spikewire::link::{Coding, MAX_FRAME, Reader, Receiver, Session, Transmitter};
use spikewire::temporal::{MovingWindow, TemporalContrast};
use spikewire::{
    Calibration, Encoder, Event, FromItems, Item, Keyframe, Scheme, Spike, Start, Tick,
};

const RATE: usize = 100;
const SECONDS: usize = 100;

/// The paper's benchmark signal, 100 periods of its 1 Hz component at 100 Hz.
fn signal(seed: u64) -> Vec<f32> {
    use std::f64::consts::PI;
    let mut random = Pcg32::new(seed, 2);
    (1..=RATE * SECONDS)
        .map(|index| {
            let t = index as f64 / RATE as f64;
            let noise = f64::from(random.next_u32()) / f64::from(u32::MAX);
            let slow = 2.0 * (2.0 * PI * t).sin() - 0.5 * (0.5 * PI * t).cos();
            (slow + 0.75 * (10.0 * PI * t).sin() - 0.5 * noise) as f32
        })
        .collect()
}

/// RMSE over each second of what a receiver holds at each sample.
fn errors<P>(mut encoder: Encoder<'_, P>, signal: &[f32], keyframes: bool) -> Vec<f64>
where
    P: Scheme<Sample = f32, Output = Spike>,
{
    let mut transmitter = Transmitter::new(Coding::for_channels(1, 10_000), Session::counted(1));
    let mut reader = Reader::<MAX_FRAME>::new();
    let mut receiver = Receiver::<_, 1, 0>::new(encoder.scheme());
    let mut squares = Vec::new();
    for (index, &sample) in signal.iter().enumerate() {
        let tick = Tick::from(10_000 * index as u32);
        let spike = encoder.encode(sample);
        let event = spike.polarity().map(|polarity| Event { tick, address: 0, polarity });
        let mut items: Vec<Item> = event.map(Item::Event).into_iter().collect();
        let is_first = index == 10;
        if is_first || (keyframes && index > 0 && index % RATE == 0) {
            items.extend(
                encoder.keyframe().map(|value| Item::Keyframe(Keyframe::new(tick, 0, value))),
            );
        }
        let mut source = FromItems(items.into_iter());
        let mut buffer = [0; 64];
        while let Some(mut bytes) = transmitter.next_frame(&mut source, &mut buffer).unwrap() {
            while let Some(received) = reader.next_frame(&mut bytes) {
                receiver.apply(&received, |_, _, _| ());
            }
        }
        let error = f64::from(receiver.estimate(0) - sample);
        squares.push(error * error);
    }
    let seconds = squares.chunks(RATE);
    seconds.map(|second| (second.iter().sum::<f64>() / second.len() as f64).sqrt()).collect()
}

fn rms(errors: &[f64]) -> f64 {
    (errors.iter().map(|error| error * error).sum::<f64>() / errors.len() as f64).sqrt()
}

fn compare<P>(name: &str, scheme: impl Fn(&[f32]) -> P, past: usize)
where
    P: Start<Sample = f32, Output = Spike>,
{
    const SIGNALS: u64 = 20;
    let (mut without, mut with, mut worst) = (0.0, 0.0, 0.0_f64);
    for seed in 0..SIGNALS {
        let signal = signal(seed);
        let scheme = scheme(&signal);
        let mut encoder = scheme.encoder();
        encoder.prime(&signal[..past]);
        without += rms(&errors(encoder, &signal, false)) / SIGNALS as f64;
        let errors = errors(encoder, &signal, true);
        with += rms(&errors) / SIGNALS as f64;
        worst = errors.iter().copied().fold(worst, f64::max);
        let (early, late) = (rms(&errors[1..50]), rms(&errors[51..]));
        assert!(late < 1.3 * early, "{name}: {early} in the first half, {late} in the second");
    }
    println!(
        "{name}: RMSE over 100 periods {without:.2} without keyframes, {with:.2} with one a second \
         (worst second {worst:.2})"
    );
    assert!(with < 0.5 * without, "{name}");
    assert!(worst < 2.5, "{name}");
}

#[test]
fn keyframes_bound_the_drift_of_temporal_contrast() {
    let scheme = |signal: &[f32]| {
        let mut calibration = Calibration::<f32>::new();
        for &sample in signal {
            calibration.observe(sample);
        }
        let threshold = TemporalContrast::from_calibration(&calibration, 0.5).unwrap().threshold();
        TemporalContrast::new(threshold).with_step(2.0 * threshold)
    };
    compare("TBR", scheme, 0);
}

#[test]
fn keyframes_bound_the_drift_of_the_moving_window() {
    compare("MW", |_| MovingWindow::<f32, 6>::new(0.25), 6);
}
