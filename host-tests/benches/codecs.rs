//! Time of every codec on this computer, a recorded gyroscope at a time: sample by sample and as a slice. What they
//! cost on a microcontroller says `cargo bench-target`.

use std::hint::black_box;

use criterion::{Criterion, Throughput};
use fixed::types::{I8F8, I16F16};
use host_tests::flight;
use rand_pcg::Pcg32;
use spikewire::population::{Centres, Gaussian, Position, Probabilistic, ReceptiveFields, Slots};
use spikewire::rate::{Ben, BenToolbox, Hough, Scale, Shape, Taps, ThresholdHough};
use spikewire::temporal::{MovingWindow, StepForward, TemporalContrast};
use spikewire::{Calibration, Decoder, Encoder, Output, Sample, Scheme};

fn measure<E, D>(
    criterion: &mut Criterion,
    name: &str,
    (mut encoder, mut decoder): (E, D),
    signal: &[E::Sample],
) where
    E: Encoder,
    D: Decoder<Sample = E::Sample, Code = <E::Output as Output>::Code>,
{
    let mut group = criterion.benchmark_group(name);
    group.throughput(Throughput::Elements(signal.len() as u64));
    group.bench_function("encode sample", |bencher| {
        bencher.iter(|| {
            for &sample in signal {
                black_box(encoder.encode(black_box(sample)));
            }
        });
    });
    encoder.reset();
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

/// Encoder and decoder of a scheme.
fn codec<P: Scheme>(scheme: P) -> (P::Encoder, P::Decoder) {
    (scheme.encoder(), scheme.decoder())
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
    measure(criterion, &name("tbr"), codec(contrast), &signal);
    measure(criterion, &name("sf"), codec(StepForward::new(part(0.1)).unwrap()), &signal);
    let window = MovingWindow::<S, 6>::new(part(0.05)).unwrap();
    measure(criterion, &name("mw-5"), codec(window), &signal);
    let window = MovingWindow::<S, 64>::new(part(0.05)).unwrap();
    measure(criterion, &name("mw-63"), codec(window), &signal);

    let taps = Taps::<S, 15>::shaped(Shape::Triangular, Scale::Peak(part(0.17))).unwrap();
    let hough = Hough::new(&taps).with_shift(min).unwrap();
    measure(criterion, &name("hsa-15"), codec(hough), &signal);
    let hough = ThresholdHough::new(&taps, part(0.15)).unwrap().with_shift(min).unwrap();
    measure(criterion, &name("t-hsa-15"), codec(hough), &signal);
    let taps = Taps::<S, 24>::shaped(Shape::Hann, Scale::Sum(part(1.0))).unwrap();
    let ben = Ben::subtractive(&taps, part(0.955)).unwrap().with_shift(min).unwrap();
    measure(criterion, &name("bsa-24"), codec(ben), &signal);
    let taps = Taps::<S, 9>::shaped(Shape::Triangular, Scale::Peak(part(0.17))).unwrap();
    let ben = BenToolbox::new(&taps, 1.15).unwrap().with_shift(min).unwrap();
    measure(criterion, &name("bsa-toolbox-9"), codec(ben), &signal);

    let centres = Centres::<S, 20>::new_gaussian_spaced(min, max).unwrap();
    measure(criterion, &name("position-20"), codec(Position::new(&centres)), &signal);
    let centres = Centres::<S, 20>::new_linear(min, max).unwrap();
    measure(criterion, &name("grf-20"), codec(Gaussian::new(&centres)), &signal);
    let fields = ReceptiveFields::<S, 15, 10>::new(min, max, 1.5).unwrap();
    measure(criterion, &name("grf-slots-15x10"), codec(Slots::new(&fields)), &signal);
    let fields = ReceptiveFields::<S, 15, 16>::new(min, max, 1.5).unwrap();
    let random = Probabilistic::new(&fields);
    let pair = (random.encoder(Pcg32::new(2, 2)), random.decoder());
    measure(criterion, &name("grf-random-15x16"), pair, &signal);
}

fn main() {
    let criterion = &mut Criterion::default().configure_from_args();
    schemes::<f32>(criterion, "f32", 1.0);
    schemes::<I16F16>(criterion, "q16.16", 1.0);
    schemes::<I8F8>(criterion, "q8.8", 1.0);
    schemes::<i16>(criterion, "i16", 1000.0);
    criterion.final_summary();
}
