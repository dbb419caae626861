//! `spikewire convert`: converts events from any format to any other, in constant memory.

use crate::inputs::StreamOptions;
use crate::words::{self, option};
use anyhow::Result;
use catalogue::run::Worded;
use clap::Args;
use lab::events::{Format, Stream};
use lab::output::Output;
use lab::port::{Bytes, Port};
use std::path::PathBuf;

/// Convert events from one format to another.
///
/// FORMAT is `link` (spikewire's own frames), `edvs:e0` to `edvs:e4` (the number is the camera's time format), `es`
/// (Event Stream), `evt2`, `evt21` (read only) or `evt3` (.raw files), `eieio` (consecutive datagrams) or `csv`
/// (`tick,address,polarity`, or `tick,x,y,polarity` for the events of a camera).
///
/// Settings follow the format's name after commas. The settings of `link,period=5000,channels=6,jitter=5` only make
/// frames shorter. `period` is the time between samples in µs, `channels` is the number of channels, and `jitter` is
/// the number of bits for the jitter of times in µs, with its sign. `step-bits=4` adds step numbers, by which step codes heal after
/// lost frames. In `edvs:e2,up=0`, the polarity bit is 0 for up and
/// 1 for down. In `eieio,base=0x70000,step=1000,signed=1`, `base` is the key (number in a datagram) of address 0, and
/// `step` is the length of a time step in µs. With `signed=1`, each address has two keys: the first for down, the
/// second for up. `es,width=320,height=240` (also of `evt2` and `evt3`) is the size of a camera's picture, if the input does
/// not say it. `evt2,pixels=1` reads columns and rows from a stream without a header. `evt21,legacy=1` is the order of the bytes
/// in a word, where neither the header nor the words show it: 1 for the IMX636, 0 for the `GenX320`.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  spikewire convert --from csv --to es spikes.csv -o flight.es
  spikewire convert --from link --to csv captured.bytes
  spikewire convert --from evt3 --to csv camera.raw
  spikewire convert --from csv --to link,period=5000,channels=6 --from-zero spikes.csv -o flight.link")]
pub(crate) struct Convert {
    /// File of events; `-` is standard input
    #[arg(default_value = "-")]
    input: PathBuf,
    /// Format of the input
    #[arg(long, value_name = "FORMAT")]
    from: Format,
    /// Format of the output
    #[arg(long, value_name = "FORMAT")]
    to: Format,
    /// File to write the events to; default: standard output
    #[arg(short, long)]
    output: Option<PathBuf>,
    #[command(flatten)]
    stream: StreamOptions,
}

/// Runs the command.
///
/// # Errors
/// Returns an error if the input cannot be read or is not of the format `--from`, or if the output cannot be written.
pub(crate) fn run(options: &Convert) -> Result<()> {
    let Convert { input, from, to, output, stream } = options;
    let mut port = Port::open(input, None)?;
    let mut output = Output::open(output.as_deref(), input)?;
    let mut stream =
        Stream::new(from.reader(port.name()), to.writer(stream.drop)?, stream.from_zero);
    let mut buffer = vec![0; 1 << 16];
    loop {
        match port.read(&mut buffer)? {
            Bytes::Some(count) => stream.push(&buffer[..count], None, &mut output)?,
            Bytes::NotYet => {}
            Bytes::End => break,
        }
    }
    stream.finish(&mut output)?;
    eprint!("{}", words::page(&stream.spelled(option).to_string()));
    say!("{}", stream.written(output.bytes()));
    stream.check_format(*from, port.name())?;
    Ok(output.finish()?)
}
