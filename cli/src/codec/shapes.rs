//! The shapes that are compiled in, and what is said of the others.

use anyhow::{Error, anyhow};

/// Calls a macro with all filter lengths.
macro_rules! for_each_filter_length {
    ($callback:ident) => {
        $callback! { 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23 24 25 26 27 28 29
        30 31 32 48 64 }
    };
}
pub(super) use for_each_filter_length;

/// Calls a macro with all windows, as counts of samples: one more than the paper's `window`.
macro_rules! for_each_window {
    ($callback:ident) => {
        $callback! { 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23 24 25 26 27 28 29
        30 31 32 33 51 65 101 }
    };
}
pub(super) use for_each_window;

/// Calls a macro with all population sizes of a position code.
macro_rules! for_each_population {
    ($callback:ident) => {
        $callback! { 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23 24 25 26 27 28 29 30
        31 32 64 128 }
    };
}
pub(super) use for_each_population;

/// Calls a macro with all population sizes of receptive fields.
macro_rules! for_each_field {
    ($callback:ident) => {
        $callback! { 3 4 5 6 7 8 9 10 11 12 13 14 15 16 20 24 32 }
    };
}
pub(super) use for_each_field;

/// Calls a macro with all counts of sub-timesteps.
macro_rules! for_each_slot_count {
    ($callback:ident) => {
        $callback! { 8 10 16 32 100 256 }
    };
}
pub(super) use for_each_slot_count;

/// Says which shapes there are.
pub(super) fn unsupported(what: &str, value: usize, supported: &[usize]) -> Error {
    anyhow!("{what} {value} is not compiled in; there are {}", ranges(supported))
}

/// A rising list with its runs joined: `1-32, 40, 48`.
fn ranges(values: &[usize]) -> String {
    let runs = values.chunk_by(|low, high| low + 1 == *high).map(|run| match run {
        [first, .., last] => format!("{first}-{last}"),
        _ => format!("{}", run[0]),
    });
    runs.collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    #[test]
    fn runs_are_joined() {
        assert_eq!(super::ranges(&[1, 2, 3, 5, 8, 9]), "1-3, 5, 8-9");
    }
}
