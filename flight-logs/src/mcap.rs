//! Reads MCAP files. A file is a sequence of records, each with a kind and a length. Each message is a record. Chunk
//! records contain further records, and may be compressed.
//!
//! The index is not used, so files that were never closed can be read too.

use super::Entry;
use super::bytes::{take, u16_from, u32_from, u64_from, unpack};
use super::chunk::{Chunked, Walk};
use super::definition::Dialect;
use super::faults::Faults;
use super::topic::Topic;
use crate::Result;
use crate::zstd::ZSTD;
use std::collections::HashMap;
use std::path::Path;

/// First bytes of an MCAP file, whatever its version.
pub(crate) const START: &[u8] = b"\x89MCAP";
/// First bytes of an MCAP file of version 0, the only one supported.
const VERSION: &[u8] = b"\x89MCAP0\r\n";

/// Opcodes: the bytes that tell the kind of a record.
mod op {
    pub(crate) const HEADER: u8 = 1;
    pub(crate) const FOOTER: u8 = 2;
    pub(crate) const SCHEMA: u8 = 3;
    pub(crate) const CHANNEL: u8 = 4;
    pub(crate) const MESSAGE: u8 = 5;
    pub(crate) const CHUNK: u8 = 6;
    pub(crate) const DATA_END: u8 = 15;
}

/// Maximum decompressed size, in bytes, of a message that ROS 2 compressed individually. A longer message is cut to
/// this size.
pub(crate) const LARGEST_MESSAGE: u64 = 1 << 30;

/// Reader of an MCAP file, from start to end.
pub(crate) struct Mcap {
    walk: Walk,
    /// Name, encoding and text of each schema. The key is the schema's number.
    schemas: HashMap<u16, (String, String, String)>,
    /// Topic of each channel, as an index in `walk.topics`. The key is the number by which messages refer to the
    /// channel.
    channels: HashMap<u16, usize>,
    data: Vec<u8>,
}

impl Mcap {
    pub(crate) fn open(path: &Path, faults: Faults) -> Result<Self> {
        Ok(Self {
            walk: Walk::open(path, faults, VERSION, "an MCAP file of another version than 0")?,
            schemas: HashMap::new(),
            channels: HashMap::new(),
            data: Vec::new(),
        })
    }

    fn open_chunk(&mut self, at: u64) -> Result<()> {
        let mut left = self.data.as_slice();
        let head = (|| {
            take(&mut left, 16)?;
            let (size, checksum) = (u64_from(&mut left)?, u32_from(&mut left)?);
            let compression = text(&mut left)?;
            let stated = u64_from(&mut left)?;
            Some((size, checksum, compression, stated))
        })();
        let Some((size, checksum, compression, stated)) = head else {
            return self.walk.faults.skip(at, "the chunk ends within its head");
        };
        let packed = &left[..left.len().min(usize::try_from(stated).unwrap_or(usize::MAX))];
        let (chunk, fault) = unpack(&compression, packed, size);
        let fault = fault.or_else(|| {
            (checksum != 0 && crc32fast::hash(&chunk) != checksum)
                .then(|| "the checksum of the chunk does not match".to_owned())
        });
        self.walk.chunk.begin(at, (chunk, fault), self.walk.is_over, &mut self.walk.faults)
    }

    /// Parses a message record. Returns the message's entry, and the length of the message's content, which is at the
    /// end of the record. Returns `None` if the record is too short or the channel is unknown.
    fn entry(&self, mut record: &[u8], at: u64) -> Option<(Entry, usize)> {
        let channel = u16_from(&mut record)?;
        let sequence = u32_from(&mut record)?;
        let (time, _published) = (u64_from(&mut record)?, u64_from(&mut record)?);
        let topic = *self.channels.get(&channel)?;
        let time = i64::try_from(time).unwrap_or(i64::MAX);
        // Recorders that do not number messages write 0.
        let sequence = Some(sequence).filter(|sequence| *sequence > 0);
        Some((Entry { topic, time, at, sequence }, record.len()))
    }

    fn odd(&mut self, at: u64) -> Result<Option<Entry>> {
        self.walk.faults.skip(at, "a message without a channel that is known").map(|()| None)
    }

    /// Stores the schema or the channel that a record defines. Records of other kinds are ignored.
    fn define(&mut self, kind: u8, mut data: &[u8], at: u64) -> Result<()> {
        let left = &mut data;
        let is_good = match kind {
            op::SCHEMA => (|| {
                let id = u16_from(left)?;
                let (name, encoding) = (text(left)?, text(left)?);
                self.schemas.insert(id, (name, encoding, text(left)?));
                Some(())
            })(),
            op::CHANNEL => (|| {
                let (id, schema) = (u16_from(left)?, u16_from(left)?);
                let (name, encoding) = (text(left)?, text(left)?);
                if !self.channels.contains_key(&id) {
                    let topic = self.topic(name, schema, &encoding);
                    let index = topic.index_in(&mut self.walk.topics);
                    self.channels.insert(id, index);
                }
                Some(())
            })(),
            _ => Some(()),
        };
        match is_good {
            Some(()) => Ok(()),
            None => self.walk.faults.skip(at, "a schema or channel that ends too early"),
        }
    }

    fn topic(&self, name: String, schema: u16, encoding: &str) -> Topic {
        let none = Default::default();
        let (kind, of_schema, definition) = self.schemas.get(&schema).unwrap_or(&none);
        let dialect = match (encoding, of_schema.as_str()) {
            ("ros1", "ros1msg") => Dialect::Ros1,
            ("cdr", "ros2msg") => Dialect::Ros2,
            _ => {
                let why = format!(
                    "encoding `{encoding}` with a schema of `{of_schema}`; there are ros1 with ros1msg and cdr with ros2msg"
                );
                return Topic::unread(name, kind.clone(), why);
            }
        };
        Topic::new(name, kind.clone(), dialect, definition)
    }
}

impl Chunked for Mcap {
    /// Kind of a record, and its offset in the file. The record's content is in `data`.
    type Record = (u8, u64);

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
            let kind = take(&mut left, 1)?[0];
            let length = u64_from(&mut left)?;
            Some((kind, take(&mut left, length)?))
        })();
        let Some((kind, data)) = record else {
            return self.walk.chunk.leave(&mut self.walk.faults).map(|()| None);
        };
        let end = self.walk.chunk.bytes().len() - left.len();
        if kind == op::MESSAGE {
            let entry = self.entry(data, at);
            self.walk.chunk.take_to(end);
            let Some((entry, content)) = entry else {
                return self.odd(at);
            };
            take_content(&self.walk.chunk.bytes()[end - content..end], &mut self.walk.message);
            return Ok(Some(entry));
        }
        let data = data.to_vec();
        self.walk.chunk.take_to(end);
        self.define(kind, &data, at).map(|()| None)
    }

    fn record(&mut self) -> Result<Option<(u8, u64)>> {
        const CUT: &str = "the file ends within the record";
        let at = self.walk.bytes.at();
        let head = self.walk.bytes.take(9, &mut self.data);
        let kind = self.data.first().copied();
        let length = u64_from(&mut self.data.get(1..).unwrap_or_default());
        let what = match (head, kind, length) {
            (Err(error), ..) => error.to_string(),
            (Ok(_), None, _) => {
                self.walk
                    .faults
                    .note("the file has no end: its recorder did not close it".to_owned());
                return Ok(None);
            }
            (Ok(_), Some(kind), Some(length)) => {
                let is_wanted = (op::HEADER..=op::CHUNK).contains(&kind) || kind == op::DATA_END;
                let taken = if is_wanted {
                    self.walk.bytes.take(length, &mut self.data)
                } else {
                    self.walk.bytes.pass(length)
                };
                match taken {
                    Ok(true) => return Ok(Some((kind, at))),
                    Ok(false) => CUT.to_owned(),
                    Err(error) => error.to_string(),
                }
            }
            _ => CUT.to_owned(),
        };
        self.walk.faults.end(at, what)?;
        self.walk.is_over = true;
        // An incomplete chunk may still hold whole messages.
        Ok(kind.filter(|kind| *kind == op::CHUNK && length.is_some()).map(|kind| (kind, at)))
    }

    fn outside(&mut self, (kind, at): (u8, u64)) -> Result<Option<Entry>> {
        match kind {
            op::CHUNK => {
                self.open_chunk(at)?;
                Ok(None)
            }
            op::MESSAGE => {
                let Some((entry, content)) = self.entry(&self.data, at) else {
                    return self.odd(at);
                };
                let start = self.data.len() - content;
                take_content(&self.data[start..], &mut self.walk.message);
                Ok(Some(entry))
            }
            op::FOOTER | op::DATA_END => {
                self.walk.is_over = true;
                Ok(None)
            }
            _ => {
                let data = std::mem::take(&mut self.data);
                let defined = self.define(kind, &data, at);
                self.data = data;
                defined.map(|()| None)
            }
        }
    }
}

/// Stores a message's content in `message`. Decompresses the content if it starts with the first bytes of Zstandard. No
/// uncompressed message of ROS 2 starts with these bytes.
fn take_content(content: &[u8], message: &mut Vec<u8>) {
    if content.starts_with(&ZSTD) {
        *message = unpack("zstd", content, LARGEST_MESSAGE).0;
    } else {
        content.clone_into(message);
    }
}

/// Removes a text from the front of `left`. The length of a text comes before it, in four bytes.
fn text(left: &mut &[u8]) -> Option<String> {
    let length = u32_from(left)?;
    Some(String::from_utf8_lossy(take(left, length.into())?).into_owned())
}
