//! Where samples come from, and how events go through, as options.

use clap::builder::{MapValueParser, PossibleValuesParser, TypedValueParser};
use clap::{ArgMatches, Args, Command, Error, FromArgMatches};
use lab::input::{self, Delimiter, TimeUnit, above_zero};
use std::ops::Deref;
use std::path::PathBuf;

/// How events go through.
#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct StreamOptions {
    /// Take the first tick off all: some formats count from 0
    #[arg(long)]
    pub from_zero: bool,
    /// Go on without the events that the format has no word for, and count them
    #[arg(long)]
    pub drop: bool,
}

/// Where samples come from.
#[derive(Args, Clone, Debug)]
struct InputArgs {
    /// CSV table with a header, also compressed by gzip, or log: PX4's `ULog`, bag of ROS 1 or
    /// 2, MCAP, Betaflight's blackbox; `-` is a CSV table on
    /// standard input
    input: PathBuf,
    #[command(flatten)]
    channel: ChannelArgs,
}

/// What of a recording is read, and how.
#[derive(Args, Clone, Debug)]
struct ChannelArgs {
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
    /// Topic of a log; in a PX4 log with `:1` after it for its second instance
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

impl From<InputArgs> for input::InputOptions {
    fn from(args: InputArgs) -> Self {
        Self { input: args.input, channel: args.channel.into() }
    }
}

impl From<ChannelArgs> for input::ChannelOptions {
    fn from(args: ChannelArgs) -> Self {
        let ChannelArgs {
            column,
            columns,
            time,
            time_unit,
            delimiter,
            topic,
            field,
            fields,
            rate,
            gap,
            skip_non_finite,
            accept_cut,
        } = args;
        Self {
            column,
            columns,
            time,
            time_unit,
            delimiter,
            topic,
            field,
            fields,
            rate,
            gap,
            skip_non_finite,
            accept_cut,
        }
    }
}

/// Declares options that are read as `$args` and then stand for `$options` of the library.
macro_rules! options {
    ($(#[$doc:meta])* $name:ident, $args:ident, $options:ty) => {
        $(#[$doc])*
        #[derive(Clone, Debug)]
        pub(crate) struct $name(pub $options);

        impl Deref for $name {
            type Target = $options;

            fn deref(&self) -> &$options {
                &self.0
            }
        }

        impl Args for $name {
            fn augment_args(command: Command) -> Command {
                $args::augment_args(command)
            }

            fn augment_args_for_update(command: Command) -> Command {
                $args::augment_args_for_update(command)
            }
        }

        impl FromArgMatches for $name {
            fn from_arg_matches(matches: &ArgMatches) -> Result<Self, Error> {
                Ok(Self($args::from_arg_matches(matches)?.into()))
            }

            fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), Error> {
                *self = Self::from_arg_matches(matches)?;
                Ok(())
            }
        }
    };
}

options!(
    /// Where samples come from.
    InputOptions,
    InputArgs,
    input::InputOptions
);
options!(
    /// What of a recording is read, and how.
    ChannelOptions,
    ChannelArgs,
    input::ChannelOptions
);
