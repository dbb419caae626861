//! Tests of `encode` and `decode` with several channels in one file of spikes.

mod common;

use common::{events, flight, flight_logs, good, ran, refused};

const COLUMNS: [&str; 6] = ["gyro_x", "gyro_y", "gyro_z", "accel_x", "accel_y", "accel_z"];

/// Schemes with their options, and the number of neurons that each scheme has for one column.
const SCHEMES: [(&str, usize); 6] = [
    ("sf --threshold 0.1", 1),
    ("tbr --factor 0.5", 1),
    ("mw --threshold 0.2 --window 5", 1),
    ("hsa --paper", 1),
    ("position --neurons 20", 20),
    ("grf-slots --neurons 15 --slots 10", 15),
];

#[test]
fn each_channel_is_as_if_alone_at_addresses_by_column() {
    let hexarotor = flight("hexarotor.csv");
    for (scheme, neurons) in SCHEMES {
        let all = ran!("encode --scheme {scheme} --columns {} {hexarotor}", COLUMNS.join(","));
        assert!(all.stderr.contains("3627 samples of 6 channels"), "{}", all.stderr);
        let together = events(&all.output);
        let decoded = good("decode", &all.output).output;
        assert!(decoded.starts_with(&format!("index,{},time_us\n", COLUMNS.join(","))));
        let mut count = 0;
        for (channel, column) in COLUMNS.iter().enumerate() {
            let alone = ran!("encode --scheme {scheme} --column {column} {hexarotor}").output;
            let channel_events: Vec<_> = together
                .iter()
                .filter(|event| event.1 / neurons == channel)
                .map(|&(index, address, polarity)| (index, address % neurons, polarity))
                .collect();
            assert_eq!(channel_events, events(&alone), "{scheme} {column}");
            count += channel_events.len();
            let values = good("decode", &alone).output;
            let values = values.lines().skip(1).map(|line| line.split(',').nth(1));
            let column = decoded.lines().skip(1).map(|line| line.split(',').nth(1 + channel));
            assert!(values.eq(column), "{scheme} {channel}");
        }
        assert_eq!(count, together.len(), "{scheme}");
        assert!(together.is_sorted_by_key(|event| event.0), "{scheme}");
    }
}

#[test]
fn columns_may_be_named_one_by_one_and_logs_take_several_fields() {
    let hexarotor = flight("hexarotor.csv");
    let sf = "encode --scheme sf --threshold 0.002";
    let three = ran!("{sf} --columns gyro_x,gyro_y,gyro_z {hexarotor}").output;
    let named = ran!("{sf} --column gyro_x --column 3 --column gyro_z {hexarotor}").output;
    assert_eq!(three, named);
    let fields = "gyro_rad[0],gyro_rad[1],gyro_rad[2]";
    let log = flight_logs()[0].display().to_string();
    let logged = ran!("{sf} --topic sensor_combined --fields {fields} {log}").output;
    assert_eq!(events(&logged), events(&three));
    let stream = good("convert --from csv --to csv", &three).output;
    assert_eq!(stream.lines().count(), 1 + events(&three).len());
}

#[test]
fn a_parameter_may_have_a_value_for_each_channel() {
    let table = "a,b\n0,0\n1,1\n2,2\n0,0\n";
    let encode = |options: &str| good(&format!("encode --scheme sf {options} -"), table).output;
    let both = encode("--threshold 0.5,1.5 --columns a,b");
    assert!(both.contains("# threshold@0=0.5\n") && both.contains("# threshold@1=1.5\n"));
    let alone = |column: &str, threshold: &str| {
        let output = encode(&format!("--threshold {threshold} --column {column}"));
        output.lines().filter(|line| line.starts_with(|first: char| first.is_ascii_digit())).count()
    };
    let spikes = both.lines().filter(|line| line.starts_with(|first: char| first.is_ascii_digit()));
    assert_eq!(spikes.count(), alone("a", "0.5") + alone("b", "1.5"));
    let words = ["--threshold has 2 values, one a channel, for 1 channel"];
    refused("encode --scheme sf --threshold 1,2 --column a -", table, &words);
}
