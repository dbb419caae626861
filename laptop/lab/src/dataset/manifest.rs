//! The manifest of a data set: a JSON line for each log.

use super::{DatasetKind, Flights, unwritten};
use crate::input::Clock;
use crate::output::{Output, OutputKind, UNFINISHED_NAME};
use crate::{Error, Place, Result};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::fs::{self, OpenOptions};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::time::UNIX_EPOCH;

/// Name of the manifest in the directory of a data set.
pub(super) const MANIFEST: &str = "manifest.jsonl";
/// Name of the file with the settings of a data set.
const SETTINGS: &str = "dataset.json";
/// Name of the directory with the files of spikes.
pub(super) const EVENTS: &str = "events";
/// Name of the directory with the files of samples.
pub(super) const VALUES: &str = "values";

/// The part of a data set to which a flight belongs: the part for training or the part for testing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Split {
    /// For training.
    Train,
    /// For testing.
    Test,
}

/// A row of the manifest: one log, and the outcome of encoding it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Full path of the log. Bytes that are not UTF-8 are replaced; [`log_bytes`](Self::log_bytes) has them.
    pub log: String,
    /// All bytes of the path in hexadecimal digits, if they are not UTF-8.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub log_bytes: Option<String>,
    /// Kind of the log, one of [`NAMES`](super::NAMES); empty if the log cannot be opened.
    pub kind: String,
    /// Length of the log, in bytes.
    pub bytes: u64,
    /// Time of the log's last change, in µs since 1970.
    pub modified_us: u64,
    /// SHA-256 of the log. If the log is a directory, SHA-256 of the contents of its files, joined in the order of
    /// their names.
    pub sha256: String,
    /// SHA-256 of the settings, as in `dataset.json`.
    pub settings: String,
    /// Whether the log's flight is for training or for testing. `None` if the log was refused; also `None` for all logs
    /// until the run ends.
    pub split: Option<Split>,
    /// Reason that the log was refused, if it was.
    pub refused: Option<String>,
    /// Name of the error's kind, such as `Open`, for programs that read the manifest. `None` if the log was not
    /// refused.
    pub refused_kind: Option<String>,
    /// Path of the file of spikes, relative to the directory of the data set.
    pub events: Option<String>,
    /// Length of the file of spikes, in bytes.
    pub events_bytes: u64,
    /// Path of the file of samples, relative to the directory of the data set.
    pub values: Option<String>,
    /// Length of the file of samples, in bytes.
    pub values_bytes: u64,
    /// Names of the channels.
    pub channels: Vec<String>,
    /// Samples a second, if known.
    pub rate: Option<f64>,
    /// Length in seconds, without the unknown time where a clock restarted.
    pub seconds: f64,
    /// Number of samples of each channel.
    pub samples: u64,
    /// Number of samples that are missing or not finite, and therefore have no spikes.
    pub not_finite: u64,
    /// Number of spikes of each channel.
    pub spikes: Vec<u64>,
    /// Number of gaps in time.
    pub gaps: u64,
    /// Number of samples whose time is earlier than the time of the preceding sample. Restarts of the clock are not
    /// counted.
    pub steps_back: u64,
    /// Number of times that the clock restarted.
    pub restarts: u64,
    /// Notes of the reader (such as skipped damage) and of the encoder.
    pub notes: Vec<String>,
}

impl Row {
    pub(super) fn new(log: &Path, settings: &Settings) -> Self {
        let bytes = log.as_os_str().as_encoded_bytes();
        Self {
            log: log.display().to_string(),
            log_bytes: log.to_str().is_none().then(|| hex(bytes)),
            settings: settings.sha256.clone(),
            ..Self::default()
        }
    }

    /// Returns the bytes of the log's path.
    pub(super) fn key(&self) -> Vec<u8> {
        let of_bytes = self.log_bytes.as_deref().and_then(unhex);
        of_bytes.unwrap_or_else(|| self.log.as_bytes().to_vec())
    }

    /// Returns the path of the log.
    fn path(&self) -> PathBuf {
        #[cfg(unix)]
        return <std::ffi::OsString as std::os::unix::ffi::OsStringExt>::from_vec(self.key())
            .into();
        #[cfg(not(unix))]
        return PathBuf::from(&self.log);
    }

    /// Returns whether the log is no longer there.
    fn is_gone(&self) -> bool {
        let data = fs::symlink_metadata(self.path());
        data.is_err_and(|error| error.kind() == io::ErrorKind::NotFound)
    }

    /// Marks the log as refused. `why` is the reason, as a text for the user, and `kind` is the kind of reason.
    pub(super) fn refuse(&mut self, kind: &str, why: String) {
        (self.refused, self.refused_kind) = (Some(why), Some(kind.to_owned()));
    }

    /// Computes the SHA-256 of the log, and stores it in the row.
    ///
    /// # Errors
    /// Returns an error if the log cannot be read, or can be read only once.
    pub(super) fn hash(&mut self, log: &Path) -> Result<()> {
        let mut hash = Hash(Sha256::new());
        for file in files(log)? {
            let open = |error| Error::open(file.display().to_string(), error);
            io::copy(&mut fs::File::open(&file).map_err(open)?, &mut hash).map_err(open)?;
        }
        self.sha256 = hex(&hash.0.finalize());
        Ok(())
    }

    /// Copies the rate, the duration and the numbers of gaps, steps back and restarts from `clock` to the row. Rate and
    /// duration are rounded to 6 decimals, so that they stay the same when the row is written and read again.
    pub(super) fn take(&mut self, clock: &Clock) {
        let rounded = |number: f64| (number * 1e6).round() / 1e6;
        // A rate that the times contradict is not written; the notes say why.
        self.rate = clock.rate().filter(|_| clock.uneven().is_none()).map(rounded);
        self.seconds = rounded(clock.seconds());
        self.gaps = clock.gaps();
        self.steps_back = clock.steps_back();
        self.restarts = clock.restarts();
    }

    /// Returns the paths of the log's spike file and sample file, relative to the directory of the data set.
    pub(super) fn parts(&self) -> (String, String) {
        const LONGEST: usize = 60;
        let stem = Path::new(&self.log).file_stem().unwrap_or_default().to_string_lossy();
        let plain =
            |own: char| if own.is_alphanumeric() || "-_.".contains(own) { own } else { '_' };
        let stem: String = stem.chars().take(LONGEST).map(plain).collect();
        let mark = &hashed(self.key())[..12];
        let part = |directory| format!("{directory}/{stem}-{mark}.parquet");
        (part(EVENTS), part(VALUES))
    }

    /// Returns whether the row's files of spikes and samples exist and have their full lengths.
    fn is_there(&self, directory: &Path) -> bool {
        let is_whole = |part: &Option<String>, bytes: u64| match part {
            None => true,
            Some(part) => directory.join(part).metadata().is_ok_and(|data| data.len() == bytes),
        };
        is_whole(&self.events, self.events_bytes) && is_whole(&self.values, self.values_bytes)
    }

    /// Returns whether the log was refused for a reason that may be gone in a later run, such as a missing disk.
    fn may_pass(&self) -> bool {
        self.refused_kind.as_deref().is_some_and(|kind| ["Open", "Io", CHANGED].contains(&kind))
    }
}

/// Name of the reason that a log was refused because it changed while it was read.
pub(super) const CHANGED: &str = "Changed";

/// The length and the modification time of a log. If both are the same as before, the log is taken to be unchanged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct File {
    bytes: u64,
    modified_us: u64,
}

impl File {
    /// Reads the length and the modification time of a log.
    ///
    /// # Errors
    /// Returns an error if the log is missing, or if it is not a regular file. Pipes are refused because they can be
    /// read only once.
    pub(super) fn of(log: &Path) -> Result<Self> {
        let mut own = Self { bytes: 0, modified_us: 0 };
        for file in files(log)? {
            let open = |error| Error::open(file.display().to_string(), error);
            let data = file.metadata().map_err(open)?;
            if !data.is_file() {
                return Err(open(io::Error::other("it can be read only once")));
            }
            let since = data.modified().map_err(open)?.duration_since(UNIX_EPOCH);
            own.bytes += data.len();
            own.modified_us = own.modified_us.max(since.map_or(0, |own| own.as_micros() as u64));
        }
        Ok(own)
    }

    pub(super) fn describe(self, row: &mut Row) {
        (row.bytes, row.modified_us) = (self.bytes, self.modified_us);
    }
}

/// Returns the files of a log: the log itself or, if the log is a directory, all its files, sorted by name.
fn files(log: &Path) -> Result<Vec<PathBuf>> {
    if !log.is_dir() {
        return Ok(vec![log.to_owned()]);
    }
    let open = |error| Error::open(log.display().to_string(), error);
    let mut files = Vec::new();
    for entry in fs::read_dir(log).map_err(open)? {
        let path = entry.map_err(open)?.path();
        if path.is_file() {
            files.push(path);
        }
    }
    files.sort();
    Ok(files)
}

/// The settings of a data set, and their hash.
pub(super) struct Settings {
    json: serde_json::Value,
    sha256: String,
}

impl Settings {
    pub(super) fn new(json: serde_json::Value) -> Self {
        let sha256 = hashed(json.to_string());
        Self { json, sha256 }
    }
}

/// The manifest of a data set, opened to append rows.
pub(super) struct Manifest {
    directory: PathBuf,
    /// The open file of the manifest, locked for this run.
    file: fs::File,
    /// The rows, by the bytes of the logs' paths.
    rows: BTreeMap<Vec<u8>, Row>,
}

impl Manifest {
    /// Opens the manifest of a data set, and deletes the unfinished files of a killed run.
    ///
    /// # Errors
    /// Returns an error if the directory cannot be written, if another run uses it, or if its data set has other
    /// settings.
    pub(super) fn open(directory: &Path, settings: &Settings) -> Result<Self> {
        let at = || directory.display().to_string();
        let failed = |error| OutputKind::Unwritten { error }.at(at());
        for own in [EVENTS, VALUES] {
            fs::create_dir_all(directory.join(own)).map_err(failed)?;
        }
        let mut options = OpenOptions::new();
        let path = directory.join(MANIFEST);
        let mut file = options.read(true).append(true).create(true).open(path).map_err(failed)?;
        lock(&file).map_err(|_| DatasetKind::InUse.at(at()))?;
        let described = directory.join(SETTINGS);
        if let Ok(text) = fs::read_to_string(&described) {
            let known: Option<serde_json::Value> = serde_json::from_str(&text).ok();
            if known.is_none_or(|known| known["sha256"] != *settings.sha256) {
                return Err(DatasetKind::OtherSettings.at(at()));
            }
        } else {
            write(&described, &described_as(settings, &serde_json::Value::Null))?;
        }
        delete_unfinished(directory).map_err(failed)?;
        let mut text = String::new();
        file.read_to_string(&mut text).map_err(failed)?;
        let text = whole(&text);
        file.set_len(text.len() as u64).map_err(failed)?;
        let rows = parse(text, directory)?;
        Ok(Self { directory: directory.to_owned(), file, rows })
    }

    /// Returns whether the manifest has a valid row for a log. `file` is the present length and modification time of
    /// the log. A row is invalid if the log has changed, or if the log was refused for a reason that may be gone.
    pub(super) fn has(&self, log: &Path, file: &File) -> bool {
        let File { bytes, modified_us } = *file;
        self.rows.get(log.as_os_str().as_encoded_bytes()).is_some_and(|row| {
            (row.bytes, row.modified_us) == (bytes, modified_us) && !row.may_pass()
        })
    }

    /// Appends a row. The files of spikes and samples that it names must already be complete.
    ///
    /// # Errors
    /// Returns an error if the manifest cannot be written.
    pub(super) fn add(&mut self, row: Row) -> Result<()> {
        let line = serde_json::to_string(&row)? + "\n";
        let written = self.file.write_all(line.as_bytes());
        written.map_err(|error| OutputKind::Unwritten { error }.at(self.path().as_path()))?;
        self.rows.insert(row.key(), row);
        Ok(())
    }

    fn path(&self) -> PathBuf {
        self.directory.join(MANIFEST)
    }

    /// Splits the flights into training and testing, and rewrites the manifest: a row for each log that is still there,
    /// sorted by path. The same logs and settings give the same bytes, whatever the order of encoding. Returns the rows,
    /// and the number of logs that are gone.
    ///
    /// # Errors
    /// Returns an error if a file cannot be written.
    pub(super) fn finish(
        self,
        settings: &Settings,
        test: f64,
        flights: Flights,
    ) -> Result<(Vec<Row>, usize)> {
        let path = self.path();
        let mut rows: Vec<Row> = self.rows.into_values().collect();
        let before = rows.len();
        rows.retain(|row| !row.is_gone());
        let gone = before - rows.len();
        split(&mut rows, test, flights);
        let mut lines = String::new();
        for row in &rows {
            lines += &serde_json::to_string(row)?;
            lines.push('\n');
        }
        let by = match flights {
            Flights::Logs => "log",
            Flights::Directories => "directory",
        };
        let shares = serde_json::json!({ "test": test, "by": by });
        write(&self.directory.join(SETTINGS), &described_as(settings, &shares))?;
        write(&path, &lines)?;
        // A worker that was killed leaves its own, although the run went on.
        delete_unfinished(&self.directory).map_err(|error| unwritten(error.into()))?;
        Ok((rows, gone))
    }
}

/// Assigns each flight to training or testing. A flight is one log, or all logs of one directory. It is for testing if
/// its hash, as a number from 0 to 1, is below `test`: the hash is that of the log's content or of the directory's path.
/// Other logs thus never change the side of a flight, and copies of a log are on one side.
fn split(rows: &mut [Row], test: f64, flights: Flights) {
    for row in rows {
        let flight = match flights {
            Flights::Logs => row.sha256.clone(),
            Flights::Directories => {
                let path = row.path();
                let directory = path.parent().unwrap_or(Path::new(""));
                hex(directory.as_os_str().as_encoded_bytes())
            }
        };
        let side = if part(&flight) < test { Split::Test } else { Split::Train };
        row.split = row.events.is_some().then_some(side);
    }
}

/// Returns a number from 0 to 1, below 1, that is drawn by a hash of a flight.
fn part(flight: &str) -> f64 {
    // Hashed once more, or another program that splits by hash would choose the same logs.
    let hash = Sha256::new_with_prefix(format!("split {flight}")).finalize();
    // 53 bits are those that a double holds exactly.
    let bits = hash.iter().take(8).fold(0_u64, |bits, byte| bits << 8 | u64::from(*byte)) >> 11;
    bits as f64 / (1_u64 << 53) as f64
}

/// Reads the manifest of a data set: the latest row of each log, sorted by path. Rows whose files are missing or
/// incomplete are left out, and so is a last line that a killed run did not finish.
///
/// # Errors
/// Returns an error if the manifest is missing, or if a line of it is not a valid row.
pub fn rows(directory: &Path) -> Result<Vec<Row>> {
    let path = directory.join(MANIFEST);
    let text = fs::read_to_string(&path)
        .map_err(|error| Error::open(path.display().to_string(), error))?;
    Ok(parse(whole(&text), directory)?.into_values().collect())
}

/// Returns the complete lines of a manifest.
fn whole(text: &str) -> &str {
    &text[..text.rfind('\n').map_or(0, |end| end + 1)]
}

/// Parses the lines of the manifest in `directory`. Returns the latest row of each log, by the log's path, of the rows
/// whose files are complete.
fn parse(text: &str, directory: &Path) -> Result<BTreeMap<Vec<u8>, Row>> {
    let path = directory.join(MANIFEST);
    let mut rows = BTreeMap::new();
    for (line, own) in (1..).zip(text.lines()) {
        let row: Row = serde_json::from_str(own).map_err(|error| {
            DatasetKind::NoRow { error }.at(Place::line(path.display().to_string(), line))
        })?;
        if row.is_there(directory) {
            rows.insert(row.key(), row);
        }
    }
    Ok(rows)
}

fn described_as(settings: &Settings, split: &serde_json::Value) -> String {
    let Settings { json, sha256 } = settings;
    format!("{:#}\n", serde_json::json!({ "settings": json, "sha256": sha256, "split": split }))
}

/// Writes a text file. The file appears once it is complete, or not at all.
fn write(path: &Path, text: &str) -> Result<()> {
    let all = || -> Result<()> {
        let mut output = Output::to(Some(path))?;
        output.write_all(text.as_bytes())?;
        output.finish()
    };
    all().map_err(unwritten)
}

/// Deletes the unfinished files of killed processes from the directories of a data set.
fn delete_unfinished(directory: &Path) -> io::Result<()> {
    for own in [directory, &directory.join(EVENTS), &directory.join(VALUES)] {
        for entry in fs::read_dir(own)? {
            let entry = entry?;
            if entry.file_name().to_string_lossy().starts_with(UNFINISHED_NAME) {
                fs::remove_file(entry.path())?;
            }
        }
    }
    Ok(())
}

/// Locks a file until it is closed, to keep other runs out.
#[cfg(unix)]
fn lock(file: &fs::File) -> io::Result<()> {
    use rustix::fs::{FlockOperation, flock};
    Ok(flock(file, FlockOperation::NonBlockingLockExclusive)?)
}

/// Locks nothing. The standard library of the oldest supported Rust version cannot lock files, and the crate `rustix`
/// can lock files only on Unix.
#[cfg(not(unix))]
fn lock(_: &fs::File) -> io::Result<()> {
    Ok(())
}

/// A SHA-256 hash of the bytes that are written to it.
struct Hash(Sha256);

impl Write for Hash {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.update(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn hashed(bytes: impl AsRef<[u8]>) -> String {
    hex(&Sha256::digest(bytes))
}

fn hex(bytes: &[u8]) -> String {
    use std::fmt::Write;
    let mut text = String::new();
    for byte in bytes {
        let _ = write!(text, "{byte:02x}");
    }
    text
}

/// Returns the bytes of a text of hexadecimal digits; `None` if it is none.
fn unhex(text: &str) -> Option<Vec<u8>> {
    let digits = text.as_bytes().chunks(2).map(|own| str::from_utf8(own).ok());
    digits.map(|own| u8::from_str_radix(own?, 16).ok()).collect()
}

#[cfg(test)]
mod tests {
    use super::{Flights, Row, Settings, Split, hex, split};
    use std::path::Path;

    fn row(log: &str) -> Row {
        let sha256 = super::hashed(log);
        Row { log: log.to_owned(), sha256, events: Some(String::new()), ..Row::default() }
    }

    /// Of a thousand logs about a fifth are for testing. Logs that are added leave the others on their side.
    #[test]
    fn an_added_log_moves_no_other() {
        let sides = |count: usize, flights| {
            let mut rows: Vec<Row> = (0..count).map(|log| row(&format!("/{log}/a.csv"))).collect();
            split(&mut rows, 0.2, flights);
            rows.into_iter().map(|own| own.split.unwrap()).collect::<Vec<_>>()
        };
        for flights in [Flights::Logs, Flights::Directories] {
            let all = sides(1000, flights);
            for count in 1..100 {
                assert_eq!(sides(count, flights), all[..count]);
            }
            let test = all.iter().filter(|own| **own == Split::Test).count();
            assert!((150..250).contains(&test), "{test}");
        }
    }

    #[test]
    fn all_or_none_can_be_for_testing() {
        for (test, side) in [(0.0, Split::Train), (1.0, Split::Test)] {
            let mut rows = [row("/a.csv"), row("/b.csv"), row("/c.csv")];
            split(&mut rows, test, Flights::Logs);
            assert!(rows.iter().all(|own| own.split == Some(side)));
        }
    }

    /// Two names that look the same, as their bytes are not UTF-8, have rows and parts of their own.
    #[cfg(unix)]
    #[test]
    fn bytes_of_a_path_are_its_key() {
        use std::ffi::OsStr;
        use std::os::unix::ffi::OsStrExt;
        let settings = Settings::new(serde_json::Value::Null);
        let rows = [&b"/logs/a\xff.csv"[..], &b"/logs/a\xfe.csv"[..]].map(|bytes| {
            let own = Row::new(Path::new(OsStr::from_bytes(bytes)), &settings);
            assert_eq!((own.key(), own.log_bytes.clone()), (bytes.to_vec(), Some(hex(bytes))));
            assert_eq!(own.path(), Path::new(OsStr::from_bytes(bytes)));
            own
        });
        assert_eq!(rows[0].log, rows[1].log);
        assert_ne!(rows[0].parts(), rows[1].parts());
        assert_eq!(row("/logs/a.csv").key(), b"/logs/a.csv");
    }
}
