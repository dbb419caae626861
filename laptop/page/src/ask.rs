//! What the page can ask for.

use crate::run::Choice;
use crate::{board, catalogue, export, flight, frames, front, recording, run, words};
use anyhow::{Context, Result};
use serde::Deserialize;
use serde_json::{Value, json};

/// A request.
#[derive(Deserialize)]
#[serde(tag = "ask", rename_all = "kebab-case")]
enum Ask {
    /// What schemes there are.
    Catalogue,
    /// Takes the files that were dropped, in the place of those before, and lists what the first one holds.
    Open {
        names: Vec<String>,
        accept_cut: bool,
        #[serde(flatten)]
        table: recording::TableOptions,
    },
    /// The same with a recording that the page brings.
    Example { name: String },
    /// Reads a channel of the file that is open, to a place.
    Load {
        #[serde(default)]
        place: usize,
        #[serde(flatten)]
        channel: recording::Channel,
    },
    /// Encodes and decodes the recording at a place.
    Run {
        choice: Choice,
        #[serde(default)]
        place: usize,
    },
    /// The same of parts of the recording, while a knob moves.
    Preview(run::Preview),
    /// Settings as text, or a file of spikes.
    Export { kind: String, choice: Choice },
    /// A flight's file of these channels.
    Flight(flight::Flown),
    /// What a flight's file asks of its channels.
    ReadFlight { text: String },
    /// The settings of a scheme that no other ones beat in spikes and error.
    Front { choice: Choice, evaluations: usize },
    /// Encodes the next frame of a video.
    Frame(frames::Frame),
    /// What a board sends, until it ends.
    Listen(board::Listen),
    /// The scheme that takes the fewest bytes within an error.
    Advise(front::Advise),
}

/// The answer to a request, or `{"error": …}`.
pub(crate) fn answered(request: &[u8]) -> Value {
    answer(request).unwrap_or_else(|error| json!({ "error": words::of(&error) }))
}

fn answer(request: &[u8]) -> Result<Value> {
    let ask =
        serde_json::from_slice(request).context("the page asks what this library does not know")?;
    match ask {
        Ask::Catalogue => Ok(catalogue::all()),
        Ask::Open { names, accept_cut, table } => recording::open(&names, accept_cut, &table),
        Ask::Example { name } => recording::example(&name),
        Ask::Load { place, channel } => recording::load(channel, place),
        Ask::Run { choice, place } => run::run(&choice, place),
        Ask::Preview(preview) => run::preview(&preview),
        Ask::Export { kind, choice } => export::export(&kind, &choice),
        Ask::Flight(channels) => flight::write(&channels),
        Ask::ReadFlight { text } => flight::read(&text),
        Ask::Front { choice, evaluations } => front::front(&choice, evaluations),
        Ask::Frame(frame) => frames::next(&frame),
        Ask::Listen(options) => board::listen(&options),
        Ask::Advise(request) => front::advise(&request),
    }
}
