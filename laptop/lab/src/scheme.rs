//! Finds the schemes of the catalogue by name.

use catalogue::run::RunTime;
use std::fmt;
use std::ops::Deref;

/// A scheme of the catalogue.
#[derive(Clone, Copy)]
pub struct Scheme(&'static dyn RunTime);

impl Scheme {
    /// Returns all schemes, in the order of the catalogue.
    pub fn all() -> impl Iterator<Item = Self> {
        catalogue::ALL.iter().map(|scheme| Self(*scheme))
    }

    /// Returns the scheme that options and files call `name`.
    pub fn named(name: &str) -> Option<Self> {
        Self::all().find(|scheme| scheme.name() == name)
    }

    /// Returns the scheme's name in options and files.
    pub fn name(self) -> &'static str {
        self.info().name
    }
}

impl Deref for Scheme {
    type Target = dyn RunTime;

    fn deref(&self) -> &Self::Target {
        self.0
    }
}

impl From<&'static dyn RunTime> for Scheme {
    fn from(scheme: &'static dyn RunTime) -> Self {
        Self(scheme)
    }
}

impl Default for Scheme {
    fn default() -> Self {
        Self(catalogue::ALL[0])
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
