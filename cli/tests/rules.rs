//! The rules of the schemes on signals worked by hand, ties included.

mod common;

use common::{events, good, spikewire, table, train, values};

fn spikes(parameters: &str, signal: &[f64]) -> Vec<i32> {
    train(&good(&format!("encode {parameters} -"), &table(signal)).output)
}

#[test]
fn contrast_is_strict_and_the_first_sample_has_no_predecessor() {
    let signal = [0.0, 1.0, 2.5, 1.5, 0.0];
    assert_eq!(spikes("--scheme tbr --threshold 1", &signal), [0, 0, 1, 0, -1]);
    assert_eq!(spikes("--scheme tbr --threshold 1 --start -2", &signal), [1, 0, 1, 0, -1]);
}

#[test]
fn contrast_takes_mean_and_deviation_of_the_differences() {
    // Differences 1, 3, 2: mean 2, deviation 1 with N-1.
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(file.path(), table(&[0.0, 1.0, 4.0, 6.0])).unwrap();
    let path = file.path().display();
    let half = good(&format!("encode --scheme tbr --factor 0.5 {path}"), "").output;
    assert!(half.contains("# threshold=2.5\n"), "{half}");
    assert_eq!(train(&half), [0, 0, 1, 0]);
    let ran = good(&format!("encode --scheme tbr --factor 0.5 --step 2x {path}"), "").output;
    assert!(ran.contains("# step=5\n"), "{ran}");
    // A ramp from 10 to 0 has a mean of -1 and no deviation.
    let ramp: Vec<f64> = (0..=10).map(|i| f64::from(10 - i)).collect();
    std::fs::write(file.path(), table(&ramp)).unwrap();
    common::refused(
        &format!("encode --scheme tbr --factor 1 {path}"),
        "",
        &["threshold -1", "above 0", "--magnitudes"],
    );
    let ran = good(&format!("encode --scheme tbr --factor 1 --magnitudes {path}"), "").output;
    assert!(ran.contains("# threshold=1\n"), "{ran}");
}

#[test]
fn step_forward_is_strict_and_the_baseline_follows_by_one_step() {
    let signal = [0.0, 0.5, 2.0, 2.0, 2.0, -1.0, -1.0];
    let encoded = good("encode --scheme sf --threshold 0.5 -", &table(&signal)).output;
    assert_eq!(train(&encoded), [0, 0, 1, 1, 1, -1, -1]);
    let decoded = good("decode", &encoded).output;
    assert_eq!(values(&decoded), [0.0, 0.0, 0.5, 1.0, 1.5, 1.0, 0.5]);
}

#[test]
fn moving_window_takes_the_mean_of_one_sample_more_than_the_window() {
    // The mean of the first two is 1; then it is that of the two before.
    let signal = [0.0, 2.0, 1.5, 2.25, 0.875, 1.0];
    assert_eq!(spikes("--scheme mw --threshold 0.5 --window 1", &signal), [-1, 1, 0, 0, -1, -1]);
    assert_eq!(
        spikes("--scheme mw --threshold 0.5 --window 1 --start 0", &signal),
        [0, 1, 0, 0, -1, -1]
    );
}

/// The value of the sample from which a decoder starts is known, so that its spike changes nothing.
#[test]
fn decoding_starts_at_the_first_sample_or_at_the_value_before_it() {
    let signal = [5.0, 0.0, 0.0, 0.0, 3.0, 0.0];
    for sample in ["f32", "q16.16", "q8.8", "i16"] {
        let mw = format!("--scheme mw --threshold 1 --window 2 --sample {sample}");
        // The first window's mean is 5/3, so that its first sample spikes.
        let encoded = good(&format!("encode {mw} -"), &table(&signal)).output;
        assert!(encoded.contains("# first=5\n") && !encoded.contains("# start="), "{encoded}");
        assert_eq!(train(&encoded), [1, -1, -1, -1, 1, 0], "{sample}");
        let decoded = values(&good("decode -", &encoded).output);
        assert_eq!(decoded, [5.0, 4.0, 3.0, 2.0, 3.0, 3.0], "{sample}");
        // The value before the first sample is given: that sample's spike counts.
        let encoded = good(&format!("encode {mw} --start 3 -"), &table(&signal)).output;
        assert!(encoded.contains("# start=3\n") && !encoded.contains("# first="), "{encoded}");
        assert_eq!(train(&encoded)[..2], [1, -1], "{sample}");
        let decoded = values(&good("decode -", &encoded).output);
        assert_eq!(decoded[..2], [4.0, 3.0], "{sample}");
    }
    for scheme in ["sf", "tbr", "mw --window 0"] {
        let encoded = good(&format!("encode --scheme {scheme} --threshold 1 -"), &table(&signal));
        let decoded = values(&good("decode -", &encoded.output).output);
        assert_eq!(decoded[0], 5.0, "{scheme}");
    }
}

#[test]
fn any_filter_window_and_population_runs() {
    let signal: Vec<f64> = (0..5000).map(|i| (f64::from(i) * 0.01).sin() * 2.0).collect();
    for scheme in [
        "hsa --filter triang:257,peak=0.2 --shift -2",
        "t-hsa --filter hann:100,peak=0.2 --shift -2 --threshold 0.5",
        "bsa --filter gauss:1023,sum=4 --shift -2 --threshold 1",
        "bsa --filter triang:33 --form toolbox --shift -2 --threshold 1.15",
        "bsa --filter triang:1 --shift -2 --threshold 0.1",
        "mw --threshold 0.1 --window 999",
        "mw --threshold 0.1 --window 4097",
        "position --neurons 777 --min -2 --max 2",
        "position --centres gaussian --neurons 257 --min -2 --max 2",
        "grf --neurons 1024 --min -2 --max 2",
        "grf-slots --neurons 77 --slots 255 --min -2 --max 2",
        "grf-prob --neurons 333 --min -2 --max 2",
    ] {
        for sample in ["f32", "q16.16", "q4.12"] {
            let encode = format!("encode --scheme {scheme} --sample {sample} -");
            let encoded = good(&encode, &table(&signal)).output;
            assert!(events(&encoded).len() > 10, "{scheme} {sample}");
            assert_eq!(values(&good("decode -", &encoded).output).len(), 5000, "{scheme} {sample}");
        }
    }
}

#[test]
fn hough_spikes_on_equality_and_never_where_the_filter_is_cut() {
    let signal = [0.5, 1.0, 0.5, 0.0, 0.5, 0.75, 0.5, 9.0, 9.0];
    let hsa = "--scheme hsa --filter triang:3 --shift 0";
    assert_eq!(spikes(hsa, &signal), [1, 0, 0, 0, 0, 0, 1, 0, 0]);
}

#[test]
fn threshold_hough_spikes_on_equality_and_nothing_costs_past_the_end() {
    let signal = [0.5, 0.75, 0.5, 0.0, 0.5, 0.5, 0.5, 0.0, 0.0];
    let at_most = |threshold: f64| {
        spikes(
            &format!("--scheme t-hsa --filter triang:3 --shift 0 --threshold {threshold}"),
            &signal,
        )
    };
    assert_eq!(at_most(0.25), [1, 0, 0, 0, 0, 0, 0, 0, 0]);
    assert_eq!(at_most(0.5), [1, 0, 0, 0, 1, 0, 0, 0, 1]);
}

#[test]
fn ben_compares_errors_with_and_without_the_filter() {
    // One filter in silence: e1 = 0 and e2 = 2 at its place.
    let signal = [0.0, 0.0, 0.5, 1.0, 0.5, 0.0, 0.0, 0.0];
    let aligned = "--scheme bsa --filter triang:3 --shift 0";
    assert_eq!(spikes(&format!("{aligned} --threshold 2"), &signal), [0, 0, 1, 0, 0, 0, 0, 0]);
    assert_eq!(spikes(&format!("{aligned} --threshold 2.001"), &signal), [0; 8]);
    assert_eq!(
        spikes(&format!("{aligned} --criterion mul --threshold 0.0001"), &signal),
        [0, 0, 1, 0, 0, 0, 0, 0]
    );
    // The toolbox compares a sample later, and subtracts a sample later still.
    let toolbox = format!("{aligned} --form toolbox --threshold 0.0001");
    assert_eq!(spikes(&toolbox, &signal), [0, 1, 0, 0, 0, 0, 0, 0]);
}

#[test]
fn a_rate_code_decodes_to_its_filters_on_the_shift() {
    let encoded = good(
        "encode --scheme hsa --filter triang:3 --shift -1 -",
        &table(&[-0.5, 0.0, -0.5, -1.0]),
    )
    .output;
    assert_eq!(train(&encoded), [1, 0, 0, 0]);
    assert_eq!(values(&good("decode -", &encoded).output), [-0.5, 0.0, -0.5, -1.0]);
}

#[test]
fn ben_on_a_sine_as_printed_with_the_schemes() {
    let signal: Vec<f64> = (0..1000)
        .map(|i| 0.5 + 0.4 * (std::f64::consts::TAU * 0.01 * f64::from(i)).sin())
        .collect();
    for (threshold, spikes, error) in
        [(0.0, 713, 0.2425), (0.5, 598, 0.1222), (0.9, 505, 0.0183), (0.955, 493, 0.00707)]
    {
        let encoded = good(
            &format!(
                "encode --scheme bsa --filter hann:24,sum=1 --shift 0 --threshold {threshold} -"
            ),
            &table(&signal),
        )
        .output;
        assert_eq!(events(&encoded).len(), spikes);
        let decoded = values(&good("decode -", &encoded).output);
        let squares: f64 = (30..970).map(|i| (signal[i] - decoded[i]).powi(2)).sum();
        assert!(((squares / 940.0).sqrt() - error).abs() < 5e-5, "threshold {threshold}");
    }
}

#[test]
fn the_nearest_neuron_fires_ties_go_down_and_values_outside_to_the_ends() {
    let signal = [-99.0, -0.5, 0.25, 0.26, 0.75, 99.0];
    let encoded = good("encode --scheme position --centres -1,0,0.5,1 -", &table(&signal)).output;
    let neurons: Vec<usize> = events(&encoded).iter().map(|event| event.1).collect();
    assert_eq!(neurons, [0, 0, 1, 2, 2, 3]);
    assert_eq!(values(&good("decode -", &encoded).output), [-1.0, -1.0, 0.0, 0.5, 0.5, 1.0]);
}

#[test]
fn receptive_fields_are_centred_half_a_step_outside() {
    // mu = -0.5, 0.5, 1.5, 2.5 for m = 4 over 0..2.
    let encoded = good(
        "encode --scheme grf --neurons 4 --min 0 --max 2 -",
        &table(&[0.0, 0.1, 1.0, 1.1, 9.0]),
    )
    .output;
    assert_eq!(values(&good("decode -", &encoded).output), [-0.5, 0.5, 0.5, 1.5, 2.5]);
}

#[test]
fn slots_as_printed_with_the_schemes() {
    let signal = [0.1, 0.5, 0.9];
    let encoded = good(
        "encode --scheme grf-slots --neurons 4 --slots 100 --min 0 --max 1 -",
        &table(&signal),
    )
    .output;
    let expected = [
        (10, 1),
        (42, 0),
        (85, 2),
        (125, 1),
        (125, 2),
        (192, 0),
        (192, 3),
        (210, 2),
        (242, 3),
        (285, 1),
    ];
    assert_eq!(events(&encoded), expected.map(|(index, neuron)| (index, neuron, 1)));
    let decoded = values(&good("decode -", &encoded).output);
    assert!(signal.iter().zip(decoded).all(|(x, y)| (x - y).abs() < 0.05));
    // Levels below the floor are silent: slot 85 is level 15.
    let floored = good(
        "encode --scheme grf-slots --neurons 4 --slots 100 --floor 16 --min 0 --max 1 -",
        &table(&signal),
    )
    .output;
    assert_eq!(events(&floored).len(), 6);
}

#[test]
fn probabilistic_spikes_come_from_their_seed() {
    let signal = vec![0.5; 200];
    let run = |seed: u64| {
        good(
            &format!("encode --scheme grf-prob --neurons 5 --min 0 --max 1 --seed {seed} -"),
            &table(&signal),
        )
        .output
    };
    let (first, again, other) = (run(1), run(1), run(2));
    assert_eq!(first, again);
    assert_ne!(events(&first), events(&other));
    assert!(first.contains("# seed=1\n"));
    // The neuron at its own centre, 1/2, always fires.
    assert_eq!(events(&first).iter().filter(|event| event.1 == 2).count(), 200);
}

#[test]
fn values_that_are_not_finite_emit_nothing_and_leave_the_state() {
    let with = "x\n0\nNaN\n0.6\ninf\ninf\n1.2\n0\n";
    common::refused(
        "encode --scheme sf --threshold 0.5 -",
        with,
        &["line 3", "NaN", "--skip-non-finite"],
    );
    for scheme in ["sf --threshold 0.5", "tbr --threshold 0.5", "hsa --filter triang:3 --shift 0"] {
        let ran = good(&format!("encode --scheme {scheme} --skip-non-finite -"), with);
        assert!(ran.told.contains("3 samples were not finite or missing"), "{}", ran.told);
        assert!(
            ran.output.contains("# rejected=1,1\n") && ran.output.contains("# rejected=3,2\n"),
            "{}",
            ran.output
        );
        let without =
            spikewire(&format!("encode --scheme {scheme} -"), "x\n0\n0.6\n1.2\n0\n").output;
        let (with, without) = (train(&ran.output), train(&without));
        assert_eq!([with[0], with[2], with[5], with[6]], without[..]);
        let decoded = values(&good("decode -", &ran.output).output);
        assert!(decoded[1].is_nan() && decoded[3].is_nan() && decoded[4].is_nan());
        assert_eq!(decoded.iter().filter(|value| value.is_finite()).count(), 4);
    }
}
