//! Flight logs, message by message: PX4's `ULog`, `ArduPilot`'s `DataFlash`, `MAVLink` telemetry, bags of ROS 1 and ROS 2, MCAP
//! files, Betaflight's blackbox.
//!
//! All formats read alike: [`Kind::of`] recognises a log by its first bytes, [`Reading`] gives its messages in the order
//! of the file, and a message gives its numbers by the name of their field. Memory does not grow with the log, but for
//! `ULog`, which is read whole. Logs packed by gzip or Zstandard are unpacked on the way.
//!
//! **Damage.** An [`Error`] names the byte at which a log is damaged. With [`Damage::Skip`] reading goes on behind it, and
//! [`Reading::notes`] says what was left out. No log makes a reader panic: a thousand damaged logs of each kind are a test.
//!
//! ```no_run
//! use flight_logs::{Damage, Kind, Reading};
//! use std::path::Path;
//!
//! let path = Path::new("flight.ulg");
//! let kind = Kind::of(path)?.expect("a log");
//! let mut log = Reading::open(path, kind, Damage::Skip)?;
//! while log.advance()? {
//!     if log.topic() == "sensor_combined" {
//!         println!("{} µs: {:?}", log.time()?, log.number("gyro_rad[0]")?);
//!     }
//! }
//! # Ok::<(), flight_logs::Error>(())
//! ```
//!
//! The readers are written here and not taken from other crates, because each names the byte of a fault and can go on
//! behind it. Compared in November 2026: `mcap` 0.26 takes a damaged chunk without a word unless it is asked to look at
//! checksums, and ends there if it is; `blackbox-log` 0.4.3 refuses a log whose head names no firmware that it knows;
//! `ardupilot-binlog` 0.2 passes damage over without a word, and ends there after 256 places; `yule_log` 0.4 is what the tests of this repository compare with; `SQLite` itself needs a C compiler.

mod bag;
mod blackbox;
mod bytes;
mod chunk;
mod dataflash;
pub mod definition;
mod error;
mod faults;
pub mod files;
mod known;
#[cfg(any(test, feature = "made"))]
#[doc(hidden)]
pub mod made;
mod mavlink;
mod mcap;
#[cfg(test)]
mod mutated;
mod reading;
mod rosbag2;
mod sqlite;
mod topic;
mod ulog;
mod window;
mod wire;
pub mod zstd;

pub use bytes::GZIP;
pub use error::{Error, ErrorKind, MessageFault, Rest, Result};
pub use faults::Faults;
pub use reading::{Reading, microseconds};
pub use topic::Topic;
pub use wire::{Fault, Wire};

use bytes::Bytes;
use std::path::Path;

/// The place and time of one message of a log.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// The index of its topic among [`Log::topics`].
    pub topic: usize,
    /// The time at which it was recorded, in ns.
    pub time: i64,
    /// Its place in the file in bytes, or that of its chunk.
    pub at: u64,
    /// Its number on its topic, if the log counts messages.
    pub sequence: Option<u32>,
}

/// A log that is read from its start to its end.
pub trait Log {
    /// Goes to the next message.
    ///
    /// # Errors
    /// Returns an error if the log is damaged and [`Damage::Refuse`] was asked for.
    fn next(&mut self) -> Result<Option<Entry>>;

    /// Returns the topics found so far; [`Entry::topic`] is an index into them.
    fn topics(&self) -> &[Topic];

    /// Returns the bytes of the message that came last.
    fn message(&self) -> &[u8];

    /// Returns the faults found so far, to add to and to report; complete at the end of the log.
    fn faults(&mut self) -> &mut Faults;
}

/// The treatment of damaged places.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Damage {
    /// A damaged log is an error.
    #[default]
    Refuse,
    /// Damaged places are left out, counted and noted.
    Skip,
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
    /// A Betaflight blackbox log.
    Blackbox,
    /// A PX4 log.
    Ulog,
    /// An `ArduPilot` log, `.bin`.
    ArduPilot,
    /// An `ArduPilot` log as text, `.log`.
    ArduPilotText,
    /// A telemetry log of a ground station, `.tlog`.
    Mavlink,
}

impl Kind {
    /// Finds a log's kind from its first bytes, packed or not; `None` if the file is no log.
    ///
    /// # Errors
    /// Returns an error if the file cannot be opened or read, or promises a log by its name and is none: a directory
    /// without `metadata.yaml`, or a file `.ulg` with other bytes.
    pub fn of(path: &Path) -> Result<Option<Self>> {
        if path.file_name().is_some_and(|name| name == rosbag2::METADATA) {
            return Ok(Some(Self::Directory));
        }
        if files::is_dir(path) {
            return if files::is_file(&path.join(rosbag2::METADATA)) {
                Ok(Some(Self::Directory))
            } else {
                Err(Error::not_a_log(path.display().to_string(), NO_BAG))
            };
        }
        // What can be read only once is no log.
        if !files::is_file(path) {
            bytes::open(path)?;
            return Ok(None);
        }
        let mut start = Vec::new();
        let read = Bytes::open(path)?.take(dataflash::LOOKED_AT, &mut start);
        let is_named = path.extension().is_some_and(|own| own == "ulg");
        match (read, of_start(&start)) {
            (Err(error), _) if is_named => Err(Error::of(path, ErrorKind::Unpack(error))),
            // What cannot be unpacked is no log.
            (Err(_), _) => Ok(None),
            (Ok(_), None) if is_named && start.is_empty() => Err(Error::of(path, ErrorKind::Empty)),
            (Ok(_), None) if is_named => {
                Err(Error::not_a_log(path.display().to_string(), ulog::OTHER))
            }
            (Ok(_), kind) => Ok(kind),
        }
    }

    /// Returns the topic that is meant unless another is named.
    pub fn usual_topic(self) -> Option<&'static str> {
        match self {
            Self::Blackbox => Some(blackbox::MAIN),
            Self::Bag
            | Self::Mcap
            | Self::Sqlite
            | Self::Directory
            | Self::Ulog
            | Self::ArduPilot
            | Self::ArduPilotText
            | Self::Mavlink => None,
        }
    }
}

/// The error of a directory that is no log.
const NO_BAG: &str = "a directory, and no bag of ROS 2, which has a file metadata.yaml";

/// The kind of a log that starts with these bytes.
fn of_start(start: &[u8]) -> Option<Kind> {
    let kinds = [
        (bag::START, Kind::Bag),
        (mcap::START, Kind::Mcap),
        (sqlite::START, Kind::Sqlite),
        (blackbox::START, Kind::Blackbox),
        (ulog::START, Kind::Ulog),
    ];
    let kind = kinds.into_iter().find(|(own, _)| start.starts_with(own)).map(|(_, kind)| kind);
    let looked_into = || {
        let is_begun = |window: &[u8]| window == dataflash::START;
        if start.windows(dataflash::START.len()).any(is_begun) {
            Some(Kind::ArduPilot)
        } else if dataflash::is_text(start) {
            Some(Kind::ArduPilotText)
        } else {
            mavlink::is_log(start).then_some(Kind::Mavlink)
        }
    };
    kind.or_else(looked_into)
}

/// The code of the README, for doctests alone.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;

/// Opens a log.
///
/// # Errors
/// Returns an error if the log cannot be opened, or its start is damaged.
pub fn open(path: &Path, kind: Kind, damage: Damage) -> Result<Box<dyn Log>> {
    let faults = Faults::new(&path.display().to_string(), damage);
    Ok(match kind {
        Kind::Bag => Box::new(bag::Bag::open(path, faults)?),
        Kind::Mcap => Box::new(mcap::Mcap::open(path, faults)?),
        Kind::Sqlite => Box::new(rosbag2::Sqlite::open(path, faults)?),
        Kind::Blackbox => Box::new(blackbox::Blackbox::open(path, faults)?),
        Kind::Ulog => Box::new(ulog::Ulog::open(path, faults)?),
        Kind::ArduPilot => Box::new(dataflash::Binary::open(path, faults)?),
        Kind::ArduPilotText => Box::new(dataflash::Text::open(path, faults)?),
        Kind::Mavlink => Box::new(mavlink::Mavlink::open(path, faults)?),
        Kind::Directory => Box::new(rosbag2::Directory::open(path, faults)?),
    })
}
