//! Schemes of the catalogue as the value of an option.

use catalogue::run::RunTime;
use clap::builder::{MapValueParser, PossibleValue, PossibleValuesParser, ValueParserFactory};
use std::fmt;
use std::ops::Deref;

/// A scheme of the catalogue.
#[derive(Clone, Copy)]
pub(crate) struct Scheme(&'static dyn RunTime);

impl Scheme {
    /// All of them, in the order of the catalogue.
    pub(crate) fn all() -> impl Iterator<Item = Self> {
        catalogue::ALL.iter().map(|scheme| Self(*scheme))
    }

    /// The scheme that options and files call so.
    pub(crate) fn named(name: &str) -> Option<Self> {
        Self::all().find(|scheme| scheme.name() == name)
    }

    /// What options and files call it.
    pub(crate) fn name(self) -> &'static str {
        self.info().name
    }

    /// Takes the name of one of these.
    pub(crate) fn parser(
        schemes: impl Iterator<Item = Self>,
    ) -> MapValueParser<PossibleValuesParser, fn(String) -> Self> {
        let values =
            schemes.map(|scheme| PossibleValue::new(scheme.name()).help(scheme.info().words));
        let parser: PossibleValuesParser = values.collect::<Vec<_>>().into();
        clap::builder::TypedValueParser::map(parser, |name| {
            // The parser lets no other name pass.
            Self::named(&name).unwrap_or(Self(catalogue::ALL[0]))
        })
    }
}

impl Deref for Scheme {
    type Target = dyn RunTime;

    fn deref(&self) -> &Self::Target {
        self.0
    }
}

impl fmt::Debug for Scheme {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl PartialEq for Scheme {
    fn eq(&self, other: &Self) -> bool {
        self.name() == other.name()
    }
}

impl ValueParserFactory for Scheme {
    type Parser = MapValueParser<PossibleValuesParser, fn(String) -> Self>;

    fn value_parser() -> Self::Parser {
        Self::parser(Self::all())
    }
}
