//! `spikewire listen`: what a board sends, as events or values, while it comes.

use crate::events::{Format, LinkReader, Stream, StreamOptions, Values, values_writer};
use crate::fit::rounded;
use crate::live::Live;
use crate::options::{SchemeOptions, Step};
use crate::output::Output;
use crate::port::{Bytes, Port};
use crate::resolve::{Known, resolve};
use crate::sample_type::SampleType;
use crate::scheme::SchemeName;
use crate::settings::Settings;
use crate::stop::Stop;
use crate::values;
use anyhow::{Context, Result, bail};
use clap::{Args, ValueEnum};
use std::io::Write;
use std::path::PathBuf;

/// Listen to what a board sends: events, or with `--scheme` the values they mean.
///
/// Formats are called as in `convert`. Values come from a link, by the receiver that runs on boards:
/// bit for bit those of the sender's own decoder from a keyframe on until something is lost. For sf the
/// value just before a keyframe equals it; for tbr and mw, whose decoders drift, it is the sample itself,
/// from which they go on.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  spikewire listen --baud 921600 /dev/ttyUSB0 -o events.csv
  spikewire listen --baud 921600 /dev/ttyUSB0 --scheme sf --thresholds 0.1,0.1,0.1,0.5,0.5,0.5
  spikewire listen captured.bytes --to es -o flight.es")]
pub(crate) struct Listen {
    /// Serial port, or file of captured bytes; `-` is standard input
    #[arg(default_value = "-")]
    input: PathBuf,
    /// The input is a serial port of this speed in bits a second, 8 data bits, no parity, 1 stop bit
    #[arg(long)]
    baud: Option<u32>,
    /// Stop after so many seconds; Ctrl-C stops as well
    #[arg(long, requires = "baud")]
    seconds: Option<f64>,
    /// Format of the bytes
    #[arg(long, value_name = "FORMAT", default_value = "link")]
    from: Format,
    /// Format to write
    #[arg(long, value_name = "FORMAT", default_value = "csv")]
    to: Format,
    /// File of events or values; standard output unless given
    #[arg(short, long)]
    output: Option<PathBuf>,
    #[command(flatten)]
    stream: StreamOptions,
    /// Decode a link's frames by this scheme, the sender's
    #[arg(long)]
    scheme: Option<StepScheme>,
    /// Sample type of the sender: f32, i16, i32, or fixed point such as q16.16 or q8.8
    #[arg(long, default_value_t)]
    sample: SampleType,
    #[command(flatten)]
    parameters: StepOptions,
}

/// The schemes whose decoders add up steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum StepScheme {
    /// Temporal contrast.
    Tbr,
    /// Step forward.
    Sf,
    /// Moving window.
    Mw,
}

/// The parameters that decoding a step code takes.
#[derive(Args, Clone, Debug, Default)]
struct StepOptions {
    /// The sender's threshold, in the signal's unit, the same for all channels: `0.1`
    #[arg(long, allow_negative_numbers = true, help_heading = "Parameters")]
    threshold: Option<f64>,
    /// In its place, one for each channel from address 0 on: `0.1,0.1,0.5`
    #[arg(
        long,
        value_delimiter = ',',
        allow_negative_numbers = true,
        conflicts_with = "threshold",
        help_heading = "Parameters"
    )]
    thresholds: Vec<f64>,
    /// tbr: what a spike adds, in the signal's unit, `0.2`, or in thresholds, `2x`; `1x` unless given
    #[arg(long, help_heading = "Parameters")]
    step: Option<Step>,
    /// mw: the sender's window, for the record; its decoder needs none
    #[arg(long, help_heading = "Parameters")]
    window: Option<usize>,
    /// The value before the first event, in the signal's unit; 0 unless given, and until a keyframe comes
    #[arg(long, allow_negative_numbers = true, help_heading = "Parameters")]
    start: Option<f64>,
}

impl StepOptions {
    fn is_empty(&self) -> bool {
        let Self { threshold, thresholds, step, window, start } = self;
        threshold.is_none()
            && thresholds.is_empty()
            && step.is_none()
            && window.is_none()
            && start.is_none()
    }

    fn with(&self, scheme: SchemeName, threshold: Option<f64>) -> SchemeOptions {
        let &Self { step, window, start, .. } = self;
        // Any window will do, as it is the encoder's alone.
        let window = window.or_else(|| (scheme == SchemeName::Mw).then_some(0));
        SchemeOptions { threshold, step, window, start, ..SchemeOptions::default() }
    }
}

impl StepScheme {
    fn name(self) -> SchemeName {
        match self {
            Self::Tbr => SchemeName::Tbr,
            Self::Sf => SchemeName::Sf,
            Self::Mw => SchemeName::Mw,
        }
    }
}

/// Runs the command.
///
/// # Errors
/// The options, the port or the output are not good.
pub(crate) fn run(options: &Listen) -> Result<()> {
    let values = options.values()?;
    let mut port = Port::open(&options.input, options.baud)?;
    let stop = Stop::new(options.seconds)?;
    let mut output = Output::open(options.output.as_deref(), &options.input)?;
    let (reader, writer) = match values {
        Some(values) => {
            let reader: Box<dyn crate::events::EventReader> =
                Box::new(LinkReader::new(Some(values)));
            (reader, values_writer(options.sample))
        }
        None => (options.from.reader(port.name()), options.to.writer(options.stream.drop)),
    };
    let mut stream = Stream::new(reader, writer, options.stream.from_zero);
    let mut live = Live::new(options.output.is_none());

    let mut buffer = vec![0; 1 << 16];
    let heard = loop {
        match port.read(&mut buffer) {
            Ok(Bytes::Some(count)) => {
                let arrival = options.baud.map(|_| stop.tick());
                stream.push(&buffer[..count], arrival, &mut output)?;
                if !port.is_file() {
                    output.flush()?;
                }
            }
            Ok(Bytes::NotYet) => {}
            Ok(Bytes::End) => break Ok(()),
            Err(error) => break Err(error),
        }
        live.update(&stream);
        if stop.is_due() {
            break Ok(());
        }
    };
    // What came before a port failed is kept.
    stream.finish(&mut output)?;
    live.clear();
    eprint!("{stream}");
    match stream.check_format(options.from, port.name()) {
        // It may yet speak, or at another speed.
        Err(error) if options.baud.is_some() => eprintln!("{error}"),
        checked => checked?,
    }
    output.finish()?;
    heard
}

impl Listen {
    /// What decodes the frames, if that is wanted.
    fn values(&self) -> Result<Option<Box<dyn Values>>> {
        let Some(scheme) = self.scheme.map(StepScheme::name) else {
            if !self.parameters.is_empty() {
                bail!("a scheme's parameters need --scheme");
            }
            return Ok(None);
        };
        if !matches!(self.from, Format::Link(_)) {
            bail!("--scheme needs --from link, whose keyframes say where the sender stands");
        }
        if self.to != Format::Csv {
            bail!("--scheme gives values, which only --to csv holds");
        }
        let StepOptions { threshold, thresholds, .. } = &self.parameters;
        let thresholds: Vec<Option<f64>> = match thresholds[..] {
            [] => vec![*threshold],
            ref many => many.iter().copied().map(Some).collect(),
        };
        let mut all = Vec::new();
        for threshold in thresholds {
            let settings = settings(scheme, &self.parameters.with(scheme, threshold))?;
            let (settings, rounding) = rounded(self.sample, &settings)?;
            if let Some(rounding) = rounding {
                eprintln!("{rounding}");
            }
            all.push(settings);
        }
        values::receiver(self.sample, &all).map(Some).with_context(|| scheme.name())
    }
}

/// The settings of a channel, from its options alone.
fn settings(scheme: SchemeName, options: &SchemeOptions) -> Result<Settings> {
    options.check(scheme)?;
    if options.threshold.is_none() {
        bail!("{} needs --threshold", scheme.name());
    }
    resolve(scheme, options, Known { calibrated: None, first: &[0.0], can_calibrate: false })
}
