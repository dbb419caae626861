//! The population codes.

use super::Codec;
use super::erased::{erase, erase_pair};
use super::shapes::{for_each_field, for_each_population, for_each_slot_count, unsupported};
use crate::settings::{
    Centres as CentreSettings, Evenly, Fields, Probabilistic as ProbabilisticSettings,
};
use anyhow::Result;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use spikewire::Sample;
use spikewire::population::{Centres, Position, Probabilistic, ReceptiveFields, Slots};

/// How many levels the probability of a spike has.
const PROBABILITY_LEVELS: usize = 256;

pub(super) fn position<S: Sample>(settings: &CentreSettings) -> Result<Codec> {
    macro_rules! with_neurons {
        ($($m:literal)*) => {
            match settings.neurons() {
                $($m => with_centres::<S, $m>(settings),)*
                neurons => Err(unsupported("the number of neurons", neurons, &[$($m),*])),
            }
        };
    }
    for_each_population!(with_neurons)
}

pub(super) fn gaussian<S: Sample>(range: &Evenly) -> Result<Codec> {
    position::<S>(&CentreSettings::Linear(*range))
}

fn with_centres<S: Sample, const M: usize>(settings: &CentreSettings) -> Result<Codec> {
    let centres: Centres<S, M> = match settings {
        CentreSettings::Linear(range) => {
            Centres::new_linear(S::from_f64(range.min), S::from_f64(range.max))?
        }
        CentreSettings::GaussianSpaced(range) => {
            Centres::new_gaussian_spaced(S::from_f64(range.min), S::from_f64(range.max))?
        }
        CentreSettings::Listed(list) => {
            Centres::new(std::array::from_fn(|neuron| S::from_f64(list[neuron])))?
        }
    };
    // Leaked for the reason told in `rate`.
    Ok(erase(Position::new(Box::leak(Box::new(centres)))))
}

pub(super) fn slots<S: Sample>(settings: &crate::settings::Slots) -> Result<Codec> {
    macro_rules! with_slots {
        ($($n:literal)*) => {
            match settings.slots {
                $($n => slots_of::<S, $n>(settings),)*
                slots => Err(unsupported("the number of slots", slots, &[$($n),*])),
            }
        };
    }
    for_each_slot_count!(with_slots)
}

fn slots_of<S: Sample, const N: usize>(settings: &crate::settings::Slots) -> Result<Codec> {
    macro_rules! with_neurons {
        ($($m:literal)*) => {
            match settings.fields.range.neurons {
                $($m => {
                    let fields = fields::<S, $m, N>(&settings.fields)?;
                    Ok(erase(Slots::new(fields).with_floor(settings.floor)?))
                })*
                neurons => Err(unsupported("the number of neurons", neurons, &[$($m),*])),
            }
        };
    }
    for_each_field!(with_neurons)
}

pub(super) fn probabilistic<S: Sample>(settings: &ProbabilisticSettings) -> Result<Codec> {
    macro_rules! with_neurons {
        ($($m:literal)*) => {
            match settings.fields.range.neurons {
                $($m => {
                    let fields = fields::<S, $m, PROBABILITY_LEVELS>(&settings.fields)?;
                    let scheme = Probabilistic::new(fields);
                    let generator = ChaCha8Rng::seed_from_u64(settings.seed);
                    Ok(erase_pair(scheme.encoder(generator), scheme.decoder(), 0))
                })*
                neurons => Err(unsupported("the number of neurons", neurons, &[$($m),*])),
            }
        };
    }
    for_each_field!(with_neurons)
}

fn fields<S: Sample, const M: usize, const N: usize>(
    settings: &Fields,
) -> Result<&'static ReceptiveFields<S, M, N>> {
    let (min, max) = (S::from_f64(settings.range.min), S::from_f64(settings.range.max));
    Ok(Box::leak(Box::new(ReceptiveFields::new(min, max, settings.beta as f32)?)))
}
