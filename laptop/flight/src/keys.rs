//! Positions of the keys in the text of a flight file.

use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A table of a flight file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Table {
    File,
    Filter,
    Parameters,
    Channel(usize),
    ChannelParameters(usize),
}

/// A key of a flight file.
#[derive(Debug)]
struct Key {
    table: Table,
    name: String,
    /// Byte offset of the key.
    start: usize,
    /// Byte offset of the end of its value.
    end: usize,
}

/// The keys in the text of a flight file, in their order.
#[derive(Debug)]
pub(crate) struct Keys<'t> {
    text: &'t str,
    list: Vec<Key>,
    /// Byte offset of each channel.
    channels: Vec<usize>,
}

impl<'t> Keys<'t> {
    /// Finds the keys; none if the text is not TOML.
    pub(crate) fn of(text: &'t str) -> Self {
        let mut keys = Self { text, list: Vec::new(), channels: Vec::new() };
        let Ok(file) = DeTable::parse(text) else { return keys };
        for (name, value) in file.get_ref() {
            keys.push(Table::File, name.get_ref(), name.span().start, value);
            match (name.get_ref().as_ref(), value.get_ref()) {
                ("filter", DeValue::Table(filter)) => keys.push_all(Table::Filter, filter),
                ("parameters", DeValue::Table(all)) => keys.push_all(Table::Parameters, all),
                ("channel", DeValue::Array(channels)) => keys.push_channels(channels),
                _ => {}
            }
        }
        keys.list.sort_by_key(|key| key.start);
        keys
    }

    fn push_channels(&mut self, channels: &[Spanned<DeValue>]) {
        for (index, channel) in channels.iter().enumerate() {
            self.channels.push(channel.span().start);
            let DeValue::Table(channel) = channel.get_ref() else { continue };
            self.push_all(Table::Channel(index), channel);
            if let Some(DeValue::Table(all)) = channel.get("parameters").map(Spanned::get_ref) {
                self.push_all(Table::ChannelParameters(index), all);
            }
        }
    }

    fn push_all(&mut self, table: Table, content: &DeTable) {
        for (name, value) in content {
            self.push(table, name.get_ref(), name.span().start, value);
        }
    }

    fn push(&mut self, table: Table, name: &str, start: usize, value: &Spanned<DeValue>) {
        self.list.push(Key { table, name: name.to_owned(), start, end: value.span().end });
    }

    /// Returns the line of a byte of the text, counted from 1.
    pub(crate) fn line(&self, at: usize) -> usize {
        1 + self.text.bytes().take(at).filter(|byte| *byte == b'\n').count()
    }

    /// Returns name and line of the innermost key whose name or value has this byte.
    pub(crate) fn at(&self, at: usize) -> Option<(&str, usize)> {
        let key = self.list.iter().rfind(|key| (key.start..key.end).contains(&at))?;
        Some((&key.name, self.line(key.start)))
    }

    /// Returns the line of a channel.
    pub(crate) fn channel_line(&self, channel: usize) -> Option<usize> {
        self.channels.get(channel).map(|at| self.line(*at))
    }

    /// Returns the line of the key with this name: that of the channel, if one is given, or else one that holds for all
    /// channels. If there is none, as when a key is missing, it is the line of the channel, or the first line.
    pub(crate) fn line_of(&self, channel: Option<usize>, name: &str) -> usize {
        let tables = match channel {
            Some(channel) => {
                vec![Table::ChannelParameters(channel), Table::Channel(channel), Table::Parameters]
            }
            None => {
                vec![Table::File, Table::Filter, Table::Parameters, Table::ChannelParameters(0)]
            }
        };
        for table in tables {
            let found = self.list.iter().find(|key| key.table == table && key.name == name);
            if let Some(key) = found {
                return self.line(key.start);
            }
        }
        channel.and_then(|channel| self.channel_line(channel)).unwrap_or(1)
    }
}
