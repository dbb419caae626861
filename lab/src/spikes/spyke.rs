//! The messages of the paper's toolbox: what the neurons did for one sample, with what decoding needs.

use std::time::Duration;

/// The message of one sample.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Spyke {
    /// The spikes of each neuron, sub-timestep after sub-timestep: 1, 0 or -1, or how many of one direction.
    pub spikes: Vec<i8>,
    /// The value that decoding starts from.
    pub start: f32,
    /// The smallest and the largest sample.
    pub range: (f32, f32),
    /// The threshold; 0 if the scheme has none.
    pub threshold: f32,
    /// The sample.
    pub input: f32,
    /// The scheme's name.
    pub scheme: &'static str,
    /// The time at which the sample was taken.
    pub time: Duration,
}

/// A kind of message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// A message of one neuron.
    Spyke,
    /// A message of several neurons, or with sub-timesteps.
    SpykeArray,
    /// Text.
    String,
}

/// The fields behind the spikes.
const FIELDS: &str = "float32 start
float32 min_input
float32 max_input
float32 threshold
float32 input
string scheme
";

impl Kind {
    /// Its name in ROS 1.
    pub(crate) fn ros1(self) -> &'static str {
        match self {
            Self::Spyke => "spyke_msgs/spyke",
            Self::SpykeArray => "spyke_msgs/spyke_array",
            Self::String => "std_msgs/String",
        }
    }

    /// Its name in ROS 2.
    pub(crate) fn ros2(self) -> &'static str {
        match self {
            Self::Spyke => "spyke_msgs/msg/Spyke",
            Self::SpykeArray => "spyke_msgs/msg/SpykeArray",
            Self::String => "std_msgs/msg/String",
        }
    }

    /// The definition for ROS 1.
    pub(crate) fn definition_ros1(self) -> String {
        match self {
            Self::Spyke => format!("int8 spike\n{FIELDS}time timestamp\n"),
            Self::SpykeArray => format!("int8[] spike\n{FIELDS}time timestamp\n"),
            Self::String => "string data\n".to_owned(),
        }
    }

    /// The definition for ROS 2, with those of the messages within.
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

    /// The MD5 of the definition without comments, by which ROS 1 tells definitions apart.
    pub(crate) fn md5(self) -> &'static str {
        match self {
            Self::Spyke => "3fe7d788a9984f98947655b57e7a8ced",
            Self::SpykeArray => "f28be150c39fd56a163d9183d695ebc5",
            Self::String => "992ce8a1687cec8c8bd883ec73ca41d1",
        }
    }
}

impl Spyke {
    /// Encodes the message as ROS 1 sends it.
    pub(crate) fn ros1(&self, kind: Kind) -> Vec<u8> {
        let mut bytes = Vec::new();
        if kind == Kind::SpykeArray {
            bytes.extend((self.spikes.len() as u32).to_le_bytes());
        }
        bytes.extend(self.spikes.iter().map(|spike| spike.to_le_bytes()[0]));
        for number in self.numbers() {
            bytes.extend(number.to_le_bytes());
        }
        bytes.extend((self.scheme.len() as u32).to_le_bytes());
        bytes.extend(self.scheme.as_bytes());
        bytes.extend((self.time.as_secs() as u32).to_le_bytes());
        bytes.extend(self.time.subsec_nanos().to_le_bytes());
        bytes
    }

    /// Encodes as CDR, the wire format of ROS 2: four-byte alignment, NUL-terminated strings.
    pub(crate) fn cdr(&self, kind: Kind) -> Vec<u8> {
        let mut bytes = CDR.to_vec();
        if kind == Kind::SpykeArray {
            bytes.extend((self.spikes.len() as u32).to_le_bytes());
        }
        bytes.extend(self.spikes.iter().map(|spike| spike.to_le_bytes()[0]));
        align(&mut bytes);
        for number in self.numbers() {
            bytes.extend(number.to_le_bytes());
        }
        add_text(&mut bytes, self.scheme);
        align(&mut bytes);
        bytes.extend((self.time.as_secs() as i32).to_le_bytes());
        bytes.extend(self.time.subsec_nanos().to_le_bytes());
        bytes
    }

    fn numbers(&self) -> [f32; 5] {
        [self.start, self.range.0, self.range.1, self.threshold, self.input]
    }
}

/// A text as ROS 1 sends it.
pub(crate) fn text_ros1(text: &str) -> Vec<u8> {
    [&(text.len() as u32).to_le_bytes()[..], text.as_bytes()].concat()
}

/// A text as ROS 2 sends it.
pub(crate) fn text_cdr(text: &str) -> Vec<u8> {
    let mut bytes = CDR.to_vec();
    add_text(&mut bytes, text);
    bytes
}

/// Plain CDR whose bytes of low value come first.
const CDR: [u8; 4] = [0, 1, 0, 0];

fn add_text(bytes: &mut Vec<u8>, text: &str) {
    bytes.extend((text.len() as u32 + 1).to_le_bytes());
    bytes.extend(text.as_bytes());
    bytes.push(0);
}

/// To four bytes, behind the first four as from the start.
fn align(bytes: &mut Vec<u8>) {
    bytes.resize(bytes.len().next_multiple_of(4), 0);
}

/// The schemes of the toolbox: its names, and ours.
const OF_TOOLBOX: [(&str, &str); 7] = [
    ("temporal_contrast", "tbr"),
    ("step_forward", "sf"),
    ("moving_window", "mw"),
    (GAUSSIAN_FIELDS, "grf"),
    ("bsa", "bsa"),
    ("hsa", "hsa"),
    ("threshold_hsa", "t-hsa"),
];

/// The name of one of our schemes in messages: the toolbox's if it has one, but for `grf`, as its neurons are numbered
/// otherwise.
pub(crate) fn published(scheme: &'static str) -> &'static str {
    let same = OF_TOOLBOX.iter().find(|(name, own)| *own == scheme && *name != GAUSSIAN_FIELDS);
    same.map_or(scheme, |(name, _)| name)
}

/// GRF as the toolbox's node has it: its neurons are numbered from 0 where the paper's centres are from 1.
pub(crate) const GAUSSIAN_FIELDS: &str = "gaussian_fields";

/// Our name of the scheme that messages name.
pub(crate) fn meant(name: &str) -> &str {
    OF_TOOLBOX.iter().find(|(own, _)| *own == name).map_or(name, |(_, scheme)| scheme)
}
