//! Options for the source of samples, and for the way of events from one format to another.

use clap::Args;
use clap::builder::{MapValueParser, PossibleValuesParser, TypedValueParser};
use lab::input::{self, Delimiter, TimeUnit, above_zero};
use std::path::{Path, PathBuf};

/// Options for events on their way from one format to another.
#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct StreamOptions {
    /// Take the first tick off all: some formats count from 0
    #[arg(long)]
    pub from_zero: bool,
    /// Go on without the events that the format has no word for, and count them
    #[arg(long)]
    pub drop: bool,
}

/// The recording, and the options to read it.
#[derive(Args, Clone, Debug)]
pub(crate) struct InputOptions {
    /// CSV table with a header, or log: PX4's `ULog`, `ArduPilot`'s `.bin` and `.log`, telemetry `.tlog`, bag of ROS 1 or
    /// 2, MCAP, Betaflight's blackbox; also compressed; `-` is a CSV table on standard input
    pub input: PathBuf,
    #[command(flatten)]
    channel: ChannelOptions,
}

/// Options that choose channels of a recording, and say how they are read.
#[derive(Args, Clone, Debug)]
pub(crate) struct ChannelOptions {
    /// Column of a CSV table, by name or by number from 1; `encode` takes several
    #[arg(long, help_heading = "Input")]
    column: Vec<String>,
    /// Several columns at once: `gyro_x,gyro_y,gyro_z`, or `all`; of a log `TOPIC.FIELD`
    #[arg(
        long,
        visible_alias = "channel",
        value_delimiter = ',',
        value_name = "NAMES",
        help_heading = "Input"
    )]
    columns: Vec<String>,
    /// Column that holds the time; found by its name, as Betaflight, `ArduPilot`, PX4, ROS and pandas
    /// write it, unless given. In a ROS log a field such as `header.stamp`; when a message was recorded unless given
    #[arg(long, value_name = "COLUMN", help_heading = "Input")]
    time: Option<String>,
    /// Unit of that column; told by its name, such as `time (us)` or `stamp_ns`, or by its values,
    /// unless given
    #[arg(long, value_name = "UNIT", value_parser = units(), help_heading = "Input")]
    time_unit: Option<TimeUnit>,
    /// What stands between columns: `,` `;` `|` `tab` `space`; found in the header unless given
    #[arg(long, help_heading = "Input")]
    delimiter: Option<Delimiter>,
    /// Topic of a log; with `:1` after it for the second instance of a sensor
    #[arg(long, help_heading = "Input")]
    topic: Option<String>,
    /// Field of that topic, such as `gyro_rad[0]` or `angular_velocity.x`; `encode` takes several
    #[arg(long, help_heading = "Input")]
    field: Vec<String>,
    /// Several fields at once: `gyro_rad[0],gyro_rad[1]`
    #[arg(long, value_delimiter = ',', value_name = "NAMES", help_heading = "Input")]
    fields: Vec<String>,
    /// Samples a second, where no time is recorded
    #[arg(long, value_parser = above_zero, help_heading = "Input")]
    rate: Option<f64>,
    /// Report steps in time above this many usual steps
    #[arg(long, default_value_t = 1.5, value_parser = above_zero, help_heading = "Input")]
    gap: f64,
    /// Go on over rows with a value that is missing (empty, `NA`) or not finite: they emit nothing and
    /// are counted
    #[arg(long, help_heading = "Input")]
    skip_non_finite: bool,
    /// Take the whole messages of a log that is cut short or damaged
    #[arg(long, help_heading = "Input")]
    accept_cut: bool,
}

/// Takes the short name of a unit of time.
fn units() -> MapValueParser<PossibleValuesParser, fn(String) -> TimeUnit> {
    PossibleValuesParser::new(["s", "ms", "us", "ns"]).map(|name| match name.as_str() {
        "ms" => TimeUnit::Ms,
        "us" => TimeUnit::Us,
        "ns" => TimeUnit::Ns,
        // The parser lets no other name pass.
        _ => TimeUnit::S,
    })
}

impl InputOptions {
    /// The options as the library has them.
    pub(crate) fn to_lab(&self) -> input::InputOptions {
        self.channel.of(&self.input)
    }
}

impl ChannelOptions {
    /// The options for a recording, as the library has them.
    pub(crate) fn of(&self, input: &Path) -> input::InputOptions {
        let own = self.clone();
        let channel = input::ChannelOptions {
            column: own.column,
            columns: own.columns,
            time: own.time,
            time_unit: own.time_unit,
            delimiter: own.delimiter,
            topic: own.topic,
            field: own.field,
            fields: own.fields,
            rate: own.rate,
            gap: own.gap,
            skip_non_finite: own.skip_non_finite,
            accept_cut: own.accept_cut,
        };
        input::InputOptions { input: input.to_owned(), channel }
    }
}
