//! `spikewire encode`: a recording to spikes, in constant memory.

use crate::inputs::InputOptions;
use crate::options::Coding;
use crate::words::tell;
use anyhow::{Result, bail};
use clap::Args;
use lab::encode::{encode, encode_flight};
use lab::flight::Flight;
use lab::output::Output;
use lab::spikes::Format;
use std::path::PathBuf;

/// Encode channels of a recording: `index,address,polarity` and, where it has times, `time_us`.
///
/// With several columns the address says which: the second column's neurons are numbered on from the
/// first's. All columns have the same parameters; what is calibrated is each one's own.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  spikewire encode --scheme sf --threshold 0.1 --column gyro_x flight.csv -o spikes.csv
  spikewire encode --scheme sf --threshold 0.1 --columns gyro_x,gyro_y,gyro_z flight.csv
  spikewire encode --scheme hsa --filter triang:15,peak=2 --topic sensor_combined --field 'gyro_rad[0]' flight.ulg
  spikewire encode --flight flight.toml flight.csv
  spikewire encode --scheme mw --threshold 120 --window 5 --sample i16 --rate 1000 counts.csv")]
pub(crate) struct Encode {
    #[command(flatten)]
    coding: Coding,
    /// The flight's file, TOML, as `advise -o` writes it: its channels, as its sender encodes them
    #[arg(long, value_name = "FILE", conflicts_with_all = ["scheme", "sample", "params", "column", "columns", "topic", "field", "fields"])]
    flight: Option<PathBuf>,
    #[command(flatten)]
    input: InputOptions,
    /// File of spikes, `.csv`, `.txt` or without an ending, or of the toolbox's messages, `.bag` (ROS 1) or `.mcap` (ROS 2);
    /// standard output unless given
    #[arg(short, long)]
    output: Option<PathBuf>,
}

/// Runs the command.
///
/// # Errors
/// The recording, the parameters or the output are not good.
pub(crate) fn run(options: &Encode) -> Result<()> {
    let Encode { coding, flight, input, output } = options;
    let format = output.as_deref().map(Format::of).transpose()?.flatten();
    let open = || Output::open(output.as_deref(), &input.input);
    let (output, notes) = if let Some(flight) = flight {
        if !coding.chosen()?.2.is_empty() {
            bail!("--flight says all parameters");
        }
        encode_flight(&Flight::read(flight)?, &input.to_lab(), format, open)?
    } else {
        let (scheme, sample, parameters) = coding.one()?;
        encode(&input.to_lab(), scheme, sample, &parameters, format, open)?
    };
    output.finish()?;
    tell(&notes);
    Ok(())
}
