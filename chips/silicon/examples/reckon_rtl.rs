//! Compares the model of `ReckOn` with the chip's register-transfer code, clock cycle by clock cycle. Usage:
//! `reckon_rtl SIMULATION [CLOCKS [SEED]]`.
//!
//! SIMULATION is a program that simulates the register-transfer code: Verilator builds it from this code and from
//! `rtl/reckon.cpp`. The model and the simulation get the same random sessions. A session sets registers, loads a
//! network and runs samples, with faults in between. The pins and registers of the two must be equal after each clock
//! cycle and each edge of a pin. The memories of the two must be equal after each session.

use std::io::{BufReader, BufWriter, Read, Write};
use std::process::{ChildStdin, ChildStdout, Command, Stdio};

use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg32;
use silicon::ReckOn;
use silicon::reckon::{Inputs, State};

type Result<T> = std::result::Result<T, Box<dyn std::error::Error + Send + Sync>>;

/// Code of the record that asks the simulation for a digest of its memories.
const MEMORIES: u8 = 255;

struct Both {
    model: ReckOn,
    sck: bool,
    mosi: bool,
    records: Vec<u8>,
    expected: Vec<[u64; 2]>,
    random: Pcg32,
    clocks: u64,
    /// Number of times that each kind of fault was tried.
    faults: [(&'static str, u64); 10],
    states: [u64; 8],
}

#[derive(Clone, Copy)]
enum Fault {
    Truncated,
    Doubled,
    Lost,
    OutOfOrder,
    EarlyTick,
    OddHandshake,
    Reset,
    Fast,
    Pins,
    Register,
}

impl Both {
    fn below(&mut self, end: u32) -> u32 {
        (u64::from(self.random.next_u32()) * u64::from(end)).wrapping_shr(32) as u32
    }

    fn one_in(&mut self, n: u32) -> bool {
        self.below(n) == 0
    }

    fn count(&mut self, fault: Fault) {
        self.faults[fault as usize].1 += 1;
    }

    fn record(&mut self, clocks: u8) {
        let pins = self.model.inputs();
        let bits = [
            pins.reset,
            self.sck,
            self.mosi,
            pins.request,
            pins.is_target,
            pins.sample,
            pins.tick,
            pins.target_valid,
            pins.infer,
            pins.output_acknowledge,
        ];
        let bits = bits.iter().rev().fold(0_u16, |bits, &bit| bits << 1 | u16::from(bit));
        let [low, high] = bits.to_le_bytes();
        self.records.extend([low, high, pins.address, clocks]);
        self.expected.push(self.model.digest());
    }

    fn pins(&mut self, change: impl FnOnce(&mut Inputs)) {
        let mut pins = self.model.inputs();
        change(&mut pins);
        self.model.set_inputs(pins);
        self.record(0);
    }

    fn run(&mut self, clocks: u32) {
        for _ in 0..clocks {
            self.record(1);
            self.model.run(1);
            self.states[self.model.state() as usize] += 1;
            self.expected.push(self.model.digest());
        }
        self.clocks += u64::from(clocks);
    }

    fn clock_in(&mut self, bit: bool, half: u32) {
        self.mosi = bit;
        self.record(0);
        self.run(half);
        (self.sck, self.mosi) = (true, bit);
        self.model.rise(bit);
        self.record(0);
        self.run(half);
        self.sck = false;
        self.model.fall();
        self.record(0);
    }

    fn word(&mut self, word: u32, half: u32, faulty: bool) {
        for at in (0..32).rev() {
            if faulty && self.one_in(40) {
                match self.below(3) {
                    0 => return self.count(Fault::Truncated),
                    1 => {
                        self.count(Fault::Lost);
                        continue;
                    }
                    _ => {
                        self.count(Fault::Doubled);
                        self.clock_in(word >> at & 1 == 1, 1);
                    }
                }
            }
            self.clock_in(word >> at & 1 == 1, half);
        }
    }

    fn spi(&mut self, header: u32, words: &[u32], half: u32, faulty: bool) {
        self.word(header | (words.len() as u32) << 16, half, faulty);
        for &word in words {
            self.word(word, half, faulty);
        }
    }

    fn register(&mut self, register: u32, value: u32) {
        self.spi(register, &[value], 1, false);
    }

    /// Writes random values to many registers, mostly values that a network could use. In one of four calls, also
    /// writes a random word to a random register, as a fault.
    fn configure(&mut self) {
        let inputs = [1, 7, 15, 23, 40][self.below(5) as usize] + self.below(2);
        let neurons = [1, 3, 15, 17, 31][self.below(5) as usize] + u32::from(self.one_in(4));
        let outputs = [0, 1, 3, 15][self.below(4) as usize];
        let learning = [0, 0, 7, 7, 4, 1, 2, 3, 5, 6][self.below(10) as usize];
        let mut values = vec![
            (0, 1),
            (8, self.below(2)),
            (9, learning),
            (11, self.below(2)),
            (21, self.below(2)),
            (23, u32::from(self.one_in(4))),
            (25, self.below(2)),
            (26, self.below(2)),
            (27, self.below(2)),
            (30, self.below(2)),
            (31, self.below(2)),
            (32, u32::from(self.one_in(4))),
            (33, self.below(2)),
            (69, self.below(256)),
            (94, inputs),
            (95, neurons),
            (96, outputs),
            (98, self.below(200)),
            (104, self.below(16)),
            (18, self.below(16)),
        ];
        if self.one_in(3) {
            values.extend([(19, self.below(8)), (20, self.below(4))]);
        }
        for register in 12..=17 {
            values.push((register, self.below(8)));
        }
        for register in 65..=68 {
            values.push((register, self.random.next_u32()));
        }
        for register in 70..=73 {
            values.push((register, (register - 69) * self.below(400)));
        }
        for register in 74..=78 {
            values.push((register, self.below(32)));
        }
        for register in (79..=84).chain(99..=103) {
            values.push((register, self.below(32)));
        }
        for register in 85..=93 {
            values.push((register, self.random.next_u32()));
        }
        if self.one_in(8) {
            values.extend([(64, 200 + self.below(2000)), (10, 1)]);
        }
        for (register, value) in values {
            if self.one_in(4) || matches!(register, 94..=96) {
                self.register(register, value);
            }
        }
        if self.one_in(4) {
            self.count(Fault::Register);
            let (register, value) = (self.below(128), self.random.next_u32());
            self.spi(register, &[value], 1, false);
        }
    }

    fn load(&mut self) {
        let half = 1 + self.below(2);
        let neurons = self.register_of(95) / 2 + 1;
        for pair in 0..neurons {
            if self.one_in(3) {
                let words = [0, 1, 2, 3].map(|at| {
                    let word = self.random.next_u32();
                    // In seven of eight words, limits the threshold to 255, so that neurons fire.
                    if at == 3 && !self.one_in(8) { word & 0xFFF0_0FFF } else { word }
                });
                self.spi(1 << 28 | pair << 2, &words, half, false);
            }
        }
        for (code, rows) in [(3, self.register_of(94)), (4, self.register_of(95))] {
            for _ in 0..2 {
                let (row, group) = (self.below(rows + 1), self.below(neurons / 8 + 1));
                let words = [0; 4].map(|_: u32| self.random.next_u32());
                self.spi(code << 28 | row << 6 | group << 2, &words, half, false);
            }
        }
        for _ in 0..4 {
            let row = self.below(2 * neurons);
            let words = [0; 4].map(|_: u32| self.random.next_u32());
            self.spi(5 << 28 | row << 2, &words, half, false);
        }
    }

    fn register_of(&self, register: usize) -> u32 {
        self.model.register_value(register)
    }

    fn read_back(&mut self) {
        let code = 1 + self.below(5);
        let header = 1 << 31 | code << 28 | self.below(1 << 14);
        let words = vec![u32::MAX; 1 + self.below(3) as usize];
        let half = [2, 3, 5, 8][self.below(4) as usize];
        if half == 2 {
            self.count(Fault::Fast);
        }
        self.spi(header, &words, half, false);
    }

    fn event(&mut self, is_target: bool) {
        let most = if is_target || self.one_in(16) { 255 } else { self.register_of(94) };
        let address = self.below(most + 1) as u8;
        self.pins(|pins| (pins.address, pins.is_target) = (address, is_target));
        let clocks = self.below(4);
        self.run(clocks);
        self.pins(|pins| pins.request = true);
        if self.one_in(10) {
            self.count(Fault::OddHandshake);
            match self.below(3) {
                0 => self.run(1),
                1 => {
                    let address = self.below(256) as u8;
                    self.run(2);
                    self.pins(|pins| (pins.address, pins.is_target) = (address, !is_target));
                    self.run(5);
                }
                _ => {
                    self.run(40);
                    self.pins(|pins| pins.is_target = !is_target);
                }
            }
            self.pins(|pins| pins.request = false);
            let clocks = self.below(3);
            return self.run(clocks);
        }
        for _ in 0..12 {
            if self.model.outputs().acknowledge {
                break;
            }
            self.run(1);
        }
        self.pins(|pins| pins.request = false);
        let clocks = 4 + self.below(3);
        self.run(clocks);
    }

    fn tick(&mut self) {
        self.pins(|pins| pins.tick = true);
        let clocks = 3 + self.below(6);
        self.run(clocks);
        self.pins(|pins| pins.tick = false);
        if self.one_in(30) {
            self.count(Fault::EarlyTick);
            let clocks = 2 + self.below(20);
            self.run(clocks);
            self.pins(|pins| pins.tick = true);
            self.run(4);
            self.pins(|pins| pins.tick = false);
        }
    }

    /// Drives the chip's handshakes until its step is done.
    fn step(&mut self) {
        self.tick();
        let mut configured = 0;
        for _ in 0..4000 {
            self.run(1);
            match self.model.state() {
                State::GetTarget => {
                    if self.one_in(20) {
                        self.count(Fault::OutOfOrder);
                        self.event(false);
                    } else {
                        self.event(true);
                    }
                }
                State::Send => {
                    let request = self.model.outputs().request;
                    self.pins(|pins| pins.output_acknowledge = request);
                    if self.one_in(100) {
                        self.count(Fault::OddHandshake);
                        self.pins(|pins| pins.output_acknowledge = !request);
                    }
                }
                State::Config => {
                    if self.one_in(4) {
                        self.read_back();
                    }
                    self.register(0, 0);
                    configured += 1;
                    if configured == 3 {
                        break;
                    }
                }
                State::Idle => break,
                State::Prop if self.model.is_ready() => break,
                _ => {}
            }
        }
        self.pins(|pins| pins.output_acknowledge = false);
    }

    fn sample(&mut self) {
        self.pins(|pins| pins.sample = true);
        self.run(3);
        for _ in 0..2 + self.below(8) {
            for _ in 0..self.below(6) {
                self.event(false);
            }
            let (valid, infer) = (self.one_in(2), self.one_in(2));
            self.pins(|pins| (pins.target_valid, pins.infer) = (valid, infer));
            if self.one_in(12) {
                self.register(0, 1);
            }
            if self.one_in(30) {
                self.count(Fault::Pins);
                self.pins(|pins| pins.sample = !pins.sample);
            }
            self.step();
        }
        self.pins(|pins| pins.sample = false);
        self.run(3);
        self.step();
    }

    fn reset(&mut self) {
        self.pins(|pins| pins.reset = true);
        let clocks = 1 + self.below(6);
        self.run(clocks);
        self.pins(|pins| *pins = Inputs::default());
        self.run(4);
    }

    fn garbage(&mut self) {
        for _ in 0..=self.below(4) {
            let code =
                [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15][self.below(16) as usize];
            let header = code << 28 | self.random.next_u32() & 0xFFFF;
            let header = if code == 0 { header & 0x7F } else { header };
            let words: Vec<u32> = (0..self.below(3)).map(|_| self.random.next_u32()).collect();
            let half = 1 + self.below(4);
            self.spi(header, &words, half, true);
        }
    }

    fn session(&mut self) {
        if self.one_in(10) {
            self.count(Fault::OutOfOrder);
        } else {
            self.reset();
        }
        self.configure();
        self.load();
        if self.one_in(3) {
            self.read_back();
        }
        if self.one_in(6) {
            self.garbage();
        }
        if !self.one_in(8) {
            self.register(0, 0);
        }
        for _ in 0..=self.below(2) {
            self.sample();
            if self.one_in(10) {
                self.garbage();
            }
            if self.one_in(20) {
                self.count(Fault::Reset);
                self.reset();
            }
        }
    }
}

fn main() -> Result<()> {
    let mut args = std::env::args().skip(1);
    let simulation = args.next().ok_or("usage: reckon_rtl SIMULATION [CLOCKS [SEED]]")?;
    let clocks: u64 = args.next().map_or(Ok(1_000_000), |clocks| clocks.parse())?;
    let seed: u64 = args.next().map_or(Ok(1), |seed| seed.parse())?;
    let mut child =
        Command::new(&simulation).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn()?;
    let mut input = BufWriter::new(child.stdin.take().ok_or("no stdin")?);
    let mut output = BufReader::new(child.stdout.take().ok_or("no stdout")?);
    let faults = [
        "SPI cut within a word",
        "SPI clock doubled",
        "SPI clock lost",
        "calls out of order",
        "tick before its time",
        "handshake at odd times",
        "reset within a sample",
        "SPI at a quarter of the clock",
        "SAMPLE at odd times",
        "any register, any value",
    ];
    let mut both = Both {
        model: ReckOn::default(),
        sck: false,
        mosi: false,
        records: vec![],
        expected: vec![],
        random: Pcg32::seed_from_u64(seed),
        clocks: 0,
        faults: faults.map(|name| (name, 0)),
        states: [0; 8],
    };
    let (mut sessions, mut compared) = (0, 0_u64);
    while both.clocks < clocks {
        both.session();
        both.records.extend([0, 0, 0, MEMORIES]);
        both.expected.push([u64::MAX, both.model.memory_digest()]);
        compared += both.expected.len() as u64;
        exchange(&mut input, &mut output, &both)
            .map_err(|error| format!("session {sessions} of seed {seed}: {error}"))?;
        both.records.clear();
        both.expected.clear();
        sessions += 1;
    }
    drop(input);
    assert!(child.wait()?.success(), "{simulation} failed");
    println!("{sessions} sessions, {} clocks, {compared} states compared: all equal", both.clocks);
    for (name, count) in both.faults {
        println!("  {name}: {count}");
    }
    let names = ["idle", "prop", "step", "done", "target", "config", "learn", "send"];
    let states: Vec<_> =
        names.iter().zip(both.states).map(|(name, clocks)| format!("{name} {clocks}")).collect();
    println!("  clocks by state: {}", states.join(", "));
    assert!(both.states.iter().all(|&clocks| clocks > 0), "a state was never seen");
    assert!(both.faults.iter().all(|&(_, count)| count > 0), "a fault was never tried");
    Ok(())
}

fn exchange(
    input: &mut BufWriter<ChildStdin>,
    output: &mut BufReader<ChildStdout>,
    both: &Both,
) -> Result<()> {
    std::thread::scope(|scope| {
        let writer = scope.spawn(|| -> Result<()> {
            input.write_all(&both.records)?;
            Ok(input.flush()?)
        });
        let mut previous = [0; 2];
        for (at, expected) in both.expected.iter().enumerate() {
            let mut bytes = [0; 16];
            output.read_exact(&mut bytes)?;
            let [pins, digest] =
                [0, 8].map(|at| u64::from_le_bytes(std::array::from_fn(|byte| bytes[at + byte])));
            if [pins, digest] != *expected {
                return Err(format!(
                    "state {at}: model {expected:x?}, code {:x?}, before {previous:x?}",
                    [pins, digest]
                )
                .into());
            }
            previous = *expected;
        }
        writer.join().expect("no panic")
    })
}
