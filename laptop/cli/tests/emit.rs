//! `emit c` writes a crate whose codecs have the names and the parameters of the given files.

mod common;

use common::{file, ran, refused};
use std::fs;

const SF: &str = "scheme = \"sf\"\nsample = \"q8.8\"\nthreshold = 0.35\n";
const HSA: &str = "scheme = \"hsa\"\nfilter = [0.5, 1.0, 0.5]\nshift = -6\n";

#[test]
fn a_codec_has_its_files_name_and_its_parameters_are_a_constant() {
    let ((_a, roll), (_b, yaw)) = (file("Roll-rate.toml", SF), file("yaw.toml", HSA));
    let directory = tempfile::tempdir().unwrap();
    let output = directory.path().join("flown");
    ran!("emit c {roll} {yaw} -o {}", output.display());
    let read = |path: &str| fs::read_to_string(output.join(path)).unwrap();
    let codecs = read("src/codecs.rs");
    for line in [
        "    roll_rate: spikewire::temporal::StepForward<fixed::types::I8F8> {",
        "        constant spikewire::temporal::StepForward::new(fixed::types::I8F8::from_bits(90));",
        "    yaw: spikewire::rate::Hough<f32, 3> {",
    ] {
        assert!(codecs.lines().any(|found| found == line), "{line}\n{codecs}");
    }
    let manifest: toml::Table = read("Cargo.toml").parse().unwrap();
    assert_eq!(manifest["package"]["name"].as_str(), Some("flown"));
    assert_eq!(manifest["dependencies"]["spikewire-c"]["default-features"].as_bool(), Some(false));

    // An existing directory is not overwritten.
    refused(&format!("emit c {roll} -o {}", output.display()), "", &["cannot be written"]);
}
