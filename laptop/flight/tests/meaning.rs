//! Each key of a flight file means what the table of keys says, and the fingerprint is that of the same flight by hand.

use catalogue::run::SampleType;
use proptest::prelude::*;
use spikewire::filter::{Biquad, Filtered, FirstOrder};
use spikewire::link::{Coding, Session, Transmitter};
use spikewire::temporal::StepForward;
use spikewire::{Bank, Fingerprint, Sample, Start};
use spikewire_flight::{Filter, Flight, FlightErrorKind};

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
    let all = flight.asked_of_all();
    assert_eq!(all.get("threshold").and_then(|list| list.numbers()), Some(&[2.0, 5.0][..]));
    assert_eq!(all.get("spikes"), asked.get("spikes"));
}

/// Channels of random codes draw numbers of their own.
#[test]
fn no_two_channels_draw_the_same_numbers() {
    let text = "version = 1\nscheme = \"bernoulli\"\nperiod = 2000\nparameters = { min = 0, max = 1 }\n\
        [[channel]]\nname = \"a\"\n[[channel]]\nname = \"b\"\n";
    let flight = Flight::parse(text).unwrap();
    let [one, other] = [0, 1].map(|channel: usize| {
        let mut codec = flight.run_time().codec(&flight.settings()[channel]).unwrap();
        let mut events = Vec::new();
        codec.encode(&[0.5; 64], &mut events);
        codec.finish(&mut events);
        events.iter().map(|event| event.sample).collect::<Vec<_>>()
    });
    assert!(one.len() > 10 && one != other, "{one:?}");
}

/// A transmitter has all that a file says of its frames.
#[test]
fn a_transmitter_is_that_of_the_file() {
    for (lines, gathering, full_every) in
        [("", 0, Transmitter::FULL_EVERY), ("gathering = 5000\nfull_every = 0", 5_000, 0)]
    {
        let flight = Flight::parse(&flight(1500, lines)).unwrap();
        let by_hand = Transmitter::new(Coding::for_channels(1, 1500), Session::counted(3))
            .with_addresses(0..=0)
            .with_fingerprint(flight.fingerprint())
            .with_gathering(gathering)
            .with_full_every(full_every);
        let transmitter = flight.transmitter(Session::counted(3));
        assert_eq!(format!("{transmitter:?}"), format!("{by_hand:?}"));
    }
}

/// A filter that runs on the laptop has the delay of a firmware's, and leaves out samples that are not finite.
#[test]
fn a_filter_has_its_delay_and_passes_over_what_is_not_finite() {
    use spikewire::filter::Filter as _;
    let delays = [
        FirstOrder::<f32>::low_pass(40.0, 500.0).delay(),
        Biquad::<f32>::low_pass(40.0, 500.0).delay(),
        Biquad::<f32>::notch(40.0, 500.0, 2.0).delay(),
    ];
    let filters = [
        Filter::FirstOrder { corner: 40.0 },
        Filter::LowPass { corner: 40.0 },
        Filter::Notch { centre: 40.0, q: 2.0 },
    ];
    for (filter, delay) in filters.into_iter().zip(delays) {
        assert_eq!(filter.delay(500.0).unwrap().to_bits(), delay.to_bits());
        for sample in ["f32", "i16", "q8.8"] {
            let sample: SampleType = sample.parse().unwrap();
            let [mut whole, mut broken] = [(); 2].map(|()| filter.start(sample, 500.0).unwrap());
            for value in [100.0, -20.0, 50.0] {
                assert!(broken(f64::NAN).is_nan() && broken(f64::INFINITY).is_infinite());
                assert_eq!(whole(value).to_bits(), broken(value).to_bits(), "{sample}");
            }
        }
    }
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
