//! Words the library's errors and notes for the command line, where a setting is called by its option.

use anyhow::Error;
use catalogue::run::Worded;
use lab::ErrorKind;
use lab::input::LogKind;
use std::io;

/// Returns the option that sets a setting.
pub(crate) fn option(name: &str) -> String {
    format!("--{}", name.replace('_', "-"))
}

/// Words an error, followed by its causes.
pub(crate) fn of(error: &Error) -> String {
    let mut words = Vec::new();
    for cause in error.chain() {
        if let Some(own) = cause.downcast_ref::<lab::Error>() {
            words.push(of_lab(own));
            break;
        }
        if let Some(own) = cause.downcast_ref::<catalogue::run::Error>() {
            words.push(own.spelled(option).to_string());
            break;
        }
        words.push(cause.to_string());
    }
    words.join(": ")
}

/// Words an error of the library, followed by the option or command that helps.
pub(crate) fn of_lab(error: &lab::Error) -> String {
    let help = match *error.kind {
        ErrorKind::Log(LogKind::NeedsChannel) => "; `spikewire info` lists them",
        ErrorKind::Setting(catalogue::run::ErrorKind::NeedsSignal { .. }) => {
            "; `spikewire tune` writes it"
        }
        _ => "",
    };
    error.spelled(option).to_string() + help
}

/// Returns whether the error is that the reader of the output closed it.
pub(crate) fn is_closed_pipe(error: &Error) -> bool {
    let is_pipe = |error: &io::Error| error.kind() == io::ErrorKind::BrokenPipe;
    error.downcast_ref::<lab::Error>().is_some_and(lab::Error::is_closed_pipe)
        || error.downcast_ref::<io::Error>().is_some_and(is_pipe)
}

/// Writes notes of the library to standard error, a line each.
pub(crate) fn tell<'a, W: Worded + 'a>(notes: impl IntoIterator<Item = &'a W>) {
    notes.into_iter().for_each(|note| eprintln!("{}", note.spelled(option)));
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
