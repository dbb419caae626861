//! The codes against the reference, as one program: what its files share is compiled and linked once.

mod common;

mod adaptive_contrast;
mod adaptive_step_forward;
mod bank;
mod bernoulli;
mod bsa;
mod bsa_toolbox;
mod built;
mod burst;
mod calibration;
mod closure;
mod config_errors;
mod dynamic;
mod every_scheme;
mod filter;
mod first_spike;
mod histogram;
mod hough;
mod integrate;
mod latency_phase;
mod laws;
mod lif;
mod moments;
mod moving_window;
mod nonlinear;
mod population_sizes;
mod position;
mod probabilistic;
mod rank_order;
mod rate_decoder;
mod samples;
mod send_on_delta;
mod serde;
mod sigma_delta;
mod slots;
mod states;
mod statics;
mod step_forward;
mod survey;
mod taps;
mod temporal_contrast;
mod threshold_hough;
mod weighted_burst;
mod weighted_phase;

/// A check on another machine draws what it draws on this one.
#[test]
fn seeds_are_fixed() {
    let seed = common::cases(1).rng_seed;
    assert!(matches!(seed, proptest::test_runner::RngSeed::Fixed(_)), "run tests through cargo");
}

/// A file that is in no list would be no test.
#[test]
fn every_file_is_listed() {
    let tests = concat!(env!("CARGO_MANIFEST_DIR"), "/tests");
    let lists = [include_str!("codes.rs"), include_str!("wire.rs")].concat();
    let programs = include_str!("../Cargo.toml");
    for entry in std::fs::read_dir(tests).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_stem().unwrap().to_str().unwrap();
        let is_listed = lists.contains(&format!("mod {name};\n"));
        let is_program = programs.contains(&format!("path = \"tests/{name}.rs\"\n"));
        let is_world = path.extension().is_none_or(|extension| extension != "rs");
        assert!(is_listed || is_program || is_world, "no program has tests/{name}");
    }
}
