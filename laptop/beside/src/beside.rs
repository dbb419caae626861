//! Slices of one channel beside ferromorphic's in `f64`, on the paper's signal and on recorded flights.

use std::{array, f64::consts::TAU, hint::black_box};

use ferromorphic::coding::{self, ContrastMode};
use spikewire::{
    Output, Scheme, Spike, Start,
    rate::{Bsa, Criterion, Hough, Taps, ThresholdHough},
    temporal::{MovingWindow, StepForward, TemporalContrast},
};

use crate::timing::{Turns, variants};

const ROUNDS: usize = 61;

/// What a sample and its spike take, of which one is read and the other written.
const BYTES: usize = size_of::<f32>() + size_of::<Spike>();

/// A signal, and the thresholds of TBR, MW and SF on it.
struct Signal {
    name: &'static str,
    samples: Vec<f64>,
    thresholds: [f64; 3],
}

/// The paper's signal without its noise, a turn rate in flight, which vibrates, and one at rest, which is noise.
fn signals() -> [Signal; 3] {
    let sines = |k: usize| {
        let t = k as f64 / 100.0;
        2.0 * (TAU * t).sin() - 0.5 * (TAU / 4.0 * t).cos() + 0.75 * (5.0 * TAU * t).sin()
    };
    let roll = |recording| flight_data::channel(recording, 0).map(f64::from).collect();
    [
        Signal {
            name: "the paper's sines, 10 000 samples",
            samples: (0..10_000).map(sines).collect(),
            thresholds: [0.3, 0.25, 0.5],
        },
        Signal {
            name: "`gyro_x` of `data/hexarotor.csv`, 3627 samples",
            samples: roll(flight_data::HEXAROTOR),
            thresholds: [0.1; 3],
        },
        Signal {
            name: "`gyro_x` of `data/vtol_at_rest.csv`, 1298 samples",
            samples: roll(flight_data::VTOL_AT_REST),
            thresholds: [0.002; 3],
        },
    ]
}

/// Prints a table for each signal.
pub fn tables() {
    for signal in signals() {
        println!("\n{}:\n", signal.name);
        println!("| code | M samples/s | GB/s | ferromorphic | times | spikes | ferromorphic |");
        println!("|---|---:|---:|---:|---:|---:|---:|");
        temporal(&signal);
        rates(&signal.samples);
    }
}

fn temporal(Signal { samples, thresholds: [contrasted, moved, stepped], .. }: &Signal) {
    let scheme = TemporalContrast::new(*contrasted as f32);
    contrast("TBR", &scheme, *contrasted, ContrastMode::ThresholdBased, samples);
    let window = ContrastMode::MovingWindow { window: 6 };
    contrast("MW, W = 5", &MovingWindow::<_, 5>::new(*moved as f32), *moved, window, samples);
    let scheme = StepForward::new(*stepped as f32);
    contrast("SF", &scheme, *stepped, ContrastMode::StepForward, samples);
}

/// Rate codes code what is above 0, and a filter that is as high at most gives spikes at any time.
fn rates(signal: &[f64]) {
    let low = signal.iter().copied().fold(f64::INFINITY, f64::min);
    let high = signal.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let signal: Vec<f64> = signal.iter().map(|x| (x - low) / (high - low)).collect();
    let (filter, peak) = (triangle::<24>(), 1.0 / 12.0);
    let filter = filter.map(|tap| tap * peak);
    let scheme = Bsa::<_, 24>::new(taps(filter), Criterion::Subtractive(0.05));
    let theirs = coding::Bsa::new(filter.to_vec(), 0.05).unwrap();
    rate(
        "BSA, 24 taps",
        &scheme,
        &signal,
        |x| theirs.encode(x).unwrap(),
        |codes| theirs.decode(codes),
    );
    let filter = triangle::<15>().map(|tap| tap / 7.5);
    let theirs = coding::Hsa::new(filter.to_vec(), 0.0).unwrap();
    let scheme = Hough::<_, 15>::new(taps(filter));
    rate(
        "HSA, 15 taps",
        &scheme,
        &signal,
        |x| theirs.encode(x).unwrap(),
        |codes| theirs.decode(codes),
    );
    let theirs = coding::Hsa::new(filter.to_vec(), 0.1).unwrap();
    let scheme = ThresholdHough::<_, 15>::new(taps(filter), 0.1);
    rate(
        "T-HSA, 15 taps",
        &scheme,
        &signal,
        |x| theirs.encode(x).unwrap(),
        |codes| theirs.decode(codes),
    );
}

/// A filter whose highest tap is nearly 1.
fn triangle<const F: usize>() -> [f64; F] {
    array::from_fn(|k| 1.0 - (2.0 * k as f64 + 1.0 - F as f64).abs() / (F as f64 + 1.0))
}

fn taps<const F: usize>(filter: [f64; F]) -> Taps<f32, F> {
    Taps::try_new(filter.map(|tap| tap as f32)).unwrap()
}

fn contrast<P>(name: &str, scheme: &P, threshold: f64, mode: ContrastMode, signal: &[f64])
where
    P: Scheme<Sample = f32, Code = Spike, Output = Spike> + Start,
{
    let theirs = coding::TemporalContrast::new(threshold, mode).unwrap();
    row(
        name,
        scheme,
        signal,
        |spikes: &Vec<_>| spikes.len(),
        |x| theirs.encode(x, 0).unwrap(),
        |spikes, signal| drop(black_box(theirs.decode(spikes, 0, signal.len(), signal[0]))),
    );
}

fn rate<P>(
    name: &str,
    scheme: &P,
    signal: &[f64],
    encode: impl Fn(&[f64]) -> Vec<bool>,
    decode: impl Fn(&[bool]) -> Vec<f64>,
) where
    P: Scheme<Sample = f32, Code = Spike, Output = Option<Spike>> + Start,
{
    let count = |spikes: &Vec<bool>| spikes.iter().filter(|fired| **fired).count();
    let decode = |spikes: &Vec<bool>, _: &[f64]| drop(black_box(decode(spikes)));
    row(name, scheme, signal, count, encode, decode);
}

/// Both ways, ours and theirs.
fn row<P, T>(
    name: &str,
    scheme: &P,
    signal: &[f64],
    count: impl Fn(&T) -> usize,
    their_encode: impl Fn(&[f64]) -> T,
    their_decode: impl Fn(&T, &[f64]),
) where
    P: Scheme<Sample = f32, Code = Spike, Output: Output<Code = Spike> + Default> + Start,
{
    let wide = variants(signal);
    let samples = wide.iter().map(|own| own.iter().map(|&sample| sample as f32).collect());
    let samples: Vec<Vec<f32>> = samples.collect();
    let mut outputs = vec![P::Output::default(); signal.len()];
    let codes = samples.iter().map(|samples| {
        scheme.encoder().encode_slice(samples, &mut outputs);
        outputs.iter().filter_map(|output| output.code()).collect()
    });
    let codes: Vec<Vec<Spike>> = codes.collect();
    let their_codes: Vec<T> = wide.iter().map(|own| their_encode(own)).collect();
    let spikes = codes[0].iter().filter(|code| **code != Spike::None).count();
    let spikes = [spikes, count(&their_codes[0])];
    let turns = Turns::take(
        ROUNDS,
        |variant| {
            let samples = black_box(&samples[variant]);
            scheme.encoder().encode_slice(samples, black_box(&mut outputs));
        },
        |variant| drop(black_box(their_encode(black_box(&wide[variant])))),
    );
    print(name, signal.len(), spikes, &turns);
    let mut values = vec![0.0; codes[0].len()];
    let turns = Turns::take(
        ROUNDS,
        |variant| {
            let codes = black_box(&codes[variant]);
            scheme.decoder().decode_slice(codes, black_box(&mut values));
        },
        |variant| their_decode(&their_codes[variant], &wide[variant]),
    );
    print(&format!("{name}, decoding"), signal.len(), spikes, &turns);
}

fn print(name: &str, length: usize, [spikes, their_spikes]: [usize; 2], turns: &Turns) {
    let [ours, theirs] = [0, 1].map(|which| 1e-6 * length as f64 / turns.of(which));
    let (gigabytes, times) = (ours * BYTES as f64 * 1e-3, turns.ratio());
    println!(
        "| {name} | {ours:.0} | {gigabytes:.1} | {theirs:.0} | {times:.2} | {spikes} | {their_spikes} |",
    );
}
