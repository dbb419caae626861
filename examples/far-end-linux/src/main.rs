//! A companion computer at the end of a serial line: link frames in, a command back for each.
//!
//! `far-end-linux /dev/ttyAMA0 921600`; a board over USB has no baud rate, so that any will do. After the rate, the
//! milliseconds of silence after which nothing is known: 1500 unless given.

use std::{
    env,
    io::{self, ErrorKind, Read, Write},
    process::ExitCode,
    time::Duration,
};

use far_end::{FarEnd, SILENCE_MS};
use linux_embedded_hal::{
    Serial,
    serialport::{self, SerialPort, TTYPort},
};

const USAGE: &str = "far-end-linux PORT [BAUD [SILENCE]]";
const BAUD: u32 = 921_600;

fn main() -> ExitCode {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let (path, numbers) = match &arguments[..] {
        [path, numbers @ ..] if numbers.len() <= 2 => (path, numbers),
        _ => {
            eprintln!("{USAGE}");
            return ExitCode::from(2);
        }
    };
    let number = |place: usize, usual| numbers.get(place).map_or(Ok(usual), |text| text.parse());
    let (Ok(baud), Ok(silence)) = (number(0, BAUD), number(1, SILENCE_MS)) else {
        eprintln!("BAUD and SILENCE are numbers\n{USAGE}");
        return ExitCode::from(2);
    };
    match open(path, baud, silence) {
        Ok(mut port) => {
            let error = run(&mut port);
            eprintln!("{path}: {error}");
            ExitCode::FAILURE
        }
        Err(error) => {
            eprintln!("{path}: {error}");
            ExitCode::FAILURE
        }
    }
}

fn open(path: &str, baud: u32, silence: u32) -> Result<TTYPort, serialport::Error> {
    let Serial(mut port) = Serial::open(path.into(), baud)?;
    port.set_timeout(Duration::from_millis(silence.into()))?;
    Ok(port)
}

/// Listens until the port fails.
fn run(port: &mut (impl Read + Write)) -> io::Error {
    let mut far = FarEnd::default();
    let mut bytes = [0; 512];
    loop {
        let mut commands = Vec::new();
        match port.read(&mut bytes) {
            Ok(0) => return ErrorKind::UnexpectedEof.into(),
            Ok(length) => {
                far.take(&bytes[..length], |_, _, _| (), |command| commands.extend(command.bytes()))
            }
            Err(error) if error.kind() == ErrorKind::TimedOut => {
                commands.extend(far.silence().bytes());
            }
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(error) => return error,
        }
        if let Err(error) = port.write_all(&commands) {
            return error;
        }
    }
}
