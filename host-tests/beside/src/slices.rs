//! No form for slices may be slower than the same samples one by one: every scheme as it flies, both ways, on every
//! channel of the recorded flights.

use std::hint::black_box;

use catalogue::{Channel, Flight, State};
use spikewire::{Calibration, ConfigError, Output, Sample, Scheme};

use crate::timing::{Turns, variants};

const ROUNDS: usize = 41;
/// Those and the rounds of a second look.
const MOST_ROUNDS: usize = 6 * ROUNDS;

/// By how much a median may be off on a machine with other work: what is slower than this is looked at once more.
const NOISE: f64 = 1.05;

/// Both ways of a scheme on a channel.
pub struct Measured {
    pub name: &'static str,
    pub way: &'static str,
    pub channel: String,
    /// How many times as long single samples take.
    pub times: f64,
    /// Of slices, in millions a second.
    pub samples: f64,
}

struct Slices<'a, S> {
    variants: &'a [Vec<S>],
    channel: &'a str,
    measured: Vec<Measured>,
}

impl<S: Sample> Slices<'_, S> {
    /// Measures the slice's form against single samples; what seems slower is measured once more, and longer.
    fn measure(
        &mut self,
        name: &'static str,
        way: &'static str,
        mut slice: impl FnMut(usize),
        mut each: impl FnMut(usize),
    ) {
        let mut turns = Turns::take(ROUNDS, &mut slice, &mut each);
        if turns.ratio() * NOISE < 1.0 {
            turns = Turns::take(MOST_ROUNDS - ROUNDS, slice, each);
        }
        self.measured.push(Measured {
            name,
            way,
            channel: self.channel.into(),
            times: turns.ratio(),
            samples: 1e-6 * self.variants[0].len() as f64 / turns.of(0),
        });
    }
}

impl<S: Sample> Flight for Slices<'_, S> {
    type Sample = S;
    type Error = ConfigError;

    fn visit<P>(
        &mut self,
        name: &'static str,
        _: &'static str,
        scheme: &P,
        start: P::EncoderState,
    ) -> Result<(), ConfigError>
    where
        P: Scheme<Sample = S, EncoderState: State, DecoderState: State>,
    {
        let start = postcard::to_allocvec(&start).unwrap();
        // A state need not be `Clone`. One for each round is read back before the rounds.
        let state = || -> P::EncoderState { postcard::from_bytes(&start).unwrap() };
        let states = || (0..MOST_ROUNDS).map(|_| state()).collect::<Vec<_>>();
        let (mut ones, mut others) = (states(), states());
        let variants = self.variants;
        let outputs = variants.iter().map(|samples| {
            let mut state = state();
            samples.iter().map(|&sample| scheme.encode(&mut state, sample)).collect()
        });
        let outputs: Vec<Vec<P::Output>> = outputs.collect();
        let codes =
            outputs.iter().map(|all| all.iter().filter_map(|output| output.code()).collect());
        let codes: Vec<Vec<P::Code>> = codes.collect();
        let (mut sliced, mut single) = (outputs[0].clone(), outputs[0].clone());
        self.measure(
            name,
            "encoding",
            |variant| {
                let mut state = ones.pop().unwrap();
                let samples = black_box(&variants[variant][..]);
                scheme.encode_slice(&mut state, samples, black_box(&mut sliced));
            },
            |variant| {
                let mut state = others.pop().unwrap();
                let samples = black_box(&variants[variant]);
                for (output, &sample) in black_box(&mut single).iter_mut().zip(samples) {
                    *output = scheme.encode(&mut state, sample);
                }
            },
        );
        let mut sliced = vec![S::default(); codes[0].len()];
        let mut single = sliced.clone();
        self.measure(
            name,
            "decoding",
            |variant| {
                let mut state = scheme.decoder_state();
                let codes = black_box(&codes[variant][..]);
                scheme.decode_slice(&mut state, codes, black_box(&mut sliced));
            },
            |variant| {
                let mut state = scheme.decoder_state();
                let codes = black_box(&codes[variant]);
                for (value, &code) in black_box(&mut single).iter_mut().zip(codes) {
                    *value = scheme.decode(&mut state, code);
                }
            },
        );
        Ok(())
    }
}

/// Measures every scheme in one type of samples. In whole numbers a channel fills three quarters of the type.
pub fn every_scheme<S: Sample>(words: &str, largest: Option<f64>) -> Vec<Measured> {
    let mut measured = Vec::new();
    for (flight, recording) in
        [("hexarotor", flight_data::HEXAROTOR), ("vtol_at_rest", flight_data::VTOL_AT_REST)]
    {
        for index in 0..6 {
            let samples: Vec<f64> = flight_data::channel(recording, index).map(f64::from).collect();
            let peak = samples.iter().fold(0.0_f64, |peak, x| peak.max(x.abs()));
            let unit = largest.map_or(1.0, |largest| 0.75 * largest / peak);
            let of = |x: f64| S::from_f64(x * unit);
            let variants = variants(&samples).into_iter();
            let variants: Vec<Vec<S>> =
                variants.map(|samples| samples.into_iter().map(of).collect()).collect();
            let mut calibration = Calibration::new();
            variants[0].iter().for_each(|&sample| calibration.observe(sample));
            let channel = format!("{words}, {flight}, channel {index}");
            let mut slices =
                Slices { variants: &variants, channel: &channel, measured: Vec::new() };
            catalogue::fly(&Channel::new(index, calibration), &mut slices).unwrap();
            measured.append(&mut slices.measured);
        }
    }
    measured
}
