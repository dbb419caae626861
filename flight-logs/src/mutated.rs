//! Reads a thousand damaged logs of each format. Reading them may fail, but must not panic.

use super::made::{KINDS, Kind, blackbox, dataflash, dataflash_text, tlog};
use super::{Damage, Kind as LogKind, Reading, Result};
use std::fs;
use std::path::Path;

/// Linear congruential generator of random numbers, with the current state.
struct Random(u32);

impl Random {
    fn below(&mut self, end: usize) -> usize {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (self.0 >> 8) as usize % end
    }

    /// Damages a log one to five times, at random: changes or removes bytes, or truncates the log.
    fn damage(&mut self, log: &mut Vec<u8>) {
        /// Approximate number of bytes before the first message. Half of the damage is placed in these bytes, and half
        /// anywhere in the log.
        const HEAD: usize = 700;
        for _ in 0..=self.below(4) {
            let within = if self.below(2) == 0 { log.len().min(HEAD) } else { log.len() };
            let at = self.below(within);
            match self.below(5) {
                0 => log[at] = self.below(256) as u8,
                1 => log[at] ^= 1 << self.below(8),
                2 => log.truncate(at.max(16)),
                3 => drop(log.drain(at..(at + self.below(16)).min(log.len()))),
                _ => log[at] = 0xff,
            }
        }
    }
}

/// Reads a log to its end; returns an error at the first damage.
fn read_through(path: &Path, kind: LogKind) -> Result<()> {
    let mut log = Reading::open(path, kind, Damage::Refuse)?;
    while log.advance()? {}
    Ok(())
}

#[test]
fn a_thousand_damaged_logs_of_each_kind_panic_nowhere() {
    let directory = tempfile::tempdir().unwrap();
    let mut random = Random(1);
    let packed = |made: Kind| made.packings().iter().map(|how| made.log(how)).collect();
    let mut all: Vec<(&str, Vec<Vec<u8>>)> =
        KINDS.into_iter().map(|made| (made.name(), packed(made))).collect();
    all.push(("log.bbl", vec![blackbox()]));
    all.push(("log.bin", vec![dataflash()]));
    all.push(("log.log", vec![dataflash_text().into_bytes()]));
    all.push(("log.tlog", vec![tlog()]));
    for (name, logs) in all {
        let (mut read, mut refused) = (0, 0);
        for round in 0..1000 {
            let mut log = logs[round % logs.len()].clone();
            random.damage(&mut log);
            let path = directory.path().join(name);
            fs::write(&path, &log).unwrap();
            let Some(kind) = LogKind::of(&path).unwrap() else { continue };
            // Each log is read with damage refused, and with damage skipped.
            refused += u32::from(read_through(&path, kind).is_err());
            let Ok(mut log) = Reading::open(&path, kind, Damage::Skip) else { continue };
            while let Ok(true) = log.advance() {
                for field in ["rate", "few[0]", "gyroADC[0]", "GyrX", "x[31]", "zmag"] {
                    read += u32::from(log.number(field).is_ok());
                }
                let _ = (log.text("header.frame_id"), log.time());
            }
        }
        assert!(read > 10_000 && refused > 100, "{name}: {read} numbers, {refused} refused");
    }
}
