//! Reads a board's ring buffer while the board runs, by Real-Time Transfer (RTT).

#[cfg(feature = "capture")]
mod probe;

#[cfg(feature = "capture")]
pub use probe::{Board, with_channel};

use crate::error::room;
use crate::{Error, Result};
use catalogue::kinds;
use std::io::Write;
use std::thread;
use std::time::Duration;

kinds! {
    /// The reason for which a board cannot be read.
    pub enum CaptureKind by spell of subject {
        Unread { error: Box<Error> } => ("the channel cannot be read any more: {error}"),
        Gone => ("it is gone"),
        NoProbe { hint: &'static str } => ("no debug probe found{hint}"),
        SeveralProbes { names: Vec<String> } =>
            ("{} debug probes found; {} says which: {}", names.len(), spell("probe"), names.join(", ")),
        NoChip { why: String } => ("{subject}: {why}"),
        NotASelector { why: String } => ("{subject}: {why}"),
        NoProbeOpen { probe: String, why: String } => ("{probe}: {why}"),
        NotReached { chip: String, why: String } => ("the probe does not reach the {chip}: {why}"),
        NoRtt { why: String } => ("the board has no RTT, or it is not set up yet: {why}"),
        NoChannel { channels: usize } => ("{subject}: the board has {channels}, numbered from 0"),
    }
}
room!(CaptureKind, Capture);

/// A ring buffer on a board, read by polling.
pub trait Channel {
    /// Reads the bytes that are available, up to the buffer's length. Returns the number of bytes read, 0 if none are
    /// available.
    ///
    /// # Errors
    /// Returns an error if the board or the probe was disconnected.
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize>;
}

/// The result of a capture.
#[derive(Debug)]
pub struct Captured {
    /// The number of bytes written.
    pub bytes: u64,
    /// `Ok` if the capture ended on request; otherwise the error that ended the capture.
    pub end: Result<()>,
}

/// Copies a channel's bytes to `output` until `is_due` returns true. Afterwards copies the bytes that are still in the
/// channel.
pub fn capture(
    channel: &mut dyn Channel,
    output: &mut dyn Write,
    mut is_due: impl FnMut() -> bool,
) -> Captured {
    let mut bytes = 0;
    let end = copy(channel, output, &mut is_due, &mut bytes);
    Captured { bytes, end }
}

fn copy(
    channel: &mut dyn Channel,
    output: &mut dyn Write,
    is_due: &mut dyn FnMut() -> bool,
    bytes: &mut u64,
) -> Result<()> {
    /// Time between polls of an empty channel. A board's buffer of 1 KiB does not overflow in this time: at 100 kB/s,
    /// the buffer fills in 10 ms.
    const PAUSE: Duration = Duration::from_millis(1);
    /// Maximum number of bytes that are read after `is_due` has requested the end of the copy. The limit ends the copy
    /// even if the board sends without a pause.
    const REST: u64 = 1 << 20;
    let mut buffer = vec![0; 1 << 14];
    let mut last = None;
    while last.is_none_or(|last| *bytes < last) {
        if last.is_none() && is_due() {
            last = Some(*bytes + REST);
        }
        let count = channel
            .read(&mut buffer)
            .map_err(|error| CaptureKind::Unread { error: Box::new(error) })?;
        if count > 0 {
            output.write_all(&buffer[..count])?;
            output.flush()?;
            *bytes += count as u64;
        } else if last.is_some() {
            break;
        } else {
            thread::sleep(PAUSE);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::{CaptureKind, Captured, Channel, capture};
    use crate::{ErrorKind, Result};
    use std::collections::VecDeque;

    /// A channel that returns the next entry at each read, and fails after the last as if the board were disconnected.
    struct Fake(VecDeque<&'static [u8]>);

    impl Channel for Fake {
        fn read(&mut self, buffer: &mut [u8]) -> Result<usize> {
            let Some(found) = self.0.pop_front() else { return Err(CaptureKind::Gone.into()) };
            buffer[..found.len()].copy_from_slice(found);
            Ok(found.len())
        }
    }

    /// Captures from a [`Fake`] board. Read number `i` of the board gives the bytes `reads[i]`. The capture is asked to
    /// stop after `stop` reads.
    fn run(reads: &[&'static [u8]], stop: usize) -> (Vec<u8>, Captured) {
        let (mut output, mut asked) = (Vec::new(), 0);
        let captured = capture(&mut Fake(reads.iter().copied().collect()), &mut output, || {
            asked += 1;
            asked > stop
        });
        (output, captured)
    }

    #[test]
    fn chunks_follow_each_other_over_reads_that_find_nothing() {
        let (output, captured) = run(&[b"one ", b"", b"", b"two ", b"three", b""], 5);
        assert_eq!((output.as_slice(), captured.bytes), (b"one two three".as_slice(), 13));
        captured.end.unwrap();
    }

    #[test]
    fn what_is_left_when_it_is_time_to_stop_is_taken_too() {
        let (output, captured) = run(&[b"one ", b"two ", b"three", b"", b"never"], 1);
        assert_eq!(output, b"one two three");
        captured.end.unwrap();
    }

    #[test]
    fn a_board_that_goes_away_is_an_error_after_what_it_said() {
        let (output, captured) = run(&[b"one ", b"", b"two"], 99);
        assert_eq!((output.as_slice(), captured.bytes), (b"one two".as_slice(), 7));
        let error = captured.end.unwrap_err();
        assert!(matches!(*error.kind, ErrorKind::Capture(CaptureKind::Unread { .. })), "{error:?}");
        assert_eq!(error.to_string(), "the channel cannot be read any more: it is gone");
    }

    #[test]
    fn a_board_that_never_rests_is_left() {
        struct Endless;
        impl Channel for Endless {
            fn read(&mut self, buffer: &mut [u8]) -> Result<usize> {
                Ok(buffer.len())
            }
        }
        let captured = capture(&mut Endless, &mut std::io::sink(), || true);
        assert_eq!(captured.bytes, 1 << 20);
        captured.end.unwrap();
    }

    #[test]
    fn an_output_that_takes_no_more_ends_it() {
        let mut output = [0; 3];
        let mut board = Fake([b"one ".as_slice()].into());
        let captured = capture(&mut board, &mut output.as_mut_slice(), || false);
        captured.end.unwrap_err();
    }
}
