//! Logs of messages on topics: ROS bags, MCAP files, Betaflight's blackbox, PX4's flight logs.
//!
//! Each kind of log gives its messages one after the other, in the order of the file, so that memory does not grow but
//! for PX4's.
//!
//! The readers are our own, as each names the byte of a fault and can go on behind it. Compared with them in November 2026,
//! with the crates that each would add: `mcap` 0.26 (17) takes a damaged chunk without a word unless it is asked to look at
//! checksums, and ends there if it is; `blackbox-log` 0.4.3 (17) refuses a log whose head names no firmware that it knows;
//! `yule_log` 0.4 (18) is what our tests compare with; `SQLite` itself needs a C compiler. `cargo verify logs` compares all
//! with other readers.

mod bag;
mod blackbox;
mod bytes;
mod channel;
mod chunk;
mod definition;
mod faults;
mod known;
#[cfg(test)]
#[path = "../../../../cli/tests/common/logs.rs"]
mod made;
mod mcap;
#[cfg(test)]
mod mutated;
mod reading;
mod rosbag2;
mod sqlite;
mod topic;
mod ulog;
mod wire;

pub use channel::Channel;
pub use reading::Reading;
pub use topic::{Overview, overview};

use crate::files::{self, File};
use anyhow::{Context, Result};
use bytes::Bytes;
use faults::Faults;
use std::path::Path;
use topic::Topic;

/// One message of a log.
#[derive(Clone, Copy, Debug)]
struct Entry {
    /// The index of its topic among the log's.
    topic: usize,
    /// The time at which it was recorded, in ns.
    pub time: i64,
    /// Its place in the file, or that of its chunk.
    pub at: u64,
    /// Its number on its topic, if the log counts them.
    pub sequence: Option<u32>,
}

/// A log that is read from its start to its end.
trait Log {
    /// Goes to the next message.
    ///
    /// # Errors
    /// The log is damaged, and that was not accepted.
    fn next(&mut self) -> Result<Option<Entry>>;

    /// The topics that came up until now; entries say their places.
    fn topics(&self) -> &[Topic];

    /// The bytes of the message that came last.
    fn message(&self) -> &[u8];

    /// The faults found so far, to add to and to report; complete at the end.
    fn faults(&mut self) -> &mut Faults;
}

/// The kinds of logs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A ROS 1 bag.
    Bag,
    /// An MCAP file.
    Mcap,
    /// A ROS 2 bag of one file.
    Sqlite,
    /// A ROS 2 bag of several files.
    Directory,
    /// Betaflight's.
    Blackbox,
    /// PX4's.
    Ulog,
}

impl Kind {
    /// The topic that is meant unless another is named.
    fn usual_topic(self) -> Option<&'static str> {
        match self {
            Self::Blackbox => Some(blackbox::MAIN),
            Self::Bag | Self::Mcap | Self::Sqlite | Self::Directory | Self::Ulog => None,
        }
    }
}

/// Finds a log's kind from its first bytes, packed or not.
///
/// # Errors
/// Returns an error if the file cannot be opened or read.
pub fn kind_of(path: &Path) -> Result<Option<Kind>> {
    const START: u64 = 32;
    if files::is_dir(path) || path.file_name().is_some_and(|name| name == rosbag2::METADATA) {
        return Ok(Some(Kind::Directory));
    }
    if path.extension().is_some_and(|own| own == "ulg") {
        return Ok(Some(Kind::Ulog));
    }
    // What can be read only once is no log.
    if !files::is_file(path) {
        File::open(path).with_context(|| format!("{}: cannot be opened", path.display()))?;
        return Ok(None);
    }
    let mut start = Vec::new();
    // What cannot be unpacked is no log.
    if Bytes::open(path)?.take(START, &mut start).is_err() {
        return Ok(None);
    }
    Ok(kind(&start))
}

/// The kind of a log that starts with these bytes.
fn kind(start: &[u8]) -> Option<Kind> {
    let kinds = [
        (bag::START, Kind::Bag),
        (mcap::START, Kind::Mcap),
        (sqlite::START, Kind::Sqlite),
        (blackbox::START, Kind::Blackbox),
        (ulog::START, Kind::Ulog),
    ];
    kinds.into_iter().find(|(own, _)| start.starts_with(own)).map(|(_, kind)| kind)
}

/// Opens a log.
///
/// # Errors
/// Returns an error if the log cannot be opened, or its start is damaged.
fn open(path: &Path, kind: Kind, accept_cut: bool) -> Result<Box<dyn Log>> {
    let file = path.display().to_string();
    let faults = Faults::new(&file, accept_cut);
    Ok(match kind {
        Kind::Bag => Box::new(bag::Bag::open(path, faults)?),
        Kind::Mcap => Box::new(mcap::Mcap::open(path, faults)?),
        Kind::Sqlite => Box::new(rosbag2::Sqlite::open(path, faults)?),
        Kind::Blackbox => Box::new(blackbox::Blackbox::open(path, faults)?),
        Kind::Ulog => Box::new(ulog::Ulog::open(path, faults)?),
        Kind::Directory => Box::new(rosbag2::Directory::open(path, faults)?),
    })
}
