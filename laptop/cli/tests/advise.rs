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
    let (flown, minutes) = (kept("verdicts"), kept("minutes"));
    for bank in banks {
        let scheme = bank["scheme"].as_str().unwrap();
        let flights = &flown["banks"][scheme];
        if scheme == "sod" {
            // At 500 samples a second, the bank that flew in every loop.
            for condition in ["here", "everywhere"] {
                let cells = minutes["sod/numbered"][condition].as_object().unwrap();
                assert!(cells.values().all(|cell| !cell["errors"].to_string().contains("null")));
            }
        } else {
            let cells = flights["everywhere"].as_object().unwrap().values();
            let mut cells = cells.chain([&flights["here"]]);
            assert!(cells.all(|cell| cell["lost"].as_array().unwrap().is_empty()), "{scheme}");
        }
        // The interval of keyframes is that of the simulated flights, at 500 samples a second, or 500 ms if the code heals.
        let heals = ["sf", "sod", "asf"].contains(&scheme);
        let apart = if heals { 500 } else { flights["keyframe_ms"].as_u64().unwrap() };
        assert_eq!(bank["keyframe_every"], apart / 2, "{scheme}");
        // The samples of both channels in f32, in frames with 4 bytes beside them.
        let rivals = bank["rivals"].as_array().unwrap();
        assert_eq!(rivals[0]["bytes_per_second"], 6000.0, "{scheme}");
        assert_eq!(rivals[1]["bytes_per_second"], 1500.0, "{scheme}");
        assert_eq!(rivals.len(), if heals { 3 } else { 2 }, "{scheme}");
    }
    // Turn rates are coded as in the flights, although a fifth of their deviation is much more.
    let threshold = report["channels"][0]["reaching"].as_array().unwrap().iter();
    let threshold = threshold.filter(|one| one["scheme"] == "sod");
    let threshold = threshold.map(|one| one["parameters"]["threshold"].as_f64().unwrap()).next();
    let flown = flown_threshold(0);
    assert!(
        threshold.is_some_and(|own| (own - flown).abs() < 1e-6 * flown),
        "{threshold:?} {flown}"
    );
    // The schemes that failed in flight are listed once, not for each channel.
    let page = ran!("{asked}").output;
    for words in ["tbr lost ", "bernoulli was not flown"] {
        assert_eq!(page.matches(words).count(), 1, "{words}: {page}");
    }
    // Errors are told beside what the encoder got, and beside the samples.
    assert!(
        page.contains(" of the filtered signal, ") && page.contains(" beside its samples"),
        "{page}"
    );
    let unknown = report["bank"]["unknown"].to_string();
    assert!(unknown.contains("in a simulator"), "{unknown}");

    let written = std::fs::read_to_string(&path).unwrap();
    let scheme = format!("scheme = \"{}\"\n", banks[0]["scheme"].as_str().unwrap());
    assert!(written.contains(&scheme) && written.contains("period = 2000"), "{written}");
    let heals = ["sf", "sod", "asf"].contains(&banks[0]["scheme"].as_str().unwrap());
    assert_eq!(written.contains("step_bits = 4\n"), heals, "{written}");
    assert_eq!(written.contains("start = 0"), heals, "{written}");
    assert!(
        written.contains("# in frames of 4 bytes and the values, samples would take 6000"),
        "{written}"
    );
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
    assert_eq!(written, include_str!("../../../examples/one-file/flight.toml"));
}

/// Returns a table of these channels at 500 samples a second. The values of a row are a function of the sample.
fn timed(names: &str, row: impl Fn(f64) -> Vec<f64>) -> String {
    let line = |sample: u32| {
        let values: Vec<String> =
            row(f64::from(sample)).iter().map(|value| format!(",{value}")).collect();
        format!("{}{}\n", sample * 2000, values.concat())
    };
    format!("time_us,{names}\n{}", (0..1500).map(line).collect::<String>())
}

/// Returns the threshold with which send-on-delta flew in every loop, for a group of channels, in SI units.
fn flown_threshold(group: usize) -> f64 {
    let text = std::fs::read_to_string("../loop/numbered.json").unwrap();
    let banks: Value = serde_json::from_str(&text).unwrap();
    banks["sod/numbered"]["groups"][group]["threshold"].as_f64().unwrap()
}

/// Reads the thresholds of the channels in a flight file.
fn thresholds(flight: &str) -> Vec<f64> {
    let parts = flight.split("threshold = ").skip(1);
    let number = |part: &str| part.split([' ', ',', '}']).next().unwrap().parse().unwrap();
    parts.map(number).collect()
}

/// A log is still but for 4 % of its samples, which jump. Most of its error is theirs. The bank that flew passes, and no
/// finer one is taken; where its spikes do not reach, the same threshold gets more of them.
#[test]
fn the_bank_that_flew_passes_its_own_bound() {
    for jump in [1.2, 6.0] {
        let log = timed("gyro_x", |at| {
            let is_jump = at.rem_euclid(250.0) < 10.0;
            vec![0.05 * (at * 0.01).sin() + if is_jump { jump } else { 0.0 }]
        });
        let (directory, log) = file("log.csv", log);
        let path = directory.path().join("flight.toml");
        ran!("advise {log} --loop-bandwidth 5 --evaluations 60 -o {}", path.display());
        let written = std::fs::read_to_string(path).unwrap();
        // The flights had six axes.
        let words = "# not known: how a drone flies on these settings: sod flew with others";
        assert!(written.contains("scheme = \"sod\"") && written.contains(words), "{written}");
        let [threshold] = thresholds(&written)[..] else { panic!("{written}") };
        assert!((threshold / flown_threshold(0) - 1.0).abs() < 1e-6, "{jump}: {written}");
    }
}

/// Six axes at 500 samples a second get the bank that flew in every loop, and the figures of its own flights.
#[test]
fn six_axes_get_the_bank_that_flew_in_every_loop() {
    let log = timed("gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z", |at| {
        let wave = |turns: f64| (at * turns).sin();
        let rates = [0.021, 0.017, 0.013].map(|turns| 3.0 * wave(turns));
        [&rates[..], &[8.0 * wave(0.03), 8.0 * wave(0.027), 9.8 + 12.0 * wave(0.02)]].concat()
    });
    let (directory, log) = file("log.csv", log);
    let path = directory.path().join("flight.toml");
    let page =
        ran!("advise {log} --loop-bandwidth 5 --evaluations 20 -o {}", path.display()).output;
    let written = std::fs::read_to_string(&path).unwrap();
    for words in
        ["scheme = \"sod\"", "corner = 200", "keyframe_every = 250", "step_bits = 4", "start = 0"]
    {
        assert!(written.contains(words), "{words}: {written}");
    }
    for (place, threshold) in thresholds(&written).into_iter().enumerate() {
        let group = [0, 0, 0, 1, 1, 2][place];
        assert!((threshold / flown_threshold(group) - 1.0).abs() < 1e-6, "{written}");
    }
    let text = std::fs::read_to_string("../loop/minutes.json").unwrap();
    let minutes: Value = serde_json::from_str(&text).unwrap();
    let mean = |way: &str, condition: &str| {
        let cell = minutes[way][condition].as_object().unwrap().values().next().unwrap();
        let errors: Vec<f64> =
            cell["errors"].as_array().unwrap().iter().filter_map(Value::as_f64).collect();
        (errors.iter().sum::<f64>() / errors.len() as f64 * 1e3).round() / 1e3
    };
    for (condition, flights, long) in
        [("here", 20, "3 or 4 s"), ("60 s on Betaflight's loop", 12, "60 s on Betaflight's loop")]
    {
        let (coded, plain) = (mean("sod/numbered", condition), mean("raw samples", condition));
        let words = format!(
            "in {flights} flights of {long} with 1 % of the frames lost a simulated drone strayed by {coded}° on this \
             bank, without a code by {plain}°; 0 lost"
        );
        assert!(page.contains(&words) && written.contains(&words), "{words}: {page}");
    }
    let words = "it lost flights that samples did not lose: 1 % in bursts of 50 ms (2 of 10), ";
    assert!(page.contains(words), "{page}");
}

/// Channels in °/s and g have thresholds in these units, and the file says so.
#[test]
fn units_of_names_are_written_and_count() {
    let turns = |at: f64| (at * 0.02).sin() * 3.0;
    let log = timed("gyro_x_dps,accel_z_g", |at| {
        vec![turns(at).to_degrees(), 1.0 + 5.0 * (at * 0.03).sin()]
    });
    let (directory, log) = file("log.csv", log);
    let path = directory.path().join("flight.toml");
    ran!("advise {log} --loop-bandwidth 5 --evaluations 60 -o {}", path.display());
    let written = std::fs::read_to_string(path).unwrap();
    assert!(written.contains("unit = \"deg/s\"") && written.contains("unit = \"g\""), "{written}");
    assert!(!written.contains("taken to be"), "{written}");
    let own = thresholds(&written);
    assert!((own[0] / flown_threshold(0).to_degrees() - 1.0).abs() < 1e-6, "{written}");
    assert!((own[1] * 9.806_65 / flown_threshold(2) - 1.0).abs() < 1e-6, "{written}");
}

/// The head of a blackbox log gives the sizes of the sensors' counts.
#[test]
fn units_of_a_blackbox_are_those_of_its_head() {
    let head = |lines: &str| {
        let log = flight_logs::made::blackbox();
        let at = log.windows(9).position(|own| own == b"H Field I").unwrap();
        [&log[..at], lines.as_bytes(), &log[at..]].concat()
    };
    for (lines, unit) in [
        ("H gyro_scale:0x3f800000\n", "deg/s"),
        ("H gyro_scale:0x3f800000\nH blackbox_high_resolution:1\n", "deg/s/10"),
        ("H gyro_scale:0x3d79c190\n", "deg/s/16.4"),
        ("", "deg/s"),
    ] {
        let (_directory, log) = file("log.bbl", head(lines));
        let asked = format!("advise {log} --columns main.gyroADC[0] --evaluations 1 --json");
        let report = spikewire(&asked, "").log();
        assert_eq!(report["channels"][0]["look"]["unit"], unit, "{lines}");
    }
}

/// A channel that rests while others move is coded as it flew. Where nothing says how, no file is written without it.
#[test]
fn no_channel_is_left_out_of_a_file_in_silence() {
    let log =
        |name: &str| timed(name, |at| vec![(at * 0.02).sin() * 3.0, 0.001 * (at * 0.05).sin()]);
    let (directory, rests) = file("log.csv", log("gyro_x,gyro_y"));
    let path = directory.path().join("flight.toml");
    ran!("advise {rests} --loop-bandwidth 5 --evaluations 60 -o {}", path.display());
    let written = std::fs::read_to_string(&path).unwrap();
    assert!(written.contains("# coded as it flew, as too still for tuning: gyro_y\n"), "{written}");
    let own = thresholds(&written);
    assert!((own[1] / flown_threshold(0) - 1.0).abs() < 1e-6 && own.len() == 2, "{written}");

    // Outside a loop, what is tuned on a channel at rest has a warning, on the page and in the file.
    let page = ran!("advise {rests} --evaluations 20 -o {}", path.display()).output;
    let written = std::fs::read_to_string(&path).unwrap();
    let words = "gyro_y hardly moves, as at rest: its deviation is 0.000708";
    assert!(page.contains(words) && written.contains(&format!("# ! {words}")), "{page}\n{written}");

    std::fs::remove_file(&path).unwrap();
    let constant = timed("gyro_x,other", |at| vec![(at * 0.02).sin() * 3.0, 7.0]);
    let (_directory, constant) = file("log.csv", constant);
    let asked =
        format!("advise {constant} --loop-bandwidth 5 --evaluations 20 -o {}", path.display());
    refused(
        &asked,
        "",
        &["no flight is written: its bank would lack channels: other never leaves 7"],
    );
    assert!(!path.exists());
}

/// With an RMSE of the user's, a flight is told only of a bank that is no coarser than one that flew.
#[test]
fn a_flight_is_told_of_no_coarser_bank() {
    let log = timed("gyro_x,accel_x", |at| vec![(at * 0.02).sin() * 3.0, 8.0 * (at * 0.03).sin()]);
    let (directory, log) = file("log.csv", log);
    let path = directory.path().join("flight.toml");
    let written = |more: &str| {
        ran!("advise {log} --loop-bandwidth 5 --evaluations 60 {more} -o {}", path.display());
        std::fs::read_to_string(&path).unwrap()
    };
    let coarse = written("--max-rmse 0.4,0.5");
    assert!(!coarse.contains("a simulated drone strayed"), "{coarse}");
    assert!(
        coarse
            .contains("# not known: how any drone flies on it: coarser than what flew on gyro_x\n"),
        "{coarse}"
    );
    let fine = written("--max-rmse 0.02,0.5");
    assert!(fine.contains("# not known: how a drone flies on these settings"), "{fine}");
    // One value is not that of two units, and two are not those of one channel.
    let asked = format!("advise {log} --loop-bandwidth 5 --max-rmse 0.4");
    refused(
        &asked,
        "",
        &["--max-rmse 0.4 cannot be that of gyro_x in rad/s and of accel_x in m/s²"],
    );
    let asked = format!("advise {log} --columns gyro_x --max-rmse 0.4,0.5");
    refused(&asked, "", &["--max-rmse has 2 values for 1 channels"]);
}

#[test]
fn a_search_that_is_cut_short_says_so_in_the_file() {
    let log = timed("gyro_x", |at| vec![(at * 0.02).sin() * 3.0]);
    let (directory, log) = file("log.csv", log);
    let path = directory.path().join("flight.toml");
    spikewire(&format!("advise {log} --seconds 0.2 -o {}", path.display()), "");
    let written = std::fs::read_to_string(path).unwrap();
    assert!(written.contains("# ! the search was cut short"), "{written}");
}

/// A sample each 20 seconds is described and advised on, although no frame of the link can tell their period.
#[test]
fn a_slow_log_is_described() {
    let row =
        |sample: u32| format!("{},{}\n", f64::from(sample) * 20.0, (f64::from(sample) / 6.0).sin());
    let log = "time,x\n".to_owned() + &(0..600).map(row).collect::<String>();
    let (directory, log) = file("log.csv", log);
    let page = ran!("advise {log} --time-unit s --evaluations 20").output;
    for words in ["600 samples in 11980 s, 0.05 a second", "take ", "- bytes a second on the link"]
    {
        assert!(page.contains(words), "{words}: {page}");
    }
    let path = directory.path().join("flight.toml");
    let asked = format!("advise {log} --time-unit s --evaluations 20 -o {}", path.display());
    refused(&asked, "", &["no flight is written: ", "0.05 has no period of 1 µs to 16 777 215 µs"]);
    assert!(!path.exists());
}
