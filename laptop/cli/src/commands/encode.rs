//! `spikewire encode`: encodes a recording as spikes, in constant memory.

use crate::inputs::InputOptions;
use crate::options::Coding;
use crate::words::tell;
use anyhow::{Result, bail};
use clap::Args;
use lab::encode::{encode, encode_flight};
use lab::flight::Flight;
use lab::input::Unnamed;
use lab::output::Output;
use lab::spikes::Format;
use std::path::PathBuf;

/// Encode channels of a recording: writes `index,address,polarity` and, if the recording has times, `time_us`.
///
/// With several columns, each has a range of addresses of its own: the neurons of the second column are numbered after
/// those of the first. The given parameters hold for all columns. Calibration is done for each column separately.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  spikewire encode --scheme sf --threshold 0.1 --channels gyro_x flight.csv -o spikes.csv
  spikewire encode --scheme sf --threshold 0.1 --channels 'gyro_*' flight.csv
  spikewire encode --scheme hsa --filter triang:15,peak=2 --channels 'sensor_combined.gyro_rad[0]' flight.ulg
  spikewire encode --flight flight.toml flight.csv
  spikewire encode --scheme mw --threshold 120 --window 5 --sample i16 --rate 1000 counts.csv")]
pub(crate) struct Encode {
    #[command(flatten)]
    coding: Coding,
    /// Flight file (`flight.toml`), as written by `advise -o`. The channels in the file are encoded exactly as the
    /// sender on the drone encodes them
    #[arg(long, value_name = "FILE", conflicts_with_all = ["scheme", "sample", "params", "column", "columns", "field", "fields"])]
    flight: Option<PathBuf>,
    #[command(flatten)]
    input: InputOptions,
    /// File to write: spikes as `.csv`, `.txt` or without an extension, or ROS messages `spyke_msgs` as `.bag` (ROS 1)
    /// or `.mcap` (ROS 2); default: standard output
    #[arg(short, long)]
    output: Option<PathBuf>,
}

/// Runs the command.
///
/// # Errors
/// Returns an error if the recording or the parameters are invalid, or if the output cannot be written.
pub(crate) fn run(options: &Encode) -> Result<()> {
    let Encode { coding, flight, input, output } = options;
    let format = output.as_deref().map(Format::of).transpose()?.flatten();
    let open = || Output::open(output.as_deref(), &input.input);
    let (output, notes) = if let Some(flight) = flight {
        if !coding.chosen()?.2.is_empty() {
            bail!("--flight says all parameters");
        }
        encode_flight(&Flight::read(flight)?, &input.to_lab()?, format, open)?
    } else {
        let (scheme, sample, parameters) = coding.one()?;
        encode(&input.to_lab()?.or(Unnamed::Inertial), scheme, sample, &parameters, format, open)?
    };
    output.finish()?;
    tell(&notes);
    Ok(())
}
