//! Writes ROS 1 bags, version 2.0, with an index and without compression.

use super::recorder::{Container, Topic};
use crate::Result;
use crate::output::Output;
use std::io::Write;

/// A bag that is being written.
pub(super) struct Bag {
    output: Output,
    topics: Vec<Topic>,
    chunk: Vec<u8>,
    /// For each message in the current chunk, the index of its topic, its time in ns, and its offset in the chunk.
    index: Vec<(usize, u64, u32)>,
    chunks: Vec<Chunk>,
}

/// A finished chunk, as listed in the index at the end of the bag.
struct Chunk {
    place: u64,
    first: u64,
    last: u64,
    /// Number of messages on each topic in the chunk.
    counts: Vec<u32>,
}

/// Size of a chunk in bytes, as in `rosbag`.
const CHUNK: usize = 768 * 1024;
const VERSION: &[u8] = b"#ROSBAG V2.0\n";
/// Size in bytes to which the first record is padded. The record is overwritten once the offset of the index is known.
const FIRST: usize = 4096;

impl Bag {
    pub(super) fn new(mut output: Output, topics: Vec<Topic>) -> Result<Self> {
        output.write_all(VERSION)?;
        output.write_all(&first(0, 0, 0))?;
        let mut bag =
            Self { output, topics, chunk: Vec::new(), index: Vec::new(), chunks: Vec::new() };
        bag.chunk = bag.connections();
        Ok(bag)
    }

    fn connections(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        for (topic, place) in self.topics.iter().zip(0_u32..) {
            let data = [
                field("topic", topic.name.as_bytes()),
                field("type", topic.kind.ros1().as_bytes()),
                field("md5sum", topic.kind.md5().as_bytes()),
                field("message_definition", topic.kind.definition_ros1().as_bytes()),
            ]
            .concat();
            let header = [
                field("op", &[7]),
                field("conn", &place.to_le_bytes()),
                field("topic", topic.name.as_bytes()),
            ];
            record(&mut bytes, &header.concat(), &data);
        }
        bytes
    }

    fn end_chunk(&mut self) -> Result<()> {
        if self.index.is_empty() {
            return Ok(());
        }
        let times = self.index.iter().map(|(_, time, _)| *time);
        let mut chunk = Chunk {
            place: self.output.bytes(),
            first: times.clone().min().unwrap_or_default(),
            last: times.max().unwrap_or_default(),
            counts: vec![0; self.topics.len()],
        };
        let mut bytes = Vec::new();
        let header = [
            field("op", &[5]),
            field("compression", b"none"),
            field("size", &(self.chunk.len() as u32).to_le_bytes()),
        ];
        record(&mut bytes, &header.concat(), &self.chunk);
        for topic in 0..self.topics.len() {
            let own = self.index.iter().filter(|(own, ..)| *own == topic);
            let data: Vec<u8> = own
                .flat_map(|(_, time, place)| {
                    [stamp(*time).as_slice(), &place.to_le_bytes()].concat()
                })
                .collect();
            let count = (data.len() / 12) as u32;
            if count == 0 {
                continue;
            }
            chunk.counts[topic] = count;
            let header = [
                field("op", &[4]),
                field("ver", &1_u32.to_le_bytes()),
                field("conn", &(topic as u32).to_le_bytes()),
                field("count", &count.to_le_bytes()),
            ];
            record(&mut bytes, &header.concat(), &data);
        }
        self.output.write_all(&bytes)?;
        self.chunks.push(chunk);
        self.chunk.clear();
        self.index.clear();
        Ok(())
    }
}

impl Container for Bag {
    fn add(&mut self, topic: usize, nanoseconds: u64, message: &[u8]) -> Result<()> {
        self.index.push((topic, nanoseconds, self.chunk.len() as u32));
        let header = [
            field("op", &[2]),
            field("conn", &(topic as u32).to_le_bytes()),
            field("time", &stamp(nanoseconds)),
        ];
        record(&mut self.chunk, &header.concat(), message);
        if self.chunk.len() >= CHUNK { self.end_chunk() } else { Ok(()) }
    }

    fn finish(mut self: Box<Self>) -> Result<Output> {
        self.end_chunk()?;
        let index = self.output.bytes();
        let mut bytes = self.connections();
        for chunk in &self.chunks {
            let counts = chunk.counts.iter().zip(0_u32..).filter(|(count, _)| **count > 0);
            let data: Vec<u8> = counts
                .flat_map(|(count, topic)| [topic.to_le_bytes(), count.to_le_bytes()].concat())
                .collect();
            let header = [
                field("op", &[6]),
                field("ver", &1_u32.to_le_bytes()),
                field("chunk_pos", &chunk.place.to_le_bytes()),
                field("start_time", &stamp(chunk.first)),
                field("end_time", &stamp(chunk.last)),
                field("count", &((data.len() / 8) as u32).to_le_bytes()),
            ];
            record(&mut bytes, &header.concat(), &data);
        }
        self.output.write_all(&bytes)?;
        let first = first(index, self.topics.len() as u32, self.chunks.len() as u32);
        self.output.overwrite(VERSION.len() as u64, &first)?;
        Ok(self.output)
    }
}

/// Returns the bag's first record, which gives the offset of the index and the numbers of connections and chunks.
fn first(index: u64, connections: u32, chunks: u32) -> Vec<u8> {
    let header = [
        field("op", &[3]),
        field("index_pos", &index.to_le_bytes()),
        field("conn_count", &connections.to_le_bytes()),
        field("chunk_count", &chunks.to_le_bytes()),
    ]
    .concat();
    let mut bytes = Vec::new();
    record(&mut bytes, &header, &vec![b' '; FIRST - 8 - header.len()]);
    bytes
}

fn field(name: &str, value: &[u8]) -> Vec<u8> {
    let length = (name.len() + 1 + value.len()) as u32;
    [&length.to_le_bytes()[..], name.as_bytes(), b"=", value].concat()
}

fn record(bytes: &mut Vec<u8>, header: &[u8], data: &[u8]) {
    for part in [header, data] {
        bytes.extend((part.len() as u32).to_le_bytes());
        bytes.extend(part);
    }
}

/// Encodes a time in ns as seconds and the nanoseconds beyond them, in 4 bytes each.
fn stamp(nanoseconds: u64) -> [u8; 8] {
    let seconds = (nanoseconds / 1_000_000_000) as u32;
    let rest = (nanoseconds % 1_000_000_000) as u32;
    (u64::from(rest) << 32 | u64::from(seconds)).to_le_bytes()
}
