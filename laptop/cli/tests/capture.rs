//! The part of `capture` that can be tested without a debug probe: its errors.

mod common;

use common::refused;

#[cfg(not(feature = "capture"))]
#[test]
fn a_build_without_it_says_how_to_get_it() {
    refused("capture --chip RP2040", "", &["no `capture`", "--features capture"]);
}

#[cfg(feature = "capture")]
#[test]
fn chips_and_probes_that_are_not_there() {
    refused("capture --chip STM32X1", "", &["--chip STM32X1", "not found"]);
    refused("capture --chip RP2040 --seconds 0", "", &["--seconds 0", "above 0"]);
    refused("capture --chip RP2040 --probe what", "", &["--probe what"]);
    let path = std::env::temp_dir().join("spikewire-never-captured");
    let options = format!("--probe 0001:0001 -o {}", path.display());
    refused(&format!("capture --chip RP2040 {options}"), "", &["no debug probe found"]);
    assert!(!path.exists());
}
