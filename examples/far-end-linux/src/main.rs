//! A companion computer at the end of a serial line: link frames in, a command back for each.
//!
//! `far-end-linux /dev/ttyAMA0 921600`; a board over USB has no baud rate, so that any will do. After the rate, the
//! milliseconds without a frame after which nothing is known: 120 unless given.

use std::{
    env,
    io::{self, ErrorKind, Read, Write},
    process::ExitCode,
    time::{Duration, Instant},
};

use far_end::{FarEnd, SILENCE_MS};
use linux_embedded_hal::{
    Serial,
    serialport::{self, SerialPort, TTYPort},
};

const USAGE: &str = "far-end-linux PORT [BAUD [SILENCE]]";
const BAUD: u32 = 921_600;
/// How often the silence is looked at.
const LOOK: Duration = Duration::from_millis(5);

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
    match open(path, baud) {
        Ok(mut port) => {
            let error = run(&mut port, FarEnd::with_silence(silence));
            eprintln!("{path}: {error}");
            ExitCode::FAILURE
        }
        Err(error) => {
            eprintln!("{path}: {error}");
            ExitCode::FAILURE
        }
    }
}

fn open(path: &str, baud: u32) -> Result<TTYPort, serialport::Error> {
    let Serial(mut port) = Serial::open(path.into(), baud)?;
    port.set_timeout(LOOK)?;
    Ok(port)
}

/// Listens until the port fails.
fn run(port: &mut (impl Read + Write), mut far: FarEnd) -> io::Error {
    let start = Instant::now();
    let mut bytes = [0; 512];
    loop {
        let length = match port.read(&mut bytes) {
            Ok(0) => return ErrorKind::UnexpectedEof.into(),
            Ok(length) => length,
            Err(error) if [ErrorKind::TimedOut, ErrorKind::Interrupted].contains(&error.kind()) => {
                0
            }
            Err(error) => return error,
        };
        let now = start.elapsed().as_millis() as u32;
        let mut commands = Vec::new();
        far.take(now, &bytes[..length], |_, _, _| (), |command| commands.extend(command.bytes()));
        commands.extend(far.silence(now).map(|command| command.bytes()).into_iter().flatten());
        if let Err(error) = port.write_all(&commands) {
            return error;
        }
    }
}
