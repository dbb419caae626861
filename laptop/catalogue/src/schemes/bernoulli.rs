//! Bernoulli, the random rate code.

use rand_pcg::Pcg32;
use rand_pcg::rand_core::Rng;
use spikewire::Spike;
use spikewire::rate::{Average, Bernoulli};

use crate::prelude::*;

#[cfg(feature = "run")]
use spikewire::rate::Window;

/// Bernoulli.
#[derive(Clone, Copy, Debug)]
pub struct Scheme;

impl Entry for Scheme {
    const INFO: Info = Info {
        name: "bernoulli",
        type_name: "Bernoulli",
        title: "Bernoulli",
        words: "Bernoulli (random rate)",
        good_for: "a mean by chance, from your generator, as networks are trained with",
        colour: [0x8f, 0x8a, 0xa8],
        parameters: &[
            Parameter::MIN,
            Parameter::MAX,
            Parameter::MEAN,
            Parameter::POWER,
            Parameter::SEED,
        ],
        ..Info::BLANK
    };

    const IN_C: &'static [InC] = &[];

    fn fly<V: Flight>(channel: &Channel<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        let scheme = Bernoulli::<_, Pcg32, _>::try_new(
            channel.min..=channel.max,
            const { Average::new(4) },
        )?;
        let generator = Pcg32::new(2026, channel.index as u64);
        let start = Bernoulli::<V::Sample, Pcg32, Average>::state(generator);
        visitor.visit("bernoulli", Self::INFO.words, &scheme, start)
    }

    fn count<V: Count>(signal: &Scaled<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        let (min, max) = (signal.min, signal.max);
        let scheme = Bernoulli::<_, Pcg32, _>::try_new(min..=max, Average::new(4))?;
        let mut random = generator();
        visitor.coded_from(
            "bernoulli",
            &scheme,
            &|| Bernoulli::<V::Sample, Pcg32, Average>::state(generator()),
            Spike::sign,
            spike_of,
            |signal, spikes| transcribed(signal, min, max, || random.next_u32(), spikes),
            |spikes, values| {
                let range = max.into() - min.into();
                plain::average_decode(spikes, min, max, (range, 0), 4, values);
            },
        )
    }
}

#[cfg(feature = "run")]
impl Build for Scheme {
    fn build<S: Sample, V: Visit<S>>(settings: &Settings, visitor: V) -> Result<V::Output> {
        type Random<S, A> = Bernoulli<S, Pcg32, A>;
        let generator = settings.generator()?;
        let range = settings.range()?;
        if settings.takes_window()? {
            let scheme = Random::<S, _>::try_new(range, settings.window()?)?;
            return visitor.visit(scheme, Random::<S, Window<128>>::state(generator));
        }
        let scheme = Random::<S, _>::try_new(range, settings.average()?)?;
        visitor.visit(scheme, Random::<S, Average>::state(generator))
    }
}

/// Makes the random generator for the counted code, whose work is counted too.
fn generator() -> Pcg32 {
    Pcg32::new(2, 2)
}

/// Encodes by the definition.
#[inline(never)]
pub fn transcribed<S: Plain>(
    input: &[S],
    min: S,
    max: S,
    mut draw: impl FnMut() -> u32,
    spikes: &mut [i8],
) {
    let range = max.into() - min.into();
    for i in 0..input.len() {
        let above = plain::above_min(input[i], min, max);
        spikes[i] = i8::from(S::is_drawn(above, range, draw() >> 16));
    }
}
