//! The yaw rate of a recorded flight through every scheme, spike by spike: what `cargo demo` draws.
//!
//! A scheme begins with its name and its latency in samples. Then comes a line a sample: who fires, each as
//! polarity, neuron and slot, and the bits of the decoded value.
//!
//! ```text
//! sf 0
//!  00000000
//! +0.0 3dd4a3c1
//! ```

#![cfg_attr(target_os = "none", no_std, no_main)]

use core::fmt::{self, Write};
use flight_log::{Log, Logs};
use spikewire::{Code, Polarity, Sample};

/// The gyroscope's z axis.
const YAW: usize = 2;

fn run(out: &mut impl Write) -> fmt::Result {
    let mut printer = Printer { out, result: Ok(()) };
    flight_log::fly::<f32>(YAW, &mut printer).map_err(|_| fmt::Error)?;
    printer.result
}

struct Printer<'a, W> {
    out: &'a mut W,
    result: fmt::Result,
}

impl<W: Write> Printer<'_, W> {
    /// Nothing is printed after an error.
    fn print(&mut self, text: fmt::Arguments) {
        self.result = self.result.and_then(|()| self.out.write_fmt(text));
    }
}

impl<W: Write> Logs for Printer<'_, W> {
    type Log = Self;

    fn log(&mut self, name: &'static str, latency: usize) -> &mut Self {
        self.print(format_args!("{name} {latency}\n"));
        self
    }
}

impl<W: Write> Log for Printer<'_, W> {
    fn code(&mut self, code: &impl Code) {
        for firing in code.firings() {
            let sign = if firing.polarity == Polarity::Up { '+' } else { '-' };
            self.print(format_args!("{sign}{}.{}", firing.neuron, firing.slot));
        }
    }

    fn decoded<S: Sample>(&mut self, _: S, value: S) {
        self.print(format_args!(" {:08x}\n", (value.to_f64() as f32).to_bits()));
    }
}

#[cfg_attr(target_os = "none", board::entry)]
fn main() -> ! {
    board::finish(run(&mut board::console()))
}
