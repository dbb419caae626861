//! ROS bags and MCAP files, made byte by byte.
#![allow(dead_code, unreachable_pub)]

use std::io::Write;

/// A log in the making, of one topic `/imu` with a counted header, an array and a text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Bag,
    Mcap,
}

pub const KINDS: [Kind; 2] = [Kind::Bag, Kind::Mcap];

const ROS1: &str = "Header header\nfloat64 rate\nfloat32[] few\n\
    ====\nMSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n";
const ROS2: &str = "std_msgs/Header header\nfloat64 rate\nfloat32[] few\n\
    ====\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n\
    ====\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n";

/// Samples of a wave, 5 ms apart; the value of a sample.
pub fn wave(sample: u32) -> f64 {
    (f64::from(sample) * 0.1).sin()
}

const START: u64 = 1_700_000_000_000_000_000;

pub fn time(sample: u32) -> u64 {
    START + u64::from(sample) * 5_000_000
}

pub fn long(bytes: &[u8]) -> Vec<u8> {
    [&(bytes.len() as u32).to_le_bytes()[..], bytes].concat()
}

pub fn seconds(time: u64) -> [[u8; 4]; 2] {
    [((time / 1_000_000_000) as u32).to_le_bytes(), ((time % 1_000_000_000) as u32).to_le_bytes()]
}

impl Kind {
    pub fn name(self) -> &'static str {
        match self {
            Self::Bag => "log.bag",
            Self::Mcap => "log.mcap",
        }
    }

    /// A message; its own stamp is a second before it was recorded. Every second has an array of one, others of none.
    pub fn message(self, sample: u32) -> Vec<u8> {
        let stamp = seconds(time(sample) - 1_000_000_000).concat();
        let few: Vec<u8> = (0..sample % 2).flat_map(|_| (sample as f32).to_le_bytes()).collect();
        let few = [&(sample % 2).to_le_bytes()[..], &few].concat();
        let rate = wave(sample).to_le_bytes();
        match self {
            Self::Bag => [&sample.to_le_bytes()[..], &stamp, &long(b"body"), &rate, &few].concat(),
            // The text ends with a zero; the number of eight bytes is aligned to eight.
            Self::Mcap => {
                [&[0, 1, 0, 0][..], &stamp, &long(b"body\0"), &[0; 7], &rate, &few].concat()
            }
        }
    }

    pub fn record(self, sample: u32) -> Vec<u8> {
        let message = self.message(sample);
        match self {
            Self::Bag => {
                let stamp = seconds(time(sample)).concat();
                record(&[("op", &[2]), ("conn", &[0; 4]), ("time", &stamp)], &message)
            }
            Self::Mcap => {
                let time = time(sample).to_le_bytes();
                entry(5, &[&[0, 0][..], &[0; 4], &time, &time, &message].concat())
            }
        }
    }

    pub fn start(self) -> Vec<u8> {
        match self {
            Self::Bag => {
                let data = fields(&[
                    ("topic", b"/imu"),
                    ("type", b"t/Imu"),
                    ("message_definition", ROS1.as_bytes()),
                ]);
                let first = record(&[("op", &[3]), ("index_pos", &[1; 8])], &[b' '; 16]);
                let connection =
                    record(&[("op", &[7]), ("conn", &[0; 4]), ("topic", b"/imu")], &data);
                [b"#ROSBAG V2.0\n".as_slice(), &first, &connection].concat()
            }
            Self::Mcap => {
                let schema =
                    [&[1, 0][..], &long(b"t/msg/Imu"), &long(b"ros2msg"), &long(ROS2.as_bytes())];
                let channel = [&[0, 0, 1, 0][..], &long(b"/imu"), &long(b"cdr"), &[0; 4]];
                let header = [long(b"ros2"), long(b"test")].concat();
                [
                    b"\x89MCAP0\r\n".to_vec(),
                    entry(1, &header),
                    entry(3, &schema.concat()),
                    entry(4, &channel.concat()),
                ]
                .concat()
            }
        }
    }

    /// A chunk, packed or not.
    pub fn chunk(self, how: &str, content: &[u8]) -> Vec<u8> {
        let packed = match how {
            "bz2" => {
                let mut packer =
                    bzip2::write::BzEncoder::new(Vec::new(), bzip2::Compression::fast());
                packer.write_all(content).unwrap();
                packer.finish().unwrap()
            }
            "lz4" => {
                let mut packer = lz4_flex::frame::FrameEncoder::new(Vec::new());
                packer.write_all(content).unwrap();
                packer.finish().unwrap()
            }
            "zstd" => {
                let level = ruzstd::encoding::CompressionLevel::Fastest;
                ruzstd::encoding::compress_to_vec(content, level)
            }
            _ => content.to_vec(),
        };
        match self {
            Self::Bag => {
                let size = (content.len() as u32).to_le_bytes();
                record(&[("op", &[5]), ("compression", how.as_bytes()), ("size", &size)], &packed)
            }
            Self::Mcap => {
                let how = if how == "none" { "" } else { how };
                let size = (content.len() as u64).to_le_bytes();
                let checksum = crc32fast::hash(content).to_le_bytes();
                let stated = (packed.len() as u64).to_le_bytes();
                let parts =
                    [&[0; 16][..], &size, &checksum, &long(how.as_bytes()), &stated, &packed];
                entry(6, &parts.concat())
            }
        }
    }

    pub fn end(self) -> Vec<u8> {
        match self {
            Self::Bag => Vec::new(),
            Self::Mcap => {
                [entry(15, &[0; 4]), entry(2, &[0; 20]), b"\x89MCAP0\r\n".to_vec()].concat()
            }
        }
    }

    /// A log of 100 messages in chunks of ten.
    pub fn log(self, how: &str) -> Vec<u8> {
        let mut log = self.start();
        for chunk in 0..10 {
            let records: Vec<u8> =
                (0..10).flat_map(|sample| self.record(chunk * 10 + sample)).collect();
            log.extend(self.chunk(how, &records));
        }
        log.extend(self.end());
        log
    }

    /// How logs of this kind are packed.
    pub fn packings(self) -> &'static [&'static str] {
        match self {
            Self::Bag => &["none", "bz2", "lz4"],
            Self::Mcap => &["none", "lz4", "zstd"],
        }
    }
}

pub fn fields(fields: &[(&str, &[u8])]) -> Vec<u8> {
    let one = |(name, value): &(&str, &[u8])| long(&[name.as_bytes(), b"=", value].concat());
    fields.iter().flat_map(one).collect()
}

pub fn record(header: &[(&str, &[u8])], data: &[u8]) -> Vec<u8> {
    [long(&fields(header)), long(data)].concat()
}

pub fn entry(kind: u8, content: &[u8]) -> Vec<u8> {
    [&[kind][..], &(content.len() as u64).to_le_bytes(), content].concat()
}
