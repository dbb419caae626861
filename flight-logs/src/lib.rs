//! Reads flight logs message by message: PX4's `ULog`, `ArduPilot`'s `DataFlash`, `MAVLink` telemetry, bags of ROS 1
//! and ROS 2, MCAP files, and Betaflight's blackbox.
//!
//! All formats are read in the same way. [`Kind::of`] recognises a log by its first bytes. [`Reading`] returns its
//! messages in the order of the file, and reads the numbers of a message by the names of their fields. Memory use does
//! not grow with the length of the log, except for `ULog`, which is read as a whole. Logs compressed by gzip,
//! Zstandard, bzip2 or xz are decompressed while they are read.
//!
//! **Damage.** An [`Error`] names the byte at which a log is damaged. With [`Damage::Skip`], reading continues after
//! the damage, and [`Reading::notes`] lists what was left out. No log makes a reader panic; the tests read a thousand
//! damaged logs of each kind.
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
//! The readers are not taken from other crates, because they must name the byte of a fault and be able to continue
//! after the fault. As of November 2026, `mcap` 0.26 accepts a damaged chunk silently, or stops at it if checksums are
//! turned on; `blackbox-log` 0.4.3 refuses a log whose header names a firmware that it does not know;
//! `ardupilot-binlog` 0.2 passes over damage silently, and stops after 256 damaged places; `SQLite` itself needs a C
//! compiler. `yule_log` 0.4 serves the tests of this repository as an independent reader of `ULog`.

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
mod packed;
mod reading;
mod rosbag2;
mod sqlite;
mod topic;
mod ulog;
mod window;
mod wire;
mod zstd;

pub use error::{Error, ErrorKind, MessageFault, Rest, Result};
pub use faults::Faults;
pub use packed::Packing;
pub use reading::{Reading, microseconds};
pub use topic::Topic;
pub use wire::{Fault, Wire};

use bytes::Bytes;
use std::path::Path;

/// Time and position of a message in a log.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// Index of the message's topic in [`Log::topics`].
    pub topic: usize,
    /// Time at which the message was recorded, in ns. The origin of the time depends on the format: for example, the
    /// year 1970, or the start of the flight controller.
    pub time: i64,
    /// Offset in the file of the message, or of the chunk that contains it, in bytes.
    pub at: u64,
    /// Sequence number of the message on its topic, if the log has one.
    pub sequence: Option<u32>,
}

/// A log that is read from start to end.
pub trait Log {
    /// Reads the next message; returns `None` at the end of the log.
    ///
    /// # Errors
    /// Returns an error if the log cannot be read, or if it is damaged and was opened with [`Damage::Refuse`].
    fn next(&mut self) -> Result<Option<Entry>>;

    /// Returns the topics found so far; [`Entry::topic`] is an index into them.
    fn topics(&self) -> &[Topic];

    /// Returns the bytes of the message that [`next`](Self::next) read last.
    fn message(&self) -> &[u8];

    /// Returns the unit of a field's numbers, such as `deg/s`, if the log gives it. `g/2048` is the unit of a sensor's
    /// counts, of which 2048 are 1 g. `topic` is an index into [`topics`](Self::topics).
    fn unit(&self, topic: usize, field: &str) -> Option<String> {
        let _ = (topic, field);
        None
    }

    /// Returns the faults found so far. Callers may report them, or add further faults. The faults are complete at the
    /// end of the log.
    fn faults(&mut self) -> &mut Faults;
}

/// Reaction to damage in a log.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Damage {
    /// Return an error at the first damage. Bad frames in a blackbox log are only noted, because the recorder drops
    /// frames even in a good flight.
    #[default]
    Refuse,
    /// Leave out the damaged parts, count them, and describe them in the notes.
    Skip,
}

/// Format of a log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A ROS 1 bag.
    Bag,
    /// An MCAP file.
    Mcap,
    /// A ROS 2 bag that is a single `SQLite` file.
    Sqlite,
    /// A ROS 2 bag that is a directory of files.
    Directory,
    /// A Betaflight blackbox log.
    Blackbox,
    /// A PX4 log.
    Ulog,
    /// An `ArduPilot` log in binary form, `.bin`.
    ArduPilot,
    /// An `ArduPilot` log in text form, `.log`.
    ArduPilotText,
    /// A telemetry log of a ground station, `.tlog`.
    Mavlink,
}

impl Kind {
    /// Recognises the format of a log by its first bytes, compressed or not; returns `None` if the file is not a log.
    ///
    /// # Errors
    /// Returns an error if the file cannot be opened or read, if the path is a directory without `metadata.yaml`, or if
    /// a file with the extension `.ulg` is not a `ULog` file.
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
        // Anything that can be read only once, such as a pipe, is not a log.
        if !files::is_file(path) {
            bytes::open(path)?;
            return Ok(None);
        }
        let mut start = Vec::new();
        let read = Bytes::open(path)?.take(LOOKED_AT, &mut start);
        let is_named = path.extension().is_some_and(|extension| extension == "ulg");
        match (read, of_start(&start)) {
            (Err(error), _) if is_named => Err(Error::of(path, ErrorKind::Unpack(error))),
            // A file that cannot be decompressed is not a log.
            (Err(_), _) => Ok(None),
            (Ok(_), None) if is_named && start.is_empty() => Err(Error::of(path, ErrorKind::Empty)),
            (Ok(_), None) if is_named => {
                Err(Error::not_a_log(path.display().to_string(), ulog::OTHER))
            }
            (Ok(_), kind) => Ok(kind),
        }
    }

    /// Recognises the format of a log by its first bytes; 8 KiB are enough. If the log is compressed, decompress it
    /// first. Returns `None` if the bytes are not the start of a log. For a ROS 2 bag that is a directory, use
    /// [`Kind::of`] instead.
    pub fn of_start(start: &[u8]) -> Option<Self> {
        of_start(start)
    }

    /// Returns the name of the topic that most users want, if the format has one.
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

/// A log must begin within this number of bytes from the start of its file: some loggers write other text first, and
/// some programs that fetch logs from a controller add or lose bytes.
const LOOKED_AT: u64 = 8192;

/// Error text for a directory that is not a ROS 2 bag.
const NO_BAG: &str = "a directory, and no bag of ROS 2, which has a file metadata.yaml";

/// Recognises the format of a log by its first decompressed bytes; returns `None` if they are not the start of a log.
fn of_start(start: &[u8]) -> Option<Kind> {
    let kinds = [
        (bag::START, Kind::Bag),
        (mcap::START, Kind::Mcap),
        (sqlite::START, Kind::Sqlite),
        (blackbox::START, Kind::Blackbox),
        (ulog::START, Kind::Ulog),
    ];
    if let Some((_, kind)) = kinds.into_iter().find(|(first, _)| start.starts_with(first)) {
        return Some(kind);
    }
    if dataflash::is_binary(start) {
        Some(Kind::ArduPilot)
    } else if dataflash::is_text(start) {
        Some(Kind::ArduPilotText)
    } else if mavlink::is_log(start) {
        Some(Kind::Mavlink)
    } else {
        blackbox::start(start).map(|_| Kind::Blackbox)
    }
}

/// Compiles the examples in the README as doctests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;

/// Opens a log of a known format; [`Kind::of`] recognises the format.
///
/// # Errors
/// Returns an error if the log cannot be opened, or if its start is damaged.
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
