//! Reasons for which spikes cannot be read or written.

use crate::error::room;
use catalogue::kinds;

kinds! {
    /// The reason for which a file of spikes, or a log of spikes, cannot be read or written.
    pub enum SpikesKind by spell of subject {
        // The header.
        OtherVersion { version: String, own: &'static str } =>
            ("the header says format `{version}`; this program reads {own}"),
        NoScheme { name: String } => ("the header names no scheme that there is: `{name}`"),
        NotOfItsKind { key: String, value: String } =>
            ("the header says {key}={value}, which is not a number of its kind"),
        Channels { count: usize, most: usize } => ("the header says channels={count}; there are 1 to {most}"),
        NoSuchChannel { key: String, value: String, channels: usize } =>
            ("the header says {key}={value}, where there are {channels} channels from 0 on"),
        TakesNo { key: String, value: String, scheme: String } =>
            ("the header says {key}={value}, which {scheme} does not take"),
        Contradicts { key: String, before: String, value: String } =>
            ("the header contradicts itself: {key}={before}, then {key}={value}"),
        Lacks { key: String } => ("the header lacks `# {key}=`; is it a file of spikes?"),
        NoChannel => ("the header has no channel"),
        // The lines.
        Empty => ("empty; a file of spikes starts with `# key=value` lines"),
        NoEvents => (
            "no events below the header, not even their names; a file of spikes starts with `# key=value` lines"
        ),
        Binary => ("binary, not a file of spikes"),
        NoKey { text: String } => ("`{text}` is not `# key=value`"),
        NoNames { text: String } => (
            "`{text}`, where `index,address,polarity` should stand below `# key=value` lines; is it a file of spikes?"
        ),
        NotAPair { text: String } => ("`{text}` is not SAMPLE,µs"),
        NotACount { text: String } => ("`{text}` is not a count"),
        NotAnEvent { text: String } => ("`{text}` is not an event"),
        NotWhole { text: String } => ("`{text}` is not an event: index and address are whole numbers"),
        Columns { text: String, columns: usize } => ("`{text}` has not the {columns} columns of the header"),
        Polarity { text: String } => ("polarity `{text}`"),
        Address { address: u64, neurons: u64 } => ("address {address} where the header says {neurons} neurons"),
        NoTime { text: String } => ("`{text}` has no time in µs"),
        Falls { sample: u64, previous: u64 } => ("sample {sample} comes after sample {previous}"),
        NoMeaning { key: String } => ("`# {key}=` has no meaning among the events"),
        NoEnd { line: u64 } => ("ends after line {line} without `# samples=` and `# events=`; is it cut short?"),
        OtherCount { events: u64, said: u64 } => ("holds {events} events where its end says {said}"),
        BehindEnd { sample: u64, samples: u64 } =>
            ("has an event at sample {sample} where its end says {samples} samples"),
        // Messages.
        NoMessages { topic: &'static str } =>
            ("no messages of spikes, such as spyke_msgs/spyke on a topic `{topic}`"),
        NotEnough { scheme: String, topic: &'static str } => (
            "messages do not say all that decoding `{scheme}` needs, and there is no topic `{topic}` that does"
        ),
        NoField { name: &'static str } => ("it has no {name}"),
        OutOfOrder { sample: u64 } => ("its sample {sample} comes before or after that of the first channel"),
        Neurons { neurons: usize } => ("it has not the {neurons} neurons of its scheme"),
        Negative { spikes: i8 } => ("a spike of {spikes}, where there are none below 0"),
        Untimed => (
            "messages have times, and these samples none; {} says how many there are a second",
            spell("rate")
        ),
        Time { microseconds: i64 } => ("the time {microseconds} µs does not fit a message: 0 to 2106"),
    }
}
room!(SpikesKind, Spikes);
