//! Searches, for a worker of their own: the page stops one by ending it.

use crate::host::tell;
use crate::recording;
use crate::run::{CORE, Choice, texts};
use anyhow::{Result, bail};
use lab::advise::{AdviseRequest, advise as advised};
use lab::tune::search::{Budget, Method, search};
use lab::tune::{Goal, Limits, Problem, Scored, Stretch};
use lab::watch::{Progress, Watch};
use serde::Deserialize;
use serde_json::{Value, json};

/// The most settings of a front that the page draws.
const MOST: usize = 200;

/// Searches the parameters of one scheme on the recording, behind the filter of `choice`: the settings that no other ones
/// beat in spikes and error.
pub(crate) fn front(choice: &Choice, evaluations: usize) -> Result<Value> {
    recording::with(|open| {
        let (scheme, sample, mut fixed) = choice.read()?;
        fixed.paper = false;
        let heard = choice.behind_filter(&open.recording)?;
        let train = Stretch::whole(&heard);
        let limits = Limits::default();
        let problem = Problem::new(scheme, sample, &fixed, &train, (Goal::Front, &limits, CORE));
        let tick =
            |done: usize, _: Option<&Scored>| tell(&json!({ "done": done, "total": evaluations }));
        let budget = Budget { evaluations, deadline: None, is_stopped: &|| false, tick: &tick };
        let found =
            search(&problem, Method { seed: 1, free_taps: false, is_unchecked: false }, &budget);
        let stride = found.front.len().div_ceil(MOST).max(1);
        let points = found.front.iter().step_by(stride).map(|one| {
            json!({
                "efficiency": one.tally.efficiency(),
                "rmse": one.tally.rmse(),
                "parameters": texts(&one.options),
            })
        });
        let points: Vec<Value> = points.collect();
        if points.is_empty() {
            bail!("{} has no settings for this recording", scheme.name());
        }
        Ok(json!({ "scheme": scheme.name(), "points": points, "evaluated": found.evaluated }))
    })
}

/// The question for the scheme that takes the fewest bytes within an error, as `spikewire advise` takes it.
#[derive(Deserialize)]
pub(crate) struct Advise {
    sample: String,
    max_rmse: Option<f64>,
    /// Bandwidth in Hz of the control loop that uses the decoded values.
    loop_bandwidth: Option<f64>,
    evaluations: usize,
}

/// Tunes all schemes a little, and names the one that takes the fewest bytes within an error.
pub(crate) fn advise(asked: &Advise) -> Result<Value> {
    recording::with(|open| {
        let mut request = AdviseRequest::new(vec![open.recording.clone()]);
        request.sample = asked.sample.parse()?;
        request.max_rmse = asked.max_rmse.into_iter().collect();
        request.loop_bandwidth = asked.loop_bandwidth;
        request.evaluations = asked.evaluations;
        let report = |now: &Progress| {
            tell(&json!({ "done": now.done, "total": now.total, "words": now.words }));
        };
        let all = advised(&request, &Watch { is_stopped: &|| false, tell: &report })?;
        let Some(advice) = all.first() else { bail!("there is no recording") };
        let best = advice.best().map(|(scheme, row)| {
            json!({
                "scheme": scheme.name(),
                "parameters": texts(&row.settings.to_asked(scheme.info())),
                "filter": advice.best_filter(),
            })
        });
        let why_not = best.is_none().then(|| advice.why_not());
        Ok(json!({ "words": advice.page(), "best": best, "whyNot": why_not }))
    })
}
