//! The compiled half of the Python package `spikewire`: a visitor of the catalogue that works on `NumPy` arrays.
//!
//! It knows no scheme by name. What Python calls things, and how arrays are shaped, is in the package's Python half.

mod array;
mod channel;
mod coder;
mod dataset;
mod error;
mod filter;
mod fingerprint;
mod flight;
mod library;
mod link;
mod network;
mod stream;
mod values;
mod work;

use pyo3::prelude::*;

/// The compiled half of the package.
#[pymodule]
mod _native {
    #[pymodule_export]
    use super::array::{outside, remarks};
    #[pymodule_export]
    use super::coder::{Coder, Fitted};
    #[pymodule_export]
    use super::dataset::{Dataset, encode_log};
    #[pymodule_export]
    use super::error::Error;
    #[pymodule_export]
    use super::filter::Filter;
    #[pymodule_export]
    use super::fingerprint::fingerprint;
    #[pymodule_export]
    use super::flight::flight;
    #[pymodule_export]
    use super::info::schemes;
    #[pymodule_export]
    use super::library::{
        advise, from_toml, plot, rate_of, read, read_events, score, to_c, to_rust, to_toml, tune,
        write_events,
    };
    #[pymodule_export]
    use super::link::{Hearer, Sender};
    #[pymodule_export]
    use super::network::Network;
    #[pymodule_export]
    use super::stream::{Decoder, Encoder};
    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        // An error that Python's half raises has no attributes of its own.
        let error = module.getattr("Error")?;
        for name in ["parameter", "value", "file", "kind", "remedy"] {
            error.setattr(name, module.py().None())?;
        }
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}

/// What is known of each scheme.
mod info {
    use catalogue::{Found, Kind, Parameter, Search, Unit};
    use pyo3::prelude::*;
    use pyo3::types::{PyDict, PyList};

    /// Every scheme of the catalogue, in its order.
    #[pyfunction]
    pub(crate) fn schemes(py: Python<'_>) -> PyResult<Bound<'_, PyList>> {
        let all = PyList::empty(py);
        for info in catalogue::INFO {
            let own = PyDict::new(py);
            own.set_item("name", info.name)?;
            own.set_item("type_name", info.type_name)?;
            own.set_item("words", info.words)?;
            own.set_item("good_for", info.good_for)?;
            own.set_item("is_signed", info.is_signed)?;
            own.set_item("has_first_value", info.has_first_value())?;
            let parameters = info.parameters.iter().map(|own| parameter(py, own));
            own.set_item("parameters", parameters.collect::<PyResult<Vec<_>>>()?)?;
            all.append(own)?;
        }
        Ok(all)
    }

    fn parameter<'py>(py: Python<'py>, own: &Parameter) -> PyResult<Bound<'py, PyDict>> {
        let told = PyDict::new(py);
        told.set_item("name", own.name)?;
        let (kind, words): (_, &[&str]) = match own.kind {
            Kind::Number => ("number", &[]),
            Kind::Count => ("count", &[]),
            Kind::Choice(words) => ("choice", words),
            Kind::Flag => ("flag", &[]),
            Kind::Text => ("text", &[]),
            Kind::Filter => ("filter", &[]),
        };
        told.set_item("kind", kind)?;
        told.set_item("words", words.to_vec())?;
        let unit = match own.unit {
            Unit::None => "",
            Unit::Signal => "the signal's unit",
            Unit::Samples => "samples",
        };
        told.set_item("unit", unit)?;
        told.set_item("help", own.help)?;
        told.set_item("default", own.default)?;
        let found = own.found.map(|found| match found {
            Found::First => "the first sample",
            Found::Min => "the signal's minimum",
            Found::Max => "the signal's maximum",
        });
        told.set_item("found", found)?;
        told.set_item("search", own.search.map(search))?;
        told.set_item("example", own.example)?;
        Ok(told)
    }

    /// Returns the kind of a search, its bounds and, for a search over words, the words.
    fn search(own: Search) -> (&'static str, f64, f64, Vec<&'static str>) {
        let (kind, low, high) = match own {
            Search::Words(words) => {
                return ("words", 0.0, words.len() as f64 - 1.0, words.to_vec());
            }
            Search::Log(low, high) | Search::Fields(low, high) => ("log", low, high),
            Search::Around(low, high) => ("around", low, high),
            Search::OfFilter(low, high) => ("of filter", low, high),
            Search::Thresholds(low, high) => ("times", low, high),
            Search::Filter(_, low, high) => ("filter", low, high),
            Search::Whole(low, high) | Search::Most(low, high) => {
                ("whole", f64::from(low), f64::from(high))
            }
        };
        (kind, low, high, Vec::new())
    }
}
