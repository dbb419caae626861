//! The parameters of a scheme, from signals.

use super::{Arguments, Signal, Watch};
use crate::commands::tune::{Outcome, Tune};
use crate::scheme::Scheme;
use crate::stop::Stop;
use crate::tune::report::Row;
use crate::tune::search::share;
use anyhow::{Result, bail};
use std::time::{Duration, Instant};

/// A scheme with the settings that were found for it.
#[derive(Clone, Debug)]
pub struct Tuned {
    /// Its short name.
    pub scheme: &'static str,
    /// Options that bring the settings about.
    pub options: Vec<(String, String)>,
    /// Figures and settings, as `spikewire tune --json` has them.
    pub figures: String,
    /// What a file of the settings says of them.
    pub comments: Vec<String>,
}

impl Tuned {
    pub(super) fn new(scheme: Scheme, row: &Row, channel: &str) -> Result<Self> {
        let options = row.settings.to_options(scheme.info());
        Ok(Self {
            scheme: scheme.name(),
            options: options
                .iter()
                .map(|(name, text)| (name.to_owned(), text.to_owned()))
                .collect(),
            figures: serde_json::to_string(row)?,
            comments: row.comments(channel),
        })
    }
}

/// Searches the parameters of a scheme, or of all, on recordings of one channel, with the options of `spikewire tune`.
/// The best comes first. What reaches no goal is told in words.
///
/// # Errors
/// The signals or options are not good, nothing keeps to the limits, or somebody stopped it.
pub fn tune(
    signals: &[Signal],
    arguments: &Arguments,
    watch: &Watch,
) -> Result<(Vec<Tuned>, Vec<String>)> {
    let options: Tune = arguments.parse("-")?;
    options.check()?;
    let mut whole: Option<crate::tune::report::Cut> = None;
    for signal in signals {
        let recording = signal.recording()?;
        options.look_at(&recording, &signal.name)?;
        let own = options.cut(&recording)?;
        match &mut whole {
            None => whole = Some(own),
            Some(all) => {
                all.train.extend(own.train);
                all.held_out.extend(own.held_out);
                all.whole.extend(own.whole);
            }
        }
    }
    let Some(cut) = whole else { bail!("there is no signal") };
    let schemes = options.schemes();
    let stop = Stop::at_word(watch.stop.clone(), options.seconds)?;
    let end = Instant::now() + Duration::from_secs_f64(options.seconds);
    let (mut rows, mut missed) = (Vec::new(), Vec::new());
    for (place, scheme) in schemes.iter().enumerate() {
        let deadline = share(end, schemes.len() - place);
        let tick = |evaluated: usize, _: Option<&_>| {
            let own = evaluated as f64 / options.evaluations as f64;
            (watch.tell)((place as f64 + own.min(1.0)) / schemes.len() as f64);
        };
        match options.tuned(*scheme, &cut, deadline, &stop, &tick)? {
            Outcome::Row(row) => rows.push((*scheme, *row)),
            Outcome::Missed(words) => missed.push(words),
            Outcome::Curve(_) => bail!("a front is drawn by the laptop program only"),
        }
        watch.check()?;
    }
    if rows.is_empty() {
        bail!("{}: no settings keep to all limits: {}", cut.name, missed.join("; "));
    }
    options.sort(&mut rows);
    let tuned = rows.iter().map(|(scheme, row)| Tuned::new(*scheme, row, &cut.name));
    Ok((tuned.collect::<Result<_>>()?, missed))
}
