//! Reasons for which a stream of events cannot be read or written.

use crate::error::room;
use catalogue::kinds;
use spikewire::link::Coding;
use spikewire_cameras::format::FormatError;

kinds! {
    /// The reason for which a stream of events cannot be read or written.
    pub enum EventsKind by spell of subject {
        // Formats by name.
        NoFormat { name: String } => ("no format `{name}`; there are {}", super::format::NAMES),
        NoPair { pair: String } => ("`{pair}` must be KEY=NUMBER"),
        OutOfRange { key: String, text: String } => ("{key}={text} is no number of its range"),
        NotABit { key: String, number: u32 } => ("{key}={number} must be 0 or 1"),
        TakesNoKey { format: String, key: String } => ("{format} takes no {key}="),
        PeriodOrJitter { text: String } => (
            "{text}: the period must be 1 to {} µs, the jitter at most 15 bits, step-bits at most 4",
            Coding::LONGEST_PERIOD
        ),
        Step { text: String } => ("{text}: the step must be above 0 µs"),
        HalfASize => ("width= and height= go together, and are 1 or more"),
        ReadOnly { format: String } => ("{format} is read, and not written; evt2 and evt3 are written"),
        TimesOfEdvs => ("edvs: how it sends times must follow, edvs:e0 to edvs:e4"),
        // Bytes of a format other than the expected one.
        NotAnEventStream => ("not an Event Stream of version 2, of generic events or of a camera's (DVS)"),
        OtherVersion { version: &'static str, name: String } =>
            ("the header says EVT {version}, which the format `{name}` reads"),
        ByteOrder { order: String } =>
            ("the header says `endianness={order}`, where `little` and `legacy` are read"),
        WhichByteOrder => (
            "the header does not say the order of the bytes, and the words do not show it: `evt21,legacy=0` (GenX320) \
             or `evt21,legacy=1` (IMX636) says it"
        ),
        FarRows { events: u64 } => (
            "events without an address, in rows from 32 on: {events}; `evt2,pixels=1` reads columns and rows"
        ),
        OtherFormat { format: String, what: &'static str, bytes: u64 } =>
            ("no {format} {what} in the {bytes} bytes; are they of another format?"),
        // Events that a format cannot express.
        NoWord { event: u64, error: FormatError } => ("event {event}: {error}; {} goes on", spell("drop")),
        NoPixels =>
            ("events of a camera have columns and rows, for which es, evt2, evt3 and csv have a place"),
        NoSize => ("the header of es has the size of the picture: `es,width=320,height=240`"),
        NoAddresses => ("addresses among columns and rows"),
        NoDirection { event: u64, address: u16 } => (
            "event {event} at address {address}: a key of 32 bits has no direction; signed=1 gives an address two keys, \
             {} goes on",
            spell("drop")
        ),
        // Tables of events.
        Empty => ("empty; a table of events starts with `{}`", super::csv::HEADER),
        NoHeader { text: String } => (
            "`{text}`, where `{}` or `{}` should stand (or `time_us` for `tick`)",
            super::csv::HEADER,
            super::csv::PIXELS
        ),
        LongLine { most: usize } => ("longer than {most} bytes; is it a table?"),
        NotACount { text: String } => ("`{text}` is not a count"),
        Frames { text: String } => ("`{text}` is not a number of frames"),
        Tick { text: String } => ("tick `{text}` is not a number of µs from 0 on"),
        Address { text: String } => ("address `{text}` is not a number from 0 to {}", u16::MAX),
        Pixel { column: &'static str, text: String } =>
            ("{column} `{text}` is not a number from 0 to {}", u16::MAX),
        Polarity { text: String } => ("polarity `{text}` is neither 1 nor -1"),
        Heartbeat { text: String } => ("heartbeat `{text}` is not TICK,ADDRESS"),
        Keyframe { text: String } => (
            "keyframe `{text}` is not TICK,ADDRESS,BITS,TYPE with 4 or 8 hexadecimal digits and a sample type"
        ),
        NoEnd => ("ends without `# samples=` and `# events=`; is it cut short?"),
        OtherCount { events: u64, said: u64 } => ("holds {events} events where its end says {said}"),
    }
}
room!(EventsKind, Events);
