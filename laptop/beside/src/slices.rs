//! No form for slices may be slower than the same samples one by one: every scheme as it flies, both ways, on the six
//! channels of each recorded flight.

use std::hint::black_box;

use catalogue::{Channel, Flight, Storable};
use spikewire::{Calibration, ConfigError, Output, Sample};

use crate::timing::{Turns, variants};

const ROUNDS: usize = 41;
/// Those and the rounds of a second look.
const MOST_ROUNDS: usize = 6 * ROUNDS;

/// By how much a median may be off on a machine with other work: what is slower than this is looked at once more.
const NOISE: f64 = 1.05;

/// One way of a scheme on a flight's channels.
pub struct Measured {
    pub name: &'static str,
    pub way: &'static str,
    pub flight: String,
    samples: usize,
    /// The sum over the channels: slices, and single samples.
    seconds: [f64; 2],
}

impl Measured {
    /// How many times as long single samples take.
    pub fn times(&self) -> f64 {
        self.seconds[1] / self.seconds[0]
    }

    /// The speed of slices, in millions of samples a second.
    pub fn millions(&self) -> f64 {
        1e-6 * self.samples as f64 / self.seconds[0]
    }

    /// Adds what another channel took.
    fn add(&mut self, other: &Self) {
        self.samples += other.samples;
        for (sum, seconds) in self.seconds.iter_mut().zip(other.seconds) {
            *sum += seconds;
        }
    }
}

struct Slices<'a, S> {
    variants: &'a [Vec<S>],
    flight: &'a str,
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
        // The single samples' time by the turns' ratio, as other work slows both of a turn.
        let sliced = turns.of(0);
        self.measured.push(Measured {
            name,
            way,
            flight: self.flight.into(),
            samples: self.variants[0].len(),
            seconds: [sliced, sliced * turns.ratio()],
        });
    }
}

impl<S: Sample> Flight for Slices<'_, S> {
    type Sample = S;
    type Error = ConfigError;

    fn visit<P: Storable<Sample = S>>(
        &mut self,
        name: &'static str,
        _: &'static str,
        scheme: &P,
        start: P::EncoderState,
    ) -> Result<(), ConfigError> {
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
    let flights =
        [("hexarotor", flight_data::HEXAROTOR), ("vtol_at_rest", flight_data::VTOL_AT_REST)];
    let channels = flights.map(|(flight, recording)| {
        let flight = format!("{words}, {flight}");
        let channels = (0..6).map(|index| channel::<S>(&flight, recording, index, largest));
        let sums = channels.reduce(|mut sums, channel| {
            sums.iter_mut().zip(&channel).for_each(|(sum, one)| sum.add(one));
            sums
        });
        sums.unwrap_or_default()
    });
    channels.into_iter().flatten().collect()
}

/// Measures every scheme on one channel.
fn channel<S: Sample>(
    flight: &str,
    recording: &[u8],
    index: usize,
    largest: Option<f64>,
) -> Vec<Measured> {
    let samples: Vec<f64> = flight_data::channel(recording, index).map(f64::from).collect();
    let peak = samples.iter().fold(0.0_f64, |peak, x| peak.max(x.abs()));
    let unit = largest.map_or(1.0, |largest| 0.75 * largest / peak);
    let of = |x: f64| S::from_f64(x * unit);
    let variants = variants(&samples).into_iter();
    let variants: Vec<Vec<S>> =
        variants.map(|samples| samples.into_iter().map(of).collect()).collect();
    let mut calibration = Calibration::new();
    variants[0].iter().for_each(|&sample| calibration.observe(sample));
    let mut slices = Slices { variants: &variants, flight, measured: Vec::new() };
    catalogue::fly(&Channel::new(index, calibration), &mut slices).unwrap();
    slices.measured
}
