//! Directories outside the repository, where cargo sees none of its settings.

use anyhow::{Context, Result};
use std::{
    env, fs,
    path::{Path, PathBuf},
    process,
};

/// A directory that goes when this is dropped.
pub struct Temporary(PathBuf);

impl Temporary {
    pub fn new(what: &str) -> Result<Self> {
        let path = env::temp_dir().join(format!("spikewire-{what}-{}", process::id()));
        fs::create_dir(&path).with_context(|| path.display().to_string())?;
        Ok(Self(path))
    }

    pub fn path(&self) -> &Path {
        &self.0
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        // What stays behind is a few kilobytes in a directory for such things.
        let _ = fs::remove_dir_all(&self.0);
    }
}
