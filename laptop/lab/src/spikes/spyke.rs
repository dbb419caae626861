//! The message types of the toolbox that belongs to the paper *A toolbox for neuromorphic perception in robotics*. A
//! message holds the spikes of one sample, with parameters for decoding.

use super::recorder::Format;
use std::time::Duration;

/// A message of the paper's toolbox: the spikes of one sample, and parameters for decoding.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Spyke {
    /// Number of spikes of each neuron in each sub-timestep (part of a sample). The number is negative for spikes of
    /// polarity down. The numbers are sorted by sub-timestep, and within each sub-timestep by neuron.
    pub spikes: Vec<i8>,
    /// Value from which decoding starts.
    pub start: f32,
    /// The smallest and the largest sample of the recording.
    pub range: (f32, f32),
    /// The threshold; 0 if the scheme has none.
    pub threshold: f32,
    /// The sample that was encoded.
    pub input: f32,
    /// Name of the scheme, as the paper's toolbox spells it.
    pub scheme: &'static str,
    /// Time of the sample by the recording's clock. If the recording has no times, the time since the first sample.
    pub time: Duration,
}

/// A type of ROS message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// A spike of one neuron.
    Spyke,
    /// Spikes of several neurons, or of several sub-timesteps.
    SpykeArray,
    /// Text.
    String,
}

/// Definition of the fields that follow the spikes in the messages `spyke` and `spyke_array`, as text in the format of
/// ROS.
const FIELDS: &str = "float32 start
float32 min_input
float32 max_input
float32 threshold
float32 input
string scheme
";

impl Kind {
    /// Returns the type's name in ROS 1.
    pub(crate) fn ros1(self) -> &'static str {
        match self {
            Self::Spyke => "spyke_msgs/spyke",
            Self::SpykeArray => "spyke_msgs/spyke_array",
            Self::String => "std_msgs/String",
        }
    }

    /// Returns the type's name in ROS 2.
    pub(crate) fn ros2(self) -> &'static str {
        match self {
            Self::Spyke => "spyke_msgs/msg/Spyke",
            Self::SpykeArray => "spyke_msgs/msg/SpykeArray",
            Self::String => "std_msgs/msg/String",
        }
    }

    /// Returns the definition of the type for ROS 1.
    pub(crate) fn definition_ros1(self) -> String {
        match self {
            Self::Spyke => format!("int8 spike\n{FIELDS}time timestamp\n"),
            Self::SpykeArray => format!("int8[] spike\n{FIELDS}time timestamp\n"),
            Self::String => "string data\n".to_owned(),
        }
    }

    /// Returns the definition of the message type in the format of ROS 2, followed by the definitions of nested types.
    pub(crate) fn definition_ros2(self) -> String {
        let time = "builtin_interfaces/Time timestamp";
        let line = "=".repeat(80);
        let within = format!("{line}\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n");
        match self {
            Self::Spyke => format!("int8 spike\n{FIELDS}{time}\n{within}"),
            Self::SpykeArray => format!("int8[] spike\n{FIELDS}{time}\n{within}"),
            Self::String => "string data\n".to_owned(),
        }
    }

    /// Returns the MD5 checksum by which ROS 1 identifies the type. It is computed from the type's definition without
    /// the comments.
    pub(crate) fn md5(self) -> &'static str {
        match self {
            Self::Spyke => "3fe7d788a9984f98947655b57e7a8ced",
            Self::SpykeArray => "f28be150c39fd56a163d9183d695ebc5",
            Self::String => "992ce8a1687cec8c8bd883ec73ca41d1",
        }
    }
}

impl Spyke {
    /// Encodes the message as ROS 1 does if `format` is a bag, and as ROS 2 does if `format` is MCAP. ROS 2 uses the
    /// encoding CDR, which has a prefix of four bytes, aligns numbers to four bytes, and ends strings with NUL.
    pub(crate) fn bytes(&self, kind: Kind, format: Format) -> Vec<u8> {
        let mut bytes = start(format);
        if kind == Kind::SpykeArray {
            bytes.extend((self.spikes.len() as u32).to_le_bytes());
        }
        bytes.extend(self.spikes.iter().map(|spike| spike.to_le_bytes()[0]));
        align(&mut bytes, format);
        for number in self.numbers() {
            bytes.extend(number.to_le_bytes());
        }
        add_text(&mut bytes, self.scheme, format);
        align(&mut bytes, format);
        bytes.extend((self.time.as_secs() as u32).to_le_bytes());
        bytes.extend(self.time.subsec_nanos().to_le_bytes());
        bytes
    }

    fn numbers(&self) -> [f32; 5] {
        [self.start, self.range.0, self.range.1, self.threshold, self.input]
    }
}

/// Encodes a message that consists of a text.
pub(crate) fn text(text: &str, format: Format) -> Vec<u8> {
    let mut bytes = start(format);
    add_text(&mut bytes, text, format);
    bytes
}

/// Returns the first bytes of a message: none in ROS 1, and in ROS 2 the prefix of little-endian CDR.
fn start(format: Format) -> Vec<u8> {
    match format {
        Format::Bag => Vec::new(),
        Format::Mcap => vec![0, 1, 0, 0],
    }
}

fn add_text(bytes: &mut Vec<u8>, text: &str, format: Format) {
    let end: &[u8] = if format == Format::Mcap { &[0] } else { &[] };
    bytes.extend(((text.len() + end.len()) as u32).to_le_bytes());
    bytes.extend(text.as_bytes());
    bytes.extend(end);
}

/// Pads a message of ROS 2 to a multiple of four bytes. In ROS 1, nothing is padded.
fn align(bytes: &mut Vec<u8>, format: Format) {
    if format == Format::Mcap {
        bytes.resize(bytes.len().next_multiple_of(4), 0);
    }
}
