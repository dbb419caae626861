//! Generates small logs of ROS, MCAP and Betaflight byte by byte, for tests.
#![allow(dead_code, unreachable_pub)]

mod ardupilot;

pub use ardupilot::*;
use std::io::Write;

/// Format of a generated ROS log. The log has one topic, `/imu`, whose messages have a header, a number `rate`, an
/// array `few` and a text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Bag,
    Mcap,
    Db3,
}

pub const KINDS: [Kind; 3] = [Kind::Bag, Kind::Mcap, Kind::Db3];

/// The formats whose messages lie in chunks.
pub const CHUNKED: [Kind; 2] = [Kind::Bag, Kind::Mcap];

const ROS1: &str = "Header header\nfloat64 rate\nfloat32[] few\n\
    ====\nMSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n";
const ROS2: &str = "std_msgs/Header header\nfloat64 rate\nfloat32[] few\n\
    ====\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n\
    ====\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n";

/// Returns the field `rate` of message number `sample`: a sine wave of amplitude 1. Messages are 5 ms apart.
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
            Self::Db3 => "log.db3",
        }
    }

    /// Returns the bytes of message number `sample`. The time stamp in the message is one second before the time of
    /// recording. The array `few` has one item if `sample` is odd, and none if it is even.
    pub fn message(self, sample: u32) -> Vec<u8> {
        let stamp = seconds(time(sample) - 1_000_000_000).concat();
        let few: Vec<u8> = (0..sample % 2).flat_map(|_| (sample as f32).to_le_bytes()).collect();
        let few = [&(sample % 2).to_le_bytes()[..], &few].concat();
        let rate = wave(sample).to_le_bytes();
        match self {
            Self::Bag => [&sample.to_le_bytes()[..], &stamp, &long(b"body"), &rate, &few].concat(),
            // A text ends with NUL, and the number of eight bytes is aligned to eight.
            Self::Mcap | Self::Db3 => {
                [&[0, 1, 0, 0][..], &stamp, &long(b"body\0"), &[0; 7], &rate, &few].concat()
            }
        }
    }

    /// Returns a log whose only chunk, which is not compressed, holds a message for each
    /// value of `samples`.
    pub fn of(self, samples: impl Iterator<Item = u32>) -> Vec<u8> {
        let records: Vec<u8> = samples.flat_map(|sample| self.record(sample)).collect();
        [self.start(), self.chunk("none", &records), self.end()].concat()
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
            Self::Db3 => {
                row(&[Cell::Null, Cell::Whole(1), Cell::Whole(time(sample)), Cell::Blob(&message)])
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
            Self::Db3 => unreachable!("it has no chunks"),
        }
    }

    /// Returns a chunk record with this content, compressed by the method `how`.
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
            Self::Db3 => unreachable!("it has no chunks"),
        }
    }

    pub fn end(self) -> Vec<u8> {
        match self {
            Self::Bag => Vec::new(),
            Self::Mcap => {
                [entry(15, &[0; 4]), entry(2, &[0; 20]), b"\x89MCAP0\r\n".to_vec()].concat()
            }
            Self::Db3 => unreachable!("it has no chunks"),
        }
    }

    /// Returns a log of 100 messages, compressed by the method `how`. In a log of chunks, each chunk holds ten messages
    /// and is compressed on its own. A database is compressed as a whole.
    pub fn log(self, how: &str) -> Vec<u8> {
        if self == Self::Db3 {
            let bag = database(&(0..100).map(|sample| self.record(sample)).collect::<Vec<_>>());
            let level = ruzstd::encoding::CompressionLevel::Fastest;
            return if how == "none" {
                bag
            } else {
                ruzstd::encoding::compress_to_vec(bag.as_slice(), level)
            };
        }
        let mut log = self.start();
        for chunk in 0..10 {
            let records: Vec<u8> =
                (0..10).flat_map(|sample| self.record(chunk * 10 + sample)).collect();
            log.extend(self.chunk(how, &records));
        }
        log.extend(self.end());
        log
    }

    /// Returns the compression methods for logs of this format.
    pub fn packings(self) -> &'static [&'static str] {
        match self {
            Self::Bag => &["none", "bz2", "lz4"],
            Self::Mcap => &["none", "lz4", "zstd"],
            Self::Db3 => &["none", "zstd"],
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

/// Size of the pages of a generated database, in bytes.
pub const PAGE: usize = 1024;

/// Value in a row of a database.
pub enum Cell<'a> {
    Null,
    Whole(u64),
    Text(&'a str),
    Blob(&'a [u8]),
}

pub fn varint(number: u64) -> Vec<u8> {
    let mut bytes = vec![(number & 0x7f) as u8];
    let mut left = number >> 7;
    while left > 0 {
        bytes.insert(0, (left & 0x7f) as u8 | 0x80);
        left >>= 7;
    }
    bytes
}

pub fn row(cells: &[Cell<'_>]) -> Vec<u8> {
    let (mut kinds, mut content) = (Vec::new(), Vec::new());
    for cell in cells {
        match cell {
            Cell::Null => kinds.extend(varint(0)),
            Cell::Whole(number) => {
                kinds.extend(varint(6));
                content.extend(number.to_be_bytes());
            }
            Cell::Text(text) => {
                kinds.extend(varint(13 + 2 * text.len() as u64));
                content.extend(text.as_bytes());
            }
            Cell::Blob(bytes) => {
                kinds.extend(varint(12 + 2 * bytes.len() as u64));
                content.extend(*bytes);
            }
        }
    }
    [varint(kinds.len() as u64 + 1), kinds, content].concat()
}

/// Returns a database page that holds `cells`. `kind` is 13 for a leaf page, and 5 for an inner page. `right` is the
/// number of an inner page's rightmost child page; leaf pages ignore `right`. `head` is the file's header for the first
/// page, and empty for other pages.
pub fn page(kind: u8, cells: &[Vec<u8>], right: u32, head: &[u8]) -> Vec<u8> {
    let mut page = head.to_vec();
    page.extend([kind, 0, 0]);
    page.extend((cells.len() as u16).to_be_bytes());
    page.extend([0; 3]);
    if kind == 5 {
        page.extend(right.to_be_bytes());
    }
    let mut end = PAGE;
    let mut bytes = vec![0; PAGE];
    for cell in cells {
        end -= cell.len();
        bytes[end..end + cell.len()].copy_from_slice(cell);
        page.extend((end as u16).to_be_bytes());
    }
    bytes[..page.len()].copy_from_slice(&page);
    bytes
}

/// Encodes a row as a cell of a leaf page. Returns the cell, and overflow pages. The overflow pages hold the end of a
/// row that is too long for the cell. `next` is the number of the first overflow page.
pub fn cell(number: u64, row: &[u8], next: u32) -> (Vec<u8>, Vec<Vec<u8>>) {
    let head = [varint(row.len() as u64), varint(number)].concat();
    let (most, least) = (PAGE - 35, (PAGE - 12) * 32 / 255 - 23);
    if row.len() <= most {
        return ([head, row.to_vec()].concat(), Vec::new());
    }
    let here = least + (row.len() - least) % (PAGE - 4);
    let (here, rest) = row.split_at(if here <= most { here } else { least });
    let parts: Vec<&[u8]> = rest.chunks(PAGE - 4).collect();
    let count = parts.len() as u32;
    let pages = (1..).zip(parts).map(|(index, part)| {
        let following = if index == count { 0 } else { next + index };
        let mut page = [&following.to_be_bytes()[..], part].concat();
        page.resize(PAGE, 0);
        page
    });
    ([head, here.to_vec(), next.to_be_bytes().to_vec()].concat(), pages.collect())
}

/// Returns a ROS 2 bag in `SQLite` with one topic, `/imu`. Each table is one leaf page, except the table of messages,
/// which has an inner page.
pub fn database(messages: &[Vec<u8>]) -> Vec<u8> {
    let sql = |name: &str, columns: &str, root: u64| {
        let statement = format!("CREATE TABLE {name}({columns})");
        let kind = Cell::Text("table");
        row(&[kind, Cell::Text(name), Cell::Text(name), Cell::Whole(root), Cell::Text(&statement)])
    };
    let definitions =
        "id INTEGER PRIMARY KEY, topic_type TEXT, encoding TEXT, encoded_message_definition TEXT";
    let topics = "id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT, offered_qos_profiles TEXT";
    let columns = "id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB";
    let tables = [
        sql("message_definitions", definitions, 2),
        sql("topics", topics, 3),
        sql("messages", columns, 4),
    ];
    let first: Vec<Vec<u8>> = (1..).zip(&tables).map(|(id, row)| cell(id, row, 0).0).collect();
    let mut head = b"SQLite format 3\0".to_vec();
    head.extend((PAGE as u16).to_be_bytes());
    head.resize(100, 0);
    let definition =
        row(&[Cell::Null, Cell::Text("t/msg/Imu"), Cell::Text("ros2msg"), Cell::Text(ROS2)]);
    let long = "- history: 3\n".repeat(250);
    let topic = row(&[
        Cell::Null,
        Cell::Text("/imu"),
        Cell::Text("t/msg/Imu"),
        Cell::Text("cdr"),
        Cell::Text(&long),
    ]);
    let (topic, further) = cell(1, &topic, 5);
    let mut pages = vec![
        page(13, &first, 0, &head),
        page(13, &[cell(1, &definition, 0).0], 0, &[]),
        page(13, &[topic], 0, &[]),
        Vec::new(),
    ];
    pages.extend(further);
    let mut leaves = Vec::new();
    for (index, rows) in messages.chunks(10).enumerate() {
        let cells: Vec<Vec<u8>> =
            (index as u64 * 10 + 1..).zip(rows).map(|(id, row)| cell(id, row, 0).0).collect();
        pages.push(page(13, &cells, 0, &[]));
        leaves.push((pages.len() as u32, index as u64 * 10 + 10));
    }
    let (right, _) = leaves.pop().unwrap();
    let cells: Vec<Vec<u8>> = leaves
        .iter()
        .map(|(leaf, last)| [leaf.to_be_bytes().to_vec(), varint(*last)].concat())
        .collect();
    pages[3] = page(5, &cells, right, &[]);
    pages.concat()
}

/// Returns the angular rate, field `gyroADC[0]`, of frame number `sample` in the generated blackbox log.
pub fn gyro(sample: u32) -> i64 {
    (wave(sample) * 1000.0).round() as i64
}

fn packed(mut number: u32) -> Vec<u8> {
    let mut bytes = Vec::new();
    while number > 127 {
        bytes.push((number & 127) as u8 | 128);
        number >>= 7;
    }
    bytes.push(number as u8);
    bytes
}

fn signed(number: i64) -> Vec<u8> {
    let number = number as i32;
    packed(((number << 1) ^ (number >> 31)) as u32)
}

/// Returns frame number `sample` of a blackbox log: every 32nd is a full frame, and the others hold differences.
pub fn frame(sample: u32) -> Vec<u8> {
    let time = 1000 + sample * 250;
    if sample.is_multiple_of(32) {
        return [b"I".to_vec(), packed(sample), packed(time), signed(gyro(sample)), signed(0)]
            .concat();
    }
    // The time is predicted from the last two frames, which are the same after a full frame.
    let step = if sample % 32 == 1 { 250 } else { 0 };
    let change = (gyro(sample) - gyro(sample - 1)) as i16;
    let [low, high] = change.to_le_bytes();
    [b"P".to_vec(), signed(step), vec![0b1100_0001, low, high, 0, 0]].concat()
}

/// Returns a blackbox log with 200 frames.
pub fn blackbox() -> Vec<u8> {
    let mut log = b"H Product:Blackbox flight data recorder by Nicholas Sherlock
H Data version:2
H I interval:32
H P interval:1/1
H Field I name:loopIteration,time,gyroADC[0],gyroADC[1],gyroADC[2]
H Field I signed:0,0,1,1,1
H Field I predictor:0,0,0,0,0
H Field I encoding:1,1,0,0,9
H Field P predictor:6,2,1,1,1
H Field P encoding:9,0,7,7,7
"
    .to_vec();
    log.extend((0..200).flat_map(frame));
    log.extend(b"E\xffEnd of log\0");
    log
}
