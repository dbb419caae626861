//! Times: which column they are in, in which unit, and what is told of their steps.

mod common;

use common::{file, flight, good, refused, table};

const SF: &str = "encode --scheme sf --threshold 0.5";

/// Names of columns, a first time, and one 5 ms later.
const EXPORTS: [(&str, &str, &str); 20] = [
    // Betaflight's blackbox_decode, and its viewer, which counts µs in `time`.
    ("time (us)", "12000000", "12005000"),
    // ArduPilot.
    ("TimeUS", "12000000", "12005000"),
    ("TimeMS", "12000", "12005"),
    // PX4.
    ("timestamp", "12000000", "12005000"),
    // Loggers of one's own.
    ("Time(ms)", "12000", "12005"),
    ("Time [s]", "12", "12.005"),
    ("seconds", "12", "12.005"),
    ("millis", "12000", "12005"),
    ("elapsed_s", "12", "12.005"),
    ("t", "12", "12.005"),
    // Seconds, ms and ns from 1970 on.
    ("timestamp", "1714564800.0", "1714564800.005"),
    ("time", "1714564800000", "1714564800005"),
    ("timestamp", "1714564800000000000", "1714564800005000000"),
    // ROS: rostopic echo -p, bagpy, PlotJuggler.
    ("%time", "1714564800000000000", "1714564800005000000"),
    ("field.header.stamp", "1714564800000000000", "1714564800005000000"),
    ("Time", "1714564800.0", "1714564800.005"),
    ("__time", "12", "12.005"),
    // pandas: a DatetimeIndex without and with a zone, and a TimedeltaIndex.
    ("", "2024-05-01 12:00:00", "2024-05-01 12:00:00.005"),
    ("timestamp", "2024-05-01 12:00:00+00:00", "2024-05-01 12:00:00.005+00:00"),
    ("Unnamed: 0", "0 days 00:00:12", "0 days 00:00:12.005000"),
];

#[test]
fn times_of_the_usual_exports_are_known() {
    for (name, first, second) in EXPORTS {
        let ran = good(&format!("{SF} -"), &format!("{name},x\n{first},0\n{second},1\n"));
        assert!(ran.output.contains("# rate=200\n"), "{name} {first}: {}", ran.output);
        assert!(ran.told.contains("from column `"), "{name}: {}", ran.told);
    }
    let betaflight = "loopIteration, time, x\n0, 12000000, 0\n1, 12005000, 1\n";
    assert!(good(&format!("{SF} -"), betaflight).output.contains("# rate=200\n"));
    let ros = "header.stamp.secs,header.stamp.nsecs,x\n1714564800,995000000,0\n1714564801,0,1\n";
    let ran = good(&format!("{SF} --column x -"), ros).output;
    assert!(ran.contains("\n1,0,1,1714564801000000\n") && ran.contains("# rate=200\n"), "{ran}");
}

#[test]
fn a_unit_that_is_given_holds() {
    let clock = "clock,x\n0,0\n5,1\n";
    let ran = good(&format!("{SF} --time clock --time-unit ms -"), clock);
    assert!(ran.output.contains("\n1,0,1,5000\n"), "{}", ran.output);
    assert!(ran.told.contains("times in ms from column `clock`\n"), "{}", ran.told);
    let as_seconds = good(&format!("{SF} --time clock -"), clock).output;
    assert!(as_seconds.contains("\n1,0,1,5000000\n"), "{as_seconds}");
    refused(
        &format!("{SF} --time-unit ms -"),
        &table(&[0.0, 1.0]),
        &["no column is known to hold"],
    );
}

#[test]
fn steps_that_no_flight_has_are_told() {
    for (second, third, words) in [
        ("5000", "10000", "the usual step is 5000 s, more than a minute"),
        ("0", "0", "the first 3 are all equal"),
        ("0.0000000005", "0.000000001", "less than a nanosecond"),
    ] {
        let told = good(&format!("{SF} -"), &format!("time,x\n0,0\n{second},1\n{third},0\n")).told;
        assert!(told.contains(words) && told.contains("--time-unit"), "{told}");
    }
    let usual = good(&format!("{SF} -"), "time,x\n0,0\n0.005,1\n0.01,0\n").told;
    assert!(!usual.contains("--time-unit"), "{usual}");
}

#[test]
fn backward_and_repeated_times_are_no_gaps() {
    let back = "time_us,x\n0,0\n5000,0\n10000,0\n7000,0\n12000,0\n17000,0\n40000,1\n";
    let ran = good(&format!("{SF} -"), back);
    assert!(ran.told.contains("1 gaps above 7.500 ms"), "{}", ran.told);
    assert!(ran.told.contains("1 steps back in time: -3.000 ms after sample 2"), "{}", ran.told);
    assert!(
        ran.output.contains("# backward=2,-3000\n# time=5,17000\n# gap=5,23000\n"),
        "{}",
        ran.output
    );
    // Four samples a time, as of a driver that hands over batches.
    let rows = (0..4000).map(|row| format!("{},0\n", row / 4 * 20_000));
    let ran = good(&format!("{SF} -"), &format!("time_us,x\n{}", rows.collect::<String>()));
    assert!(ran.told.contains("0 gaps above 30.000 ms"), "{}", ran.told);
    assert!(ran.told.contains("3000 times equal the one before"), "{}", ran.told);
}

#[test]
fn decoded_values_have_times() {
    let hexarotor = flight("hexarotor.csv");
    let encode =
        |options: &str| good(&format!("encode --column gyro_x {options} {hexarotor}"), "").output;
    let times = |decoded: &str| -> Vec<i64> {
        decoded
            .lines()
            .skip(1)
            .map(|line| line.rsplit(',').next().unwrap().parse().unwrap())
            .collect()
    };
    let recorded: Vec<i64> = std::fs::read_to_string(&hexarotor)
        .unwrap()
        .lines()
        .skip(1)
        .map(|line| line.split(',').next().unwrap().parse().unwrap())
        .collect();
    // A spike each sample: every time is known.
    let position = encode("--scheme position --neurons 20");
    let decoded = good("decode", &position).output;
    assert!(decoded.starts_with("index,value,time_us\n"), "{decoded}");
    assert_eq!(times(&decoded), recorded);
    // With slots an event's time is not its sample's.
    let slots = encode("--scheme grf-slots --neurons 15 --slots 10");
    assert_eq!(times(&good("decode", &slots).output), recorded);
    // With few spikes they are exact there, at gaps and at the ends, and near elsewhere.
    let few = encode("--scheme sf --threshold 0.3");
    let decoded = times(&good("decode", &few).output);
    assert_eq!(decoded.len(), recorded.len());
    let mut exact: Vec<usize> = common::events(&few).iter().map(|event| event.0).collect();
    assert!((50..600).contains(&exact.len()), "{}", exact.len());
    exact.extend([0, 119, 120, 3626]);
    assert!(exact.iter().all(|&sample| decoded[sample] == recorded[sample]));
    let furthest = decoded.iter().zip(&recorded).map(|(ours, theirs)| (ours - theirs).abs()).max();
    assert!(furthest.unwrap() < 20_000, "{furthest:?}");
    assert!(decoded.is_sorted());
}

#[test]
fn a_file_of_spikes_without_times_decodes_without() {
    let spikes = good(&format!("{SF} --rate 200 -"), &table(&[0.0, 1.0])).output;
    assert_eq!(good("decode", &spikes).output, "index,value\n0,0.0\n1,0.5\n");
    let (_directory, log) = file("x.csv", "time_us,x\n0,0\n5000,1\n");
    refused(&format!("{SF} --time-unit h {log}"), "", &["invalid value 'h'", "ms, us, ns"]);
}

#[test]
fn times_at_the_ends_of_their_range_do_no_harm() {
    let signal = "time_us,x\n-1e30,0\n0,1\n1e30,2\n";
    let spikes = good(&format!("{SF} -"), signal).output;
    let decoded = good("decode", &spikes).output;
    assert!(decoded.contains("\n1,0.5,0\n"), "{decoded}");
    let later = spikes.replace("# time=0,-9223372036854775808", "# time=0,9223372036854775807");
    assert_ne!(later, spikes);
    good("decode", &later);
    let (directory, path) = file("x.csv", signal);
    good(&format!("score {path}"), "");
    let picture = directory.path().join("x.svg");
    good(&format!("plot --scheme sf --threshold 1 {path} -o {}", picture.display()), "");
}
