//! Converts Parquet files to CSV tables. Numbers, times and texts become fields; other values become missing values.

use super::{Lines, Rows, end, odd, quote};
use crate::Result;
use parquet::data_type::Decimal;
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
        Field::Decimal(ref own) => return decimal(own, text),
        _ => "",
    };
    text.extend(digits.as_bytes());
}

/// Appends a decimal number to `text`, with all its digits. Its bytes are a whole number in two's complement, the
/// highest byte first, and its scale is the number of digits behind the point. A number of more than 128 bits, which no
/// sensor has, becomes a missing value.
fn decimal(own: &Decimal, text: &mut Vec<u8>) {
    let Ok(scale) = usize::try_from(own.scale()) else { return };
    let bytes = own.data();
    if bytes.len() > size_of::<i128>() {
        return;
    }
    let sign = bytes.first().map_or(0, |first| if *first >= 0x80 { -1 } else { 0 });
    let whole = bytes.iter().fold(sign, |whole: i128, byte| whole << 8 | i128::from(*byte));
    let digits = whole.unsigned_abs().to_string();
    let digits = format!("{digits:0>width$}", width = scale + 1);
    let (before, behind) = digits.split_at(digits.len() - scale);
    if whole < 0 {
        text.push(b'-');
    }
    text.extend(before.as_bytes());
    if scale > 0 {
        text.push(b'.');
        text.extend(behind.as_bytes());
    }
}

#[cfg(test)]
mod tests {
    use super::decimal;
    use parquet::data_type::Decimal;

    #[test]
    fn decimals_keep_their_digits() {
        let of_bytes = |bytes: &[u8], scale| Decimal::from_bytes(bytes.to_vec().into(), 38, scale);
        for (own, digits) in [
            (Decimal::from_i32(125, 9, 2), "1.25"),
            (Decimal::from_i32(-5, 9, 3), "-0.005"),
            (Decimal::from_i64(7, 18, 0), "7"),
            (of_bytes(&[0xff, 0x38], 2), "-2.00"),
            (of_bytes(&[0x7f; 16], 4), "16947396313317327396019049076013554.0607"),
            (of_bytes(&[1; 17], 0), ""),
        ] {
            let mut text = Vec::new();
            decimal(&own, &mut text);
            assert_eq!(String::from_utf8(text).unwrap(), digits);
        }
    }
}
