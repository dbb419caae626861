//! The head of a file of spikes.

use crate::sample_type::SampleType;
use crate::scheme::SchemeName;
use crate::settings::{
    Centres, Contrast, Evenly, Fields, MovingWindow, Probabilistic, Rate, RateRule, Settings,
    Slots, StepForward,
};
use anyhow::{Result, anyhow, bail};
use clap::ValueEnum;
use std::str::FromStr;

/// What a file of spikes says before the first.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Header {
    /// The scheme.
    pub scheme: SchemeName,
    /// The sample type.
    pub sample: SampleType,
    /// All parameters that decoding needs, for each channel.
    pub channels: Vec<Settings>,
    /// Samples a second, if known.
    pub rate: Option<f64>,
    /// Where the signal came from, and what was calibrated; decoding needs none of it.
    pub notes: Vec<(&'static str, String)>,
}

/// The version of the format.
const VERSION: &str = "1";

/// As many addresses as there are.
const MOST_CHANNELS: usize = 1 << 16;

/// Keys that decoding does not need.
const NOTES: [&str; 6] = ["column", "topic", "field", "factor", "filter", "latency"];

impl Header {
    /// The keys and values before the parameters.
    fn common(&self) -> Vec<(&'static str, String)> {
        let mut lines = vec![
            ("spikewire", VERSION.to_owned()),
            ("scheme", self.scheme.name()),
            ("sample", self.sample.to_string()),
        ];
        if self.channels.len() > 1 {
            lines.push(("channels", self.channels.len().to_string()));
        }
        lines
    }

    /// The keys and values, in order. What channels do not share has theirs behind an `@`: `start@1`.
    pub(crate) fn lines(&self) -> Vec<(String, String)> {
        let all: Vec<_> = self.channels.iter().map(parameters).collect();
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
    /// One is missing, occurs twice, is not a number or does not belong to the scheme.
    pub(crate) fn parse(lines: Vec<(String, String)>) -> Result<Self> {
        let mut keys = Keys::new(lines)?;
        let version = keys.take("spikewire")?;
        if version != VERSION {
            bail!("the header says format `{version}`; this program reads {VERSION}");
        }
        let name = keys.take("scheme")?;
        let scheme = SchemeName::from_str(&name, false)
            .map_err(|_| anyhow!("the header names no scheme that there is: `{name}`"))?;
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
            channels.push(settings(scheme, &mut keys)?);
            if let Some((key, value)) = keys.left.iter().find(|line| own.contains(line)) {
                bail!("the header says {key}={value}, which {name} does not take");
            }
            left = keys.left;
        }
        let mut keys = Keys { left };
        let rate = keys.optional("rate")?;
        let mut notes = Vec::new();
        keys.left.retain(|(key, value)| {
            let note = NOTES.iter().find(|note| *note == key);
            notes.extend(note.map(|note| (*note, value.clone())));
            note.is_none()
        });
        if let Some((key, value)) = keys.left.first() {
            bail!("the header says {key}={value}, which {name} does not take");
        }
        Ok(Self { scheme, sample, channels, rate, notes })
    }
}

/// What the settings are called in the header.
pub(crate) fn parameters(settings: &Settings) -> Vec<(&'static str, String)> {
    let range = |range: &Evenly| {
        vec![
            ("neurons", range.neurons.to_string()),
            ("min", range.min.to_string()),
            ("max", range.max.to_string()),
        ]
    };
    match settings {
        Settings::Contrast(Contrast { threshold, step, start }) => vec![
            ("threshold", threshold.to_string()),
            ("step", step.to_string()),
            ("start", start.to_string()),
        ],
        Settings::StepForward(StepForward { threshold, start }) => {
            vec![("threshold", threshold.to_string()), ("start", start.to_string())]
        }
        Settings::MovingWindow(MovingWindow { threshold, window, start, .. }) => vec![
            ("threshold", threshold.to_string()),
            ("window", window.to_string()),
            ("start", start.to_string()),
        ],
        Settings::Rate(Rate { taps, shift, rule }) => {
            let mut keys = vec![("taps", list(taps)), ("shift", shift.to_string())];
            let (form, criterion, threshold) = match rule {
                RateRule::Hough => return keys,
                RateRule::ThresholdHough { threshold } => (None, None, threshold),
                RateRule::BenSubtractive { threshold } => (Some("aligned"), Some("sub"), threshold),
                RateRule::BenMultiplicative { threshold } => {
                    (Some("aligned"), Some("mul"), threshold)
                }
                RateRule::BenToolbox { threshold } => (Some("toolbox"), Some("mul"), threshold),
            };
            keys.extend(form.map(|form| ("form", form.to_owned())));
            keys.extend(criterion.map(|criterion| ("criterion", criterion.to_owned())));
            keys.push(("threshold", threshold.to_string()));
            keys
        }
        Settings::Position(Centres::Listed(centres)) => vec![("centres", list(centres))],
        Settings::Position(Centres::Linear(linear)) => {
            [vec![("centres", "linear".to_owned())], range(linear)].concat()
        }
        Settings::Position(Centres::GaussianSpaced(spaced)) => {
            [vec![("centres", "gaussian".to_owned())], range(spaced)].concat()
        }
        Settings::Gaussian(fields) => range(fields),
        Settings::Slots(Slots { fields, slots, floor }) => {
            let own = vec![
                ("slots", slots.to_string()),
                ("beta", fields.beta.to_string()),
                ("floor", floor.to_string()),
            ];
            [range(&fields.range), own].concat()
        }
        Settings::Probabilistic(Probabilistic { fields, seed }) => {
            let own = vec![("beta", fields.beta.to_string()), ("seed", seed.to_string())];
            [range(&fields.range), own].concat()
        }
    }
}

fn settings(scheme: SchemeName, keys: &mut Keys) -> Result<Settings> {
    Ok(match scheme {
        SchemeName::Tbr => Settings::Contrast(Contrast {
            threshold: keys.number("threshold")?,
            step: keys.number("step")?,
            start: keys.number("start")?,
        }),
        SchemeName::Sf => Settings::StepForward(StepForward {
            threshold: keys.number("threshold")?,
            start: keys.number("start")?,
        }),
        SchemeName::Mw => Settings::MovingWindow(MovingWindow {
            threshold: keys.number("threshold")?,
            window: keys.number("window")?,
            start: keys.number("start")?,
            first: Vec::new(),
        }),
        SchemeName::Hsa | SchemeName::THsa | SchemeName::Bsa => {
            let (taps, shift) = (keys.list("taps")?, keys.number("shift")?);
            let rule = match scheme {
                SchemeName::Hsa => RateRule::Hough,
                SchemeName::THsa => {
                    RateRule::ThresholdHough { threshold: keys.number("threshold")? }
                }
                _ => ben(keys)?,
            };
            Settings::Rate(Rate { taps, shift, rule })
        }
        SchemeName::Position => Settings::Position(match keys.take("centres")?.as_str() {
            "linear" => Centres::Linear(evenly(keys)?),
            "gaussian" => Centres::GaussianSpaced(evenly(keys)?),
            centres => Centres::Listed(numbers("centres", centres)?),
        }),
        SchemeName::Grf => Settings::Gaussian(evenly(keys)?),
        SchemeName::GrfSlots => Settings::Slots(Slots {
            fields: fields(keys)?,
            slots: keys.number("slots")?,
            floor: keys.number("floor")?,
        }),
        SchemeName::GrfProb => Settings::Probabilistic(Probabilistic {
            fields: fields(keys)?,
            seed: keys.number("seed")?,
        }),
    })
}

fn ben(keys: &mut Keys) -> Result<RateRule> {
    let threshold = keys.number("threshold")?;
    let (form, criterion) = (keys.take("form")?, keys.take("criterion")?);
    Ok(match (form.as_str(), criterion.as_str()) {
        ("aligned", "sub") => RateRule::BenSubtractive { threshold },
        ("aligned", "mul") => RateRule::BenMultiplicative { threshold },
        ("toolbox", "mul") => RateRule::BenToolbox { threshold },
        _ => bail!("the header says form={form} with criterion={criterion}, which there is not"),
    })
}

fn fields(keys: &mut Keys) -> Result<Fields> {
    Ok(Fields { range: evenly(keys)?, beta: keys.number("beta")? })
}

fn evenly(keys: &mut Keys) -> Result<Evenly> {
    Ok(Evenly {
        neurons: keys.number("neurons")?,
        min: keys.number("min")?,
        max: keys.number("max")?,
    })
}

fn list(values: &[f64]) -> String {
    values.iter().map(f64::to_string).collect::<Vec<_>>().join(",")
}

fn numbers(key: &str, text: &str) -> Result<Vec<f64>> {
    text.split(',').map(|number| parse(key, number)).collect()
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

    fn number<T: FromStr>(&mut self, key: &str) -> Result<T> {
        parse(key, &self.take(key)?)
    }

    fn optional<T: FromStr>(&mut self, key: &str) -> Result<Option<T>> {
        let place = self.left.iter().position(|(name, _)| name == key);
        place.map(|place| parse(key, &self.left.remove(place).1)).transpose()
    }

    fn list(&mut self, key: &str) -> Result<Vec<f64>> {
        numbers(key, &self.take(key)?)
    }
}
