//! JSON lines, with an object on each line, and arrays of objects, which are read as such lines. A member of a nested object becomes a column such as `pose.x`, and an
//! element of an array becomes a column such as `gyro[0]`.

use super::{Lines, Rows, end, odd, quote};
use crate::Result;
use serde_json::value::RawValue;
use std::collections::{BTreeMap, VecDeque};
use std::io::{self, BufRead, BufReader, Read};

/// Number of lines at the start of the file from which the names of the columns are taken. A name that first appears on
/// a later line is not read.
const AHEAD: usize = 64;

/// Reads an array of objects as a CSV table.
pub(super) fn array(input: impl Read + 'static) -> Result<Box<dyn Read>> {
    lines(Records::new(input))
}

/// A reader that puts each object of an array of objects on a line of its own.
struct Records<R> {
    input: R,
    /// Number of brackets and braces that are open.
    depth: usize,
    is_text: bool,
    /// Whether the byte before was a backslash within a text.
    is_escaped: bool,
    is_over: bool,
}

impl<R: Read> Records<R> {
    fn new(input: R) -> Self {
        Self { input, depth: 0, is_text: false, is_escaped: false, is_over: false }
    }

    /// Returns the byte that stands for the next byte of the array. Bytes behind the array are kept, and are no JSON
    /// line.
    fn line(&mut self, byte: u8) -> u8 {
        if self.is_text {
            self.is_text = self.is_escaped || byte != b'"';
            self.is_escaped = !self.is_escaped && byte == b'\\';
            return byte;
        }
        match byte {
            b'"' => self.is_text = true,
            b'{' | b'[' => {
                self.depth += 1;
                if self.depth == 1 && !self.is_over {
                    return b' ';
                }
            }
            b'}' | b']' => {
                self.depth = self.depth.saturating_sub(1);
                if self.depth == 0 && !self.is_over {
                    self.is_over = true;
                    return b' ';
                }
            }
            b',' if self.depth == 1 && !self.is_over => return b'\n',
            b'\n' | b'\r' => return b' ',
            _ => {}
        }
        byte
    }
}

impl<R: Read> Read for Records<R> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let read = self.input.read(bytes)?;
        if read == 0 && !self.is_over && !bytes.is_empty() {
            return Err(io::Error::other("the JSON array has no end"));
        }
        for byte in &mut bytes[..read] {
            *byte = self.line(*byte);
        }
        Ok(read)
    }
}

/// Reads JSON lines as a CSV table.
pub(super) fn lines(input: impl Read + 'static) -> Result<Box<dyn Read>> {
    let mut rows = Objects {
        input: BufReader::with_capacity(1 << 16, input),
        names: BTreeMap::new(),
        ahead: VecDeque::new(),
        line: String::new(),
        number: 0,
    };
    let mut names = Vec::new();
    while rows.ahead.len() < AHEAD && rows.read()? {
        rows.number += 1;
        for (name, _) in fields(&rows.line, rows.number)? {
            if !rows.names.contains_key(&name) {
                rows.names.insert(name.clone(), names.len());
                names.push(name);
            }
        }
        rows.ahead.push_back(rows.line.clone());
    }
    if names.is_empty() {
        return Err(odd("its first lines hold no values"));
    }
    rows.number = 0;
    Ok(Box::new(Lines::new(names, rows)))
}

struct Objects<R> {
    input: BufReader<R>,
    /// For each name, the index of its column.
    names: BTreeMap<String, usize>,
    /// The first lines of the input. They were read in advance, to find the names of the columns.
    ahead: VecDeque<String>,
    line: String,
    number: u64,
}

impl<R: Read> Objects<R> {
    /// Reads the next line. Returns false at the end of the input.
    fn read(&mut self) -> io::Result<bool> {
        self.line.clear();
        Ok(self.input.read_line(&mut self.line)? > 0)
    }
}

impl<R: Read> Rows for Objects<R> {
    fn next(&mut self, text: &mut Vec<u8>) -> io::Result<bool> {
        match self.ahead.pop_front() {
            Some(line) => self.line = line,
            None if !self.read()? => return Ok(false),
            None => {}
        }
        self.number += 1;
        // Lines are counted, also empty ones.
        if self.line.trim().is_empty() {
            text.push(b'\n');
            return Ok(true);
        }
        let mut values = vec![None; self.names.len()];
        for (name, value) in fields(&self.line, self.number).map_err(io::Error::other)? {
            if let Some(place) = self.names.get(&name) {
                values[*place] = Some(value);
            }
        }
        for value in values {
            if let Some(value) = value {
                quote(&value, text);
            }
            text.push(b',');
        }
        end(text);
        // An empty line would be passed over.
        if text.ends_with(b"\n\n") || text.as_slice() == b"\n" {
            text.pop();
            text.extend(b"NA\n");
        }
        Ok(true)
    }
}

/// Returns the names and values of a line. Numbers keep the digits with which they are written.
fn fields(line: &str, number: u64) -> Result<Vec<(String, String)>> {
    let mut fields = Vec::new();
    if !line.trim().is_empty() {
        let read = serde_json::from_str(line).and_then(|own| flatten("", own, &mut fields));
        read.map_err(|error| odd(format!("line {number} is no JSON: {error}")))?;
    }
    Ok(fields)
}

fn flatten(
    name: &str,
    value: &RawValue,
    fields: &mut Vec<(String, String)>,
) -> serde_json::Result<()> {
    let text = value.get();
    match text.as_bytes().first() {
        Some(b'{') => {
            for (key, own) in serde_json::from_str::<BTreeMap<String, &RawValue>>(text)? {
                let within = if name.is_empty() { key } else { format!("{name}.{key}") };
                flatten(&within, own, fields)?;
            }
        }
        Some(b'[') => {
            let all: Vec<&RawValue> = serde_json::from_str(text)?;
            for (place, own) in all.into_iter().enumerate() {
                flatten(&format!("{name}[{place}]"), own, fields)?;
            }
        }
        Some(b'"') => fields.push((name.to_owned(), serde_json::from_str(text)?)),
        _ => {
            let own = match text {
                "true" => "1",
                "false" => "0",
                "null" => "",
                number => number,
            };
            fields.push((name.to_owned(), own.to_owned()));
        }
    }
    Ok(())
}
