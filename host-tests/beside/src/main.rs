//! Slices of spikewire beside ferromorphic's on this machine, in turns: a row of a table for each code.

use std::{array, f64::consts::TAU, hint::black_box, time::Instant};

use ferromorphic::coding::{self, ContrastMode};
use spikewire::{
    Output, Scheme, Spike, Start,
    rate::{Bsa, Criterion, Hough, Taps, ThresholdHough},
    temporal::{MovingWindow, StepForward, TemporalContrast},
};

const ROUNDS: usize = 61;
const LENGTH: usize = 10_000;

/// What a sample and its spike take, of which one is read and the other written.
const BYTES: usize = size_of::<f32>() + size_of::<Spike>();

fn main() {
    println!("| code | M samples/s | GB/s | ferromorphic | times | spikes | ferromorphic |");
    println!("|---|---:|---:|---:|---:|---:|---:|");
    // The paper's, without its noise.
    let signal: [f64; LENGTH] = array::from_fn(|k| {
        let t = k as f64 / 100.0;
        2.0 * (TAU * t).sin() - 0.5 * (TAU / 4.0 * t).cos() + 0.75 * (5.0 * TAU * t).sin()
    });
    contrast("TBR", &TemporalContrast::new(0.3), 0.3, ContrastMode::ThresholdBased, &signal);
    let window = ContrastMode::MovingWindow { window: 6 };
    contrast("MW, W = 5", &MovingWindow::<_, 5>::new(0.25), 0.25, window, &signal);
    contrast("SF", &StepForward::new(0.5), 0.5, ContrastMode::StepForward, &signal);

    // Rate codes code what is above 0, and a filter that is as high at most gives spikes at any time.
    let signal = signal.map(|x| (x + 3.25) / 6.5);
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

    let (from, mut to) = (vec![1_u8; 1 << 27], vec![0; 1 << 27]);
    let second = median(
        (0..9).map(|_| seconds(|| black_box(&mut to).copy_from_slice(black_box(&from)))).collect(),
    );
    let copied = (1 << 27) as f64 / second * 1e-9;
    println!(
        "\nThe memory copies {copied:.1} GB a second: it reads and writes {:.1}.",
        2.0 * copied
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
    let encode = |signal: &[f64]| theirs.encode(signal, 0).unwrap();
    let spikes = encode(signal);
    let decode = || theirs.decode(&spikes, 0, signal.len(), signal[0]);
    row(
        name,
        scheme,
        signal,
        spikes.len(),
        |x| drop(black_box(encode(x))),
        || drop(black_box(decode())),
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
    let spikes = encode(signal);
    let fired = spikes.iter().filter(|fired| **fired).count();
    row(
        name,
        scheme,
        signal,
        fired,
        |x| drop(black_box(encode(x))),
        || drop(black_box(decode(&spikes))),
    );
}

/// Both ways, ours and theirs.
fn row<P: Scheme<Sample = f32, Code = Spike, Output: Output<Code = Spike> + Default> + Start>(
    name: &str,
    scheme: &P,
    signal: &[f64],
    their_spikes: usize,
    their_encode: impl Fn(&[f64]),
    their_decode: impl Fn(),
) {
    let samples: Vec<f32> = signal.iter().map(|&sample| sample as f32).collect();
    let mut outputs = vec![P::Output::default(); samples.len()];
    scheme.encoder().encode_slice(&samples, &mut outputs);
    let codes: Vec<Spike> = outputs.iter().filter_map(|output| output.code()).collect();
    let spikes = codes.iter().filter(|code| **code != Spike::None).count();
    let encode = || {
        scheme.encoder().encode_slice(black_box(&samples), black_box(&mut outputs));
    };
    let mut values = vec![0.0; codes.len()];
    let decode = || {
        scheme.decoder().decode_slice(black_box(&codes), black_box(&mut values));
    };
    in_turns(name, [spikes, their_spikes], encode, || their_encode(black_box(signal)));
    in_turns(&format!("{name}, decoding"), [spikes, their_spikes], decode, their_decode);
}

fn in_turns(name: &str, spikes: [usize; 2], mut ours: impl FnMut(), theirs: impl Fn()) {
    let pairs: Vec<[f64; 2]> =
        (0..ROUNDS).map(|_| [seconds(&mut ours), seconds(&theirs)]).collect();
    let of = |which: usize| {
        1e-6 * LENGTH as f64 / median(pairs.iter().map(|pair| pair[which]).collect())
    };
    let times = median(pairs.iter().map(|pair| pair[1] / pair[0]).collect());
    let ([ours, theirs], [own_spikes, their_spikes]) = ([of(0), of(1)], spikes);
    let gigabytes = ours * BYTES as f64 * 1e-3;
    println!(
        "| {name} | {ours:.0} | {gigabytes:.1} | {theirs:.0} | {times:.1} | {own_spikes} | {their_spikes} |",
    );
}

fn seconds(work: impl FnOnce()) -> f64 {
    let start = Instant::now();
    work();
    start.elapsed().as_secs_f64()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
