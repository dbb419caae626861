//! `spikewire network`: a trained network onto a chip or the flight controller, and what that costs.

use super::network_rule::RuleOptions;
use crate::inputs::InputOptions;
use crate::options::{SchemeOptions, schemes, tell_each};
use anyhow::{Context, Result, ensure};
use catalogue::run::{Calibrated, Known, SampleType, Settings};
use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use indicatif::{ProgressBar, ProgressStyle};
use lab::bank::Bank;
use lab::fit::rounding;
use lab::input::{InputOptions as Input, above_zero};
use lab::network::{
    Brought, CHIPS, Chip, ControllerRequest, Figures, File, Model, OnChip, Request, Stepped, Told,
    Trained, Trains, WINDOW, bring, bring_to_controller,
};
use lab::output::Output;
use lab::scheme::Scheme;
use lab::trial::Recording;
use spikewire::Polarity;
use std::fmt::Write as _;
use std::fs;
use std::io::{self, BufRead, Write, stdin};
use std::path::{Path, PathBuf};

/// Bring a trained network onto a chip or the flight controller itself: Rust constants for `spikewire-chips` or
/// `spikewire-network`, and what that costs.
///
/// A recording's spikes run through the network in double precision and, with the chip's weights and arithmetic, through
/// its model, clock by clock; or as the controller computes it, bit by bit. NETWORK is a NIR graph (an HDF5 file of
/// snnTorch, Norse, Rockpool, Sinabs, Lava and others) that is a chain of up to three layers, each Linear or Affine and
/// LIF, IF or `CubaLIF` (whose currents last a step), which may lead back to itself, and on `ReckOn` Linear and LI, I or
/// `CubaLI` as outputs; or JSON: {"layers": [{"name": ..., "weights": [[...]], "recurrent": [[...]], "bias": [...],
/// "keep": 0.9, "threshold": 1.0}], "readout": {"name": ..., "weights": [[...]], "keep": 0.95}}, with weights by neuron and
/// then input, and the share of the potential that a step leaves.
///
/// The controller takes any number of layers, `CubaLIF` with currents of any length, and weights behind the last neurons.
/// A NIR file does not say by which rule its neurons step: --as does, and the options behind it.
#[derive(Args, Debug)]
#[command(after_help = "\
Example:
  spikewire network trained.nir --scheme position --neurons 20 --column gyro_x flight.csv -o src/network.rs
  spikewire network trained.nir --on controller --as snntorch --reset subtract-late spikes.txt -o src/network.rs")]
pub(crate) struct Network {
    /// NIR graph, or network in JSON
    #[arg(value_name = "NETWORK")]
    trained: PathBuf,
    /// The chip, or `controller`
    #[arg(long = "on", visible_alias = "chip", default_value = CHIPS[0].name(), value_parser = places())]
    place: &'static str,
    /// The scheme that makes the inputs: one for each neuron of each column, of codes with a direction two, up and
    /// down. Without it INPUT holds the spikes themselves: a line for each step, with the numbers of the inputs that fire,
    /// in order
    #[arg(long, value_parser = schemes())]
    scheme: Option<Scheme>,
    /// Sample type: f32, i16, i32, or fixed point such as q16.16 or q8.8
    #[arg(long, default_value_t)]
    sample: SampleType,
    /// Seconds of a step in the network's time constants, such as 1e-4 of snnTorch; a sample or sub-timestep of the
    /// recording unless given, but for the controller
    #[arg(long, value_name = "SECONDS", value_parser = above_zero)]
    dt: Option<f64>,
    #[command(flatten)]
    input: InputOptions,
    #[command(flatten)]
    parameters: SchemeOptions,
    #[command(flatten)]
    rule: RuleOptions,
    /// Another recording, which shows what the network is worth where it was not tuned
    #[arg(long, value_name = "INPUT")]
    held_out: Option<PathBuf>,
    /// File of Rust; standard output unless given
    #[arg(short, long)]
    output: Option<PathBuf>,
    /// File of the network as bytes, which the driver loads at run time
    #[arg(long, value_name = "FILE")]
    bytes: Option<PathBuf>,
    /// Then run the network on the chip's model, step by step: each line of standard input is one, as those of spikes
    /// are, and is answered by a line of the chip's clocks and the outputs that fire. The constant is not written
    /// unless -o is given
    #[arg(long)]
    live: bool,
}

/// The flight controller's name beside those of the chips.
const CONTROLLER: &str = "controller";

/// The names of the places where networks go.
fn places() -> impl TypedValueParser<Value = &'static str> {
    let names = || CHIPS.iter().map(|chip: &&dyn Chip| chip.name()).chain([CONTROLLER]);
    PossibleValuesParser::new(names())
        .map(move |asked| names().find(|name| *name == asked).unwrap_or_default())
}

/// A network with the numbers of its place.
enum Placed {
    Chip(&'static dyn Chip, Trained),
    Controller(Model),
}

impl Placed {
    fn read(options: &Network, seconds: Option<f64>) -> Result<Self> {
        let Network { trained: path, place, dt, rule, .. } = options;
        let file = File::read(path)?;
        if *place == CONTROLLER {
            return Ok(Self::Controller(file.on_controller(&rule.asked(*dt))?));
        }
        ensure!(
            !rule.is_told(),
            "the chips have rules and numbers of their own: --on controller takes others"
        );
        let chip = CHIPS.iter().find(|chip| chip.name() == *place).context("no such chip")?;
        Ok(Self::Chip(*chip, file.in_steps(dt.or(seconds))?))
    }

    /// How many inputs it has, and the name of its first layer.
    fn inputs(&self) -> (usize, &str) {
        match self {
            Self::Chip(_, trained) => (trained.inputs(), &trained.layers[0].name),
            Self::Controller(model) => (model.inputs(), model.first()),
        }
    }
}

/// Runs the command.
///
/// # Errors
/// The network, the recording, the parameters or the output are not good, or the network does not fit the chip.
pub(crate) fn run(options: &Network) -> Result<()> {
    let Network { trained: path, output, .. } = options;
    let input = &options.input.to_lab();
    ensure!(
        !input.is_stdin(),
        "the recording calibrates scheme and chip, and is read as a whole: give a file"
    );
    let driven = match options.scheme {
        Some(scheme) => driven(options, scheme, input, None)?,
        None => spiking(&input.input)?,
    };
    let seconds = driven.step_us.map(|step| step * 1e-6);
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let placed = Placed::read(options, seconds).map_err(|error| error.context(name.clone()))?;
    driven.check(placed.inputs(), options.scheme).with_context(|| name.clone())?;
    let held_out = options.held_out.as_ref().map(|path| {
        let input = Input { input: path.clone(), ..input.clone() };
        match options.scheme {
            Some(scheme) => self::driven(options, scheme, &input, Some(&driven.settings)),
            None => spiking(path),
        }
    });
    let held_out = held_out.transpose()?;
    if let Some(held_out) = &held_out {
        held_out.check(placed.inputs(), options.scheme).with_context(|| name.clone())?;
    }

    let bar = ProgressBar::new(0).with_style(ProgressStyle::with_template(
        "{bar:40} {percent:>3} %  {human_pos} of {human_len} neurons",
    )?);
    let progress = |done: usize, total: usize| {
        bar.set_length(total as u64);
        bar.set_position(done as u64);
    };
    let (tuned, held_out) = (&driven.steps, held_out.as_ref().map(|held_out| &held_out.steps));
    let (progress, numbers) = (&progress, options.rule.numbers);
    let brought = match &placed {
        Placed::Chip(chip, trained) => {
            bring(&Request { chip: *chip, trained, tuned, held_out, progress })
        }
        Placed::Controller(model) => {
            bring_to_controller(&ControllerRequest { model, numbers, tuned, held_out, progress })
        }
    };
    bar.finish_and_clear();
    let brought = brought.map_err(|error| error.context(name.clone()))?;

    let told = Told { source: name, inputs: driven.words, step_us: driven.step_us };
    if output.is_some() || !options.live {
        let mut output = Output::open(output.as_deref(), &input.input)?;
        output.write_all(brought.network.emit(&told).as_bytes())?;
        output.finish()?;
    }
    if let Some(path) = &options.bytes {
        let mut output = Output::open(Some(path), &input.input)?;
        output.write_all(&brought.network.bytes()?)?;
        output.finish()?;
    }
    tell_each(&driven.notes);
    report(&brought);
    if options.live { live(&*brought.network, placed.inputs().0) } else { Ok(()) }
}

/// Steps in by standard input, answers out.
fn live(network: &dyn OnChip, inputs: usize) -> Result<()> {
    let (mut answers, mut line) = (Output::to(None)?, String::new());
    let step = |line: io::Result<String>| {
        let step = spikes(&line?)?;
        let is_known = step.iter().all(|input| usize::from(*input) < inputs);
        ensure!(is_known, "the network has {inputs} inputs, and not those of {step:?}");
        Ok(step)
    };
    let mut steps = stdin().lock().lines().map(step);
    network.follow(&mut steps, &mut |Stepped { fired, clocks }| {
        line.clear();
        write!(line, "{clocks}")?;
        fired.last().into_iter().flatten().try_for_each(|output| write!(line, " {output}"))?;
        line.push('\n');
        answers.write_all(line.as_bytes())?;
        Ok(answers.flush()?)
    })?;
    Ok(())
}

/// A line of spikes.
fn spikes(line: &str) -> Result<Vec<u16>> {
    let of_word = |word: &str| {
        word.parse().with_context(|| format!("`{word}` is not the number of an input"))
    };
    line.split_whitespace().map(of_word).collect()
}

/// The input of the network.
struct Driven {
    /// The input spikes, by step.
    steps: Trains,
    /// How many there are; of spikes as they are the highest is known.
    inputs: usize,
    /// What the inputs are.
    words: String,
    /// How long a step is, if that is known.
    step_us: Option<f64>,
    /// The settings of the columns.
    settings: Vec<Settings>,
    notes: Vec<String>,
}

impl Driven {
    /// Returns an error unless these are the network's inputs.
    fn check(&self, (inputs, layer): (usize, &str), scheme: Option<Scheme>) -> Result<()> {
        let given = &self.words;
        match scheme {
            Some(scheme) => ensure!(
                inputs == self.inputs,
                "{layer} has {inputs} inputs, but {} gives {given}",
                scheme.name()
            ),
            None => ensure!(self.inputs <= inputs, "{layer} has {inputs} inputs, but {given}"),
        }
        Ok(())
    }
}

/// The recording as spikes, with these settings or those that it calibrates.
fn driven(
    options: &Network,
    scheme: Scheme,
    input: &Input,
    known: Option<&[Settings]>,
) -> Result<Driven> {
    let Network { sample, parameters: SchemeOptions(parameters), .. } = options;
    parameters.check(scheme.info())?;
    let recordings = Recording::read_all(input)?;
    let first = recordings.first().context("there is no channel")?;
    let (samples, rate) = (first.values.len(), first.rate);
    let mut notes: Vec<String> = first.notes().lines().map(str::to_owned).collect();
    let columns: Vec<Vec<f64>> = recordings.into_iter().map(|own| own.values).collect();

    let mut settings = known.unwrap_or_default().to_vec();
    for (channel, column) in columns.iter().enumerate().skip(settings.len()) {
        let mut calibrated = Calibrated::new(*sample);
        calibrated.observe(column);
        let known = Known { calibrated: Some(&calibrated), first: column, can_calibrate: true };
        let asked = parameters.channel(scheme.info(), channel, columns.len())?;
        let own = scheme.resolve(*sample, &asked, &known)?;
        notes.extend(rounding(&own));
        settings.push(own);
    }
    ensure!(
        columns.len() == settings.len(),
        "{}: {} columns, where the network is tuned on {}",
        input.name(),
        columns.len(),
        settings.len()
    );
    let mut bank = Bank::new(scheme, &settings)?;
    let mut events = Vec::new();
    bank.encode(&columns, &mut events);
    bank.finish(&mut events);

    let shape = scheme.shape(&settings[0])?;
    let is_signed = scheme.info().is_signed;
    let directions = if is_signed { 2 } else { 1 };
    let mut steps = vec![Vec::new(); samples * shape.slots];
    for event in events {
        let step = event.sample as usize * shape.slots + usize::from(event.slot);
        let falls = u16::from(is_signed && event.polarity == Polarity::Down);
        if let Some(step) = steps.get_mut(step) {
            step.push(event.neuron * directions + falls);
        }
    }
    let inputs = columns.len() * shape.neurons * usize::from(directions);
    let columns =
        if columns.len() == 1 { "1 column" } else { &format!("{} columns", columns.len()) };
    let neurons = shape.neurons;
    let of = if neurons == 1 { String::new() } else { format!("{neurons} neurons of ") };
    let each = if is_signed { ", each up and down" } else { "" };
    Ok(Driven {
        steps,
        inputs,
        words: format!("{inputs}, of {of}{columns}{each}"),
        settings,
        step_us: rate.map(|rate| 1e6 / rate / shape.slots as f64),
        notes,
    })
}

/// Spikes as they are.
fn spiking(path: &Path) -> Result<Driven> {
    let name = || path.display().to_string();
    let text = fs::read_to_string(path).with_context(|| format!("{}: cannot be read", name()))?;
    let step = |(at, line)| spikes(line).with_context(|| format!("{}: line {at}", name()));
    let steps: Trains = (1..).zip(text.lines()).map(step).collect::<Result<_>>()?;
    ensure!(!steps.is_empty(), "{}: no steps", name());
    let highest = steps.iter().flatten().max().copied().unwrap_or(0);
    Ok(Driven {
        steps,
        inputs: usize::from(highest) + 1,
        words: format!("spikes as they are, of input {highest} at most"),
        step_us: None,
        settings: Vec::new(),
        notes: Vec::new(),
    })
}

/// The share of agreeing steps below which a warning says so.
const LOW: f64 = 0.5;

/// Prints the cost of quantising on standard error.
fn report(brought: &Brought) {
    let Brought { network, tuned, held_out } = brought;
    network.notes().iter().for_each(|note| eprintln!("{note}"));
    eprintln!("layer: neurons, weights clipped; spikes, on the chip, distance");
    tell(tuned, &**network);
    match held_out {
        Some(held_out) => {
            eprintln!("the recording that was held out:");
            tell(held_out, &**network);
        }
        None => eprintln!(
            "the figures are those of the recording that the network is tuned on: --held-out shows another"
        ),
    }
}

fn tell(figures: &Figures, network: &dyn OnChip) {
    for layer in &figures.layers {
        eprintln!(
            "{}: {}, {}; {}, {}, {:.1}",
            layer.name, layer.neurons, layer.clipped, layer.spikes, layer.on_chip, layer.distance
        );
    }
    if let Some(outputs) = &figures.potentials {
        eprintln!(
            "{}: {} outputs, {} weights clipped; potentials of {:.4}, on the chip {:.4} off (root mean squares)",
            outputs.name, outputs.outputs, outputs.clipped, outputs.size, outputs.error
        );
    }
    let &Figures { steps, agreeing, active, windows, windows_agreeing, .. } = figures;
    if let Some(agreement) = figures.agreement() {
        eprintln!(
            "outputs agree in {:.1} % of {steps} steps, in {:.1} % of the {active} in which any {}",
            100.0 * agreeing as f64 / steps as f64,
            100.0 * agreement,
            if figures.potentials.is_some() { "has a potential" } else { "fires" }
        );
        eprintln!(
            "the output that {} is the same in {:.1} % of {windows} times {WINDOW} steps",
            if figures.potentials.is_some() { "is highest most often" } else { "fires most" },
            100.0 * windows_agreeing as f64 / windows as f64
        );
        if agreement < LOW {
            eprintln!(
                "warning: step by step the chip is another network than the trained one; compare the spikes of each \
                 layer, and train with what costs most: {}",
                network.dearest()
            );
        }
    } else if figures.potentials.is_none() {
        eprintln!(
            "warning: no output fires, neither in double precision nor on the chip: there is nothing to compare"
        );
    }
    eprintln!("{}", network.effort(figures.mean_clocks, figures.most_clocks));
    if figures.lost > 0 {
        eprintln!("warning: {} spikes were lost: {}", figures.lost, network.loss());
    }
}
