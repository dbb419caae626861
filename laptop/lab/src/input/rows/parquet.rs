//! Converts Parquet files to CSV tables. Numbers, times and texts become fields; other values become missing values.

use super::{Lines, Rows, end, odd, quote};
use crate::Result;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;
use parquet::record::reader::RowIter;
use std::fs::File;
use std::io::{self, Read};

/// Reads a Parquet file as a CSV table.
pub(super) fn open(file: File) -> Result<Box<dyn Read>> {
    let unread = |error| odd(format!("a Parquet file that is not read: {error}"));
    let file = SerializedFileReader::new(file).map_err(unread)?;
    let schema = file.metadata().file_metadata().schema_descr_ptr();
    let fields = schema.root_schema().get_fields();
    if fields.iter().any(|own| own.is_group()) {
        return Err(odd("a Parquet file with nested columns; export them as columns of their own"));
    }
    let names: Vec<String> = fields.iter().map(|own| own.name().to_owned()).collect();
    // A packing that is not read is told here, and not within the rows.
    if file.metadata().num_row_groups() > 0 {
        for column in 0..names.len() {
            file.get_row_group(0)
                .and_then(|group| group.get_column_page_reader(column))
                .and_then(|mut pages| pages.get_next_page())
                .map_err(unread)?;
        }
    }
    Ok(Box::new(Lines::new(names, Table(RowIter::from_file_into(Box::new(file))))))
}

struct Table(RowIter<'static>);

impl Rows for Table {
    fn next(&mut self, text: &mut Vec<u8>) -> io::Result<bool> {
        let Some(row) = self.0.next() else { return Ok(false) };
        let row = row.map_err(io::Error::other)?;
        let is_single = row.len() == 1;
        for (_, field) in row.get_column_iter() {
            write(field, text);
            text.push(b',');
        }
        // An empty line would be passed over.
        if is_single && text.ends_with(b"\n,") || text.as_slice() == b"," {
            text.pop();
            text.extend(b"NA,");
        }
        end(text);
        Ok(true)
    }
}

/// Appends a value to `text`. A time is written as a whole number in the file's unit.
fn write(field: &Field, text: &mut Vec<u8>) {
    let (mut whole, mut decimals) = (itoa::Buffer::new(), zmij::Buffer::new());
    let digits = match *field {
        Field::Bool(own) => whole.format(u8::from(own)),
        Field::Byte(own) => whole.format(own),
        Field::Short(own) => whole.format(own),
        Field::Int(own) | Field::Date(own) | Field::TimeMillis(own) => whole.format(own),
        Field::Long(own)
        | Field::TimeMicros(own)
        | Field::TimestampMillis(own)
        | Field::TimestampMicros(own) => whole.format(own),
        Field::UByte(own) => whole.format(own),
        Field::UShort(own) => whole.format(own),
        Field::UInt(own) => whole.format(own),
        Field::ULong(own) => whole.format(own),
        Field::Float16(own) => decimals.format(own.to_f64()),
        Field::Float(own) => decimals.format(f64::from(own)),
        Field::Double(own) => decimals.format(own),
        Field::Str(ref own) => return quote(own, text),
        _ => "",
    };
    text.extend(digits.as_bytes());
}
