//! The command line of the laptop program: reads arguments and prints text. The work itself is done in `lab`.

mod commands;
mod inputs;
mod live;
mod options;
mod stop;
mod words;

use clap::{Parser, Subcommand};
use commands::{capture, convert, decode, encode, info, listen, score, signal};
use std::process::ExitCode;

/// Spikes from recordings and back, with the code that flies.
#[derive(Parser)]
#[command(name = "spikewire", version)]
struct Program {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Encode(encode::Encode),
    Decode(decode::Decode),
    Listen(listen::Listen),
    Convert(convert::Convert),
    Dataset(commands::dataset::Dataset),
    Capture(capture::Capture),
    Score(score::Score),
    Bench(commands::bench::Bench),
    Plot(commands::plot::Plot),
    Network(commands::network::Network),
    Info(info::Info),
    Signal(signal::Signal),
    Tune(commands::tune::Tune),
    Frames(commands::frames::Frames),
    Advise(commands::advise::Advise),
    Emit(commands::emit::Emit),
}

/// Exit status of a command that fails, the same as for wrong options.
const FAILURE: u8 = 2;

/// Runs the program with the arguments of the process.
pub fn run() -> ExitCode {
    let command = Program::parse().command;
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
        Command::Signal(options) => signal::run(&options),
        Command::Advise(options) => commands::advise::run(&options),
        Command::Emit(options) => commands::emit::run(&options),
        Command::Tune(options) => commands::tune::run(&options),
        Command::Frames(options) => commands::frames::run(&options),
    });
    inputs::delete_copy();
    match done {
        Ok(()) => ExitCode::SUCCESS,
        // Whoever reads has read enough.
        Err(error) if words::is_closed_pipe(&error) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {}", words::of(&error));
            ExitCode::from(FAILURE)
        }
    }
}
