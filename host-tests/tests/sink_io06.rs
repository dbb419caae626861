//! Ports of embedded-io 0.6: all that they do comes through the adapter to version 0.7.

use embedded_io::{Error, ErrorKind, Write, WriteReady};
use embedded_io_06 as old;
use spikewire::out::{Io06, Io06Error};

/// A port that takes so many bytes, and then fails.
#[derive(Debug)]
struct Port {
    room: usize,
    flushed: bool,
    error: old::ErrorKind,
}

impl old::ErrorType for Port {
    type Error = old::ErrorKind;
}

impl old::Write for Port {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, old::ErrorKind> {
        let taken = bytes.len().min(self.room);
        self.room -= taken;
        if taken > 0 { Ok(taken) } else { Err(self.error) }
    }

    fn flush(&mut self) -> Result<(), old::ErrorKind> {
        self.flushed = true;
        Ok(())
    }
}

impl old::WriteReady for Port {
    fn write_ready(&mut self) -> Result<bool, old::ErrorKind> {
        Ok(self.room > 0)
    }
}

#[test]
fn bytes_and_readiness_are_the_ports() {
    let mut port = Io06(Port { room: 5, flushed: false, error: old::ErrorKind::Other });
    assert_eq!((port.write(&[1, 2, 3]), port.write_ready()), (Ok(3), Ok(true)));
    assert_eq!((port.write(&[1, 2, 3]), port.write_ready()), (Ok(2), Ok(false)));
    assert_eq!((port.write(&[3]), port.flush()), (Err(Io06Error(old::ErrorKind::Other)), Ok(())));
    assert!(port.0.flushed);
}

#[test]
fn errors_keep_their_kinds() {
    let kinds = [
        (old::ErrorKind::TimedOut, ErrorKind::TimedOut),
        (old::ErrorKind::Interrupted, ErrorKind::Interrupted),
        (old::ErrorKind::BrokenPipe, ErrorKind::BrokenPipe),
        (old::ErrorKind::WriteZero, ErrorKind::WriteZero),
        (old::ErrorKind::NotConnected, ErrorKind::NotConnected),
        (old::ErrorKind::InvalidInput, ErrorKind::InvalidInput),
        (old::ErrorKind::Other, ErrorKind::Other),
    ];
    for (error, kind) in kinds {
        let seen = Io06(Port { room: 0, flushed: false, error }).write(&[0]).unwrap_err();
        assert_eq!((seen.kind(), seen.to_string()), (kind, format!("{error:?}")));
    }
}
