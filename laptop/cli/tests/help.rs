//! `--help`: each command has an example whose options it accepts, and a text for each option.

mod common;

use common::{good, ran};

const COMMANDS: [&str; 14] = [
    "encode", "dataset", "decode", "listen", "convert", "score", "bench", "plot", "network",
    "info", "signal", "tune", "advise", "frames",
];

#[test]
fn every_command_has_an_example_that_its_options_allow() {
    for command in COMMANDS {
        let help = ran!("{command} --help").output;
        let examples: Vec<&str> =
            help.lines().filter_map(|line| line.trim().strip_prefix("spikewire ")).collect();
        assert!(!examples.is_empty(), "{command}: {help}");
        for example in examples {
            let mut words = example.split([' ', '|']).filter(|word| word.starts_with("--"));
            let command = example.split(' ').next().unwrap();
            let help = ran!("{command} --help").output;
            if example.contains('|') {
                continue;
            }
            assert!(words.all(|word| help.contains(word)), "{example}");
        }
    }
}

#[test]
fn every_option_says_what_it_means() {
    for command in COMMANDS {
        let help = ran!("{command} -h").output;
        let options = help.lines().map(str::trim_start).filter(|line| line.starts_with("--"));
        for option in options {
            let words = option.split_once("  ").map_or("", |(_, words)| words.trim());
            assert!(words.len() > 8, "{command}: {option}");
        }
    }
    let encode = good("encode --help", "").output;
    assert!(encode.contains("in the signal's unit, such as `0.1`"), "{encode}");
}

#[test]
fn listen_offers_what_it_takes() {
    let help = good("listen --help", "").output;
    for taken in
        ["--threshold ", "--thresholds", "--filter", "--neurons", "--edges", "sf:", "grf:", "ttfs:"]
    {
        assert!(help.contains(taken), "{taken}");
    }
    // Options that only an encoder uses.
    for other in ["--factor", "--magnitudes", "--paper"] {
        assert!(!help.contains(other), "{other}");
    }
}
