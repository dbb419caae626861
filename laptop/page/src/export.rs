//! What a user takes away: constants, files of parameters and spikes.

use crate::flight;
use crate::host::send;
use crate::recording::{self, Open};
use crate::run::Choice;
use anyhow::{Result, bail};
use catalogue::run::{SET, Value as Parameter};
use lab::coding::Coding;
use lab::encode::{encode, encode_flight};
use lab::events::{Format, Stream};
use lab::output::Output;
use lab::trial::Trial;
use lab::tune::emit;
use serde_json::{Value, json};

/// Makes what is asked for: `text`, or the array `file`.
pub(crate) fn export(kind: &str, choice: &Choice) -> Result<Value> {
    recording::with(|open| {
        let (_, trial) = choice.trial(&open.recording)?;
        if kind == "csv" || kind == "es" {
            let table = spikes(open, &trial, choice)?;
            send("file", &if kind == "es" { event_stream(&table)? } else { table });
            return Ok(json!({}));
        }
        Ok(json!({ "text": as_text(kind, open, &trial)? }))
    })
}

fn as_text(kind: &str, open: &Open, trial: &Trial) -> Result<String> {
    let (scheme, settings) = (trial.scheme, &trial.settings);
    match kind {
        "rust" => Ok(emit::rust(&[], &open.recording.name, scheme, settings)?),
        "toml" => Ok(emit::toml(&[], scheme, settings)),
        "python" => Ok(python(&Coding::of_settings(scheme, settings))),
        _ => bail!("there is no export `{kind}`"),
    }
}

/// The class of the Python package with its keywords.
fn python(coding: &Coding) -> String {
    let value = |value: &Parameter| match value {
        value if *value == SET => "True".to_owned(),
        Parameter::Word(word) => format!("\"{word}\""),
        Parameter::Numbers(all) => {
            format!("[{}]", all.iter().map(f64::to_string).collect::<Vec<_>>().join(", "))
        }
        value => value.to_string(),
    };
    let given = coding.asked.iter().map(|(name, own)| format!("{name}={}, ", value(own)));
    let class = coding.scheme.info().type_name;
    format!(
        "import spikewire as sw\n\nscheme = sw.{class}({}sample=\"{}\")\n",
        given.collect::<String>(),
        coding.sample
    )
}

/// The file that `spikewire encode` writes with these settings; behind a filter with a flight of this one channel.
fn spikes(open: &Open, trial: &Trial, choice: &Choice) -> Result<Vec<u8>> {
    let input = &open.input;
    let (output, _) = if choice.filter.is_some() {
        let channel = (open.recording.name.clone(), trial.settings.to_asked(trial.scheme.info()));
        let flight = flight::of(choice, open.recording.steady_rate()?, vec![channel])?;
        encode_flight(&flight, input, None, || Ok(Output::memory()))?
    } else {
        let Coding { scheme, sample, asked } = Coding::of_settings(trial.scheme, &trial.settings);
        encode(input, scheme, sample, &asked, None, || Ok(Output::memory()))?
    };
    Ok(output.into_bytes())
}

/// The table as `spikewire convert --to es` writes it.
fn event_stream(table: &[u8]) -> Result<Vec<u8>> {
    let reader = Format::Csv.reader("the spikes");
    let mut stream = Stream::new(reader, Format::EventStream { size: None }.writer(false)?, false);
    let mut file = Vec::new();
    stream.push(table, None, &mut file)?;
    stream.finish(&mut file)?;
    Ok(file)
}
