//! `spikewire listen`: what a board sends, as events or values, while it comes.

use crate::events::{
    EventReader, Format, LinkReader, Stream, StreamOptions, Values, values_writer,
};
use crate::fit::rounded;
use crate::live::Live;
use crate::options::{augment, given};
use crate::output::Output;
use crate::params::{self, Params};
use crate::port::{Bytes, Port};
use crate::scheme::Scheme;
use crate::stop::Stop;
use crate::values::with_receiver;
use anyhow::{Result, bail};
use catalogue::run::{Known, Options, SampleType, Settings};
use catalogue::{Info, Parameter};
use clap::{Arg, ArgAction, ArgMatches, Args, Command, Error, FromArgMatches, value_parser};
use std::io::Write;
use std::path::PathBuf;

/// Listen to what a board sends: events, or with `--scheme` the values they mean.
///
/// Formats are called as in `convert`. Values come from a link, by the receiver that runs on boards:
/// bit for bit those of the sender's own decoder from a keyframe on until something is lost. Where the
/// encoder follows its decoder the value just before a keyframe equals it; decoders that drift go on from
/// the keyframe, which is the sample itself.
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
    #[arg(long, value_parser = Scheme::parser(Scheme::all().filter(|scheme| adds_up_steps(scheme.info()))))]
    scheme: Option<Scheme>,
    /// Sample type of the sender: f32, i16, i32, or fixed point such as q16.16 or q8.8; f32 unless given
    #[arg(long)]
    sample: Option<SampleType>,
    /// File of the sender's parameters, TOML, as `tune --emit toml` writes it; options override it
    #[arg(long, value_name = "FILE", value_parser = params::parse)]
    params: Option<Params>,
    #[command(flatten)]
    parameters: StepOptions,
}

fn adds_up_steps(info: &Info) -> bool {
    info.has_first_value
}

fn is_recorded(parameter: &Parameter) -> bool {
    parameter.is_recorded
}

/// The parameters that decoding a step code takes.
#[derive(Clone, Debug, Default)]
struct StepOptions {
    options: Options,
    /// In the place of `--threshold`, one for each channel from address 0 on.
    thresholds: Vec<f64>,
}

impl Args for StepOptions {
    fn augment_args(command: Command) -> Command {
        augment(command, adds_up_steps, is_recorded).arg(
            Arg::new("thresholds")
                .long("thresholds")
                .value_delimiter(',')
                .value_parser(value_parser!(f64))
                .allow_negative_numbers(true)
                .action(ArgAction::Append)
                .conflicts_with("threshold")
                .help_heading("Parameters")
                .help("In the place of --threshold, one for each channel from address 0 on: `0.1,0.1,0.5`"),
        )
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl FromArgMatches for StepOptions {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, Error> {
        let thresholds = matches.get_many("thresholds").into_iter().flatten().copied();
        let options = given(matches, adds_up_steps, is_recorded);
        Ok(Self { options, thresholds: thresholds.collect() })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

/// Runs the command.
///
/// # Errors
/// The options, the port or the output are not good.
pub(crate) fn run(options: &Listen) -> Result<()> {
    let sample = options.params.as_ref().and_then(|params| params.sample);
    let sample = options.sample.or(sample).unwrap_or_default();
    let Some(scheme) = options.named()? else {
        if !options.parameters.options.is_empty() || !options.parameters.thresholds.is_empty() {
            bail!("a scheme's parameters need --scheme");
        }
        return listen(options, None);
    };
    let settings = options.settings(scheme, sample)?;
    with_receiver(scheme, sample, &settings, |values| listen(options, Some((values, sample))))
}

fn listen(options: &Listen, values: Option<(Box<dyn Values + '_>, SampleType)>) -> Result<()> {
    let mut port = Port::open(&options.input, options.baud)?;
    let stop = Stop::new(options.seconds)?;
    let mut output = Output::open(options.output.as_deref(), &options.input)?;
    let (reader, writer): (Box<dyn EventReader + '_>, _) = match values {
        Some((values, sample)) => (Box::new(LinkReader::new(Some(values))), values_writer(sample)),
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
    /// The scheme named, here or in the file of parameters.
    fn named(&self) -> Result<Option<Scheme>> {
        let Some(params) = &self.params else { return Ok(self.scheme) };
        let scheme = params.agreed(self.scheme)?;
        if !adds_up_steps(scheme.info()) {
            bail!("a link's receiver adds up steps, which {} does not", scheme.name());
        }
        Ok(Some(scheme))
    }

    /// The settings of one channel for all, or of each.
    fn settings(&self, scheme: Scheme, sample: SampleType) -> Result<Vec<Settings>> {
        if !matches!(self.from, Format::Link(_)) {
            bail!("--scheme needs --from link, whose keyframes say where the sender stands");
        }
        if self.to != Format::Csv {
            bail!("--scheme gives values, which only --to csv holds");
        }
        let StepOptions { options, thresholds } = &self.parameters;
        let options = &match &self.params {
            Some(params) => options.or(&params.options),
            None => options.clone(),
        };
        let each: Vec<Options> = match thresholds[..] {
            [] => vec![options.clone()],
            ref many => many
                .iter()
                .map(|threshold| {
                    let mut options = options.clone();
                    options.set("threshold", &threshold.to_string());
                    options
                })
                .collect(),
        };
        let mut all = Vec::new();
        for mut options in each {
            // Any value will do of what is the encoder's alone.
            for parameter in scheme.info().parameters.iter().filter(|own| own.is_of_encoder) {
                if options.get(parameter.name).is_none() {
                    options.set(parameter.name, parameter.example);
                }
            }
            let settings = settings(scheme, &options)?;
            let (settings, rounding) = rounded(scheme, sample, &settings)?;
            if let Some(rounding) = rounding {
                eprintln!("{rounding}");
            }
            all.push(settings);
        }
        Ok(all)
    }
}

/// The settings of a channel, from its options alone.
fn settings(scheme: Scheme, options: &Options) -> Result<Settings> {
    let known = Known { calibrated: None, first: &[0.0], can_calibrate: false };
    scheme.resolve(options, &known)
}
