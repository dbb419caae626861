//! Writes the spikes and the samples of one log as two Parquet files.

use super::unwritten;
use crate::encode::Start;
use crate::input::{ChannelOptions, Chunk, Step};
use crate::output::Output;
use crate::spikes::{Record, Summary};
use crate::{Error, Result};
use catalogue::run::Event;
use parquet::basic::{Compression, Encoding, LogicalType, Repetition, Type as Physical};
use parquet::data_type::{DoubleType, Int32Type, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::{EnabledStatistics, WriterProperties};
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::{ColumnPath, Type};
use spikewire::Polarity;
use std::collections::{HashSet, VecDeque};
use std::io::{self, Write};
use std::sync::Arc;

/// Name of the column that holds the times.
pub(super) const TIME: &str = "time_us";
/// Metadata key of a Parquet file. The value is the header of the spikes: the scheme and its settings.
pub(super) const HEADER: &str = "spikewire";
/// Metadata key of a Parquet file. The value is the number of samples at the start of the log whose times were passed
/// to [`Clock::new`](crate::input::Clock::new).
pub(super) const FIRST: &str = "spikewire.first";
/// Metadata key of a Parquet file. The value is the argument `steps` of [`Clock::new`](crate::input::Clock::new): a
/// step longer than this multiple of the usual step is a gap.
pub(super) const GAP: &str = "spikewire.gap";
/// Metadata key of a Parquet file. The value is the sample rate in Hz that the user gave. The file lacks the key if no
/// rate was given.
pub(super) const RATE: &str = "spikewire.rate";

/// Number of bytes in a row group. Each file that is being written keeps one row group in memory.
const GROUP: usize = 1 << 21;
/// Maximum number of rows in a row group.
const MOST_ROWS: usize = 1 << 17;

impl From<ParquetError> for Error {
    fn from(error: ParquetError) -> Self {
        Self::other(error)
    }
}

/// A log's file of spikes and file of samples, while they are being written.
pub(super) struct Parts {
    events: Part,
    values: Part,
    is_timed: bool,
    slots: u64,
    neurons: u16,
    /// Time between samples in µs at the rate in the header; 0 if the rate is unknown.
    period: u64,
    /// Index and time (in µs) of each finite sample whose events are not complete yet.
    pending: VecDeque<(u64, i64)>,
    /// Number of finite samples before the first one in `pending`.
    first_pending: u64,
    rows: Rows,
    samples: Chunk,
    summary: Summary,
}

/// Events that are not yet written as a row group.
#[derive(Default)]
struct Rows {
    index: Vec<i64>,
    channel: Vec<i32>,
    neuron: Vec<i32>,
    polarity: Vec<i32>,
    time: Vec<i64>,
}

impl Parts {
    /// Starts a file of spikes and a file of samples.
    ///
    /// # Errors
    /// Returns an error if a file cannot be written.
    pub(super) fn new(
        [events, values]: [Output; 2],
        start: &Start<'_>,
        options: &ChannelOptions,
    ) -> Result<Self> {
        let Start { header, names, is_timed, first, .. } = start;
        let shape = match header.channels.first() {
            Some(settings) => header.scheme.shape(settings)?,
            None => catalogue::run::Shape { neurons: 1, slots: 1 },
        };
        let lines = header.lines().into_iter().map(|(key, value)| format!("{key}={value}\n"));
        let mut about = vec![
            KeyValue::new(HEADER.to_owned(), lines.collect::<String>()),
            KeyValue::new(FIRST.to_owned(), first.to_string()),
            KeyValue::new(GAP.to_owned(), options.gap.to_string()),
        ];
        about.extend(options.rate.map(|rate| KeyValue::new(RATE.to_owned(), rate.to_string())));
        let mut of_events = vec![long("index")?, int("channel", 16, false)?];
        if shape.neurons > 1 {
            of_events.push(int("neuron", 16, false)?);
        }
        of_events.push(int("polarity", 8, true)?);
        let mut of_values = Vec::new();
        if *is_timed {
            of_events.push(long(TIME)?);
            of_values.push(long(TIME)?);
        }
        let mut taken = HashSet::from([TIME.to_owned()]);
        for name in names {
            of_values.push(double(&apart(name, &mut taken))?);
        }
        Ok(Self {
            events: Part::new(events, of_events, about.clone())?,
            values: Part::new(values, of_values, about)?,
            is_timed: *is_timed,
            slots: shape.slots as u64,
            neurons: shape.neurons as u16,
            period: header.rate.map_or(0, |rate| (1e6 / rate).round() as u64),
            pending: VecDeque::new(),
            first_pending: 0,
            rows: Rows::default(),
            samples: Chunk::default(),
            summary: Summary::default(),
        })
    }

    /// Writes the collected samples as a row group.
    fn write_samples(&mut self) -> Result<()> {
        let Chunk { columns, times } = &self.samples;
        let times = (!times.is_empty()).then_some(Column::Long(times));
        let columns = columns.iter().map(|own| Column::Double(own));
        self.values.group(times.into_iter().chain(columns))?;
        self.samples.columns.iter_mut().for_each(Vec::clear);
        self.samples.times.clear();
        Ok(())
    }

    /// Writes the collected events as a row group.
    fn write_events(&mut self) -> Result<()> {
        let Rows { index, channel, neuron, polarity, time } = &self.rows;
        let neuron = (self.neurons > 1).then_some(Column::Int(neuron));
        let time = self.is_timed.then_some(Column::Long(time));
        let first = [Column::Long(index), Column::Int(channel)];
        let columns = first.into_iter().chain(neuron).chain([Column::Int(polarity)]).chain(time);
        self.events.group(columns)?;
        self.rows = Rows::default();
        Ok(())
    }
}

impl Record for Parts {
    fn observe(&mut self, chunk: &mut Chunk, _: &[Step]) -> Result<()> {
        let rows = chunk.finite_rows();
        for (place, &is_finite) in rows.iter().enumerate() {
            if is_finite {
                let time = chunk.times.get(place).copied().unwrap_or(0);
                self.pending.push_back((self.summary.samples, time));
            } else {
                self.summary.rejected += 1;
            }
            self.summary.samples += 1;
        }
        self.samples.columns.resize(chunk.columns.len(), Vec::new());
        for (own, column) in self.samples.columns.iter_mut().zip(&chunk.columns) {
            own.extend(column);
        }
        self.samples.times.extend(&chunk.times);
        let row = size_of::<f64>() * (chunk.columns.len() + usize::from(self.is_timed));
        if self.samples.len() >= (GROUP / row.max(1)).clamp(1, MOST_ROWS) {
            self.write_samples()?;
        }
        if rows.contains(&false) {
            chunk.columns = chunk.kept(&rows);
        }
        Ok(())
    }

    fn write(&mut self, events: &mut Vec<Event>, decided: u64) -> Result<()> {
        const ROWS: usize = GROUP / size_of::<(i64, i64, i32, i32, i32)>();
        if self.slots > 1 {
            events.sort_by_key(|event| (event.sample, event.slot));
        }
        self.summary.events += events.len() as u64;
        for event in events.drain(..) {
            let (sample, time) = self.pending[(event.sample - self.first_pending) as usize];
            let within = self.period.saturating_mul(event.slot.into()) / self.slots;
            let rows = &mut self.rows;
            rows.index.push((sample * self.slots + u64::from(event.slot)) as i64);
            rows.channel.push((event.neuron / self.neurons).into());
            rows.neuron.push((event.neuron % self.neurons).into());
            rows.polarity.push(if event.polarity == Polarity::Up { 1 } else { -1 });
            rows.time.push(time.saturating_add_unsigned(within));
        }
        self.pending.drain(..(decided - self.first_pending) as usize);
        self.first_pending = decided;
        if self.rows.index.len() >= ROWS {
            self.write_events()?;
        }
        Ok(())
    }

    fn finish(mut self: Box<Self>, events: &mut Vec<Event>) -> Result<(Output, Summary)> {
        let decided = self.first_pending + self.pending.len() as u64;
        self.write(events, decided)?;
        if !self.rows.index.is_empty() {
            self.write_events()?;
        }
        if !self.samples.is_empty() {
            self.write_samples()?;
        }
        let Self { events, values, summary, .. } = *self;
        values.finish()?.finish().map_err(unwritten)?;
        Ok((events.finish()?, summary))
    }
}

/// A Parquet file that is being written.
struct Part {
    output: Output,
    file: SerializedFileWriter<Pipe>,
}

/// A buffer between the Parquet writer and the output. The Parquet writer accepts only sinks that are `Send`, and
/// `Output` is not `Send`.
#[derive(Default)]
struct Pipe(Vec<u8>);

impl Write for Pipe {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.extend(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

enum Column<'a> {
    Long(&'a [i64]),
    Int(&'a [i32]),
    Double(&'a [f64]),
}

impl Part {
    fn new(output: Output, columns: Vec<Type>, about: Vec<KeyValue>) -> Result<Self> {
        let mut properties = WriterProperties::builder()
            .set_created_by(concat!("spikewire ", env!("CARGO_PKG_VERSION")).to_owned())
            .set_compression(Compression::LZ4_RAW)
            .set_statistics_enabled(EnabledStatistics::Chunk)
            .set_key_value_metadata(Some(about));
        for column in columns.iter().filter(|own| own.get_physical_type() != Physical::INT32) {
            // Numbers that rise, and numbers that hardly repeat.
            let encoding = match column.get_physical_type() {
                Physical::INT64 => Encoding::DELTA_BINARY_PACKED,
                _ => Encoding::PLAIN,
            };
            let path = ColumnPath::from(column.name());
            properties = properties
                .set_column_dictionary_enabled(path.clone(), false)
                .set_column_encoding(path, encoding);
        }
        let fields = columns.into_iter().map(Arc::new).collect();
        let schema = Type::group_type_builder("schema").with_fields(fields).build()?;
        let pipe = Pipe::default();
        let file = SerializedFileWriter::new(pipe, Arc::new(schema), Arc::new(properties.build()))?;
        Ok(Self { output, file })
    }

    /// Writes a row group.
    fn group<'a>(&mut self, columns: impl Iterator<Item = Column<'a>>) -> Result<()> {
        let mut group = self.file.next_row_group()?;
        for column in columns {
            let Some(mut writer) = group.next_column()? else { break };
            match column {
                Column::Long(all) => writer.typed::<Int64Type>().write_batch(all, None, None)?,
                Column::Int(all) => writer.typed::<Int32Type>().write_batch(all, None, None)?,
                Column::Double(all) => writer.typed::<DoubleType>().write_batch(all, None, None)?,
            };
            writer.close()?;
        }
        group.close()?;
        self.file.flush()?;
        self.pass_on()
    }

    fn pass_on(&mut self) -> Result<()> {
        let pipe = self.file.inner_mut();
        self.output.write_all(&pipe.0).map_err(|error| unwritten(error.into()))?;
        pipe.0.clear();
        Ok(())
    }

    /// Writes the end of the file, and returns the output.
    fn finish(mut self) -> Result<Output> {
        self.file.finish()?;
        self.file.flush()?;
        self.pass_on()?;
        Ok(self.output)
    }
}

fn long(name: &str) -> Result<Type> {
    column(name, Physical::INT64, None)
}

fn double(name: &str) -> Result<Type> {
    column(name, Physical::DOUBLE, None)
}

fn int(name: &str, width: i8, is_signed: bool) -> Result<Type> {
    column(name, Physical::INT32, Some(LogicalType::integer(width, is_signed)))
}

fn column(name: &str, physical: Physical, logical: Option<LogicalType>) -> Result<Type> {
    let column = Type::primitive_type_builder(name, physical)
        .with_repetition(Repetition::REQUIRED)
        .with_logical_type(logical);
    Ok(column.build()?)
}

/// Returns `name`, with a number appended if `taken` already contains `name`. Adds the result to `taken`.
fn apart(name: &str, taken: &mut HashSet<String>) -> String {
    let numbered = (2..).map(|number| format!("{name}_{number}"));
    let name = std::iter::once(name.to_owned()).chain(numbered).find(|own| !taken.contains(own));
    let name = name.unwrap_or_default();
    taken.insert(name.clone());
    name
}
