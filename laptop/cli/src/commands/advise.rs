//! `spikewire advise`: describes a log, and names the scheme that suits each of its channels.

use crate::inputs::{LogOptions, ManyChannels};
use crate::options::{answer, check_ending, whole};
use crate::report::{Counts, Log, Report, is_stdout};
use crate::stop::Stop;
use crate::words::{self, tell_of};
use anyhow::{Result, anyhow, bail};
use catalogue::run::SampleType;
use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use lab::advise::{Advice, AdviseRequest, BankAdvice, advise};
use lab::dataset::Found;
use lab::flight::visible;
use lab::input::{InputOptions, Unnamed};
use lab::output::Output;
use lab::plot::{Picture, draw};
use lab::trial::{Recording, Trial};
use lab::tune::costs;
use lab::watch::{Progress, Watch};
use serde::Serialize;
use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Describe a log and advise a bank of encoders for it: one scheme for all channels, its parameters, and the reasons.
/// Of several logs, each is described under its name, and a last line counts the schemes advised.
///
/// Each scheme is tuned briefly on each channel, with some blocks of the log held out. A scheme qualifies if its RMSE
/// is at most --max-rmse on the tuned blocks, and at most 1.25 times --max-rmse on the held-out blocks. Of the schemes
/// that qualify, the one that needs the fewest bytes a second on the link is advised. With --loop-bandwidth, a scheme
/// qualifies only if simulated drones also flew well with it while the link lost frames.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  spikewire advise flight.csv --loop-bandwidth 4 -o flight.toml
  spikewire advise flight.ulg --loop-bandwidth 4
  spikewire advise flight.csv --channels gyro_x --max-rmse 0.05 --max-latency 0 --picture roll.svg
  spikewire advise logs --channels-of ulog='sensor_combined.gyro_rad[0]' --channels-of table=gyro_x
  spikewire advise flight.ulg --channels 'sensor_gyro.*' --json")]
pub(crate) struct Advise {
    #[command(flatten)]
    logs: LogOptions,
    #[command(flatten)]
    channels: ManyChannels,
    /// Sample type of the codecs: f32, i16, i32, or fixed point such as q16.16
    #[arg(long, default_value_t)]
    sample: SampleType,
    /// Largest RMSE that the control loop tolerates, in the signal's unit: one for each channel, in their order, or one
    /// for all channels if they are in one unit. Default: a fifth of the signal's standard deviation, and with
    /// --loop-bandwidth, on axes of a gyroscope or accelerometer in a known unit, no coarser than the parameters with
    /// which simulated drones flew
    #[arg(long, value_name = "RMSE", value_delimiter = ',', value_parser = lab::input::above_zero)]
    max_rmse: Vec<f64>,
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
    /// Stop the search on a log after this many seconds in total; the advice then depends on the machine's speed. Ctrl-C
    /// stops too
    #[arg(long, value_parser = lab::input::above_zero)]
    seconds: Option<f64>,
    /// Maximum number of settings to score for each scheme and channel
    #[arg(long, default_value_t = AdviseRequest::EVALUATIONS, value_parser = whole::<usize>)]
    evaluations: usize,
    /// Seed of the search
    #[arg(long, default_value_t = 1, value_parser = whole::<u64>)]
    seed: u64,
    /// Picture to draw, as `.svg` or `.png`: signal, spikes and reconstruction with the advised scheme; needs one log
    /// of one channel, or --channels
    #[arg(long)]
    picture: Option<PathBuf>,
    /// Write the advised bank of encoders, one for each channel of one log, as a flight file (`flight.toml`). It is
    /// read by `emit`, `encode`, `listen`, Python and a firmware's build script
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Print the whole report as JSON
    #[arg(long)]
    json: bool,
}

/// Advice on a log: on each channel, and on a bank for all of them.
#[derive(Debug, Serialize)]
struct Advised {
    channels: Vec<Advice>,
    bank: Option<BankAdvice>,
}

/// What holds for all logs together.
#[derive(Debug, Serialize)]
struct Summary {
    #[serde(flatten)]
    counts: Counts,
    /// Number of channels for which each scheme is advised.
    advised: BTreeMap<&'static str, usize>,
}

/// Runs the command.
///
/// # Errors
/// Returns an error if a log or the options are invalid, or if no channel of a log has a scheme that can be advised.
/// Advice on the other logs comes first. With `-o`, also returns an error if no scheme suits all channels, if a channel
/// is left out, or if the output cannot be written. After Ctrl-C, returns an error if logs are left.
pub(crate) fn run(options: &Advise) -> Result<()> {
    let Found { logs, is_single, .. } = options.logs.find()?;
    if (options.output.is_some() || options.picture.is_some()) && logs.len() > 1 {
        bail!("-o and --picture take one log; there are {}", logs.len());
    }
    check_ending(options.output.as_deref(), "toml", "a flight file")?;
    let is_stdout = is_stdout(options.output.as_deref(), options.json)?;
    let stop = Stop::new(None)?;
    let ends = is_single && !options.json;
    let (mut all, mut last) = (Vec::new(), None);
    for path in &logs {
        if stop.is_due() {
            break;
        }
        // The recordings of the log before need not be kept while this one is read.
        last = None;
        let log = path.display().to_string();
        match options.advised(path, is_single, &stop) {
            Ok((request, notes, advised)) => {
                let why = advised.check().err();
                if !options.json {
                    let page = advised.page();
                    let page = if is_single { page } else { format!("{log}\n{page}\n") };
                    let page = words::page(&page);
                    if is_stdout { eprint!("{page}") } else { answer(page)? }
                }
                let entry = match why {
                    None => Log { log, refused: None, notes, content: Some(advised) },
                    Some(why) => {
                        Log { notes, content: Some(advised), ..Log::refused(log, why, ends)? }
                    }
                };
                all.push(entry);
                last = Some(request);
            }
            Err(error) => all.push(Log::refused(log, error, ends)?),
        }
    }
    let summary = Summary::of(&all);
    let counts = summary.counts;
    if options.json {
        Report { command: "advise", logs: &all, summary }.print()?;
    } else if !is_single {
        let advised = summary.advised.iter().map(|(scheme, count)| format!("{scheme} {count}"));
        let advised = advised.collect::<Vec<_>>().join(", ");
        answer(format_args!("channels by advised scheme: {advised}\n"))?;
    }
    if all.len() < logs.len() {
        bail!("stopped: {} of {} logs are left", logs.len() - all.len(), logs.len());
    }
    counts.check()?;
    if let ([Log { content: Some(advised), .. }], [path], Some(request)) =
        (&all[..], &logs[..], last)
    {
        options.write(path, &request, advised)?;
    }
    Ok(())
}

impl Advise {
    /// Writes the picture and the flight file of the only log, if they are asked for.
    fn write(&self, path: &Path, request: &AdviseRequest, advised: &Advised) -> Result<()> {
        if let (Some(picture), [advice], [recording]) =
            (&self.picture, &advised.channels[..], &request.recordings[..])
        {
            draw_advised(self, (picture, path), advice, recording)?;
        }
        if let (Some(output), Some(bank)) = (&self.output, &advised.bank) {
            let flight = bank.flight().map_err(|why| anyhow!("no flight is written: {why}"))?;
            let mut output = Output::open(Some(output), path)?;
            output.write_all(flight.to_toml(&bank.comments()).as_bytes())?;
            output.finish()?;
        }
        Ok(())
    }

    /// Reads a log, tells its notes and advises on it. Returns the request that was made, notes for the user on the log, and the advice.
    fn advised(
        &self,
        path: &Path,
        is_single: bool,
        stop: &Stop,
    ) -> Result<(AdviseRequest, Vec<String>, Advised)> {
        let read = |input: &InputOptions| Recording::read_all(&input.or(Unnamed::InertialOrAll));
        let recordings = self.channels.read(path, is_single, read)?;
        if self.picture.is_some() && recordings.len() > 1 {
            bail!("--picture draws one channel; --channels says which");
        }
        let notes = recordings.first().map(Recording::notes).unwrap_or_default();
        let notes = words::notes(&notes);
        if !self.json {
            let log = path.display().to_string();
            tell_of((!is_single).then_some(&*log), &notes);
        }
        let request = AdviseRequest {
            recordings,
            sample: self.sample,
            max_rmse: self.max_rmse.clone(),
            max_latency: self.max_latency,
            loop_bandwidth: self.loop_bandwidth,
            frame_loss: self.frame_loss,
            core: self.core.clone(),
            evaluations: self.evaluations,
            seconds: self.seconds,
            seed: self.seed,
        };
        let advised = self.searched(&request, stop)?;
        Ok((request, notes, advised))
    }

    /// Searches for the advice, and shows the progress.
    fn searched(&self, request: &AdviseRequest, stop: &Stop) -> Result<Advised> {
        let bar = ProgressBar::no_length()
            .with_style(ProgressStyle::with_template("{bar:40} {percent:>3} %  {msg}")?);
        let tell = |progress: &Progress| {
            bar.set_length(progress.total as u64);
            bar.set_position(progress.done as u64);
            bar.set_message(visible(&progress.words));
        };
        let watch = Watch { is_stopped: &|| stop.is_due(), tell: &tell };
        let channels = advise(request, &watch)?;
        let is_wanted = request.recordings.len() > 1 || self.output.is_some();
        let has_rate = request.recordings.iter().all(|recording| recording.rate.is_some());
        let bank = if is_wanted && (has_rate || self.output.is_some()) {
            Some(BankAdvice::new(request, &channels, &watch)?)
        } else {
            None
        };
        bar.finish_and_clear();
        Ok(Advised { channels, bank })
    }
}

impl Advised {
    fn page(&self) -> String {
        let pages = self.channels.iter().map(Advice::page);
        pages.chain(self.bank.as_ref().map(BankAdvice::page)).collect()
    }

    /// Checks that a scheme is advised for a channel.
    ///
    /// # Errors
    /// Returns an error, with the reasons, if none is advised for any channel.
    fn check(&self) -> Result<()> {
        if self.channels.iter().all(|advice| advice.best().is_none()) {
            let why: Vec<String> = self.channels.iter().map(Advice::why_not).collect();
            bail!("nothing can be advised: {}", why.join("; "));
        }
        Ok(())
    }
}

impl Summary {
    fn of(logs: &[Log<Advised>]) -> Self {
        let mut advised = BTreeMap::new();
        let channels =
            logs.iter().filter_map(|log| log.content.as_ref()).flat_map(|own| &own.channels);
        for (scheme, _) in channels.filter_map(Advice::best) {
            *advised.entry(scheme.name()).or_default() += 1;
        }
        Self { counts: Counts::of(logs), advised }
    }
}

/// Draws the recording of a log, its spikes and its reconstruction, and writes the picture to `picture`. Spikes and
/// reconstruction are those of the scheme in `advice`; without such a scheme, nothing is written.
fn draw_advised(
    options: &Advise,
    (picture, log): (&Path, &Path),
    advice: &Advice,
    recording: &Recording,
) -> Result<()> {
    let Some((scheme, row)) = advice.best() else { return Ok(()) };
    let parameters = row.settings.to_asked(scheme.info());
    let trials = [Trial::new(scheme, &parameters, options.sample, recording)?];
    Ok(draw(picture, log, &Picture::of(recording, &trials, 0..recording.values.len()))?)
}
