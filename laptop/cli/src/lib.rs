//! The command line of the program `spikewire`: parses arguments and prints text. The work itself is done by the
//! library `lab`.

mod commands;
mod inputs;
mod live;
mod options;
mod panel;
mod report;
mod stop;
mod words;

use clap::{Parser, Subcommand};
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

/// Exit status of a failed command; clap exits with the same status if options are wrong.
const FAILURE: u8 = 2;

/// Parses the process's arguments, runs the command, and returns the exit status: 0 on success, 2 after an error, which
/// is printed on standard error.
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
        // A reader that closes the pipe early, such as `head`, is no error.
        Err(error) if words::is_closed_pipe(&error) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {}", words::of(&error));
            ExitCode::from(FAILURE)
        }
    }
}
