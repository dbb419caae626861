//! The examples of the README and of the book's how-to pages run as they stand there.

#![cfg(unix)]

mod common;

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::Command;

/// What stands in an example that cannot run here: files of the reader's own, boards, and work of minutes.
const NOT_HERE: [&str; 9] = [
    "flight.ulg",
    "clip.",
    "frames pictures",
    "spikewire listen",
    "spikewire capture",
    "signal --seconds",
    "trained.nir",
    "turns.nir",
    "spikewire bench",
];

/// Returns the texts of the README and of the how-to pages.
fn pages() -> Vec<String> {
    let crate_directory = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut paths = vec![crate_directory.join("README.md")];
    for page in fs::read_dir(crate_directory.join("../../docs/how-to")).unwrap() {
        paths.push(page.unwrap().path());
    }
    paths.iter().map(|path| fs::read_to_string(path).unwrap()).collect()
}

/// Returns the commands of a page: its lines in blocks of `sh`, with those that a backslash joins as one.
fn commands(text: &str) -> Vec<String> {
    let mut all = Vec::new();
    let (mut is_within, mut is_open) = (false, false);
    for line in text.lines() {
        match line {
            "```sh" => is_within = true,
            "```" => is_within = false,
            _ if is_within => {
                let (own, goes_on) = match line.strip_suffix('\\') {
                    Some(own) => (own, true),
                    None => (line, false),
                };
                if is_open {
                    let last: &mut String = all.last_mut().unwrap();
                    last.push_str(own);
                } else {
                    all.push(own.to_owned());
                }
                is_open = goes_on;
            }
            _ => {}
        }
    }
    all
}

/// Each command that needs nothing but the repository's own recordings succeeds. Searches are shortened: they need not
/// find the best.
#[test]
fn the_examples_of_the_pages_succeed() {
    let directory = tempfile::tempdir().unwrap();
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data").canonicalize().unwrap();
    std::os::unix::fs::symlink(data, directory.path().join("data")).unwrap();
    let programs = Path::new(env!("CARGO_BIN_EXE_spikewire")).parent().unwrap().to_owned();
    let path = std::env::var("PATH").unwrap();
    let mut count = 0;
    // Each once, and a page's own in their order, as one may read what another wrote.
    let mut seen = BTreeSet::new();
    let mut all: Vec<String> = pages().iter().flat_map(|page| commands(page)).collect();
    all.retain(|command| seen.insert(command.clone()));
    for command in all {
        let is_here = !NOT_HERE.iter().any(|words| command.contains(words));
        if !(command.starts_with("spikewire ") && is_here) {
            continue;
        }
        let is_search =
            ["spikewire tune ", "spikewire advise "].iter().any(|own| command.starts_with(own));
        let short = if is_search { " --evaluations 60" } else { "" };
        let ran = Command::new("sh")
            .args(["-c", &format!("{command}{short}")])
            .current_dir(directory.path())
            .env("PATH", format!("{}:{path}", programs.display()))
            .output()
            .unwrap();
        assert!(ran.status.success(), "{command}: {}", String::from_utf8_lossy(&ran.stderr));
        count += 1;
    }
    // Of the first block all but the ULog's and the board's, and the block of `tune`.
    assert!(count >= 12, "{count}");
}
