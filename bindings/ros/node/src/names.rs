//! Names of schemes: the toolbox's and the catalogue's.

pub(crate) use catalogue::toolbox::{GAUSSIAN_FIELDS, published};

use catalogue::toolbox;

/// Returns the catalogue's name of a scheme that is called by either name, or by the catalogue's with underscores.
pub(crate) fn of_catalogue(name: &str) -> String {
    toolbox::meant(name).replace('_', "-")
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
