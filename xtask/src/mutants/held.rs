//! The committed list with which a run is compared: `host-tests/mutants.toml`.

use crate::common::paths;
use anyhow::{Context, Result};
use serde::Deserialize;
use std::{collections::BTreeSet, fs};

/// Changes that no test notices.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Held {
    /// Changes that no test can distinguish from the crate.
    #[serde(default)]
    equal: Vec<Equal>,
    /// Changes that a test should notice, but none does yet.
    #[serde(default)]
    not_noticed_yet: BTreeSet<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Equal {
    /// The reason, for readers only.
    #[serde(rename = "reason")]
    _reason: String,
    changes: BTreeSet<String>,
}

impl Held {
    pub fn read() -> Result<Self> {
        let file = paths::root().join("host-tests/mutants.toml");
        let text = fs::read_to_string(&file).with_context(|| file.display().to_string())?;
        toml::from_str(&text).context("host-tests/mutants.toml")
    }

    pub fn is_equal(&self, name: &str) -> bool {
        self.equal.iter().any(|equal| equal.changes.contains(name))
    }

    pub fn is_known(&self, name: &str) -> bool {
        self.not_noticed_yet.contains(name)
    }

    pub fn names(&self) -> impl Iterator<Item = &String> {
        self.equal.iter().flat_map(|equal| &equal.changes).chain(&self.not_noticed_yet)
    }
}
