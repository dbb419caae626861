//! `advise` describes a log and names the scheme that suits it, or gives the reason if no scheme does.

mod common;

use common::{file, flight, good, ran, refused, spikewire, table};
use serde_json::Value;

/// Options for a search that is short enough for a debug build to finish in a few seconds.
const SHORT: &str = "--evaluations 60";

#[test]
fn a_scheme_within_the_error_is_advised_with_its_figures() {
    let (_directory, log) = file("signal.csv", good("signal --seconds 6", "").output);
    let arguments = format!("advise {log} --channel signal --max-rmse 0.4 {SHORT}");
    let report = ran!("{arguments} --json").log();
    let advice = &report["channels"][0];
    assert_eq!(advice["look"]["verdict"], "good");
    assert!((advice["look"]["rate"].as_f64().unwrap() - 100.0).abs() < 0.1);
    let reaching = advice["reaching"].as_array().unwrap();
    let bytes: Vec<f64> =
        reaching.iter().map(|one| one["link_bytes_per_second"].as_f64().unwrap()).collect();
    assert!(bytes.is_sorted() && bytes[0] < 400.0, "{bytes:?}");
    for one in reaching {
        assert!(one["tuned_on"]["rmse"].as_f64().unwrap() <= 0.4, "{one:#}");
        assert!(one["held_out"]["rmse"].as_f64().unwrap() <= 0.5, "{one:#}");
    }
    let directory = tempfile::tempdir().unwrap();
    let picture = directory.path().join("signal.svg");
    let page = ran!("{arguments} --picture {}", picture.display()).output;
    for words in
        ["signal\n", "noise floor", "at rest", "take ", "bytes a second on the link", "latency"]
    {
        assert!(page.contains(words), "{words}: {page}");
    }
    assert!(std::fs::read_to_string(picture).unwrap().starts_with("<svg "));
}

/// A control loop with a bandwidth of 5 Hz tolerates a phase lag of 20°. At 100 samples a second, this allows a latency
/// of one whole sample. No code with a longer latency is advised. The scheme `sf` (step forward) is not advised either,
/// because it cannot follow this signal's jumps if it is tuned for few spikes.
#[test]
fn a_loop_is_advised_no_code_that_is_late_or_falls_behind() {
    let sample = |sample: u32| {
        let wave = (f64::from(sample) / 240.0 * std::f64::consts::TAU).sin();
        wave + if (sample / 25).is_multiple_of(2) { 0.3 } else { -0.3 }
    };
    let (_directory, log) = file("log.csv", table(&(0..1200).map(sample).collect::<Vec<_>>()));
    let ask = |more: &str| {
        let asked = format!("advise {log} --column x --rate 100 --max-rmse 0.4 --evaluations 16");
        let ran = ran!("{asked} --json {more}");
        let report = ran.log();
        let reaching = report["channels"][0]["reaching"].as_array().unwrap().iter();
        let latencies = reaching.map(|one| {
            let latency = one["costs"]["latency"].as_f64().unwrap();
            (one["scheme"].as_str().unwrap().to_owned(), latency)
        });
        (latencies.collect::<Vec<_>>(), report["channels"][0].clone())
    };
    let (any, advice) = ask("");
    assert!(any.iter().any(|(_, latency)| *latency > 1.0), "{any:?}");
    assert!(any.iter().any(|(scheme, _)| scheme == "sf"), "{any:?}");
    assert!(advice["loop_latency"].is_null());
    let others = advice["others"].to_string();
    assert!(
        others.contains(", allowed 0.4, at the nearest of 16 settings")
            && !others.contains("at best"),
        "{others}"
    );

    let (within, advice) = ask("--loop-bandwidth 5");
    assert_eq!(advice["loop_latency"], 1.0);
    assert!(!within.is_empty(), "{advice:#}");
    assert!(within.iter().all(|(scheme, latency)| *latency <= 1.0 && scheme != "sf"), "{within:?}");
    let others = advice["others"].to_string();
    for words in ["tbr was not flown with rotors that shake the sensor", "bernoulli was not flown"]
    {
        assert!(others.contains(words), "{words}: {others}");
    }
    // The bandwidth may be at most a quarter of the sample rate.
    ran!("advise {log} --column x --rate 100 --max-rmse 0.4 --evaluations 1 --loop-bandwidth 25");
    refused(
        &format!("advise {log} --column x --rate 100 --loop-bandwidth 25.1"),
        "",
        &["--loop-bandwidth 25.1 must be 25 or less: x has 100 samples a second"],
    );
    // Without a sample rate, latency in samples cannot be converted to time.
    let unknown = format!("advise {log} --column x --loop-bandwidth 5");
    refused(&unknown, "", &["--loop-bandwidth needs the rate of x"]);
}

/// `advise` ranks schemes for two channels together, by bytes a second. In the simulated flights, none of these schemes
/// lost the drone. `encode` and `emit` accept the flight file that `advise` writes.
#[test]
fn a_bank_has_one_scheme_that_flies_and_its_file_is_read_by_both_ends() {
    let row = |sample: u32| {
        let at = f64::from(sample);
        let (slow, fast) = ((at * 0.02).sin() * 3.0, (at * 0.11).sin() + (at * 0.013).cos() * 4.0);
        format!("{},{slow},{fast}\n", sample * 2000)
    };
    let rows: String = (0..1500).map(row).collect();
    let (_directory, log) = file("log.csv", format!("time_us,gyro_x,accel_z\n{rows}"));
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("flight.toml");
    let asked = format!("advise {log} --loop-bandwidth 5 --evaluations 16 -o {}", path.display());
    let report = ran!("{asked} --json").log();
    let banks = report["bank"]["banks"].as_array().unwrap();
    let bytes: Vec<f64> =
        banks.iter().map(|bank| bank["bytes_per_second"].as_f64().unwrap()).collect();
    assert!(bytes.is_sorted() && !bytes.is_empty(), "{banks:#?}");
    let kept = |name: &str| -> Value {
        let text = std::fs::read_to_string(format!("../loop/{name}.json")).unwrap();
        serde_json::from_str(&text).unwrap()
    };
    let (flown, found) = (kept("verdicts"), kept("banks"));
    for bank in banks {
        let scheme = bank["scheme"].as_str().unwrap();
        let flights = &flown["banks"][scheme];
        let cells = flights["everywhere"].as_object().unwrap().values().chain([&flights["here"]]);
        assert!(cells.clone().all(|cell| cell["lost"].as_array().unwrap().is_empty()), "{scheme}");
        // The interval of keyframes is that of the simulated flights, at 500 samples a second.
        assert_eq!(
            bank["keyframe_every"],
            flights["keyframe_ms"].as_u64().unwrap() / 2,
            "{scheme}"
        );
    }
    // Turn rates are coded about as finely as in the flights (thresholds within 1.2 times, as the same RMSE has another
    // threshold here), although a fifth of their deviation is much more.
    let threshold = report["channels"][0]["reaching"].as_array().unwrap().iter();
    let threshold = threshold.filter(|one| one["scheme"] == "sod");
    let threshold = threshold.map(|one| one["parameters"]["threshold"].as_f64().unwrap()).next();
    let most = found["sod"]["groups"][0]["threshold"].as_f64().unwrap();
    assert!(threshold.is_some_and(|own| own < 1.2 * most), "{threshold:?} {most}");
    // The schemes that failed in flight are listed once, not for each channel.
    let page = ran!("{asked}").output;
    for words in ["tbr lost ", "bernoulli was not flown"] {
        assert_eq!(page.matches(words).count(), 1, "{words}: {page}");
    }
    // Each scheme has a limit of its own: that of its parameters that flew.
    let words = " schemes that come near enough, this one within an RMSE of ";
    assert_eq!(page.matches(words).count(), 2, "{page}");
    let unknown = report["bank"]["unknown"].to_string();
    assert!(unknown.contains("in a simulator"), "{unknown}");

    let written = std::fs::read_to_string(&path).unwrap();
    let scheme = format!("scheme = \"{}\"\n", banks[0]["scheme"].as_str().unwrap());
    assert!(written.contains(&scheme) && written.contains("period = 2000"), "{written}");
    let spikes = ran!("encode --flight {} {log}", path.display()).output;
    assert!(
        spikes.contains("# column=gyro_x,accel_z\n") || spikes.contains("gyro_x,accel_z"),
        "{spikes}"
    );
    let module = ran!("emit rust --flight {}", path.display()).output;
    assert!(
        module.contains("pub const NAMES: [&str; CHANNELS] = [\"gyro_x\", \"accel_z\"];"),
        "{module}"
    );
}

#[test]
fn more_lost_frames_than_were_flown_are_refused() {
    let (_directory, log) = file("log.csv", table(&[0.0, 1.0, 2.0]));
    let refusal = &["--frame-loss 11 must be 0 to 10 percent: more was not flown"];
    refused(&format!("advise {log} --rate 100 --frame-loss 11"), "", refusal);
}

/// The vibration of the motors is nearly as large as the motion of the flight: the noise has a standard deviation of
/// 0.124, and the whole signal has one of 0.206. Still, the log is not mistaken for noise.
#[test]
fn a_shaken_flight_is_advised_on() {
    let text = std::fs::read_to_string(flight("hexarotor.csv")).unwrap();
    let column = |line: &str| line.split(',').nth(1).unwrap().parse::<f64>().unwrap();
    let flown: Vec<f64> = text.lines().skip(1 + 900).map(column).collect();
    let wave = |turns: f64, sample: usize| (std::f64::consts::TAU * turns * sample as f64).sin();
    // Frequencies in cycles per sample, which vary like the speed of motors.
    let shaken = |(sample, value): (usize, &f64)| {
        let speed = 0.01 * wave(0.0005, sample);
        0.3 * value + 0.13 * wave(0.25 + speed, sample) + 0.13 * wave(0.31 - speed, sample)
    };
    let values: Vec<f64> = flown.iter().enumerate().map(shaken).collect();
    let (_directory, log) = file("log.csv", table(&values));
    let ran = spikewire(
        &format!("advise {log} --column x --rate 197 --max-rmse 0.12 --json {SHORT}"),
        "",
    );
    let report = ran.log();
    let look = &report["channels"][0]["look"];
    let (deviation, noise) = (look["deviation"].as_f64().unwrap(), look["noise"].as_f64().unwrap());
    assert!(
        (deviation - 0.206).abs() < 0.02 && (noise - 0.124).abs() < 0.02,
        "{deviation} {noise}"
    );
    assert_eq!(look["verdict"], "good");
    assert!(!report["channels"][0]["reaching"].as_array().unwrap().is_empty());
}

/// No scheme is advised for three logs: one recorded on the ground, one with only 10 samples, and one with a constant
/// value. The report gives the reason.
#[test]
fn a_log_on_the_ground_or_too_short_has_a_verdict() {
    let rest = spikewire(&format!("advise {} {SHORT}", flight("vtol_at_rest.csv")), "");
    assert_eq!(rest.status, 2);
    assert!(
        rest.stderr.contains("nothing can be advised") && !rest.output.contains("take "),
        "{}",
        rest.output
    );
    assert_eq!(rest.output.matches("all on the ground").count(), 6, "{}", rest.output);
    for (values, words) in [
        (vec![1.0, 2.0, 4.0, 3.0, 5.0, 4.0, 6.0, 2.0, 1.0, 0.0], "10 samples are too few"),
        (vec![7.0; 500], "never leaves 7"),
    ] {
        let (_directory, path) = file("log.csv", table(&values));
        let ran = spikewire(&format!("advise --rate 100 {path}"), "");
        assert_eq!(ran.status, 2);
        assert!(ran.output.contains(words) && !ran.output.contains("take "), "{}", ran.output);
    }
}

#[test]
fn the_example_s_flight_is_what_the_readme_s_command_writes() {
    let directory = tempfile::tempdir().unwrap();
    let (path, log) = (directory.path().join("flight.toml"), flight("hexarotor.csv"));
    ran!("advise {log} --loop-bandwidth 4 -o {}", path.display());
    let written = std::fs::read_to_string(path).unwrap();
    // The units, which the table does not tell, were added by hand.
    let flown = include_str!("../../../examples/one-file/flight.toml").lines();
    let without_units = flown.filter(|line| !line.starts_with("unit = "));
    assert!(written.lines().eq(without_units), "{written}");
}
