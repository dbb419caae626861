//! Sender, line and far end, spell by spell.

use core::fmt;

use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg32;
use spikewire::link::MAX_FRAME;

use crate::{
    far_end::FarEnd,
    line::{Fault, Line},
    sender::Sender,
};

/// Gyroscope x, y, z, then accelerometer x, y, z.
pub const CHANNELS: usize = 6;
/// Microseconds from sample to sample.
pub const PERIOD: u32 = 5_000;
/// Samples from one keyframe to the next.
const KEYFRAME_EVERY: u32 = 50;
/// Samples from one turn of main to the next.
const TURN: u32 = 4;
/// Samples of a spell with a fault, and of the one after it without: together no multiple of those between keyframes.
const SPELL: u32 = 233;
const CALM: u32 = 100;
/// Samples until a far end that starts again has the fingerprint of the sender: 2¹⁹ µs, and the next keyframe.
const FINGERPRINT: u32 = (1 << 19) / PERIOD + KEYFRAME_EVERY;
/// Samples without a frame, a second of them, after which a far end waits for a full frame, which has the fingerprint.
const LONGEST_GAP: u32 = 1_000_000 / PERIOD;
/// One of so many turns has a brown-out.
const BROWN_OUT: u32 = 16;

pub struct World {
    random: Pcg32,
    sender: Sender,
    line: Line,
    far: FarEnd,
    flown: u32,
    /// Frames that were delivered, and the sample at which the last one was.
    frames: u32,
    heard: u32,
    at: usize,
    /// What earlier starts of the sender lost and rejected.
    lost: u32,
    rejected: u32,
}

/// What became of all spells of a fault.
#[derive(Default)]
pub struct Tally {
    pub samples: u32,
    injected: u32,
    lost_frames: u32,
    damaged: u32,
    repeated: u32,
    late: u32,
    starts: u32,
    lost_items: u32,
    rejected: u32,
    exact: u32,
    /// The most samples after a spell until all channels were exact.
    recovery: u32,
}

impl fmt::Display for Tally {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} injected;", self.injected)?;
        let noticed = [
            (self.lost_frames, "frames lost"),
            (self.damaged, "damaged"),
            (self.repeated, "repeated"),
            (self.late, "late"),
            (self.starts, "starts"),
            (self.lost_items, "items lost"),
            (self.rejected, "samples rejected"),
        ];
        for (count, what) in noticed.into_iter().filter(|(count, _)| *count > 0) {
            write!(f, " {count} {what},")?;
        }
        let milliseconds = self.recovery * PERIOD / 1_000;
        write!(f, " exact again within {milliseconds} ms; {} values exact, 0 wrong", self.exact)
    }
}

impl World {
    pub fn new() -> Self {
        Self {
            random: Pcg32::seed_from_u64(1),
            sender: Sender::new(0, 1_000_000),
            line: Line::new(),
            far: FarEnd::new(),
            flown: 0,
            frames: 0,
            heard: 0,
            at: 0,
            lost: 0,
            rejected: 0,
        }
    }

    fn draw(&mut self, below: u32) -> u32 {
        self.random.next_u32() % below
    }

    /// Flies spells with the fault, and one without after each.
    pub fn fly(&mut self, fault: Fault, spells: u32) -> Result<Tally, &'static str> {
        let mut tally = Tally::default();
        let before = (self.far.told(), self.lost(), self.rejected(), self.line.harmed);
        for _ in 0..spells {
            if fault == Fault::TickWrap {
                tally.injected += 1;
                let soon = u64::from(self.draw(SPELL * PERIOD));
                self.restart_sender((1 << 32) - soon)?;
            }
            for _ in 0..SPELL {
                self.sample(Some(fault), &mut tally)?;
            }
            // The first frame of the calm comes with its first keyframe, at the latest.
            let gap = self.flown - self.heard + KEYFRAME_EVERY;
            let must_learn = fault == Fault::FarEndOut || gap > LONGEST_GAP;
            let learns = if must_learn { FINGERPRINT } else { 0 };
            self.calm(learns, &mut tally)?;
        }
        let told = self.far.told();
        tally.injected += self.line.harmed - before.3;
        tally.lost_frames = told.lost - before.0.lost;
        tally.damaged = told.damaged - before.0.damaged;
        tally.repeated = told.repeated - before.0.repeated;
        tally.late = told.late - before.0.late;
        tally.starts = told.starts - before.0.starts;
        tally.lost_items = self.lost() - before.1;
        tally.rejected = self.rejected() - before.2;
        Ok(tally)
    }

    fn lost(&self) -> u32 {
        self.lost + self.sender.lost()
    }

    fn rejected(&self) -> u32 {
        self.rejected + self.sender.rejected()
    }

    /// Until the second keyframe; by the first one all is exact, but for what main has not yet sent. A far end that must
    /// learn who sends takes so many samples longer.
    fn calm(&mut self, learns: u32, tally: &mut Tally) -> Result<(), &'static str> {
        let mut recovered = None;
        for sample in 1..=CALM + learns {
            let is_exact = self.sample(None, tally)?;
            if is_exact && recovered.is_none() {
                recovered = Some(sample);
            }
        }
        let recovered = recovered.ok_or("not exact again")?;
        // Bytes that cannot be read may look like the beginning of a short frame, whose end is in the frame after: a
        // keyframe then comes out with the frame behind it.
        if recovered > KEYFRAME_EVERY + 2 * TURN + learns {
            return Err("not exact by the next keyframe");
        }
        tally.recovery = tally.recovery.max(recovered);
        Ok(())
    }

    /// One period, and whether all channels are known to be exact after it.
    fn sample(&mut self, fault: Option<Fault>, tally: &mut Tally) -> Result<bool, &'static str> {
        self.flown += 1;
        tally.samples += 1;
        if fault == Some(Fault::Gap) {
            tally.injected += 1;
            self.sender.wait();
        } else {
            let mut samples = self.next();
            if fault == Some(Fault::NotFinite) && self.draw(2) == 0 {
                tally.injected += 1;
                let channel = self.draw(CHANNELS as u32) as usize;
                samples[channel] =
                    [f32::NAN, f32::INFINITY, f32::NEG_INFINITY][self.draw(3) as usize];
            }
            self.sender.sample(samples);
            if self.flown.is_multiple_of(KEYFRAME_EVERY) {
                self.sender.keyframe();
            }
        }
        let hangs = fault == Some(Fault::Hang);
        tally.injected += u32::from(hangs);
        if hangs || !self.flown.is_multiple_of(TURN) {
            return Ok(false);
        }
        let is_exact = self.turn(fault, tally)?;
        if self.far.frames() != self.frames {
            self.frames = self.far.frames();
            self.heard = self.flown;
        }
        Ok(is_exact)
    }

    /// The next sample of the recording, over and over.
    fn next(&mut self) -> [f32; CHANNELS] {
        const FLIGHT: &[u8] = flight_data::HEXAROTOR;
        let record = flight_data::record(FLIGHT, self.at);
        self.at = (self.at + 1) % (FLIGHT.len() / flight_data::Record::SIZE);
        record.map_or([0.0; CHANNELS], |record| record.channels)
    }

    /// Main's turn on both sides.
    fn turn(&mut self, fault: Option<Fault>, tally: &mut Tally) -> Result<bool, &'static str> {
        match fault {
            Some(Fault::SenderOut) if self.draw(BROWN_OUT) == 0 => {
                tally.injected += 1;
                let micros = u64::from(self.random.next_u32());
                self.restart_sender(micros)?;
            }
            Some(Fault::FarEndOut) if self.draw(BROWN_OUT) == 0 => {
                tally.injected += 1;
                self.far.restart();
            }
            _ => {}
        }
        let Self { random, sender, line, far, .. } = self;
        let mut buffer = [0; MAX_FRAME];
        while let Some(frame) = sender.frame(&mut buffer)? {
            far.remember(sender.starts(), frame)?;
            line.carry(frame, fault, random, |bytes| far.hear(bytes))?;
        }
        if fault.is_none() {
            line.release(|bytes| far.hear(bytes))?;
        }
        far.idle()?;
        if !sender.is_accounted_for() {
            return Err("an item is lost, untold");
        }
        let (Some(exact), Some(truth)) = (far.exact(sender.starts()), sender.truth()) else {
            return Ok(false);
        };
        for (value, truth) in exact.into_iter().zip(truth) {
            let Some(value) = value else { continue };
            if value.to_bits() != truth.to_bits() {
                return Err("a wrong value is called exact");
            }
            tally.exact += 1;
        }
        Ok(exact.iter().all(Option::is_some))
    }

    /// A brown-out: nothing survives it but the count of starts.
    fn restart_sender(&mut self, micros: u64) -> Result<(), &'static str> {
        self.line.release(|bytes| self.far.hear(bytes))?;
        self.lost += self.sender.lost();
        self.rejected += self.sender.rejected();
        self.sender = Sender::new(self.sender.starts() + 1, micros);
        Ok(())
    }
}
