//! There and back: every scheme and sample type, from tables and from flight logs.

mod common;

use common::{flight, flight_logs, good, refused, table, values};

const SCHEMES: [&str; 10] =
    ["tbr", "mw", "sf", "bsa", "hsa", "t-hsa", "position", "grf", "grf-slots", "grf-prob"];

#[test]
fn every_scheme_and_sample_type_decodes_what_it_encodes() {
    let hexarotor = flight("hexarotor.csv");
    for scheme in SCHEMES {
        for sample in ["f32", "q16.16", "q8.8", "q4.12", "q8.24"] {
            let encoded = good(
                &format!(
                    "encode --scheme {scheme} --paper --sample {sample} --column gyro_y {hexarotor}"
                ),
                "",
            );
            let decoded = values(&good("decode", &encoded.output).output);
            assert_eq!(decoded.len(), 3627, "{scheme} {sample}");
            assert!(decoded.iter().all(|value| value.is_finite()));
        }
    }
}

#[test]
fn a_scheme_that_follows_stays_near() {
    let hexarotor = flight("hexarotor.csv");
    let encoded = good(
        &format!("encode --scheme grf-slots --neurons 15 --slots 10 --column 5 {hexarotor}"),
        "",
    )
    .output;
    let decoded = values(&good("decode", &encoded).output);
    let signal = std::fs::read_to_string(&hexarotor).unwrap();
    let signal =
        signal.lines().skip(1).map(|line| line.split(',').nth(4).unwrap().parse::<f64>().unwrap());
    let squares: f64 = signal.zip(decoded).map(|(x, y)| (x - y) * (x - y)).sum();
    assert!((squares / 3627.0).sqrt() < 1.0);
}

#[test]
fn a_flight_log_gives_the_same_spikes_as_its_table() {
    for (log, name) in flight_logs().iter().zip(["hexarotor.csv", "vtol_at_rest.csv"]) {
        let scheme = "encode --scheme sf --threshold 0.002";
        let from_log = good(
            &format!("{scheme} --topic sensor_combined --field gyro_rad[0] {}", log.display()),
            "",
        )
        .output;
        let from_table = good(&format!("{scheme} --column gyro_x {}", flight(name)), "").output;
        assert_eq!(common::events(&from_log), common::events(&from_table));
        assert!(common::events(&from_log).len() > 10);
    }
}

#[test]
fn times_are_kept_and_gaps_are_told() {
    let ran = good(
        &format!("encode --scheme sf --threshold 0.1 --column gyro_x {}", flight("hexarotor.csv")),
        "",
    );
    assert!(ran.told.contains("9 gaps above 7.557 ms"), "{}", ran.told);
    assert!(ran.told.contains("100.753 ms after sample 119"), "{}", ran.told);
    assert!(ran.output.contains("index,address,polarity,time_us\n"));
    assert!(ran.output.contains("\n833,0,-1,4297129\n"));
    assert_eq!(ran.output.matches("# gap=").count(), 9);
    let wide = good(
        &format!(
            "encode --scheme sf --threshold 0.1 --gap 3 --column gyro_x {}",
            flight("hexarotor.csv")
        ),
        "",
    );
    assert_eq!(wide.output.matches("# gap=").count(), 1);
}

#[test]
fn times_are_known_by_their_column_or_said_to_be_missing() {
    for (name, second) in [
        ("timestamp_ns", "5000000"),
        ("timestamp_us", "5000"),
        ("timestamp_ms", "5"),
        ("timestamp_s", "0.005"),
        ("time_ns", "5000000"),
        ("time_ms", "5"),
    ] {
        let signal = format!("{name},x\n0,0\n{second},1\n");
        let spikes = good("encode --scheme sf --threshold 0.5 -", &signal).output;
        assert!(spikes.contains("\n1,0,1,5000\n") && spikes.contains("# rate=200\n"), "{spikes}");
    }
    let told = good("encode --scheme sf --threshold 0.5 -", &table(&[0.0, 1.0])).told;
    assert!(told.contains("no times are recorded, so gaps cannot be seen\n"), "{told}");
}

#[test]
fn sub_timesteps_have_times_of_their_own() {
    let signal = "time_us,x\n100,0.1\n1100,0.5\n2100,0.9\n";
    let slots = "--scheme grf-slots --neurons 4 --slots 10 --min 0 --max 1";
    let spikes = good(&format!("encode {slots} -"), signal).output;
    let rows: Vec<&str> = spikes.lines().filter(|line| !line.starts_with('#')).skip(1).collect();
    assert!(rows.len() > 6, "{spikes}");
    for row in &rows {
        let index: u32 = row.split(',').next().unwrap().parse().unwrap();
        assert!(row.ends_with(&format!(",{}", 100 + index * 100)), "{row}");
    }
    let table = good("convert --from csv --to csv", &spikes).output;
    let ticks = table.lines().skip(1).map(|line| line.split(',').next().unwrap());
    assert!(ticks.eq(rows.iter().map(|row| row.rsplit(',').next().unwrap())), "{table}");
    let as_before = spikes.lines().map(|line| match line.rsplit_once(',') {
        Some((row, time)) if time.parse::<u32>().is_ok() => format!("{row},100\n"),
        _ => format!("{line}\n"),
    });
    let decoded = values(&good("decode", &spikes).output);
    assert_eq!(values(&good("decode", &as_before.collect::<String>()).output), decoded);
}

#[test]
fn info_lists_topics_fields_rates_and_gaps() {
    let [hexarotor, _] = flight_logs();
    let told = good(&format!("info {}", hexarotor.display()), "").output;
    let (_, sensors) =
        told.split_once("sensor_combined: 3627 samples, 18.403 s, 198.49 Hz\n").unwrap();
    assert!(sensors.starts_with("  9 gaps above 7.557 ms"), "{sensors}");
    assert!(sensors.contains("gyro_rad[0..3]"), "{sensors}");
}

#[test]
fn scores_are_those_of_a_signal_worked_by_hand() {
    // Decoded 0, 0, 1, 1: errors 0, 1, 1, 1 less; the variance of 0, 1, 2, 1 is 1/2.
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(file.path(), table(&[0.0, 1.0, 2.0, 1.0])).unwrap();
    let told = good(
        &format!("score --scheme sf --threshold 1 --rate 2 --json {}", file.path().display()),
        "",
    )
    .output;
    let figures: serde_json::Value = serde_json::from_str(&told).unwrap();
    let number = |name: &str| figures[0][name].as_f64().unwrap();
    assert_eq!(
        (number("spikes"), number("efficiency"), number("spikes_per_second")),
        (1.0, 75.0, 0.5)
    );
    assert!((number("rmse") - 0.5_f64.sqrt()).abs() < 1e-12);
    assert!(number("snr").abs() < 1e-12);
    let all = good(&format!("score --column gyro_x {}", flight("hexarotor.csv")), "").output;
    assert!(SCHEMES.iter().all(|scheme| all.contains(&format!("| {scheme} "))), "{all}");
}

#[test]
fn scores_and_pictures_say_what_they_left_out() {
    let directory = tempfile::tempdir().unwrap();
    let (signal, picture) = (directory.path().join("signal.csv"), directory.path().join("p.svg"));
    std::fs::write(&signal, table(&[0.0, 200.0, f64::NAN, -300.0, 1.0])).unwrap();
    let options = "--scheme sf --threshold 1 --sample q8.8 --skip-non-finite";
    let (signal, picture) = (signal.display(), picture.display());
    for command in
        [format!("score {options} {signal}"), format!("plot {options} -o {picture} {signal}")]
    {
        let told = good(&command, "").told;
        assert!(
            told.contains("1 samples were not finite or missing and emitted nothing\n"),
            "{told}"
        );
        assert!(told.contains("2 samples were cut to the range of q8.8, -128 to "), "{told}");
        assert!(told.contains("no times are recorded, so gaps cannot be seen\n"), "{told}");
    }
}

#[test]
fn slopes_that_step_forward_cannot_follow_are_told() {
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(file.path(), table(&[0.0, 0.5, 2.0, 2.5, 2.0])).unwrap();
    let told = |options: &str| {
        good(&format!("score --scheme sf {options} {}", file.path().display()), "").told
    };
    let steep = told("--threshold 1 --rate 100");
    let words = "sf cannot follow this signal: it climbs up to 100 a second, the signal 150; 1 steps, 20 % of";
    assert!(steep.contains(words), "{steep}");
    assert!(told("--threshold 1").contains("it climbs up to 1 a sample, the signal 1.5;"));
    assert!(
        told("--threshold 1.5").contains("sf follows this signal: it climbs up to 1.5 a sample")
    );
    let json =
        good(&format!("score --scheme sf --threshold 1 --json {}", file.path().display()), "");
    let figures: serde_json::Value = serde_json::from_str(&json.output).unwrap();
    let slope = &figures[0]["slope"];
    assert_eq!(
        (slope["follows"].as_bool(), slope["steps_above_threshold"].as_u64()),
        (Some(false), Some(1))
    );
    assert_eq!((slope["fastest"].as_f64(), slope["steepest"].as_f64()), (Some(1.0), Some(1.5)));
}

#[test]
fn pictures_are_drawn_in_both_formats() {
    let directory = tempfile::tempdir().unwrap();
    let path = |name: &str| directory.path().join(name).display().to_string();
    let hexarotor = flight("hexarotor.csv");
    good(
        &format!(
            "plot --all --column gyro_x --range 2350..2700 -o {} {hexarotor}",
            path("all.svg")
        ),
        "",
    );
    let svg = std::fs::read_to_string(path("all.svg")).unwrap();
    assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>") && svg.contains("T-HSA"));
    good(
        &format!(
            "plot --scheme sf --threshold 0.1 --column gyro_x -o {} {hexarotor}",
            path("sf.png")
        ),
        "",
    );
    assert!(std::fs::read(path("sf.png")).unwrap().starts_with(b"\x89PNG"));
    refused(
        &format!(
            "plot --scheme sf --threshold 0.1 --column gyro_x -o {} {hexarotor}",
            path("sf.gif")
        ),
        "",
        &[".svg or .png"],
    );
    assert_eq!(std::fs::read_dir(directory.path()).unwrap().count(), 2);
}

#[test]
fn a_decoded_table_can_be_encoded_again() {
    let encoded =
        good("encode --scheme sf --threshold 0.5 -", &table(&[0.0, 0.6, 1.2, 0.2])).output;
    let decoded = good("decode -", &encoded).output;
    assert_eq!(
        common::train(&good("encode --scheme sf --threshold 0.4 -", &decoded).output),
        [0, 1, 1, 0]
    );
}

#[test]
fn a_scheme_that_refuses_is_a_row() {
    let values: Vec<f64> = (0..400).map(|sample| (f64::from(sample) * 0.05).sin() * 0.02).collect();
    let (_directory, path) = common::file("small.csv", table(&values));
    let ran = good(&format!("score --sample q8.8 --rate 100 {path}"), "");
    let row = |name: &str| {
        let mut lines = ran.output.lines();
        lines.find(|line| line.starts_with(&format!("| {name} "))).unwrap().to_owned()
    };
    assert!(row("mw").contains("refused: ") && row("mw").contains("threshold"), "{}", ran.output);
    assert!(row("weighted-phase").ends_with(" |") && !row("weighted-phase").contains("refused"));
    let json = good(&format!("score --json --sample q8.8 --rate 100 {path}"), "").output;
    let rows: Vec<serde_json::Value> = serde_json::from_str(&json).unwrap();
    let refused = rows.iter().filter(|row| row["refused"].is_string()).count();
    assert!((1..rows.len()).contains(&refused), "{json}");
    refused_alone(&path);
}

/// One scheme that is asked for alone ends the command.
fn refused_alone(path: &str) {
    let words = ["threshold"];
    common::refused(&format!("score --scheme mw --sample q8.8 --rate 100 {path}"), "", &words);
    let (_directory, constant) = common::file("constant.csv", table(&[1.0; 50]));
    common::refused(&format!("score --rate 100 {constant}"), "", &["the signal never leaves 1"]);
}

#[test]
fn one_scheme_without_parameters_has_the_papers_settings() {
    let flight = flight("hexarotor.csv");
    let threshold = |command: &str| {
        let ran = good(&format!("{command} --json --column gyro_x {flight}"), "").output;
        let rows: Vec<serde_json::Value> = serde_json::from_str(&ran).unwrap();
        let sf = rows.iter().find(|row| row["scheme"] == "sf").unwrap();
        sf["parameters"]["threshold"].as_f64().unwrap()
    };
    assert_eq!(threshold("score --scheme sf"), threshold("score"));
    let directory = tempfile::tempdir().unwrap();
    let picture = directory.path().join("sf.svg");
    good(&format!("plot --scheme sf --column gyro_x {flight} -o {}", picture.display()), "");
}
