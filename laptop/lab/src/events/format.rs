//! Event formats by name. Parses a name such as `evt2` or `edvs:e2,up=0`, and makes a reader or writer of the format.

use super::bytes::{self, Hooks};
use super::eieio::{self, Board};
use super::{EventReader, EventWriter, EventsKind, LinkReader, csv, link};
use crate::{Error, Result};
use catalogue::run::SampleType;
use spikewire::Tick;
use spikewire::link::Coding;
use spikewire_cameras::format::{Edvs, EdvsTime, EventStream, Evt2};
use std::fmt;
use std::num::NonZeroU32;
use std::str::FromStr;

/// An event format and its settings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Link frames (packets of events from a sender), the format of `spikewire::link`. The [`Coding`] matters only to a
    /// writer.
    Link(Coding),
    /// The format of eDVS event cameras, with the encoding of the events' times.
    Edvs(Edvs, EdvsTime),
    /// Event Stream, in a file `.es`.
    EventStream,
    /// EVT2, in a file `.raw`.
    Evt2,
    /// EIEIO, the datagrams of `SpiNNaker` boards.
    Eieio(Board),
    /// A table of events in CSV.
    Csv,
}

impl Format {
    /// Makes a reader of the format; `file` is the name of the input in errors.
    pub fn reader(self, file: &str) -> Box<dyn EventReader> {
        match self {
            Self::Link(_) => Box::new(LinkReader::new(None)),
            Self::Edvs(edvs, time) => {
                let is_timed = time != EdvsTime::None;
                let set_arrival: fn(&mut _, Tick) =
                    spikewire_cameras::format::EdvsDecoder::set_tick;
                let hooks =
                    Hooks { check: |_| Ok(()), set_arrival: (!is_timed).then_some(set_arrival) };
                Box::new(bytes::Reader::new(edvs.decoder(), hooks))
            }
            Self::EventStream => {
                let check: fn(&spikewire_cameras::format::EventStreamDecoder) -> Result<()> =
                    |decoder| {
                        if decoder.is_foreign() {
                            return Err(EventsKind::NotAnEventStream.into());
                        }
                        Ok(())
                    };
                let hooks = Hooks { check, set_arrival: None };
                Box::new(bytes::Reader::new(EventStream::decoder(), hooks))
            }
            Self::Evt2 => {
                let hooks = Hooks { check: |_| Ok(()), set_arrival: None };
                Box::new(bytes::Reader::new(Evt2::file_decoder(), hooks))
            }
            Self::Eieio(board) => Box::new(eieio::Reader::new(board)),
            Self::Csv => Box::new(csv::Reader::new(file)),
        }
    }

    /// Makes a writer of the format. If `drops` is true, the writer drops and counts events that the format cannot
    /// express. If `drops` is false, such an event is an error.
    pub fn writer(self, drops: bool) -> Box<dyn EventWriter> {
        match self {
            Self::Link(coding) => Box::new(link::Writer::new(coding)),
            Self::Edvs(edvs, _) => {
                Box::new(bytes::Writer::new(edvs.encoder(), edvs.decoder(), &[], drops))
            }
            Self::EventStream => Box::new(bytes::Writer::new(
                EventStream::encoder(),
                EventStream::decoder(),
                &EventStream::HEADER,
                drops,
            )),
            Self::Evt2 => Box::new(bytes::Writer::new(
                Evt2::encoder(),
                Evt2::file_decoder(),
                Evt2::HEADER,
                drops,
            )),
            Self::Eieio(board) => Box::new(eieio::Writer::new(board, drops)),
            Self::Csv => Box::new(csv::Writer::new(None)),
        }
    }
}

/// Makes a writer of a table of decoded values; `sample` is their sample type.
pub fn values_writer(sample: SampleType) -> Box<dyn EventWriter> {
    Box::new(csv::Writer::new(Some(sample)))
}

/// Writes the format's name without its settings, such as `edvs:e2`.
impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Link(_) => "link",
            Self::Edvs(_, EdvsTime::None) => "edvs:e0",
            Self::Edvs(_, EdvsTime::Delta) => "edvs:e1",
            Self::Edvs(_, EdvsTime::Bits16) => "edvs:e2",
            Self::Edvs(_, EdvsTime::Bits24) => "edvs:e3",
            Self::Edvs(_, EdvsTime::Bits32) => "edvs:e4",
            Self::EventStream => "es",
            Self::Evt2 => "evt2",
            Self::Eieio(_) => "eieio",
            Self::Csv => "csv",
        })
    }
}

/// Names of the formats, as [`Format`] parses them.
pub(crate) const NAMES: &str = "link, edvs:e0 to edvs:e4, es, evt2, eieio, csv";

impl FromStr for Format {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        let (name, settings) = text.split_once(',').unwrap_or((text, ""));
        let mut settings = Settings::new(settings)?;
        let format = match name {
            "link" => {
                let channels = settings.number("channels", 8)?;
                let period = settings.number("period", 1_000)?;
                let jitter: u8 = settings.number("jitter", 0)?;
                if period == 0 || jitter > 15 {
                    return Err(EventsKind::PeriodOrJitter { text: text.to_owned() }.into());
                }
                Self::Link(Coding::for_channels(channels, period).with_jitter_bits(jitter))
            }
            "edvs" => return Err(EventsKind::TimesOfEdvs.into()),
            "edvs:e0" => edvs(EdvsTime::None, &mut settings)?,
            "edvs:e1" => edvs(EdvsTime::Delta, &mut settings)?,
            "edvs:e2" => edvs(EdvsTime::Bits16, &mut settings)?,
            "edvs:e3" => edvs(EdvsTime::Bits24, &mut settings)?,
            "edvs:e4" => edvs(EdvsTime::Bits32, &mut settings)?,
            "es" => Self::EventStream,
            "evt2" => Self::Evt2,
            "eieio" => {
                let base = settings.number("base", 0)?;
                let step = NonZeroU32::new(settings.number("step", 1_000)?)
                    .ok_or_else(|| EventsKind::Step { text: text.to_owned() })?;
                let is_signed = settings.bit("signed", false)?;
                Self::Eieio(Board { base, step, is_signed })
            }
            "csv" => Self::Csv,
            _ => return Err(EventsKind::NoFormat { name: name.to_owned() }.into()),
        };
        settings.end(name)?;
        Ok(format)
    }
}

fn edvs(time: EdvsTime, settings: &mut Settings) -> Result<Format> {
    let edvs = Edvs::new(time);
    let edvs = if settings.bit("up", true)? { edvs } else { edvs.with_up_as_zero() };
    Ok(Format::Edvs(edvs, time))
}

/// The `key=value` pairs of a format's text that have not been read yet.
struct Settings<'a>(Vec<(&'a str, &'a str)>);

impl<'a> Settings<'a> {
    fn new(text: &'a str) -> Result<Self> {
        let pairs = text.split(',').filter(|pair| !pair.is_empty());
        let pairs = pairs.map(|pair| {
            pair.split_once('=').ok_or_else(|| EventsKind::NoPair { pair: pair.to_owned() })
        });
        Ok(Self(pairs.collect::<Result<_, _>>()?))
    }

    /// Removes the pair with the key `key`, and returns the pair's value. The value is a decimal number, or a
    /// hexadecimal number that starts with `0x`. Returns `otherwise` if the key is missing.
    fn number<N: TryFrom<u32>>(&mut self, key: &str, otherwise: N) -> Result<N> {
        let Some(place) = self.0.iter().position(|pair| pair.0 == key) else {
            return Ok(otherwise);
        };
        let (_, text) = self.0.remove(place);
        let number = match text.strip_prefix("0x") {
            Some(digits) => u32::from_str_radix(digits, 16),
            None => text.parse(),
        };
        let number = number.ok().and_then(|number| number.try_into().ok());
        let (key, text) = (key.to_owned(), text.to_owned());
        number.ok_or_else(|| EventsKind::OutOfRange { key, text }.into())
    }

    /// Removes the pair with the key `key`, and returns whether its value is 1. Returns `otherwise` if the key is
    /// missing.
    ///
    /// # Errors
    /// Returns an error if the value is neither 0 nor 1.
    fn bit(&mut self, key: &str, otherwise: bool) -> Result<bool> {
        match self.number::<u32>(key, otherwise.into())? {
            bit @ 0..=1 => Ok(bit == 1),
            number => Err(EventsKind::NotABit { key: key.to_owned(), number }.into()),
        }
    }

    fn end(self, name: &str) -> Result<()> {
        match self.0.first() {
            Some((key, _)) => {
                let (format, key) = (name.to_owned(), (*key).to_owned());
                Err(EventsKind::TakesNoKey { format, key }.into())
            }
            None => Ok(()),
        }
    }
}
