//! Event formats by name. Parses a name such as `evt2` or `edvs:e2,up=0`, and makes a reader or writer of the format.

use super::bytes;
use super::eieio::{self, Board};
use super::prophesee::{self, Version};
use super::{EventReader, EventWriter, EventsKind, LinkReader, Size, csv, dvs, link, pixels};
use crate::{Error, Result};
use catalogue::run::SampleType;
use spikewire::Tick;
use spikewire::link::Coding;
use spikewire_cameras::format::{Edvs, EdvsTime, Evt21Order};
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
    EventStream {
        /// The size of the camera's picture, for a writer of events that have columns and rows.
        size: Option<Size>,
    },
    /// EVT2, in a file `.raw`.
    Evt2 {
        /// As for [`EventStream`](Self::EventStream).
        size: Option<Size>,
        /// Whether words without a header have columns and rows, and no addresses.
        has_pixels: bool,
    },
    /// EVT 2.1, in a file `.raw`; read only.
    Evt21 {
        /// The order of the bytes in a word. By default, the header says it, or the words show it.
        order: Option<Evt21Order>,
    },
    /// EVT3, in a file `.raw`.
    Evt3 {
        /// As for [`EventStream`](Self::EventStream).
        size: Option<Size>,
    },
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
                let set_arrival = (!is_timed).then_some(set_arrival);
                Box::new(bytes::Reader::new(edvs.decoder(), set_arrival))
            }
            Self::EventStream { .. } => Box::<dvs::Reader>::default(),
            Self::Evt2 { has_pixels, .. } => {
                Box::new(prophesee::Reader::new(Version::Evt2, has_pixels))
            }
            Self::Evt21 { order } => Box::new(prophesee::Reader::of_evt21(order)),
            Self::Evt3 { .. } => Box::new(prophesee::Reader::new(Version::Evt3, false)),
            Self::Eieio(board) => Box::new(eieio::Reader::new(board)),
            Self::Csv => Box::new(csv::Reader::new(file)),
        }
    }

    /// Makes a writer of the format. If `drops` is true, the writer drops and counts events that the format cannot
    /// express. If `drops` is false, such an event is an error.
    ///
    /// # Errors
    /// Returns an error if the format is read only.
    pub fn writer(self, drops: bool) -> Result<Box<dyn EventWriter>> {
        Ok(match self {
            Self::Link(coding) => Box::new(link::Writer::new(coding)),
            Self::Edvs(edvs, _) => {
                Box::new(bytes::Writer::new(edvs.encoder(), edvs.decoder(), vec![], drops))
            }
            Self::EventStream { size } => {
                Box::new(pixels::Writer::new(pixels::Format::EventStream, size, drops))
            }
            Self::Evt2 { size, .. } => {
                Box::new(pixels::Writer::new(pixels::Format::Evt2, size, drops))
            }
            Self::Evt21 { .. } => {
                return Err(EventsKind::ReadOnly { format: self.to_string() }.into());
            }
            Self::Evt3 { size } => Box::new(pixels::Writer::new(pixels::Format::Evt3, size, drops)),
            Self::Eieio(board) => Box::new(eieio::Writer::new(board, drops)),
            Self::Csv => Box::new(csv::Writer::new(None)),
        })
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
            Self::EventStream { .. } => "es",
            Self::Evt2 { .. } => "evt2",
            Self::Evt21 { .. } => "evt21",
            Self::Evt3 { .. } => "evt3",
            Self::Eieio(_) => "eieio",
            Self::Csv => "csv",
        })
    }
}

/// Names of the formats, as [`Format`] parses them.
pub(crate) const NAMES: &str = "link, edvs:e0 to edvs:e4, es, evt2, evt21, evt3, eieio, csv";

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
                let step_bits: u8 = settings.number("step-bits", 0)?;
                if !(1..=Coding::LONGEST_PERIOD).contains(&period) || jitter > 15 || step_bits > 4 {
                    return Err(EventsKind::PeriodOrJitter { text: text.to_owned() }.into());
                }
                let coding = Coding::for_channels(channels, period);
                Self::Link(coding.with_jitter_bits(jitter).with_step_bits(step_bits))
            }
            "edvs" => return Err(EventsKind::TimesOfEdvs.into()),
            "edvs:e0" => edvs(EdvsTime::None, &mut settings)?,
            "edvs:e1" => edvs(EdvsTime::Delta, &mut settings)?,
            "edvs:e2" => edvs(EdvsTime::Bits16, &mut settings)?,
            "edvs:e3" => edvs(EdvsTime::Bits24, &mut settings)?,
            "edvs:e4" => edvs(EdvsTime::Bits32, &mut settings)?,
            "es" => Self::EventStream { size: settings.size()? },
            "evt2" => {
                let size = settings.size()?;
                Self::Evt2 { size, has_pixels: settings.bit("pixels", false)? }
            }
            "evt21" => {
                let order = match settings.optional_bit("legacy")? {
                    None => None,
                    Some(true) => Some(Evt21Order::Halves),
                    Some(false) => Some(Evt21Order::Little),
                };
                Self::Evt21 { order }
            }
            "evt3" => Self::Evt3 { size: settings.size()? },
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

    /// As [`bit`](Self::bit). Returns `None` if the key is missing.
    fn optional_bit(&mut self, key: &str) -> Result<Option<bool>> {
        if !self.0.iter().any(|pair| pair.0 == key) {
            return Ok(None);
        }
        self.bit(key, false).map(Some)
    }

    /// Removes the pairs `width` and `height`, and returns them if they are there.
    fn size(&mut self) -> Result<Option<Size>> {
        let size = Size { width: self.number("width", 0)?, height: self.number("height", 0)? };
        match size {
            Size { width: 0, height: 0 } => Ok(None),
            Size { width: 0, .. } | Size { height: 0, .. } => Err(EventsKind::HalfASize.into()),
            size => Ok(Some(size)),
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
