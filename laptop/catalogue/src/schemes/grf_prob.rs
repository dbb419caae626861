//! Gaussian receptive fields with probabilistic spiking.

use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;
use spikewire::population::{FiredNeurons, Probabilistic};

use crate::plain::response;
use crate::prelude::*;

/// Gaussian receptive fields with probabilistic spiking.
#[derive(Clone, Copy, Debug)]
pub struct Scheme;

// As the checks fly it.
const NEURONS: usize = 15;

impl Entry for Scheme {
    const INFO: Info = Info {
        name: "grf-prob",
        type_name: "Probabilistic",
        title: "GRF, probabilistic",
        words: "GRF with probabilistic spiking",
        good_for: "a value by chance, from your generator",
        colour: [0xb5, 0x83, 0x8d],
        parameters: &[
            Parameter::neurons("15"),
            Parameter::MIN,
            Parameter::MAX,
            Parameter::BETA,
            Parameter::SEED,
        ],
        ..Info::BLANK
    };

    const IN_C: &'static [InC] = &[];

    fn fly<V: Flight>(channel: &Channel<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        let scheme =
            Probabilistic::<_, Pcg32, NEURONS, 64>::try_new(channel.min..=channel.max, 1.5)?;
        let generator = Pcg32::new(2026, channel.index as u64);
        let start = Probabilistic::<V::Sample, Pcg32, NEURONS, 64>::state(generator);
        visitor.visit("grf-prob", Self::INFO.words, &scheme, start)
    }

    fn count<V: Count>(signal: &Scaled<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        let scheme = Probabilistic::<_, Pcg32, 15, 16>::try_new(signal.min..=signal.max, 1.5)?;
        let (sigma, means) = ((signal.range / (1.5 * 13.0)) as f32, signal.means::<15>());
        let mut random = generator();
        visitor.neurons::<_, 15>(
            "grf-random-15x16",
            &scheme,
            &|| Probabilistic::<V::Sample, Pcg32, 15, 16>::state(generator()),
            fired_of,
            |signal, fired| transcribed(signal, &means, sigma, 16, || random.next_u32(), fired),
            |fired, before, values| {
                transcribed_decoder(fired, scheme.centres(), before, values);
            },
        )
    }
}

#[cfg(feature = "run")]
impl Build for Scheme {
    population!(|settings| {
        let (neurons, beta) = (settings.neurons()?, settings.number("beta")? as f32);
        let generator = settings.generator()?;
        let scheme = dynamic::Probabilistic::<S, _, M>::try_new(neurons, &settings.range()?, beta)?;
        (dynamic::Probabilistic::<S, _, M>::state(generator), scheme)
    });
}

/// Makes the random generator for the counted code, whose work is counted too.
fn generator() -> Pcg32 {
    Pcg32::new(2, 2)
}

/// Converts a code from the transcription's form: 1 for each neuron that fired.
fn fired_of(fired: &[i8]) -> FiredNeurons<15> {
    let neurons = (0..).zip(fired).filter(|&(_, &fired)| fired == 1).map(|(neuron, _)| neuron);
    FiredNeurons::new(neurons).unwrap_or(FiredNeurons::EMPTY)
}

/// Encodes by chance, with exponentials, in `f32` for every sample type: draws a number below the levels for each
/// neuron that responds. Writes whether each neuron fired, one sample after the other.
#[inline(never)]
pub fn transcribed<S: Plain>(
    input: &[S],
    centres: &[f32],
    sigma: f32,
    levels: u32,
    mut draw: impl FnMut() -> u32,
    fired: &mut [i8],
) {
    for i in 0..input.len() {
        let x = input[i].to_f64() as f32;
        for j in 0..centres.len() {
            let level = (levels as f32 * response(x, centres[j], sigma) + 0.5) as u32;
            let does_fire = level > 0 && draw() / (u32::MAX / levels + 1) < level;
            fired[i * centres.len() + j] = i8::from(does_fire);
        }
    }
}

/// Decodes to the mean of the centres that fired, or to the previous value if none did.
#[inline(never)]
pub fn transcribed_decoder<S: Plain>(fired: &[i8], centres: &[S], mut value: S, values: &mut [S]) {
    for i in 0..values.len() {
        let (mut sum, mut total) = (S::Wide::default(), 0);
        for j in 0..centres.len() {
            if fired[i * centres.len() + j] == 1 {
                sum += centres[j].into();
                total += 1;
            }
        }
        if total > 0 {
            value = S::narrow(sum / S::count(total as i16));
        }
        values[i] = value;
    }
}
