//! `network --on controller`: the converted networks fire as in the frameworks that trained them. The tests cover the
//! update rule of each framework.
//!
//! The files `lif*` and `braille*` in `peers/nir` come from the repository of NIR (BSD 3-Clause, 2023, NIR Team). The
//! script `peers/frameworks.py` wrote the other files there.

mod common;

use common::{file, good, ran, refused};
use lab::network::{Asked, Current, File, Fires, Framework, Model, Outputs, Reset, Trains};
use std::fs;
use std::path::{Path, PathBuf};

fn nir(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/peers/nir").join(name)
}

fn text(name: &str) -> String {
    fs::read_to_string(nir(name)).unwrap()
}

fn spikes(text: &str) -> Vec<u16> {
    text.split_whitespace().map(|number| number.parse().unwrap()).collect()
}

fn trains(name: &str) -> Trains {
    text(name).lines().map(spikes).collect()
}

fn model(name: &str, asked: &Asked) -> Model {
    File::read(&nir(name)).unwrap().on_controller(asked).unwrap()
}

fn by(framework: Framework) -> Asked {
    Asked { framework: Some(framework), ..Asked::default() }
}

/// Returns the number of spikes that only one of the two spike trains has.
fn differing(one: &Trains, other: &Trains) -> usize {
    let only = |a: &[u16], b: &[u16]| a.iter().filter(|neuron| !b.contains(neuron)).count();
    assert_eq!(one.len(), other.len());
    one.iter().zip(other).map(|(one, other)| only(one, other) + only(other, one)).sum()
}

/// Two recurrent networks for reading Braille were published with the spikes of their hidden layers. Here, these layers
/// fire exactly the same spikes, in the controller's arithmetic and in double precision.
#[test]
fn networks_that_snntorch_trained_fire_as_was_published() {
    let inputs = trains("braille.txt");
    for (name, reset, other) in [
        ("braille_bias_zero", Reset::ToValue, Reset::SubtractNoDelay),
        ("braille_subtract", Reset::SubtractNoDelay, Reset::Subtract),
    ] {
        let run = |reset| {
            let asked = Asked { resets: vec![reset], ..by(Framework::SnnTorch) };
            let model = model(&format!("{name}.nir"), &asked);
            (model.run_as_flown(&inputs).0, model.run(&inputs))
        };
        let expected = trains(&format!("{name}.spikes.txt"));
        assert!(expected.len() == 256 && expected.iter().flatten().count() > 100);
        let (flown, double) = run(reset);
        assert_eq!(differing(&flown[0], &expected), 0, "{name}");
        assert_eq!(differing(&double[0], &expected), 0, "{name}");
        // With a wrong reset mode, spikes differ.
        assert!(differing(&run(other).0[0], &expected) > 40, "{name}");
    }
}

/// Over 1000 steps, the potentials of one neuron equal those that the frameworks recorded: within 1e-7 for Norse, bit
/// for bit for the others.
#[test]
fn one_neuron_has_the_potentials_that_were_published() {
    let table = text("lif.csv");
    let rows = table.lines().skip(1).map(|line| line.split(',').collect::<Vec<_>>());
    let rows: Vec<_> = rows.collect();
    let inputs = rows.iter().map(|row| if row[0] == "0" { vec![] } else { vec![0] }).collect();
    let exponential =
        |framework| Asked { fires: Some(Fires::Above), dt: Some(1e-4), ..by(framework) };
    for (column, asked, spikes, least) in [
        // Norse adds in a different order, v + dt / tau * (x + v_leak - v), and rounds differently.
        (1, Asked { dt: Some(1e-4), ..by(Framework::Norse) }, [460, 510, 710, 760], 0),
        (
            2,
            Asked { resets: vec![Reset::ToValue], ..by(Framework::SnnTorch) },
            [460, 510, 710, 760],
            1000,
        ),
        (3, exponential(Framework::Rockpool), [450, 500, 710, 760], 1000),
        (4, exponential(Framework::Sinabs), [450, 500, 710, 760], 1000),
    ] {
        let (fired, potentials) = model("lif.nir", &asked).run_as_flown(&inputs);
        let fired: Vec<usize> = (0..1000).filter(|&at| !fired[0][at].is_empty()).collect();
        assert_eq!(fired, spikes, "{asked:?}");
        let published = rows.iter().map(|row| row[column].parse::<f32>().unwrap());
        let pairs: Vec<_> = published.zip(&potentials).map(|(v, found)| (v, found[0])).collect();
        let exact = pairs.iter().filter(|(v, found)| v.to_bits() == found.to_bits()).count();
        assert!(exact >= least, "{asked:?}: {exact}");
        assert!(pairs.iter().all(|(v, found)| (v - found).abs() < 1e-7), "{asked:?}");
    }
}

/// Over 200 steps, networks fire exactly as in the framework that wrote their file. The potentials of their outputs
/// differ from the framework's by at most 2e-5.
#[test]
fn networks_fire_as_their_frameworks_do() {
    use Reset::{NoReset, Subtract, SubtractLate, SubtractNoDelay, ToValue, ToValueLate};
    let torch = |reset| Asked { resets: vec![reset], ..by(Framework::SnnTorch) };
    // In snnTorch 1.0.0, RSynaptic resets late whatever its argument `reset_delay`.
    let mixed = |first, last| Asked { resets: vec![first, last], ..by(Framework::SnnTorch) };
    let norse = Asked { dt: Some(1e-3), current: Some(Current::Whole), ..by(Framework::Norse) };
    let subtracting = |asked: &Asked| Asked { resets: vec![Subtract], ..asked.clone() };
    let jelly = by(Framework::SpikingJelly);
    let mut ambiguous = Vec::new();
    for (name, reset, asked) in [
        ("snntorch", "subtract-late", torch(SubtractLate)),
        ("snntorch", "to-value-late", torch(ToValueLate)),
        ("snntorch", "subtract-no-delay", torch(SubtractNoDelay)),
        ("snntorch", "to-value", torch(ToValue)),
        ("snntorch", "none", torch(NoReset)),
        ("snntorch_recurrent", "subtract-late", torch(SubtractLate)),
        ("snntorch_recurrent", "to-value-late", torch(ToValueLate)),
        ("snntorch_recurrent", "subtract-no-delay", mixed(SubtractLate, SubtractNoDelay)),
        ("snntorch_recurrent", "to-value", mixed(ToValueLate, ToValue)),
        ("snntorch_recurrent", "none", torch(NoReset)),
        ("snntorch_one_to_one", "subtract-late", torch(SubtractLate)),
        ("snntorch_one_to_one", "to-value-late", torch(ToValueLate)),
        ("snntorch_one_to_one", "subtract-no-delay", torch(SubtractNoDelay)),
        ("snntorch_one_to_one", "to-value", torch(ToValue)),
        ("snntorch_one_to_one", "none", torch(NoReset)),
        ("spikingjelly", "to-value", jelly.clone()),
        ("spikingjelly", "subtract", subtracting(&jelly)),
        ("spikingjelly_cuba", "to-value", jelly.clone()),
        ("spikingjelly_recurrent", "to-value", jelly.clone()),
        ("spikingjelly_recurrent", "subtract", subtracting(&jelly)),
        ("norse", "to-value", norse.clone()),
        ("norse", "subtract", subtracting(&norse)),
        ("norse_cell", "to-value", norse.clone()),
        ("norse_if", "to-value", norse.clone()),
        ("norse_recurrent", "to-value", norse.clone()),
    ] {
        let steps = text(&format!("{name}.{reset}.txt"));
        let steps: Vec<Vec<&str>> = steps.lines().map(|line| line.split(';').collect()).collect();
        let column = |at: usize| -> Trains { steps.iter().map(|step| spikes(step[at])).collect() };
        let (fired, potentials) = model(&format!("{name}.nir"), &asked).run_as_flown(&column(0));
        // The outputs that the framework recorded show the rule, whether its name is given or not.
        let outputs = if name.starts_with("norse") {
            let recorded = steps.iter().map(|step| step[3].split(' '));
            Outputs::Potentials(
                recorded.map(|step| step.map(|v| v.parse().unwrap()).collect()).collect(),
            )
        } else {
            Outputs::Spikes(column(2))
        };
        for framework in [asked.framework, None] {
            let file = File::read(&nir(&format!("{name}.nir"))).unwrap();
            let open = Asked { framework, dt: asked.dt, ..Asked::default() };
            let found = match file.find_rule(&open, &column(0), &outputs) {
                Ok(found) => found.unwrap(),
                // Two outputs that fire seldom cannot tell all rules apart: then the error names those that fit.
                Err(error) => {
                    let words = error.to_string();
                    assert!(words.contains("rules give"), "{name} {reset}: {words}");
                    assert!(
                        words.contains(&format!("`reset` {reset} ")),
                        "{name} {reset}: {words}"
                    );
                    ambiguous.push(format!("{name} {reset} {framework:?}"));
                    continue;
                }
            };
            let by_found = file.on_controller(&found.asked).unwrap().run_as_flown(&column(0));
            assert_eq!(by_found.0, fired, "{name} {reset}: {found:?}");
            if name.starts_with("norse") {
                assert_eq!(by_found.1, potentials, "{name} {reset}: {found:?}");
            }
        }
        assert!(steps.len() == 200 && column(1).iter().flatten().count() > 100, "{name}");
        assert_eq!(differing(&fired[0], &column(1)), 0, "{name} {reset}");
        assert_eq!(differing(&fired[1], &column(2)), 0, "{name} {reset}");
        // SpikingJelly starts at its reset value, -0.25, relative to which potentials are kept here.
        let start = if name == "spikingjelly_cuba" { -0.25 } else { 0.0 };
        for (step, found) in steps.iter().zip(&potentials) {
            let expected = step[3].split(' ').map(|v| v.parse::<f32>().unwrap() - start);
            let off = expected.zip(found).map(|(v, found)| (v - found).abs()).fold(0.0, f32::max);
            assert!(off < 2e-5, "{name} {reset}: {off}");
        }
    }
    // 43 of the 50 recordings leave one rule.
    assert_eq!(ambiguous.len(), 7, "{ambiguous:?}");
}

/// Neurons that rest at 0.1 with a threshold of 0.4 become neurons that rest at 0 with a threshold of 0.3. A spike
/// still subtracts 0.4, as in the file.
#[test]
fn a_spike_subtracts_the_files_threshold_wherever_a_neuron_rests() {
    let (_directory, spikes) = common::file("spikes.txt", "0 2 5\n1 4\n\n".repeat(20));
    let norse = nir("norse.nir");
    let ran = ran!(
        "network {} --on controller --as norse --dt 0.001 --reset subtract {spikes}",
        norse.display()
    );
    assert!(ran.output.contains(", 0.3).with_reset(0.4)"), "{}", ran.output);
}

fn network(name: &str, options: &str) -> String {
    format!(
        "network {} --on controller {options} {}",
        nir(name).display(),
        nir("braille.txt").display()
    )
}

#[test]
fn a_file_that_does_not_say_the_rule_is_refused_with_the_choices() {
    for (name, options, words) in [
        (
            "braille_subtract.nir",
            "",
            &["--as snntorch|", "--reset", "--fires", "--decay", "--current", "--dt"][..],
        ),
        ("braille_subtract.nir", "--as snntorch", &["subtract-late (its default)"]),
        ("braille_subtract.nir", "--as norse", &["LIFCell", "--dt SECONDS"]),
        ("braille_subtract.nir", "--as sinabs", &["--fires above (v > threshold) or at"]),
        (
            "braille_subtract.nir",
            "--as nir --dt 1e-4",
            &["--reset to-value (NIR's definition) or subtract"],
        ),
        // A step of 0.1 s is longer than the time constants in the file.
        (
            "norse.nir",
            "--as norse --dt 0.1",
            &["e-3 s is shorter than a step of 0.1 s", "--dt 0.01"],
        ),
        ("spikingjelly.nir", "--as spikingjelly --dt 0.1", &["shorter than a step of 0.1 s"]),
    ] {
        refused(&network(name, options), "", words);
    }
    // The message names only options that `--as` leaves open.
    let report = common::spikewire(&network("braille_subtract.nir", "--as snntorch"), "").stderr;
    assert!(!report.contains("--fires") && !report.contains("--dt"), "{report}");
    let chip = network("braille_subtract.nir", "--as snntorch --reset zero")
        .replace("controller", "tinyodin");
    refused(&format!("{chip} --numbers i8"), "", &["--on controller"]);
    let chip =
        network("snntorch.nir", "--as snntorch --reset none").replace("controller", "tinyodin");
    refused(&chip, "", &["--reset none is for the controller"]);
}

#[test]
fn a_file_that_the_framework_would_not_write_is_reported() {
    // A file for Norse, with a gain that snnTorch never writes.
    let (_one, one) = file("one.txt", "0\n\n0\n");
    let lif = nir("lif.nir").display().to_string();
    let report = ran!("network {lif} --on controller --as snntorch --reset to-value {one}").stderr;
    assert!(report.contains("a gain of 0.040000, where snnTorch writes 1"), "{report}");
}

/// The Rust module equals the one in the firmware `examples/trained`, which `cargo verify all-cores` compiles for every
/// core.
#[test]
fn a_network_becomes_the_module_of_the_firmware() {
    let options = "--as snntorch --reset subtract-no-delay";
    let ran = good(&network("braille_subtract.nir", options), "");
    let firmware =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/trained/src/braille.rs");
    assert_eq!(ran.output, fs::read_to_string(firmware).unwrap());
    for words in [
        "10568 bytes of flash for weights and neurons, 520 bytes of RAM",
        "node `lif1.lif`: 40, 0; 118, 118, 0.0",
        "outputs agree in 100.0 % of 256 steps",
        "a step adds 105.9 weights, 407 at most, and visits 47 neurons",
    ] {
        assert!(ran.stderr.contains(words), "{}", ran.stderr);
    }
    // Weights of 8 bits take a quarter of the flash, and fire almost the same.
    let held_out = format!("--held-out {}", nir("braille.txt").display());
    let ran =
        good(&network("braille_subtract.nir", &format!("{options} --numbers i8 {held_out}")), "");
    assert!(ran.output.contains("Weights::packed(") && ran.output.contains("pub const UNITS"));
    let report = ran.stderr.split_once("held out:\n").unwrap().1;
    let share = report.split("outputs agree in ").nth(1).unwrap().split(' ').next().unwrap();
    assert!(share.parse::<f64>().unwrap() > 95.0, "{}", ran.stderr);
}

/// A network in JSON needs no options for its update rule, the order of decay, firing and reset. If the outputs never
/// fire, the report compares their potentials on the controller with those in double precision.
#[test]
fn json_goes_onto_the_controller_and_answers_step_by_step() {
    let json = r#"{"layers": [{"weights": [[3, 0], [0, 5]], "threshold": 5.5}], "readout": {"weights": [[1, -2]]}}"#;
    let (_network, network) = file("two.json", json);
    let (_steps, steps) = file("steps.txt", "0 1\n1\n0\n0\n1\n");
    let ran = good(&format!("network {network} --on controller {steps} --live"), "1\n1\n0 0\n");
    // Each line is the number of weights added: two for each input, one for each spike.
    assert_eq!(ran.output, "2\n3\n5\n");
    for (numbers, off) in [("f32", "0.0000"), ("i8", "0.0005")] {
        let ran = ran!("network {network} --on controller --numbers {numbers} {steps}");
        assert!(ran.output.contains("pub type Trained = Then<Layer1, Layer2>;"), "{}", ran.output);
        let potentials = format!("potentials of 1.1832, on the chip {off} off");
        assert!(ran.stderr.contains(&potentials), "{}", ran.stderr);
    }
    let bytes = format!("network {network} --on controller {steps} --bytes {network}.bytes");
    refused(&bytes, "", &["compiled in"]);
}
