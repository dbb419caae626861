//! Summarises a CSV table: its columns, and the times of its rows.

use super::is_missing;
use crate::Result;
use crate::input::text::shown;
use crate::input::time::{microseconds, number};
use crate::input::times::Times;
use crate::input::{ALL, Clock, InputOptions, Rollover, Source};
use catalogue::run::Words;

/// A summary of a CSV table.
#[derive(Debug)]
pub struct Summary {
    /// The columns of signals: all columns except the column of times and columns of counts, such as `index`.
    pub columns: Vec<ColumnSummary>,
    /// Number of rows.
    pub rows: u64,
    /// Duration, sample rate and gaps of the table, from the times of the rows.
    pub clock: Clock,
    /// Wraps of the recorder's 32-bit clock.
    pub rollover: Rollover,
    /// Notes for the user on how the table is read.
    pub notes: Vec<Words>,
}

/// A summary of one column of a table.
#[derive(Debug)]
pub struct ColumnSummary {
    /// Name of the column.
    pub name: String,
    /// Number of rows in which the value is missing or not finite.
    pub missing: u64,
    /// The first field of the column that is not a number. The pair has the number of the field's line, and the field's
    /// text.
    pub text: Option<(u64, String)>,
}

/// Summarises a CSV table, whose columns may also hold text.
///
/// # Errors
/// Returns an error if the table cannot be read, or if a time is invalid.
pub fn summary(input: &InputOptions) -> Result<Summary> {
    let mut options = input.clone();
    options.channel.columns = vec![ALL.to_owned()];
    let mut table = options.open_table()?;
    let columns = table.names().into_iter().map(str::to_owned);
    let mut columns: Vec<ColumnSummary> =
        columns.map(|name| ColumnSummary { name, missing: 0, text: None }).collect();
    let mut times = Times::new(input.gap);
    let mut rows = 0;
    while table.advance()? {
        for (own, column) in columns.iter_mut().zip(&table.columns) {
            let field = table.record.get(column.index).unwrap_or_default().trim_ascii();
            match number(field, table.has_decimal_commas) {
                Some(value) => own.missing += u64::from(!value.is_finite()),
                None if is_missing(field) => own.missing += 1,
                None if own.text.is_none() => own.text = Some((table.line(), shown(field))),
                None => {}
            }
        }
        if let Some(time) = &table.time {
            let Some(picoseconds) = time.read(&table.record) else {
                return Err(table.no_time(time));
            };
            times.observe(microseconds(picoseconds));
        }
        rows += 1;
    }
    let (clock, rollover) = times.finish();
    Ok(Summary { columns, rows, clock, rollover, notes: table.notes })
}
