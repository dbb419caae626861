//! No form for slices may be slower than the same samples one by one: every scheme as it flies, both ways, on every
//! channel of the recorded flights.

use std::hint::black_box;

use catalogue::{Channel, Flight, State};
use spikewire::{Calibration, ConfigError, Output, Sample, Scheme};

use crate::timing::Turns;

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
    samples: &'a [S],
    channel: &'a str,
    measured: Vec<Measured>,
}

impl<S: Sample> Slices<'_, S> {
    /// Measures the slice's form against single samples; what seems slower is measured once more, and longer.
    fn measure(
        &mut self,
        name: &'static str,
        way: &'static str,
        mut slice: impl FnMut(),
        mut each: impl FnMut(),
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
            samples: 1e-6 * self.samples.len() as f64 / turns.of(0),
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
        let samples = self.samples;
        let mut state_of_outputs = state();
        let outputs: Vec<P::Output> =
            samples.iter().map(|&sample| scheme.encode(&mut state_of_outputs, sample)).collect();
        let codes: Vec<P::Code> = outputs.iter().filter_map(|output| output.code()).collect();
        let mut outputs = [outputs.clone(), outputs];
        let [sliced, single] = &mut outputs;
        self.measure(
            name,
            "encoding",
            || {
                let mut state = ones.pop().unwrap();
                scheme.encode_slice(&mut state, black_box(samples), black_box(sliced));
            },
            || {
                let mut state = others.pop().unwrap();
                for (output, &sample) in black_box(&mut *single).iter_mut().zip(black_box(samples))
                {
                    *output = scheme.encode(&mut state, sample);
                }
            },
        );
        let mut values = [vec![S::default(); codes.len()], vec![S::default(); codes.len()]];
        let [sliced, single] = &mut values;
        self.measure(
            name,
            "decoding",
            || {
                let mut state = scheme.decoder_state();
                scheme.decode_slice(&mut state, black_box(&codes[..]), black_box(sliced));
            },
            || {
                let mut state = scheme.decoder_state();
                for (value, &code) in black_box(&mut *single).iter_mut().zip(black_box(&codes)) {
                    *value = scheme.decode(&mut state, code);
                }
            },
        );
        Ok(())
    }
}

/// Measures every scheme in one type of samples, whose unit is so many of theirs.
pub fn every_scheme<S: Sample>(words: &str, unit: f64) -> Vec<Measured> {
    let mut measured = Vec::new();
    for (flight, recording) in
        [("hexarotor", flight_data::HEXAROTOR), ("vtol_at_rest", flight_data::VTOL_AT_REST)]
    {
        for index in 0..6 {
            let samples = flight_data::channel(recording, index);
            let samples: Vec<S> =
                samples.map(|sample| S::from_f64(f64::from(sample) * unit)).collect();
            let mut calibration = Calibration::new();
            samples.iter().for_each(|&sample| calibration.observe(sample));
            let channel = format!("{words}, {flight}, channel {index}");
            let mut slices = Slices { samples: &samples, channel: &channel, measured: Vec::new() };
            catalogue::fly(&Channel::new(index, calibration), &mut slices).unwrap();
            measured.append(&mut slices.measured);
        }
    }
    measured
}
