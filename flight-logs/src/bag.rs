//! Reads ROS 1 bags, version 2.0. A bag is a sequence of records, each with a header of named fields and with data.
//! Messages lie in chunk records, which may be compressed.
//!
//! The index is not used, so bags that were never closed or indexed can be read too.

use super::Entry;
use super::bytes::{Bytes, take, u32_from, u64_from, unpack};
use super::chunk::{Chunked, Walk};
use super::definition::Dialect;
use super::faults::Faults;
use super::topic::Topic;
use crate::Result;
use std::collections::HashMap;
use std::path::Path;

/// First bytes of a ROS 1 bag, whatever its version.
pub(crate) const START: &[u8] = b"#ROSBAG V";
/// First bytes of a ROS 1 bag of version 2.0, the only one supported.
const VERSION: &[u8] = b"#ROSBAG V2.0\n";

/// Kinds of records: the values of the header field `op`.
mod op {
    pub(crate) const MESSAGE: u8 = 2;
    pub(crate) const BAG: u8 = 3;
    pub(crate) const INDEX: u8 = 4;
    pub(crate) const CHUNK: u8 = 5;
    pub(crate) const CHUNK_INFO: u8 = 6;
    pub(crate) const CONNECTION: u8 = 7;
}

/// Reader of a ROS 1 bag, from start to end.
pub(crate) struct Bag {
    walk: Walk,
    /// Topic of each connection, as an index in `walk.topics`. The key is the number by which messages refer to the
    /// connection.
    connections: HashMap<u32, usize>,
    header: Vec<u8>,
    data: Vec<u8>,
}

/// The named fields in a record's header, encoded one after the other.
struct Fields<'a>(&'a [u8]);

impl<'a> Fields<'a> {
    fn get(&self, name: &str) -> Option<&'a [u8]> {
        let mut left = self.0;
        while let Some(length) = u32_from(&mut left) {
            let field = take(&mut left, length.into())?;
            let equals = field.iter().position(|&byte| byte == b'=')?;
            if &field[..equals] == name.as_bytes() {
                return Some(&field[equals + 1..]);
            }
        }
        None
    }

    fn op(&self) -> Option<u8> {
        self.get("op")?.first().copied()
    }

    fn u32(&self, name: &str) -> Option<u32> {
        u32_from(&mut self.get(name)?)
    }

    fn u64(&self, name: &str) -> Option<u64> {
        u64_from(&mut self.get(name)?)
    }

    fn text(&self, name: &str) -> Option<String> {
        Some(String::from_utf8_lossy(self.get(name)?).into_owned())
    }

    /// Reads the field `name`, a time stored as seconds and nanoseconds; returns the time in ns.
    fn time(&self, name: &str) -> Option<i64> {
        let mut field = self.get(name)?;
        let (seconds, nanoseconds) = (u32_from(&mut field)?, u32_from(&mut field)?);
        Some(i64::from(seconds) * 1_000_000_000 + i64::from(nanoseconds))
    }
}

impl Bag {
    pub(crate) fn open(path: &Path, faults: Faults) -> Result<Self> {
        const OTHER: &str =
            "a ROS bag of another version than 2.0; `rosbag fix` or `rosbag migrate` converts it";
        Ok(Self {
            walk: Walk::open(path, faults, VERSION, OTHER)?,
            connections: HashMap::new(),
            header: Vec::new(),
            data: Vec::new(),
        })
    }

    fn entry(
        &mut self,
        connection: Option<u32>,
        time: Option<i64>,
        at: u64,
    ) -> Result<Option<Entry>> {
        let topic = connection.and_then(|connection| self.connections.get(&connection));
        if let (Some(&topic), Some(time)) = (topic, time) {
            return Ok(Some(Entry { topic, time, at, sequence: None }));
        }
        self.walk.faults.skip(at, "a message without a time or a connection that is known")?;
        Ok(None)
    }

    fn add(&mut self, connection: Option<(u32, Topic)>, at: u64) -> Result<()> {
        let Some((id, topic)) = connection else {
            return self.walk.faults.skip(at, "a connection without a number or a type");
        };
        if !self.connections.contains_key(&id) {
            let index = topic.index_in(&mut self.walk.topics);
            self.connections.insert(id, index);
        }
        Ok(())
    }
}

/// Reads one part of a record, its header or its data, into `part`. In the file, each part follows a number of four
/// bytes, the length of the part.
///
/// # Errors
/// Returns the reason if the file ends within the part, or cannot be read.
fn part(bytes: &mut Bytes, part: &mut Vec<u8>) -> Result<(), String> {
    const CUT: &str = "the bag ends within the record";
    let mut take = |count| match bytes.take(count, part) {
        Ok(true) => Ok(u32_from(&mut part.as_slice())),
        Ok(false) => Err(CUT.to_owned()),
        Err(error) => Err(error.to_string()),
    };
    let length = take(4)?.unwrap_or_default();
    take(length.into()).map(drop)
}

/// Parses a connection record; returns the connection's number and its topic, or `None` if a field is missing.
fn connection(fields: &Fields<'_>, data: &[u8]) -> Option<(u32, Topic)> {
    let data_fields = Fields(data);
    let (id, name, kind) = (fields.u32("conn")?, fields.text("topic")?, data_fields.text("type")?);
    let text = data_fields.text("message_definition").unwrap_or_default();
    Some((id, Topic::new(name, kind, Dialect::Ros1, &text)))
}

impl Chunked for Bag {
    /// Offset of a record in the file. The record's content is in `header` and `data`.
    type Record = u64;

    fn walk(&self) -> &Walk {
        &self.walk
    }

    fn walk_mut(&mut self) -> &mut Walk {
        &mut self.walk
    }

    fn of_chunk(&mut self) -> Result<Option<Entry>> {
        let mut left = self.walk.chunk.left();
        let at = self.walk.chunk.at();
        let record = (|| {
            let length = u32_from(&mut left)?;
            let header = take(&mut left, length.into())?;
            let length = u32_from(&mut left)?;
            Some((Fields(header), take(&mut left, length.into())?))
        })();
        let Some((fields, data)) = record else {
            return self.walk.chunk.leave(&mut self.walk.faults).map(|()| None);
        };
        let end = self.walk.chunk.bytes().len() - left.len();
        match fields.op() {
            Some(op::MESSAGE) => {
                let (connection, time) = (fields.u32("conn"), fields.time("time"));
                data.clone_into(&mut self.walk.message);
                self.walk.chunk.take_to(end);
                self.entry(connection, time, at)
            }
            Some(op::CONNECTION) => {
                let connection = connection(&fields, data);
                self.walk.chunk.take_to(end);
                self.add(connection, at)?;
                Ok(None)
            }
            _ => {
                let what =
                    format!("the chunk has no message at its byte {}", self.walk.chunk.taken());
                self.walk.chunk.take_to(end);
                self.walk.faults.skip(at, what)?;
                Ok(None)
            }
        }
    }

    fn record(&mut self) -> Result<Option<u64>> {
        let mut at = self.walk.bytes.at();
        self.data.clear();
        let mut read = part(&mut self.walk.bytes, &mut self.header);
        // No header is empty: a recorder that makes its file longer in advance leaves zeros.
        if read.is_ok() && self.header.is_empty() {
            let zeros = self.walk.bytes.pass_zeros();
            let count = self.walk.bytes.at() - at;
            self.walk.faults.lose(at, format!("{count} zeros where a record should begin"));
            at = self.walk.bytes.at();
            read = zeros
                .map_err(|error| error.to_string())
                .and_then(|()| part(&mut self.walk.bytes, &mut self.header));
        }
        let read = read.and_then(|()| part(&mut self.walk.bytes, &mut self.data));
        let Err(what) = read else { return Ok(Some(at)) };
        if self.walk.bytes.at() == at {
            return Ok(None);
        }
        self.walk.faults.end(at, what)?;
        self.walk.is_over = true;
        // An incomplete chunk may still hold whole messages.
        let is_chunk = Fields(&self.header).op() == Some(op::CHUNK);
        Ok(is_chunk.then_some(at))
    }

    fn outside(&mut self, at: u64) -> Result<Option<Entry>> {
        let fields = Fields(&self.header);
        match fields.op() {
            Some(op::CHUNK) => {
                let compression = fields.text("compression").unwrap_or_default();
                let size = fields.u32("size").unwrap_or_default();
                let unpacked = unpack(&compression, &self.data, size.into());
                self.walk.chunk.begin(at, unpacked, self.walk.is_over, &mut self.walk.faults)?;
            }
            Some(op::MESSAGE) => {
                let (connection, time) = (fields.u32("conn"), fields.time("time"));
                self.data.clone_into(&mut self.walk.message);
                return self.entry(connection, time, at);
            }
            Some(op::CONNECTION) => {
                let connection = connection(&fields, &self.data);
                self.add(connection, at)?;
            }
            Some(op::BAG) => {
                if fields.u64("index_pos") == Some(0) {
                    self.walk
                        .faults
                        .note("the bag has no index: its recorder did not close it".to_owned());
                }
            }
            Some(op::INDEX | op::CHUNK_INFO) => {}
            Some(other) => {
                self.walk.faults.skip(at, format!("a record of unknown kind {other}"))?;
            }
            None => self.walk.faults.skip(at, "a record without a kind")?,
        }
        Ok(None)
    }
}
