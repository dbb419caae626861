//! The report on the settings that a search found.

use super::RequestKind;
use super::problem::{Goal, Tally};
use super::search::Found;
use super::{Bound, Costs, Figures, Over, Problem, Scored, Stretch};
use crate::Result;
use crate::brief::{brief, json, short};
use catalogue::run::{Asked, SampleType, Settings, Words};
use serde::Serialize;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fmt::Write;

/// Note for the user about the settings of a code that drifts: in its decoder, the errors of all steps add up until a
/// keyframe arrives.
pub(crate) const DRIFTS: &str = "drifts: the errors of all its steps add up until a keyframe comes, and each flight's add up \
     otherwise: not to be relied on in another flight";

/// One channel of all recordings, cut into stretches: consecutive samples that are coded in one piece.
pub struct Cut {
    /// The channel's name.
    pub name: String,
    /// Stretches to tune on.
    pub train: Vec<Stretch>,
    /// Stretches that are held out, to check the settings on.
    pub held_out: Vec<Stretch>,
    /// One stretch for each segment of the recordings. A restart of the recorder's clock begins a new segment.
    pub whole: Vec<Stretch>,
}

/// The settings of one scheme, and the report on them.
#[derive(Debug, Serialize)]
pub struct Row {
    /// Short name of the scheme.
    pub scheme: &'static str,
    /// The sample type, such as `f32` or `q8.8`.
    pub sample: String,
    /// The parameters, by the names that files and other commands use.
    pub parameters: BTreeMap<&'static str, Value>,
    /// Figures on the stretches (parts of the recordings) that were used for tuning.
    pub tuned_on: Figures,
    /// Figures on the stretches that were held out from tuning. `None` if no stretch was held out.
    pub held_out: Option<Figures>,
    /// Figures on whole segments of the recordings, each coded in one piece.
    pub whole: Figures,
    /// Figures of the settings that the toolbox paper gives for the scheme, on the same stretches as `tuned_on` and
    /// `held_out`. `None` if the paper gives none.
    pub paper: Option<Paper>,
    /// Costs of the settings on a flight controller, such as memory and instructions.
    pub costs: Costs,
    /// Change of the RMSE from `f32` to the sample type, in percent. `None` if the sample type is `f32`.
    pub quantisation: Option<f64>,
    /// Number of settings that were scored with the codec.
    pub evaluated: usize,
    /// Number of outcomes (spikes and error of a threshold) that were computed in exact arithmetic, without the codec.
    /// Thresholds with the same spikes share an outcome.
    pub listed: usize,
    /// Whether `listed` counts every outcome that some threshold can have.
    pub is_complete: bool,
    /// Whether the search stopped before its budget of settings was spent.
    pub is_cut_short: bool,
    /// Notes for the user: reasons not to trust the settings.
    pub notes: Vec<String>,
    /// The settings found.
    #[serde(skip)]
    pub settings: Settings,
    #[serde(skip)]
    brief: String,
}

/// Figures of the settings that the paper *A toolbox for neuromorphic perception in robotics* gives for a scheme. The
/// figures are computed on the stretches of a channel.
#[derive(Debug, Serialize)]
pub struct Paper {
    /// Figures on the stretches (parts of the recordings) that were used for tuning.
    pub tuned_on: Figures,
    /// Figures on the stretches that were held out from tuning. `None` if no stretch was held out.
    pub held_out: Option<Figures>,
}

impl Row {
    /// Makes the report on settings that a search has found. `below` is the frequency in Hz below which the error is
    /// also reported.
    ///
    /// # Errors
    /// Returns an error if the settings are invalid. Settings that a search has found are always valid.
    pub fn new(
        problem: &Problem,
        cut: &Cut,
        found: &Found,
        best: &Scored,
        below: Option<f64>,
    ) -> Result<Self> {
        let sample = problem.sample;
        let figures = |options: &Asked, sample, stretches: &[Stretch]| {
            Figures::new(problem, options, sample, stretches, below)
        };
        let held_out = |options: &Asked| {
            (!cut.held_out.is_empty()).then(|| figures(options, sample, &cut.held_out)).transpose()
        };
        let tuned_on = figures(&best.options, sample, &cut.train)?;
        let mut paper = problem.fixed.clone();
        paper.paper = true;
        // The paper may have no settings for the scheme or the channel.
        let paper = figures(&paper, sample, &cut.train)
            .and_then(|tuned_on| Ok(Paper { tuned_on, held_out: held_out(&paper)? }))
            .ok();
        let quantisation = (sample != SampleType::F32)
            .then(|| figures(&best.options, SampleType::F32, &cut.train))
            .transpose()?
            .map(|plain| (tuned_on.rmse / plain.rmse - 1.0) * 100.0);
        let first = cut.whole.first().ok_or(RequestKind::NoRecording)?;
        let settings = problem.settings(&best.options, sample, first)?;
        let mut row = Self {
            scheme: problem.scheme.name(),
            sample: sample.to_string(),
            parameters: settings.entries().iter().map(|(key, value)| (*key, json(value))).collect(),
            tuned_on,
            held_out: held_out(&best.options)?,
            whole: figures(&best.options, sample, &cut.whole)?,
            paper,
            costs: best.costs,
            quantisation,
            evaluated: found.evaluated,
            listed: found.listed,
            is_complete: found.is_complete,
            is_cut_short: found.is_cut_short,
            notes: Vec::new(),
            brief: brief(settings.entries()),
            settings,
        };
        row.notes = row.flags(problem, cut, found);
        Ok(row)
    }

    /// Returns reasons not to trust the settings, a sentence each.
    fn flags(&self, problem: &Problem, cut: &Cut, found: &Found) -> Vec<String> {
        /// Factor by which chance alone can make an RMSE on what was held out too large or too small.
        const BY_CHANCE: f64 = 1.25;
        /// Factor by which the RMSE may be larger on what was held out before overfitting is reported.
        const FAR: f64 = 1.5;
        let mut flags = Vec::new();
        if found.is_cut_short {
            flags.push(format!(
                "the search was cut short after {} settings: how far it came depends on this machine's speed",
                found.evaluated
            ));
        }
        if problem.scheme.info().drifts() {
            flags.push(DRIFTS.to_owned());
        }
        if problem.over == Over::Worst
            && problem.train.chunk_by(|a, b| a.flight == b.flight).count() == 1
        {
            flags.push(
                "tuned on one log only: there is no other whose error may be larger".to_owned(),
            );
        }
        flags.extend(found.bounds.iter().map(Bound::words));
        let judged = self.held_out.as_ref().unwrap_or(&self.tuned_on);
        // A code without spikes, or worse than a constant, is reported as such instead of by its error.
        if judged.spikes == 0 {
            flags.push("never spikes: its value stays where it starts".to_owned());
        } else if judged.snr <= 0.0 {
            flags.push(format!(
                "no better than a constant: the error has {} of the signal's power",
                short((10_f64.powf(-judged.snr / 10.0) * 100.0).round() / 100.0)
            ));
        }
        let Some(held_out) = &self.held_out else {
            flags.push("nothing was held out: the figures are of what it was tuned on".to_owned());
            return flags;
        };
        match problem.goal {
            Goal::LeastError(efficiency) if held_out.efficiency < efficiency - 2.0 => {
                flags.push(format!(
                    "misses the goal on what was held out: {:.1} % efficiency, where {efficiency:.1} was asked for",
                    held_out.efficiency
                ));
            }
            Goal::MostEfficient(rmse) if held_out.rmse > rmse * BY_CHANCE => {
                flags.push(format!(
                    "misses the goal on what was held out: RMSE {}, where {} was asked for",
                    short(held_out.rmse),
                    short(rmse)
                ));
            }
            _ => {}
        }
        let growth = held_out.rmse / self.tuned_on.rmse;
        if growth > FAR {
            flags.push(format!(
                "{} times the RMSE on what was held out, {} where it is {} on what it was tuned on",
                short((growth * 10.0).round() / 10.0),
                short(held_out.rmse),
                short(self.tuned_on.rmse)
            ));
        }
        // Other settings that the search found may do far better on what was held out.
        let stride = found.front.len().div_ceil(64).max(1);
        let others = found.front.iter().step_by(stride).filter_map(|other| {
            let (tally, _) = problem.tally(&other.options, problem.sample, &cut.held_out).ok()?;
            let settings = problem.settings(&other.options, problem.sample, &cut.train[0]).ok()?;
            (tally.spikes <= held_out.spikes).then(|| (tally, brief(settings.entries())))
        });
        let better = others.min_by(|a: &(Tally, String), b| a.0.squares.total_cmp(&b.0.squares));
        if let Some((tally, brief)) =
            better.filter(|(tally, _)| tally.rmse() * BY_CHANCE < held_out.rmse)
        {
            flags.push(format!(
                "fits what it was tuned on only: on what was held out {brief} has an RMSE of {} with no more spikes",
                short(tally.rmse())
            ));
        }
        if let Some(Paper { tuned_on: on_tuned, held_out: Some(paper) }) = &self.paper {
            // What was held out may be harder for all settings.
            let grown = (held_out.rmse / self.tuned_on.rmse) / (paper.rmse / on_tuned.rmse);
            if paper.rmse < held_out.rmse && paper.spikes <= held_out.spikes {
                flags.push("the paper's settings are better on what was held out".to_owned());
            } else if paper.rmse * BY_CHANCE < held_out.rmse && grown > BY_CHANCE {
                flags.push(format!(
                    "fits what it was tuned on: from there to what was held out its RMSE grows from {} to {}, that of the \
                     paper's settings from {} to {}",
                    short(self.tuned_on.rmse),
                    short(held_out.rmse),
                    short(on_tuned.rmse),
                    short(paper.rmse)
                ));
            }
        }
        flags
    }

    /// Returns the comments, one for each line, for a file with a channel's settings. The comments name the channel,
    /// the scheme and the sample type, and give the settings' efficiency and RMSE.
    pub fn comments(&self, channel: &str) -> Vec<String> {
        let Self { scheme, sample, tuned_on, held_out, .. } = self;
        let held_out = held_out.map_or(String::new(), |own| {
            format!("; on held-out blocks {:.2} % and {}", own.efficiency, short(own.rmse))
        });
        vec![
            format!(
                "`{channel}` through {scheme} in {sample}, by `spikewire tune`: {:.2} % of the samples without a spike,",
                tuned_on.efficiency
            ),
            format!("RMSE {}{held_out}.", short(tuned_on.rmse)),
        ]
    }
}

/// Formats a table of all rows, followed by details of each row. `core` is the processor core of the instruction
/// counts. `below` is the frequency in Hz below which the error is also reported.
pub fn print(rows: &[&Row], core: &str, below: Option<f64>) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = table(&mut text, rows, below);
    for row in rows {
        let _ = details(&mut text, row, core);
    }
    text
}

fn table(text: &mut String, rows: &[&Row], below: Option<f64>) -> std::fmt::Result {
    let limit = below.map_or(String::new(), |limit| format!(" RMSE < {limit} Hz |"));
    let dashes = if below.is_some() { "|--:" } else { "" };
    writeln!(
        text,
        "| scheme | settings | blocks | efficiency % | RMSE | SNR dB | worst | lag | events/s | bits/s | raw bits/s |{limit}"
    )?;
    writeln!(text, "|---|---|---|--:|--:|--:|--:|--:|--:|--:|--:{dashes}|")?;
    for row in rows {
        let mut line = |settings: &str, blocks: &str, own: &Figures| {
            let rate =
                |value: Option<f64>| value.map_or("-".to_owned(), |value| format!("{value:.1}"));
            write!(
                text,
                "| {} | {settings} | {blocks} | {:.2} | {} | {:.2} | {} | {} | {} | {} | {} |",
                row.scheme,
                own.efficiency,
                short(own.rmse),
                own.snr,
                short(own.worst),
                own.lag,
                rate(own.events_per_second),
                rate(own.bits_per_second),
                rate(own.raw_bits_per_second),
            )?;
            if below.is_some() {
                write!(text, " {} |", own.below.map_or("-".to_owned(), short))?;
            }
            writeln!(text)
        };
        line("tuned", "tuned on", &row.tuned_on)?;
        if let Some(held_out) = &row.held_out {
            line("tuned", "held out", held_out)?;
        }
        line("tuned", "whole log", &row.whole)?;
        if let Some(paper) = &row.paper {
            line("the paper's", "tuned on", &paper.tuned_on)?;
            if let Some(held_out) = &paper.held_out {
                line("the paper's", "held out", held_out)?;
            }
        }
    }
    writeln!(text)
}

fn details(text: &mut String, row: &Row, core: &str) -> std::fmt::Result {
    let Row { scheme, sample, costs, quantisation, evaluated, brief, .. } = row;
    writeln!(text, "{scheme}: {brief}")?;
    let ram = costs.ram.map_or("unknown".to_owned(), |bytes| format!("{bytes} bytes"));
    writeln!(
        text,
        "  on a Cortex-{core} in {sample}: {} instructions a sample, {ram} of RAM a channel; latency {} samples",
        costs.instructions(),
        costs.latency
    )?;
    if let Some(percent) = quantisation {
        writeln!(text, "  {sample} changes the RMSE of f32 by {percent:+.2} %")?;
    }
    let listed = match row.listed {
        0 => String::new(),
        listed if row.is_complete => format!("; all of {listed} different outcomes compared"),
        listed => format!("; {listed} outcomes compared, which are not all"),
    };
    writeln!(text, "  {evaluated} settings scored by the codec{listed}")?;
    row.notes.iter().try_for_each(|note| writeln!(text, "  {note}"))
}

/// Returns a message that tells the user that no settings keep to all limits. The message lists each limit that the
/// best settings break, with the value that these settings reach.
pub fn missed(problem: &Problem, found: &Found, best: &Scored) -> Words {
    let settings = problem
        .train
        .first()
        .and_then(|stretch| problem.settings(&best.options, problem.sample, stretch).ok());
    let mut words = Words::from(format!(
        "{}: none of {} settings keeps to all limits; nearest, with an RMSE of {} at {:.2} % efficiency ({}): ",
        problem.scheme.name(),
        found.evaluated,
        short(best.tally.rmse()),
        best.tally.efficiency(),
        settings.map_or(String::new(), |settings| brief(settings.entries())),
    ));
    for (place, one) in best.excess.iter().enumerate() {
        let value = if one.value.is_finite() { short(one.value) } else { "not known".to_owned() };
        words = words.text(if place > 0 { ", " } else { "" }).setting(one.limit.name());
        words = words.text(format_args!(" {} is {value}", short(one.allowed)));
    }
    let bounds = found.bounds.iter().map(|bound| format!("; {}", bound.words()));
    words.text(bounds.collect::<String>())
}
