//! Formats the library's errors and notes for the command line, where a setting is called by its option, such as
//! `--max-rmse`.

use anyhow::Error;
use catalogue::run::Worded;
use lab::ErrorKind;
use lab::flight::visible;
use lab::input::LogKind;
use std::io;

/// Prints a message on standard error. Letters of names that would control the terminal or turn a line around are escaped.
macro_rules! say {
    ($($message:tt)*) => {
        eprintln!("{}", crate::words::page(&format!($($message)*)))
    };
}

/// Returns the text of a page for people. Letters of names that would control the terminal or turn a line around are
/// escaped.
pub(crate) fn page(text: &str) -> String {
    let mut page = String::new();
    for line in text.split_inclusive('\n') {
        let words = line.trim_end_matches('\n');
        page += &visible(words);
        page += &line[words.len()..];
    }
    page
}

/// Returns the command-line option of a setting: `--max-rmse` for `max_rmse`.
pub(crate) fn option(name: &str) -> String {
    match name {
        "columns" => "--channels".to_owned(),
        name => format!("--{}", name.replace('_', "-")),
    }
}

/// Formats an error and its causes, separated by colons.
pub(crate) fn of(error: &Error) -> String {
    let mut words = Vec::new();
    for cause in error.chain() {
        if let Some(error) = cause.downcast_ref::<lab::Error>() {
            words.push(of_lab(error));
            break;
        }
        if let Some(error) = cause.downcast_ref::<catalogue::run::Error>() {
            words.push(error.spelled(option).to_string());
            break;
        }
        words.push(cause.to_string());
    }
    words.join(": ")
}

/// Formats an error of the library `lab`. The text ends with a command that helps, if one is known.
pub(crate) fn of_lab(error: &lab::Error) -> String {
    let help = match &*error.kind {
        ErrorKind::Log(LogKind::NeedsChannel { example: Some(example), .. }) => {
            format!("; `spikewire info` lists them; to read this one:\n  {}", line(example))
        }
        ErrorKind::Setting(catalogue::run::ErrorKind::NeedsSignal { .. }) => {
            "; `spikewire tune` writes it".to_owned()
        }
        _ => String::new(),
    };
    error.spelled(option).to_string() + &help
}

/// Returns the command line of this run with a channel chosen.
fn line(channel: &str) -> String {
    let mut words = vec!["spikewire".to_owned()];
    words.extend(std::env::args().skip(1).map(|argument| quoted(&argument)));
    words.push(format!("--channels {}", quoted(channel)));
    words.join(" ")
}

/// Returns an argument as a shell takes it, in quotes if necessary.
fn quoted(argument: &str) -> String {
    let is_plain = |letter: char| letter.is_alphanumeric() || "-_./:=,@%+".contains(letter);
    if !argument.is_empty() && argument.chars().all(is_plain) {
        return argument.to_owned();
    }
    format!("'{}'", argument.replace('\'', r"'\''"))
}

/// Returns whether the error means that the reader of our output closed the pipe.
pub(crate) fn is_closed_pipe(error: &Error) -> bool {
    let is_pipe = |error: &io::Error| error.kind() == io::ErrorKind::BrokenPipe;
    error.downcast_ref::<lab::Error>().is_some_and(lab::Error::is_closed_pipe)
        || error.downcast_ref::<io::Error>().is_some_and(is_pipe)
}

/// Formats notes of the library.
pub(crate) fn notes<W: Worded>(notes: &[W]) -> Vec<String> {
    notes.iter().map(|note| note.spelled(option).to_string()).collect()
}

/// Prints notes on a log on standard error, one on each line. If the log is one of several, its name comes first.
pub(crate) fn tell_of(log: Option<&str>, notes: &[String]) {
    for note in notes {
        match log {
            // The note on the channels that were found begins with the log's name.
            Some(log) if !note.starts_with(&format!("{log}: ")) => say!("{log}: {note}"),
            _ => say!("{note}"),
        }
    }
}

/// Prints notes of the library on standard error, one on each line.
pub(crate) fn tell<'a, W: Worded + 'a>(notes: impl IntoIterator<Item = &'a W>) {
    notes.into_iter().for_each(|note| say!("{}", note.spelled(option)));
}

#[cfg(test)]
mod tests {
    use super::of;
    use anyhow::Context;
    use catalogue::run::{Error, ErrorKind, Given};

    #[test]
    fn settings_are_options_and_values_are_not() {
        let error = |given| anyhow::Error::from(Error::of(given, ErrorKind::NotANumber));
        for (given, words) in [
            (Given::new("max_rmse", "`min`"), "--max-rmse `min` is not a number"),
            (Given::listed("threshold", Some("half")), "threshold half is not a number"),
        ] {
            assert_eq!(of(&error(given)), words);
        }
        let led: anyhow::Result<()> = Err(error(Given::new("rate", "x")));
        let led = led.context("a.csv").unwrap_err();
        assert_eq!(of(&led), "a.csv: --rate x is not a number");
    }
}
