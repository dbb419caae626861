//! `network` for chips: the constants written for networks in NIR and JSON, the reported costs, and networks that are
//! refused.

mod common;

use common::{file, flight, good, ran, refused, spikewire};
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Options for encoding a recording as the inputs of `roll.nir`, a network whose weights were computed rather than
/// trained.
const CODE: &str = "--scheme position --neurons 20 --min -2 --max 2 --column gyro_x";

fn peers(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/peers").join(name)
}

fn network(file: &str) -> String {
    format!("network {file} {CODE} {AS_THE_CHIP} --reset zero {}", flight("hexarotor.csv"))
}

/// Options for tests with the chip's own rule: neurons compare potential and threshold after each spike. The whole
/// recording is used for tuning.
const AS_THE_CHIP: &str = "--compare spike --no-held-out";

/// Finds the first line of `report` that begins with `start`, and returns the numbers that follow in this line.
fn figures(report: &str, start: &str) -> Vec<f64> {
    let line = report.lines().find_map(|line| line.strip_prefix(start)).expect(start);
    let numbers = line.split([' ', ',', ';', '%', ':']);
    numbers.filter_map(|number| number.parse().ok()).collect()
}

/// The constant that `network` writes equals the one in the firmware `examples/rate-loop`. This firmware is built for
/// every core and runs in QEMU.
#[test]
fn a_nir_graph_becomes_the_constant_of_the_firmware() {
    let ran = good(&network(&peers("roll.nir").display().to_string()), "");
    let firmware =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/rate-loop/src/roll.rs");
    assert_eq!(ran.output, fs::read_to_string(firmware).unwrap());
    let [neurons, _, spikes, on_chip, distance] = figures(&ran.stderr, "node `lif1`: ")[..] else {
        panic!("{}", ran.stderr)
    };
    assert_eq!(neurons, 12.0);
    assert!(spikes > 2_000.0 && (spikes - on_chip).abs() < 0.05 * spikes, "{}", ran.stderr);
    assert!(distance < 0.1 * spikes, "{}", ran.stderr);
    let winners = figures(&ran.stderr, "the output that fires most is the same in ");
    assert!(winners[0] > 80.0, "{}", ran.stderr);
}

/// Writes a network to a JSON file in a new directory. Returns the directory, and the arguments that convert the
/// network. The network's inputs are spikes of the column `gyro_x`, encoded by the scheme `sf` (step forward) with
/// `threshold`.
fn driven(layers: &str, threshold: f64, options: &str) -> (tempfile::TempDir, String) {
    let (directory, path) = file("net.json", format!("{{\"layers\": [{layers}}}"));
    let sf = format!("--scheme sf --threshold {threshold} --column gyro_x");
    (directory, format!("network {path} {options} {sf} {}", flight("hexarotor.csv")))
}

/// If a chip can hold a network's weights unrounded, the network fires on the chip exactly as in double precision. The
/// order of spikes does not matter here: no sum of weights equals a threshold, and a neuron receives at most one spike
/// in a sample.
#[test]
fn networks_that_a_chip_can_hold_lose_nothing() {
    let three = r#"{"name": "one", "weights": [[3, 0], [0, 5]], "threshold": 11.5},
        {"name": "two", "weights": [[7, -4]], "threshold": [12.5]}, {"weights": [[2]], "threshold": 3.5}]"#;
    // The second neuron is excited by the spikes of the first, and inhibited by its own.
    let recurrent = r#"{"name": "one", "weights": [[3, 3], [2, 1]], "recurrent": [[0, 0], [-2, 0]],
        "threshold": [8.5, 30.5]}]"#;
    // ReckOn stores neurons in pairs: the third neuron of the first layer is alone in its pair.
    let reckon = r#"{"name": "one", "weights": [[3, 0], [0, 5], [2, 2]], "threshold": 11.5, "bias": [0, 1, 0],
        "recurrent": [[0, 2, 0], [0, 0, -4], [0, 0, 0]]},
        {"name": "two", "weights": [[7, 4, -4], [1, 6, 5]], "threshold": [12.5, 6.5]}]"#;
    let bias = r#"{"weights": [[0, 0]], "bias": [0.25], "threshold": 1.1}]"#;
    for (options, layers, names, written) in [
        (
            AS_THE_CHIP,
            three,
            &["one", "two", "layer 3"][..],
            &["    outputs: [3],\n", "<2, 4, 1>"][..],
        ),
        (AS_THE_CHIP, recurrent, &["one"], &["recurrent: &[\n        [0, -"]),
        (AS_THE_CHIP, bias, &[], &["pub const BIAS: u16 = 2;"]),
        (
            "--chip reckon --no-held-out",
            reckon,
            &["one", "two"],
            &["ReckOnTick { always: &[2], raises: &[] }", "<3, 6, 2>"],
        ),
    ] {
        let (_directory, command) = driven(layers, 0.05, options);
        let ran = good(&command, "");
        assert!(ran.stderr.contains("\noutputs agree in 100.0 % of 3627 steps"), "{}", ran.stderr);
        let spikes = ran.stderr.rsplit("layer: neurons").next().unwrap();
        for layer in names {
            let figures = figures(spikes, &format!("{layer}: "));
            let [_, clipped, spikes, on_chip, distance] = figures[..] else {
                panic!("{}", ran.stderr)
            };
            assert!(spikes > 10.0, "{}", ran.stderr);
            assert_eq!((clipped, distance, on_chip), (0.0, 0.0, spikes), "{}", ran.stderr);
        }
        assert!(written.iter().all(|words| ran.output.contains(words)), "{}", ran.output);
        let has_bias = layers == bias;
        assert_eq!(ran.output.contains("BIAS"), has_bias, "{}", ran.output);
    }
}

/// Whole weights alone do not mean that a network was trained in `ReckOn`'s integers: taken as they are, such small
/// weights would hardly leak as trained, because the chip rounds potentials down.
#[test]
fn reckon_takes_whole_weights_as_they_are_only_if_the_file_says_so() {
    let layers = r#""layers":[{"weights":[[1,0,1],[0,1,1]],"keep":0.9375,"threshold":2}]"#;
    let (_steps, steps) = file("steps.txt", "0\n1\n2\n".repeat(133));
    let agreeing = |integers: &str| {
        let (_network, network) = file("whole.json", format!("{{{layers}{integers}}}"));
        let ran = good(&format!("network {network} {steps} --on reckon --no-held-out"), "");
        (figures(&ran.stderr, "outputs agree in ")[0], ran.output)
    };
    let (scaled, _) = agreeing("");
    assert_eq!(scaled, 100.0);
    let (taken, written) = agreeing(r#", "integers": true"#);
    assert!(taken < 70.0 && written.contains("threshold: 3"), "{taken}: {written}");
}

#[test]
fn what_is_no_network_or_does_not_fit_is_refused_by_name() {
    let ones = |rows: usize, columns: usize| {
        let row = format!("[{}]", vec!["1"; columns].join(","));
        format!("{{\"weights\": [{}], \"threshold\": 1}}", vec![row; rows].join(","))
    };
    let of = |sizes: &[(usize, usize)]| {
        sizes.iter().map(|&(rows, columns)| ones(rows, columns)).collect::<Vec<_>>().join(",") + "]"
    };
    let one = |weights: &str, rest: &str| format!("{{\"weights\": {weights}, {rest}}}]");
    let leaky = r#"[[1, 1]], "threshold": 1}], "readout": {"weights": [[1],[1]], "keep": 0.001"#;
    for (options, layers, words) in [
        ("", "]".to_owned(), &["net.json", "no layer"][..]),
        ("", of(&[(2, 2); 4]), &["4 layers", "3 at most"]),
        ("", of(&[(257, 2)]), &["layer 1: the chip has 256 neurons"]),
        ("", of(&[(255, 2), (1, 255)]), &["2 inputs with 256 neurons", "need 258"]),
        ("", of(&[(3, 2), (2, 4)]), &["layer 2: weights for 4 inputs", "3 neurons"]),
        (
            "",
            of(&[(2, 3)]),
            &["layer 1 has 3 inputs, but sf gives 2, of 1 column, each up and down"],
        ),
        ("", one("[[1, 2], [1]]", r#""threshold": 1"#), &["neuron 1 has 1 weights"]),
        ("", one("[[1, 1e999]]", r#""threshold": 1"#), &["number out of range"]),
        ("", one("[[1, 1]]", r#""threshold": 0"#), &["layer 1: neuron 0 fires at 0 above rest"]),
        ("", one("[[1, 1]]", r#""threshold": [1, 2]"#), &["2 values of `threshold` for 1"]),
        ("", one("[[1, 1]]", r#""threshold": 1, "keep": 1.5"#), &["keeps 1.5"]),
        ("", one("[[1, 1]]", r#""threshold": 1, "leek": 1"#), &["unknown field `leek`"]),
        ("", one("[]", r#""threshold": 1"#), &["layer 1: no weights"]),
        // tinyODIN cannot hold outputs that never fire.
        ("", format!("{{\"weights\": {leaky}}}"), &["readout: tinyODIN has no outputs"]),
        ("--chip reckon", of(&[(257, 2)]), &["256 neurons"]),
        ("--chip reckon", of(&[(17, 2)]), &["16 outputs"]),
    ] {
        let (_directory, command) = driven(&layers, 1.0, options);
        refused(&command, "", words);
    }
    let (hexarotor, roll) = (flight("hexarotor.csv"), peers("roll.nir").display().to_string());
    refused(&network(&hexarotor), "", &["hexarotor.csv: no network", "NIR graph", "JSON"]);
    refused(&network("nowhere.nir"), "", &["nowhere.nir: cannot be opened"]);
    let dt = format!("{} --dt 0.1", network(&roll));
    refused(&dt, "", &["roll.nir: node `lif1`", "3e-2 s is shorter than a step of 0.1 s", "--dt"]);
    let other = format!(
        "network {roll} --scheme position --neurons 10 --reset zero --column gyro_x {hexarotor}"
    );
    refused(&other, "", &["node `lif1` has 20 inputs, but position gives 10"]);
}

#[test]
fn changes_by_a_chip_are_reported_and_a_recording_is_held_out() {
    // A tick of ReckOn leaves at least 0.875 of a neuron's potential, and a step has 16 ticks at most.
    let little = r#"{"weights": [[0.4, -0.3]], "keep": 0.05, "threshold": 0.3}]"#;
    let (_directory, command) = driven(little, 0.05, "--chip reckon");
    let report = good(&command, "").stderr;
    let leaks = "warning: 1 neurons leak otherwise than trained, by up to 0.0681";
    assert!(report.contains(leaks), "{report}");

    let silent = r#"{"weights": [[1, 1]], "threshold": 1e9}]"#;
    let (_directory, command) = driven(silent, 0.1, "--no-held-out");
    let silent = good(&command, "").stderr;
    assert!(silent.contains("warning: no output fires") && !silent.contains("100.0 %"), "{silent}");
    assert!(silent.contains("--held-out shows another"), "{silent}");

    // A leak that halves the potential in each step, which tinyODIN cannot do.
    let low = r#"{"weights": [[0.31, -0.29], [0.27, 0.33]], "keep": 0.5, "threshold": 0.5},
        {"weights": [[0.61, -0.59]], "keep": 0.3, "threshold": 0.55}]"#;
    let (_directory, command) = driven(low, 0.1, "--compare spike");
    let tuned = good(&command, "").stderr;
    let rest = tuned.split("\nheld out:\n").nth(1).unwrap();
    let share = figures(rest, "outputs agree in ")[2];
    assert_eq!(tuned.contains("warning: step by step"), share < 50.0, "{tuned}");
    assert!(share >= 50.0 || tuned.contains("comparing after each spike"), "{tuned}");
    let low = ran!("{command} --held-out {}", flight("vtol_at_rest.csv")).stderr;
    let held_out = low.split("\nheld out:\n").nth(1).unwrap();
    assert!(held_out.starts_with("layer 1: 2, ") && !low.contains("--held-out"), "{low}");
}

/// A file of spikes, one line for each step, can take the place of a recording. With `--live`, steps from standard
/// input are answered by the chip's model, which keeps its potentials between steps.
#[test]
fn a_file_of_spikes_drives_a_network_that_answers_step_by_step() {
    let json = r#"{"layers": [{"weights": [[3, 0], [0, 5]], "threshold": 11.5}]}"#;
    let (_network, network) = file("two.json", json);
    let (_steps, steps) = file("steps.txt", "0 1\n\n1\n0\n1\n0\n0\n");
    let ran = good(&format!("network {network} {steps} {AS_THE_CHIP} --live"), "1\n0 1\n\n1\n1\n");
    let outputs = ran.output.lines().map(|line| line.split(' ').skip(1).collect::<Vec<_>>());
    assert_eq!(outputs.collect::<Vec<_>>(), [vec![], vec![], vec![], vec!["1"], vec![]]);
    // Without leaks, the chip takes no clock cycles for a step without spikes.
    let idle = ran.output.lines().map(|line| line.starts_with('0')).collect::<Vec<_>>();
    assert_eq!(idle, [false, false, true, false, false], "{}", ran.output);
    assert!(ran.stderr.contains("outputs agree in 100.0 % of 7 steps"), "{}", ran.stderr);
    // Without --live, the Rust constant is written to standard output.
    let ran = ran!("network {network} {steps} {AS_THE_CHIP}");
    assert!(ran.output.contains("TinyOdinNetwork<2, 2, 2>"), "{}", ran.output);

    refused(&format!("network {network} {steps} --live"), "2\n", &["2 inputs", "[2]"]);
    let (_odd, odd) = file("odd.txt", "0\n0 x\n");
    refused(&format!("network {network} {odd}"), "", &["line 2", "`x`"]);
    let (_wide, wide) = file("wide.txt", "0 7\n");
    refused(&format!("network {network} {wide}"), "", &["2 inputs", "7"]);
    let reckon = format!("network {network} {steps} --chip reckon --live");
    refused(&reckon, "0\n", &["only tinyODIN"]);
}

/// In the trained network, two input spikes in the same step cancel out if one raises and the other lowers a neuron's
/// potential. On a chip with `--compare spike`, the neuron compares its potential with the threshold after each spike,
/// and may fire between the two. With `--compare step`, the chip's outputs agree in all steps with those of the trained
/// network. The command therefore chooses `--compare step`, although each step then needs more events.
#[test]
fn neurons_compare_once_a_step_if_that_agrees_better() {
    let json = r#"{"layers": [{"name": "one", "weights": [[7, -7], [3, 6]], "threshold": 6.5},
        {"name": "two", "weights": [[7, -1]], "threshold": 5.5}]}"#;
    let (_network, network) = file("two.json", json);
    let steps = (0..300_u32).map(|at| ["0 1", "0", "", "1"][(at * at % 13 % 4) as usize]);
    let steps: Vec<&str> = steps.collect();
    let (_steps, steps) = file("steps.txt", steps.join("\n") + "\n");
    let by_spike = good(&format!("network {network} {steps} --compare spike"), "").stderr;
    let by_spike = figures(&by_spike, "outputs agree in ")[2];
    assert!(by_spike < 90.0, "{by_spike}");
    for compare in ["", "--compare step"] {
        let ran = good(&format!("network {network} {steps} {compare}"), "");
        assert_eq!(ran.stderr.matches("outputs agree in 100.0 % of").count(), 2, "{}", ran.stderr);
        for words in ["pub static STEPS: Steps = Steps {", "inputs: 2,", "TinyOdinNetwork<"] {
            assert!(ran.output.contains(words), "{}", ran.output);
        }
    }
    let live = "0 1\n0\n\n";
    let ran = good(&format!("network {network} {steps} --live"), live);
    assert_eq!(ran.output.lines().count(), 3, "{}", ran.output);
}

/// snnTorch writes the same file for every reset mode. The spikes recorded in snnTorch show the mode: no option is
/// needed, and a wrong one is refused with the right one.
#[test]
fn reset_modes_are_found_by_the_frameworks_spikes() {
    let at = |name: &str| peers("nir").join(name).display().to_string();
    let recorded = fs::read_to_string(at("snntorch.to-value.txt")).unwrap();
    let column = |number: usize| column(&recorded, number);
    let (_inputs, inputs) = file("inputs.txt", column(0));
    let (_outputs, outputs) = file("outputs.txt", column(2));
    let net = at("snntorch.nir");
    refused(&format!("network {net} {inputs}"), "", &["by which rule", "--as", "--reset"]);
    refused(&format!("network {net} {inputs} --as snntorch"), "", &["leaves open", "--reset"]);
    for chip in ["tinyodin", "reckon", "controller"] {
        let network = format!("network {net} {inputs} --trained-spikes {outputs} --on {chip}");
        for rule in
            ["", "--as snntorch", "--as snntorch --reset zero", "--as snntorch --reset to-value"]
        {
            let ran = good(&format!("{network} {rule}"), "");
            assert!(
                ran.stderr
                    .contains("rule found: --as snntorch --reset to-value --fires above gives"),
                "{}",
                ran.stderr
            );
            assert_eq!(figures(&ran.stderr, "in double precision, as the file")[0], 100.0);
        }
        let wrong = format!("{network} --as snntorch --reset subtract-late");
        refused(
            &wrong,
            "",
            &["outputs.txt", "gives all of them by --as snntorch --reset to-value"],
        );
    }
    let (_silent, silent) = file("silent.txt", "\n".repeat(200));
    let network = format!("network {net} {inputs} --trained-spikes {silent} --on controller");
    refused(&network, "", &["silent.txt", "no rule gives the recorded outputs", "part in step"]);
    let few = |text: &str| text.split_inclusive('\n').take(3).collect::<String>();
    let (_few, few_in) = file("in.txt", few(&column(0)));
    let (_fired, few_out) = file("out.txt", few(&column(2)));
    let network = format!("network {net} {few_in} --trained-spikes {few_out} --on controller");
    refused(&network, "", &["rules give the recorded outputs in all 3 steps"]);
    let (_short, short) = file("short.txt", "0\n");
    let short =
        format!("network {net} {inputs} --as snntorch --reset zero --trained-spikes {short}");
    refused(&short, "", &["short.txt", "1 steps", "200"]);
}

/// Returns a column of what a framework recorded, a line for each step.
fn column(recorded: &str, number: usize) -> String {
    let lines = recorded.lines().map(|line| line.split(';').nth(number).unwrap());
    lines.map(|line| line.to_owned() + "\n").collect()
}

/// Outputs of `ReckOn` that never fire are compared with the potentials that they had in training. Sums of whole weights
/// are exact on the chip.
#[test]
fn potentials_are_compared_with_those_of_training() {
    let layers = r#"{"layers": [{"weights": [[1, 0], [0, 1]], "threshold": 0.5}]"#;
    let readout = r#""readout": {"weights": [[2, 0], [0, -1]]}"#;
    let (_real, real) = file("net.json", format!("{layers}, {readout}}}"));
    let (_whole, network) = file("net.json", format!("{layers}, {readout}, \"integers\": true}}"));
    let (_fires, fires) = file("fires.json", format!("{layers}}}"));
    let (_steps, steps) = file("steps.txt", "0\n0 1\n\n");
    let compared = |network: &str, potentials: &str| {
        let (_potentials, potentials) = file("potentials.txt", potentials);
        let network = format!("network {network} {steps} --on reckon --no-held-out");
        good(&format!("{network} --trained-potentials {potentials}"), "").stderr
    };
    let off = |potentials: &str| {
        let report = compared(&network, potentials);
        assert!(!report.contains("in double precision, as the file"), "{report}");
        figures(&report, "readout: 2 outputs")[2]
    };
    assert_eq!(off("2 0\n4 -1\n4 -1\n"), 0.0);
    // Of six potentials one is 6 off.
    assert_eq!(off("2 0\n4 -1\n4 5\n"), 2.4495);
    for (potentials, off) in [("2 0\n4 -1\n4 -1\n", 0.0), ("2 0\n4 -1\n4 5\n", 76.2)] {
        let report = compared(&real, potentials);
        assert_eq!(figures(&report, "in double precision, as the file")[0], off, "{report}");
        assert_eq!(report.contains("may be others"), off > 0.0, "{report}");
    }
    // Norse's potentials tell a wrong `--dt`.
    let at = |name: &str| peers("nir").join(name).display().to_string();
    for (reset, dt) in
        [("to-value", "1e-3"), ("subtract", "1e-3"), ("to-value", "5e-4"), ("subtract", "1.2e-3")]
    {
        let recorded = fs::read_to_string(at(&format!("norse.{reset}.txt"))).unwrap();
        let column = |number: usize| column(&recorded, number);
        let (_inputs, inputs) = file("inputs.txt", column(0));
        let (_outputs, outputs) = file("outputs.txt", column(3));
        let norse = format!("network {} {inputs} --on reckon --as norse", at("norse.nir"));
        let norse = format!("{norse} --reset {reset} --dt {dt} --trained-potentials {outputs}");
        if dt == "1e-3" {
            let report = good(&norse, "").stderr;
            let off = figures(&report, "in double precision, as the file")[0];
            assert_eq!(off, 0.0, "{report}");
        } else {
            // Norse's own step, which is not in the file, is among those that are tried.
            let other = format!("gives all of them by --as norse --reset {reset}");
            refused(&norse, "", &[&other, "--dt 0.001"]);
        }
    }
    for (network, option, outputs, words) in [
        (&network, "potentials", "2 0\n", "outputs of 1 steps, and the recording has 3"),
        (&network, "potentials", "2 0\n4 -1\n4\n", "1 potentials in step 3, and the network has 2"),
        (&network, "potentials", "2 0\n1 x\n", "line 2: `x` is not a finite number"),
        (&network, "potentials", "2 0\n4 nan\n4 -1\n", "line 2: `nan` is not a finite number"),
        (&network, "potentials", "2 0\n4 -1\n-inf 0\n", "line 3: `-inf` is not a finite number"),
        (&network, "potentials", "1e400 0\n", "line 1: `1e400` is not a finite number"),
        (&network, "spikes", "0\n\n\n", "spikes, but the network's outputs never fire"),
        (&fires, "potentials", "2 0\n4 -1\n4 -1\n", "potentials, but the network's outputs fire"),
        (&fires, "spikes", "0\n1\n\n\n", "outputs of 4 steps, and the recording has 3"),
        (&fires, "spikes", "0\n1 2\n\n", "a spike of output 2 in step 2, and the network has 2"),
    ] {
        let (_outputs, outputs) = file("outputs.txt", outputs);
        let network = format!("network {network} {steps} --on reckon --reset zero --no-held-out");
        refused(&format!("{network} --trained-{option} {outputs}"), "", &["outputs.txt: ", words]);
    }
}

/// In the trained network, neurons subtract the threshold before the leak. `ReckOn` subtracts the threshold after the
/// leak. The converted network makes up for the difference by a weight from each neuron to itself.
#[test]
fn a_reset_by_subtraction_is_corrected_for_reckon() {
    let json = r#"{"layers": [{"name": "one", "weights": [[127, -20], [60, 50]], "keep": 0.9,
        "threshold": 127.5}]}"#;
    let (_network, network) = file("one.json", json);
    let steps = ["0", "0 1", "1", "", "0 1"].map(|line| format!("{line}\n")).concat().repeat(40);
    let (_steps, steps) = file("steps.txt", steps);
    for reset in ["subtract", "subtract-late", "zero"] {
        let ran = good(&format!("network {network} {steps} --chip reckon --reset {reset}"), "");
        let share = figures(ran.stderr.split("held out:").nth(1).unwrap(), "outputs agree in ")[2];
        assert!(share > 90.0, "{reset}: {}", ran.stderr);
        let shared = format!("resets_to_zero: {}", reset == "zero");
        assert!(ran.output.contains(&shared), "{}", ran.output);
    }
}

/// The Python example `on_chip.py` trained this network in tinyODIN's arithmetic. In at least 99 % of the steps in
/// which an output fires, the same outputs fire on the chip as in double precision. The potentials on the chip
/// have a lower bound, -2048, and those in double precision have none.
#[test]
fn a_network_trained_in_the_chips_arithmetic_loses_little_on_the_chip() {
    let network = peers("on_chip.json").display().to_string();
    let code = "--scheme sf --threshold 0.05 --columns gyro_x,gyro_y,gyro_z";
    let ran =
        good(&format!("network {network} {code} --compare step {}", flight("hexarotor.csv")), "");
    let held_out = ran.stderr.split("held out:").nth(1).unwrap();
    let [_, _, share, active, ..] = figures(held_out, "outputs agree in ")[..] else {
        panic!("{}", ran.stderr)
    };
    assert!(share >= 99.0 && active > 50.0, "{}", ran.stderr);
}

/// The script `plain.py` trained this network without the chip in mind.
#[test]
fn a_network_that_was_trained_without_the_chip_in_mind_keeps_most_of_its_steps() {
    let network = peers("plain.json").display().to_string();
    let code = "--scheme sf --threshold 0.05 --columns gyro_x,gyro_y,gyro_z";
    for chip in ["tinyodin --compare step", "reckon"] {
        let ran = good(
            &format!("network {network} {code} --chip {chip} {}", flight("hexarotor.csv")),
            "",
        );
        let held_out = ran.stderr.split("held out:").nth(1).unwrap();
        let [_, _, share, active, ..] = figures(held_out, "outputs agree in ")[..] else {
            panic!("{}", ran.stderr)
        };
        assert!(share >= 75.0 && active > 100.0, "{}", ran.stderr);
    }
}

/// Networks of snnTorch and `SpikingJelly`, some of which keep 0.6 of a potential in a step. `ReckOn` cannot do that in
/// one tick, and gates keep its neurons from firing in between.
#[test]
fn reckon_fires_as_frameworks_do_with_several_ticks_a_step() {
    for (name, reset, least) in [
        ("snntorch", "subtract-late", 90.0),
        ("snntorch", "subtract-no-delay", 90.0),
        ("snntorch", "to-value", 90.0),
        ("snntorch_one_to_one", "to-value", 90.0),
        ("snntorch_one_to_one", "subtract-late", 90.0),
        ("snntorch_one_to_one", "subtract-no-delay", 80.0),
        ("spikingjelly", "subtract", 90.0),
        ("spikingjelly", "to-value", 90.0),
        ("spikingjelly_recurrent", "subtract", 90.0),
        ("spikingjelly_recurrent", "to-value", 90.0),
    ] {
        let at = |end: &str| peers("nir").join(format!("{name}.{end}")).display().to_string();
        let recorded = fs::read_to_string(at(&format!("{reset}.txt"))).unwrap();
        let column = |number: usize| column(&recorded, number);
        let (_inputs, inputs) = file("inputs.txt", column(0));
        let (_outputs, outputs) = file("outputs.txt", column(2));
        let framework = name.split('_').next().unwrap();
        let ran = good(
            &format!(
                "network {} {inputs} --as {framework} --reset {reset} --trained-spikes {outputs} --chip reckon",
                at("nir")
            ),
            "",
        );
        let held_out = ran.stderr.split("held out:").nth(1).unwrap();
        let share = figures(held_out, "outputs agree in ")[2];
        assert!(share >= least, "{name} {reset}: {}", ran.stderr);
        assert_eq!(ran.output.matches("ReckOnTick {").count(), 4, "{}", ran.output);
    }
}

/// A reset without a delay takes three of the chip's neurons for each of the network's, and four in a recurrent layer.
/// If they do not fit the chip, the chip's own reset replaces it, and the report says so.
#[test]
fn a_reset_without_a_delay_takes_several_neurons_of_reckon() {
    let steps = ["0 1", "", "", "1", "", "0", ""].map(|line| format!("{line}\n"));
    let (_steps, steps) = file("steps.txt", steps.concat().repeat(30));
    let two = "[127, 60], [-40, 120]";
    let recurrent = r#""recurrent": [[0, -64], [32, 0]],"#;
    let many = ["[127, 60]"; 86].join(",");
    for (weights, more, neurons) in [(two, "", 6), (two, recurrent, 8), (&many, "", 86)] {
        let outputs = vec!["1"; weights.matches('[').count()].join(",");
        let json = format!(
            r#"{{"layers": [{{"weights": [{weights}], {more} "threshold": 64.5, "keep": 0.9}}],
            "readout": {{"weights": [[{outputs}]]}}}}"#,
        );
        let (_network, network) = file("net.json", json);
        let reset = "--chip reckon --reset subtract-no-delay";
        let ran = good(&format!("network {network} {steps} {reset}"), "");
        let held_out = ran.stderr.split("held out:").nth(1).unwrap();
        let [_, _, spikes, _, distance] = figures(held_out, "layer 1: ")[..] else {
            panic!("{}", ran.stderr)
        };
        let fits = neurons < 86;
        assert_eq!(distance < 0.02 * spikes, fits, "{}", ran.stderr);
        assert_eq!(ran.stderr.contains("do not fit"), !fits, "{}", ran.stderr);
        let size = format!("{neurons} of the chip's 256 neurons");
        assert!(ran.stderr.contains(&size) && spikes > 10.0, "{}", ran.stderr);
    }
}

/// Returns a CSV table of roll rates. The script `turns.py` divided the flight into stretches of 250 samples, and held
/// out every third. The table has the held-out stretches if `is_held_out`, otherwise those used for training.
fn stretches(is_held_out: bool) -> String {
    let flight = fs::read_to_string(flight("hexarotor.csv")).unwrap();
    let rows: Vec<&str> = flight.lines().skip(1).collect();
    let chosen = rows.chunks(250).enumerate().filter(|(at, _)| (at % 3 == 2) == is_held_out);
    let rates = chosen.flat_map(|(_, rows)| rows).map(|row| row.split(',').nth(1).unwrap());
    let mut table = "time_s,gyro_x\n".to_owned();
    for (at, rate) in rates.enumerate() {
        writeln!(table, "{},{rate}", at as f64 / 200.0).unwrap();
    }
    table
}

/// The script `turns.py` trained this recurrent network, and printed how many spikes the network fires. The command
/// counts the same number of spikes in double precision. On the chip, the number of spikes differs by less than 3 %.
/// The constant that the command writes equals the one in the firmware `examples/rate-loop`.
#[test]
fn a_recurrent_network_that_was_trained_on_a_flight_goes_onto_reckon() {
    let (_trained, trained) = file("trained.csv", stretches(false));
    let (_held_out, held_out) = file("held_out.csv", stretches(true));
    let (_bytes, bytes) = file("turns.bin", "");
    let turns = peers("turns.nir").display().to_string();
    let ran = ran!(
        "network {turns} --chip reckon --scheme position --neurons 25 --min=-1.2 --max 1.2 --dt 0.005 --reset \
             zero --column gyro_x {trained} --held-out {held_out} --bytes {bytes}"
    );
    // A header; the pairs of neurons; for each neuron its 25 inputs, 32 neurons and 3 outputs.
    assert_eq!(fs::read(bytes).unwrap().len(), 16 + 16 * 4 + 32 * (25 + 32 + 3));
    assert!(
        ran.stderr.contains("32 of the chip's 256 neurons, 25 of its 256 inputs"),
        "{}",
        ran.stderr
    );
    let (tuned, held_out) = ran.stderr.split_once("held out:\n").unwrap();
    for (report, expected) in [(tuned, 2147.0), (held_out, 1365.0)] {
        let of_spikes = report.rsplit_once("\nlayer: neurons").map_or(report, |(_, report)| report);
        let [neurons, clipped, spikes, on_chip, _] = figures(of_spikes, "node `neurons`: ")[..]
        else {
            panic!("{}", ran.stderr)
        };
        assert_eq!((neurons, clipped, spikes), (32.0, 0.0, expected), "{}", ran.stderr);
        assert!((on_chip - spikes).abs() < 0.03 * spikes, "{}", ran.stderr);
        let [_, _, agreeing, _] = figures(report, "outputs agree")[..] else {
            panic!("{}", ran.stderr)
        };
        assert!(agreeing > 97.0, "{}", ran.stderr);
        let of_outputs = report.rsplit("node `outputs`: ").next().unwrap();
        let [_, size, error] = figures(of_outputs, "3 outputs, ")[..] else {
            panic!("{}", ran.stderr)
        };
        assert!(error < 0.15 * size, "{}", ran.stderr);
    }
    let firmware =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/rate-loop/src/turns.rs");
    assert_eq!(ran.output, fs::read_to_string(firmware).unwrap());
}

/// The leaks of the outputs differ, so that the driver leaks them and the chip adds up their weights. Inputs far denser than
/// those of the recording that tuned the network must not bring these sums to the end of their 16 bits.
#[test]
fn outputs_that_the_driver_leaks_take_denser_inputs_than_the_recording() {
    let list = |values: Vec<String>| format!("[{}]", values.join(","));
    let row = |neuron: usize| {
        list((0..16).map(|input| if neuron % 16 == input { "1.5" } else { "0" }.into()).collect())
    };
    let layer = list((0..48).map(row).collect());
    let readout = |weight: &str| list(vec![weight.to_owned(); 48]);
    let (_network, network) = file(
        "dense.json",
        format!(
            "{{\"layers\":[{{\"weights\":{layer},\"keep\":0.9,\"threshold\":1}}],\
             \"readout\":{{\"weights\":[{},{}],\"keep\":[0.5,0.9]}}}}",
            readout("1"),
            readout("-0.5")
        ),
    );
    let (_sparse, sparse) = file("sparse.txt", "0\n5\n\n9\n".repeat(50));
    let (_dense, dense) = file("dense.txt", "0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15\n".repeat(40));
    let ran = good(&format!("network {network} {sparse} --on reckon --held-out {dense}"), "");
    assert!(ran.output.contains("outputs: ReckOnOutputs::Leaky"), "{}", ran.output);
    let (_, held_out) = ran.stderr.split_once("held out:\n").unwrap();
    let [_, size, error] = figures(held_out, "readout: 2 outputs, ")[..] else {
        panic!("{}", ran.stderr)
    };
    assert!(size > 100.0 && error < 0.01 * size, "{}", ran.stderr);
    assert!(!ran.stderr.contains("16 bits"), "{}", ran.stderr);
}

/// A NIR graph whose layers are nested graphs, as snnTorch and Norse write them, gives the same constants as a flat
/// graph, apart from the names of nodes. The weights of a recurrent layer are read too.
#[test]
fn nested_and_recurrent_graphs_are_taken() {
    let whole = good(&network(&peers("roll.nir").display().to_string()), "");
    let nested = good(&network(&peers("nested.nir").display().to_string()), "");
    let body = |output: &str| output.lines().skip(1).map(str::to_owned).collect::<Vec<_>>();
    let named: Vec<_> = body(&nested.output);
    let expected: Vec<_> = body(&whole.output)
        .iter()
        .map(|line| line.replace("node `lif2`", "node `lif2.lif`"))
        .collect();
    assert_eq!(named, expected);

    let recurrent = good(&network(&peers("recurrent.nir").display().to_string()), "");
    let rows = recurrent.output.split("recurrent: &[").nth(1).unwrap();
    // As in the graph, the weight to neuron 0 is negative, and that to neuron 1 is 0.
    let row: Vec<i32> = rows
        .lines()
        .nth(2)
        .unwrap()
        .trim_matches([' ', '[', ']', ','])
        .split(", ")
        .map(|weight| weight.parse().unwrap())
        .collect();
    assert!(row[0] < 0 && row[1] == 0, "{row:?}");
    let [_, _, spikes, on_chip, _] = figures(&recurrent.stderr, "node `lif1.lif`: ")[..] else {
        panic!("{}", recurrent.stderr)
    };
    assert!(spikes > 1_000.0 && (spikes - on_chip).abs() < 0.1 * spikes, "{}", recurrent.stderr);
}

/// A network file that is cut or has a flipped byte is refused, or read as a different network, but never makes the
/// program panic.
#[test]
fn damaged_files_are_refused() {
    let whole = fs::read(peers("roll.nir")).unwrap();
    let (_directory, table) = file("short.csv", "x\n1\n2\n3\n1\n");
    let code = format!("--scheme position --neurons 20 --dt 0.005 --reset zero --column x {table}");
    let mut refusals = 0;
    for at in (8..whole.len()).step_by(whole.len() / 60) {
        let mut flipped = whole.clone();
        flipped[at] ^= 0x55;
        for bytes in [&whole[..at], &flipped] {
            let (_directory, path) = file("damaged.nir", bytes);
            let ran = spikewire(&format!("network {path} {code}"), "");
            assert!([0, 2].contains(&ran.status), "{at}: {} {}", ran.status, ran.stderr);
            refusals += usize::from(ran.status == 2);
        }
    }
    assert!(refusals >= 60, "{refusals}");
}

/// Files written by the Python package `nir` are read. A faulty file is refused with a message that names the faulty
/// node. `cargo verify peers` runs this test.
#[test]
#[ignore = "needs PEERS_PYTHON with nir"]
fn files_of_pypis_nir_are_read_and_what_is_wrong_is_named() {
    let python = std::env::var("PEERS_PYTHON").unwrap();
    let directory = tempfile::tempdir().unwrap();
    let written = |name: &str, fault: &[&str]| {
        let path = directory.path().join(name);
        let mut script = Command::new(&python);
        let status = script.arg(peers("roll.py")).arg(&path).args(fault).status().unwrap();
        assert!(status.success(), "{fault:?}");
        path.display().to_string()
    };
    let kept = good(&network(&peers("roll.nir").display().to_string()), "");
    let fresh = good(&network(&written("roll.nir", &[])), "");
    assert_eq!(fresh.output, kept.output);
    let short = good(&network(&written("short.nir", &["short"])), "");
    let body = |output: &str| output.lines().skip(1).map(str::to_owned).collect::<Vec<_>>();
    assert_eq!(body(&short.output), body(&kept.output), "a current of a step is none");
    for (fault, words) in [
        ("cuba", "node `lif2`: a spike's current lasts: a step leaves 0.995 of it"),
        ("odd", "node `lif2` (Threshold): nothing here has anything like it"),
        ("back", "node `lif2` leads to 2 nodes"),
        ("deep", "4 layers, of which 3 at most"),
        ("nan", "node `lif2`"),
        ("narrow", "node `lif2`: weights for 11 inputs, but node `lif1` has 12 neurons"),
        ("unweighted", "node `lif1` (LIF): no weights lead to it"),
        ("wide", "node `lif1`: the chip has 256 neurons"),
    ] {
        refused(&network(&written("bad.nir", &[fault])), "", &["bad.nir", words]);
    }
}
