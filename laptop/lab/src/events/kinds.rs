//! Reasons for which a stream of events cannot be read or written.

use crate::error::room;
use catalogue::kinds;
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
        PeriodOrJitter { text: String } => ("{text}: the period must be above 0 µs, the jitter at most 15 bits"),
        Step { text: String } => ("{text}: the step must be above 0 µs"),
        TimesOfEdvs => ("edvs: how it sends times must follow, edvs:e0 to edvs:e4"),
        // Bytes of a format other than the expected one.
        NotAnEventStream => ("not an Event Stream of version 2 and of generic events"),
        OtherFormat { format: String, what: &'static str, bytes: u64 } =>
            ("no {format} {what} in the {bytes} bytes; are they of another format?"),
        // Events that a format cannot express.
        NoWord { event: u64, error: FormatError } => ("event {event}: {error}; {} goes on", spell("drop")),
        NoDirection { event: u64, address: u16 } => (
            "event {event} at address {address}: a key of 32 bits has no direction; signed=1 gives an address two keys, \
             {} goes on",
            spell("drop")
        ),
        // Tables of events.
        Empty => ("empty; a table of events starts with `{}`", super::csv::HEADER),
        NoHeader { text: String } =>
            ("`{text}`, where `{}` should stand (or `time_us` for `tick`)", super::csv::HEADER),
        LongLine { most: usize } => ("longer than {most} bytes; is it a table?"),
        NotACount { text: String } => ("`{text}` is not a count"),
        Frames { text: String } => ("`{text}` is not a number of frames"),
        Tick { text: String } => ("tick `{text}` is not a number of µs from 0 on"),
        Address { text: String } => ("address `{text}` is not a number from 0 to {}", u16::MAX),
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
