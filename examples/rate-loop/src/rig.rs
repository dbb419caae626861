//! The chip on its board, its driver, and a twin of the driver that hears the same.

use crate::tape::{Recording, Repeating, Tape};
use board::{chip_bus::ChipBus, stopwatch::instructions};
use core::{
    fmt::{self, Write},
    num::NonZeroU32,
};
use silicon::Board;
use spikewire::{Event, FromEvents};
use spikewire_chips::{Describe, Input, TinyOdin, TinyOdinInput};

type Chip = TinyOdin<silicon::Spi<silicon::TinyOdin>, Recording<silicon::Port<silicon::TinyOdin>>>;
type Twin = TinyOdin<ChipBus, Repeating>;

/// Clocks of the chip to one of SCK: 10 MHz and 656 kHz, as an STM32F405 has it from 42 MHz.
const RATIO: u32 = 16;
/// Clocks of the chip to a look at its pins: some 34 cycles of a core at 168 MHz.
const LOOK: u32 = 2;

pub struct Rig {
    board: Board<silicon::TinyOdin>,
    chip: Chip,
    twin: Twin,
    tape: &'static Tape,
    pub cost: Cost,
}

/// What events cost so far.
#[derive(Clone, Copy, Default)]
pub struct Cost {
    events: u32,
    /// The chip's clocks until it had taken them, and until it was at rest.
    taken: Many,
    rest: Many,
    /// Instructions of the driver for the same.
    send: Many,
    wait: Many,
}

/// A sum, and the largest.
#[derive(Clone, Copy, Default)]
struct Many {
    total: u64,
    most: u64,
}

impl Many {
    fn add(&mut self, one: u64) {
        self.total += one;
        self.most = self.most.max(one);
    }
}

impl Rig {
    /// A chip that was loaded with the network and verified, and runs. Tells what that took.
    pub fn start(
        network: &impl Describe<TinyOdinInput>,
        time_step: NonZeroU32,
        tape: &'static Tape,
        name: &str,
        out: &mut impl Write,
    ) -> Result<Self, fmt::Error> {
        let board = Board::new(RATIO, LOOK);
        let port = Recording { port: board.port(), tape };
        let polls = TinyOdinInput::MAX_CLOCKS;
        let mut chip = TinyOdin::new(board.spi(), port, polls).with_time_step(time_step);
        tape.record();
        let mut gated = chip.reset(&mut board.clone()).map_err(|_| fmt::Error)?;
        gated.load(network, |_| ()).map_err(|_| fmt::Error)?;
        gated.run(&network.registers()).map_err(|_| fmt::Error)?;
        let bits = board.pins().spi_clocks;
        writeln!(
            out,
            "{name}: {} neurons, loaded and verified in {} frames, {} ms at 656 kHz",
            network.neurons(),
            bits / 40,
            bits / 656
        )?;

        tape.record();
        let port = Repeating::new(Some(tape));
        let mut twin = TinyOdin::new(ChipBus::default(), port, polls).with_time_step(time_step);
        let gated = twin.reset(&mut Repeating::new(None)).map_err(|_| fmt::Error)?;
        gated.run(&network.registers()).map_err(|_| fmt::Error)?;
        Ok(Self { board, chip, twin, tape, cost: Cost::default() })
    }

    /// Sends the events of a time step and waits until the chip is at rest.
    pub fn step(
        &mut self,
        events: &[Event],
        mut to_input: impl FnMut(Event) -> TinyOdinInput,
        mut on_output: impl FnMut(u8),
    ) -> fmt::Result {
        let clocks = || self.board.pins().chip.clocks;
        let source = || FromEvents(events.iter().copied());

        self.tape.record();
        let mut running = self.chip.running().map_err(|_| fmt::Error)?;
        let start = clocks();
        running.feed(source(), &mut to_input, &mut on_output).map_err(|_| fmt::Error)?;
        let taken = clocks();
        let mut last = taken;
        let mut timed = |neuron: u8| {
            last = clocks();
            on_output(neuron);
        };
        running.quiesce(&mut timed).map_err(|_| fmt::Error)?;
        {
            let chip = &mut self.board.pins().chip;
            chip.taken.clear();
            chip.fired.clear();
        }

        self.tape.repeat();
        let mut twin = self.twin.running().map_err(|_| fmt::Error)?;
        let (mut sent, mut rested) = (false, false);
        let send = instructions(|| sent = twin.feed(source(), &mut to_input, |_| ()).is_ok());
        let wait = instructions(|| rested = twin.quiesce(|_| ()).is_ok());
        if !sent || !rested || !self.tape.is_over() {
            return Err(fmt::Error);
        }

        let cost = &mut self.cost;
        cost.events += events.len() as u32;
        cost.taken.add(taken - start);
        cost.rest.add(last - start);
        cost.send.add(send.into());
        cost.wait.add(wait.into());
        Ok(())
    }
}

impl Cost {
    /// Of an event: time on the bus, and on a board instructions.
    pub fn print(&self, name: &str, out: &mut impl Write) -> fmt::Result {
        let Self { events, taken, rest, send, wait } = self;
        let mean = |many: &Many| tenths(many.total, *events);
        writeln!(
            out,
            "{name}: an event takes the chip {} clocks to take, {} at most, and {} to the last answer, {} at most",
            mean(taken),
            taken.most,
            mean(rest),
            rest.most
        )?;
        if cfg!(target_os = "none") {
            writeln!(
                out,
                "{name}: an event takes the core {} instructions to send, {} at most, and {} to wait for rest",
                mean(send),
                send.most,
                mean(wait)
            )?;
        }
        Ok(())
    }
}

/// A mean with one digit after the point.
pub fn tenths(total: u64, count: u32) -> Tenths {
    Tenths((10 * total + u64::from(count) / 2) / u64::from(count.max(1)))
}

pub struct Tenths(u64);

impl fmt::Display for Tenths {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}.{}", self.0 / 10, self.0 % 10)
    }
}
