//! What the tests of all schemes draw from: recordings, kind and hostile.
#![allow(dead_code, unused_imports, unused_macros, reason = "each test takes what it needs")]

pub(crate) mod fields;
pub(crate) mod rate;
pub(crate) mod timing;

use fixed::types::{I1F15, I8F8, I16F16, I32F0};
use host_tests::flight;
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::test_runner::FileFailurePersistence;
use spikewire::{ConfigError, Sample};

/// Runs a check in every integer type.
macro_rules! in_every_integer {
    ($check:ident) => {
        $check::<i16>();
        $check::<fixed::types::I8F8>();
        $check::<fixed::types::I1F15>();
        $check::<fixed::types::I16F16>();
        $check::<fixed::types::I32F0>();
    };
}
pub(crate) use in_every_integer;

/// Runs a check in every sample type.
macro_rules! in_every_type {
    ($check:ident) => {
        $check::<f32>();
        crate::common::in_every_integer!($check);
    };
}
pub(crate) use in_every_type;

/// The test of a check with parameters drawn in every sample type, which is `S`.
macro_rules! drawn_recordings {
    ($S:ident: $Bound:path, $cases:literal, ($($value:pat in $values:expr),*) => $check:expr) => {
        #[test]
        fn drawn_recordings() {
            fn drawn<$S: $Bound + crate::common::Drawn>() {
                let cases = &crate::common::cases($cases);
                proptest!(cases, |($($value in $values),*)| $check);
            }
            crate::common::in_every_type!(drawn);
        }
    };
}
pub(crate) use drawn_recordings;

/// The test of a check with each channel of the flights in four sample types: `S`, of which 1 rad/s or 1 m/s² is `unit`.
macro_rules! flights {
    ($S:ident: $Bound:path, |$samples:ident, $unit:ident| $check:expr) => {
        #[test]
        fn flights() {
            fn flown<$S: $Bound>($unit: f64) {
                for $samples in crate::common::flown_channels::<$S>($unit) {
                    $check
                }
            }
            flown::<f32>(1.0);
            flown::<fixed::types::I16F16>(1.0);
            flown::<fixed::types::I8F8>(1.0);
            flown::<i16>(100.0);
        }
    };
}
pub(crate) use flights;

/// The name of the parameter that a constructor refused.
pub(crate) fn refused<T>(result: Result<T, ConfigError>) -> &'static str {
    match result.err().expect("it must be refused") {
        ConfigError::NotPositive { parameter, .. }
        | ConfigError::NotFinite { parameter, .. }
        | ConfigError::NotRising { parameter, .. }
        | ConfigError::OutOfRange { parameter, .. } => parameter,
        error => panic!("{error}"),
    }
}

/// How a property is tried: with this many cases, times `CASES_TIMES`. They are drawn from the seed that
/// `.cargo/config.toml` fixes, after those that failed before, whose seeds are in `<test>.proptest-regressions`.
/// `cargo verify sweeps` draws more, from a fresh seed.
pub(crate) fn cases(count: u32) -> ProptestConfig {
    let times = std::env::var("CASES_TIMES").map_or(1, |times| times.parse().unwrap());
    let failed = FileFailurePersistence::WithSource("proptest-regressions");
    ProptestConfig {
        cases: count.saturating_mul(times),
        max_global_rejects: 1024_u32.saturating_mul(times),
        failure_persistence: Some(Box::new(failed)),
        ..ProptestConfig::default()
    }
}

/// The floats that break things.
pub(crate) const HOSTILE: [f32; 16] = [
    0.0,
    -0.0,
    f32::MIN_POSITIVE,
    -f32::MIN_POSITIVE,
    1e-45,
    -1e-45,
    1e38,
    -1e38,
    f32::MAX,
    f32::MIN,
    f32::EPSILON,
    16_777_217.0,
    f32::NAN,
    f32::INFINITY,
    f32::NEG_INFINITY,
    1.0,
];

/// From `low` to `high`. proptest's own ranges panic in some draws if `low` is no multiple of the spacing at `high`.
pub(crate) fn between(low: f32, high: f32) -> impl Strategy<Value = f32> + Clone {
    (0..=1_u32 << 24).prop_map(move |part| low + (high - low) * (part as f32 / 16_777_216.0))
}

/// Any `f32`, the hostile ones often.
pub(crate) fn float() -> BoxedStrategy<f32> {
    prop_oneof![
        proptest::sample::select(&HOSTILE[..]),
        any::<u32>().prop_map(f32::from_bits),
        -4.0_f32..4.0,
    ]
    .boxed()
}

/// Values that stay for a while.
fn steps<T: Clone + std::fmt::Debug + 'static>(value: BoxedStrategy<T>) -> BoxedStrategy<Vec<T>> {
    vec((value, 1..9_usize), 0..12)
        .prop_map(|parts| parts.into_iter().flat_map(|(value, n)| vec![value; n]).collect())
        .boxed()
}

/// A walk in small steps, so that exact ties are frequent.
fn walk() -> BoxedStrategy<Vec<i64>> {
    vec(-9..=9_i64, 0..90)
        .prop_map(|steps| {
            steps
                .into_iter()
                .scan(0, |value, step| {
                    *value += step;
                    Some(*value)
                })
                .collect()
        })
        .boxed()
}

/// Integers of a type with this largest value, its ends often.
pub(crate) fn integer(max: i64) -> BoxedStrategy<i64> {
    prop_oneof![
        -100..=100_i64,
        -max - 1..=max,
        proptest::sample::select(vec![-max - 1, -max, -1, 0, 1, max - 1, max]),
    ]
    .boxed()
}

/// Recordings in integers of a type with this largest value.
fn integers(max: i64) -> BoxedStrategy<Vec<i64>> {
    let at_an_end =
        (walk(), proptest::sample::select(vec![-max - 1, max])).prop_map(move |(walk, end)| {
            walk.into_iter().map(|value| (value + end).clamp(-max - 1, max)).collect()
        });
    prop_oneof![walk(), at_an_end, vec(integer(max), 0..60), steps(integer(max))].boxed()
}

/// A sample type that recordings can be drawn in.
pub(crate) trait Drawn: Sized + Clone + std::fmt::Debug + 'static {
    /// Recordings, hostile ones included.
    fn recordings() -> BoxedStrategy<Vec<Self>>;
    /// Any finite value.
    fn value() -> BoxedStrategy<Self>;
    /// Any finite value above 0.
    fn positive() -> BoxedStrategy<Self>;
    /// A shift of a rate code, 0 often.
    fn shift() -> BoxedStrategy<Self>;
    /// A tap of which 24 fit into the type's range.
    fn tap() -> BoxedStrategy<Self>;
}

/// Ranges of drawn ends, those that rise.
pub(crate) fn ranges<S: Drawn + Copy + PartialOrd>() -> BoxedStrategy<[S; 2]> {
    let rising = |(a, b)| if a < b { [a, b] } else { [b, a] };
    let ranges = (S::value(), S::value()).prop_map(rising);
    ranges.prop_filter("rising", |[min, max]| min < max).boxed()
}

impl Drawn for f32 {
    fn recordings() -> BoxedStrategy<Vec<f32>> {
        let others = vec(proptest::option::weighted(0.1, float()), 90);
        prop_oneof![
            walk().prop_map(|walk| walk.into_iter().map(|value| value as f32 / 8.0).collect()),
            vec(-4.0_f32..4.0, 0..90),
            vec(float(), 0..60),
            steps(float()),
            (walk(), others).prop_map(|(walk, others)| {
                let either =
                    |(eighths, other): (i64, Option<f32>)| other.unwrap_or(eighths as f32 / 8.0);
                walk.into_iter().zip(others).map(either).collect()
            }),
        ]
        .boxed()
    }
    fn value() -> BoxedStrategy<f32> {
        float().prop_filter("finite", |value| value.is_finite()).boxed()
    }
    /// Handy ones often.
    fn positive() -> BoxedStrategy<f32> {
        prop_oneof![
            (1..32_u8).prop_map(|eighths| f32::from(eighths) / 8.0),
            between(0.01, 2.0),
            f32::value().prop_map(f32::abs).prop_filter("above 0", |&value| value > 0.0),
        ]
        .boxed()
    }
    fn tap() -> BoxedStrategy<f32> {
        prop_oneof![
            4 => (1..16_u8).prop_map(|eighths| f32::from(eighths) / 8.0),
            4 => between(0.01, 1.0),
            1 => f32::value().prop_map(|value| value.clamp(-4e29, 4e29)),
        ]
        .boxed()
    }
    fn shift() -> BoxedStrategy<f32> {
        prop_oneof![Just(0.0), f32::value().prop_map(|value| value.clamp(-1e31, 1e31))].boxed()
    }
}

macro_rules! drawn {
    ($sample:ty, $bits:ty, $from_bits:expr) => {
        impl Drawn for $sample {
            fn recordings() -> BoxedStrategy<Vec<Self>> {
                let from_bits = |bits: i64| $from_bits(bits as $bits);
                integers(<$bits>::MAX.into())
                    .prop_map(move |list| list.into_iter().map(from_bits).collect())
                    .boxed()
            }
            fn value() -> BoxedStrategy<Self> {
                integer(<$bits>::MAX.into()).prop_map(|bits| $from_bits(bits as $bits)).boxed()
            }
            fn positive() -> BoxedStrategy<Self> {
                let max = <$bits>::MAX;
                prop_oneof![1..=100 as $bits, 1..=max, Just(max)].prop_map($from_bits).boxed()
            }
            fn shift() -> BoxedStrategy<Self> {
                prop_oneof![Just(<$sample>::default()), <$sample>::value()].boxed()
            }
            fn tap() -> BoxedStrategy<Self> {
                let most = <$bits>::MAX / 24;
                prop_oneof![4 => 1..=24 as $bits, 2 => -9..=9 as $bits, 1 => -most..=most]
                    .prop_map($from_bits)
                    .boxed()
            }
        }
    };
}
drawn!(i16, i16, |bits: i16| bits);
drawn!(I8F8, i16, I8F8::from_bits);
drawn!(I1F15, i16, I1F15::from_bits);
drawn!(I16F16, i32, I16F16::from_bits);
drawn!(I32F0, i32, I32F0::from_bits);

/// All twelve channels of both flights.
pub(crate) fn flight_channels() -> Vec<Vec<f32>> {
    flight::flights().into_iter().flatten().collect()
}

/// All twelve channels in a sample type, of which 1 rad/s or 1 m/s² is `unit`.
pub(crate) fn flown_channels<S: Sample>(unit: f64) -> Vec<Vec<S>> {
    let scaled = |x: f32| S::from_f64(f64::from(x) * unit);
    let scaled = |channel: Vec<f32>| channel.into_iter().map(scaled).collect();
    flight_channels().into_iter().map(scaled).collect()
}

/// Every way of being short or strange: recordings that each scheme is run on.
pub(crate) fn hostile_recordings() -> Vec<Vec<f32>> {
    let mut recordings = vec![vec![], HOSTILE.to_vec()];
    recordings.extend(HOSTILE.map(|value| vec![value]));
    recordings.extend(HOSTILE.map(|value| vec![value; 40]));
    recordings.extend(HOSTILE.map(|value| [vec![1.0; 20], vec![value; 20]].concat()));
    recordings.extend(HOSTILE.map(|value| [0.5, value].repeat(20)));
    recordings
}
