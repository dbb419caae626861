//! All comparisons with the reference, as one program: what they share is compiled and linked once.

mod bus;
mod common;
mod interleaving_world;

mod bank;
mod bsa;
mod bsa_toolbox;
mod burst;
mod calibration;
mod chip_akd1500;
mod chip_faults;
mod chip_handshake;
mod chip_network;
mod chip_reckon;
mod chip_reckon_pairs;
mod chip_search;
mod chip_silicon;
mod chip_words;
mod chip_xylo;
mod closure;
mod config_errors;
mod defmt;
mod dynamic;
mod first_spike;
mod formats_bytes;
mod formats_peers;
mod formats_pixels;
mod frames;
mod gaussian;
mod heapless;
mod histogram;
mod hough;
mod interleaving;
mod latency_phase;
mod laws;
mod link_adaptive;
mod link_bytes;
mod link_drift;
mod link_frames;
mod link_loss;
mod link_outage;
mod link_readout;
mod link_receiver;
mod link_time;
mod moments;
mod moving_window;
mod nonlinear;
mod population_sizes;
mod position;
mod probabilistic;
mod queue;
mod rank_order;
mod rooms;
mod samples;
mod serde;
mod sink_bus;
mod slots;
mod states;
mod statics;
mod step_forward;
mod survey;
mod taps;
mod temporal_contrast;
mod threshold_hough;
mod transcriptions;
mod weighted_phase;

/// The signals that codecs are counted on.
#[allow(clippy::pedantic, dead_code, unreachable_pub)]
#[path = "../../examples/bench-target/src/signal.rs"]
mod signal;

/// What the firmware program `camera` prints.
#[allow(clippy::pedantic, dead_code, unreachable_pub)]
#[path = "../../examples/camera/src/lib.rs"]
mod camera;

/// A check on another machine draws what it draws on this one.
#[test]
fn seeds_are_fixed() {
    let seed = common::cases(1).rng_seed;
    assert!(matches!(seed, proptest::test_runner::RngSeed::Fixed(_)), "run tests through cargo");
}

/// A file that is not in the list above would be no test.
#[test]
fn every_file_is_listed() {
    let tests = concat!(env!("CARGO_MANIFEST_DIR"), "/tests");
    for entry in std::fs::read_dir(tests).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_stem().unwrap().to_str().unwrap();
        let listed = include_str!("main.rs").contains(&format!("mod {name};\n"));
        assert!(
            listed || ["main", "faults", "loom"].contains(&name),
            "tests/{name} is not in tests/main.rs"
        );
    }
}
