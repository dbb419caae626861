//! Finds the logs among files, directories and patterns.

use super::DatasetKind;
use super::manifest::MANIFEST;
use crate::Result;
use flight_logs::Kind;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// Endings of file names by which tables in a directory are recognised.
pub(super) const TABLES: [&str; 8] =
    ["csv", "tsv", "txt", "jsonl", "ndjson", "npy", "npz", "parquet"];
/// Endings of the names of compressed files.
const PACKED: [&str; 5] = ["gz", "zst", "zstd", "bz2", "xz"];

/// Finds the logs, including tables, in the given files, directories and patterns. A file that is given by name or that
/// matches a pattern always counts as a log. Files in directories that are neither logs nor tables are passed over.
/// A directory that cannot be read, or a link that leads nowhere, counts as a log, which cannot be opened. Returns the
/// logs' full paths, sorted and without repetitions, and the number of files passed over.
///
/// # Errors
/// Returns an error if a file is missing, or if a pattern is invalid.
pub(super) fn find(given: &[PathBuf], output: &Path) -> Result<(Vec<PathBuf>, usize)> {
    // It may not be there yet.
    let output = output.canonicalize().unwrap_or_default();
    let mut found = Found { logs: BTreeSet::new(), passed_over: 0, output };
    for path in given {
        if path.exists() {
            found.take(path);
            continue;
        }
        for path in matches(path)? {
            found.take(&path);
        }
    }
    Ok((found.logs.into_iter().collect(), found.passed_over))
}

/// Returns the files and directories that match a pattern, sorted by name, and the directories that cannot be read.
///
/// # Errors
/// Returns an error if the pattern is invalid, or if nothing matches it.
pub(super) fn matches(pattern: &Path) -> Result<Vec<PathBuf>> {
    let name = pattern.display().to_string();
    let matches = glob::glob(&name).map_err(|error| DatasetKind::Pattern { error }.at(&name))?;
    // A directory that cannot be read stands among the matches: whoever opens it gets the reason.
    let matches = matches.map(|path| path.unwrap_or_else(|error| error.path().to_owned()));
    let matches: Vec<PathBuf> = matches.collect();
    if matches.is_empty() {
        return Err(DatasetKind::NoneThere.at(name));
    }
    Ok(matches)
}

struct Found {
    logs: BTreeSet<PathBuf>,
    passed_over: usize,
    output: PathBuf,
}

impl Found {
    /// Adds a log, or all logs in a directory.
    fn take(&mut self, path: &Path) {
        // A directory that is a log, as ROS 2 writes it.
        let is_log = !path.is_dir() || Kind::of(path).is_ok();
        let path = full(path);
        if is_log {
            self.logs.insert(path);
            return;
        }
        // Not the parts of a data set.
        if path == self.output || path.join(MANIFEST).exists() {
            return;
        }
        let Ok(entries) = fs::read_dir(&path) else {
            self.logs.insert(path);
            return;
        };
        for entry in entries {
            let Ok(entry) = entry else {
                self.logs.insert(path);
                return;
            };
            let own = entry.path();
            let is_hidden = entry.file_name().as_encoded_bytes().starts_with(b".");
            // A link to a directory may lead in a circle.
            if is_hidden || own.is_symlink() && own.is_dir() {
                continue;
            }
            if own.is_dir() || is_log_or_table(&own) {
                self.take(&own);
            } else {
                self.passed_over += 1;
            }
        }
    }
}

/// Returns the full path behind all links or, if a link leads nowhere, the full path of the link.
fn full(path: &Path) -> PathBuf {
    path.canonicalize().or_else(|_| std::path::absolute(path)).unwrap_or_else(|_| path.to_owned())
}

fn is_log_or_table(path: &Path) -> bool {
    let ends = |path: &Path, endings: &[&str]| {
        path.extension().is_some_and(|own| endings.iter().any(|end| own.eq_ignore_ascii_case(end)))
    };
    let unpacked = if ends(path, &PACKED) { path.with_extension("") } else { path.to_owned() };
    // What should be a log by its name and is none is listed, with the reason.
    ends(&unpacked, &TABLES) || Kind::of(path).map_or(true, |kind| kind.is_some())
}
