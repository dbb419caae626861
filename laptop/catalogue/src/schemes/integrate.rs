//! Integrate and fire (IF).

use spikewire::rate::IntegrateAndFire;
use spikewire::temporal::Steps;

use crate::prelude::*;

/// Integrate and fire.
#[derive(Clone, Copy, Debug)]
pub struct Scheme;

// As the checks fly it; a threshold is a part of a channel's range.
const THRESHOLD: f64 = 0.2;
const POWER: u8 = 3;
const SPIKES: usize = 8;

/// The parameters of the neuron with and without a leak.
pub(super) const PARAMETERS: &[Parameter] = &[
    Parameter::new(
        "threshold",
        Kind::Number,
        Unit::Signal,
        "what the samples add up to at a spike, above 0",
    )
    .with_paper(Paper::Signal(1.0))
    .with_example("0.5")
    .searched(Search::Log(0.02, 8.0)),
    Parameter::new("reference", Kind::Number, Unit::Signal, "the value without spikes")
        .with_default("0")
        .searched(Search::Around(0.0, 1.0)),
    Parameter::count(
        "power",
        "the decoder's mean is over about 2^POWER samples, and so long a leak lasts: 1 to 15",
    )
    .with_default("4")
    .searched(Search::Whole(1, 8)),
    Parameter::SPIKES,
];

impl Entry for Scheme {
    const INFO: Info = Info {
        name: "if",
        type_name: "IntegrateAndFire",
        title: "IF",
        words: "integrate and fire (IF)",
        good_for: "a mean, and an integral that never drifts: a gyroscope's angle",
        is_signed: true,
        colour: [0x2f, 0x9e, 0x8f],
        parameters: PARAMETERS,
        ..Info::BLANK
    };

    const IN_C: &'static [InC] = &[InC {
        name: "integrate_and_fire",
        scheme: "rate::IntegrateAndFire<S, {0}>",
        shapes: &[&[SPIKES]],
        made: &[Made {
            name: "init",
            words: "`threshold`: what samples add up to at a spike, above 0; `power`: the decoder's mean is over 2^power samples, 1 to 15; `reference`: the value without spikes.",
            arguments: &[
                Argument::sample("threshold", Flown::Fraction(THRESHOLD)),
                Argument::number("power", "u8", POWER as f64),
                Argument::sample("reference", Flown::Number(0.0)),
            ],
            value: "rate::IntegrateAndFire::try_new(threshold, power)?.try_with_reference(reference)",
            flies: Some("if"),
        }],
    }];

    fn fly<V: Flight>(channel: &Channel<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        let scheme = IntegrateAndFire::<_, SPIKES>::try_new(channel.fraction(THRESHOLD), POWER)?;
        let start = IntegrateAndFire::<V::Sample, SPIKES>::START;
        visitor.visit("if", Self::INFO.words, &scheme, start)
    }

    fn count<V: Count>(signal: &Scaled<V::Sample>, visitor: &mut V) -> Result<(), V::Error> {
        let threshold = signal.part(1.0);
        let scheme = IntegrateAndFire::<_, 4>::try_new(threshold, 4)?;
        visitor.coded(
            "if",
            &scheme,
            Steps::count,
            Steps::new,
            |signal, counts| transcribed(signal, threshold, None, 4, counts),
            |counts, values| transcribed_decoder(counts, threshold, 4, values),
        )
    }
}

/// One neuron, whose spikes come one after the other.
#[cfg(feature = "run")]
pub(super) fn shape(settings: &Settings) -> Result<Shape> {
    Ok(Shape { neurons: 1, slots: settings.count("spikes", 1..=127)? })
}

/// The neuron, with room for the most spikes.
#[cfg(feature = "run")]
pub(super) fn built<S: Sample>(settings: &Settings) -> Result<IntegrateAndFire<S, 127>> {
    let power = settings.count("power", 1..=15)? as u8;
    let scheme = IntegrateAndFire::try_new(settings.signal("threshold")?, power)?;
    let scheme = scheme.try_with_reference(settings.signal("reference")?)?;
    Ok(scheme.try_with_most(shape(settings)?.slots as u8)?)
}

#[cfg(feature = "run")]
impl Build for Scheme {
    const CONSTANT: Option<[&str; 3]> = Some([
        "rate::IntegrateAndFire",
        "{spikes}",
        "new({threshold}, {power}).with_reference({reference})",
    ]);

    costs!(IntegrateAndFire<S, 127>, "if");

    fn shape(settings: &Settings) -> Result<Shape> {
        shape(settings)
    }

    fn build<S: Sample, V: Visit<S>>(settings: &Settings, visitor: V) -> Result<V::Output> {
        visitor.visit(built(settings)?, IntegrateAndFire::<S, 127>::START)
    }
}

/// The definition, with 0 as the reference.
#[inline(never)]
pub fn transcribed<S: Plain>(
    input: &[S],
    threshold: S,
    leak: Option<u8>,
    most: i8,
    counts: &mut [i8],
) {
    let (zero, threshold) = (S::Wide::default(), threshold.into());
    let mut potential = zero;
    for i in 0..input.len() {
        if let Some(power) = leak {
            potential = leaked::<S>(potential, power);
        }
        potential += input[i].into();
        counts[i] = 0;
        while potential >= threshold && counts[i] < most {
            potential -= threshold;
            counts[i] += 1;
        }
        while potential <= zero - threshold && counts[i] <= 0 && counts[i] > -most {
            potential += threshold;
            counts[i] -= 1;
        }
    }
}

/// Less its `2^power`th part, whatever its sign.
fn leaked<S: Plain>(potential: S::Wide, power: u8) -> S::Wide {
    let zero = S::Wide::default();
    if potential < zero {
        potential + S::halved(zero - potential, power)
    } else {
        potential - S::halved(potential, power)
    }
}

/// The leaky mean, with 0 as the reference.
#[inline(never)]
pub fn transcribed_decoder<S: Plain>(counts: &[i8], threshold: S, power: u8, values: &mut [S]) {
    let mut potential = S::Wide::default();
    for i in 0..counts.len() {
        potential = leaked::<S>(potential, power);
        potential += S::count(counts[i].into()) * threshold.into();
        values[i] = S::narrow(S::halved_to_nearest(potential, power));
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use fixed::types::{I8F8, I16F16};
    use proptest::prelude::*;
    use spikewire::rate::IntegrateAndFire;
    use spikewire::temporal::Steps;
    use spikewire::{ConfigError, Sample, Scheme};

    use super::{Plain, transcribed, transcribed_decoder};

    pub(crate) use spikewire::rate::IntegrateAndFire as Neuron;

    /// Twelve samples of 3, four of -7.
    pub(crate) const SIGNAL: [i16; 16] = [3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, -7, -7, -7, -7];

    pub(crate) fn counts_of<S: Sample, const K: usize>(
        scheme: &IntegrateAndFire<S, K>,
        x: &[S],
    ) -> Vec<i8> {
        let mut encoder = scheme.encoder();
        x.iter().map(|&x| encoder.encode(x).count()).collect()
    }

    /// Recordings within 4000 counts.
    pub(crate) fn drawn() -> impl Strategy<Value = Vec<i16>> {
        proptest::collection::vec(-4000_i16..=4000, 1..200)
    }

    /// Encoder and decoder against the transcriptions, in every sample type: counts as they are, and 256 of them a 1.
    pub(crate) fn agrees(x: &[i16], threshold: i16, power: u8, is_leaky: bool) {
        agrees_in(x, threshold, power, is_leaky);
        let of = |x: i16| f32::from(x) / 256.0;
        agrees_in(&x.iter().map(|&x| of(x)).collect::<Vec<_>>(), of(threshold), power, is_leaky);
        let of = I8F8::from_bits;
        agrees_in(&x.iter().map(|&x| of(x)).collect::<Vec<_>>(), of(threshold), power, is_leaky);
        let of = |x: i16| I16F16::from_bits(i32::from(x) << 8);
        agrees_in(&x.iter().map(|&x| of(x)).collect::<Vec<_>>(), of(threshold), power, is_leaky);
    }

    fn agrees_in<S: Plain>(x: &[S], threshold: S, power: u8, is_leaky: bool) {
        let scheme = IntegrateAndFire::<S, 4>::new(threshold, power);
        let scheme = if is_leaky { scheme.leaky() } else { scheme };
        let mut counts = vec![0; x.len()];
        transcribed(x, threshold, is_leaky.then_some(power), 4, &mut counts);
        assert_eq!(counts_of(&scheme, x), counts);
        let mut values = vec![S::default(); x.len()];
        transcribed_decoder(&counts, threshold, power, &mut values);
        let mut decoder = scheme.decoder();
        let ours: Vec<S> = counts.iter().map(|&count| decoder.decode(Steps::new(count))).collect();
        assert_eq!(ours, values);
    }

    /// How far each decoded value is from the same leaky mean of the samples.
    pub(crate) fn mean_error<const K: usize>(
        scheme: IntegrateAndFire<i16, K>,
        x: &[i16],
        reference: i16,
        power: u8,
    ) -> Vec<f64> {
        let mut decoder = scheme.decoder();
        let mut mean = 0_i32;
        let errors = counts_of(&scheme, x).into_iter().zip(x).map(|(count, &x)| {
            let value = decoder.decode(Steps::new(count));
            mean -= mean.signum() * (mean.abs() >> power);
            mean += i32::from(x) - i32::from(reference);
            (f64::from(value) - f64::from(reference) - f64::from(mean) / f64::from(1 << power))
                .abs()
        });
        errors.collect()
    }

    const TEN: Neuron<i16, 1> = Neuron::new(10, 3);

    #[test]
    fn check_values() {
        let counts = [0, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 0, 0, -1, -1];
        assert_eq!(counts_of(&TEN, &SIGNAL), counts);
    }

    /// The threshold itself fires, on both sides.
    #[test]
    fn ties_fire() {
        assert_eq!(counts_of(&TEN, &[9, 1, -9, -1]), [0, 1, 0, -1]);
        assert_eq!(counts_of(&Neuron::<f32, 2>::new(0.5, 1), &[1.0, -1.0, -1.0]), [2, -2, -2]);
    }

    #[test]
    fn what_is_not_finite_is_counted_and_ignored() {
        let scheme = Neuron::<f32, 1>::new(1.0, 3);
        let mut encoder = scheme.encoder();
        let x = [0.75, f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.25];
        assert_eq!(x.map(|x| encoder.encode(x).count()), [0, 0, 0, 0, 1]);
        assert_eq!(encoder.rejected(), 3);
        // What would bring the potential beyond all numbers is not taken either.
        assert_eq!([f32::MAX, f32::MAX, -1.0].map(|x| encoder.encode(x).count()), [1, 0, 1]);
        assert_eq!(encoder.rejected(), 4);
    }

    /// Without an end in sight the potential stays at its end, and comes back.
    #[test]
    fn integers_do_not_wrap() {
        let scheme = Neuron::<I16F16, 1>::new(I16F16::ONE, 3).with_reference(I16F16::MIN);
        let mut encoder = scheme.encoder();
        for _ in 0..1000 {
            assert_eq!(encoder.encode(I16F16::MAX).count(), 1);
        }
        let scheme = Neuron::<i16, 1>::new(1, 3).with_reference(i16::MIN);
        let mut encoder = scheme.encoder();
        for _ in 0..100_000 {
            assert_eq!(encoder.encode(i16::MAX).count(), 1);
        }
    }

    #[test]
    fn what_makes_no_sense_is_refused_by_name() {
        let parameter = |scheme: Result<Neuron<f32, 4>, ConfigError>| match scheme.unwrap_err() {
            ConfigError::NotPositive { parameter, .. }
            | ConfigError::NotFinite { parameter, .. }
            | ConfigError::OutOfRange { parameter, .. } => parameter,
            error => panic!("{error}"),
        };
        assert_eq!(parameter(Neuron::try_new(0.0, 3)), "threshold");
        assert_eq!(parameter(Neuron::try_new(1e32, 3)), "threshold");
        assert_eq!(parameter(Neuron::try_new(1.0, 0)), "power of the mean");
        assert_eq!(parameter(Neuron::try_new(1.0, 16)), "power of the mean");
        assert_eq!(parameter(Neuron::new(1.0, 3).try_with_reference(f32::NAN)), "reference");
        assert_eq!(parameter(Neuron::new(1.0, 3).try_with_most(5)), "most spikes a sample");
    }

    proptest! {
        #[test]
        fn as_transcribed(x in drawn(), threshold in 1_i16..2000, power in 1_u8..8) {
            agrees(&x, threshold, power, false);
        }

        /// The spikes tell the integral of the samples, to less than one.
        #[test]
        fn the_integral_never_drifts(x in drawn(), threshold in 512_i16..4000, reference in -90_i16..90) {
            let scheme = Neuron::<i16, 8>::new(threshold, 3).with_reference(reference);
            let (mut sum, mut told) = (0, 0);
            for (count, x) in counts_of(&scheme, &x).into_iter().zip(x) {
                sum += i32::from(x) - i32::from(reference);
                told += i32::from(count) * i32::from(threshold);
                prop_assert!((sum - told).abs() < i32::from(threshold));
            }
        }

        #[test]
        fn the_value_is_near_the_leaky_mean(x in drawn(), threshold in 500_i16..4000, power in 1_u8..10) {
            let scheme = Neuron::<i16, 8>::new(threshold, power);
            let bound = 2.0 * f64::from(threshold) / f64::from(1_u32 << power) + 3.0;
            for error in mean_error(scheme, &x, 0, power) {
                prop_assert!(error < bound, "{} of {}", error, bound);
            }
        }
    }
}
