//! `spikewire info`: lists the content of a log or a table.

use crate::inputs::{LogOptions, as_file, units};
use crate::report::{Counts, Log, Report};
use crate::words;
use anyhow::Result;
use clap::Args;
use flight_logs::Kind;
use lab::dataset::{self, Found};
use lab::input::messages::{Overview, overview};
use lab::input::{
    ChannelOptions, Clock, InputOptions, Rollover, Summary, TimeUnit, above_zero, summary,
};
use lab::output::Output;
use serde_json::json;
use std::io::Write;
use std::path::Path;

/// List the content of logs and tables: PX4's `ULog`, `ArduPilot`'s `.bin` or `.log`, telemetry `.tlog`, bags of ROS 1
/// and 2, MCAP, Betaflight's blackbox; CSV, JSON lines, Parquet, `NumPy`'s arrays; also compressed.
///
/// For a log: its topics with their fields, rates and gaps, and the data that the logger lost. For a table: its
/// columns, rows, rate and gaps. Each of several files is listed under its name.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  spikewire info flight.ulg
  spikewire info --json logs 'more/*.bag'")]
pub(crate) struct Info {
    #[command(flatten)]
    logs: LogOptions,
    /// Report time steps longer than this multiple of the usual step
    #[arg(long, default_value_t = 1.5, value_parser = above_zero)]
    gap: f64,
    /// Unit of a table's times; default: the unit in the column's name, or else a guess from its values
    #[arg(long, value_name = "UNIT", value_parser = units())]
    time_unit: Option<TimeUnit>,
    /// Line of a table that holds the names of the columns, counted from 1; default: found where it is sure
    #[arg(long, value_name = "LINE", value_parser = clap::value_parser!(u64).range(1..))]
    header: Option<u64>,
    /// Read the undamaged part of a log that is cut short or damaged
    #[arg(long)]
    accept_cut: bool,
    /// Print the content as JSON
    #[arg(long)]
    json: bool,
}

/// The content of a file: a log's format, topics and notes, or a table's summary.
enum Content {
    Log(Kind, Vec<Overview>, Vec<String>),
    Table(Box<Summary>),
}

/// Runs the command.
///
/// # Errors
/// Returns an error if a log cannot be read. The readable ones are listed first.
pub(crate) fn run(options: &Info) -> Result<()> {
    let Found { logs, is_single, .. } = options.logs.find()?;
    let mut output = Output::to(None)?;
    let mut all = Vec::new();
    for path in &logs {
        let log = path.display().to_string();
        let content = match as_file(path).and_then(|own| options.content(&own)) {
            Ok(content) => content,
            Err(error) => {
                all.push(Log::refused(log, error, is_single && !options.json)?);
                continue;
            }
        };
        if !options.json {
            let mut page = Vec::new();
            if !is_single {
                writeln!(page, "{log}")?;
            }
            content.write(&name_of(path), &mut page)?;
            if !is_single {
                writeln!(page)?;
            }
            write!(output, "{}", words::page(&String::from_utf8_lossy(&page)))?;
        }
        let (notes, content) = (content.notes(), options.json.then(|| content.json()));
        all.push(Log { log, refused: None, notes, content });
    }
    let counts = Counts::of(&all);
    if options.json {
        Report { command: "info", logs: &all, summary: counts }.print()?;
    }
    output.finish()?;
    counts.check()
}

impl Info {
    /// Reads the content of a file.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read.
    fn content(&self, log: &Path) -> Result<Content> {
        let Self { gap, accept_cut, time_unit, header, .. } = *self;
        let kind = if log == Path::new("-") { None } else { Kind::of(log)? };
        if let Some(kind) = kind {
            let (topics, notes) = overview(log, kind, accept_cut, gap)?;
            return Ok(Content::Log(kind, topics, notes));
        }
        let default = ChannelOptions::default();
        let channel = ChannelOptions { gap, accept_cut, time_unit, header, ..default };
        let table = summary(&InputOptions { input: log.to_owned(), channel })?;
        Ok(Content::Table(Box::new(table)))
    }
}

/// Returns the name under which a file is listed: its path, or `standard input`.
fn name_of(log: &Path) -> String {
    InputOptions { input: log.to_owned(), channel: ChannelOptions::default() }.name()
}

impl Content {
    fn notes(&self) -> Vec<String> {
        match self {
            Self::Log(_, _, notes) => notes.clone(),
            Self::Table(table) => words::notes(&table.notes),
        }
    }

    /// Lists the content of a file that is called `name` if it is a table.
    fn write(&self, name: &str, output: &mut impl Write) -> Result<()> {
        for note in self.notes() {
            writeln!(output, "{note}")?;
        }
        match self {
            Self::Table(table) => write_table(name, table, output),
            Self::Log(_, topics, _) => topics.iter().try_for_each(|topic| write(topic, output)),
        }
    }

    /// Returns the content as JSON.
    fn json(&self) -> serde_json::Value {
        match self {
            Self::Log(kind, topics, _) => {
                let topics: Vec<_> = topics
                    .iter()
                    .map(|own| {
                        let mut all = json!({
                            "name": own.name,
                            "type": own.kind,
                            "samples": own.count,
                            "fields": own.fields,
                            "texts": own.texts,
                            "unread": own.unread,
                            "missing": own.missing,
                            "stamp": own.stamp,
                        });
                        add_times(&mut all, &own.clock, &own.rollover);
                        all
                    })
                    .collect();
                json!({ "kind": dataset::name(Some(*kind)), "topics": topics })
            }
            Self::Table(table) => {
                let Summary { columns, rows, clock, rollover, .. } = &**table;
                let columns: Vec<_> = columns
                    .iter()
                    .map(|own| {
                        let text = own.text.as_ref();
                        let text = text.map(|(line, text)| json!({ "line": line, "text": text }));
                        json!({ "name": own.name, "missing": own.missing, "text": text })
                    })
                    .collect();
                let kind = dataset::name(None);
                let mut all = json!({ "kind": kind, "samples": rows, "columns": columns });
                add_times(&mut all, clock, rollover);
                all
            }
        }
    }
}

/// Adds statistics of the sample times to the JSON description `all`: the rate, the duration, the gaps, the steps back,
/// the restarts of the clock, a summary as text, and a note if the clock's counter has wrapped.
fn add_times(all: &mut serde_json::Value, clock: &Clock, rollover: &Rollover) {
    all["rate"] = json!(clock.rate());
    all["seconds"] = json!(clock.seconds());
    all["gaps"] = json!(clock.gaps());
    all["steps_back"] = json!(clock.steps_back());
    all["restarts"] = json!(clock.restarts());
    all["times"] = json!(clock.to_string());
    all["rollover"] = json!(rollover.note());
}

fn write_table(name: &str, table: &Summary, output: &mut impl Write) -> Result<()> {
    let Summary { columns, rows, clock, rollover, .. } = table;
    write!(output, "{name}: {rows} rows")?;
    if let Some(rate) = clock.rate() {
        write!(output, ", {:.3} s, {rate:.2} Hz", clock.seconds())?;
    }
    writeln!(output, "\n  {clock}")?;
    if let Some(note) = rollover.note() {
        writeln!(output, "  {note}")?;
    }
    let numbers = columns.iter().filter(|column| column.text.is_none());
    let numbers: Vec<&str> = numbers.map(|column| column.name.as_str()).collect();
    writeln!(output, "  {}", numbers.join(", "))?;
    for column in columns {
        if let Some((line, text)) = &column.text {
            writeln!(output, "  {}: no signal, as line {line} has `{text}`", column.name)?;
        } else if column.missing > 0 {
            let rows = if column.missing == 1 { "row" } else { "rows" };
            writeln!(
                output,
                "  {}: missing or not finite in {} {rows}",
                column.name, column.missing
            )?;
        }
    }
    Ok(())
}

fn write(topic: &Overview, output: &mut impl Write) -> Result<()> {
    let Overview { name, kind, count, clock, rollover, .. } = topic;
    let of = if kind.is_empty() { String::new() } else { format!(" of {kind}") };
    match clock.rate() {
        Some(rate) => {
            let seconds = clock.seconds();
            writeln!(
                output,
                "{name}: {count} samples{of}, {seconds:.3} s, {rate:.2} Hz\n  {clock}"
            )?;
        }
        None => writeln!(output, "{name}: {count} samples{of}")?,
    }
    if let Some(note) = rollover.note() {
        writeln!(output, "  {note}")?;
    }
    if let Some(stamp) = topic.stamp {
        writeln!(output, "  times are the sensor's own, `{stamp}`")?;
    }
    if topic.missing > 0 {
        writeln!(
            output,
            "  {} messages are missing, by the numbers of those there",
            topic.missing
        )?;
    }
    match &topic.unread {
        Some(why) => writeln!(output, "  not read: {why}")?,
        None => writeln!(output, "  {}", topic.fields.join(", "))?,
    }
    if !topic.texts.is_empty() {
        writeln!(output, "  text: {}", topic.texts.join(", "))?;
    }
    Ok(())
}
