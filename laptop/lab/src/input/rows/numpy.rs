//! Converts `NumPy`'s arrays to CSV tables. A structured array gives a column for each field, and a plain array gives a
//! column for each of its columns. An `.npz` archive gives the columns of all its arrays.
//!
//! The header is parsed here rather than by the crate `npyz` 0.9, which needs a parser generator and a C compiler.

use super::{Lines, Rows, end, odd};
use crate::Result;
use flight_logs::files::scratch;
use std::fs::File;
use std::io::{self, BufReader, Cursor, Read, Seek};
use zip::ZipArchive;

/// Maximum number of columns of an array.
const MOST: usize = 1 << 16;

/// Reads an array as a CSV table.
pub(super) fn array(input: impl Read + 'static) -> Result<Box<dyn Read>> {
    let array = Array::open(BufReader::new(input), "")?;
    let names: Vec<String> = array.fields.iter().map(|own| own.name.clone()).collect();
    Ok(Box::new(Lines::new(names, Arrays(vec![array]))))
}

/// Reads the arrays of an archive as one CSV table, which has the columns of all arrays.
///
/// # Errors
/// Returns an error if the file is not an archive of arrays, if the archive is empty, or if the arrays have different
/// lengths.
pub(super) fn archive(file: File) -> Result<Box<dyn Read>> {
    const OTHER: &str = "a zip archive or a spreadsheet; export it as CSV";
    let no_archive = |error| odd(format!("{OTHER} ({error})"));
    let mut archive = ZipArchive::new(BufReader::new(file)).map_err(no_archive)?;
    let (mut arrays, mut names) = (Vec::new(), Vec::new());
    for place in 0..archive.len() {
        let mut member = archive.by_index(place).map_err(no_archive)?;
        let Some(name) = member.name().strip_suffix(".npy").map(str::to_owned) else {
            return Err(odd(OTHER));
        };
        // Rows are read from all arrays in turn.
        let mut content = scratch()?;
        io::copy(&mut member, &mut content)?;
        content.rewind()?;
        let array = Array::open(BufReader::new(content), &name)?;
        names.extend(array.fields.iter().map(|own| own.name.clone()));
        arrays.push(array);
    }
    let lengths: Vec<u64> = arrays.iter().map(|own| own.left).collect();
    match lengths.first() {
        None => Err(odd("an archive without arrays")),
        Some(first) if lengths.iter().any(|own| own != first) => {
            Err(odd(format!("its arrays have different lengths: {lengths:?}")))
        }
        Some(_) => Ok(Box::new(Lines::new(names, Arrays(arrays)))),
    }
}

/// An array whose rows are read one after the other.
struct Array {
    input: Box<dyn Read>,
    fields: Vec<Field>,
    row: Vec<u8>,
    /// Number of rows that are not read yet.
    left: u64,
}

/// The position and type of a number in each row.
struct Field {
    name: String,
    at: usize,
    kind: Kind,
}

/// Type of a number: the type's letter in `NumPy`, its size in bytes, and whether it is big-endian.
#[derive(Clone, Copy)]
struct Kind {
    letter: u8,
    size: usize,
    is_big: bool,
}

impl Kind {
    /// Parses a type such as `<f8`. Returns `None` if the type is not a type of numbers.
    fn of(text: &str) -> Option<Self> {
        let [order, kind, size @ ..] = text.as_bytes() else { return None };
        let size = str::from_utf8(size).ok()?.parse().ok()?;
        let is_known =
            matches!((kind, size), (b'i' | b'u', 1 | 2 | 4 | 8) | (b'f', 4 | 8) | (b'b', 1));
        is_known.then_some(Self { letter: *kind, size, is_big: *order == b'>' })
    }

    /// Appends the number in `bytes` to `text`, in decimal digits.
    fn write(self, bytes: &[u8], text: &mut Vec<u8>) {
        let mut own = [0; 8];
        for (place, byte) in own.iter_mut().zip(bytes) {
            *place = *byte;
        }
        if self.is_big {
            own[..self.size].reverse();
        }
        let unsigned = u64::from_le_bytes(own);
        let (mut whole, mut decimals) = (itoa::Buffer::new(), zmij::Buffer::new());
        let digits = match (self.letter, self.size) {
            (b'i', size) => {
                let shift = 64 - 8 * size as u32;
                whole.format((unsigned << shift) as i64 >> shift)
            }
            (b'f', 4) => decimals.format(f64::from(f32::from_bits(unsigned as u32))),
            (b'f', _) => decimals.format(f64::from_bits(unsigned)),
            _ => whole.format(unsigned),
        };
        text.extend(digits.as_bytes());
    }
}

impl Array {
    fn open(mut input: impl Read + 'static, name: &str) -> Result<Self> {
        let mut start = [0; 10];
        input.read_exact(&mut start)?;
        let mut length = usize::from(u16::from_le_bytes([start[8], start[9]]));
        if !start.starts_with(super::NPY) {
            return Err(odd(format!("`{name}` is no array of NumPy")));
        }
        if start[6] > 1 {
            let mut more = [0; 2];
            input.read_exact(&mut more)?;
            length |= usize::from(u16::from_le_bytes(more)) << 16;
        }
        let mut header = Vec::new();
        input.by_ref().take(length as u64).read_to_end(&mut header)?;
        let header = String::from_utf8_lossy(&header);
        let (fields, size, left) = layout(&header, name).ok_or_else(|| {
            let own = header.trim();
            odd(format!("no array of numbers with one or two dimensions: {own}"))
        })?;
        let input: Box<dyn Read> = if header.contains("'fortran_order': True") && fields.len() > 1 {
            Box::new(Cursor::new(by_rows(input, size / fields.len(), fields.len(), left)?))
        } else {
            Box::new(input)
        };
        Ok(Self { input, fields, row: vec![0; size], left })
    }
}

/// Reads an array that is stored column by column, and returns the bytes of the whole array row by row.
fn by_rows(mut input: impl Read, size: usize, columns: usize, rows: u64) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    input.read_to_end(&mut bytes)?;
    let rows = usize::try_from(rows).ok();
    let length = rows.and_then(|rows| rows.checked_mul(columns)?.checked_mul(size));
    let Some(rows) = rows.filter(|_| length == Some(bytes.len())) else {
        return Err(odd(format!("an array of {} bytes where its header has others", bytes.len())));
    };
    let mut sorted = Vec::with_capacity(bytes.len());
    for row in 0..rows {
        for column in 0..columns {
            let at = (column * rows + row) * size;
            sorted.extend(&bytes[at..at + size]);
        }
    }
    Ok(sorted)
}

/// Parses the header of an array. Returns the numeric fields of a row, the length of a row in bytes, and the number of
/// rows. `name` is the array's name in an archive, or empty. The names of the fields begin with it. Returns `None` if
/// the array has more than two dimensions, or a type that this module does not read.
fn layout(header: &str, name: &str) -> Option<(Vec<Field>, usize, u64)> {
    let (_, shape) = header.split_once("'shape':")?;
    let shape = shape.split_once('(')?.1.split_once(')')?.0;
    let shape: Vec<u64> = shape
        .split(',')
        .map(str::trim)
        .filter(|own| !own.is_empty())
        .map(|own| own.parse().ok())
        .collect::<Option<_>>()?;
    let (rows, columns) = match shape[..] {
        [rows] => (rows, None),
        [rows, columns] => (rows, Some(usize::try_from(columns).ok()?)),
        _ => return None,
    };
    if columns.is_some_and(|own| own > MOST) {
        return None;
    }
    let descr = header.split_once("'descr':")?.1.trim_start();
    let mut fields = Vec::new();
    let mut at = 0;
    let mut add = |name: String, kind: &str| {
        // A text is passed over.
        let size = match Kind::of(kind) {
            Some(kind) => {
                fields.push(Field { name, at, kind });
                kind.size
            }
            None => match kind.as_bytes() {
                [_, b'S', count @ ..] => str::from_utf8(count).ok()?.parse().ok()?,
                [_, b'U', count @ ..] => 4 * str::from_utf8(count).ok()?.parse::<usize>().ok()?,
                _ => return None,
            },
        };
        at += size;
        Some(())
    };
    if let Some(list) = descr.strip_prefix('[') {
        if columns.is_some() {
            return None;
        }
        for own in list.split_once(']')?.0.split('(').skip(1) {
            let mut parts = own.split('\'').skip(1).step_by(2);
            let (field, kind) = (parts.next()?, parts.next()?);
            let of = if name.is_empty() { String::new() } else { format!("{name}.") };
            add(format!("{of}{field}"), kind)?;
        }
    } else {
        let kind = descr.split('\'').nth(1)?;
        for column in 0..columns.unwrap_or(1) {
            let own = match (name, columns) {
                ("", _) => format!("{}", column + 1),
                (name, None) => name.to_owned(),
                (name, Some(_)) => format!("{name}[{column}]"),
            };
            add(own, kind)?;
        }
    }
    (!fields.is_empty()).then_some((fields, at, rows))
}

/// Arrays of equal length, read as one table. Each row of the table joins one row of every array.
struct Arrays(Vec<Array>);

impl Rows for Arrays {
    fn next(&mut self, text: &mut Vec<u8>) -> io::Result<bool> {
        for array in &mut self.0 {
            let Some(left) = array.left.checked_sub(1) else { return Ok(false) };
            array.input.read_exact(&mut array.row)?;
            array.left = left;
            for Field { at, kind, .. } in &array.fields {
                kind.write(&array.row[*at..*at + kind.size], text);
                text.push(b',');
            }
        }
        end(text);
        Ok(true)
    }
}
