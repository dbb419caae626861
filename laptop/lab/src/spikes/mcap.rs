//! Writes MCAP files with messages of ROS 2, with an index and without compression.

use super::recorder::{Container, Topic};
use crate::Result;
use crate::output::Output;
use std::io::Write;

/// An MCAP file that is being written.
pub(super) struct Mcap {
    output: Output,
    topics: Vec<Topic>,
    chunk: Vec<u8>,
    /// For each message in the current chunk, the index of its topic, its time in ns, and its offset in the chunk.
    index: Vec<(usize, u64, u64)>,
    /// Index entries of the finished chunks, one for each chunk. They are written at the end of the file.
    chunks: Vec<Vec<u8>>,
    /// Number of messages on each topic.
    counts: Vec<u32>,
    /// The earliest and the latest time in the finished chunks, in ns.
    span: Option<(u64, u64)>,
}

/// Size of a chunk in bytes, the same as in `rosbag`.
const CHUNK: usize = 768 * 1024;
const MAGIC: &[u8] = b"\x89MCAP0\r\n";

impl Mcap {
    pub(super) fn new(mut output: Output, topics: Vec<Topic>) -> Result<Self> {
        let counts = vec![0; topics.len()];
        output.write_all(MAGIC)?;
        let mut bytes = Vec::new();
        record(&mut bytes, 1, &[text("ros2"), text("spikewire")].concat());
        bytes.extend(channels(&topics));
        output.write_all(&bytes)?;
        Ok(Self {
            output,
            topics,
            chunk: Vec::new(),
            index: Vec::new(),
            chunks: Vec::new(),
            counts,
            span: None,
        })
    }

    fn end_chunk(&mut self) -> Result<()> {
        let times = self.index.iter().map(|(_, time, _)| *time);
        let (Some(first), Some(last)) = (times.clone().min(), times.max()) else { return Ok(()) };
        let span = self.span.get_or_insert((first, last));
        *span = (span.0.min(first), span.1.max(last));
        let place = self.output.bytes();
        let size = (self.chunk.len() as u64).to_le_bytes();
        let content = [
            &first.to_le_bytes()[..],
            &last.to_le_bytes(),
            &size,
            &crc32fast::hash(&self.chunk).to_le_bytes(),
            &text(""),
            &size,
            &self.chunk,
        ];
        let mut bytes = Vec::new();
        record(&mut bytes, 6, &content.concat());
        let length = bytes.len() as u64;
        let mut places = Vec::new();
        for topic in 0..self.topics.len() {
            let own = self.index.iter().filter(|(own, ..)| *own == topic);
            let entries: Vec<u8> = own
                .flat_map(|(_, time, place)| [time.to_le_bytes(), place.to_le_bytes()].concat())
                .collect();
            if !entries.is_empty() {
                places.extend((topic as u16).to_le_bytes());
                places.extend((place + bytes.len() as u64).to_le_bytes());
                record(
                    &mut bytes,
                    7,
                    &[&(topic as u16).to_le_bytes()[..], &long(&entries)].concat(),
                );
            }
        }
        let of_index = bytes.len() as u64 - length;
        self.chunks.push(
            [
                &first.to_le_bytes()[..],
                &last.to_le_bytes(),
                &place.to_le_bytes(),
                &length.to_le_bytes(),
                &long(&places),
                &of_index.to_le_bytes(),
                &text(""),
                &size,
                &size,
            ]
            .concat(),
        );
        self.output.write_all(&bytes)?;
        self.chunk.clear();
        self.index.clear();
        Ok(())
    }

    fn statistics(&self) -> Vec<u8> {
        let (first, last) = self.span.unwrap_or_default();
        let counts: Vec<u8> = (0_u16..)
            .zip(&self.counts)
            .flat_map(|(topic, count)| {
                [&topic.to_le_bytes()[..], &u64::from(*count).to_le_bytes()].concat()
            })
            .collect();
        let all: u64 = self.counts.iter().map(|count| u64::from(*count)).sum();
        let topics = self.topics.len();
        [
            &all.to_le_bytes()[..],
            &(topics as u16).to_le_bytes(),
            &(topics as u32).to_le_bytes(),
            &[0; 8],
            &(self.chunks.len() as u32).to_le_bytes(),
            &first.to_le_bytes(),
            &last.to_le_bytes(),
            &long(&counts),
        ]
        .concat()
    }
}

impl Container for Mcap {
    fn add(&mut self, topic: usize, nanoseconds: u64, message: &[u8]) -> Result<()> {
        self.index.push((topic, nanoseconds, self.chunk.len() as u64));
        self.counts[topic] += 1;
        let time = nanoseconds.to_le_bytes();
        let sequence = self.counts[topic].to_le_bytes();
        let head = [&(topic as u16).to_le_bytes()[..], &sequence, &time, &time];
        record(&mut self.chunk, 5, &[&head.concat(), message].concat());
        if self.chunk.len() >= CHUNK { self.end_chunk() } else { Ok(()) }
    }

    fn finish(mut self: Box<Self>) -> Result<Output> {
        self.end_chunk()?;
        let mut bytes = Vec::new();
        record(&mut bytes, 15, &[0; 4]);
        let summary = self.output.bytes() + bytes.len() as u64;
        bytes.extend(channels(&self.topics));
        record(&mut bytes, 11, &self.statistics());
        for chunk in &self.chunks {
            record(&mut bytes, 8, chunk);
        }
        record(&mut bytes, 2, &[&summary.to_le_bytes()[..], &[0; 12]].concat());
        bytes.extend(MAGIC);
        self.output.write_all(&bytes)?;
        Ok(self.output)
    }
}

/// Returns the records that define each topic and its message type; types are numbered from 1.
fn channels(topics: &[Topic]) -> Vec<u8> {
    let mut bytes = Vec::new();
    for (topic, place) in topics.iter().zip(0_u16..) {
        let schema = (place + 1).to_le_bytes();
        let definition = text(&topic.kind.definition_ros2());
        let content = [&schema[..], &text(topic.kind.ros2()), &text("ros2msg"), &definition];
        record(&mut bytes, 3, &content.concat());
        let content =
            [&place.to_le_bytes()[..], &schema, &text(&topic.name), &text("cdr"), &[0; 4]];
        record(&mut bytes, 4, &content.concat());
    }
    bytes
}

fn record(bytes: &mut Vec<u8>, kind: u8, content: &[u8]) {
    bytes.push(kind);
    bytes.extend((content.len() as u64).to_le_bytes());
    bytes.extend(content);
}

fn text(text: &str) -> Vec<u8> {
    long(text.as_bytes())
}

/// Returns the length of `bytes` as 4 bytes, followed by `bytes`.
fn long(bytes: &[u8]) -> Vec<u8> {
    [&(bytes.len() as u32).to_le_bytes()[..], bytes].concat()
}
