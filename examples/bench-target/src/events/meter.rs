//! Adds up what was counted, and prints it.

use core::{fmt, hint::black_box};

use board::stopwatch::{Count, counted, keep};
use spikewire::Event;

use crate::measure::print_count;

/// What one direction of a subject cost.
#[derive(Default)]
pub struct Cost {
    /// Events, or sets of samples.
    count: u32,
    total: Count,
    /// Of the worst one; where many go together, of the worst batch's mean.
    max: Count,
    bytes: u32,
    /// Of a call of an empty function, once it is known.
    pub call: Option<Count>,
}

impl Cost {
    /// Counts a call that makes bytes of an event, and keeps what it gave.
    pub fn encoding<F, R>(
        &mut self,
        work: &mut F,
        event: Event,
        bytes: &mut [u8],
        given: &mut R,
    ) -> Count
    where
        F: FnMut(Event, &mut [u8]) -> R,
    {
        let event = black_box(&event);
        let empty = *self.call.get_or_insert_with(|| counted(|| take(work, event, bytes)));
        counted(|| *given = encode(work, event, bytes)).saturating_sub(empty)
    }

    /// Counts a call that reads bytes, and keeps what it gave.
    pub fn decoding<F, R>(&mut self, work: &mut F, bytes: &[u8], given: &mut R) -> Count
    where
        F: FnMut(&[u8]) -> R,
    {
        let bytes = black_box(bytes);
        let empty = *self.call.get_or_insert_with(|| counted(|| take(work, bytes, &())));
        counted(|| *given = decode(work, bytes)).saturating_sub(empty)
    }

    pub fn add(&mut self, count: usize, bytes: usize, cost: Count) {
        let count = count as u32;
        self.count += count;
        self.total += cost;
        self.max = self.max.max(cost.div_ceil(count.max(1)));
        self.bytes += bytes as u32;
    }

    /// A line of JSON, of an event or a set of samples.
    pub fn print(
        &self,
        out: &mut impl fmt::Write,
        (subject, direction): (&str, &str),
        sample: Option<&str>,
        per: &str,
    ) -> fmt::Result {
        let Self { count, total, max, bytes, .. } = self;
        write!(out, r#"{{"subject":"{subject}","direction":"{direction}","per":"{per}","#)?;
        if let Some(sample) = sample {
            write!(out, r#""sample":"{sample}","#)?;
        }
        print_count(out, "total", total)?;
        print_count(out, "max", max)?;
        writeln!(out, r#""count":{count},"bytes":{bytes}}}"#)
    }

    /// A line of JSON, of an event.
    pub fn print_event(
        &self,
        out: &mut impl fmt::Write,
        subject: &str,
        direction: &str,
    ) -> fmt::Result {
        self.print(out, (subject, direction), None, "event")
    }
}

#[inline(never)]
fn encode<R>(work: &mut impl FnMut(Event, &mut [u8]) -> R, event: &Event, bytes: &mut [u8]) -> R {
    work(*event, bytes)
}

#[inline(never)]
fn decode<R>(work: &mut impl FnMut(&[u8]) -> R, bytes: &[u8]) -> R {
    work(bytes)
}

/// Takes what the others take, and does nothing.
#[inline(never)]
pub fn take<F, A: ?Sized, B: ?Sized>(work: &mut F, a: &A, b: &B) {
    keep(work);
    keep(a);
    keep(b);
}
