//! `spikewire listen`: prints what a board sends, as events or as decoded values, while the bytes arrive.

use crate::inputs::{StreamOptions, read_flight};
use crate::live::Live;
use crate::options::{agreed, augment, given, option_group, schemes};
use crate::panel::{Panel, Screen};
use crate::stop::Stop;
use crate::words::{self, of_lab, option};
use anyhow::{Result, bail};
use catalogue::Parameter;
use catalogue::run::{Asked, Known, SampleType, Settings, Worded};
use clap::{Args, value_parser};
use lab::coding::Coding;
use lab::events::{EventReader, Format, LinkReader, LinkTally, Stream, Values, values_writer};
use lab::fit::rounding;
use lab::flight;
use lab::output::Output;
use lab::port::{Bytes, Port};
use lab::scheme::Scheme;
use lab::values::with_receiver;
use spikewire::link::Withheld;
use std::cell::RefCell;
use std::io::{self, Write};
use std::path::PathBuf;
use std::rc::Rc;

/// Listen to a board: write the events that it sends, or with `--scheme` the values that they encode.
///
/// Formats have the names that `convert` uses. Only input in the format `link` can be decoded to values. The decoder is
/// the same receiver that runs on boards. A temporal code, whose spikes stand for changes, gives a value for each
/// event. The other codes give a value for each sample and channel, from the channel's first event on.
///
/// A value marked `exact` equals, bit for bit, the value that a decoder on the sender has. Values of a temporal code
/// are exact from a keyframe (a message with the whole value) until data is lost. Values of a rate code are exact once
/// enough samples to fill the code's filter have arrived without loss. Values of a population code are exact again from
/// the first spike after a loss.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  spikewire listen --baud 921600 /dev/ttyUSB0 -o events.csv
  spikewire listen --baud 921600 /dev/ttyUSB0 --scheme sf --thresholds 0.1,0.1,0.1,0.5,0.5,0.5
  spikewire listen captured.bytes --scheme grf --neurons 20 --min=-9 --max=9
  spikewire listen captured.bytes --flight flight.toml
  spikewire listen --baud 921600 /dev/ttyUSB0 --flight flight.toml --live
  spikewire listen captured.bytes --to es -o flight.es")]
pub(crate) struct Listen {
    /// Serial port, or a file of captured bytes; `-` reads standard input
    #[arg(default_value = "-")]
    input: PathBuf,
    /// Speed in bits a second if the input is a serial port (8 data bits, no parity, 1 stop bit)
    #[arg(long)]
    baud: Option<u32>,
    /// Stop after this many seconds; Ctrl-C stops too
    #[arg(long, requires = "baud")]
    seconds: Option<f64>,
    /// Format of the input
    #[arg(long, value_name = "FORMAT", default_value = "link")]
    from: Format,
    /// Format of the output
    #[arg(long, value_name = "FORMAT", default_value = "csv")]
    to: Format,
    /// File to write events or values to; default: standard output
    #[arg(short, long)]
    output: Option<PathBuf>,
    #[command(flatten)]
    stream: StreamOptions,
    /// Decode the link's frames with this scheme, which must be the sender's
    #[arg(long, value_parser = schemes())]
    scheme: Option<Scheme>,
    /// Sample type of the sender: f32, i16, i32, or fixed point such as q16.16 or q8.8; default: f32
    #[arg(long)]
    sample: Option<SampleType>,
    /// File of the sender's parameters (TOML), as written by `tune --emit toml`; options on the command line override
    /// it
    #[arg(long, value_name = "FILE", value_parser = crate::options::read)]
    params: Option<Coding>,
    /// Flight file (`flight.toml`) from which the sender was made, as written by `advise -o`. If the sender was made from
    /// another one, no value is exact: the reason is printed, and the exit status is 2
    #[arg(long, value_name = "FILE", conflicts_with_all = ["scheme", "sample", "params", "slot_ticks"])]
    flight: Option<PathBuf>,
    /// Length in µs of the sender's sub-timesteps. Needed if the decoded value depends on the sub-timestep in which a
    /// spike comes, otherwise not allowed
    #[arg(long, value_name = "µs", value_parser = value_parser!(u32).range(1..))]
    slot_ticks: Option<u32>,
    /// Draw values, spikes and losses in the terminal while they arrive. A recording is drawn at the pace of its clock.
    /// Values are written only if a file is given by -o
    #[arg(long)]
    live: bool,
    #[command(flatten)]
    parameters: DecoderOptions,
}

fn is_recorded(parameter: &Parameter) -> bool {
    parameter.is_recorded
}

/// The scheme parameters that a decoder needs. Parameters that only an encoder needs are not offered as options.
#[derive(Clone, Debug)]
struct DecoderOptions(Asked);

option_group!(
    DecoderOptions,
    |command| augment(command, is_recorded)
        .mut_arg("threshold", |arg| arg.visible_alias("thresholds")),
    |matches| given(matches, is_recorded)
);

/// Runs the command.
///
/// # Errors
/// Returns an error if the options are invalid, the port cannot be opened, or the output cannot be written.
pub(crate) fn run(options: &Listen) -> Result<()> {
    if let Some(path) = &options.flight {
        if !options.parameters.0.is_empty() {
            bail!("--flight says all parameters");
        }
        options.check_formats("--flight")?;
        let flight = read_flight(path)?;
        let mut listened = Ok(());
        flight::with_receiver(&flight, |values| {
            listened = listen_to(options, values, flight.sample, || Panel::of_flight(&flight));
            Ok(())
        })?;
        return listened;
    }
    let sample = options.params.as_ref().map(|params| params.sample);
    let sample = options.sample.or(sample).unwrap_or_default();
    let Some(scheme) = options.named()? else {
        if !options.parameters.0.is_empty() || options.slot_ticks.is_some() {
            bail!("a scheme's parameters need --scheme");
        }
        if options.live {
            bail!("--live draws values: it needs --flight or --scheme");
        }
        return listen(options, None, None);
    };
    let settings = options.settings(scheme, sample)?;
    let slot_ticks = options.slot_ticks(scheme, &settings)?;
    let neurons = settings.first().map(|first| scheme.shape(first)).transpose()?;
    let neurons = neurons.map_or(1, |shape| shape.neurons);
    let mut listened = Ok(());
    with_receiver(scheme, sample, &settings, slot_ticks, |values| {
        listened = listen_to(options, values, sample, || Panel::new(neurons));
        Ok(())
    })?;
    listened
}

/// Decodes the input with the decoder `values`. If `--live` is given, calls `panel` to make a panel, and draws the
/// decoded values there.
fn listen_to(
    options: &Listen,
    values: Box<dyn Values + '_>,
    sample: SampleType,
    panel: impl FnOnce() -> Panel,
) -> Result<()> {
    if !options.live {
        return listen(options, Some((values, sample)), None);
    }
    let panel = Rc::new(RefCell::new(panel()));
    let screen = Screen::new(&panel)?;
    listen(options, Some((Panel::noting(&panel, values), sample)), Some(screen))
}

fn listen(
    options: &Listen,
    values: Option<(Box<dyn Values + '_>, SampleType)>,
    mut screen: Option<Screen>,
) -> Result<()> {
    /// Number of bytes that `--live` reads from a recording before it updates the terminal.
    const PART: usize = 64;
    let mut port = Port::open(&options.input, options.baud)?;
    let stop = Stop::new(options.seconds)?;
    let is_written = screen.is_none() || options.output.is_some();
    let open = || Output::open(options.output.as_deref(), &options.input);
    let mut file = is_written.then(open).transpose()?;
    let (reader, writer): (Box<dyn EventReader + '_>, _) = match values {
        Some((values, sample)) => (Box::new(LinkReader::new(Some(values))), values_writer(sample)),
        None => (options.from.reader(port.name()), options.to.writer(options.stream.drop)?),
    };
    let mut stream = Stream::new(reader, writer, options.stream.from_zero);
    let mut live = Live::new(options.output.is_none());

    let mut nothing = io::sink();
    let output: &mut dyn Write = file.as_mut().map_or(&mut nothing, |file| file);

    let is_played = screen.is_some() && options.baud.is_none();
    let mut buffer = vec![0; if is_played { PART } else { 1 << 16 }];
    let listened = loop {
        match port.read(&mut buffer) {
            Ok(Bytes::Some(count)) => {
                let arrival = options.baud.map(|_| stop.tick());
                stream.push(&buffer[..count], arrival, output)?;
                if !port.is_file() {
                    output.flush()?;
                }
            }
            Ok(Bytes::NotYet) => {}
            Ok(Bytes::End) => break Ok(()),
            Err(error) => break Err(error),
        }
        match &mut screen {
            Some(screen) => screen.update(&stream, port.is_file(), &stop)?,
            None => live.update(&stream),
        }
        if stop.is_due() {
            break Ok(());
        }
    };
    // Bytes received before the port failed are kept.
    stream.finish(output)?;
    live.clear();
    if let Some(screen) = &mut screen {
        screen.finish(&stream)?;
    }
    eprint!("{}", words::page(&stream.spelled(option).to_string()));
    match stream.check_format(options.from, port.name()) {
        // A board on a serial port may still be silent, or the baud rate may be wrong: a warning.
        Err(error) if options.baud.is_some() => say!("{}", of_lab(&error)),
        checked => checked?,
    }
    if let Some(file) = file {
        file.finish()?;
    }
    listened?;
    check_flight(options, stream.tally().link)
}

/// Checks that the sender is not one from another flight file than `--flight`, which makes no value exact.
fn check_flight(options: &Listen, link: Option<LinkTally>) -> Result<()> {
    match (&options.flight, link.and_then(|link| link.withheld)) {
        (Some(path), Some(why @ (Withheld::Description { .. } | Withheld::Contradicted))) => {
            bail!("{}: the sender is not made from this flight file: {why}", path.display())
        }
        _ => Ok(()),
    }
}

impl Listen {
    /// Returns the scheme that `--scheme` or the file of `--params` names.
    ///
    /// # Errors
    /// Returns an error if the two name different schemes.
    fn named(&self) -> Result<Option<Scheme>> {
        let Some(params) = &self.params else { return Ok(self.scheme) };
        Ok(Some(agreed(params, self.scheme)?))
    }

    /// Returns the length of the sender's sub-timesteps in µs; `None` if the scheme has no sub-timesteps.
    ///
    /// # Errors
    /// Returns an error if `--slot-ticks` is missing for a scheme that needs it, or given for one that does not.
    fn slot_ticks(&self, scheme: Scheme, settings: &[Settings]) -> Result<Option<u32>> {
        // A temporal code decodes a spike the same way in every sub-timestep.
        let has_slots = !scheme.info().has_first_value()
            && settings
                .first()
                .map(|settings| scheme.shape(settings))
                .transpose()?
                .is_some_and(|shape| shape.slots > 1);
        match self.slot_ticks {
            None if has_slots => {
                bail!(
                    "{} needs --slot-ticks, the length of the sender's sub-timesteps in µs",
                    scheme.name()
                )
            }
            Some(_) if !has_slots => {
                bail!("{} has no sub-timesteps: it takes no --slot-ticks", scheme.name())
            }
            length => Ok(length),
        }
    }

    /// Checks that the input format is `link`, which can carry values, and that the output format is `csv`, which can
    /// express them. `option` is named in the error messages.
    fn check_formats(&self, option: &str) -> Result<()> {
        if !matches!(self.from, Format::Link(_)) {
            bail!(
                "{option} needs --from link, whose frames say what was lost and where keyframes are"
            );
        }
        if self.to != Format::Csv {
            bail!("{option} gives values, which only --to csv holds");
        }
        Ok(())
    }

    /// Returns the decoder's settings: one item that all channels share, or one item for each channel.
    fn settings(&self, scheme: Scheme, sample: SampleType) -> Result<Vec<Settings>> {
        self.check_formats("--scheme")?;
        let mut asked = match &self.params {
            Some(params) => self.parameters.0.or(&params.asked),
            None => self.parameters.0.clone(),
        };
        // A decoder ignores the encoder's own parameters: any valid value will do.
        for parameter in scheme.info().parameters.iter().filter(|parameter| parameter.is_of_encoder)
        {
            if asked.get(parameter.name).is_none() {
                asked.set(parameter.name, parameter.read(parameter.example)?);
            }
        }
        if let Some(missing) = scheme.needs_signal(&asked) {
            let missing = missing.spelled(option);
            bail!("{} needs {missing}, as the sender has it", scheme.name());
        }
        let known = Known { calibrated: None, first: &[0.0], can_calibrate: false };
        let channels = asked.channels(scheme.info())?.unwrap_or(1);
        let mut all = Vec::new();
        for channel in 0..channels {
            let asked = asked.channel(scheme.info(), channel, channels)?;
            let settings = scheme.resolve(sample, &asked, &known)?;
            if let Some(rounding) = rounding(&settings) {
                say!("{rounding}");
            }
            all.push(settings);
        }
        Ok(all)
    }
}
