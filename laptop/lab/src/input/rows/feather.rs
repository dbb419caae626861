//! Converts Feather files (version 2, which are Arrow IPC files) to CSV tables. Numbers, times and texts become fields;
//! other values become missing values.

use super::parquet::write_row;
use super::{Lines, Rows, odd};
use crate::Result;
use arrow_array::cast::AsArray;
use arrow_array::types::{
    Date32Type, Date64Type, DurationMicrosecondType, DurationMillisecondType,
    DurationNanosecondType, DurationSecondType, Float16Type, Float32Type, Float64Type, Int8Type,
    Int16Type, Int32Type, Int64Type, TimestampMicrosecondType, TimestampMillisecondType,
    TimestampNanosecondType, TimestampSecondType, UInt8Type, UInt16Type, UInt32Type, UInt64Type,
};
use arrow_array::{Array, RecordBatch};
use arrow_ipc::reader::FileReader;
use arrow_schema::{DataType, TimeUnit};
use parquet::record::Field;
use std::fs::File;
use std::io::{self, BufReader, Read};

/// Reads a Feather file as a CSV table.
pub(super) fn open(file: File) -> Result<Box<dyn Read>> {
    let unread = |error| odd(format!("a Feather file that is not read: {error}"));
    let mut batches = FileReader::try_new(BufReader::new(file), None).map_err(unread)?;
    let schema = batches.schema();
    if schema.fields().iter().any(|own| own.data_type().is_nested()) {
        return Err(odd("a Feather file with nested columns; export them as columns of their own"));
    }
    let names: Vec<String> = schema.fields().iter().map(|own| own.name().clone()).collect();
    // A packing that is not read is told here, and not within the rows.
    let batch = batches.next().transpose().map_err(unread)?;
    Ok(Box::new(Lines::new(names, Table { batches, batch, row: 0 })))
}

/// The rest of a Feather file. One batch of rows is in memory at a time.
struct Table {
    batches: FileReader<BufReader<File>>,
    batch: Option<RecordBatch>,
    /// Index of the next row in the batch.
    row: usize,
}

impl Rows for Table {
    fn next(&mut self, text: &mut Vec<u8>) -> io::Result<bool> {
        while self.batch.as_ref().is_some_and(|own| own.num_rows() <= self.row) {
            self.batch = self.batches.next().transpose().map_err(io::Error::other)?;
            self.row = 0;
        }
        let Some(batch) = &self.batch else { return Ok(false) };
        write_row(batch.columns().iter().map(|own| field(own, self.row)), text);
        self.row += 1;
        Ok(true)
    }
}

/// Returns the value of a column in a row. A time is a whole number in the file's unit.
fn field(column: &dyn Array, row: usize) -> Field {
    /// Returns the value of a column of primitive values.
    macro_rules! primitive {
        ($field:ident, $kind:ident) => {
            Field::$field(column.as_primitive::<$kind>().value(row))
        };
    }
    if column.is_null(row) {
        return Field::Null;
    }
    match column.data_type() {
        DataType::Boolean => Field::Bool(column.as_boolean().value(row)),
        DataType::Int8 => primitive!(Byte, Int8Type),
        DataType::Int16 => primitive!(Short, Int16Type),
        DataType::Int32 => primitive!(Int, Int32Type),
        DataType::Int64 => primitive!(Long, Int64Type),
        DataType::UInt8 => primitive!(UByte, UInt8Type),
        DataType::UInt16 => primitive!(UShort, UInt16Type),
        DataType::UInt32 => primitive!(UInt, UInt32Type),
        DataType::UInt64 => primitive!(ULong, UInt64Type),
        DataType::Float16 => primitive!(Float16, Float16Type),
        DataType::Float32 => primitive!(Float, Float32Type),
        DataType::Float64 => primitive!(Double, Float64Type),
        DataType::Date32 => primitive!(Int, Date32Type),
        DataType::Date64 => primitive!(Long, Date64Type),
        DataType::Timestamp(TimeUnit::Second, _) => primitive!(Long, TimestampSecondType),
        DataType::Timestamp(TimeUnit::Millisecond, _) => primitive!(Long, TimestampMillisecondType),
        DataType::Timestamp(TimeUnit::Microsecond, _) => primitive!(Long, TimestampMicrosecondType),
        DataType::Timestamp(TimeUnit::Nanosecond, _) => primitive!(Long, TimestampNanosecondType),
        DataType::Duration(TimeUnit::Second) => primitive!(Long, DurationSecondType),
        DataType::Duration(TimeUnit::Millisecond) => primitive!(Long, DurationMillisecondType),
        DataType::Duration(TimeUnit::Microsecond) => primitive!(Long, DurationMicrosecondType),
        DataType::Duration(TimeUnit::Nanosecond) => primitive!(Long, DurationNanosecondType),
        DataType::Utf8 => Field::Str(column.as_string::<i32>().value(row).to_owned()),
        DataType::LargeUtf8 => Field::Str(column.as_string::<i64>().value(row).to_owned()),
        DataType::Utf8View => Field::Str(column.as_string_view().value(row).to_owned()),
        _ => Field::Null,
    }
}

#[cfg(test)]
mod tests {
    use super::open;
    use arrow_array::{
        ArrayRef, BooleanArray, Float32Array, RecordBatch, StringArray, TimestampNanosecondArray,
    };
    use arrow_ipc::CompressionType;
    use arrow_ipc::writer::{FileWriter, IpcWriteOptions};
    use std::io::{Read, Seek};
    use std::sync::Arc;

    /// Two batches of rows, as they are and packed by LZ4, which is how `pandas` writes them.
    #[test]
    fn rows_are_those_of_a_table() {
        let columns: [(&str, ArrayRef); 4] = [
            ("time", Arc::new(TimestampNanosecondArray::from(vec![5_000_000, 10_000_000]))),
            ("gyro,x", Arc::new(Float32Array::from(vec![Some(0.25), None]))),
            ("armed", Arc::new(BooleanArray::from(vec![true, false]))),
            ("mode", Arc::new(StringArray::from(vec!["a,b", ""]))),
        ];
        let batch = RecordBatch::try_from_iter(columns).unwrap();
        for packing in [None, Some(CompressionType::LZ4_FRAME)] {
            let mut file = tempfile::tempfile().unwrap();
            let options = IpcWriteOptions::default().try_with_compression(packing).unwrap();
            let schema = batch.schema();
            let mut writer = FileWriter::try_new_with_options(&mut file, &schema, options).unwrap();
            writer.write(&batch).unwrap();
            writer.write(&batch).unwrap();
            writer.finish().unwrap();
            drop(writer);
            file.rewind().unwrap();
            let mut text = String::new();
            open(file).unwrap().read_to_string(&mut text).unwrap();
            let rows = "5000000,0.25,1,\"a,b\"\n10000000,,0,\n";
            assert_eq!(text, format!("time,\"gyro,x\",armed,mode\n{rows}{rows}"));
        }
    }
}
