//! What ran, and whether it suits the signal, is told.

mod common;

use common::{events, file, flight, good, refused, table};
use serde_json::Value;

fn wave() -> String {
    table(&(0..500).map(|sample| (f64::from(sample) * 0.05).sin() * 20.0).collect::<Vec<_>>())
}

#[test]
fn the_file_says_what_ran_and_the_user_hears_what_was_rounded() {
    for (sample, asked, ran) in [
        ("i16", "1.4", "1"),
        ("q8.8", "0.1", "0.1015625"),
        ("q16.16", "0.1", "0.1000061035156"),
        ("i32", "2.5", "3"),
    ] {
        let done =
            good(&format!("encode --scheme sf --threshold {asked} --sample {sample} -"), &wave());
        assert!(
            done.output.contains(&format!("# threshold={ran}")),
            "{sample}: {}",
            &done.output[..200]
        );
        let words = format!("in {sample}, threshold {asked} ran as {ran}");
        assert!(done.told.contains(&words), "{sample}: {}", done.told);
        let threshold =
            |text: &str| text.lines().find(|line| line.contains("threshold=")).unwrap().to_owned();
        let exact = threshold(&done.output).replace("# threshold=", "");
        let again =
            good(&format!("encode --scheme sf --threshold {exact} --sample {sample} -"), &wave());
        assert_eq!(again.output, done.output, "{sample}");
        assert!(!again.told.contains("ran as"), "{}", again.told);
    }
    for exact in
        ["encode --scheme sf --threshold 0.1 -", "encode --scheme sf --threshold 2 --sample i16 -"]
    {
        assert!(!good(exact, &wave()).told.contains("ran as"), "{exact}");
    }
    let hsa =
        good("encode --scheme hsa --filter hann:15 --shift -20.3 --sample q8.8 -", &wave()).told;
    assert!(
        hsa.contains(
            "in q8.8, shift -20.3 ran as -20.30078125, 12 taps were rounded by at most 0.0019"
        ),
        "{hsa}"
    );
}

#[test]
fn what_becomes_zero_is_refused_by_its_name() {
    for command in ["encode", "score", "plot -o x.svg"] {
        let (_directory, path) = file("x.csv", wave());
        refused(
            &format!("{command} --scheme sf --threshold 0.001 --sample q8.8 {path}"),
            "",
            &["threshold 0.001 is 0 in q8.8, whose step is 0.00390625"],
        );
    }
}

#[test]
fn a_type_or_threshold_that_does_not_suit_the_data_is_told() {
    let rates =
        table(&(0..500).map(|sample| (f64::from(sample) * 0.05).sin() * 2.0).collect::<Vec<_>>());
    let told = good("encode --scheme sf --threshold 120 --sample i16 -", &rates).told;
    assert!(told.contains("the signal's range, 3.9"), "{told}");
    assert!(told.contains("i16 loses the column's own steps"), "{told}");
    assert!(told.contains("no spike: the threshold, 120, is above the signal's range"), "{told}");
    let told = good("encode --scheme sf --threshold 2 --sample i16 -", &wave()).told;
    assert!(!told.contains("steps of") && !told.contains("no spike"), "{told}");
    let told = good("encode --scheme sf --threshold 1 --sample q8.8 -", &table(&[0.0, 300.0])).told;
    assert!(told.contains("1 samples were cut to the range of q8.8"), "{told}");
}

#[test]
fn a_rate_code_that_cannot_reach_the_signal_is_told() {
    let hexarotor = flight("hexarotor.csv");
    let low = format!("--scheme hsa --filter triang:15 --column accel_z {hexarotor}");
    let score = good(&format!("score {low}"), "").told;
    assert!(score.contains("the shift and the filter's sum, which is the most"), "{score}");
    assert!(score.contains(" too low on average, where the signal's own deviation is"), "{score}");
    assert!(good(&format!("encode {low}"), "").told.contains("the most that the code can mean"));
    let (_directory, signal) = file("signal.csv", good("signal --seconds 5", "").output);
    let reached = good(&format!("score --scheme hsa --paper {signal}"), "").told;
    assert!(!reached.contains("too low") && !reached.contains("most that"), "{reached}");
}

#[test]
fn scores_say_what_they_ran_with() {
    let hexarotor = flight("hexarotor.csv");
    let all = good(&format!("score --column gyro_x {hexarotor}"), "").output;
    for words in
        ["threshold=", "window=5", "15 taps, sum ", "form=toolbox", "neurons=20", "slots=10"]
    {
        assert!(all.contains(words), "{words}: {all}");
    }
    let json = good(&format!("score --column gyro_x --json {hexarotor}"), "").output;
    let figures: Value = serde_json::from_str(&json).unwrap();
    for scheme in figures.as_array().unwrap() {
        let parameters = scheme["parameters"].as_object().unwrap();
        assert!(parameters.len() >= 2, "{scheme}");
        assert_eq!(scheme["scheme"] == "sf", scheme["slope"].is_object(), "{scheme}");
    }
    let hsa = figures.as_array().unwrap().iter().find(|scheme| scheme["scheme"] == "hsa").unwrap();
    assert_eq!(hsa["parameters"]["taps"].as_array().unwrap().len(), 15);
}

#[test]
fn conversions_tell_bytes_an_event_of_what_they_wrote() {
    let spikes = "tick,address,polarity\n0,0,1\n1000,1,-1\n2000,2,1\n3000,0,-1\n";
    for (format, words) in [
        ("edvs:e4", "24 bytes written, 6.00 an event\n"),
        ("csv", "bytes written, "),
        ("link", "bytes written, "),
    ] {
        let ran =
            common::good_bytes(&format!("convert --from csv --to {format} -"), spikes.as_bytes());
        let written = format!("{} {words}", ran.output.len());
        let words = if format == "edvs:e4" { words.to_owned() } else { written };
        assert!(ran.told.contains(words.trim()), "{format}: {}", ran.told);
    }
}

/// Whole numbers that `f32` does not tell apart, and a wave far from 0.
#[test]
fn columns_that_a_sample_type_loses_are_told() {
    let latitude: Vec<f64> =
        (0..500).map(|sample| f64::from(473_977_419 + sample * sample % 97)).collect();
    let encode = |sample: &str, values: &[f64]| {
        let (_directory, path) = file("x.csv", table(values));
        let options = format!("--scheme sf --threshold 20 --sample {sample} {path}");
        (good(&format!("encode {options}"), ""), good(&format!("score {options}"), "").told)
    };
    let ((single, scored), (whole, _)) = (encode("f32", &latitude), encode("i32", &latitude));
    for told in [&single.told, &scored] {
        assert!(told.contains("f32 loses the column's own steps: "), "{told}");
        assert!(told.contains("; i32 holds them"), "{told}");
    }
    assert!(!whole.told.contains("loses"), "{}", whole.told);
    assert_ne!(events(&single.output), events(&whole.output));
    let far: Vec<f64> = (0..2000).map(|sample| 1e9 + (f64::from(sample) * 0.01).sin()).collect();
    let (_directory, path) = file("far.csv", table(&far));
    let words = ["f32 loses", "once 1000000000 is taken from every value", "never leaves"];
    refused(&format!("score --scheme sf {path}"), "", &words);
    refused(&format!("encode --scheme sf --paper {path}"), "", &words);
}
