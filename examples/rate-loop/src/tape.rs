//! What the chip's pins said in one event, to be said again: the driver's instructions are counted on the repetition,
//! without those of the model.

use alloc::{boxed::Box, vec};
use core::{cell::Cell, convert::Infallible};
use embedded_hal::delay::DelayNs;
use spikewire_chips::{AerPort, ReckOnPort};

/// The most answers of an event.
const LENGTH: usize = 8 * 1024;

pub struct Tape {
    answers: Box<[Cell<u8>]>,
    at: Cell<usize>,
    /// How many there are to be said again.
    end: Cell<usize>,
}

impl Tape {
    /// An empty one, which stays for as long as the program runs.
    pub fn new() -> &'static Self {
        let answers = vec![Cell::new(0); LENGTH].into_boxed_slice();
        Box::leak(Box::new(Self { answers, at: Cell::new(0), end: Cell::new(0) }))
    }

    /// To the start of a recording.
    pub fn record(&self) {
        self.at.set(0);
        self.end.set(0);
    }

    /// To the start of a repetition.
    pub fn repeat(&self) {
        self.end.set(self.at.replace(0));
    }

    fn is_repeating(&self) -> bool {
        self.end.get() > 0
    }

    /// Whether all of it was said again.
    pub fn is_over(&self) -> bool {
        self.at.get() == self.end.get()
    }

    fn keep(&self, answer: u8) {
        let at = self.at.get();
        self.answers[at].set(answer);
        self.at.set(at + 1);
    }

    fn next(&self) -> u8 {
        let at = self.at.get();
        self.at.set(at + 1);
        self.answers[at].get()
    }
}

/// A port whose answers are recorded.
pub struct Recording<P> {
    pub port: P,
    pub tape: &'static Tape,
}

impl<P: AerPort> Recording<P> {
    fn keep<T: Copy>(
        &self,
        answer: Result<T, P::Error>,
        byte: impl Fn(T) -> u8,
    ) -> Result<T, P::Error> {
        if let Ok(answer) = answer {
            self.tape.keep(byte(answer));
        }
        answer
    }
}

impl<P: AerPort> AerPort for Recording<P> {
    type Error = P::Error;

    fn set_input(&mut self, word: u32) -> Result<(), P::Error> {
        self.port.set_input(word)
    }

    fn set_input_request(&mut self, is_high: bool) -> Result<(), P::Error> {
        self.port.set_input_request(is_high)
    }

    fn input_acknowledge(&mut self) -> Result<bool, P::Error> {
        let answer = self.port.input_acknowledge();
        self.keep(answer, u8::from)
    }

    fn output_request(&mut self) -> Result<bool, P::Error> {
        let answer = self.port.output_request();
        self.keep(answer, u8::from)
    }

    fn output(&mut self) -> Result<u8, P::Error> {
        let answer = self.port.output();
        self.keep(answer, u8::from)
    }

    fn set_output_acknowledge(&mut self, is_high: bool) -> Result<(), P::Error> {
        self.port.set_output_acknowledge(is_high)
    }

    fn set_reset(&mut self, is_high: bool) -> Result<(), P::Error> {
        self.port.set_reset(is_high)
    }
}

/// A port that says it again, and before the first tape acknowledges at once.
pub struct Repeating {
    pub tape: Option<&'static Tape>,
    pub is_requested: bool,
}

impl Repeating {
    pub const fn new(tape: Option<&'static Tape>) -> Self {
        Self { tape, is_requested: false }
    }

    /// The tape, once there is something on it.
    fn said(&self) -> Option<&'static Tape> {
        self.tape.filter(|tape| tape.is_repeating())
    }
}

impl DelayNs for Repeating {
    fn delay_ns(&mut self, _: u32) {}
}

impl AerPort for Repeating {
    type Error = Infallible;

    fn set_input(&mut self, word: u32) -> Result<(), Infallible> {
        board::stopwatch::keep(&word);
        Ok(())
    }

    fn set_input_request(&mut self, is_high: bool) -> Result<(), Infallible> {
        self.is_requested = is_high;
        Ok(())
    }

    fn input_acknowledge(&mut self) -> Result<bool, Infallible> {
        Ok(self.said().map_or(self.is_requested, |tape| tape.next() == 1))
    }

    fn output_request(&mut self) -> Result<bool, Infallible> {
        Ok(self.said().is_some_and(|tape| tape.next() == 1))
    }

    fn output(&mut self) -> Result<u8, Infallible> {
        Ok(self.said().map_or(0, Tape::next))
    }

    fn set_output_acknowledge(&mut self, is_high: bool) -> Result<(), Infallible> {
        board::stopwatch::keep(&is_high);
        Ok(())
    }

    fn set_reset(&mut self, _: bool) -> Result<(), Infallible> {
        Ok(())
    }
}

/// A port of ReckOn that does both: its driver keeps nothing from one time step to the next, and can run it twice.
pub struct Taped<P> {
    pub port: P,
    pub tape: &'static Tape,
}

impl<P> Taped<P> {
    fn ask<E>(&mut self, ask: impl FnOnce(&mut P) -> Result<u8, E>) -> Result<u8, E> {
        if self.tape.is_repeating() {
            return Ok(self.tape.next());
        }
        let answer = ask(&mut self.port)?;
        self.tape.keep(answer);
        Ok(answer)
    }

    fn set<E>(
        &mut self,
        is_high: bool,
        set: impl FnOnce(&mut P, bool) -> Result<(), E>,
    ) -> Result<(), E> {
        if self.tape.is_repeating() {
            board::stopwatch::keep(&is_high);
            return Ok(());
        }
        set(&mut self.port, is_high)
    }
}

impl<P: ReckOnPort> ReckOnPort for Taped<P> {
    type Error = P::Error;

    fn set_input(&mut self, byte: u8, is_target: bool) -> Result<(), P::Error> {
        board::stopwatch::keep(&byte);
        self.set(is_target, |port, is_target| port.set_input(byte, is_target))
    }

    fn set_input_request(&mut self, is_high: bool) -> Result<(), P::Error> {
        self.set(is_high, P::set_input_request)
    }

    fn input_acknowledge(&mut self) -> Result<bool, P::Error> {
        self.ask(|port| port.input_acknowledge().map(u8::from)).map(|answer| answer == 1)
    }

    fn output_request(&mut self) -> Result<bool, P::Error> {
        self.ask(|port| port.output_request().map(u8::from)).map(|answer| answer == 1)
    }

    fn output(&mut self) -> Result<u8, P::Error> {
        self.ask(P::output)
    }

    fn set_output_acknowledge(&mut self, is_high: bool) -> Result<(), P::Error> {
        self.set(is_high, P::set_output_acknowledge)
    }

    fn set_sample(&mut self, is_high: bool) -> Result<(), P::Error> {
        self.set(is_high, P::set_sample)
    }

    fn set_tick(&mut self, is_high: bool) -> Result<(), P::Error> {
        self.set(is_high, P::set_tick)
    }

    fn set_target_valid(&mut self, is_high: bool) -> Result<(), P::Error> {
        self.set(is_high, P::set_target_valid)
    }

    fn set_infer(&mut self, is_high: bool) -> Result<(), P::Error> {
        self.set(is_high, P::set_infer)
    }

    fn ready(&mut self) -> Result<bool, P::Error> {
        self.ask(|port| port.ready().map(u8::from)).map(|answer| answer == 1)
    }

    fn set_reset(&mut self, is_high: bool) -> Result<(), P::Error> {
        self.set(is_high, P::set_reset)
    }
}
