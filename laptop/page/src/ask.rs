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
    Open { names: Vec<String>, accept_cut: bool },
    /// The same with a recording that the page brings.
    Example { name: String },
    /// Reads a channel of the file that is open.
    Load(recording::Channel),
    /// Takes samples from another worker.
    Take { name: String, rate: Option<f64>, file: u32 },
    /// Encodes and decodes the recording.
    Run { choice: Choice },
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
    Advise { sample: String, max_rmse: Option<f64>, evaluations: usize },
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
        Ask::Open { names, accept_cut } => recording::open(&names, accept_cut),
        Ask::Example { name } => recording::example(&name),
        Ask::Load(channel) => recording::load(channel),
        Ask::Take { name, rate, file } => recording::take(name, rate, file),
        Ask::Run { choice } => run::run(&choice),
        Ask::Preview(preview) => run::preview(&preview),
        Ask::Export { kind, choice } => export::export(&kind, &choice),
        Ask::Flight(channels) => flight::write(&channels),
        Ask::ReadFlight { text } => flight::read(&text),
        Ask::Front { choice, evaluations } => front::front(&choice, evaluations),
        Ask::Frame(frame) => frames::next(&frame),
        Ask::Listen(options) => board::listen(&options),
        Ask::Advise { sample, max_rmse, evaluations } => {
            front::advise(&sample, max_rmse, evaluations)
        }
    }
}
