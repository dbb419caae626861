//! Gaussian receptive fields with sub-timesteps.

use spikewire::population::{SlotSpikes, Slots};

use crate::plain::response;
use crate::prelude::*;

/// Gaussian receptive fields with sub-timesteps.
#[derive(Clone, Copy, Debug)]
pub struct Scheme;

// As the checks fly it.
const NEURONS: usize = 15;
const SLOTS: usize = 10;
const BETA: f32 = 1.5;

impl Entry for Scheme {
    const INFO: Info = Info {
        name: "grf-slots",
        type_name: "Slots",
        title: "GRF, slots",
        words: "GRF with sub-timesteps",
        good_for: "a value finer than the neurons, by spike time",
        colour: [0x8e, 0x3b, 0x46],
        parameters: &[
            Parameter::neurons("15"),
            Parameter::MIN,
            Parameter::MAX,
            Parameter::SLOTS,
            Parameter::BETA,
            Parameter::FLOOR,
        ],
        ..Info::BLANK
    };

    const IN_C: &'static [InC] = &[InC {
        name: "slots",
        scheme: "population::Slots<S, {0}, {1}>",
        shapes: &[&[NEURONS, SLOTS]],
        made: &[Made {
            name: "init",
            words: "`min`, `max`: the range, which must rise. `beta`: the fields' width is their distance divided by it, above 0; `floor`: neurons below this level of the slots are silent, 1 or more.",
            arguments: &[
                Argument::MIN,
                Argument::MAX,
                Argument::number("beta", "f32", BETA as f64),
                Argument::number("floor", "u16", 1.0),
            ],
            value: "population::Slots::try_new(min..=max, beta)?.try_with_floor(floor)",
            flies: Some("grf-slots"),
        }],
    }];

    fn fly<V: Flight>(channel: &Channel<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        let scheme = Slots::<_, NEURONS, SLOTS>::try_new(channel.min..=channel.max, BETA)?;
        visitor.visit(
            "grf-slots",
            Self::INFO.words,
            &scheme,
            Slots::<V::Sample, NEURONS, SLOTS>::START,
        )
    }

    fn count<V: Count>(signal: &Scaled<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        let scheme = Slots::<_, 15, 10>::try_new(signal.min..=signal.max, 1.5)?;
        let (sigma, means) = ((signal.range / (1.5 * 13.0)) as f32, signal.means::<15>());
        visitor.neurons::<_, 15>(
            "grf-slots-15x10",
            &scheme,
            &|| Slots::<V::Sample, 15, 10>::START,
            spikes_of,
            |signal, slots| transcribed(signal, &means, sigma, 10, slots),
            |slots, before, values| {
                transcribed_decoder(slots, scheme.centres(), 10, before, values);
            },
        )
    }
}

#[cfg(feature = "run")]
impl Build for Scheme {
    const CONSTANT: Option<[&str; 3]> = Some([
        "population::Slots",
        "{neurons}, {slots}",
        "new({range}, {beta}).with_floor({floor})",
    ]);

    costs!(Slots<S, 15, 10>, "grf-slots-15x10", |settings| settings.neurons()? as f64 / 15.0);

    population!(|settings| {
        let (neurons, beta) = (settings.neurons()?, settings.number("beta")? as f32);
        let slots = settings.count("slots", 2..=dynamic::LEVELS)?;
        let scheme = dynamic::Slots::<S, M>::try_new(neurons, slots, &settings.range()?, beta)?;
        let scheme = scheme.try_with_floor(settings.count("floor", 1..=slots)? as u16)?;
        (scheme.state(), scheme)
    });
}

/// Converts a code from the transcription's form: the slot or rank of each neuron, or -1.
pub(super) fn spikes_of<const N: usize>(slots: &[i8]) -> SlotSpikes<15, N> {
    let mut fired = [0; 15];
    let mut length = 0;
    for (fired, &slot) in fired.iter_mut().zip(slots.iter().filter(|&&slot| slot >= 0)) {
        *fired = slot as u8;
        length += 1;
    }
    let first = slots.iter().take_while(|&&slot| slot < 0).count();
    let first = if length == 0 { 0 } else { first };
    let fired = fired.get(..length).unwrap_or_default();
    SlotSpikes::new(first as u16, fired).unwrap_or(SlotSpikes::EMPTY)
}

/// Encodes by the paper's algorithm 2, with its exponentials, in `f32` for every sample type. Writes the slot of each
/// neuron, or -1, one sample after the other.
#[inline(never)]
pub fn transcribed<S: Plain>(
    input: &[S],
    centres: &[f32],
    sigma: f32,
    levels: usize,
    slots: &mut [i8],
) {
    for i in 0..input.len() {
        let x = input[i].to_f64() as f32;
        for j in 0..centres.len() {
            let level = (levels as f32 * response(x, centres[j], sigma) + 0.5) as usize;
            slots[i * centres.len() + j] = if level > 0 { (levels - level) as i8 } else { -1 };
        }
    }
}

/// Decodes to the mean of the centres, weighted by their levels, or to the previous value if none fired.
#[inline(never)]
pub fn transcribed_decoder<S: Plain>(
    slots: &[i8],
    centres: &[S],
    levels: usize,
    mut value: S,
    values: &mut [S],
) {
    for i in 0..values.len() {
        let (mut sum, mut total) = (S::Wide::default(), 0);
        for j in 0..centres.len() {
            let slot = slots[i * centres.len() + j];
            if slot >= 0 {
                let level = levels - slot as usize;
                sum += centres[j].into() * S::count(level as i16);
                total += level;
            }
        }
        if total > 0 {
            value = S::narrow(sum / S::count(total as i16));
        }
        values[i] = value;
    }
}
