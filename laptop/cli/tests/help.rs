//! `--help`: each command has an example whose options it accepts, and a text for each option.

mod common;

use common::{good, ran};

const COMMANDS: [&str; 17] = [
    "advise", "score", "tune", "encode", "decode", "info", "samples", "plot", "dataset", "emit",
    "listen", "capture", "convert", "frames", "network", "signal", "bench",
];

#[test]
fn every_command_has_an_example_that_its_options_allow() {
    for command in COMMANDS {
        let help = ran!("{command} --help").output;
        let examples: Vec<&str> =
            help.lines().filter_map(|line| line.trim().strip_prefix("spikewire ")).collect();
        assert!(examples.len() >= 2, "{command}: {help}");
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
        let lines: Vec<&str> = help.lines().collect();
        for (place, line) in lines.iter().enumerate() {
            // Lines of a text that go on are indented further.
            let Some(option) = line.strip_prefix("      ").filter(|own| own.starts_with("--"))
            else {
                continue;
            };
            let beside = option.split_once("  ").map_or("", |(_, words)| words.trim());
            let below = lines.get(place + 1).map_or("", |line| line.trim());
            let words = if beside.is_empty() { below } else { beside };
            assert!(words.len() > 8, "{command}: {option}");
        }
    }
    let encode = good("encode --help", "").output;
    let encode = encode.split_whitespace().collect::<Vec<_>>().join(" ");
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

/// Returns the help of a command as a terminal of 80 columns shows it.
fn help_in_80_columns(arguments: &str) -> String {
    let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_spikewire"));
    let done = command.args(arguments.split(' ')).env("COLUMNS", "80").output().unwrap();
    assert!(done.status.success(), "{arguments}");
    String::from_utf8(done.stdout).unwrap()
}

/// Lines of 80 columns are broken between words. Only an example, which is to be copied, may be longer.
#[test]
fn no_word_is_broken_at_80_columns() {
    for help in ["-h", "--help"] {
        for command in COMMANDS {
            let text = help_in_80_columns(&format!("{command} {help}"));
            for line in text.lines().filter(|line| !line.trim_start().starts_with("spikewire ")) {
                assert!(line.chars().count() <= 80, "{command} {help}: {line}");
            }
        }
    }
}

#[test]
fn the_first_page_has_the_commands_by_task() {
    let page = help_in_80_columns("-h");
    assert!(page.lines().count() <= 48, "{page}");
    assert!(page.lines().all(|line| line.chars().count() <= 80), "{page}");
    let named: Vec<&str> = page
        .lines()
        .take_while(|line| *line != "Options:")
        .filter_map(|line| line.strip_prefix("  ")?.split_whitespace().next())
        .collect();
    assert_eq!(named, COMMANDS);
    for example in page.lines().filter_map(|line| line.strip_prefix("  spikewire ")) {
        let (command, _) = example.split_once(' ').unwrap();
        assert!(COMMANDS.contains(&command), "{example}");
    }
}
