//! MCAP files: records of a kind and a length, messages alone or in chunks that may be compressed.
//!
//! The index is not needed, so files that were never closed are read as any other.

use super::bytes::{Bytes, ZSTD, take, u16_from, u32_from, u64_from, unpack};
use super::chunk::{Chunk, Chunked};
use super::definition::Dialect;
use super::faults::Faults;
use super::topic::Topic;
use super::{Entry, Log};
use anyhow::{Context, Result, bail};
use std::collections::HashMap;
use std::ops::Range;
use std::path::Path;

/// The first bytes of a file of any version.
pub(super) const START: &[u8] = b"\x89MCAP";
/// The first bytes of a file of the version that is read.
const VERSION: &[u8] = b"\x89MCAP0\r\n";

/// Kinds of records.
mod op {
    pub(super) const HEADER: u8 = 1;
    pub(super) const FOOTER: u8 = 2;
    pub(super) const SCHEMA: u8 = 3;
    pub(super) const CHANNEL: u8 = 4;
    pub(super) const MESSAGE: u8 = 5;
    pub(super) const CHUNK: u8 = 6;
    pub(super) const DATA_END: u8 = 15;
}

/// Messages of ROS 2 are packed one by one where a recorder was told so; unpacked none is larger.
pub(super) const LARGEST_MESSAGE: u64 = 1 << 30;

/// A file that is read from its start to its end.
pub(super) struct Mcap {
    bytes: Bytes,
    faults: Faults,
    topics: Vec<Topic>,
    /// The schemas by number: name, encoding and text.
    schemas: HashMap<u16, (String, String, String)>,
    /// The topic of each channel.
    channels: HashMap<u16, usize>,
    chunk: Chunk,
    data: Vec<u8>,
    /// The message that came last.
    message: Message,
    is_over: bool,
}

/// The place of a message's bytes.
enum Message {
    InChunk(Range<usize>),
    InData(Range<usize>),
    Unpacked(Vec<u8>),
}

impl Mcap {
    pub(super) fn open(path: &Path, faults: Faults) -> Result<Self> {
        let mut bytes = Bytes::open(path)?;
        let mut start = Vec::new();
        bytes.take(VERSION.len() as u64, &mut start).with_context(|| faults.file().to_owned())?;
        if start != VERSION {
            bail!("{}: an MCAP file of another version than 0", faults.file());
        }
        Ok(Self {
            bytes,
            faults,
            topics: Vec::new(),
            schemas: HashMap::new(),
            channels: HashMap::new(),
            chunk: Chunk::default(),
            data: Vec::new(),
            message: Message::InData(0..0),
            is_over: false,
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
            return self.faults.skip(at, "the chunk ends within its head");
        };
        let packed = &left[..left.len().min(usize::try_from(stated).unwrap_or(usize::MAX))];
        let (chunk, fault) = unpack(&compression, packed, size);
        let fault = fault.or_else(|| {
            (checksum != 0 && crc32fast::hash(&chunk) != checksum)
                .then(|| "the checksum of the chunk does not match".to_owned())
        });
        self.chunk.begin(at, (chunk, fault), self.is_over, &mut self.faults)
    }

    /// The entry of a message, and how long its content is; `None` if it has no known channel.
    fn entry(&self, mut record: &[u8], at: u64) -> Option<(Entry, usize)> {
        let channel = u16_from(&mut record)?;
        let sequence = u32_from(&mut record)?;
        let (time, _published) = (u64_from(&mut record)?, u64_from(&mut record)?);
        let topic = *self.channels.get(&channel)?;
        let time = i64::try_from(time).unwrap_or(i64::MAX);
        // Recorders that do not count leave 0.
        let sequence = Some(sequence).filter(|sequence| *sequence > 0);
        Some((Entry { topic, time, at, sequence }, record.len()))
    }

    fn odd(&mut self, at: u64) -> Result<Option<Entry>> {
        self.faults.skip(at, "a message without a channel that is known").map(|()| None)
    }

    /// Takes a schema or a channel, and leaves others.
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
                    let place = topic.place_in(&mut self.topics);
                    self.channels.insert(id, place);
                }
                Some(())
            })(),
            _ => Some(()),
        };
        match is_good {
            Some(()) => Ok(()),
            None => self.faults.skip(at, "a schema or channel that ends too early"),
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
    /// The kind and place of a record, which is in `data`.
    type Record = (u8, u64);

    fn chunk(&self) -> &Chunk {
        &self.chunk
    }

    fn of_chunk(&mut self) -> Result<Option<Entry>> {
        let mut left = self.chunk.left();
        let at = self.chunk.at();
        let record = (|| {
            let kind = take(&mut left, 1)?[0];
            let length = u64_from(&mut left)?;
            Some((kind, take(&mut left, length)?))
        })();
        let Some((kind, data)) = record else {
            return self.chunk.leave(&mut self.faults).map(|()| None);
        };
        let end = self.chunk.bytes().len() - left.len();
        if kind == op::MESSAGE {
            let entry = self.entry(data, at);
            self.chunk.take_to(end);
            let Some((entry, content)) = entry else {
                return self.odd(at);
            };
            let content = end - content..end;
            self.message = unpacked(&self.chunk.bytes()[content.clone()])
                .map_or(Message::InChunk(content), Message::Unpacked);
            return Ok(Some(entry));
        }
        let data = data.to_vec();
        self.chunk.take_to(end);
        self.define(kind, &data, at).map(|()| None)
    }

    fn is_over(&mut self) -> &mut bool {
        &mut self.is_over
    }

    fn record(&mut self) -> Result<Option<(u8, u64)>> {
        const CUT: &str = "the file ends within the record";
        let at = self.bytes.at();
        let head = self.bytes.take(9, &mut self.data);
        let kind = self.data.first().copied();
        let length = u64_from(&mut self.data.get(1..).unwrap_or_default());
        let what = match (head, kind, length) {
            (Err(error), ..) => error.to_string(),
            (Ok(_), None, _) => {
                self.faults.note("the file has no end: its recorder did not close it".to_owned());
                return Ok(None);
            }
            (Ok(_), Some(kind), Some(length)) => {
                let is_wanted = (op::HEADER..=op::CHUNK).contains(&kind) || kind == op::DATA_END;
                let taken = if is_wanted {
                    self.bytes.take(length, &mut self.data)
                } else {
                    self.bytes.pass(length)
                };
                match taken {
                    Ok(true) => return Ok(Some((kind, at))),
                    Ok(false) => CUT.to_owned(),
                    Err(error) => error.to_string(),
                }
            }
            _ => CUT.to_owned(),
        };
        self.faults.end(at, what)?;
        self.is_over = true;
        // Of a chunk, what is there may hold messages.
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
                self.message = unpacked(&self.data[start..])
                    .map_or(Message::InData(start..self.data.len()), Message::Unpacked);
                Ok(Some(entry))
            }
            op::FOOTER | op::DATA_END => {
                self.is_over = true;
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

impl Log for Mcap {
    fn next(&mut self) -> Result<Option<Entry>> {
        self.next_message()
    }

    fn topics(&self) -> &[Topic] {
        &self.topics
    }

    fn message(&self) -> &[u8] {
        match &self.message {
            Message::InChunk(range) => &self.chunk.bytes()[range.clone()],
            Message::InData(range) => &self.data[range.clone()],
            Message::Unpacked(bytes) => bytes,
        }
    }

    fn faults(&mut self) -> &mut Faults {
        &mut self.faults
    }
}

/// Unpacks a message that was packed by itself.
fn unpacked(message: &[u8]) -> Option<Vec<u8>> {
    // No message of ROS 2 starts like this.
    message.starts_with(&ZSTD).then(|| unpack("zstd", message, LARGEST_MESSAGE).0)
}

/// A text, or bytes, behind their length.
fn text(left: &mut &[u8]) -> Option<String> {
    let length = u32_from(left)?;
    Some(String::from_utf8_lossy(take(left, length.into())?).into_owned())
}
