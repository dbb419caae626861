//! Runs the program on the cases in the directory `said`, one case on each line, and checks what it prints.
//!
//! - `command << input => words | words`: the command fails, and standard error contains each of the words.
//! - `command << input -> words | !words`: the command succeeds, and its outputs contain each of the words, but none
//!   that follow a `!`.
//! - `command << input == text`: the command succeeds, and writes exactly this text.
//!
//! ` |> ` pipes the output of one command into the next. `\n`, `\r`, `\t`, `\\` and `\u202e` are escapes. `NAME := text` defines
//! a name for a text; `@NAME := text` writes the text to a file, and the name stands for the file's path; `{NAME}`
//! inserts the text or the path.

mod common;

use common::{RanBytes, flight, flight_logs, good_bytes, spikewire_bytes, table};
use flight_logs::made::{KINDS, blackbox, dataflash, dataflash_text, tlog};
use std::fs;
use std::path::Path;

/// Names that the cases may use, each with the text that replaces `{name}` in a case. This text may itself contain
/// names that stand earlier in the list.
type Names = Vec<(String, String)>;

/// Returns the names that the cases in the directory `said` may use, each with its text. Some texts are paths of sample
/// logs. The function writes these logs into `directory`.
fn names(directory: &Path) -> Names {
    let wave = |size: f64| -> Vec<f64> {
        (0..500).map(|sample| (f64::from(sample) * 0.05).sin() * size).collect()
    };
    let [log, _] = flight_logs();
    let mut names = vec![
        ("hexarotor".to_owned(), flight("hexarotor.csv")),
        ("log".to_owned(), log.display().to_string()),
        ("dir".to_owned(), directory.display().to_string()),
        ("wave".to_owned(), table(&wave(20.0))),
        ("low wave".to_owned(), table(&wave(2.0))),
    ];
    let mut write = |name: &str, content: &[u8]| {
        let path = directory.join(name);
        fs::write(&path, content).unwrap();
        names.push((name.to_owned(), path.display().to_string()));
    };
    for kind in KINDS {
        write(kind.name(), &kind.log("none"));
    }
    write("log.bbl", &blackbox());
    write("log.bin", &dataflash());
    write("log.log", dataflash_text().as_bytes());
    write("log.tlog", &tlog());
    names
}

/// Replaces each `{name}` in a text by the text that it stands for.
fn plain(text: &str, names: &Names) -> String {
    let mut text = text.to_owned();
    for (name, value) in names.iter().rev() {
        text = text.replace(&format!("{{{name}}}"), value);
    }
    text
}

fn unescaped(text: &str) -> String {
    let text = text.replace(r"\\", "\0").replace(r"\n", "\n").replace(r"\r", "\r");
    let text = text.replace(r"\u202e", "\u{202e}");
    text.replace(r"\t", "\t").replace('\0', r"\")
}

/// Runs a case; returns the case and the program's output if the result is not the expected one.
fn fault(case: &str, names: &Names) -> Option<String> {
    let parts = ["=>", "->", "=="].into_iter().filter_map(|sign| {
        let (start, words) = case.split_once(&format!(" {sign}"))?;
        Some((start, sign, words))
    });
    let Some((start, sign, words)) = parts.min_by_key(|(start, ..)| start.len()) else {
        return Some(format!("no case: {case}"));
    };
    let mut commands = start.split(" |> ");
    let first = commands.next().unwrap();
    let (first, input) = first.split_once(" << ").unwrap_or((first, ""));
    let mut input = unescaped(&plain(input, names)).into_bytes();
    let mut command = plain(first, names);
    for next in commands {
        input = good_bytes(&command, &input).output;
        command = plain(next, names);
    }
    let RanBytes { status, output, stderr } = spikewire_bytes(&command, &input);
    let output = String::from_utf8_lossy(&output);
    let words = unescaped(&plain(words.trim_start_matches(' '), names));
    let is_right = match sign {
        "==" => status == 0 && output == words,
        "=>" => status == 2 && words.split(" | ").all(|word| stderr.contains(word)),
        _ => {
            let printed = format!("{output}{stderr}");
            let is_right = |word: &str| match word.strip_prefix('!') {
                Some(unsaid) => !printed.contains(unsaid),
                None => printed.contains(word),
            };
            status == 0 && words.split(" | ").all(is_right)
        }
    };
    (!is_right).then(|| {
        let most = |text: &str| text.chars().take(1000).collect::<String>();
        format!("{case}\n{status}: {}{}", most(&output), most(&stderr))
    })
}

fn check(table: &str) {
    let directory = tempfile::tempdir().unwrap();
    let mut names = names(directory.path());
    let mut faults = Vec::new();
    for line in table.lines().filter(|line| !line.is_empty() && !line.starts_with("# ")) {
        match line.split_once(" := ") {
            Some((name, text)) => {
                let text = plain(text, &names);
                let Some(name) = name.strip_prefix('@') else {
                    names.push((name.to_owned(), text));
                    continue;
                };
                let path = directory.path().join(name);
                fs::write(&path, unescaped(&text)).unwrap();
                names.push((name.to_owned(), path.display().to_string()));
            }
            None => faults.extend(fault(line, &names)),
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

macro_rules! tables {
    ($($name:ident)*) => {
        $(#[test]
        fn $name() {
            check(include_str!(concat!("said/", stringify!($name), ".txt")));
        })*
    };
}

tables!(channels events inputs logs options parameters recordings schemes spikes times);
