//! `spikewire advise`: describes a log, and names the scheme that suits each of its channels.

use crate::inputs::InputOptions;
use crate::options::{answer, whole};
use crate::stop::Stop;
use crate::words::tell;
use anyhow::{Result, bail};
use catalogue::run::SampleType;
use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use lab::advise::{Advice, AdviseRequest, BankAdvice, advise};
use lab::look::known_unit;
use lab::output::Output;
use lab::plot::{Picture, draw};
use lab::trial::{Recording, Trial};
use lab::tune::costs;
use lab::watch::{Progress, Watch};
use std::io::Write;
use std::path::{Path, PathBuf};

/// Describe a log and advise a bank of encoders for it: one scheme for all channels, its parameters, and the reasons.
///
/// Each scheme is tuned briefly on each channel, with some blocks of the log held out. A scheme qualifies if its RMSE
/// is at most --max-rmse on the tuned blocks, and at most 1.25 times --max-rmse on the held-out blocks. Of the schemes
/// that qualify, the one that needs the fewest bytes a second on the link is advised. With --loop-bandwidth, a scheme
/// qualifies only if simulated drones also flew well with it while the link lost frames.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  spikewire advise flight.csv --loop-bandwidth 4 -o flight.toml
  spikewire advise flight.csv --channel gyro_x --max-rmse 0.05 --max-latency 0 --picture roll.svg
  spikewire advise flight.ulg --topic sensor_combined --field 'gyro_rad[0]' --json")]
pub(crate) struct Advise {
    #[command(flatten)]
    input: InputOptions,
    /// Sample type of the codecs: f32, i16, i32, or fixed point such as q16.16
    #[arg(long, default_value_t)]
    sample: SampleType,
    /// Largest RMSE that the control loop tolerates, in the signal's unit; default: a fifth of the signal's standard
    /// deviation, and with --loop-bandwidth at most the RMSE of the parameters with which simulated drones flew
    #[arg(long, value_name = "RMSE", value_parser = lab::input::above_zero)]
    max_rmse: Option<f64>,
    /// Maximum delay of the code, in samples
    #[arg(long, value_name = "SAMPLES")]
    max_latency: Option<f64>,
    /// Bandwidth in Hz of the control loop that will use the decoded values, at most a quarter of the sample rate.
    /// Codes whose latency is too long for this bandwidth, or that cannot follow the signal, are not advised
    #[arg(long, value_name = "HZ", value_parser = lab::input::above_zero)]
    loop_bandwidth: Option<f64>,
    /// Share of frames that the link loses, in percent, 0 to 10. With --loop-bandwidth, a code is advised only if
    /// simulated drones flew well with it at such a loss
    #[arg(long, value_name = "PERCENT", default_value_t = AdviseRequest::FRAME_LOSS)]
    frame_loss: f64,
    /// Core for which the report counts instructions: Cortex-M0 (`M0`) or Cortex-M4F (`M4F`)
    #[arg(long, default_value = "M4F", value_parser = costs::core)]
    core: String,
    /// Stop after this many seconds in total; the advice then depends on the machine's speed. Ctrl-C stops too
    #[arg(long, value_parser = lab::input::above_zero)]
    seconds: Option<f64>,
    /// Maximum number of settings to score for each scheme and channel
    #[arg(long, default_value_t = AdviseRequest::EVALUATIONS, value_parser = whole::<usize>)]
    evaluations: usize,
    /// Seed of the search
    #[arg(long, default_value_t = 1, value_parser = whole::<u64>)]
    seed: u64,
    /// Picture to draw, as `.svg` or `.png`: signal, spikes and reconstruction with the advised scheme; needs a
    /// recording of one channel, or --channel
    #[arg(long)]
    picture: Option<PathBuf>,
    /// Write the advised bank of encoders, one for each channel, as a flight file (`flight.toml`). It is read by `emit`,
    /// `encode`, `listen`, Python and a firmware's build script
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Print the whole report as JSON
    #[arg(long)]
    json: bool,
}

/// Runs the command.
///
/// # Errors
/// Returns an error if the log or the options are invalid, or if no channel has a scheme that can be advised. With
/// `-o`, also returns an error if no scheme suits all channels, or if the output cannot be written.
pub(crate) fn run(options: &Advise) -> Result<()> {
    let recordings = Recording::read_all(&options.input.to_lab()?.or_all()?)?;
    if options.picture.is_some() && recordings.len() > 1 {
        bail!("--picture draws one channel; --channel says which");
    }
    if let Some(first) = recordings.first() {
        tell(&first.notes());
    }
    let request = AdviseRequest {
        recordings,
        sample: options.sample,
        max_rmse: options.max_rmse,
        max_latency: options.max_latency,
        loop_bandwidth: options.loop_bandwidth,
        frame_loss: options.frame_loss,
        core: options.core.clone(),
        evaluations: options.evaluations,
        seconds: options.seconds,
        seed: options.seed,
    };
    let stop = Stop::new(None)?;
    let bar = ProgressBar::no_length()
        .with_style(ProgressStyle::with_template("{bar:40} {percent:>3} %  {msg}")?);
    let tell = |progress: &Progress| {
        bar.set_length(progress.total as u64);
        bar.set_position(progress.done as u64);
        bar.set_message(progress.words.clone());
    };
    let watch = Watch { is_stopped: &|| stop.is_due(), tell: &tell };
    let all = advise(&request, &watch)?;
    let is_wanted = request.recordings.len() > 1 || options.output.is_some();
    let has_rate = request.recordings.iter().all(|recording| recording.rate.is_some());
    let bank = if is_wanted && (has_rate || options.output.is_some()) {
        Some(BankAdvice::new(&request, &all, &watch)?)
    } else {
        None
    };
    bar.finish_and_clear();
    if options.json {
        let report = serde_json::json!({ "channels": all, "bank": bank });
        answer(serde_json::to_string_pretty(&report)? + "\n")?;
    } else {
        let pages = all.iter().map(Advice::page).chain(bank.as_ref().map(BankAdvice::page));
        answer(pages.collect::<String>())?;
    }
    if let (Some(path), [advice], [recording]) =
        (&options.picture, &all[..], &request.recordings[..])
    {
        draw_advised(options, path, advice, recording)?;
    }
    if all.iter().all(|advice| advice.best().is_none()) {
        bail!(
            "nothing can be advised: {}",
            all.iter().map(Advice::why_not).collect::<Vec<_>>().join("; ")
        );
    }
    if let (Some(path), Some(bank)) = (&options.output, &bank) {
        let Some(flight) = bank.flight() else {
            bail!("no scheme suits all channels: no flight is written")
        };
        let mut output = Output::open(Some(path), &options.input.input)?;
        output.write_all(flight.to_toml(&bank.comments()).as_bytes())?;
        output.finish()?;
    }
    Ok(())
}

/// Draws a recording, its spikes and its reconstruction, and writes the picture to `path`. Spikes and reconstruction
/// are those of the scheme in `advice`; without such a scheme, nothing is written.
fn draw_advised(
    options: &Advise,
    path: &Path,
    advice: &Advice,
    recording: &Recording,
) -> Result<()> {
    let Some((scheme, row)) = advice.best() else { return Ok(()) };
    let parameters = row.settings.to_asked(scheme.info());
    let trials = [Trial::new(scheme, &parameters, options.sample, recording)?];
    let unit = known_unit(&recording.name);
    let shown = 0..recording.values.len();
    let picture = Picture { recording, trials: &trials, unit, shown };
    Ok(draw(path, &options.input.input, &picture)?)
}
