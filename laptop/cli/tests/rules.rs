//! Tests of the schemes as the program runs them; `host-tests` checks the schemes themselves.

mod common;

use common::{events, good, table, values};

/// In a code with time slots, the neuron nearest to the value fires first. `--floor` suppresses the spikes of the last
/// slots.
#[test]
fn earlier_slots_are_nearer_neurons() {
    for (floor, neurons) in [("", &[1, 0, 2][..]), ("--floor 16", &[1, 0])] {
        let slots = format!("grf-slots --neurons 4 --slots 100 --min 0 --max 1 {floor}");
        let encoded = good(&format!("encode --scheme {slots} -"), &table(&[0.1])).output;
        assert!(events(&encoded).iter().map(|event| event.1).eq(neurons.iter().copied()));
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
    // The middle neuron always fires: the signal is at its centre, 1/2.
    assert_eq!(events(&first).iter().filter(|event| event.1 == 2).count(), 200);
}
