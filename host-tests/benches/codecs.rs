//! Time of every codec on this computer, a recorded gyroscope at a time: sample by sample and as a slice. What they
//! cost on a microcontroller says `cargo bench-target`.

use std::hint::black_box;

use criterion::{Criterion, Throughput};
use fixed::types::{I8F8, I16F16};
use host_tests::flight;
use rand_pcg::Pcg32;
use spikewire::population::{Gaussian, Position, Probabilistic, Slots};
use spikewire::rate::{Bsa, BsaToolbox, Hough, Scale, Shape, Taps, ThresholdHough};
use spikewire::temporal::{MovingWindow, StepForward, TemporalContrast};
use spikewire::{Calibration, Encoder, Output, Sample, Scheme};

fn measure<P: Scheme<EncoderState: Clone>>(
    criterion: &mut Criterion,
    name: &str,
    fresh: &Encoder<'_, P>,
    signal: &[P::Sample],
) {
    let (mut encoder, mut decoder) = (fresh.clone(), fresh.scheme().decoder());
    let mut group = criterion.benchmark_group(name);
    group.throughput(Throughput::Elements(signal.len() as u64));
    group.bench_function("encode sample", |bencher| {
        bencher.iter(|| {
            for &sample in signal {
                black_box(encoder.encode(black_box(sample)));
            }
        });
    });
    let mut encoder = fresh.clone();
    let mut outputs: Vec<_> = signal.iter().map(|&sample| encoder.encode(sample)).collect();
    let codes: Vec<_> = outputs.iter().filter_map(|output| output.code()).collect();
    group.bench_function("encode slice", |bencher| {
        bencher.iter(|| encoder.encode_slice(black_box(signal), black_box(&mut outputs)));
    });
    group.bench_function("decode sample", |bencher| {
        bencher.iter(|| {
            for &code in &codes {
                black_box(decoder.decode(black_box(code)));
            }
        });
    });
    let mut values = signal.to_vec();
    group.bench_function("decode slice", |bencher| {
        bencher.iter(|| decoder.decode_slice(black_box(&codes), black_box(&mut values)));
    });
}

/// Every scheme in one sample type, with the shapes of `cargo bench-target`.
fn schemes<S: Sample>(criterion: &mut Criterion, sample: &str, units: f64) {
    let signal = flight::channel(&flight::hexarotor(), 0);
    let signal: Vec<S> = signal.into_iter().map(|x| S::from_f64(f64::from(x) * units)).collect();
    let mut calibration = Calibration::new();
    for &sample in &signal {
        calibration.observe(sample);
    }
    let (min, max) = (calibration.min().unwrap(), calibration.max().unwrap());
    let part = |part: f64| S::from_f64(part * (max.to_f64() - min.to_f64()));
    let name = |codec: &str| format!("{codec} {sample}");

    let contrast = TemporalContrast::from_magnitudes(&calibration, 0.5).unwrap();
    measure(criterion, &name("tbr"), &contrast.encoder(), &signal);
    measure(criterion, &name("sf"), &StepForward::new(part(0.1)).encoder(), &signal);
    let window = MovingWindow::<S, 6>::new(part(0.05));
    measure(criterion, &name("mw-5"), &window.encoder(), &signal);
    let window = MovingWindow::<S, 64>::new(part(0.05));
    measure(criterion, &name("mw-63"), &window.encoder(), &signal);

    let taps = Taps::<S, 15>::shaped(Shape::Triangular, Scale::Peak(part(0.17)));
    let hough = Hough::new(taps).with_shift(min);
    measure(criterion, &name("hsa-15"), &hough.encoder(), &signal);
    let hough = ThresholdHough::new(taps, part(0.15)).with_shift(min);
    measure(criterion, &name("t-hsa-15"), &hough.encoder(), &signal);
    let taps = Taps::<S, 24>::shaped(Shape::Hann, Scale::Sum(part(1.0)));
    let bsa = Bsa::subtractive(taps, part(0.955)).with_shift(min);
    measure(criterion, &name("bsa-24"), &bsa.encoder(), &signal);
    let taps = Taps::<S, 9>::shaped(Shape::Triangular, Scale::Peak(part(0.17)));
    let bsa = BsaToolbox::new(taps, 1.15).with_shift(min);
    measure(criterion, &name("bsa-toolbox-9"), &bsa.encoder(), &signal);

    let position = Position::<S, 20>::gaussian_spaced(min..=max);
    measure(criterion, &name("position-20"), &position.encoder(), &signal);
    let gaussian = Gaussian::<S, 20>::linear(min..=max);
    measure(criterion, &name("grf-20"), &gaussian.encoder(), &signal);
    let slots = Slots::<S, 15, 10>::new(min..=max, 1.5);
    measure(criterion, &name("grf-slots-15x10"), &slots.encoder(), &signal);
    let random = Probabilistic::<S, Pcg32, 15, 16>::new(min..=max, 1.5);
    let encoder = random.encoder(Pcg32::new(2, 2));
    measure(criterion, &name("grf-random-15x16"), &encoder, &signal);
}

fn main() {
    let criterion = &mut Criterion::default().configure_from_args();
    schemes::<f32>(criterion, "f32", 1.0);
    schemes::<I16F16>(criterion, "q16.16", 1.0);
    schemes::<I8F8>(criterion, "q8.8", 1.0);
    schemes::<i16>(criterion, "i16", 1000.0);
    criterion.final_summary();
}
