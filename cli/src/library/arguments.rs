//! Options by name, checked as those of the command line.

use anyhow::{Result, anyhow};
use clap::{Args, Parser};

/// Options by their long names, with their values; flags have none.
#[derive(Clone, Debug, Default)]
pub struct Arguments(Vec<(String, Option<String>)>);

impl Arguments {
    /// Sets an option, which may be set several times where it takes several values.
    pub fn set(&mut self, name: &str, value: &str) {
        self.0.push((name.replace('_', "-"), Some(value.to_owned())));
    }

    /// Sets a flag.
    pub fn flag(&mut self, name: &str) {
        self.0.push((name.replace('_', "-"), None));
    }

    /// As a command takes them that reads this input.
    ///
    /// # Errors
    /// There is no such option, or it has no such value.
    pub(super) fn parse<T: Args>(&self, input: &str) -> Result<T> {
        let option = |(name, value): &(String, Option<String>)| match value {
            Some(value) => format!("--{name}={value}"),
            None => format!("--{name}"),
        };
        let given = self.0.iter().map(option);
        let all = ["spikewire".to_owned(), input.to_owned()].into_iter().chain(given);
        let parsed = Command::<T>::try_parse_from(all).map_err(|error| {
            // The first paragraph says what is wrong, the others how to get help on the command line.
            let text = error.to_string();
            let words = text.split("\n\n").next().unwrap_or_default();
            let words: Vec<&str> = words.split_whitespace().collect();
            anyhow!("{}", words.join(" ").trim_start_matches("error: "))
        })?;
        Ok(parsed.options)
    }
}

#[derive(Parser)]
struct Command<T: Args> {
    #[command(flatten)]
    options: T,
}
