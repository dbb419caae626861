//! Reasons for which a recording cannot be read.

use super::{TimeUnit, UnevenRate};
use crate::error::room;
use catalogue::kinds;
use flight_logs::Rest;

kinds! {
    /// The reason for which a table of samples cannot be read.
    pub enum TableKind by spell of subject {
        Empty => ("empty; a CSV table starts with a header"),
        NoSamples => ("no samples below the header"),
        Uneven { line: u64, columns: u64, expected: u64 } => (
            "line {line} has {columns} columns where the header has {expected}; {} leaves such lines out",
            spell("skip_non_finite")
        ),
        OtherHeader { line: u64, columns: u64, expected: u64, header: u64 } => (
            "line {line} has {columns} columns where the header has {expected}; {} {header} takes its names for the \
             first columns, if they are those",
            spell("header")
        ),
        Unreadable { error: csv::Error } => ("{error}"),
        NotUnpacked { error: std::io::Error } => ("cannot be unpacked: {error}"),
        NoTable { what: &'static str } => ("{what}"),
        OddTable { what: String } => ("{what}"),
        NoChannel => ("no channel"),
        // Values.
        NotANumber { value: String } => ("value `{value}` is not a number"),
        NotATime { value: String } => ("value `{value}` is not a time"),
        Missing { value: String } =>
            ("value `{value}` is missing; {} goes on over such values", spell("skip_non_finite")),
        NotFinite { value: String } =>
            ("{value} is not finite; {} goes on over such values", spell("skip_non_finite")),
        NoneFinite { samples: usize } => ("none of the {samples} samples is finite"),
        // Columns.
        NoColumn { name: String, near: String, comment: Option<u64> } =>
            ("no column `{name}`; {near}{}", match comment {
                None => String::new(),
                Some(line) => format!("; {} {line} takes the names of the comment there", spell("header")),
            }),
        NoColumnNumber { number: String, columns: usize } =>
            ("no column {number}; columns are numbered from 1 to {columns}"),
        WhichColumn { columns: String } => ("{} must say which; there are {columns}", spell("columns")),
        OneColumn { command: String } => ("{command} takes one column, not all"),
        OneChannel { command: String, channels: usize } =>
            ("{command} takes one column or field, not {channels}; encode takes several"),
        UnevenRate { uneven: UnevenRate } => (
            "the times give {uneven}, as those of samples that arrive in bursts; {} says how many a second are taken",
            spell("rate")
        ),
        WhichUnit { column: String, unit: TimeUnit, rate: f64 } => (
            "times of column `{column}` in {unit} would be {rate:.2} samples a second; {} says their unit",
            spell("time_unit")
        ),
        NoTimes => ("{subject}: no column is known to hold times; {} says which", spell("time")),
        // Settings.
        TakesNo { what: &'static str } => ("{what} takes no {subject}"),
        Delimiter => ("{subject} must be one character, `tab` or `space`"),
        TimeUnit => ("{subject} must be `s`, `ms`, `us` or `ns`"),
        NotAboveZero => ("{subject} must be a number above 0 and finite"),
    }
}
room!(TableKind, Table);

kinds! {
    /// The reason for which a channel of a flight log cannot be read.
    pub enum LogKind by spell of subject {
        Unread { error: flight_logs::Error } => ("{error}{}", match error.kind.rest() {
            None => std::error::Error::source(error).map_or(String::new(), |why| format!(": {why}")),
            Some(Rest::Behind) => format!("; {} goes on behind it", spell("accept_cut")),
            Some(Rest::From(next)) => format!("; {} goes on at byte {next}", spell("accept_cut")),
            Some(Rest::Before) => format!("; {} takes what is before", spell("accept_cut")),
        }),
        NeedsChannel { example: Option<String>, is_one: bool } => ("{}{}", match is_one {
            true => format!("a log needs {}", spell("columns")),
            false => format!("no name tells a gyroscope or an accelerometer; {} says what to read", spell("columns")),
        }, match example {
            Some(example) => format!(", such as {} '{example}'", spell("columns")),
            None => ", and no topic of this one holds numbers".to_owned(),
        }),
        NoChannelOf { name: String, near: String } => ("no channel `{name}`; {near}"),
        SeveralTopics { topics: String, example: String } => (
            "the channels are of several topics, {topics}; {} takes those of one, such as '{example}'",
            spell("columns")
        ),
        Undefined { topic: String, kind: String, why: String } => ("topic {topic} of {kind}: {why}"),
        NoTopic { topic: String, near: String } => ("no topic `{topic}`; {near}"),
        NoMessages { topic: String } => ("topic {topic} has no messages"),
        NoField { topic: String, field: String, near: String } => ("topic {topic} has no field `{field}`; {near}"),
        TextField { topic: String, field: String } => ("topic {topic}: field `{field}` is text, not a signal"),
        SeveralNumbers { topic: String, field: String, numbers: String } =>
            ("topic {topic}: field `{field}` is not one number but several; there are {numbers}"),
        NotFinite { topic: String, field: String, value: f64, time: i64, sample: u64 } => (
            "topic {topic}, field {field}: {value} at {time} µs (sample {sample}) is missing or not finite; {} goes on \
             over such values",
            spell("skip_non_finite")
        ),
    }
}
room!(LogKind, Log);
