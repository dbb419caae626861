//! Gaussian receptive fields (GRF), winner takes all.

use spikewire::population::Gaussian;

use crate::plain::response;
use crate::prelude::*;

/// Gaussian receptive fields, one spike a sample.
#[derive(Clone, Copy, Debug)]
pub struct Scheme;

// As the checks fly it.
const NEURONS: usize = 20;

impl Entry for Scheme {
    const INFO: Info = Info {
        name: "grf",
        type_name: "Gaussian",
        title: "GRF",
        words: "Gaussian receptive fields (GRF)",
        good_for: "a value over an even range",
        is_drawn: true,
        colour: [0xd9, 0x88, 0x80],
        parameters: &[Parameter::neurons("20"), Parameter::MIN, Parameter::MAX],
        ..Info::BLANK
    };

    const IN_C: &'static [InC] = &[InC {
        name: "gaussian",
        scheme: "population::Gaussian<S, {0}>",
        shapes: &[&[NEURONS]],
        made: &[Made {
            name: "init",
            words: "`min`, `max`: the range, which must rise.",
            arguments: &[Argument::MIN, Argument::MAX],
            value: "population::Gaussian::try_linear(min..=max)",
            flies: Some("grf"),
        }],
    }];

    fn fly<V: Flight>(channel: &Channel<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        let scheme = Gaussian::<_, NEURONS>::try_linear(channel.min..=channel.max)?;
        visitor.visit("grf", Self::INFO.words, &scheme, Gaussian::<V::Sample, NEURONS>::START)
    }

    fn count<V: Count>(signal: &Scaled<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        let scheme = Gaussian::<_, 20>::try_linear(signal.min..=signal.max)?;
        let (sigma, means) = ((signal.range / 18.0) as f32, signal.means::<20>());
        visitor.winner("grf-20", &scheme, &means, &[sigma; 20], |signal, neurons| {
            transcribed(signal, &means, sigma, neurons);
        })
    }
}

#[cfg(feature = "run")]
impl Build for Scheme {
    const CONSTANT: Option<[&str; 3]> =
        Some(["population::Gaussian", "{neurons}", "linear({range})"]);

    // Neurons are found by bisection.
    costs!(Gaussian<S, 20>, "grf-20", |settings| settings.neurons()? as f64 / 20.0);

    population!(|settings| {
        let scheme =
            dynamic::Position::<S, M>::try_linear(settings.neurons()?, &settings.range()?)?;
        (scheme.state(), scheme)
    });
}

/// Encodes by the paper's algorithm 2, with its exponentials, in `f32` for every sample type: finds the winner.
#[inline(never)]
pub fn transcribed<S: Plain>(input: &[S], centres: &[f32], sigma: f32, neurons: &mut [i8]) {
    for i in 0..input.len() {
        let x = input[i].to_f64() as f32;
        let (mut winner, mut largest) = (0, 0.0);
        for j in 0..centres.len() {
            let response = response(x, centres[j], sigma);
            if response > largest {
                (winner, largest) = (j, response);
            }
        }
        neurons[i] = winner as i8;
    }
}
