//! Six channels in one call of the run-time codec, as Python takes them, beside the codec's channel by channel and
//! ferromorphic's in `f64`.

use std::hint::black_box;

use catalogue::ALL;
use catalogue::run::{Asked, Known, SampleType, Samples, Value};
use ferromorphic::coding::{self, ContrastMode};

use crate::timing::{Turns, variants};

const ROUNDS: usize = 61;
const CHANNELS: usize = 6;

/// A threshold of the temporal codes and one of T-HSA and BSA, of signals from 0 to 1.
const STEP: f64 = 0.05;
const ERROR: f64 = 0.1;

/// Another crate's encoder of one channel.
type Peer = Box<dyn Fn(&[f64])>;

/// A code, its name in the catalogue, its options, and ferromorphic's if it has that code.
type Row = (&'static str, &'static str, Vec<(&'static str, Value)>, Option<Peer>);

/// Prints a table for each recording.
pub fn tables() {
    let flights =
        [("hexarotor", flight_data::HEXAROTOR), ("vtol_at_rest", flight_data::VTOL_AT_REST)];
    for (flight, recording) in flights {
        let channels = (0..CHANNELS).map(|index| unit(recording, index));
        let channels: Vec<Vec<f64>> = channels.collect();
        println!("\nSix channels of `{flight}`, each from 0 to 1:\n");
        println!("| code | M samples/s | one by one | times | ferromorphic | times |");
        println!("|---|---:|---:|---:|---:|---:|");
        codes().into_iter().for_each(|code| row(code, &channels));
    }
}

/// A channel of a recording, scaled to values from 0 to 1.
fn unit(recording: &[u8], index: usize) -> Vec<f64> {
    let samples: Vec<f64> = flight_data::channel(recording, index).map(f64::from).collect();
    let low = samples.iter().copied().fold(f64::INFINITY, f64::min);
    let high = samples.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    samples.iter().map(|x| (x - low) / (high - low)).collect()
}

fn codes() -> Vec<Row> {
    let contrast = |mode| -> Option<Peer> {
        let code = coding::TemporalContrast::new(STEP, mode).unwrap();
        Some(Box::new(move |x| drop(black_box(code.encode(x, 0).unwrap()))))
    };
    let hough = |threshold| -> Option<Peer> {
        let code = coding::Hsa::new(triangle(15, 1.0 / 7.5), threshold).unwrap();
        Some(Box::new(move |x| drop(black_box(code.encode(x).unwrap()))))
    };
    let bsa = coding::Bsa::new(triangle(24, 1.0 / 12.0), STEP).unwrap();
    let bsa = move |x: &[f64]| drop(black_box(bsa.encode(x).unwrap()));
    let step = ("threshold", STEP.into());
    let filter = ("filter", "triang:15,peak=0.125".into());
    let shift = ("shift", 0.0.into());
    let window = ("window", 5_u64.into());
    let neuron = vec![
        ("threshold", 1.0.into()),
        ("power", 4_u64.into()),
        ("reference", 0.0.into()),
        ("spikes", 1_u64.into()),
    ];
    vec![
        ("TBR", "tbr", vec![step.clone()], contrast(ContrastMode::ThresholdBased)),
        (
            "MW, W = 5",
            "mw",
            vec![step.clone(), window],
            contrast(ContrastMode::MovingWindow { window: 6 }),
        ),
        ("SF", "sf", vec![step.clone()], contrast(ContrastMode::StepForward)),
        (
            "BSA, 24 taps",
            "bsa",
            vec![
                ("filter", "triang:24,peak=0.08".into()),
                shift.clone(),
                ("criterion", "sub".into()),
                step,
            ],
            Some(Box::new(bsa)),
        ),
        ("IF", "if", neuron.clone(), None),
        ("LIF", "lif", neuron, None),
        ("HSA, 15 taps", "hsa", vec![filter.clone(), shift.clone()], hough(0.0)),
        ("T-HSA, 15 taps", "t-hsa", vec![filter, shift, ("threshold", ERROR.into())], hough(ERROR)),
    ]
}

/// A filter of triangular form whose highest tap is nearly `peak`.
fn triangle(length: usize, peak: f64) -> Vec<f64> {
    let tap = |k| 1.0 - (2.0 * k as f64 + 1.0 - length as f64).abs() / (length as f64 + 1.0);
    (0..length).map(|k| tap(k) * peak).collect()
}

fn row((title, name, options, peer): Row, channels: &[Vec<f64>]) {
    let scheme = *ALL.iter().find(|scheme| scheme.info().name == name).unwrap();
    let length = channels[0].len();
    let mut asked = Asked::default();
    for (name, value) in options {
        asked.set(name, value);
    }
    let known = Known { calibrated: None, first: &channels[0], can_calibrate: false };
    let settings = scheme.resolve(SampleType::F32, &asked, &known).unwrap();
    let codec = || scheme.codec_from(&settings, None).unwrap();
    let wide = variants(&channels.concat());
    let own: Vec<Vec<f32>> =
        wide.iter().map(|all| all.iter().map(|x| *x as f32).collect()).collect();
    let (mut six, mut one) = (codec(), codec());
    let mut cells = vec![0; wide[0].len()];
    let mut at_once = |variant: usize| {
        let samples = Samples::F32(black_box(&own[variant]));
        six.encode_channels(samples, length, 0, black_box(&mut cells));
    };
    let mut room = vec![0; length];
    let each = |variant: usize| {
        for samples in black_box(&own[variant]).chunks(length) {
            one.encode_channels(Samples::F32(samples), length, 0, black_box(&mut room));
        }
    };
    let turns = Turns::take(ROUNDS, &mut at_once, each);
    let millions = |turns: &Turns, which| 1e-6 * own[0].len() as f64 / turns.of(which);
    let [ours, single] = [0, 1].map(|which| millions(&turns, which));
    print!("| {title} | {ours:.0} | {single:.0} | {:.1} ", turns.ratio());
    let Some(peer) = peer else { return println!("| – | – |") };
    let theirs = |variant: usize| black_box(&wide[variant]).chunks(length).for_each(&peer);
    let turns = Turns::take(ROUNDS, at_once, theirs);
    println!("| {:.0} | {:.1} |", millions(&turns, 1), turns.ratio());
}
