//! Every scheme of the catalogue at run time: its parameters are complete, it runs in every sample type with the
//! paper's values, and its file of spikes contains all that decoding needs.

#![cfg(feature = "run")]

use catalogue::run::{
    Asked, Calibrated, ErrorKind, Event, Known, Needs, Result, RunTime, SampleType, Samples,
    Settings, Worded,
};
use catalogue::{ALL, Found, Kind};

const SAMPLES: [&str; 6] = ["f32", "i32", "q16.16", "q8.24", "q4.12", "q8.8"];

fn signal() -> Vec<f64> {
    (0..2000)
        .map(|i| (f64::from(i) * 0.02).sin() * 2.0 + (f64::from(i) * 0.31).cos() * 0.5)
        .collect()
}

/// Returns the signal in the unit of a type with fractional bits, or scaled to larger numbers for a type without.
fn signal_for(sample: SampleType) -> Vec<f64> {
    let scale = if sample.step() == 1.0 { 1000.0 } else { 1.0 };
    signal().into_iter().map(|value| value * scale).collect()
}

fn paper() -> Asked {
    let mut asked = Asked::default();
    asked.paper = true;
    asked
}

fn resolve(scheme: &dyn RunTime, options: &Asked, sample: SampleType) -> Result<Settings> {
    let signal = signal_for(sample);
    let mut calibrated = Calibrated::new(sample);
    calibrated.observe(&signal);
    let known = Known { calibrated: Some(&calibrated), first: &signal, can_calibrate: true };
    scheme.resolve(sample, options, &known)
}

/// Encodes the signal with a scheme, and decodes it; returns events and values.
fn there_and_back(
    scheme: &dyn RunTime,
    settings: &Settings,
    piece: usize,
) -> (Vec<Event>, Vec<f64>) {
    let signal = signal_for(settings.sample);
    let mut codec = scheme.codec(settings).unwrap();
    let (mut events, mut values) = (Vec::new(), Vec::new());
    for samples in signal.chunks(piece) {
        codec.encode(samples, &mut events);
    }
    codec.finish(&mut events);
    let mut codec = scheme.codec(settings).unwrap();
    let (mut left, mut done) = (events.as_slice(), 0);
    for samples in signal.chunks(piece) {
        done += samples.len() as u64;
        let (now, later) = left.split_at(left.partition_point(|event| event.sample < done));
        codec.decode(samples.len(), now, &mut values).unwrap();
        left = later;
    }
    (events, values)
}

/// A codec that starts anew on another recording gives what a new codec does, with events and with values.
#[test]
fn a_codec_starts_anew() {
    for scheme in ALL {
        for sample in SAMPLES.map(|name| name.parse::<SampleType>().unwrap()) {
            let settings = resolve(*scheme, &paper(), sample).unwrap();
            if settings.get("seed").is_some() {
                continue;
            }
            let mut signal = signal_for(sample);
            let mut codec = scheme.codec(&settings).unwrap();
            codec.encode(&signal[..701], &mut Vec::new());
            signal.rotate_left(123);
            let other = settings.beginning(&signal[..settings.first.len()]);
            codec.restart(&other.first);
            let mut fresh = scheme.codec_from(&other, other.first_value()).unwrap();
            let [anew, expected] = [&mut codec, &mut fresh].map(|codec| {
                let (mut events, mut values) = (Vec::new(), Vec::new());
                codec.encode(&signal, &mut events);
                codec.finish(&mut events);
                codec.decode(signal.len(), &events, &mut values).unwrap();
                (events, values)
            });
            assert!(!expected.0.is_empty() && anew == expected, "{} {sample}", scheme.info().name);
        }
    }
}

/// Channels encoded in one call have the cells of a codec each, codes by chance those of a stream each.
#[test]
fn channels_in_one_call() {
    const LENGTH: usize = 601;
    for scheme in ALL {
        for sample in SAMPLES.map(|name| name.parse::<SampleType>().unwrap()) {
            let settings = resolve(*scheme, &paper(), sample).unwrap();
            let signal = signal_for(sample);
            let shape = scheme.shape(&settings).unwrap();
            let mut cells = vec![0; 3 * LENGTH * shape.neurons * shape.slots];
            let mut expected = cells.clone();
            let mut codec = scheme.codec(&settings).unwrap();
            codec.encode_channels(Samples::F64(&signal[..3 * LENGTH]), LENGTH, 5, &mut cells);
            let rows = expected.chunks_mut(LENGTH * shape.neurons * shape.slots);
            for ((samples, rows), channel) in signal.chunks(LENGTH).zip(rows).zip(5..) {
                let own = settings.beginning(&samples[..settings.first.len()]).with_stream(channel);
                let mut codec = scheme.codec_from(&own, own.first_value()).unwrap();
                let made = codec.encode_cells(Samples::F64(samples), rows);
                codec.finish_cells(&mut rows[made * shape.neurons * shape.slots..]);
            }
            assert!(cells.iter().any(|cell| *cell != 0) && cells == expected, "{settings:?}");
        }
    }
}

/// Codes of several channels at once have the cells of a codec each: for more channels than lanes, recordings shorter
/// than filter and window and longer than a block, samples of any type, and thresholds at which rounding decides.
#[test]
fn channels_in_lanes() {
    let cases = [
        ("hsa", "filter=triang:15,peak=0.1 shift=0.125"),
        ("hsa", "filter=triang:2 shift=0"),
        ("t-hsa", "filter=triang:15,peak=0.1 shift=0.125 threshold=0.15"),
        ("t-hsa", "filter=triang:24,peak=0.1 shift=0 threshold=0"),
        ("bsa", "filter=hann:24,peak=0.2 shift=0.125 criterion=sub threshold=0.3"),
        ("bsa", "filter=triang:9,peak=0.5 shift=0 criterion=mul threshold=0.9"),
        ("tbr", "threshold=0.012"),
        ("tbr", "threshold=0.012 start=0.5"),
        ("sf", "threshold=0.1"),
        ("sf", "threshold=0.1 start=0.5"),
        ("mw", "threshold=0.05 window=5"),
        ("mw", "threshold=0.05 window=30 start=0.5"),
        ("if", "threshold=0.7 power=4 reference=0.4 spikes=1"),
        ("lif", "threshold=0.7 power=4 reference=0.4 spikes=1"),
        ("lif", "threshold=0.7 power=4 reference=0.4 spikes=3"),
    ];
    // Multiples of what the taps are made of, so that sums often fall on the threshold itself.
    let samples: Vec<f32> =
        (0..14_300).map(|i| (f32::from(i as u16 % 89) - 20.0).abs() * 0.0125).collect();
    // Potentials beyond all numbers, too: channels are then encoded one by one.
    let huge: Vec<f32> = samples.iter().map(|sample| sample * 1e38).collect();
    let signals = [(&samples, true), (&huge, false)];
    for ((name, options), (samples, spikes)) in
        cases.iter().flat_map(|own| signals.map(|x| (own, x)))
    {
        let wide: Vec<f64> = samples.iter().copied().map(f64::from).collect();
        let scheme = *ALL.iter().find(|scheme| scheme.info().name == *name).unwrap();
        let mut asked = Asked::default();
        for (name, value) in options.split(' ').filter_map(|option| option.split_once('=')) {
            let parameter = scheme.info().parameter(name).unwrap();
            asked.set(parameter.name, parameter.read(value).unwrap());
        }
        let past = scheme.looks_back(&asked);
        for length in [1, 14, 100, 1300] {
            let all = 11 * length;
            let first = &wide[..past.min(length)];
            let known = Known { calibrated: None, first, can_calibrate: false };
            let settings = scheme.resolve(SampleType::F32, &asked, &known).unwrap();
            let shape = scheme.shape(&settings).unwrap();
            let width = length * shape.neurons * shape.slots;
            let mut expected = vec![0; 11 * width];
            for (samples, cells) in wide[..all].chunks(length).zip(expected.chunks_mut(width)) {
                let own = if settings.get("start").is_some() {
                    settings.clone()
                } else {
                    settings.beginning(&samples[..settings.first.len()])
                };
                let mut codec = scheme.codec_from(&own, own.first_value()).unwrap();
                let made = codec.encode_cells(Samples::F64(samples), cells);
                codec.finish_cells(&mut cells[made * width / length..]);
            }
            let has_spikes = expected.iter().any(|cell| *cell != 0);
            assert!(length < 100 || !spikes || has_spikes, "{name} {options}");
            let mut codec = scheme.codec_from(&settings, settings.first_value()).unwrap();
            #[cfg(target_arch = "x86_64")]
            if is_x86_feature_detected!("avx2") {
                assert_eq!(codec.has_lanes(), !options.contains("spikes=3"), "{name} {options}");
            }
            for samples in [Samples::F32(&samples[..all]), Samples::F64(&wide[..all])] {
                let mut cells = vec![0; 11 * width];
                codec.encode_channels(samples, length, 0, &mut cells);
                assert!(cells == expected, "{name} {options}, {length} samples");
            }
        }
    }
}

/// Names and colours of schemes are distinct.
#[test]
fn schemes_differ() {
    for (place, info) in catalogue::INFO.iter().enumerate() {
        for other in &catalogue::INFO[..place] {
            assert_ne!(info.name, other.name);
            assert_ne!(info.title, other.title);
            assert_ne!(info.colour, other.colour, "{} and {}", info.name, other.name);
        }
    }
}

#[test]
fn parameters_say_what_they_take() {
    let names: Vec<&str> = ALL.iter().map(|scheme| scheme.info().name).collect();
    for scheme in ALL {
        let info = scheme.info();
        assert_eq!(names.iter().filter(|name| **name == info.name).count(), 1, "{}", info.name);
        assert!(!info.words.is_empty() && !info.good_for.is_empty() && !info.title.is_empty());
        let own = info.parameters.iter().map(|parameter| parameter.name).collect::<Vec<_>>();
        for parameter in info.parameters {
            let what = format!("{} {}", info.name, parameter.name);
            assert!(parameter.help.len() > 10, "{what}");
            assert_eq!(own.iter().filter(|name| **name == parameter.name).count(), 1, "{what}");
            // Who does not know it sees what to give.
            let is_shown = parameter.default.is_some() || !parameter.example.is_empty();
            assert!(is_shown || matches!(parameter.kind, Kind::Flag | Kind::Choice(_)), "{what}");
        }
        assert_eq!(
            info.has_first_value(),
            info.parameters.iter().any(|parameter| parameter.found == Some(Found::First)),
            "{}",
            info.name
        );
        // What it climbs by is a parameter of its own.
        assert!(info.climbs_by.is_none_or(|name| own.contains(&name)), "{}", info.name);
    }
}

#[test]
fn every_scheme_runs_with_the_papers_settings_in_every_sample_type() {
    for scheme in ALL {
        for sample in SAMPLES {
            let what = format!("{} {sample}", scheme.info().name);
            let sample: SampleType = sample.parse().unwrap();
            let settings = resolve(*scheme, &paper(), sample).unwrap();
            let (events, values) = there_and_back(*scheme, &settings, 2000);
            assert!(events.len() > 20, "{what}: {}", events.len());
            assert_eq!(values.len(), 2000, "{what}");
            let shape = scheme.shape(&settings).unwrap();
            assert!(events.iter().all(|event| usize::from(event.neuron) < shape.neurons), "{what}");
            assert!(events.iter().all(|event| usize::from(event.slot) < shape.slots), "{what}");
            // In pieces as in one.
            for piece in [1, 512] {
                let again = there_and_back(*scheme, &settings, piece);
                assert!(again == (events.clone(), values.clone()), "{what} in pieces of {piece}");
            }
        }
    }
}

#[test]
fn settings_come_back_from_their_names_and_texts() {
    for scheme in ALL {
        for sample in SAMPLES {
            let sample: SampleType = sample.parse().unwrap();
            let settings = resolve(*scheme, &paper(), sample).unwrap();
            let keys = settings.entries().iter().rev();
            let mut keys: Vec<_> =
                keys.map(|(name, text)| ((*name).to_owned(), text.to_string())).collect();
            keys.push(("rate".to_owned(), "200".to_owned()));
            let read = Settings::take(scheme.info(), sample, &mut keys).unwrap();
            assert_eq!(read.entries(), settings.entries(), "{}", scheme.info().name);
            assert_eq!(keys, [("rate".to_owned(), "200".to_owned())]);
            // Decoding needs nothing else.
            let (events, values) = there_and_back(*scheme, &settings, 2000);
            let mut again = Vec::new();
            scheme.codec(&read).unwrap().decode(2000, &events, &mut again).unwrap();
            assert!(again == values, "{}", scheme.info().name);
            // Rounded once, they stay.
            let twice = resolve(*scheme, &settings.to_asked(scheme.info()), sample).unwrap();
            let again = twice.rounded.iter().find(|(name, _)| *name != "first");
            assert_eq!(again, None, "{}", scheme.info().name);
        }
    }
}

#[test]
fn a_file_without_one_of_the_entries_is_refused_by_its_name() {
    for scheme in ALL {
        let settings = resolve(*scheme, &paper(), SampleType::F32).unwrap();
        for (name, text) in settings.entries() {
            // Without a moving window's width or anything else that decoding is built from.
            let others = settings.entries().iter().filter(|(other, _)| other != name);
            let mut keys: Vec<_> =
                others.map(|(name, text)| ((*name).to_owned(), text.to_string())).collect();
            let lacking = Settings::take(scheme.info(), SampleType::F32, &mut keys).unwrap();
            let what = format!("{} {name}={text}", scheme.info().name);
            let error = scheme.codec(&lacking).err().expect(&what);
            let told = error.to_string();
            assert!(told.contains(&format!("`# {name}=`")), "{what}: {told}");
            assert!(matches!(error.kind, ErrorKind::Lacking { .. }), "{what}: {error:?}");
            assert!(error.parameter.is_some_and(|own| own.name == *name), "{what}: {told}");
            // And one that makes no sense.
            let mut keys: Vec<_> = settings
                .entries()
                .iter()
                .map(|(other, text)| {
                    let text = if other == name { "1,x".to_owned() } else { text.to_string() };
                    ((*other).to_owned(), text)
                })
                .collect();
            let wrong = Settings::take(scheme.info(), SampleType::F32, &mut keys);
            let error = wrong.and_then(|wrong| scheme.codec(&wrong).map(drop)).unwrap_err();
            let told = error.to_string();
            assert!(told.contains(name) && told.contains('x'), "{name}=1,x: {told}");
            assert!(error.parameter.is_some_and(|own| own.name == *name), "{name}=1,x: {told}");
        }
    }
}

#[test]
fn events_that_no_encoder_emits_together_are_refused() {
    for scheme in ALL {
        let settings = resolve(*scheme, &paper(), SampleType::F32).unwrap();
        let (events, _) = there_and_back(*scheme, &settings, 2000);
        let event = events[events.len() / 2];
        let mut twice: Vec<Event> = events.clone();
        twice.insert(events.len() / 2, event);
        let mut codec = scheme.codec(&settings).unwrap();
        let refused = codec.decode(2000, &twice, &mut Vec::new()).unwrap_err();
        assert_eq!(refused.sample, event.sample, "{}", scheme.info().name);
    }
}

#[test]
fn what_is_wanted_of_a_signal_is_said() {
    for scheme in ALL {
        let info = scheme.info();
        assert!(scheme.needs_signal(&paper()) == Some(Needs::Paper));
        let mut options = Asked::default();
        for parameter in info.parameters {
            if parameter.is_recorded && !matches!(parameter.kind, Kind::Choice(_)) {
                let text = parameter.default.unwrap_or(parameter.example);
                options.set(parameter.name, parameter.read(text).unwrap());
            }
        }
        // Its ratio goes with logarithmic edges.
        if info.name == "ttfs" {
            options.set("edges", "log");
        }
        assert_eq!(scheme.needs_signal(&options), None, "{}", info.name);
        // With all given it needs none.
        let known = Known { calibrated: None, first: &[0.25], can_calibrate: false };
        let settings = scheme.resolve(SampleType::F32, &options, &known).unwrap();
        scheme.codec(&settings).unwrap();
        options.set("colour", "blue");
        let error = scheme.resolve(SampleType::F32, &options, &known).unwrap_err().to_string();
        assert!(
            error.starts_with(&format!("{} takes no `colour`; it takes `", info.name)),
            "{error}"
        );
    }
}

#[test]
fn centres_at_the_quantiles_of_the_signal() {
    let sample: SampleType = "f32".parse().unwrap();
    for name in ["grf-nonlinear", "grf-nonlinear-slots"] {
        let scheme = ALL.iter().find(|scheme| scheme.info().name == name).unwrap();
        let mut options = paper();
        options.set("centres", "quantiles");
        options.set("neurons", 9_u64);
        assert!(scheme.needs_signal(&options).is_some());
        let settings = resolve(*scheme, &options, sample).unwrap();
        let mut sorted = signal();
        sorted.sort_by(f64::total_cmp);
        let centres = settings.numbers("centres").unwrap();
        assert_eq!(centres.len(), 9);
        for (i, centre) in centres.iter().enumerate() {
            let quantile = sorted[(2 * i + 1) * sorted.len() / 18];
            assert!((centre - quantile).abs() < 0.02, "{i}: {centre} for {quantile}");
        }
        let (_, values) = there_and_back(*scheme, &settings, 100);
        assert_eq!(values.len(), signal().len());
        options.set("companding", 20.0);
        let error = resolve(*scheme, &options, sample).unwrap_err();
        assert!(matches!(&error.kind, ErrorKind::SaysItAll { by } if by.name == "centres"));
        let told = "`centres` quantiles says it all; `companding` contradicts it";
        assert_eq!(error.to_string(), told);
        assert_eq!(
            error.spelled(|name| format!("--{name}")).to_string(),
            told.replace('`', "").replace("ce", "--ce").replace("; ", "; --")
        );
    }
}

#[test]
fn the_spike_of_the_first_sample_changes_nothing() {
    for scheme in ALL.iter().filter(|scheme| scheme.info().has_first_value()) {
        for sample in SAMPLES {
            let sample: SampleType = sample.parse().unwrap();
            let settings = resolve(*scheme, &paper(), sample).unwrap();
            let first = settings.first_value().unwrap();
            let (_, values) = there_and_back(*scheme, &settings, 2000);
            assert_eq!(values[0], first, "{}", scheme.info().name);
            assert!((first - signal_for(sample)[0]).abs() <= sample.step());
        }
    }
}

#[test]
fn errors_name_what_is_allowed() {
    let mut keys = vec![("neurons".to_owned(), "2".to_owned())];
    let settings = Settings::take(
        ALL.iter().map(|scheme| scheme.info()).find(|info| info.name == "grf").unwrap(),
        SampleType::F32,
        &mut keys,
    )
    .unwrap();
    assert_eq!(
        settings.neurons().unwrap_err().to_string(),
        "neurons 2 must be a whole number in 3..=1024"
    );
    assert!(settings.number("min").unwrap_err().to_string().contains("lacks `# min=`"));
}
