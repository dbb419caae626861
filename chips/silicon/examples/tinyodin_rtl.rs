//! Runs the steps of a network on tinyODIN's register-transfer code, and prints the outputs that fire in each step.
//! (The command `spikewire network --live` does the same on the chip's model.)
//!
//! Usage: `tinyodin_rtl SIMULATION NETWORK.rs NETWORK.bytes < STEPS`.
//!
//! SIMULATION is a program that simulates the register-transfer code: Verilator builds it from this code and from
//! `rtl/tinyodin.cpp`. The network's two files are those that `spikewire network --compare step` writes. For each call
//! of the driver, this program changes pins and runs the clock exactly as the command does for the model. Therefore
//! simulation and model must give the same spikes after the same number of clock cycles.

use std::cell::RefCell;
use std::fs;
use std::io::{self, BufRead, BufReader, BufWriter, Read, Write};
use std::process::{ChildStdin, ChildStdout, Command, Stdio};
use std::rc::Rc;

use embedded_hal::delay::DelayNs;
use embedded_hal::spi::{ErrorKind, ErrorType, Operation, SpiDevice};
use spikewire_chips::{
    AerPort, Describe, Input, NetworkBytes, Steps, StepsLayer, StepsState, TinyOdin, TinyOdinInput,
};

type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

/// Number of the chip's clock cycles in one SPI clock cycle.
const RATIO: u16 = 4;

struct Simulation {
    records: BufWriter<ChildStdin>,
    outputs: BufReader<ChildStdout>,
    /// Levels of the pins RST, SCK, MOSI, `AERIN_REQ` and `AEROUT_ACK`, from bit 0 on.
    pins: u8,
    word: u16,
    clocks: u64,
}

const RST: u8 = 0;
const SCK: u8 = 1;
const MOSI: u8 = 2;
const REQUEST: u8 = 3;
const ACKNOWLEDGE: u8 = 4;

impl Simulation {
    fn set(&mut self, pin: u8, is_high: bool) {
        self.pins = self.pins & !(1 << pin) | u8::from(is_high) << pin;
    }

    fn send(&mut self, clocks: u16, asks: bool) -> io::Result<()> {
        self.clocks += u64::from(clocks);
        let ([low, high], [few, many]) = (self.word.to_le_bytes(), clocks.to_le_bytes());
        self.records.write_all(&[self.pins | u8::from(asks) << 7, low, high, few, many])
    }

    /// Runs the chip for `clocks` clock cycles, and returns its output pins and its output bus.
    fn read(&mut self, clocks: u16) -> io::Result<[u8; 2]> {
        self.send(clocks, true)?;
        self.records.flush()?;
        let mut outputs = [0; 2];
        self.outputs.read_exact(&mut outputs)?;
        Ok(outputs)
    }

    fn bit(&mut self, bit: bool) -> io::Result<bool> {
        let [outputs, _] = self.read(RATIO / 2)?;
        self.set(MOSI, bit);
        self.send(0, false)?;
        self.set(SCK, true);
        self.send(RATIO / 2, false)?;
        self.set(SCK, false);
        self.send(0, false)?;
        Ok(outputs & 1 == 1)
    }
}

#[derive(Clone)]
struct Rtl(Rc<RefCell<Simulation>>);

impl ErrorType for Rtl {
    type Error = ErrorKind;
}

impl SpiDevice for Rtl {
    fn transaction(
        &mut self,
        operations: &mut [Operation<'_, u8>],
    ) -> std::result::Result<(), ErrorKind> {
        let mut chip = self.0.borrow_mut();
        let mut byte = |byte: u8| -> io::Result<u8> {
            (0..8)
                .rev()
                .try_fold(0, |out, at| Ok(out << 1 | u8::from(chip.bit(byte >> at & 1 == 1)?)))
        };
        for operation in operations {
            match operation {
                Operation::Write(bytes) => {
                    for sent in *bytes {
                        byte(*sent).map_err(|_| ErrorKind::Other)?;
                    }
                }
                Operation::TransferInPlace(bytes) => {
                    for place in bytes.iter_mut() {
                        *place = byte(*place).map_err(|_| ErrorKind::Other)?;
                    }
                }
                _ => return Err(ErrorKind::Other),
            }
        }
        Ok(())
    }
}

impl Rtl {
    /// Runs the chip for one clock cycle, and then changes pins.
    fn change(&mut self, change: impl FnOnce(&mut Simulation)) -> io::Result<()> {
        let mut chip = self.0.borrow_mut();
        chip.send(1, false)?;
        change(&mut chip);
        chip.send(0, false)
    }

    fn ask(&mut self, clocks: u16, bit: u8) -> io::Result<bool> {
        Ok(self.0.borrow_mut().read(clocks)?[0] >> bit & 1 == 1)
    }
}

impl AerPort for Rtl {
    type Error = io::Error;

    fn set_input(&mut self, word: u32) -> io::Result<()> {
        self.change(|chip| chip.word = word as u16)
    }

    fn set_input_request(&mut self, is_high: bool) -> io::Result<()> {
        self.change(|chip| chip.set(REQUEST, is_high))
    }

    fn input_acknowledge(&mut self) -> io::Result<bool> {
        self.ask(1, 1)
    }

    fn output_request(&mut self) -> io::Result<bool> {
        self.ask(1, 2)
    }

    fn output(&mut self) -> io::Result<u8> {
        Ok(self.0.borrow_mut().read(1)?[1])
    }

    fn set_output_acknowledge(&mut self, is_high: bool) -> io::Result<()> {
        self.change(|chip| chip.set(ACKNOWLEDGE, is_high))
    }

    fn set_reset(&mut self, is_high: bool) -> io::Result<()> {
        self.change(|chip| chip.set(RST, is_high))
    }

    fn queue_full(&mut self) -> io::Result<Option<bool>> {
        self.ask(0, 3).map(Some)
    }
}

impl DelayNs for Rtl {
    fn delay_ns(&mut self, ns: u32) {
        for _ in 0..ns.div_ceil(100) {
            self.0.borrow_mut().send(1, false).expect("the simulation runs");
        }
    }
}

/// Finds the line of the field `name` in `source`, and splits the field's value at each `[`. Returns the numbers in
/// each part: a plain number gives one part, and each `[` one more.
fn lists(source: &str, name: &str) -> Result<Vec<Vec<u16>>> {
    let start = format!("    {name}: ");
    let line = source.lines().find_map(|line| line.strip_prefix(&start)).ok_or(start.clone())?;
    let numbers = |part: &str| {
        let words = part.split(|letter: char| !letter.is_ascii_digit());
        words.filter_map(|word| word.parse().ok()).collect()
    };
    Ok(line.split('[').map(numbers).collect())
}

fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [simulation, source, bytes] = &arguments[..] else {
        return Err("usage: tinyodin_rtl SIMULATION NETWORK.rs NETWORK.bytes < STEPS".into());
    };
    let source = fs::read_to_string(source)?;
    let numbers = |name| Ok::<_, Box<dyn std::error::Error>>(lists(&source, name)?.concat());
    let number = |name| Ok::<_, Box<dyn std::error::Error>>(numbers(name)?[0]);
    let of_layers = source.split("StepsLayer {").skip(1).map(|layer| StepsLayer {
        neurons: layer
            .split(|c: char| !c.is_ascii_digit())
            .find_map(|n| n.parse().ok())
            .unwrap_or(0),
        loops: layer.split('}').next().is_some_and(|layer| layer.contains("true")),
    });
    let layers: Vec<StepsLayer> = of_layers.collect();
    let leaks = lists(&source, "leaks")?;
    let leaks: Vec<&[u16]> = leaks.iter().skip(2).map(Vec::as_slice).collect();
    let steps = Steps {
        inputs: number("inputs")?,
        has_bias: source.contains("has_bias: true"),
        rows: &numbers("rows")?,
        layers: &layers,
        rungs: number("rungs")?,
        leaks: &leaks,
        lift: number("lift")?,
        own_leaks: &numbers("own_leaks")?,
    };
    let bytes = fs::read(bytes)?;
    let network = NetworkBytes::<TinyOdinInput>::new(&bytes)?;

    let mut child =
        Command::new(simulation).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn()?;
    let (records, outputs) = (child.stdin.take(), child.stdout.take());
    let (records, outputs) = records.zip(outputs).ok_or("no pipes to the simulation")?;
    let rtl = Rtl(Rc::new(RefCell::new(Simulation {
        records: BufWriter::new(records),
        outputs: BufReader::new(outputs),
        pins: 0,
        word: 0,
        clocks: 0,
    })));
    let mut chip = TinyOdin::new(rtl.clone(), rtl.clone(), TinyOdinInput::MAX_CLOCKS);
    let mut gated = chip.reset(&mut rtl.clone()).map_err(|error| format!("{error:?}"))?;
    gated.load(&network, |_| ()).map_err(|error| format!("{error:?}"))?;
    let registers = network.registers();
    let mut running = gated.run(&registers).map_err(|error| format!("{error:?}"))?;
    let mut state = StepsState::REST;
    for line in io::stdin().lock().lines() {
        let inputs: Vec<u16> =
            line?.split_whitespace().map(str::parse).collect::<std::result::Result<_, _>>()?;
        let before = rtl.0.borrow().clocks;
        let mut fired = vec![];
        running
            .step(&steps, &mut state, inputs, |neuron| fired.extend(network.output(neuron)))
            .map_err(|error| format!("{error:?}"))?;
        while !rtl.clone().ask(0, 4)? {
            running.poll(|_| ()).map_err(|error| format!("{error:?}"))?;
        }
        fired.sort_unstable();
        let clocks = rtl.0.borrow().clocks - before;
        let words = fired.iter().map(|output| format!(" {output}"));
        println!("{clocks}{}", words.collect::<String>());
    }
    Ok(())
}
