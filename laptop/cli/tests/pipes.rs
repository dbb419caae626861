//! `encode` piped into `decode`, for every scheme and sample type, and the commands that score and draw the result.

mod common;

use common::{file, flight, flight_logs, good, ran, refused, table, values};

const SCHEMES: [&str; 10] =
    ["tbr", "mw", "sf", "bsa", "hsa", "t-hsa", "position", "grf", "grf-slots", "grf-prob"];

#[test]
fn every_scheme_and_sample_type_decodes_what_it_encodes() {
    let hexarotor = flight("hexarotor.csv");
    for scheme in SCHEMES {
        for sample in ["f32", "q16.16", "q8.8", "q4.12", "q8.24"] {
            let encoded = ran!(
                "encode --scheme {scheme} --paper --sample {sample} --column gyro_y {hexarotor}"
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
    let encoded =
        ran!("encode --scheme grf-slots --neurons 15 --slots 10 --column 5 {hexarotor}").output;
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
        let from_log =
            ran!("{scheme} --topic sensor_combined --field gyro_rad[0] {}", log.display()).output;
        let from_table = ran!("{scheme} --column gyro_x {}", flight(name)).output;
        assert_eq!(common::events(&from_log), common::events(&from_table));
        assert!(common::events(&from_log).len() > 10);
    }
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
fn scores_are_those_of_a_signal_worked_by_hand() {
    // Decoded as 0, 0, 1, 1: the squared errors are 0, 1, 1, 0, and the signal's variance is 1/2.
    let (_directory, path) = file("x.csv", table(&[0.0, 1.0, 2.0, 1.0]));
    let figures = ran!("score --scheme sf --threshold 1 --rate 2 --json {path}").schemes();
    let number = |name: &str| figures[0][name].as_f64().unwrap();
    assert_eq!(
        (number("spikes"), number("efficiency"), number("spikes_per_second")),
        (1.0, 75.0, 0.5)
    );
    assert!((number("rmse") - 0.5_f64.sqrt()).abs() < 1e-12);
    assert!(number("snr").abs() < 1e-12);
    let all = ran!("score --column gyro_x {}", flight("hexarotor.csv")).output;
    assert!(SCHEMES.iter().all(|scheme| all.contains(&format!("| {scheme} "))), "{all}");
}

#[test]
fn pictures_are_drawn_in_both_formats() {
    let directory = tempfile::tempdir().unwrap();
    let path = |name: &str| directory.path().join(name).display().to_string();
    let hexarotor = flight("hexarotor.csv");
    ran!("plot --all --column gyro_x --range 2350..2700 -o {} {hexarotor}", path("all.svg"));
    let svg = std::fs::read_to_string(path("all.svg")).unwrap();
    assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>") && svg.contains("T-HSA"));
    ran!("plot --scheme sf --threshold 0.1 --column gyro_x -o {} {hexarotor}", path("sf.png"));
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
fn a_scheme_that_refuses_is_a_row() {
    let values: Vec<f64> = (0..400).map(|sample| (f64::from(sample) * 0.05).sin() * 0.02).collect();
    let (_directory, path) = file("small.csv", table(&values));
    let ran = ran!("score --sample q8.8 --rate 100 {path}");
    let row = |name: &str| {
        let mut lines = ran.output.lines();
        lines.find(|line| line.starts_with(&format!("| {name} "))).unwrap().to_owned()
    };
    assert!(row("mw").contains("refused: ") && row("mw").contains("threshold"), "{}", ran.output);
    assert!(row("weighted-phase").ends_with(" |") && !row("weighted-phase").contains("refused"));
    let rows = ran!("score --json --sample q8.8 --rate 100 {path}").schemes();
    let refusals = rows.iter().filter(|row| row["refused"].is_string()).count();
    assert!((1..rows.len()).contains(&refusals), "{rows:?}");
    // If only this scheme is asked for, its refusal is the command's.
    let alone = format!("score --scheme mw --sample q8.8 --rate 100 {path}");
    refused(&alone, "", &["threshold"]);
}

#[test]
fn one_scheme_without_parameters_has_the_papers_settings() {
    let flight = flight("hexarotor.csv");
    let threshold = |command: &str| {
        let rows = ran!("{command} --json --column gyro_x {flight}").schemes();
        let sf = rows.iter().find(|row| row["scheme"] == "sf").unwrap();
        sf["parameters"]["threshold"].as_f64().unwrap()
    };
    assert_eq!(threshold("score --scheme sf"), threshold("score"));
    let directory = tempfile::tempdir().unwrap();
    let picture = directory.path().join("sf.svg");
    ran!("plot --scheme sf --column gyro_x {flight} -o {}", picture.display());
}
