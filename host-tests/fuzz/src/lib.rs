//! Targets for a fuzzer: each takes any bytes, and panics if a promise is broken.
//!
//! `cargo verify fuzz` replays the corpora and a bounded number of mutants of theirs, from a fixed seed; `cargo xtask fuzz`
//! runs them under libFuzzer, which looks for bytes that reach new code.

pub mod chips;
pub mod codecs;
pub mod files;
pub mod formats;
pub mod link;
pub mod mutate;
pub mod script;

/// What is fed with bytes.
#[derive(Clone, Copy)]
pub struct Target {
    /// The name, which its corpus has too.
    pub name: &'static str,
    /// Takes any bytes.
    pub run: fn(&[u8]),
    /// Mutants of each file of the corpus in the replay.
    pub mutants: usize,
}

const fn target(name: &'static str, run: fn(&[u8]), mutants: usize) -> Target {
    Target { name, run, mutants }
}

/// Every target.
pub const TARGETS: &[Target] = &[
    target("link", link::flight, 40),
    target("reader", link::bytes, 100),
    target("formats", formats::all, 100),
    target("chips", chips::junk, 40),
    target("codecs", codecs::reference, 40),
    target("catalogue", codecs::catalogue, 40),
    target("logs", files::logs, 40),
    target("ulog", files::ulog, 40),
    target("csv", files::csv, 40),
    target("spikes", files::spikes, 40),
    target("events", files::events, 40),
    target("toml", files::toml, 60),
    target("network", files::network, 30),
    target("video", files::video, 30),
];

/// The target of a name.
pub fn named(name: &str) -> Option<Target> {
    TARGETS.iter().copied().find(|target| target.name == name)
}
