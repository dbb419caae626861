//! `spikewire decode`: spikes back to values, in constant memory.

use crate::codec::{Codec, Event};
use crate::output::Output;
use crate::sample_type::SampleType;
use crate::spikes::{Item, Reader};
use anyhow::{Context, Result, anyhow};
use clap::Args;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Write};
use std::path::{Path, PathBuf};

/// Decode a file of spikes.
#[derive(Args, Debug)]
pub(crate) struct Decode {
    /// File of spikes; `-` is standard input
    #[arg(default_value = "-")]
    spikes: PathBuf,
    /// CSV file `index,value`; standard output unless given
    #[arg(short, long)]
    output: Option<PathBuf>,
}

/// Runs the command.
///
/// # Errors
/// The file of spikes or the output are not good.
pub(crate) fn run(options: &Decode) -> Result<()> {
    const BUFFER: usize = 1 << 18;
    let output = |path| Output::open(path);
    if options.spikes == Path::new("-") {
        let input = BufReader::with_capacity(BUFFER, io::stdin().lock());
        return decode(input, "standard input", || output(options.output.as_deref()));
    }
    let name = options.spikes.display().to_string();
    let file = File::open(&options.spikes).with_context(|| format!("{name}: cannot be opened"))?;
    let input = BufReader::with_capacity(BUFFER, file);
    decode(input, &name, || output(options.output.as_deref()))
}

fn decode(input: impl BufRead, file: &str, open: impl FnOnce() -> Result<Output>) -> Result<()> {
    /// How many events are taken together.
    const BATCH: usize = 4096;
    let (mut reader, header) = Reader::open(input, file)?;
    let codec = Codec::new(header.sample, &header.settings).with_context(|| file.to_owned())?;
    let mut decoding = Decoding::new(codec, header.sample, open()?)?;
    let mut events: Vec<Event> = Vec::new();
    loop {
        let decoded = match reader.next()? {
            Item::Event(event) => {
                // Events of one sample stay together.
                let is_next = events.last().is_some_and(|last| last.sample < event.sample);
                let decoded = if events.len() >= BATCH && is_next {
                    decoding.advance(event.sample, &mut events)
                } else {
                    Ok(())
                };
                events.push(event);
                decoded
            }
            Item::Rejected { first, count } => {
                decoding.advance(first, &mut events).and_then(|()| decoding.skip(count))
            }
            Item::End { samples } => {
                decoding
                    .advance(samples, &mut events)
                    .map_err(|error| error.at(&reader.place()))?;
                return decoding.output.finish();
            }
        };
        decoded.map_err(|error| error.at(&reader.place()))?;
    }
}

/// Values in the making.
struct Decoding {
    codec: Codec,
    output: Output,
    is_single: bool,
    /// The next sample, as the file counts.
    next: u64,
    /// How many were skipped before.
    skipped: u64,
    values: Vec<f64>,
    line: Vec<u8>,
}

enum Failure {
    Code(Event),
    Output(io::Error),
}

impl Failure {
    fn at(self, place: &str) -> anyhow::Error {
        match self {
            Self::Code(event) => {
                anyhow!(
                    "{place} or before: sample {} has events that no encoder emits together",
                    event.sample
                )
            }
            Self::Output(error) => error.into(),
        }
    }
}

impl Decoding {
    fn new(codec: Codec, sample: SampleType, mut output: Output) -> Result<Self> {
        output.write_all(b"index,value\n")?;
        let is_single = sample == SampleType::F32;
        Ok(Self {
            codec,
            output,
            is_single,
            next: 0,
            skipped: 0,
            values: Vec::new(),
            line: Vec::new(),
        })
    }

    /// Decodes up to this sample, which takes all events.
    fn advance(&mut self, end: u64, events: &mut Vec<Event>) -> Result<(), Failure> {
        const MOST: u64 = 8192;
        for event in events.iter_mut() {
            event.sample = event.sample.saturating_sub(self.skipped);
        }
        let mut left = events.as_slice();
        while self.next < end {
            let count = (end - self.next).min(MOST);
            let stop = self.next - self.skipped + count;
            let (now, later) = left.split_at(left.partition_point(|event| event.sample < stop));
            self.values.clear();
            self.codec.decode(count as usize, now, &mut self.values).map_err(|event| {
                Failure::Code(Event { sample: event.sample + self.skipped, ..event })
            })?;
            self.write().map_err(Failure::Output)?;
            left = later;
        }
        events.clear();
        Ok(())
    }

    /// What the encoder never saw has no value.
    fn skip(&mut self, count: u64) -> Result<(), Failure> {
        for index in self.next..self.next + count {
            writeln!(self.output, "{index},NaN").map_err(Failure::Output)?;
        }
        self.next += count;
        self.skipped += count;
        Ok(())
    }

    fn write(&mut self) -> io::Result<()> {
        self.line.clear();
        let (mut whole, mut decimals) = (itoa::Buffer::new(), zmij::Buffer::new());
        for &value in &self.values {
            self.line.extend(whole.format(self.next).as_bytes());
            self.line.push(b',');
            let text =
                if self.is_single { decimals.format(value as f32) } else { decimals.format(value) };
            self.line.extend(text.as_bytes());
            self.line.push(b'\n');
            self.next += 1;
        }
        self.output.write_all(&self.line)
    }
}
