//! Burst coding.

use spikewire::timing::{Burst, BurstSpikes};

use crate::prelude::*;

/// Burst coding.
#[derive(Clone, Copy, Debug)]
pub struct Scheme;

// As the checks fly it.
const SPIKES: u8 = 5;
const SHORTEST: u8 = 2;
const LONGEST: u8 = 10;

/// Number of slots: enough for five spikes at intervals from 2 to 10.
const SLOTS: usize = 19;

impl Entry for Scheme {
    const INFO: Info = Info {
        name: "burst",
        type_name: "Burst",
        title: "Burst",
        words: "burst coding",
        good_for: "a value by the count and the interval of its spikes",
        colour: [0x74, 0x7a, 0x3c],
        parameters: &[
            Parameter::count("slots", "sub-timesteps a sample, 2 to 256")
                .with_default("19")
                .searched(Search::Whole(2, 64)),
            Parameter::count("spikes", "most spikes a sample, 1 to 255")
                .with_default("5")
                .searched(Search::Whole(1, 16)),
            Parameter::count("shortest", "shortest interval in slots, from 1 on")
                .with_default("2")
                .searched(Search::Whole(1, 8)),
            Parameter::count("longest", "longest interval in slots, up to 255")
                .with_default("10")
                .searched(Search::Whole(1, 16)),
            Parameter::MIN,
            Parameter::MAX,
        ],
        ..Info::BLANK
    };

    const IN_C: &'static [InC] = &[InC {
        name: "burst",
        scheme: "timing::Burst<S, {0}>",
        shapes: &[&[SLOTS]],
        made: &[Made {
            name: "init",
            words: "`min`, `max`: the range, which must rise. `spikes`: most of a sample, above 0; `shortest`, `longest`: their intervals in slots.",
            arguments: &[
                Argument::MIN,
                Argument::MAX,
                Argument::number("spikes", "u8", SPIKES as f64),
                Argument::number("shortest", "u8", SHORTEST as f64),
                Argument::number("longest", "u8", LONGEST as f64),
            ],
            value: "timing::Burst::try_new(min..=max, spikes, shortest..=longest)",
            flies: Some("burst"),
        }],
    }];

    fn fly<V: Flight>(channel: &Channel<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        let scheme =
            Burst::<_, SLOTS>::try_new(channel.min..=channel.max, SPIKES, SHORTEST..=LONGEST)?;
        visitor.visit("burst", Self::INFO.words, &scheme, Burst::<V::Sample, SLOTS>::START)
    }

    fn count<V: Count>(signal: &Scaled<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        let (min, max) = (signal.min, signal.max);
        let scheme = Burst::<_, SLOTS>::try_new(min..=max, 5, 2..=10)?;
        let mut bursts = [(0, V::Sample::default()); SLOTS + 1];
        for (entry, (burst, value)) in bursts.iter_mut().zip(scheme.bursts()) {
            *entry = (byte_of(burst), value);
        }
        visitor.coded(
            "burst-5",
            &scheme,
            byte_of,
            burst_of,
            |signal, bursts| transcribed(signal, min, max, bursts),
            |codes, values| transcribed_decoder(codes, &bursts, values),
        )
    }
}

#[cfg(feature = "run")]
impl Build for Scheme {
    const CONSTANT: Option<[&str; 3]> =
        Some(["timing::Burst", "{slots}", "new({range}, {spikes}, {shortest}..={longest})"]);

    costs!(Burst<S, 19>, "burst-5");

    fn build<S: Sample, V: Visit<S>>(settings: &Settings, visitor: V) -> Result<V::Output> {
        let slots = settings.count("slots", 2..=dynamic::LEVELS)?;
        let byte = |name| settings.count(name, 1..=255).map(|count| count as u8);
        let intervals = byte("shortest")?..=byte("longest")?;
        let scheme =
            dynamic::Burst::<S>::try_of(slots, &settings.range()?, byte("spikes")?, &intervals)?;
        visitor.visit(scheme, dynamic::Burst::<S>::START)
    }
}

/// Converts a burst to the transcription's form: 16 times the count, plus the interval.
fn byte_of<const N: usize>(burst: BurstSpikes<N>) -> i8 {
    (burst.count() * 16 + burst.interval()) as i8
}

/// Converts a burst from the transcription's form.
fn burst_of<const N: usize>(byte: i8) -> BurstSpikes<N> {
    BurstSpikes::new(byte as u8 / 16, byte as u8 % 16).unwrap_or_default()
}

/// Encodes up to five spikes, at an interval from 10 down to 2.
#[inline(never)]
pub fn transcribed<S: Plain>(input: &[S], min: S, max: S, bursts: &mut [i8]) {
    let range: S::Wide = max.into() - min.into();
    for i in 0..input.len() {
        let above = input[i].into() - min.into();
        let mut count = 0;
        while count < 5 && above * S::count(5) > range * S::count(count) {
            count += 1;
        }
        let steps = above * S::count(8) / range;
        let interval = if count > 1 { 10 - S::narrow(steps).to_f64() as i16 } else { 0 };
        bursts[i] = (count * 16 + interval) as i8;
    }
}

/// Decodes bursts with a list of the value of each.
#[inline(never)]
pub fn transcribed_decoder<S: Plain>(codes: &[i8], bursts: &[(i8, S)], values: &mut [S]) {
    for i in 0..codes.len() {
        let mut j = 0;
        while bursts[j].0 != codes[i] {
            j += 1;
        }
        values[i] = bursts[j].1;
    }
}
