//! `spikewire network`: converts a trained network for a chip or the flight controller, and reports how much accuracy
//! the conversion costs.

use super::network_rule::RuleOptions;
use crate::inputs::InputOptions;
use crate::options::{SchemeOptions, check_ending, schemes};
use crate::report::{Counts, Log, Report, is_stdout};
use crate::words;
use anyhow::{Context, Result, ensure};
use catalogue::run::{Calibrated, Known, SampleType, Settings, Words};
use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use indicatif::{ProgressBar, ProgressStyle};
use lab::bank::Bank;
use lab::fit::{Fit, rounding};
use lab::input::{InputOptions as Input, above_zero};
use lab::network::{
    Brought, CHIPS, Chip, Compare, ControllerRequest, Cost, Figures, File, HeldOut, Model,
    NetworkKind, Numbers, OnChip, Outputs, Remarks, Request, Stepped, Trained, Trains, WINDOW,
    bring, bring_to_controller,
};
use lab::output::Output;
use lab::scheme::Scheme;
use lab::trial::Recording;
use serde::Serialize;
use spikewire::Polarity;
use std::fmt::Write as _;
use std::fs;
use std::io::{self, BufRead, Write, stdin};
use std::path::{Path, PathBuf};

/// Convert a trained network for a chip, or for the flight controller itself: writes Rust constants for
/// `spikewire-chips` or `spikewire-network`, and reports how much accuracy the conversion costs.
///
/// The spikes of a recording run through the network twice: in double precision, and in the target's arithmetic. A chip
/// is simulated clock cycle by clock cycle; the controller's arithmetic is reproduced bit by bit.
///
/// NETWORK is a NIR graph, JSON, or TOML. A NIR graph is an HDF5 file, as snnTorch, Norse, Rockpool, Sinabs, Lava and others
/// write it. For a chip, the graph must be a chain of up to three layers. Each layer consists of Linear or Affine
/// weights, followed by LIF, IF or `CubaLIF` neurons. The current of a `CubaLIF` neuron must not last longer than one
/// step. A layer may be recurrent. On the chip `ReckOn`, the outputs may be a last layer of Linear weights, followed by
/// neurons of the types LI, I or `CubaLI`, which never fire.
///
/// JSON is {"layers": [{"name": ..., "weights": [[...]], "recurrent": [[...]], "bias": [...], "keep": 0.9, "threshold":
/// 1.0}], "readout": {"name": ..., "weights": [[...]], "keep": 0.95}}. Its weights are listed by neuron, then by input;
/// `keep` is the factor by which a neuron's potential decays in a step. "integers": true says that the network was
/// trained in a chip's integers. `ReckOn` then takes the numbers of its layers as they are, unless a layer needs gates:
/// one with `keep` below 0.875 that is recurrent or subtracts. It takes the readout's weights unscaled, too, if it has
/// the readout's leak. Leaks round potentials down, which changes small ones most: 0.95 of 2 is 1.
///
/// TOML, in a file whose name ends in `.toml`, holds all numbers of the controller's form, and the order in which its
/// neurons decay, fire and reset. The Python package writes it.
///
/// The controller takes any number of layers, `CubaLIF` neurons with currents of any length, and a last layer of
/// weights without neurons. A NIR file does not contain the order in which neurons decay, fire and reset. Outputs that
/// the training framework recorded show it (`--trained-spikes`, `--trained-potentials`). Without them, the option `--as`
/// sets this order by the name of the training framework, and the options `--reset`, `--fires`, `--decay` and `--current`
/// set parts of it. A wrong choice then changes the spikes, and the report cannot show it.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  spikewire network trained.nir --scheme position --neurons 20 --channels gyro_x flight.csv -o src/network.rs
  spikewire network trained.nir --on controller --as snntorch --reset subtract-late spikes.txt -o src/network.rs
  spikewire network trained.nir --on controller --trained-spikes outputs.txt spikes.txt -o src/network.rs")]
pub(crate) struct Network {
    /// Network: a NIR graph, JSON, or TOML
    #[arg(value_name = "NETWORK")]
    trained: PathBuf,
    /// Target: the name of a chip, or `controller` for the flight controller
    #[arg(long = "on", visible_alias = "chip", default_value = CHIPS[0].name(), value_parser = targets())]
    target: &'static str,
    /// Scheme that encodes the columns of INPUT as the network's inputs. Each neuron of each column is one input, or
    /// two (up, then down) if the code has polarities. Without --scheme, INPUT holds spikes: one line for each step,
    /// with the numbers of the inputs that fire, separated by blanks
    #[arg(long, value_parser = schemes())]
    scheme: Option<Scheme>,
    /// Sample type: f32, i16, i32, or fixed point such as q16.16 or q8.8
    #[arg(long, default_value_t)]
    sample: SampleType,
    /// Length of a step in seconds, such as 1e-4 for snnTorch. The network's time constants are converted for steps of
    /// this length; default for a chip: one sample or sub-timestep of the recording
    #[arg(long, value_name = "SECONDS", value_parser = above_zero)]
    dt: Option<f64>,
    #[command(flatten)]
    input: InputOptions,
    #[command(flatten)]
    parameters: SchemeOptions,
    #[command(flatten)]
    rule: RuleOptions,
    /// Second recording, to test the network on, so that the whole of INPUT can serve to tune the network. Default for
    /// a chip: the network is tuned on the first two thirds of INPUT, and tested on the last third
    #[arg(long, value_name = "INPUT")]
    held_out: Option<PathBuf>,
    /// Tune on the whole of INPUT, without a test on held-out data
    #[arg(long, conflicts_with = "held_out")]
    no_held_out: bool,
    /// File of the output spikes that the network had in the training framework, one line for each step of INPUT. They
    /// show by which rule the neurons of a NIR file step, so that --as, --reset and the like can be left out; a rule that
    /// gives other spikes is refused. The report compares these spikes with the target's and, unless the network was
    /// trained in a chip's integers, with those of the network in double precision
    #[arg(long, value_name = "FILE", conflicts_with = "held_out")]
    trained_spikes: Option<PathBuf>,
    /// The same for a network whose outputs never fire: file of the potentials that the outputs had in the training
    /// framework, one line for each step of INPUT, with a number for each output
    #[arg(long, value_name = "FILE", conflicts_with_all = ["held_out", "trained_spikes"])]
    trained_potentials: Option<PathBuf>,
    /// Point at which tinyODIN's neurons compare their potentials with their thresholds. `spike`: after each arriving
    /// spike, as the chip does by itself. `step`: once in each time step, as in training; the driver then sends extra
    /// events to the chip in each step. Default: the choice that keeps more accuracy
    #[arg(long, value_parser = compares())]
    compare: Option<Compare>,
    /// Rust file to write; default: standard output
    #[arg(short, long)]
    output: Option<PathBuf>,
    /// Also write the network as a binary file, which the firmware's driver of the chip loads at run time
    #[arg(long, value_name = "FILE")]
    bytes: Option<PathBuf>,
    /// After the conversion, run the network on the chip's model, step by step. Each line of standard input is a step:
    /// the numbers of the inputs that fire. Each line of output answers a step: how many clock cycles the chip took,
    /// and the numbers of the outputs that fired. The Rust file is not written unless -o is given
    #[arg(long)]
    live: bool,
    /// Print the comparisons as JSON; needs -o
    #[arg(long, requires = "output", conflicts_with = "live")]
    json: bool,
}

impl Network {
    /// Returns the path of the outputs that the training framework computed, for error messages.
    fn recorded(&self) -> String {
        let path = self.trained_spikes.as_ref().or(self.trained_potentials.as_ref());
        path.map(|path| path.display().to_string()).unwrap_or_default()
    }
}

/// The comparisons of a network on a recording.
#[derive(Serialize)]
struct Content<'a> {
    tuned: &'a Figures,
    held_out: Option<&'a Figures>,
    /// Share of active steps in which the outputs fire as in the training framework.
    reading: Option<f64>,
    /// Root mean square of the difference between the outputs' potentials in double precision and in the training
    /// framework, divided by that of the framework's.
    reading_error: Option<f64>,
    costs: Vec<CostLeft>,
}

/// A part of the chip's arithmetic, and the share of active steps that it alone leaves as they were.
#[derive(Serialize)]
struct CostLeft {
    #[serde(flatten)]
    cost: Cost,
    left: f64,
}

/// Name by which `--on` selects the flight controller rather than a chip.
const CONTROLLER: &str = "controller";

/// Returns the parser of `--on`, which accepts the name of a chip or [`CONTROLLER`].
fn targets() -> impl TypedValueParser<Value = &'static str> {
    let names = || CHIPS.iter().map(|chip: &&dyn Chip| chip.name()).chain([CONTROLLER]);
    PossibleValuesParser::new(names())
        .map(move |asked| names().find(|name| *name == asked).unwrap_or_default())
}

fn compares() -> impl TypedValueParser<Value = Compare> {
    PossibleValuesParser::new(["spike", "step"])
        .map(|asked| if asked == "spike" { Compare::Spike } else { Compare::Step })
}

/// A trained network in the form for its target: a chip, or the flight controller.
enum Converted {
    Chip(&'static dyn Chip, Trained),
    Controller(Model),
}

impl Converted {
    /// Converts the network of a file. If `outputs` of the training framework are given, they show by which rule its neurons
    /// step, and the rule is reported on standard error.
    fn from_file(
        file: File,
        options: &Network,
        driven: &Driven,
        outputs: Option<&Outputs>,
    ) -> Result<Self> {
        let Network { target, dt, rule, .. } = options;
        let seconds = driven.step_us.map(|step| step * 1e-6);
        let mut asked = rule.asked(*dt);
        if let Some(outputs) = outputs {
            let found = file.find_rule(&asked, &driven.steps, outputs);
            if let Some(found) = found.map_err(|error| error.at(options.recorded()))? {
                let (rule, steps) = (found.settings(words::option), driven.steps.len());
                say!("rule found: {rule} gives the recorded outputs in all {steps} steps");
                asked = found.asked;
            }
        } else if matches!(file, File::Nir(_)) {
            say!(
                "the rule is as the options say: a wrong one gives other spikes, which --trained-spikes or \
                 --trained-potentials would show"
            );
        }
        if *target == CONTROLLER {
            return Ok(Self::Controller(file.on_controller(&asked)?));
        }
        ensure!(
            rule.numbers == Numbers::Float,
            "the chips have numbers of their own: --on controller takes others"
        );
        let chip = CHIPS.iter().find(|chip| chip.name() == *target).context("no such chip")?;
        Ok(Self::Chip(*chip, file.on_chip(&asked, seconds)?))
    }

    /// Returns the network's number of inputs, and the name of its first layer.
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
/// Returns an error if the network, the recording or the parameters are invalid, if the network does not fit the chip,
/// or if the output cannot be written.
pub(crate) fn run(options: &Network) -> Result<()> {
    let Network { trained: path, output, .. } = options;
    check_ending(output.as_deref(), "rs", "Rust")?;
    is_stdout(output.as_deref(), options.json)?;
    let input = &options.input.to_lab()?;
    ensure!(
        !input.is_stdin(),
        "the recording calibrates scheme and chip, and is read as a whole: give a file"
    );
    let driven = match options.scheme {
        Some(scheme) => driven(options, scheme, input, None)?,
        None => spiking(&input.input)?,
    };
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let framework = framework(options)?;
    let framework = framework.as_ref();
    let file = File::read(path)?;
    let converted =
        Converted::from_file(file, options, &driven, framework).with_context(|| name.clone())?;
    driven.check(converted.inputs(), options.scheme).with_context(|| name.clone())?;
    let held_out = options.held_out.as_ref().map(|path| {
        let input = Input { input: path.clone(), ..input.clone() };
        match options.scheme {
            Some(scheme) => self::driven(options, scheme, &input, Some(&driven.settings)),
            None => spiking(path),
        }
    });
    let held_out = held_out.transpose()?;
    if let Some(held_out) = &held_out {
        held_out.check(converted.inputs(), options.scheme).with_context(|| name.clone())?;
    }

    // Without a second recording, the last third of the first is held out.
    let steps = driven.steps.len();
    // Nothing is tuned for the controller, whose arithmetic is exact or nearly so.
    let on_controller = matches!(converted, Converted::Controller(_));
    let holds_out = held_out.is_none() && !options.no_held_out && !on_controller;
    let part = if holds_out { steps - steps / 3 } else { steps };
    let tuned = driven.steps[..part].to_vec();
    let held_out = match &held_out {
        Some(other) => Some(HeldOut { steps: &other.steps, from: 0 }),
        None => (part < steps).then_some(HeldOut { steps: &driven.steps, from: part }),
    };

    let bar = ProgressBar::new(0).with_style(ProgressStyle::with_template(
        "{bar:40} {percent:>3} %  {human_pos} of {human_len}",
    )?);
    let progress = |done: usize, total: usize| {
        bar.set_length(total as u64);
        bar.set_position(done as u64);
    };
    let (tuned, compare) = (&tuned, options.compare);
    let (progress, numbers) = (&progress, options.rule.numbers);
    let brought = match &converted {
        Converted::Chip(chip, trained) => {
            let chip = *chip;
            bring(&Request { chip, trained, tuned, held_out, framework, compare, progress })
        }
        Converted::Controller(model) => {
            let framework = framework.filter(|_| held_out.is_none());
            let request =
                ControllerRequest { model, numbers, tuned, held_out, framework, progress };
            bring_to_controller(&request)
        }
    };
    bar.finish_and_clear();
    let brought = brought.map_err(|error| error.at(&name))?;

    let remarks = Remarks { source: name, inputs: driven.words, step_us: driven.step_us };
    if output.is_some() || !options.live {
        let mut output = Output::open(output.as_deref(), &input.input)?;
        output.write_all(brought.network.emit(&remarks).as_bytes())?;
        output.finish()?;
    }
    if let Some(path) = &options.bytes {
        let mut output = Output::open(Some(path), &input.input)?;
        output.write_all(&brought.network.bytes()?)?;
        output.finish()?;
    }
    if options.json {
        let Brought { network, tuned, held_out, costs, reading, reading_error } = &brought;
        let content = Content {
            tuned,
            held_out: held_out.as_ref(),
            reading: *reading,
            reading_error: *reading_error,
            costs: costs.iter().map(|&(cost, left)| CostLeft { cost, left }).collect(),
        };
        let log = Log {
            log: input.input.display().to_string(),
            refused: None,
            notes: words::notes(&driven.notes).into_iter().chain(network.notes()).collect(),
            content: Some(content),
        };
        let logs = [log];
        return Report { command: "network", logs: &logs, summary: Counts::of(&logs) }.print();
    }
    words::tell(&driven.notes);
    report(&brought);
    if options.live { live(&*brought.network, converted.inputs().0) } else { Ok(()) }
}

/// Simulates the network step by step, for `--live`. Each line of standard input is a step: the numbers of the inputs
/// that fire. Each line of output answers a step: how many clock cycles the chip took, and the numbers of the outputs
/// that fired.
fn live(network: &dyn OnChip, inputs: usize) -> Result<()> {
    let (mut answers, mut line) = (Output::to(None)?, String::new());
    let step = |line: io::Result<String>| -> lab::Result<_> {
        let step = spikes(&line?)?;
        let is_known = step.iter().all(|input| usize::from(*input) < inputs);
        if is_known { Ok(step) } else { Err(NetworkKind::NoInputs { inputs, step }.into()) }
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

/// Parses the numbers of the inputs that fire in a step, separated by blanks.
fn spikes(line: &str) -> lab::Result<Vec<u16>> {
    let of_word = |word: &str| {
        word.parse().map_err(|_| NetworkKind::NotAnInput { word: word.to_owned() }.into())
    };
    line.split_whitespace().map(of_word).collect()
}

/// Input spikes for the network, from an encoded recording or from a file of spikes.
struct Driven {
    /// The numbers of the inputs that fire in each step.
    steps: Trains,
    /// Number of inputs that the network must have. If the spikes come from a file, this is the minimum: the highest
    /// number of an input that fires, plus one.
    inputs: usize,
    /// Description of the inputs, for error messages.
    words: String,
    /// Length of a step in µs, if it is known.
    step_us: Option<f64>,
    /// Settings of the encoding scheme, with an item for each column. Empty if the spikes come from a file.
    settings: Vec<Settings>,
    notes: Vec<Words>,
}

impl Driven {
    /// Checks that the network's number of inputs suits these spikes. With a `scheme`, the two numbers of inputs must
    /// be equal. Without a scheme, the spikes come from a file, and the network may have more inputs. `inputs` is the
    /// network's number of inputs, and `layer` is the name of its first layer, for the error message.
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

/// Encodes the columns of a recording as input spikes. The scheme runs with the settings `known`; if `known` is `None`,
/// the scheme is calibrated on the recording.
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
    let (samples, rate) = (first.values.len(), first.steady_rate()?);
    let mut notes = first.notes();
    let columns: Vec<Vec<f64>> = recordings.into_iter().map(|recording| recording.values).collect();

    let mut settings = known.unwrap_or_default().to_vec();
    for (channel, column) in columns.iter().enumerate().skip(settings.len()) {
        let mut calibrated = Calibrated::new(*sample);
        calibrated.observe(column);
        let known = Known { calibrated: Some(&calibrated), first: column, can_calibrate: true };
        let asked = parameters.channel(scheme.info(), channel, columns.len())?;
        let resolved = scheme.resolve(*sample, &asked, &known)?;
        notes.extend(rounding(&resolved).map(Words::from));
        settings.push(resolved);
    }
    ensure!(
        columns.len() == settings.len(),
        "{}: {} columns, where the network is tuned on {}",
        input.name(),
        columns.len(),
        settings.len()
    );
    for (column, settings) in columns.iter().zip(&settings) {
        let mut fit = Fit::new(scheme, settings);
        fit.observe(column);
        // A code without a spike shows in the network's own figures.
        let spikes = 1;
        notes.extend(fit.notes(settings, spikes).lines().map(|note| Words::from(note.to_owned())));
    }
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

/// Reads a file of input spikes: one line for each step, with the numbers of the inputs that fire.
fn spiking(path: &Path) -> Result<Driven> {
    let steps: Trains = steps(path, |line| Ok(spikes(line)?))?;
    ensure!(!steps.is_empty(), "{}: no steps", path.display());
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

/// Reads the outputs that the training framework computed, if a file of them is given.
fn framework(options: &Network) -> Result<Option<Outputs>> {
    match (&options.trained_spikes, &options.trained_potentials) {
        (Some(path), _) => Ok(Some(Outputs::Spikes(spiking(path)?.steps))),
        (_, Some(path)) => Ok(Some(Outputs::Potentials(potentials(path)?))),
        _ => Ok(None),
    }
}

/// Reads a file of the outputs' potentials: one line for each step, with a number for each output.
fn potentials(path: &Path) -> Result<Vec<Vec<f64>>> {
    let number = |word: &str| {
        let number = word.parse().ok().filter(|number: &f64| number.is_finite());
        number.with_context(|| format!("`{word}` is not a finite number"))
    };
    steps(path, |line| line.split_whitespace().map(number).collect())
}

/// Reads a file with a line for each step.
fn steps<T>(path: &Path, read: impl Fn(&str) -> Result<T>) -> Result<Vec<T>> {
    let name = || path.display().to_string();
    let text = fs::read_to_string(path).with_context(|| format!("{}: cannot be read", name()))?;
    let step = |(at, line)| read(line).with_context(|| format!("{}: line {at}", name()));
    (1..).zip(text.lines()).map(step).collect()
}

/// Least agreement between chip and trained network for which the report does not warn. The agreement of two runs is
/// the share of active steps in which the same outputs fire in both. A step is active if an output fires in either run.
const LOW: f64 = 0.5;
/// Least agreement between the network in double precision and the training framework. If the agreement is lower, the
/// report suggests that `--as`, `--reset` or `--dt` are wrong.
const READ: f64 = 0.95;
/// Largest difference between the outputs' potentials in double precision and in the training framework, relative to
/// the framework's, both as root mean squares. If it is larger, the report suggests the same as below [`READ`].
/// Recorded networks that `ReckOn` takes are 0.000 off by their own rule, and 0.023 or more by those of other frameworks.
const READ_ERROR: f64 = 0.02;

/// Prints on standard error how the converted network differs from the trained one: first for the recording that the
/// conversion was tuned on, then for the held-out recording.
fn report(brought: &Brought) {
    let Brought { network, tuned, held_out, costs, reading, reading_error } = brought;
    network.notes().iter().for_each(|note| say!("{note}"));
    let doubt = |is_far| if is_far { ": --as, --reset or --dt may be others" } else { "" };
    if let Some(reading) = reading {
        say!(
            "in double precision, as the file and the options say, outputs fire as they did in training in {:.1} % of the \
             steps in which any fires{}",
            100.0 * reading,
            doubt(*reading < READ)
        );
    }
    if let Some(error) = reading_error {
        say!(
            "in double precision, as the file and the options say, potentials of outputs are {:.1} % off those of \
             training (root mean squares){}",
            100.0 * error,
            doubt(*error > READ_ERROR)
        );
    }
    say!("layer: neurons, weights clipped; spikes, on the chip, distance");
    tell(tuned, &**network);
    match held_out {
        Some(held_out) => {
            say!("held out:");
            tell(held_out, &**network);
        }
        None => say!(
            "the figures are those of the recording that the network is tuned on: --held-out shows another"
        ),
    }
    let shown = held_out.as_ref().unwrap_or(tuned).agreement();
    if shown.is_some_and(|agreement| agreement < LOW) {
        let alone = |(cost, left): &(Cost, f64)| format!("{cost} {:.1} %", 100.0 * left);
        let mut costs = costs.clone();
        costs.sort_by(|(_, one), (_, other)| one.total_cmp(other));
        let costs: Vec<String> = costs.iter().map(alone).collect();
        say!(
            "warning: step by step the chip is another network than the trained one; {}",
            if costs.is_empty() {
                "compare the spikes of each layer".to_owned()
            } else {
                format!(
                    "alone would leave of its steps: {}; train with the first",
                    costs.join(", ")
                )
            }
        );
    }
}

fn tell(figures: &Figures, network: &dyn OnChip) {
    for layer in &figures.layers {
        say!(
            "{}: {}, {}; {}, {}, {:.1}",
            layer.name,
            layer.neurons,
            layer.clipped,
            layer.spikes,
            layer.on_chip,
            layer.distance
        );
    }
    if let Some(outputs) = &figures.potentials {
        say!(
            "{}: {} outputs, {} weights clipped; potentials of {:.4}, on the chip {:.4} off (root mean squares)",
            outputs.name,
            outputs.outputs,
            outputs.clipped,
            outputs.size,
            outputs.error
        );
    }
    let &Figures { steps, agreeing, active, windows, windows_agreeing, .. } = figures;
    if let Some(agreement) = figures.agreement() {
        say!(
            "outputs agree in {:.1} % of {steps} steps, in {:.1} % of the {active} in which any {}",
            100.0 * agreeing as f64 / steps as f64,
            100.0 * agreement,
            if figures.potentials.is_some() { "has a potential" } else { "fires" }
        );
        say!(
            "the output that {} is the same in {:.1} % of {windows} times {WINDOW} steps",
            if figures.potentials.is_some() { "is highest most often" } else { "fires most" },
            100.0 * windows_agreeing as f64 / windows as f64
        );
    } else if figures.potentials.is_none() {
        say!(
            "warning: no output fires, neither in double precision nor on the chip: there is nothing to compare"
        );
    }
    say!("{}", network.effort(figures.mean_clocks, figures.most_clocks));
    if figures.lost > 0 {
        say!("warning: {} spikes were lost: {}", figures.lost, network.loss());
    }
    if figures.clipped > 0 {
        say!(
            "warning: in {} steps an output reached the end of its 16 bits; in flight, `run` returns `Clipped` then",
            figures.clipped
        );
    }
}
