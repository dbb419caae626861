//! `encode` reports irregular steps between times, and `decode` restores the times of samples.

mod common;

use common::{flight, good, ran};

#[test]
fn repeated_times_are_no_gaps() {
    // Four samples share each time, as from a driver that delivers batches.
    let rows = (0..4000).map(|row| format!("{},0\n", row / 4 * 20_000));
    let ran = good(
        "encode --scheme sf --threshold 0.5 -",
        &format!("time_us,x\n{}", rows.collect::<String>()),
    );
    assert!(ran.stderr.contains("0 gaps above 30.000 ms"), "{}", ran.stderr);
    assert!(ran.stderr.contains("3000 times equal the one before"), "{}", ran.stderr);
}

#[test]
fn decoded_values_have_times() {
    let hexarotor = flight("hexarotor.csv");
    let encode = |options: &str| ran!("encode --column gyro_x {options} {hexarotor}").output;
    let column = |table: &str, of: fn(&str) -> Option<&str>| -> Vec<i64> {
        table.lines().skip(1).map(|line| of(line).unwrap().parse().unwrap()).collect()
    };
    let times = |decoded: &str| column(decoded, |line| line.rsplit(',').next());
    let recorded = std::fs::read_to_string(&hexarotor).unwrap();
    let recorded = column(&recorded, |line| line.split(',').next());
    // This code has a spike in every sample, and therefore a recorded time for each.
    let position = encode("--scheme position --neurons 20");
    let decoded = good("decode", &position).output;
    assert!(decoded.starts_with("index,value,time_us\n"), "{decoded}");
    assert_eq!(times(&decoded), recorded);
    // In a code with slots, the time of an event differs from the time of its sample.
    let slots = encode("--scheme grf-slots --neurons 15 --slots 10");
    assert_eq!(times(&good("decode", &slots).output), recorded);
    // With few spikes, times are exact at spikes, gaps and both ends, and within 20 ms elsewhere.
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
fn a_quoted_header_of_euroc_is_read_as_a_bare_one() {
    let rows = (0..400).map(|row| format!("{},{}\n", row * 5_000_000, f64::from(row).sin()));
    let rows = rows.collect::<String>();
    let encoded = |header: &str| {
        let ran = good("encode --scheme sf --threshold 0.5 -", &format!("{header}\n{rows}"));
        assert!(ran.stderr.contains("in ns from column `timestamp [ns]`"), "{}", ran.stderr);
        ran.output
    };
    let quoted = encoded("\"#timestamp [ns]\",\"w_RS_S_x [rad s^-1]\"");
    assert_eq!(quoted, encoded("#timestamp [ns],w_RS_S_x [rad s^-1]"));
}
