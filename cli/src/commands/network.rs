//! `spikewire network`: a trained network onto a chip, and what that costs.

use crate::bank::Bank;
use crate::fit::rounded;
use crate::input::{Clock, InputOptions, above_zero};
use crate::network::{Distance, File, Ran, Told, Trained, Trains, emit, quantise, run_on_chip};
use crate::options::SchemeOptions;
use crate::output::Output;
use crate::scheme::Scheme;
use anyhow::{Result, bail, ensure};
use catalogue::run::{Calibrated, Known, SampleType, Shape};
use clap::Args;
use spikewire::Polarity;
use std::collections::{BTreeMap, BTreeSet};
use std::io::Write;
use std::path::PathBuf;

/// Bring a trained network onto tinyODIN: a Rust constant for `spikewire::chip`, and what quantising costs.
///
/// A recording's spikes run through the network in double precision and, with weights of 4 bits, through the chip's
/// model, clock by clock. NETWORK is a NIR graph (an HDF5 file of snnTorch, Norse, Rockpool, Sinabs, Lava and
/// others) that is a chain of up to three layers, each Linear or Affine and LIF or IF; or JSON:
/// {"layers": [{"name": ..., "weights": [[...]], "bias": [...], "keep": 0.9, "threshold": 1.0}]}, with weights by
/// neuron and then input, and the share of the potential that a step leaves.
#[derive(Args, Debug)]
#[command(after_help = "\
Example:
  spikewire network trained.nir --scheme position --neurons 20 --column gyro_x flight.csv -o src/network.rs")]
pub(crate) struct Network {
    /// NIR graph, or network in JSON
    #[arg(value_name = "NETWORK")]
    trained: PathBuf,
    /// The scheme that makes the inputs: one for each neuron of each column, of codes with a direction two, up and
    /// down
    #[arg(long)]
    scheme: Scheme,
    /// Sample type: f32, i16, i32, or fixed point such as q16.16 or q8.8
    #[arg(long, default_value_t)]
    sample: SampleType,
    /// Seconds of a step in the network's time constants, such as 1e-4 of snnTorch; a sample or sub-timestep of the
    /// recording unless given
    #[arg(long, value_name = "SECONDS", value_parser = above_zero)]
    dt: Option<f64>,
    #[command(flatten)]
    input: InputOptions,
    #[command(flatten)]
    parameters: SchemeOptions,
    /// File of Rust; standard output unless given
    #[arg(short, long)]
    output: Option<PathBuf>,
}

/// Runs the command.
///
/// # Errors
/// The network, the recording, the parameters or the output are not good, or the network does not fit the chip.
pub(crate) fn run(options: &Network) -> Result<()> {
    let Network { trained: path, scheme, dt, input, output, .. } = options;
    let file = File::read(path)?;
    ensure!(
        !input.is_stdin(),
        "the recording calibrates scheme and chip, and is read as a whole: give a file"
    );
    let driven = driven(options)?;
    let seconds = driven.step_us.map(|step| step * 1e-6);
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let trained = file.in_steps(dt.or(seconds)).map_err(|error| error.context(name.clone()))?;
    ensure!(
        trained.inputs() == driven.inputs,
        "{name}: {} has {} inputs, but {} gives {}",
        trained.layers[0].name,
        trained.inputs(),
        scheme.name(),
        driven.words()
    );

    let original = trained.run(&driven.steps);
    let network = quantise(&trained, &driven.steps, &original)
        .map_err(|error| error.context(name.clone()))?;
    let ran = run_on_chip(&network, &driven.steps)?;

    let told = Told { source: name, inputs: driven.words(), step_us: driven.step_us };
    let mut output = Output::open(output.as_deref(), &input.input)?;
    output.write_all(emit(&network, &told).as_bytes())?;
    output.finish()?;
    for note in &driven.notes {
        eprintln!("{note}");
    }
    let clipped: Vec<usize> = network
        .layers
        .iter()
        .map(|layer| layer.neurons.iter().map(|neuron| neuron.clipped).sum())
        .collect();
    report(&trained, &original, &ran, &clipped, network.steps_a_leak);
    Ok(())
}

/// What goes into the network.
struct Driven {
    /// By step.
    steps: Trains,
    inputs: usize,
    shape: Shape,
    channels: usize,
    is_signed: bool,
    /// How long a step is, if that is known.
    step_us: Option<f64>,
    notes: Vec<String>,
}

impl Driven {
    /// What the inputs are.
    fn words(&self) -> String {
        let Self { inputs, shape: Shape { neurons, .. }, channels, is_signed, .. } = self;
        let directions = if *is_signed { ", each up and down" } else { "" };
        let columns = if *channels == 1 { "1 column" } else { &format!("{channels} columns") };
        let of = if *neurons == 1 { String::new() } else { format!("{neurons} neurons of ") };
        format!("{inputs}, of {of}{columns}{directions}")
    }
}

/// The recording as spikes.
fn driven(options: &Network) -> Result<Driven> {
    let Network { scheme, sample, input, parameters, .. } = options;
    parameters.check(scheme.info())?;
    let mut source = input.open()?;
    let all = source.rest()?;
    let mut clock = Clock::new(&all.times, input.rate, input.gap);
    clock.observe(&all.times);
    let rows = all.finite_rows();
    let columns = all.kept(&rows);
    let samples = columns.first().map_or(0, Vec::len);
    if samples == 0 {
        bail!("{}: none of the {} samples is finite", input.name(), rows.len());
    }
    let mut notes = source.notes().to_vec();
    if samples < rows.len() {
        let count = rows.len() - samples;
        notes.push(format!("{count} samples were not finite or missing and emitted nothing"));
    }
    notes.push(clock.to_string());

    let mut settings = Vec::new();
    for column in &columns {
        let mut calibrated = Calibrated::new(*sample);
        calibrated.observe(column);
        let known = Known { calibrated: Some(&calibrated), first: column, can_calibrate: true };
        let (own, rounding) = rounded(*scheme, *sample, &scheme.resolve(parameters, &known)?)?;
        notes.extend(rounding);
        settings.push(own);
    }
    let mut bank = Bank::new(*scheme, *sample, &settings)?;
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
    Ok(Driven {
        steps,
        inputs: columns.len() * shape.neurons * usize::from(directions),
        shape,
        channels: columns.len(),
        is_signed,
        step_us: clock.rate().map(|rate| 1e6 / rate / shape.slots as f64),
        notes,
    })
}

/// What quantising costs, on standard error.
fn report(
    trained: &Trained,
    original: &[Trains],
    ran: &Ran,
    clipped: &[usize],
    steps_a_leak: usize,
) {
    let neurons: usize = trained.layers.iter().map(|layer| layer.neurons.len()).sum();
    let steps = ran.clocks.len();
    let every = if steps_a_leak == 1 { "step" } else { &format!("{steps_a_leak} steps") };
    eprintln!("{neurons} of the chip's 256 neurons; a leak every {every}");
    eprintln!("layer: neurons, weights clipped; spikes, on the chip, distance");
    for (((layer, original), chip), clipped) in
        trained.layers.iter().zip(original).zip(&ran.fired).zip(clipped)
    {
        let Cost { spikes, on_chip, distance } = cost(layer.neurons.len(), original, chip);
        let (name, neurons) = (&layer.name, layer.neurons.len());
        eprintln!("{name}: {neurons}, {clipped}; {spikes}, {on_chip}, {distance:.1}");
    }
    if let (Some(original), Some(chip)) = (original.last(), ran.fired.last()) {
        let Agreement { all, active, agreeing } = agreement(original, chip);
        eprintln!(
            "outputs agree in {:.1} % of {steps} steps, in {:.1} % of the {active} in which any fires",
            percent(all, steps),
            percent(agreeing, active)
        );
        let (windows, agreeing) = winners(original, chip);
        eprintln!(
            "the output that fires most is the same in {:.1} % of {windows} times {WINDOW} steps",
            percent(agreeing, windows)
        );
    }
    let most = ran.clocks.iter().max().copied().unwrap_or(0);
    let mean = ran.clocks.iter().sum::<u64>() as f64 / steps.max(1) as f64;
    eprintln!("a step takes the chip {mean:.0} clocks, {most} at most");
    if ran.overflows > 0 {
        eprintln!("the chip's queue of 128 was full, and {} spikes were lost", ran.overflows);
    }
}

fn percent(part: usize, of: usize) -> f64 {
    if of == 0 { 100.0 } else { 100.0 * part as f64 / of as f64 }
}

struct Cost {
    spikes: usize,
    on_chip: usize,
    distance: f64,
}

fn cost(neurons: usize, original: &Trains, chip: &Trains) -> Cost {
    let mut distances = vec![Distance::default(); neurons];
    let (mut spikes, mut on_chip) = (0, 0);
    for (original, chip) in original.iter().zip(chip) {
        spikes += original.len();
        on_chip += chip.len();
        for (neuron, distance) in distances.iter_mut().enumerate() {
            let count = |fired: &[u16]| fired.iter().filter(|&&n| usize::from(n) == neuron).count();
            distance.step(count(original), count(chip));
        }
    }
    Cost { spikes, on_chip, distance: distances.into_iter().map(Distance::value).sum() }
}

/// The steps over which outputs are counted.
const WINDOW: usize = 20;

/// How many windows there are in which an output fires, and in how many of them those that fire most are the same.
fn winners(original: &Trains, chip: &Trains) -> (usize, usize) {
    let most = |steps: &[Vec<u16>]| {
        let mut counts = BTreeMap::new();
        for output in steps.iter().flatten() {
            *counts.entry(*output).or_insert(0) += 1;
        }
        let most = counts.values().max().copied();
        counts.retain(|_, count| Some(*count) == most);
        counts.into_keys().collect::<Vec<_>>()
    };
    let windows = original.chunks(WINDOW).zip(chip.chunks(WINDOW));
    let winners = windows.map(|(original, chip)| (most(original), most(chip)));
    let active = winners.filter(|(original, chip)| !original.is_empty() || !chip.is_empty());
    active.fold((0, 0), |(windows, agreeing), (original, chip)| {
        (windows + 1, agreeing + usize::from(original == chip))
    })
}

/// In how many steps the outputs are the same.
struct Agreement {
    all: usize,
    /// Steps in which any fires, here or there.
    active: usize,
    /// Of those.
    agreeing: usize,
}

fn agreement(original: &Trains, chip: &Trains) -> Agreement {
    let mut counts = Agreement { all: 0, active: 0, agreeing: 0 };
    for (original, chip) in original.iter().zip(chip) {
        let sets = [original, chip].map(|fired| fired.iter().collect::<BTreeSet<_>>());
        let agrees = sets[0] == sets[1];
        let is_active = !original.is_empty() || !chip.is_empty();
        counts.all += usize::from(agrees);
        counts.active += usize::from(is_active);
        counts.agreeing += usize::from(agrees && is_active);
    }
    counts
}
