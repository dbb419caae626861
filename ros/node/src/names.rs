//! Names of schemes: the toolbox's and the catalogue's.

/// The toolbox's names beside the catalogue's.
const OF_TOOLBOX: [(&str, &str); 7] = [
    ("temporal_contrast", "tbr"),
    ("step_forward", "sf"),
    ("moving_window", "mw"),
    ("bsa", "bsa"),
    ("hsa", "hsa"),
    ("threshold_hsa", "t-hsa"),
    (GAUSSIAN_FIELDS, "grf"),
];
/// GRF as the toolbox has it: its neurons are numbered from 0 where the paper's centres are from 1.
pub(crate) const GAUSSIAN_FIELDS: &str = "gaussian_fields";

/// Returns the catalogue's name of a scheme that is called by either name, or by the catalogue's with underscores.
pub(crate) fn of_catalogue(name: &str) -> String {
    let own = OF_TOOLBOX.iter().find(|(toolbox, _)| *toolbox == name);
    own.map_or_else(|| name.replace('_', "-"), |(_, own)| (*own).to_owned())
}

/// Returns what messages call a scheme of the catalogue: the toolbox's name where it means the same.
pub(crate) fn published(name: &'static str) -> &'static str {
    let same = OF_TOOLBOX.iter().find(|(word, own)| *own == name && *word != GAUSSIAN_FIELDS);
    same.map_or(name, |(word, _)| word)
}

#[cfg(test)]
mod tests {
    use super::{of_catalogue, published};

    #[test]
    fn published_names_lead_back() {
        for scheme in catalogue::ALL {
            assert_eq!(of_catalogue(published(scheme.info().name)), scheme.info().name);
        }
        assert_eq!((of_catalogue("grf_slots"), published("grf")), ("grf-slots".to_owned(), "grf"));
    }
}
