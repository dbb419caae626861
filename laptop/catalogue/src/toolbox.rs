//! Names of schemes in messages of the paper's toolbox, and their names here.

/// Pairs of names: the toolbox's, and the one used here.
const OF_TOOLBOX: [(&str, &str); 7] = [
    ("temporal_contrast", "tbr"),
    ("step_forward", "sf"),
    ("moving_window", "mw"),
    (GAUSSIAN_FIELDS, "grf"),
    ("bsa", "bsa"),
    ("hsa", "hsa"),
    ("threshold_hsa", "t-hsa"),
];

/// Returns the name of a scheme in messages: the toolbox's if it has one. `grf` keeps its own name, as the toolbox
/// numbers its neurons differently.
pub fn published(scheme: &'static str) -> &'static str {
    let same = OF_TOOLBOX.iter().find(|(name, own)| *own == scheme && *name != GAUSSIAN_FIELDS);
    same.map_or(scheme, |(name, _)| name)
}

/// GRF of the toolbox's node, whose neurons are numbered from 0 while the paper's centres are numbered from 1.
pub const GAUSSIAN_FIELDS: &str = "gaussian_fields";

/// Returns the name used here for a scheme that a message names.
pub fn meant(name: &str) -> &str {
    OF_TOOLBOX.iter().find(|(own, _)| *own == name).map_or(name, |(_, scheme)| scheme)
}
