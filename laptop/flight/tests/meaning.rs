//! Each key of a flight file means what the table of keys says, and the fingerprint is that of the same flight by hand.

use proptest::prelude::*;
use spikewire::filter::{Biquad, Filtered, FirstOrder};
use spikewire::temporal::StepForward;
use spikewire::{Bank, Fingerprint, Sample, Start};
use spikewire_flight::{Flight, FlightErrorKind};

/// Returns a flight of one channel, with further lines before it.
fn flight(period: u32, lines: &str) -> String {
    format!(
        "version = 1\nscheme = \"sf\"\nperiod = {period}\n{lines}\n[[channel]]\nname = \"roll\"\nparameters = {{ threshold = 3 }}\n"
    )
}

/// Unless given, the number of samples in 50 ms, and one at least.
#[test]
fn keyframes_are_50_ms_apart() {
    for (period, samples) in
        [(30, 1666), (999, 50), (1000, 50), (1001, 49), (50_000, 1), (16_777_215, 1)]
    {
        let flight = Flight::parse(&flight(period, "")).unwrap();
        assert_eq!(flight.keyframe_every, samples, "a period of {period} µs");
    }
}

#[test]
fn a_clock_is_off_by_10_percent_at_most() {
    for ppm in [0, 20_000, 100_000] {
        let flight = Flight::parse(&flight(2000, &format!("clock_ppm = {ppm}"))).unwrap();
        assert_eq!(flight.clock_ppm, ppm);
    }
    for ppm in [100_001, 150_000, 200_000, u32::MAX] {
        let error = Flight::parse(&flight(2000, &format!("clock_ppm = {ppm}"))).unwrap_err();
        assert_eq!((error.parameter.as_str(), error.place.line), ("clock_ppm", Some(4)));
        assert!(matches!(error.kind, FlightErrorKind::Range { max: 1e5, .. }), "{error}");
    }
}

/// A channel's parameter goes before the shared one, and a shared one completes those of a channel.
#[test]
fn a_channel_s_parameter_goes_before_the_shared_one() {
    let text = "version = 1\nscheme = \"sod\"\nperiod = 2000\nparameters = { threshold = 5, spikes = 4 }\n\
        [[channel]]\nname = \"a\"\nparameters = { threshold = 2 }\n[[channel]]\nname = \"b\"\n";
    let flight = Flight::parse(text).unwrap();
    let thresholds: Vec<f64> =
        flight.settings().iter().map(|settings| settings.number("threshold").unwrap()).collect();
    assert_eq!(thresholds, [2.0, 5.0]);
    let spikes = flight.settings().iter().map(|settings| settings.count("spikes", 1..=9).unwrap());
    assert_eq!(spikes.collect::<Vec<_>>(), [4, 4]);
    let asked = flight.asked(&flight.channels[0]);
    assert_eq!(asked.get("threshold"), flight.channels[0].asked.get("threshold"));
}

/// Returns the fingerprint of the flight of one channel behind a filter, as its sender computes it.
fn by_hand<P: Start>(scheme: &P, label: &str) -> Fingerprint {
    Bank::<_, 1>::new(scheme).fingerprint().labelled(label)
}

macro_rules! same_as_by_hand {
    ($sample:ty, $name:literal, $rate:expr, $corner:expr, $q:expr, $period:expr) => {{
        let step = StepForward::<$sample>::new(<$sample>::from_f64(3.0));
        let (corner, q) = ($corner, $q);
        let fingerprint = |filter: &str| {
            let lines = format!("sample = \"{}\"\nfilter = {{ {filter} }}", $name);
            let flight = Flight::parse(&flight($period, &lines)).unwrap();
            (flight.fingerprint(), flight.label())
        };
        let (first, label) = fingerprint(&format!("kind = \"first-order\", corner = {corner:?}"));
        let filter = FirstOrder::<$sample>::low_pass(corner, $rate);
        prop_assert_eq!(first, by_hand(&Filtered::new(filter, step), &label));
        let (second, label) = fingerprint(&format!("kind = \"low-pass\", corner = {corner:?}"));
        let filter = Biquad::<$sample>::low_pass(corner, $rate);
        prop_assert_eq!(second, by_hand(&Filtered::new(filter, step), &label));
        let (notch, label) =
            fingerprint(&format!("kind = \"notch\", centre = {corner:?}, q = {q:?}"));
        let filter = Biquad::<$sample>::notch(corner, $rate, q);
        prop_assert_eq!(notch, by_hand(&Filtered::new(filter, step), &label));
        prop_assert!(first != second && second != notch && notch != first);
    }};
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn a_filter_s_fingerprint_is_the_sender_s(period in 500_u32..20_000, share in 0.01_f32..0.4, q in 0.2_f32..20.0) {
        let rate = (1e6 / f64::from(period)) as f32;
        same_as_by_hand!(f32, "f32", rate, rate * share, q, period);
        same_as_by_hand!(i16, "i16", rate, rate * share, q, period);
    }
}

/// An error names a key where a key is wrong, and never takes a value for one.
#[test]
fn an_error_names_a_key_or_none() {
    let error = Flight::parse(&flight(2000, "clock_ppm = 100_001")).unwrap_err();
    assert_eq!(error.to_string(), "line 4: clock_ppm 100001 must be in 0..=100000");
    let error = Flight::parse("version = 1\nscheme = \"sf\"\nperiod = -1").unwrap_err();
    assert!(["", "period"].contains(&error.parameter.as_str()), "{error}");
    let begins = error.to_string().replace("period ", "");
    assert!(begins.starts_with("line 3: cannot be read: "), "{error}");
}
