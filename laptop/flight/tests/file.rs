//! Flight files: they are read, written and read again without change, and a wrong one is refused with key and line.

use catalogue::run::Value;
use proptest::prelude::*;
use spikewire_flight::{Filter, Flight, FlightErrorKind, UnitSize, rust};

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
#[expect(clippy::too_many_lines, reason = "a table of cases")]
fn an_invalid_file_is_refused_with_key_and_line() {
    for (text, parameter, line, words) in [
        ("nonsense", "", Some(1), "cannot be read"),
        ("version = 1", "scheme", Some(1), "is missing"),
        ("scheme = \"sf\"\nperiod = 2000", "version", Some(1), "is missing"),
        ("\nversion = 1\nscheme = \"sf\"", "period", Some(1), "is missing"),
        ("version = 1\nversion = 1", "", Some(2), "duplicate key"),
        ("version = 2\nscheme = \"sf\"\nperiod = 1", "version", Some(1), "2 is not known"),
        (
            "version = 1\nscheme = \"snf\"\nperiod = 1",
            "scheme",
            Some(2),
            "`snf` is unknown; there are tbr,",
        ),
        ("version = 1\nscheme = \"sf\"\nperiod = 0", "period", Some(3), "cannot be read"),
        ("version = 1\nscheme = \"sf\"\nperiod = \"2 ms\"", "period", Some(3), "cannot be read"),
        ("version = 1\nscheme = \"sf\"\nperiod = 2", "period", Some(3), "2 ms are 2000"),
        (
            "version = 1\nscheme = \"sf\"\nperiod = 16777216",
            "period",
            Some(3),
            "16777216 must be in 30..=16777215",
        ),
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
        ("version = 1\nscheme = \"sf\"\nperiod = 2000", "channel", Some(1), "0 must be in 1..=64"),
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
            "corner",
            None,
            4,
            "corner 300 must lie in",
        ),
        (
            "[filter]\nkind = \"notch\"\n\ncentre = 80\nq = 1000\n[[channel]]\nname = \"a\"",
            "q",
            None,
            8,
            "q 1000 must lie in",
        ),
        ("[filter]\nkind = \"notch\"\ncentre = 80\n", "q", None, 4, "is missing"),
        (
            "[filter]\nkind = \"notch\"\nq = 3\ncorner = 80\n",
            "corner",
            None,
            7,
            "there are centre, q",
        ),
        ("[filter]\ncorner = 80\nkind = \"high-pass\"", "kind", None, 6, "is unknown"),
        ("[filter]\nkind = \"notch\"\ncentre = \"80\"\n", "centre", None, 6, "cannot be read"),
        ("[[channel]]\nname = \"a\"\nunits = \"m\"", "units", None, 6, "unknown field"),
        ("[[channel]]\nname = \"a\"", "threshold", Some(0), 4, "is missing"),
        ("\n[[channel]]\nunit = \"V\"", "name", Some(0), 5, "is missing"),
        (
            "[[channel]]\nname = \"a\"\nunit = \"dps\"\nparameters = { threshold = 1 }",
            "unit",
            Some(0),
            6,
            "`dps` is written `deg/s`",
        ),
        (
            "[[channel]]\nname = \"a\"\n[channel.parameters]\n\nthreshold = -1",
            "threshold",
            Some(0),
            8,
            "threshold -1 must be above 0",
        ),
        (
            "[parameters]\nthreshold = 1e99\n[[channel]]\nname = \"a\"",
            "threshold",
            Some(0),
            5,
            "must be",
        ),
        (
            "[[channel]]\nname = \"a\"\nparameters = { window = 3 }",
            "parameters",
            Some(0),
            6,
            "`window` is unknown; there are threshold, start",
        ),
        (
            "[[channel]]\nname = \"a\"\nparameters = { threshold = \"x\" }",
            "threshold",
            Some(0),
            6,
            "must be a number, without quotation marks",
        ),
        (
            "[[channel]]\nname = \"a\"\nparameters = { threshold = 1, start = \"0\" }",
            "start",
            Some(0),
            6,
            "must be a number, without quotation marks",
        ),
        ("step_bits = 5\n[[channel]]\nname = \"a\"", "step_bits", None, 4, "5 must be in 0..=4"),
        ("step_bits = -1\n[[channel]]\nname = \"a\"", "step_bits", None, 4, "cannot be read"),
        (
            "gathering = 1000001\n[[channel]]\nname = \"a\"",
            "gathering",
            None,
            4,
            "1000001 must be in 0..=1000000",
        ),
        ("gathering = \"4 ms\"\n[[channel]]\nname = \"a\"", "gathering", None, 4, "cannot be read"),
        (
            "\nfull_every = 10000001\n[[channel]]\nname = \"a\"",
            "full_every",
            None,
            5,
            "10000001 must be in 0..=10000000",
        ),
        (
            "[[channel]]\nname = \"a\"\ncounts = 0\nparameters = { threshold = 1 }",
            "counts",
            Some(0),
            6,
            "0 must be in",
        ),
        (
            "[parameters]\nthreshold = 1\n[[channel]]\nname = \"a\"\n\n[[channel]]\nname = \"a\"",
            "name",
            Some(1),
            10,
            "names two channels",
        ),
        (
            "[[channel]]\nname = \"a\"\nparameters = { threshold = -1 }",
            "threshold",
            Some(0),
            6,
            "above 0",
        ),
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
    assert_eq!((error.place.channel, error.place.line), (Some(1), Some(9)));
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
        period in 30_u32..=16_777_215,
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
            let corner = part * 1e6 / period as f32;
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

/// Every error names the line of the wrong key, or of the channel that lacks it.
#[test]
fn every_wrong_value_is_told_with_the_line_of_its_key() {
    let right = "version = 1\nscheme = \"grf-slots\"\nsample = \"i16\"\nperiod = 4000\nkeyframe_every = 25\n\
                 clock_ppm = 100\n\n[filter]\nkind = \"low-pass\"\ncorner = 40\n\n[parameters]\nneurons = 9\n\
                 slots = 8\n\n[[channel]]\nname = \"a\"\nunit = \"V\"\ncounts = 9.0\n\n[channel.parameters]\n\
                 min = -3000\nmax = 3000\n";
    Flight::parse(right).unwrap();
    let mut told = 0;
    for (index, line) in right.lines().enumerate() {
        let Some((key, _)) = line.split_once(" = ") else { continue };
        for wrong in ["\"x\"", "1e99", "[\n\n1,\n\"x\"]", "nan", "{ }", "1979-05-27"] {
            let mut lines: Vec<String> = right.lines().map(str::to_owned).collect();
            lines[index] = format!("{key} = {wrong}");
            let Err(error) = Flight::parse(&lines.join("\n")) else { continue };
            assert_eq!(error.place.line, Some(index + 1), "{key} = {wrong}: {error}");
            assert_eq!(error.parameter, key, "{key} = {wrong}: {error}");
            told += 1;
        }
    }
    assert!(told > 70, "{told}");
}

/// A parameter that the sample type changes by more than a tenth is refused; a smaller change is told.
#[test]
fn a_rounded_parameter_is_told_or_refused() {
    let text = |sample: &str, threshold: &str| {
        format!(
            "version = 1\nscheme = \"sf\"\nsample = \"{sample}\"\nperiod = 2000\n[[channel]]\nname = \"a\"\n\
             parameters = {{ threshold = {threshold} }}"
        )
    };
    for (sample, threshold) in [("i16", "1.4"), ("q1.31", "3"), ("q8.8", "0.005"), ("i16", "1e6")] {
        let error = Flight::parse(&text(sample, threshold)).unwrap_err();
        assert!(matches!(error.kind, FlightErrorKind::Rounded { .. }), "{sample}: {error}");
        assert_eq!((error.place.channel, error.place.line), (Some(0), Some(7)));
    }
    let flight = Flight::parse(&text("q8.8", "0.1")).unwrap();
    let [rounded] = &flight.rounded()[..] else { panic!("{:?}", flight.rounded()) };
    assert_eq!(rounded.to_string(), "a: threshold 0.1 is 0.1015625 in q8.8");
    let module = rust(&flight).unwrap();
    assert!(
        module.contains("    /// Rounded: a: threshold 0.1 is 0.1015625 in q8.8.\n"),
        "{module}"
    );
    for (sample, threshold) in [("f32", "0.1"), ("q8.8", "0.25"), ("i16", "3")] {
        assert!(Flight::parse(&text(sample, threshold)).unwrap().rounded().is_empty());
    }
    // A tenth is no more than a tenth, and of two channels each has its own note.
    for (threshold, is_refused) in [("1.11", false), ("1.12", true), ("9.1", false)] {
        assert_eq!(Flight::parse(&text("i16", threshold)).is_err(), is_refused, "{threshold}");
    }
    let two = "[[channel]]\nname = \"b\"\nparameters = { threshold = 0.2 }\n";
    let flight = Flight::parse(&format!("{}\n{two}", text("q8.8", "0.1"))).unwrap();
    let module = rust(&flight).unwrap();
    assert_eq!(module.matches("Rounded: a: threshold 0.1 is").count(), 1, "{module}");
    assert_eq!(module.matches("Rounded: b: threshold 0.2 is").count(), 1, "{module}");
    let asked = flight.asked_as_flown(1);
    assert_eq!(asked.get("threshold").and_then(Value::number), Some(0.199_218_75));
    assert!(asked.get("start").is_none());
    // Of a list it is the number that changes most.
    let taps = "version = 1\nscheme = \"hsa\"\nsample = \"q8.8\"\nperiod = 2000\n[[channel]]\nname = \"a\"\n\
                parameters = { filter = [0.25, 0.3, 0.1, 0.5], shift = 0 }";
    let [rounded] = &Flight::parse(taps).unwrap().rounded()[..] else { panic!("one list") };
    assert_eq!((rounded.given, rounded.nearest), (0.1, 0.101_562_5));
    // A small end of a wide range is no large change.
    let range = "version = 1\nscheme = \"position\"\nsample = \"i16\"\nperiod = 2000\n[[channel]]\nname = \"a\"\n\
                 parameters = { neurons = 4, min = 0.4, max = 100 }";
    assert_eq!(Flight::parse(range).unwrap().rounded().len(), 1);
}

/// Names of users are written as text, not as the code or comment around them.
#[test]
fn names_are_escaped_in_rust_and_toml() {
    let name = "e\u{301}\u{85}\u{202e}??/\n\"x\\";
    let quoted = toml::Value::from(name);
    let text = format!("{HEAD}[[channel]]\nname = {quoted}\nparameters = {{ threshold = 0.1 }}\n");
    let flight = Flight::parse(&text).unwrap();
    let module = rust(&flight).unwrap();
    assert!(!module.contains(['\u{85}', '\u{202e}']), "{module}");
    assert!(
        module.contains(r"/// Scheme with the parameters of e\u{301}\u{85}\u{202e}??/\n"),
        "{module}"
    );
    let written = flight.to_toml(&[format!("of {name}")]);
    assert_eq!(Flight::parse(&written).unwrap().channels, flight.channels);
}

mod odd_names {
    include!("flights/odd_names.rs");
}

/// A module with odd names compiles, and has the names of the file.
#[test]
fn a_module_with_odd_names_compiles() {
    use odd_names::flight;

    let parsed = Flight::parse(include_str!("flights/odd_names.toml")).unwrap();
    let written = rust(&parsed).unwrap();
    let path = concat!(env!("CARGO_TARGET_TMPDIR"), "/odd_names.rs");
    std::fs::write(path, &written).unwrap();
    let known = include_str!("flights/odd_names.rs");
    assert!(written == known, "tests/flights has another module than {path}");
    let names: Vec<&str> = parsed.channels.iter().map(|channel| channel.name.as_str()).collect();
    assert_eq!(names, flight::NAMES);
    assert_eq!(parsed.label(), flight::LABEL);
    assert_eq!(parsed.fingerprint(), flight::receiver().fingerprint());
    let invisible = ['\u{85}', '\u{301}', '\u{202e}', '\u{2028}'];
    assert!(!known.contains(invisible), "{known}");
}

/// The path of a file of taps is relative to the flight file.
#[test]
fn taps_lie_beside_the_file() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("flight.toml");
    let text = "version = 1\nscheme = \"hsa\"\nperiod = 2000\n[[channel]]\nname = \"a\"\n\
                parameters = { filter = \"taps.txt\", shift = 0 }\n";
    std::fs::write(&path, text).unwrap();
    assert_eq!(Flight::read(&path).unwrap_err().place.line, Some(6));
    std::fs::write(directory.path().join("taps.txt"), "0.5 1\n0.5\n").unwrap();
    let flight = Flight::read(&path).unwrap();
    assert_eq!(flight.settings()[0].numbers("taps").unwrap(), [0.5, 1.0, 0.5]);
}

#[test]
fn a_unit_is_that_of_the_file_or_of_a_name() {
    let text = format!(
        "{HEAD}[parameters]\nthreshold = 1\n[[channel]]\nname = \"gyro_x_dps\"\n[[channel]]\nname = \"roll\"\n\
         source = \"imu.rate_rad_s[0]\"\n[[channel]]\nname = \"gyro_dps_y\"\nunit = \"rad/s\"\n"
    );
    let flight = Flight::parse(&text).unwrap();
    let units: Vec<&str> = flight.channels.iter().map(|channel| channel.unit.as_str()).collect();
    assert_eq!(units, ["deg/s", "rad/s", "rad/s"]);
    let both = format!(
        "{HEAD}[parameters]\nthreshold = 1\n[[channel]]\nname = \"x_dps\"\nsource = \"x_rad_s\"\n"
    );
    assert_eq!(Flight::parse(&both).unwrap().channels[0].unit, "deg/s", "the name goes first");
    flight.check_units().unwrap();
    let error = Flight::parse(&format!("{text}[[channel]]\nname = \"gyro_x\"")).unwrap();
    let error = error.check_units().unwrap_err();
    assert_eq!((error.place.channel, error.place.line), (Some(3), Some(14)));
    assert!(error.to_string().contains("give `unit = \"rad/s\"`"), "{error}");
}

/// Every key of a file is one of the file that is written of it.
#[test]
fn every_key_is_written() {
    for filter in [
        "{ centre = 80.0, kind = \"notch\", q = 2.5 }",
        "{ corner = 20.0, kind = \"first-order\" }",
        "{ corner = 20.0, kind = \"low-pass\" }",
    ] {
        for full_every in [0, 1, 600_000] {
            let text = format!(
                "version = 1\nscheme = \"sod\"\nsample = \"q8.8\"\nperiod = 2000 # µs\nkeyframe_every = 7 # samples\n\
                 clock_ppm = 300\nstep_bits = 1\ngathering = 1 # µs\nfull_every = {full_every} # µs\nfilter = {filter}\n\
                 parameters = {{ spikes = 4 }}\n\n[[channel]]\nname = \"roll\"\nsource = \"imu.x\"\nunit = \"rad/s\"\n\
                 counts = 0.5\nparameters = {{ start = -1, threshold = 0.25 }}\n"
            );
            assert_eq!(Flight::parse(&text).unwrap().to_toml(&[]), text);
        }
    }
}

/// A channel without a start begins as its scheme does, beside one that has one.
#[test]
fn channels_may_start_differently() {
    let text = format!(
        "{HEAD}{CHANNEL}[[channel]]\nname = \"pitch\"\nparameters = {{ threshold = 0.1, start = 2 }}\n"
    );
    let module = rust(&Flight::parse(&text).unwrap()).unwrap();
    let states = "[(&SCHEME_0, <Code as spikewire::Start>::START), \
                  (&SCHEME_0, <spikewire::temporal::StepForward<f32>>::state_at(2.0))]";
    assert!(module.contains(states), "{module}");
}

/// Sub-timesteps must be told apart by the fastest clock: five fit into a period at 10 %, eight at 2 %.
#[test]
fn sub_timesteps_fit_by_the_tolerance_of_the_file() {
    for (ppm, slots, most) in [(20_000, 8, None), (100_000, 5, None), (100_000, 8, Some("1..=5"))] {
        let text = format!(
            "version = 1\nscheme = \"grf-slots\"\nperiod = 1000\nclock_ppm = {ppm}\n[parameters]\nneurons = 5\n\
             slots = {slots}\nmin = 0\nmax = 1\n[[channel]]\nname = \"a\"\n"
        );
        let error = Flight::parse(&text).err();
        assert_eq!(error.as_ref().map(|error| error.place.line), most.map(|_| Some(7)));
        let words = error.map(|error| error.to_string()).unwrap_or_default();
        assert!(words.contains(most.unwrap_or_default()), "{ppm} {slots}: {words}");
    }
    // Their length leaves room for 2 %, whatever the tolerance is: a part of the fingerprint does not depend on it.
    for ppm in [0, 300, 20_000] {
        let text = format!(
            "version = 1\nscheme = \"grf-slots\"\nperiod = 1000\nclock_ppm = {ppm}\n[parameters]\nneurons = 5\n\
             slots = 50\nmin = 0\nmax = 1\n[[channel]]\nname = \"a\"\n"
        );
        assert_eq!(Flight::parse(&text).unwrap().slot_ticks(), 19, "{ppm}");
    }
}

/// Codes without steps have no step numbers, and codes without a baseline no start.
#[test]
fn settings_of_step_codes_are_refused_elsewhere() {
    for (scheme, parameters, key, words) in [
        ("position", "min = -1, max = 1, neurons = 5", "step_bits", "the scheme has no steps"),
        (
            "mw",
            "threshold = 1, window = 3, start = 0",
            "start",
            "only sf, sod and asf have a baseline",
        ),
        ("tbr", "threshold = 1, start = 0", "start", "only sf, sod and asf have a baseline"),
    ] {
        let bits = if key == "step_bits" { "step_bits = 4\n" } else { "" };
        let text = format!(
            "version = 1\nscheme = \"{scheme}\"\nperiod = 2000\n{bits}[[channel]]\nname = \"a\"\n\
             parameters = {{ {parameters} }}\n"
        );
        let error = Flight::parse(&text).unwrap_err();
        let line = if key == "step_bits" { 4 } else { 6 };
        assert_eq!((error.parameter.as_str(), error.place.line), (key, Some(line)), "{error}");
        assert!(error.to_string().contains(words), "{error}");
    }
}

/// What the sender alone decides is written into its half, and kept by the file, but is no part of the fingerprint.
#[test]
fn what_the_sender_decides_is_written_and_no_part_of_the_fingerprint() {
    let plain = Flight::parse(&format!("{HEAD}{CHANNEL}")).unwrap();
    let text = format!("{HEAD}step_bits = 3\ngathering = 5000\nfull_every = 250000\n{CHANNEL}")
        .replace("0.1 }", "0.1, start = -0.25 }");
    let flight = Flight::parse(&text).unwrap();
    assert_eq!(flight.fingerprint(), plain.fingerprint());
    assert_eq!((flight.coding().step_bits, plain.coding().step_bits), (3, 0));
    let again = Flight::parse(&flight.to_toml(&[])).unwrap();
    assert_eq!((again.step_bits, again.gathering, again.full_every), (3, 5_000, 250_000));
    assert_eq!(rust(&again).unwrap(), rust(&flight).unwrap());
    let module = rust(&flight).unwrap();
    for part in [
        "PERIOD).with_step_bits(3);",
        ".with_label(LABEL).with_gathering(5000).with_full_every(250000)",
        "per_channel_with_states([(&SCHEME_0, <spikewire::temporal::StepForward<f32>>::state_at(-0.25))]);",
    ] {
        assert!(module.contains(part), "{module}");
    }
    assert!(
        !plain.to_toml(&[]).contains("step_bits") && !rust(&plain).unwrap().contains("gathering")
    );
}

/// Thresholds of 0.1 rad/s and 0.1 m/s² have that size in whatever unit a log gives, so that a firmware for the file has them.
#[test]
fn thresholds_are_right_in_every_unit_that_advice_writes() {
    const G: f64 = 9.806_65;
    let degree = std::f64::consts::PI / 180.0;
    for (name, unit, si) in [
        ("gyro_x", "rad/s", [1.0, 0.0]),
        ("gyro_x", "mrad/s", [1e-3, 0.0]),
        ("gyro_x", "deg/s", [degree, 0.0]),
        ("gyro_x", "deg/s/10", [degree / 10.0, 0.0]),
        ("gyro_x", "deg/s/16.4", [degree / 16.4, 0.0]),
        ("acc_z", "m/s²", [0.0, 1.0]),
        ("acc_z", "m/s/s", [0.0, 1.0]),
        ("acc_z", "g", [0.0, G]),
        ("acc_z", "mg", [0.0, G * 1e-3]),
        ("acc_z", "g/2048", [0.0, G / 2048.0]),
        ("acc_z", "g/20480", [0.0, G / 20480.0]),
    ] {
        let threshold = 0.1 / (si[0] + si[1]);
        let text = format!(
            "{HEAD}[[channel]]\nname = \"{name}\"\nunit = \"{unit}\"\nparameters = {{ threshold = {threshold} }}\n"
        );
        let flight = Flight::parse(&text).unwrap();
        flight.check_units().unwrap();
        let size = UnitSize::of(unit).unwrap();
        let own = [size.rate().unwrap_or_default(), size.acceleration().unwrap_or_default()];
        for (own, si) in own.iter().zip(si) {
            assert!((own - si).abs() <= 1e-12 * si, "{unit}: {own}, {si}");
        }
        let flown = flight.settings()[0].number("threshold").unwrap() * (own[0] + own[1]);
        assert!((flown - 0.1).abs() < 1e-7, "{unit}: {flown}");
        assert!(
            rust(&flight).unwrap().contains(&format!("SI: [[f64; 2]; CHANNELS] = [{own:?}];")),
            "{unit}"
        );
    }
}
