//! What the program adds to the rules of the schemes, which `host-tests` hold: each option reaches its scheme, decoders
//! start where the recording says, and gaps stay gaps.

mod common;

use common::{events, good, spikewire, table, train, values};

#[test]
fn each_option_reaches_its_scheme() {
    let contrast = [0.0, 1.0, 2.5, 1.5, 0.0];
    let window = [0.0, 2.0, 1.5, 2.25, 0.875, 1.0];
    let hough = [0.5, 0.75, 0.5, 0.0, 0.5, 0.5, 0.5, 0.0, 0.0];
    let ben = [0.0, 0.0, 0.5, 1.0, 0.5, 0.0, 0.0, 0.0];
    let cases: [(&str, &[f64], &[i32]); 12] = [
        ("tbr --threshold 1", &contrast, &[0, 0, 1, 0, -1]),
        ("tbr --threshold 1 --start -2", &contrast, &[1, 0, 1, 0, -1]),
        ("sf --threshold 0.5", &[0.0, 0.5, 2.0, 2.0, 2.0, -1.0], &[0, 0, 1, 1, 1, -1]),
        ("mw --threshold 0.5 --window 1", &window, &[-1, 1, 0, 0, -1, -1]),
        ("mw --threshold 0.5 --window 1 --start 0", &window, &[0, 1, 0, 0, -1, -1]),
        ("hsa --filter triang:3 --shift -1", &[-0.5, 0.0, -0.5, -1.0], &[1, 0, 0, 0]),
        (
            "t-hsa --filter triang:3 --shift 0 --threshold 0.25",
            &hough,
            &[1, 0, 0, 0, 0, 0, 0, 0, 0],
        ),
        ("t-hsa --filter triang:3 --shift 0 --threshold 0.5", &hough, &[1, 0, 0, 0, 1, 0, 0, 0, 1]),
        ("bsa --filter triang:3 --shift 0 --threshold 2", &ben, &[0, 0, 1, 0, 0, 0, 0, 0]),
        ("bsa --filter triang:3 --shift 0 --threshold 2.001", &ben, &[0; 8]),
        (
            "bsa --filter triang:3 --shift 0 --threshold 0.0001 --criterion mul",
            &ben,
            &[0, 0, 1, 0, 0, 0, 0, 0],
        ),
        (
            "bsa --filter triang:3 --shift 0 --threshold 0.0001 --form toolbox",
            &ben,
            &[0, 1, 0, 0, 0, 0, 0, 0],
        ),
    ];
    for (scheme, signal, spikes) in cases {
        let encoded = good(&format!("encode --scheme {scheme} -"), &table(signal)).output;
        assert_eq!(train(&encoded), spikes, "{scheme}");
    }
    let neurons: [(&str, &[f64], &[usize]); 3] = [
        (
            "position --centres -1,0,0.5,1",
            &[-99.0, -0.5, 0.25, 0.26, 0.75, 99.0],
            &[0, 0, 1, 2, 2, 3],
        ),
        ("grf-slots --neurons 4 --slots 100 --min 0 --max 1", &[0.1], &[1, 0, 2]),
        ("grf-slots --neurons 4 --slots 100 --min 0 --max 1 --floor 16", &[0.1], &[1, 0]),
    ];
    for (scheme, signal, neurons) in neurons {
        let encoded = good(&format!("encode --scheme {scheme} -"), &table(signal)).output;
        assert!(
            events(&encoded).iter().map(|event| event.1).eq(neurons.iter().copied()),
            "{scheme}"
        );
    }
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
