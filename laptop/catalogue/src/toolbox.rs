//! Names of schemes in the messages of the toolbox of the paper, and in ours.

/// Pairs of names: the toolbox's, and ours.
const OF_TOOLBOX: [(&str, &str); 7] = [
    ("temporal_contrast", "tbr"),
    ("step_forward", "sf"),
    ("moving_window", "mw"),
    (GAUSSIAN_FIELDS, "grf"),
    ("bsa", "bsa"),
    ("hsa", "hsa"),
    ("threshold_hsa", "t-hsa"),
];

/// Returns the name of one of our schemes in messages: the toolbox's if it has one, but for `grf`, as its neurons are numbered
/// otherwise.
pub fn published(scheme: &'static str) -> &'static str {
    let same = OF_TOOLBOX.iter().find(|(name, own)| *own == scheme && *name != GAUSSIAN_FIELDS);
    same.map_or(scheme, |(name, _)| name)
}

/// GRF as the toolbox's node has it: its neurons are numbered from 0 where the paper's centres are from 1.
pub const GAUSSIAN_FIELDS: &str = "gaussian_fields";

/// Returns our name of a scheme that a message names.
pub fn meant(name: &str) -> &str {
    OF_TOOLBOX.iter().find(|(own, _)| *own == name).map_or(name, |(_, scheme)| scheme)
}
