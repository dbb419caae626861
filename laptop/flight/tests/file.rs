//! Flight files: they are read, written and read again without change, and a wrong one is refused with key and line.

use proptest::prelude::*;
use spikewire_flight::{Filter, Flight, FlightErrorKind, rust};

const HEAD: &str = "version = 1\nscheme = \"sf\"\nperiod = 2000\n";
const CHANNEL: &str = "[[channel]]\nname = \"roll\"\nparameters = { threshold = 0.1 }\n";

#[test]
fn a_short_file_has_its_defaults() {
    let flight = Flight::parse(&format!("{HEAD}{CHANNEL}")).unwrap();
    assert_eq!(flight.sample.to_string(), "f32");
    assert_eq!((flight.keyframe_every, flight.clock_ppm, flight.filter), (25, 20_000, None));
    let [channel] = &flight.channels[..] else { panic!("{:?}", flight.channels) };
    assert_eq!((channel.source.as_str(), channel.unit.as_str(), channel.counts), ("roll", "", 1.0));
    assert!((flight.rate() - 500.0).abs() < 1e-9);
}

#[test]
fn an_invalid_file_is_refused_with_key_and_line() {
    for (text, parameter, line, words) in [
        ("nonsense", "", Some(1), "cannot be read"),
        ("version = 1", "", Some(1), "missing field `scheme`"),
        ("version = 2\nscheme = \"sf\"\nperiod = 1", "version", Some(1), "2 is not known"),
        (
            "version = 1\nscheme = \"snf\"\nperiod = 1",
            "scheme",
            Some(2),
            "`snf` is unknown; there are tbr,",
        ),
        ("version = 1\nscheme = \"sf\"\nperiod = 0", "0", Some(3), "cannot be read"),
        (
            "version = 1\nscheme = \"sf\"\nsample = \"f64\"\nperiod = 1",
            "sample",
            Some(3),
            "no sample type",
        ),
        (
            "version = 1\nscheme = \"sf\"\nperiod = 1\nkeyframe_evry = 2",
            "keyframe_evry",
            Some(4),
            "unknown field",
        ),
        ("version = 1\nscheme = \"sf\"\nperiod = 2000", "channel", None, "0 must be in 1..=64"),
    ] {
        let error = Flight::parse(text).unwrap_err();
        assert_eq!(
            (error.parameter.as_str(), error.place.line),
            (parameter, line),
            "{text}: {error}"
        );
        assert!(error.to_string().contains(words), "{text}: {error}");
    }
    let after = |more: &str| Flight::parse(&format!("{HEAD}{more}")).unwrap_err();
    for (more, parameter, channel, line, words) in [
        (
            "keyframe_every = 0\n[[channel]]\nname = \"a\"\nparameters = { threshold = 1 }",
            "keyframe_every",
            None,
            4,
            "0 must be in 1..=",
        ),
        (
            "filter = { kind = \"low-pass\", corner = 300 }\n[[channel]]\nname = \"a\"",
            "filter",
            None,
            4,
            "corner 300 must lie in",
        ),
        ("[[channel]]\nname = \"a\"\nunits = \"m\"", "units", None, 6, "unknown field"),
        ("[[channel]]\nname = \"a\"", "threshold", Some(0), 4, "is missing"),
        (
            "[[channel]]\nname = \"a\"\nparameters = { window = 3 }",
            "parameters",
            None,
            6,
            "`window` is unknown; there are threshold, start",
        ),
        (
            "[[channel]]\nname = \"a\"\nparameters = { threshold = \"x\" }",
            "threshold",
            None,
            6,
            "is not a number",
        ),
        (
            "[[channel]]\nname = \"a\"\nparameters = { threshold = 1, start = 0 }",
            "start",
            Some(0),
            6,
            "starts from its first samples",
        ),
        (
            "[[channel]]\nname = \"a\"\ncounts = 0\nparameters = { threshold = 1 }",
            "counts",
            Some(0),
            4,
            "0 must be in",
        ),
        (
            "[parameters]\nthreshold = 1\n[[channel]]\nname = \"a\"\n\n[[channel]]\nname = \"a\"",
            "name",
            Some(1),
            9,
            "names two channels",
        ),
        ("[[channel]]\nname = \"a\"\nparameters = { threshold = -1 }", "", Some(0), 4, "above 0"),
    ] {
        let error = after(more);
        assert_eq!(
            (error.parameter.as_str(), error.place.channel, error.place.line),
            (parameter, channel, Some(line)),
            "{more}: {error}"
        );
        assert!(error.to_string().contains(words), "{more}: {error}");
    }
}

#[test]
fn channels_that_differ_in_a_count_are_refused() {
    let text = "version = 1\nscheme = \"sod\"\nperiod = 2000\n\
        [[channel]]\nname = \"a\"\nparameters = { threshold = 1, spikes = 4 }\n\
        [[channel]]\nname = \"b\"\nparameters = { threshold = 1, spikes = 5 }\n";
    let error = Flight::parse(text).unwrap_err();
    assert!(matches!(error.kind, FlightErrorKind::NotOneBank), "{error}");
    assert_eq!((error.place.channel, error.place.line), (Some(1), Some(7)));
    assert!(Flight::parse(&text.replace("= 5", "= 4")).is_ok());
}

/// Random codes need a generator of the user's, and cannot be written as a constant.
#[test]
fn random_codes_have_no_module() {
    let text = "version = 1\nscheme = \"bernoulli\"\nperiod = 2000\nparameters = { min = 0, max = 1 }\n[[channel]]\nname = \"a\"\n";
    let error = rust(&Flight::parse(text).unwrap()).unwrap_err();
    assert!(matches!(error.kind, FlightErrorKind::NoConstant), "{error}");
}

#[test]
fn a_file_names_itself_in_its_errors() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("flight.toml");
    let error = Flight::read(&path).unwrap_err();
    assert!(matches!(error.kind, FlightErrorKind::File(_)), "{error}");
    std::fs::write(&path, "version = 3").unwrap();
    let error = Flight::read(&path).unwrap_err();
    assert!(error.to_string().starts_with(&path.display().to_string()), "{error}");
}

/// For every scheme, no sample of a test signal has more events than [`Flight::events`] gives.
#[test]
fn no_sample_has_more_events_than_are_kept() {
    for info in catalogue::INFO {
        let parameters = catalogue::run::example(info);
        let text = format!(
            "version = 1\nscheme = \"{}\"\nperiod = 2000\nparameters = {{ {parameters} }}\n[[channel]]\nname = \"a\"\n",
            info.name
        );
        let flight = Flight::parse(&text).unwrap_or_else(|error| panic!("{text}: {error}"));
        let mut codec = flight.run_time().codec(&flight.settings()[0]).unwrap();
        let signal =
            (0..3000).map(|i| f64::from(i) * 0.031).map(|at| 2.4 * at.sin() * (at * 7.3).cos());
        let mut events = Vec::new();
        codec.encode(&signal.collect::<Vec<_>>(), &mut events);
        codec.finish(&mut events);
        let most = events.chunk_by(|a, b| a.sample == b.sample).map(<[_]>::len).max();
        let most = most.unwrap_or_else(|| panic!("{}: no events", info.name));
        if flight.events() == 0 {
            assert!(info.has_first_value(), "{}", info.name);
        } else {
            assert!(most <= flight.events(), "{}: {most} of {}", info.name, flight.events());
        }
    }
}

proptest! {
    /// A flight is the same after it is written and read again.
    #[test]
    fn a_written_file_is_read_back(
        thresholds in prop::collection::vec(1e-3_f64..1e3, 1..8),
        counts in 1e-2_f64..1e4,
        period in 1_u16..,
        keyframe_every in 1_u32..1000,
        spikes in 1_u32..=127,
        corner in prop::option::of(0.01_f32..0.4),
        name in "[a-z\"\\\\ ./\\[\\]µ]{1,9}",
    ) {
        let channels = thresholds.iter().enumerate().map(|(index, threshold)| {
            let name = toml::Value::from(format!("{name}{index}"));
            format!("[[channel]]\nname = {name}\nunit = \"m/s²\"\ncounts = {counts:?}\nparameters = {{ threshold = {threshold:?} }}\n")
        });
        let channels = channels.collect::<String>();
        let filter = corner.map(|part| {
            let corner = part * 1e6 / f32::from(period);
            format!("filter = {{ kind = \"low-pass\", corner = {corner:?} }}\n")
        });
        let text = format!(
            "version = 1\nscheme = \"sod\"\nsample = \"q16.16\"\nperiod = {period}\nkeyframe_every = {keyframe_every}\n\
             {}parameters = {{ spikes = {spikes} }}\n{channels}",
            filter.unwrap_or_default()
        );
        let flight = Flight::parse(&text).unwrap();
        let written = flight.to_toml(&["how it came about".to_owned()]);
        let again = Flight::parse(&written).unwrap();
        prop_assert_eq!(&again.channels, &flight.channels);
        prop_assert_eq!(again.filter, flight.filter);
        prop_assert_eq!(again.settings(), flight.settings());
        prop_assert_eq!(again.to_toml(&["how it came about".to_owned()]), written);
        let is_low_pass = matches!(again.filter, None | Some(Filter::LowPass { .. }));
        prop_assert!(is_low_pass);
    }
}
