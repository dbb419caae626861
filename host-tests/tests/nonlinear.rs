//! Non-linear receptive fields: the strongest response, and its spikes in slots.

use crate::common::{
    Drawn, between, cases, drawn_recordings, flight_channels, hostile_recordings, in_every_type,
};
use fixed::types::{I1F15, I8F8, I16F16, I32F0};
use host_tests::compare::{
    Wire, assert_same_values, check_position, decode, encode, finite, whole,
};
use host_tests::reference::{
    companded_centres, field_edges, fields_are_regions, float_levels, integer_levels,
    integer_weighted_mean, level_radii, slots_decode, slots_of_levels, spacing_widths, strongest,
};
use proptest::collection::vec;
use proptest::prelude::*;
use spikewire::population::{Gaussian, Neuron, NeuronSlots, NonLinearSlots, Position};
use spikewire::{Code, ConfigError, Histogram, Sample, Scheme};

/// A level's distance itself still has the level.
#[test]
fn the_last_sample_of_a_level() {
    let scheme = NonLinearSlots::<f32, 3, 10>::new([-9.0, 0.0, 9.0], [1.0; 3]);
    for (level, radius) in (1..=10_u16).zip(level_radii(10)) {
        let nearest = radius as f32;
        let last = if f64::from(nearest) > radius { nearest.next_down() } else { nearest };
        let slots = [last, last.next_up()].map(|x| {
            let spikes = scheme.encoder().encode(x);
            spikes.iter().find(|&(neuron, _)| neuron == 1).map(|(_, slot)| slot)
        });
        assert_eq!(slots, [Some(10 - level), (level > 1).then(|| 11 - level)], "{level}");
    }
}

/// Fields wider than all of a type: every neuron fires at every sample.
#[test]
fn fields_wider_than_the_type() {
    let centres = [-30_000, 0, 30_000].map(I16F16::from_num);
    for width in [65_536.0, 1e6, 1e30] {
        let scheme = NonLinearSlots::<I16F16, 3, 10>::new(centres, [width; 3]);
        for x in [I16F16::MIN, I16F16::ZERO, I16F16::MAX] {
            assert_eq!(scheme.encoder().encode(x).len(), 3, "{x} in {width}");
        }
    }
}

/// A sample type and what its receptive fields are in the reference.
trait Fields: Wire {
    /// The level of each neuron.
    fn levels(self, centres: &[Self], sigmas: &[f64], n: u16) -> Vec<u16>;
    /// What levels decode to.
    fn mean(levels: &[u16], centres: &[Self], n: u16) -> Option<Self>;
    /// What may be rounded of a distance, for the law.
    const ROUNDED: f64;
}

impl Fields for f32 {
    fn levels(self, centres: &[f32], sigmas: &[f64], n: u16) -> Vec<u16> {
        float_levels(self, centres, sigmas, n)
    }
    fn mean(levels: &[u16], centres: &[f32], n: u16) -> Option<f32> {
        let fired = levels.iter().any(|&level| level > 0);
        fired.then(|| slots_decode(&slots_of_levels(levels, n, 1), centres, n, 0.0))
    }
    const ROUNDED: f64 = 1e-6;
}

macro_rules! fields {
    ($($sample:ty),*) => {$(
        impl Fields for $sample {
            fn levels(self, centres: &[Self], sigmas: &[f64], n: u16) -> Vec<u16> {
                let unit = unit::<Self>();
                let sigmas: Vec<f64> = sigmas.iter().map(|sigma| sigma / unit).collect();
                let centres: Vec<i64> = centres.iter().copied().map(whole).collect();
                integer_levels(whole(self), &centres, &sigmas, n)
            }
            fn mean(levels: &[u16], centres: &[Self], _: u16) -> Option<Self> {
                let centres: Vec<i64> = centres.iter().copied().map(whole).collect();
                integer_weighted_mean(levels, &centres).map(|mean| Self::from_bits32(mean as u32))
            }
            const ROUNDED: f64 = 0.0;
        }
    )*};
}
fields!(i16, I8F8, I1F15, I16F16, I32F0);

/// The last place of an integer type; 0 in `f32`.
fn unit<S: Wire>() -> f64 {
    let [low, high] = S::ends().map(Into::into);
    let range: f64 = high - low;
    match size_of::<S>() {
        2 => range / 65_535.0,
        _ if range.is_finite() => range / 4_294_967_295.0,
        _ => 0.0,
    }
}

/// The width of a field as its scale, rounded to a whole number, has it.
fn rounded_width<S: Wire>(sigma: f64) -> f64 {
    let one = 2_f64.powi(32) * unit::<S>();
    if one == 0.0 { sigma } else { one / (one / sigma + 0.5).floor() }
}

fn doubles<S: Wire>(values: &[S]) -> Vec<f64> {
    values.iter().map(|value| value.to_f64()).collect()
}

/// The winner of fields with these widths, if they are not refused; and whether they were.
fn check_winner<S: Wire, const M: usize>(
    scheme: Result<Position<S, M>, ConfigError>,
    centres: &[S],
    widths: &[f64],
    x: &[S],
) -> bool {
    let centres = doubles(centres);
    let is_good = fields_are_regions(&centres, widths);
    let scheme = match scheme {
        Ok(scheme) => scheme,
        Err(ConfigError::FieldTooWide { .. }) => {
            assert!(!is_good);
            return false;
        }
        Err(ConfigError::EmptyCell { .. }) => return false,
        Err(error) => panic!("{error}"),
    };
    assert!(is_good);
    let edges = field_edges(&centres, widths);
    let values: Vec<_> = scheme.centres().iter().map(|&centre| centre.real()).collect();
    check_position(&scheme, x, &values, |x| {
        x.iter().map(|&x| strongest(x.into(), &edges)).collect()
    });
    true
}

fn check_spaced<S: Wire, const M: usize>(centres: [S; M], x: &[S]) -> bool {
    let widths = spacing_widths(&doubles(&centres));
    check_winner(Gaussian::try_spaced(centres), &centres, &widths, x)
}

/// Encoder, decoder and law of slots with these fields.
fn check_slots<S: Fields, const M: usize, const N: usize>(
    scheme: &NonLinearSlots<S, M, N>,
    sigmas: &[f64],
    floor: u16,
    x: &[S],
) {
    let scheme = scheme.try_with_floor(floor).unwrap();
    let run = encode(&scheme, x);
    let recording = finite(x);
    assert_eq!(run.rejected as usize, recording.rejected.len());
    let (n, centres, radii) = (N as u16, scheme.centres(), level_radii(N as u16));
    let mut value = centres[M / 2];
    let mut values = Vec::new();
    for (&x, &spikes) in x.iter().zip(&run.outputs) {
        let is_finite = x.to_f64().is_finite();
        let mut levels = if is_finite { x.levels(centres, sigmas, n) } else { vec![0; M] };
        let slots = slots_of_levels(&levels, n, floor);
        let mut ours = vec![None; M];
        for (neuron, slot) in spikes.iter() {
            ours[usize::from(neuron)] = Some(slot);
        }
        assert_eq!(ours, slots, "{x:?} of {centres:?} {sigmas:?}");
        assert_eq!(spikes.len(), slots.iter().flatten().count());
        assert_eq!(NeuronSlots::assemble(spikes.firings()), spikes);
        assert_eq!(NeuronSlots::new(spikes.iter()), Some(spikes));
        for level in &mut levels {
            *level = if *level < floor { 0 } else { *level };
        }
        value = S::mean(&levels, centres, n).unwrap_or(value);
        values.push(value.real());
        // The law.
        let total: f64 = levels.iter().copied().map(f64::from).sum();
        if total > 0.0 {
            let reaches = levels.iter().zip(sigmas).filter(|(level, _)| **level > 0);
            let sum: f64 = reaches
                .map(|(&level, &sigma)| {
                    f64::from(level) * radii[usize::from(level) - 1] * rounded_width::<S>(sigma)
                })
                .sum();
            let off = (x.to_f64() - value.to_f64()).abs();
            let most =
                centres.iter().map(|centre| centre.to_f64().abs()).fold(x.to_f64().abs(), f64::max);
            let bound = sum / total * (1.0 + 1e-6) + unit::<S>() / 2.0 + S::ROUNDED * most * total;
            assert!(off <= bound, "{x:?}: {value:?} is off by {off}, above {bound}");
        }
    }
    let mut decoder = scheme.decoder();
    assert_same_values(&decode(&decoder, &run.outputs), &values);
    decoder.resync(centres[0]);
    assert_eq!(decoder.decode(NeuronSlots::EMPTY), centres[0]);
    decoder.reset();
    assert_same_values(&decode(&decoder, &run.outputs), &values);
}

/// Winner and slots of fields as wide as their spacing.
fn check_both<S: Fields, const M: usize, const N: usize>(
    centres: [S; M],
    beta: f32,
    floor: u16,
    x: &[S],
) -> bool {
    let is_good = check_spaced(centres, x);
    let sigmas: Vec<f64> = spacing_widths(&doubles(&centres))
        .iter()
        .map(|width| width / (2.0 * f64::from(beta)))
        .collect();
    match NonLinearSlots::<S, M, N>::try_spaced(centres, beta) {
        Ok(scheme) => check_slots(&scheme, &sigmas, floor, x),
        Err(ConfigError::OutOfRange { parameter: "centre" | "width", .. }) => {
            assert_eq!(unit::<S>(), 0.0);
        }
        Err(error) => assert!(!fields_are_regions(&doubles(&centres), &sigmas), "{error}"),
    }
    is_good
}

#[test]
fn the_printed_check_values() {
    let scheme = Gaussian::try_spaced([0_i16, 10, 30, 70, 150]).unwrap();
    let table = [(-9, 0), (4, 0), (5, 1), (16, 1), (17, 2), (43, 2), (44, 3), (104, 3), (105, 4)];
    for (x, neuron) in table {
        assert_eq!(scheme.encoder().encode(x).map(Neuron::index), Some(neuron), "{x}");
    }
    let slots = NonLinearSlots::<i16, 5, 10>::try_spaced([0, 10, 30, 70, 150], 1.5).unwrap();
    assert!(slots.encoder().encode(100).iter().eq([(3, 2), (4, 4)]));
    let centres = [0_i16, 1, 2, 3, 1003];
    let refused = ConfigError::FieldTooWide { field: 3, lower: 0 };
    assert_eq!(Gaussian::try_spaced(centres), Err(refused));
    assert_eq!(NonLinearSlots::<_, 5, 10>::try_spaced(centres, 1.5), Err(refused));
    assert_eq!(
        refused.to_string(),
        "field 3 is so wide that it wins where fields 0 and 1 meet: use a narrower one there, or equal widths"
    );
    assert!(Gaussian::try_with_widths(centres, [7.0; 5]).is_ok());
}

/// Equal widths are position coding.
#[test]
fn equal_widths() {
    let centres = [-2.5_f32, -1.0, 0.0, 0.25, 4.0, 4.5];
    assert_eq!(Gaussian::try_with_widths(centres, [0.5; 6]), Position::try_new(centres));
}

/// In front of the first centre a wider field reaches farther than its narrower neighbour: the neurons that fire need
/// not be neighbours.
#[test]
fn gaps() {
    let slots = NonLinearSlots::<i16, 5, 10>::spaced([0, 10, 30, 70, 150], 1.5);
    let neurons: Vec<_> = slots.encoder().encode(-15).iter().map(|(neuron, _)| neuron).collect();
    assert_eq!(neurons, [0, 2, 3]);
}

#[test]
fn refusals() {
    let centres = [0.0_f32, 1.0, 2.0];
    let table = [
        (Gaussian::try_with_widths(centres, [1.0, 0.0, 1.0]), "width 0 must be above 0 and finite"),
        (
            Gaussian::try_with_widths(centres, [1.0, 1.0, f32::NAN]),
            "width NaN must be above 0 and finite",
        ),
        (
            Gaussian::try_with_widths([0.0, 2.0, 1.0], [1.0; 3]),
            "centres must rise strictly, but number 2 is 1 after 2",
        ),
        (Gaussian::try_companded(0.0..=1.0, 0.0), "companding 0 must be above 0 and finite"),
        (
            Gaussian::try_companded(0.0..=1.0, f32::INFINITY),
            "companding inf must be above 0 and finite",
        ),
        (
            Gaussian::try_companded(1.0..=1.0, 255.0),
            "min and max must rise strictly, but number 1 is 1 after 1",
        ),
    ];
    for (refused, message) in table {
        assert_eq!(refused.unwrap_err().to_string(), message);
    }
    let slots = NonLinearSlots::<f32, 3, 10>::try_spaced(centres, 0.0);
    assert_eq!(slots.unwrap_err().to_string(), "beta 0 must be above 0 and finite");
    let slots = NonLinearSlots::<f32, 3, 10>::try_new(centres, [1e-39; 3]).unwrap_err();
    assert!(matches!(slots, ConfigError::OutOfRange { parameter: "width", .. }), "{slots}");
    let slots = NonLinearSlots::<f32, 3, 10>::try_new(centres, [1.0; 3]).unwrap();
    for floor in [0, 11] {
        let error = slots.try_with_floor(floor).unwrap_err().to_string();
        assert_eq!(error, format!("floor {floor} must lie in 1..=10"));
    }
    // Too fine for the type.
    let error = Gaussian::<i16, 20>::try_companded(-20..=20, 255.0).unwrap_err();
    assert!(matches!(error, ConfigError::NotRising { parameter: "centres", .. }), "{error}");
}

/// What is built at compile time is what is built in flight.
#[test]
fn constants() {
    static COMPANDED: Gaussian<f32, 20> = Gaussian::companded(-9.0..=9.1, 255.0);
    static OWN: Gaussian<I8F8, 3> =
        Gaussian::with_widths([I8F8::NEG_ONE, I8F8::ZERO, I8F8::ONE], [0.5, 0.25, 0.75]);
    static SLOTS: NonLinearSlots<i16, 15, 10> = NonLinearSlots::companded(-3000..=4000, 20.0, 1.5);
    assert_eq!(COMPANDED, Gaussian::try_companded(-9.0..=9.1, 255.0).unwrap());
    assert_eq!(OWN.centres().len(), 3);
    assert_eq!(SLOTS, NonLinearSlots::try_companded(-3000..=4000, 20.0, 1.5).unwrap());
}

/// So little companding that `(1 + A)^t` is 1 in every digit.
#[test]
fn hardly_companded_centres_are_even() {
    for companding in [f32::MIN_POSITIVE, 1e-30, 1e-20, 1e-9] {
        let scheme = Gaussian::<f32, 5>::try_companded(-1.0..=1.0, companding).unwrap();
        assert_eq!(*scheme.centres(), [-1.0, -0.5, 0.0, 0.5, 1.0], "{companding:e}");
    }
}

/// Every size to 64, and several strengths.
#[test]
fn companded_fields_are_regions() {
    fn check<const M: usize>() {
        for companding in [0.01, 1.0, 20.0, 255.0, 1e4] {
            let scheme = Gaussian::<f32, M>::try_companded(-4.0..=9.0, companding).unwrap();
            let expected = companded_centres(-4.0, 9.0, M, companding.into());
            for (&ours, exact) in scheme.centres().iter().zip(expected) {
                assert_eq!(ours, f32::nearest(exact));
            }
            let scheme = Gaussian::<I32F0, M>::try_companded(
                I32F0::from_bits(-2_000_000_000)..=I32F0::from_bits(2_000_000_000),
                companding,
            );
            let scheme = scheme.unwrap();
            let expected = companded_centres(-2e9, 2e9, M, companding.into());
            for (&ours, exact) in scheme.centres().iter().zip(expected) {
                assert_eq!(ours, I32F0::nearest(exact));
            }
        }
    }
    macro_rules! sizes {
        ($($m:literal)*) => { $(check::<$m>();)* };
    }
    sizes!(3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23 24 25 26 27 28 29 30 31 32 33 34 35
        36 37 38 39 40 41 42 43 44 45 46 47 48 49 50 51 52 53 54 55 56 57 58 59 60 61 62 63 64);
}

/// Companded centres in every type are exact centres, rounded once.
fn companded_as_drawn<S: Wire + Drawn + PartialOrd>() {
    let companding = prop_oneof![
        between(0.01, 999.0),
        (0..=30_u8).prop_map(f32::from).prop_filter("above 0", |&companding| companding > 0.0),
        (1e-30_f32..1e-3),
        f32::positive(),
    ];
    proptest!(cases(32), |(a in S::value(), b in S::value(), companding in companding)| {
        let [min, max] = if a < b { [a, b] } else { [b, a] };
        if let Ok(scheme) = Gaussian::<S, 7>::try_companded(min..=max, companding) {
            let exact = companded_centres(min.to_f64(), max.to_f64(), 7, companding.into());
            for (centre, exact) in scheme.centres().iter().zip(exact) {
                // Halfway between two samples the reference's own rounding may decide.
                let about = [exact * (1.0 - 1e-15), exact, exact * (1.0 + 1e-15)].map(S::nearest);
                assert!(about.contains(centre), "{centre:?}, not {exact}");
            }
        }
    });
}

#[test]
fn companded_centres_are_exact() {
    in_every_type!(companded_as_drawn);
}

/// From a flight to its quantiles to a code.
#[test]
fn quantiles_of_flights() {
    for channel in flight_channels() {
        let mut histogram = Histogram::<f32, 64>::new(-4.0..=4.0, 20_000);
        for &x in &channel {
            histogram.observe(x);
        }
        let centres = histogram.centres::<15>().unwrap();
        check_both::<_, 15, 10>(centres, 1.5, 1, &channel);
        let scheme = Gaussian::try_with_widths(centres, [1.0; 15]);
        assert!(check_winner(scheme, &centres, &[1.0; 15], &channel));
    }
}

#[test]
fn flights() {
    for channel in flight_channels() {
        let centres = *Gaussian::<f32, 20>::companded(-4.0..=4.0, 255.0).centres();
        assert!(check_both::<_, 20, 10>(centres, 1.5, 1, &channel));
        let fixed: Vec<_> = channel.iter().map(|&x| I16F16::from_num(x)).collect();
        assert!(check_both::<_, 20, 100>(centres.map(I16F16::from_num), 1.5, 7, &fixed));
    }
}

#[test]
fn hostile() {
    for x in hostile_recordings() {
        check_both::<f32, 5, 10>([-1.0, -0.5, 0.0, 1.0, 2.5], 1.5, 1, &x);
        check_both::<f32, 5, 256>([f32::MIN, -1.0, 0.0, 1.0, f32::MAX], 1.5, 256, &x);
        check_both::<f32, 5, 10>([-1e38, -1e37, 0.0, 1e37, 1e38], 0.3, 2, &x);
        check_both::<f32, 3, 2>([-1e-40, 0.0, 1e-40], 1.5, 1, &x);
    }
}

drawn_recordings!(S: Fields, 96, (mut list in vec(S::value(), 7), beta in prop_oneof![Just(1.5_f32), between(0.3, 4.0)],
    widths in vec(between(0.2, 4.0), 7), mut x in S::recordings(), floor in 1..10_u16) => {
    list.sort_by(|a, b| a.partial_cmp(b).unwrap());
    prop_assume!(list.windows(2).all(|pair| pair[0] < pair[1]));
    let centres: [S; 7] = list.try_into().unwrap();
    x.extend(centres);
    check_both::<S, 7, 10>(centres, beta, floor, &x);
    check_both::<S, 7, 256>(centres, beta, 1, &x);
    let widths: [f32; 7] = widths.try_into().unwrap();
    let sigmas = widths.map(f64::from);
    check_winner(Gaussian::try_with_widths(centres, widths), &centres, &sigmas, &x);
    if let Ok(scheme) = NonLinearSlots::<S, 7, 10>::try_new(centres, widths) {
        check_slots(&scheme, &sigmas, floor, &x);
    }
});

/// The winner of every value is the least `|x - mu| / sigma`, by whole numbers; the lower of two alike.
#[test]
fn all_65536_inputs_have_the_strongest_response() {
    let centres = [-30_000_i16, -7000, -900, -100, 0, 100, 1500, 8000, 20_000];
    let widths = [9000_i16, 6000, 1000, 150, 100, 200, 1500, 6000, 9000];
    let scheme = Gaussian::try_with_widths(centres, widths.map(f32::from)).unwrap();
    let error = |x: i16, i: usize| {
        let distance = (i64::from(x) - i64::from(centres[i])).abs();
        move |width: i64| distance * width
    };
    for x in centres[0]..=centres[8] {
        let winner = (1..9).fold(0, |winner, i| {
            let is_stronger =
                error(x, i)(widths[winner].into()) < error(x, winner)(widths[i].into());
            if is_stronger { i } else { winner }
        });
        let ours = scheme.encoder().encode(x).map(|neuron| usize::from(neuron.index()));
        assert_eq!(ours, Some(winner), "{x}");
    }
}

#[test]
fn all_65536_inputs() {
    let counts: Vec<_> = (i16::MIN..=i16::MAX).collect();
    let companded = *Gaussian::<i16, 20>::companded(-20_000..=25_001, 255.0).centres();
    assert!(check_both::<_, 20, 10>(companded, 1.5, 1, &counts));
    assert!(!check_both::<_, 5, 256>([i16::MIN, -30_000, 0, 9, i16::MAX], 4.0, 3, &counts));
    assert!(check_both::<_, 5, 256>([-30_000, -9000, 0, 9000, i16::MAX], 4.0, 3, &counts));
    let bits: Vec<_> = counts.iter().copied().map(I8F8::from_bits).collect();
    let companded =
        *Gaussian::<I8F8, 20>::companded(I8F8::from_num(-9)..=I8F8::from_num(9.1), 5.0).centres();
    assert!(check_both::<_, 20, 100>(companded, 1.5, 3, &bits));
    let bits: Vec<_> = counts.iter().copied().map(I1F15::from_bits).collect();
    let companded =
        *Gaussian::<I1F15, 4>::companded(I1F15::from_num(-0.5)..=I1F15::from_num(0.7), 5.0)
            .centres();
    assert!(check_both::<_, 4, 10>(companded, 2.5, 1, &bits));
}
