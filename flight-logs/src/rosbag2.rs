//! Reads ROS 2 bags: `SQLite` databases, and directories of databases or of MCAP files.

use super::bytes::unpack;
use super::definition::Dialect;
use super::faults::Faults;
use super::known::known;
use super::mcap::LARGEST_MESSAGE;
use super::sqlite::{Database, Rows};
use super::topic::Topic;
use super::zstd::ZSTD;
use super::{Entry, Error, ErrorKind, Kind, Log, Result, files, open};
use std::collections::{HashMap, VecDeque};
use std::path::{Path, PathBuf};

/// Name of the file that every bag directory contains.
pub(crate) const METADATA: &str = "metadata.yaml";

/// Reason that the messages of a topic cannot be read if the bag has no definition of them.
const UNDEFINED: &str = "the bag has no definition of its messages, as those written before ROS 2 Iron; \
    `ros2 bag convert` to MCAP adds it";

/// Reader of a ROS 2 bag in a `SQLite` database.
pub(crate) struct Sqlite {
    database: Database,
    faults: Faults,
    topics: Vec<Topic>,
    /// Map from the number of a topic in the database to its index in `topics`.
    topic_indices: HashMap<i64, usize>,
    rows: Rows,
    /// Indices of the columns with topic, time and content of a message.
    columns: [usize; 3],
    message: Vec<u8>,
}

impl Sqlite {
    pub(crate) fn open(path: &Path, mut faults: Faults) -> Result<Self> {
        let mut database = Database::open(path)?;
        let mut wal = path.as_os_str().to_owned();
        wal.push("-wal");
        if files::has_bytes(Path::new(&wal)) {
            let wal = wal.to_string_lossy();
            faults.skip(0, format!("{wal} holds messages that are not in the file yet"))?;
        }
        let file = faults.file().to_owned();
        let missing =
            |what: &str| Error::not_a_log(&file, format!("no bag of ROS 2, which has {what}"));
        let mut definitions = HashMap::new();
        if let Some(table) = database.table("message_definitions", &mut faults)? {
            let names = ["topic_type", "encoding", "encoded_message_definition"];
            let columns: Option<Vec<usize>> = names.iter().map(|name| table.column(name)).collect();
            let mut rows = table.rows();
            while let Some(row) = rows.next(&mut database, &mut faults)? {
                let text = |column: usize| row.text(*columns.as_ref()?.get(column)?);
                if let (Some(kind), Some(encoding), Some(text)) = (text(0), text(1), text(2)) {
                    definitions.insert(kind, (encoding, text));
                }
            }
        }
        let table = database.table("topics", &mut faults)?;
        let table = table.ok_or_else(|| missing("a table `topics`"))?;
        let column = |name: &str| table.column(name).ok_or_else(|| missing(name));
        let [id, name, kind, format] =
            [column("id")?, column("name")?, column("type")?, column("serialization_format")?];
        let (mut topics, mut topic_indices) = (Vec::new(), HashMap::new());
        let mut rows = table.rows();
        while let Some(row) = rows.next(&mut database, &mut faults)? {
            let (Some(id), Some(name), Some(kind)) =
                (row.integer(id), row.text(name), row.text(kind))
            else {
                faults.skip(row.at, "a topic without a number, a name or a type")?;
                continue;
            };
            let format = row.text(format).unwrap_or_default();
            let topic = match definitions.get(&kind) {
                _ if format != "cdr" => {
                    Topic::unread(name, kind, format!("encoding `{format}`; there is cdr"))
                }
                Some((encoding, text)) if encoding == "ros2msg" => {
                    Topic::new(name, kind, Dialect::Ros2, text)
                }
                Some((encoding, _)) => {
                    let why = format!("a definition in `{encoding}`; there is ros2msg");
                    Topic::unread(name, kind, why)
                }
                None => match known(&kind) {
                    Some(text) => Topic::new(name, kind, Dialect::Ros2, &text),
                    None => Topic::unread(name, kind, UNDEFINED.to_owned()),
                },
            };
            topic_indices.insert(id, topic.index_in(&mut topics));
        }
        let table = database.table("messages", &mut faults)?;
        let table = table.ok_or_else(|| missing("a table `messages`"))?;
        let column = |name: &str| table.column(name).ok_or_else(|| missing(name));
        let columns = [column("topic_id")?, column("timestamp")?, column("data")?];
        let rows = table.rows();
        Ok(Self { database, faults, topics, topic_indices, rows, columns, message: Vec::new() })
    }
}

impl Log for Sqlite {
    fn next(&mut self) -> Result<Option<Entry>> {
        while let Some(mut row) = self.rows.next(&mut self.database, &mut self.faults)? {
            let [topic, time, data] = self.columns;
            let topic = row.integer(topic).and_then(|id| self.topic_indices.get(&id));
            let (Some(&topic), Some(time), Some(data)) =
                (topic, row.integer(time), row.take_bytes(data))
            else {
                self.faults.skip(row.at, "a message without a topic, a time or content")?;
                continue;
            };
            self.message = data;
            // A recorder may compress each message. No uncompressed message starts like this.
            if self.message.starts_with(&ZSTD) {
                self.message = unpack("zstd", &self.message, LARGEST_MESSAGE).0;
            }
            return Ok(Some(Entry { topic, time, at: row.at, sequence: None }));
        }
        Ok(None)
    }

    fn topics(&self) -> &[Topic] {
        &self.topics
    }

    fn message(&self) -> &[u8] {
        &self.message
    }

    fn faults(&mut self) -> &mut Faults {
        &mut self.faults
    }
}

/// Reader of a ROS 2 bag in a directory: its files are read one after the other.
pub(crate) struct Directory {
    files: VecDeque<PathBuf>,
    current: Option<Box<dyn Log>>,
    /// Indices in `topics` of the current file's topics, in the order in which the file lists its topics.
    topic_indices: Vec<usize>,
    topics: Vec<Topic>,
    faults: Faults,
}

impl Directory {
    /// Opens a bag. `path` is the directory of the bag, or the file `metadata.yaml` in the directory.
    ///
    /// # Errors
    /// Returns an error if `metadata.yaml` cannot be read, or lists no files.
    pub(crate) fn open(path: &Path, faults: Faults) -> Result<Self> {
        let metadata = if files::is_dir(path) { path.join(METADATA) } else { path.to_owned() };
        let text = files::read_to_string(&metadata)
            .map_err(|error| Error::of(&metadata, ErrorKind::Read(error)))?;
        let directory = metadata.parent().unwrap_or(Path::new(""));
        let files: VecDeque<PathBuf> = files(&text).map(|name| directory.join(name)).collect();
        if files.is_empty() {
            return Err(Error::not_a_log(metadata.display().to_string(), "it lists no files"));
        }
        Ok(Self { files, current: None, topic_indices: Vec::new(), topics: Vec::new(), faults })
    }
}

/// Returns the names of the bag's files, which `metadata.yaml` lists under `relative_file_paths:`.
fn files(text: &str) -> impl Iterator<Item = &str> {
    let mut lines = text.lines().map(str::trim);
    lines.by_ref().find(|line| *line == "relative_file_paths:");
    let names = lines.map_while(|line| line.strip_prefix("- "));
    names.map(|name| name.trim().trim_matches(['"', '\'']))
}

impl Log for Directory {
    fn next(&mut self) -> Result<Option<Entry>> {
        loop {
            if let Some(log) = &mut self.current {
                if let Some(entry) = log.next()? {
                    for topic in log.topics().iter().skip(self.topic_indices.len()) {
                        self.topic_indices.push(topic.clone().index_in(&mut self.topics));
                    }
                    return Ok(Some(Entry { topic: self.topic_indices[entry.topic], ..entry }));
                }
                for note in log.faults().notes() {
                    self.faults.note(note);
                }
                self.current = None;
            }
            let Some(file) = self.files.pop_front() else { return Ok(None) };
            let kind = Kind::of(&file)?.filter(|kind| *kind != Kind::Directory);
            let kind = kind
                .ok_or_else(|| Error::not_a_log(file.display().to_string(), "no bag of ROS 2"))?;
            self.topic_indices.clear();
            self.current = Some(open(&file, kind, self.faults.damage())?);
        }
    }

    fn topics(&self) -> &[Topic] {
        &self.topics
    }

    fn message(&self) -> &[u8] {
        self.current.as_ref().map_or(&[], |log| log.message())
    }

    fn faults(&mut self) -> &mut Faults {
        match &mut self.current {
            Some(log) => log.faults(),
            None => &mut self.faults,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::files;

    #[test]
    fn files_are_those_listed() {
        let text = "rosbag2_bagfile_information:\n  relative_file_paths:\n    - a_0.db3\n    - \"a_1.db3\"\n  topics:\n    - x\n";
        assert_eq!(files(text).collect::<Vec<_>>(), ["a_0.db3", "a_1.db3"]);
        assert_eq!(files("version: 5\n").count(), 0);
    }
}
