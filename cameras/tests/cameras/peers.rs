//! The event formats against independent programs: `event-stream`, `expelliarmus` and `evt3`.
//!
//! `cargo verify peers` installs them in a virtual environment and runs this with `PEERS_PYTHON` set to
//! its Python.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use flight_data::{HEXAROTOR, records};
use spikewire::temporal::StepForward;
use spikewire::{Bank, Event, Polarity};
use spikewire_cameras::format::{EventDecoder, EventFormat, EventStream, Evt2, Evt3Pixels};
use spikewire_cameras::frame::PixelEvent;

const WHY: &str = "run by `cargo verify peers`";

/// The flight log's spikes, and the ends of the address range.
fn events() -> Vec<Event> {
    let scheme = StepForward::new(0.1);
    let mut bank = Bank::<_, 6>::new(&scheme);
    let mut events = Vec::new();
    for record in records(HEXAROTOR) {
        bank.encode(record.micros.into(), record.channels, |event| events.push(event));
    }
    let tick = events.last().unwrap().tick;
    for address in [0, 255, 256, 2047, 2048, 32_767, u16::MAX] {
        for polarity in [Polarity::Up, Polarity::Down] {
            events.push(Event { tick, address, polarity });
        }
    }
    events
}

fn lines(events: &[Event]) -> String {
    let line = |event: &Event| {
        let up = u8::from(event.polarity == Polarity::Up);
        format!("{} {} {up}\n", event.tick.micros(), event.address)
    };
    events.iter().map(line).collect()
}

fn peer(action: &str, kind: &str, path: &Path, input: &str) -> String {
    let python = std::env::var_os("PEERS_PYTHON").expect(WHY);
    let mut child = Command::new(python)
        .arg(concat!(env!("CARGO_MANIFEST_DIR"), "/peers/peers.py"))
        .args([action, kind])
        .arg(path)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    child.stdin.take().unwrap().write_all(input.as_bytes()).unwrap();
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success());
    String::from_utf8(output.stdout).unwrap()
}

/// Returns a file of a format, with the ending that the format's program asks for.
fn file(name: &str, format: &str) -> PathBuf {
    let ending = if format == "es" { "es" } else { "raw" };
    PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}-{format}.{ending}"))
}

fn the_peer_reads_ours(name: &str, header: &[u8], encoder: impl EventFormat) {
    let events = events();
    the_peer_reads(name, header, encoder, &events, &events);
}

/// Writes `written`, which the peer must read as `events`.
fn the_peer_reads<E: Copy>(
    name: &str,
    header: &[u8],
    mut encoder: impl EventFormat<E>,
    written: &[E],
    events: &[Event],
) {
    let mut bytes = header.to_vec();
    let mut buffer = vec![0; 1 << 16];
    for &event in written {
        let length = encoder.encode(event, &mut buffer).unwrap();
        bytes.extend(&buffer[..length]);
    }
    let path = file("ours", name);
    std::fs::write(&path, &bytes).unwrap();
    assert!(peer("read", name, &path, "") == lines(events));
}

fn we_read_the_peers(name: &str, events: &[Event], mut decoder: impl EventDecoder) {
    let path = file("theirs", name);
    peer("write", name, &path, &lines(events));
    let bytes = std::fs::read(&path).unwrap();
    let read: Vec<Event> = decoder.decode(&bytes).collect();
    assert!(read == events);
    assert_eq!(decoder.skipped(), 0);
}

#[test]
#[ignore = "needs other programs: run by `cargo verify peers`"]
fn event_stream_agrees_with_its_own_program() {
    the_peer_reads_ours("es", &EventStream::HEADER, EventStream::encoder());
    // Its writer ends a payload at the first byte that is 0.
    let without_zeros: Vec<Event> = events()
        .into_iter()
        .map(|event| Event { address: event.address | 0x0101, polarity: Polarity::Up, ..event })
        .collect();
    we_read_the_peers("es", &without_zeros, EventStream::decoder());
}

#[test]
#[ignore = "needs other programs: run by `cargo verify peers`"]
fn evt2_agrees_with_expelliarmus() {
    the_peer_reads_ours("evt2", Evt2::HEADER, Evt2::encoder());
    we_read_the_peers("evt2", &events(), Evt2::file_decoder());
}

/// Only one way: the program has no writer.
#[test]
#[ignore = "needs other programs: run by `cargo verify peers`"]
fn evt3_reads_ours() {
    let events = events();
    let pixel = |event: &Event| {
        let Event { tick, address, polarity } = *event;
        PixelEvent { tick, x: address & 0x7FF, y: address >> 11, polarity }
    };
    let pixels: Vec<PixelEvent> = events.iter().map(pixel).collect();
    let header = b"% evt 3.0\n% format EVT3;height=32;width=2048\n% geometry 2048x32\n% end\n";
    the_peer_reads("evt3", header, Evt3Pixels::encoder(), &pixels, &events);
}
