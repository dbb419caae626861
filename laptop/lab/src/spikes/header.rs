//! The head of a file of spikes.

use crate::scheme::Scheme;
use anyhow::{Context, Result, anyhow, bail};
use catalogue::Parameter;
use catalogue::run::{SampleType, Settings};
use std::str::FromStr;

/// The header of a file of spikes.
#[derive(Clone, Debug, PartialEq)]
pub struct Header {
    /// The scheme.
    pub scheme: Scheme,
    /// The sample type.
    pub sample: SampleType,
    /// All parameters that decoding needs, for each channel.
    pub channels: Vec<Settings>,
    /// Samples a second, if known.
    pub rate: Option<f64>,
    /// The signal's origin, and what was calibrated; decoding needs none of it.
    pub notes: Vec<(&'static str, String)>,
}

/// The parameters from which others are made, which decoding needs.
pub fn unrecorded(scheme: Scheme) -> Vec<&'static str> {
    let parameters = scheme.info().parameters.iter();
    let is_note =
        |parameter: &&Parameter| !parameter.is_recorded || parameter.key() != parameter.name;
    parameters.filter(is_note).map(|parameter| parameter.name).collect()
}

/// The version of the format.
const VERSION: &str = "1";

/// The number of addresses.
const MOST_CHANNELS: usize = 1 << 16;

/// Keys that decoding does not need, besides parameters that others were made from.
const NOTES: [&str; 4] = ["column", "topic", "field", "latency"];

impl Header {
    /// The keys and values before the parameters.
    fn common(&self) -> Vec<(&'static str, String)> {
        let mut lines = vec![
            ("spikewire", VERSION.to_owned()),
            ("scheme", self.scheme.name().to_owned()),
            ("sample", self.sample.to_string()),
        ];
        if self.channels.len() > 1 {
            lines.push(("channels", self.channels.len().to_string()));
        }
        lines
    }

    /// The keys and values, in order. A value that channels do not share has its channel behind an `@`: `start@1`.
    pub fn lines(&self) -> Vec<(String, String)> {
        let texts = |own: &Settings| -> Vec<(&'static str, String)> {
            own.entries().iter().map(|(name, value)| (*name, value.to_string())).collect()
        };
        let all: Vec<_> = self.channels.iter().map(texts).collect();
        let shared =
            |place: usize| all.windows(2).all(|pair| pair[0].get(place) == pair[1].get(place));
        let own = |(lines, channel): (&Vec<(&'static str, String)>, usize)| {
            let own = lines.iter().enumerate().filter(|(place, _)| !shared(*place));
            own.map(|(_, (key, value))| (format!("{key}@{channel}"), value.clone()))
                .collect::<Vec<_>>()
        };
        let whole = |(key, value): &(&'static str, String)| ((*key).to_owned(), value.clone());
        let first = all.first().into_iter().flatten().enumerate();
        let mut lines: Vec<(String, String)> = self.common().iter().map(whole).collect();
        lines.extend(first.filter(|(place, _)| shared(*place)).map(|(_, line)| whole(line)));
        lines.extend(all.iter().zip(0..).flat_map(own));
        lines.extend(self.rate.map(|rate| ("rate".to_owned(), rate.to_string())));
        lines.extend(self.notes.iter().map(whole));
        lines
    }

    /// Reads the keys and values again.
    ///
    /// # Errors
    /// Returns an error if a parameter is missing, occurs twice, is not a number or does not belong to the scheme.
    pub fn parse(lines: Vec<(String, String)>) -> Result<Self> {
        let mut keys = Keys::new(lines)?;
        let version = keys.take("spikewire")?;
        if version != VERSION {
            bail!("the header says format `{version}`; this program reads {VERSION}");
        }
        let name = keys.take("scheme")?;
        let scheme = Scheme::named(&name)
            .with_context(|| format!("the header names no scheme that there is: `{name}`"))?;
        let sample = keys.take("sample")?.parse()?;
        let count: usize = keys.optional("channels")?.unwrap_or(1);
        if !(1..=MOST_CHANNELS).contains(&count) {
            bail!("the header says channels={count}; there are 1 to {MOST_CHANNELS}");
        }
        let (of_one, shared): (Vec<_>, Vec<_>) =
            keys.left.into_iter().partition(|(key, _)| key.contains('@'));
        if let Some((key, value)) = of_one.iter().find(|(key, _)| {
            let channel = key.split_once('@').and_then(|(_, channel)| channel.parse().ok());
            channel.is_none_or(|channel: usize| channel >= count)
        }) {
            bail!("the header says {key}={value}, where there are {count} channels from 0 on");
        }
        let mut channels = Vec::new();
        let mut left = shared.clone();
        for channel in 0..count {
            let suffix = format!("@{channel}");
            let own = of_one.iter().filter_map(|(key, value)| {
                Some((key.strip_suffix(&suffix)?.to_owned(), value.clone()))
            });
            let own: Vec<(String, String)> = own.collect();
            let mut keys = Keys::new([shared.clone(), own.clone()].concat())?;
            let taken = Settings::take(scheme.info(), sample, &mut keys.left);
            channels.push(taken.context("the header")?);
            if let Some((key, value)) = keys.left.iter().find(|line| own.contains(line)) {
                bail!("the header says {key}={value}, which {name} does not take");
            }
            left = keys.left;
        }
        let mut keys = Keys { left };
        let rate = keys.optional("rate")?;
        let scheme_notes = unrecorded(scheme);
        let mut notes = Vec::new();
        keys.left.retain(|(key, value)| {
            let note = scheme_notes.iter().chain(&NOTES).find(|note| *note == key);
            notes.extend(note.map(|note| (*note, value.clone())));
            note.is_none()
        });
        if let Some((key, value)) = keys.left.first() {
            bail!("the header says {key}={value}, which {name} does not take");
        }
        Ok(Self { scheme, sample, channels, rate, notes })
    }
}

fn parse<T: FromStr>(key: &str, value: &str) -> Result<T> {
    value
        .trim()
        .parse()
        .map_err(|_| anyhow!("the header says {key}={value}, which is not a number of its kind"))
}

/// Keys that are taken one after the other, so that what is left has no meaning.
struct Keys {
    left: Vec<(String, String)>,
}

impl Keys {
    fn new(lines: Vec<(String, String)>) -> Result<Self> {
        for (place, (key, value)) in lines.iter().enumerate() {
            if let Some((_, before)) = lines[..place].iter().find(|(before, _)| before == key) {
                bail!("the header contradicts itself: {key}={before}, then {key}={value}");
            }
        }
        Ok(Self { left: lines })
    }

    fn take(&mut self, key: &str) -> Result<String> {
        match self.left.iter().position(|(name, _)| name == key) {
            Some(place) => Ok(self.left.remove(place).1),
            None => bail!("the header lacks `# {key}=`; is it a file of spikes?"),
        }
    }

    fn optional<T: FromStr>(&mut self, key: &str) -> Result<Option<T>> {
        let place = self.left.iter().position(|(name, _)| name == key);
        place.map(|place| parse(key, &self.left.remove(place).1)).transpose()
    }
}
