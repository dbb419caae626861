//! Reasons that a data set cannot be made or read.

use crate::error::room;
use catalogue::kinds;

kinds! {
    /// The reason that a data set cannot be made or read.
    pub enum DatasetKind by spell of subject {
        NoLogs => ("no logs: name files, directories or patterns such as `logs/*.ulg`"),
        NoneInside => (
            "no logs in this directory, and no tables: files that end in .{}", super::paths::TABLES.join(", .")
        ),
        NotComplete => ("the data set is not complete; run `spikewire dataset` again"),
        NoFlight { side: &'static str } => ("the data set has no flight for {side}; {} chooses others", spell("split")),
        NoneThere => ("no file of this name, and none that matches it"),
        Pattern { error: glob::PatternError } => ("no pattern: {error}"),
        KindOfLog { name: String } => (
            "{subject} {name}: there are {}, followed by `=` and channels", super::NAMES.join(", ")
        ),
        OtherCount { names: usize, channels: usize } =>
            ("{subject} has {names} names for {channels} channels of the flight"),
        OtherSettings => ("holds parts of other settings or another version; choose another directory"),
        InUse => ("another run is writing here"),
        NoRow { error: serde_json::Error } => ("no row of a manifest: {error}"),
        NoPart { what: String } => ("no part that `spikewire dataset` wrote: {what}"),
        Share => ("{subject} must be from 0 to 1"),
    }
}
room!(DatasetKind, Dataset);
