//! The header of a file of spikes.

use super::SpikesKind;
use crate::Result;
use crate::scheme::Scheme;
use catalogue::Parameter;
use catalogue::run::{SampleType, Settings};
use std::str::FromStr;

/// The header of a file of spikes.
#[derive(Clone, Debug, PartialEq)]
pub struct Header {
    /// The scheme of the spikes.
    pub scheme: Scheme,
    /// The sample type of the encoder.
    pub sample: SampleType,
    /// All parameters that decoding needs, as one set for each channel.
    pub channels: Vec<Settings>,
    /// Sample rate in Hz, if known.
    pub rate: Option<f64>,
    /// Facts that decoding does not need: the origin of the signal, and parameters from which others were derived.
    pub notes: Vec<(&'static str, String)>,
}

/// Returns the names of a scheme's parameters that decoding does not need, because other parameters are derived from
/// them. A file of spikes holds these parameters as notes.
pub fn unrecorded(scheme: Scheme) -> Vec<&'static str> {
    let parameters = scheme.info().parameters.iter();
    let is_note =
        |parameter: &&Parameter| !parameter.is_recorded || parameter.key() != parameter.name;
    parameters.filter(is_note).map(|parameter| parameter.name).collect()
}

/// Version of the file format.
const VERSION: &str = "1";

/// Maximum number of channels: the number of possible addresses.
const MOST_CHANNELS: usize = 1 << 16;

/// Keys of the notes that a header of any scheme may have. Further notes depend on the scheme: [`unrecorded`] lists
/// their keys. Decoding does not need the notes.
const NOTES: [&str; 4] = ["column", "topic", "field", "latency"];

impl Header {
    /// Returns the header's keys and values that precede the parameters of the scheme.
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

    /// Returns the header's keys and values, in their order in the file. A key whose value differs between channels
    /// ends in `@` and the channel's number, such as `start@1`.
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

    /// Parses the keys and values of a header.
    ///
    /// # Errors
    /// Returns an error if a parameter is missing, occurs twice, is not a number or does not belong to the scheme.
    pub fn parse(lines: Vec<(String, String)>) -> Result<Self> {
        let mut keys = Keys::new(lines)?;
        let version = keys.take("spikewire")?;
        if version != VERSION {
            return Err(SpikesKind::OtherVersion { version, own: VERSION }.into());
        }
        let name = keys.take("scheme")?;
        let scheme =
            Scheme::named(&name).ok_or_else(|| SpikesKind::NoScheme { name: name.clone() })?;
        let sample = keys.take("sample")?.parse()?;
        let count: usize = keys.optional("channels")?.unwrap_or(1);
        if !(1..=MOST_CHANNELS).contains(&count) {
            return Err(SpikesKind::Channels { count, most: MOST_CHANNELS }.into());
        }
        let (of_one, shared): (Vec<_>, Vec<_>) =
            keys.left.into_iter().partition(|(key, _)| key.contains('@'));
        if let Some((key, value)) = of_one.iter().find(|(key, _)| {
            let channel = key.split_once('@').and_then(|(_, channel)| channel.parse().ok());
            channel.is_none_or(|channel: usize| channel >= count)
        }) {
            let (key, value) = (key.clone(), value.clone());
            return Err(SpikesKind::NoSuchChannel { key, value, channels: count }.into());
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
            channels.push(Settings::take(scheme.info(), sample, &mut keys.left)?);
            if let Some((key, value)) = keys.left.iter().find(|line| own.contains(line)) {
                let (key, value) = (key.clone(), value.clone());
                return Err(SpikesKind::TakesNo { key, value, scheme: name }.into());
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
            let (key, value) = (key.clone(), value.clone());
            return Err(SpikesKind::TakesNo { key, value, scheme: name }.into());
        }
        Ok(Self { scheme, sample, channels, rate, notes })
    }
}

fn parse<T: FromStr>(key: &str, value: &str) -> Result<T> {
    let wrong = |_| SpikesKind::NotOfItsKind { key: key.to_owned(), value: value.to_owned() };
    Ok(value.trim().parse().map_err(wrong)?)
}

/// The keys and values of a header, which are removed as they are used. The entries left at the end are unused.
struct Keys {
    left: Vec<(String, String)>,
}

impl Keys {
    fn new(lines: Vec<(String, String)>) -> Result<Self> {
        for (place, (key, value)) in lines.iter().enumerate() {
            if let Some((_, before)) = lines[..place].iter().find(|(before, _)| before == key) {
                let (key, before, value) = (key.clone(), before.clone(), value.clone());
                return Err(SpikesKind::Contradicts { key, before, value }.into());
            }
        }
        Ok(Self { left: lines })
    }

    fn take(&mut self, key: &str) -> Result<String> {
        match self.left.iter().position(|(name, _)| name == key) {
            Some(place) => Ok(self.left.remove(place).1),
            None => Err(SpikesKind::Lacks { key: key.to_owned() }.into()),
        }
    }

    fn optional<T: FromStr>(&mut self, key: &str) -> Result<Option<T>> {
        let place = self.left.iter().position(|(name, _)| name == key);
        place.map(|place| parse(key, &self.left.remove(place).1)).transpose()
    }
}
