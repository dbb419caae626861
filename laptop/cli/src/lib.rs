//! The command line of the program `spikewire`: parses arguments and prints text. The work itself is done by the
//! library `lab`.

#[macro_use]
mod words;

mod commands;
mod inputs;
mod live;
mod options;
mod panel;
mod report;
mod stop;

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use commands::{capture, convert, decode, encode, info, listen, score, signal};
use std::process::ExitCode;

/// Encode recordings as spikes and decode them, with the code that runs on the flight controller.
#[derive(Parser)]
#[command(name = "spikewire", version)]
struct Program {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Advise(commands::advise::Advise),
    Score(score::Score),
    Tune(commands::tune::Tune),
    Encode(encode::Encode),
    Decode(decode::Decode),
    Info(info::Info),
    Samples(commands::samples::Samples),
    Plot(commands::plot::Plot),
    Dataset(commands::dataset::Dataset),
    Emit(commands::emit::Emit),
    Listen(listen::Listen),
    Capture(capture::Capture),
    Convert(convert::Convert),
    Frames(commands::frames::Frames),
    Network(commands::network::Network),
    Signal(signal::Signal),
    Bench(commands::bench::Bench),
}

/// The first page of the help: the commands by task, as clap has no groups of commands.
const HELP: &str = "\
{about-with-newline}
{usage-heading} {usage}

A scheme for a log:
  advise   Describe a log, and advise a scheme and parameters for each channel
  score    Count a scheme's spikes, and measure the error of what they decode to
  tune     Search a scheme's parameters for a goal
  encode   Encode channels of a recording as spikes
  decode   Decode spikes to values

Recordings:
  info     List the content of logs and tables
  samples  Write channels of a log as a CSV table
  plot     Draw a signal, its spikes and what they decode to
  dataset  Encode many logs to Parquet files, with a manifest

The drone and its link:
  emit     Write source code for firmware from a flight file
  listen   Read the events that a board sends, and decode them
  capture  Read a board's RTT channel through a debug probe
  convert  Convert events from one format to another

Cameras and networks:
  frames   Convert a video to the events of its pixels
  network  Convert a trained network for a chip or the flight controller

The paper, Dupeyroux et al. (2022):
  signal   Write the test signal of its benchmark
  bench    Reproduce its tables, cell by cell

Options:
{options}

Examples:
  spikewire advise flight.csv --loop-bandwidth 4 -o flight.toml
  spikewire encode --scheme sf --threshold 0.1 --channels gyro_x flight.csv

`spikewire COMMAND -h` lists a command's options, and `--help` explains them.
";

/// Exit status of a failed command; clap exits with the same status if options are wrong.
const FAILURE: u8 = 2;

/// Parses the process's arguments, runs the command, and returns the exit status: 0 on success, 2 after an error, which
/// is printed on standard error.
pub fn run() -> ExitCode {
    let mut matches = Program::command().help_template(HELP).get_matches();
    let command = match Program::from_arg_matches_mut(&mut matches) {
        Ok(program) => program.command,
        Err(error) => error.exit(),
    };
    let done = stop::handle().and_then(|()| match command {
        Command::Encode(options) => encode::run(&options),
        Command::Decode(options) => decode::run(&options),
        Command::Listen(options) => listen::run(&options),
        Command::Convert(options) => convert::run(&options),
        Command::Dataset(options) => commands::dataset::run(&options),
        Command::Capture(options) => capture::run(&options),
        Command::Score(options) => score::run(&options),
        Command::Bench(options) => commands::bench::run(&options),
        Command::Plot(options) => commands::plot::run(&options),
        Command::Network(options) => commands::network::run(&options),
        Command::Info(options) => info::run(&options),
        Command::Samples(options) => commands::samples::run(&options),
        Command::Signal(options) => signal::run(&options),
        Command::Advise(options) => commands::advise::run(&options),
        Command::Emit(options) => commands::emit::run(&options),
        Command::Tune(options) => commands::tune::run(&options),
        Command::Frames(options) => commands::frames::run(&options),
    });
    inputs::delete_copy();
    match done {
        Ok(()) => ExitCode::SUCCESS,
        // A reader that closes the pipe early, such as `head`, is no error.
        Err(error) if words::is_closed_pipe(&error) => ExitCode::SUCCESS,
        Err(error) => {
            say!("error: {}", words::of(&error));
            ExitCode::from(FAILURE)
        }
    }
}
