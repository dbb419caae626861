//! The program at the end of a pseudo terminal, with what a board has sent.

use std::{
    env, fs,
    io::{ErrorKind, Read, Write},
    path::PathBuf,
    process::{Child, Command},
    time::{Duration, Instant},
};

use linux_embedded_hal::serialport::{SerialPort, TTYPort};

/// A command that damps nothing.
const NEUTRAL: [u8; 8] = [0x5C, 0, 0, 0, 0, 0, 0, 0];

/// In ms: longer than a busy machine stands still.
const SILENCE: &str = "6000";

const PATIENCE: Duration = Duration::from_secs(60);

/// The program, which ends with the test.
struct Program(Child);

impl Drop for Program {
    fn drop(&mut self) {
        // What has ended already cannot be killed.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// `LINK_BYTES` is a file of what came out of a board's UART; the commands go to the file `LINK_COMMANDS`.
#[test]
#[ignore = "needs what a board has sent: cargo verify link"]
fn answers_what_a_board_has_sent() {
    let path =
        |name| PathBuf::from(env::var_os(name).unwrap_or_else(|| panic!("{name} is not set")));
    let sent = fs::read(path("LINK_BYTES")).unwrap();
    let (mut board, companion) = TTYPort::pair().unwrap();
    board.set_timeout(Duration::from_millis(20)).unwrap();
    let program = Command::new(env!("CARGO_BIN_EXE_far-end-linux"))
        .args([&companion.name().unwrap(), "115200", SILENCE])
        .spawn()
        .unwrap();
    let _program = Program(program);

    // Its answer to silence says that it listens.
    assert_eq!(until_neutral(&mut board, Vec::new()), NEUTRAL);
    let mut commands = Vec::new();
    for chunk in sent.chunks(997) {
        board.write_all(chunk).unwrap();
        hear(&mut board, &mut commands);
    }
    let commands = until_neutral(&mut board, commands);
    fs::write(path("LINK_COMMANDS"), commands).unwrap();
}

/// Hears the rest, up to the answer to silence.
fn until_neutral(port: &mut TTYPort, mut heard: Vec<u8>) -> Vec<u8> {
    let start = Instant::now();
    while !heard.ends_with(&NEUTRAL) {
        assert!(start.elapsed() < PATIENCE, "no answer to silence after {} bytes", heard.len());
        hear(port, &mut heard);
    }
    heard
}

/// Adds what has come; nothing after a while is nothing.
fn hear(port: &mut TTYPort, to: &mut Vec<u8>) {
    let mut bytes = [0; 4096];
    match port.read(&mut bytes) {
        Ok(length) => to.extend(&bytes[..length]),
        Err(error) if error.kind() == ErrorKind::TimedOut => {}
        Err(error) => panic!("{error}"),
    }
}
