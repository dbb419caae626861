//! Finds the logs among files, directories and patterns.

use super::DatasetKind;
use super::manifest::MANIFEST;
use crate::{Error, Result};
use flight_logs::Kind;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// Endings of file names by which tables in a directory are recognised.
const TABLES: [&str; 8] = ["csv", "tsv", "txt", "jsonl", "ndjson", "npy", "npz", "parquet"];
/// Endings of the names of compressed files.
const PACKED: [&str; 5] = ["gz", "zst", "zstd", "bz2", "xz"];

/// Finds the logs, including tables, in the given files, directories and patterns. A file that is given by name or that
/// matches a pattern always counts as a log. Files in directories that are neither logs nor tables are passed over.
/// Returns the logs' full paths, sorted and without repetitions, and the number of files passed over.
///
/// # Errors
/// Returns an error if a file is missing, if a pattern is invalid, or if a directory cannot be read.
pub(super) fn find(given: &[PathBuf], output: &Path) -> Result<(Vec<PathBuf>, usize)> {
    // It may not be there yet.
    let output = output.canonicalize().unwrap_or_default();
    let mut found = Found { logs: BTreeSet::new(), passed_over: 0, output };
    for path in given {
        if path.exists() {
            found.take(path)?;
            continue;
        }
        let name = path.display().to_string();
        let matches =
            glob::glob(&name).map_err(|error| DatasetKind::Pattern { error }.at(&name))?;
        let mut is_any = false;
        for path in matches {
            found.take(&path.map_err(|error| Error::open(&name, error.into()))?)?;
            is_any = true;
        }
        if !is_any {
            return Err(DatasetKind::NoneThere.at(name));
        }
    }
    Ok((found.logs.into_iter().collect(), found.passed_over))
}

struct Found {
    logs: BTreeSet<PathBuf>,
    passed_over: usize,
    output: PathBuf,
}

impl Found {
    /// Adds a log, or all logs in a directory.
    fn take(&mut self, path: &Path) -> Result<()> {
        // A directory that is a log, as ROS 2 writes it.
        let is_log = !path.is_dir() || Kind::of(path).is_ok();
        let path = full(path)?;
        if is_log {
            self.logs.insert(path);
            return Ok(());
        }
        // Not the parts of a data set.
        if path == self.output || path.join(MANIFEST).exists() {
            return Ok(());
        }
        let unread = |error| Error::open(path.display().to_string(), error);
        for entry in fs::read_dir(&path).map_err(unread)? {
            let entry = entry.map_err(unread)?;
            let (own, kind) = (entry.path(), entry.file_type().map_err(unread)?);
            let is_hidden = entry.file_name().as_encoded_bytes().starts_with(b".");
            // A link to a directory may lead in a circle.
            if is_hidden || kind.is_symlink() && own.is_dir() {
                continue;
            }
            if own.is_dir() || is_log_or_table(&own) {
                self.take(&own)?;
            } else {
                self.passed_over += 1;
            }
        }
        Ok(())
    }
}

fn full(path: &Path) -> Result<PathBuf> {
    path.canonicalize().map_err(|error| Error::open(path.display().to_string(), error))
}

fn is_log_or_table(path: &Path) -> bool {
    let ends = |path: &Path, endings: &[&str]| {
        path.extension().is_some_and(|own| endings.iter().any(|end| own.eq_ignore_ascii_case(end)))
    };
    let unpacked = if ends(path, &PACKED) { path.with_extension("") } else { path.to_owned() };
    // What should be a log by its name and is none is listed, with the reason.
    ends(&unpacked, &TABLES) || Kind::of(path).map_or(true, |kind| kind.is_some())
}
