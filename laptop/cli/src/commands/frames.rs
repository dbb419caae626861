//! `spikewire frames`: converts a video to the events that an event camera would send, in constant memory.

use anyhow::{Context, Result, bail};
use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use lab::frames::{Preview, Rate, Sink, open};
use spikewire::{Polarity, Tick};
use spikewire_cameras::frame::{
    DynamicFrameEncoder, Intensity, LogIntensity, PixelCode, Refractory,
};
use std::io::{self, IsTerminal};
use std::path::{Path, PathBuf};

/// Convert a video to the events of its pixels, as an event camera would send them.
///
/// VIDEO is YUV4MPEG2 (`.y4m`, or `-`), pictures (`.png`, `.jpg`, `.pgm`, as files or a directory, in the order of
/// their names), or any format that an installed `ffmpeg` reads. Colours are ignored. The first frame sends nothing,
/// and sets a reference brightness for each pixel. A pixel sends an event if its brightness is more than a threshold
/// away from its reference, and each event moves the reference by the threshold. The threshold is in grey levels for
/// `--threshold`, and a difference of natural logarithms for `--contrast`.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  spikewire frames clip.y4m --threshold 10 -o events.es
  spikewire frames clip.mp4 --contrast 0.2 --most 8 --interpolate -o events.raw
  spikewire frames pictures --fps 30 --preview figure.png
  spikewire frames clip.mp4 --preview figure.gif --until 100")]
pub(crate) struct Frames {
    /// Video file, or several pictures
    #[arg(required = true)]
    video: Vec<PathBuf>,
    /// Threshold in grey levels, 1 to 254
    #[arg(long, conflicts_with = "contrast")]
    threshold: Option<u8>,
    /// Contrast threshold, as a difference of natural logarithms: 0.2 means 22 % brighter
    #[arg(long)]
    contrast: Option<f64>,
    /// Contrast threshold for pixels that get darker; default: --contrast
    #[arg(long, requires = "contrast")]
    contrast_off: Option<f64>,
    /// Maximum number of events of one pixel in a frame, 1 to 255
    #[arg(long, default_value_t = 1)]
    most: u8,
    /// Number of frames for which a pixel stays silent after a frame in which it sent events
    #[arg(long, default_value_t = 0)]
    refractory: u8,
    /// Maximum number of events in a frame. Further events are counted, and delayed to later frames
    #[arg(long)]
    budget: Option<u32>,
    /// Spread each pixel's events over the time since the previous frame. This time is divided into equal parts, as
    /// many as the value of --most
    #[arg(long)]
    interpolate: bool,
    /// Frames a second, such as `30` or `30000/1001`; default: the video's own rate, or 30 for pictures
    #[arg(long)]
    fps: Option<Rate>,
    /// File of events to write: `.es` (Event Stream), `.raw` (EVT2) or `.csv`
    #[arg(short, long)]
    output: Option<PathBuf>,
    /// Picture to draw: one frame and its events as `.png`, or all frames as `.gif`
    #[arg(long)]
    preview: Option<PathBuf>,
    /// Thresholds of the preview's panels, in grey levels; one panel for each
    #[arg(long, value_delimiter = ',', default_value = "1,10", requires = "preview")]
    panels: Vec<u8>,
    /// Frame that a `.png` preview shows, or that a `.gif` ends with, counted from 0; default: 30, or the last for a
    /// `.gif`
    #[arg(long, requires = "preview")]
    until: Option<u64>,
}

/// Runs the command.
///
/// # Errors
/// Returns an error if the options or the video are invalid, or if the output cannot be written.
pub(crate) fn run(options: &Frames) -> Result<()> {
    let Frames { threshold, contrast, most, .. } = options;
    match (threshold, contrast) {
        (Some(threshold), _) => {
            with_silence(options, Intensity::try_new(*threshold)?.try_with_most(*most)?)
        }
        (None, Some(on)) => {
            let on = levels("--contrast", *on)?;
            let off = options.contrast_off.map_or(Ok(on), |off| levels("--contrast-off", off))?;
            with_silence(options, LogIntensity::try_new(on, off)?.try_with_most(*most)?)
        }
        (None, None) if options.output.is_none() && options.preview.is_some() => {
            encode::<Intensity>(options, None)
        }
        (None, None) => bail!("events need --threshold or --contrast"),
    }
}

/// Converts a contrast, a difference of natural logarithms, to a whole number of steps of 1/1024.
///
/// # Errors
/// Returns an error that names `option` if the number of steps is outside 1 to 5673. From black to white there are 5673
/// steps.
fn levels(option: &str, contrast: f64) -> Result<u16> {
    const SCALE: f64 = 1024.0;
    const MOST: f64 = 5673.0;
    let levels = (SCALE * contrast).round();
    if !(1.0..=MOST).contains(&levels) {
        bail!("{option} {contrast} must lie in {:.4}..={:.4}", 0.5 / SCALE, MOST / SCALE);
    }
    Ok(levels as u16)
}

fn with_silence<C: PixelCode>(options: &Frames, code: C) -> Result<()> {
    match options.refractory {
        0 => encode(options, Some(code)),
        frames => encode(options, Some(Refractory::try_new(code, frames)?)),
    }
}

fn encode<C: PixelCode>(options: &Frames, code: Option<C>) -> Result<()> {
    let mut video = open(&options.video)?;
    let input = options.video.first().map_or(Path::new("-"), PathBuf::as_path);
    let (size, name) = (video.size(), input.display());
    let rate = options.fps.or(video.rate()).or(Rate::new(30, 1)).context("no frame rate")?;
    let mut encoder = match code {
        Some(code) => Some(encoder(code, size, options.budget)?),
        None => None,
    };
    let mut sink = match &options.output {
        Some(path) => Some(Sink::open(path, input, size)?),
        None => None,
    };
    let mut preview = match &options.preview {
        Some(path) => Some(Preview::open(path, input, size, rate, &options.panels, options.until)?),
        None => None,
    };
    let bar = bar(video.frames())?;

    let mut frame = Vec::new();
    let (mut ups, mut downs, mut busiest) = (0_u64, 0_u64, 0_u64);
    let mut frames = 0;
    while video.next(&mut frame)? {
        let tick = Tick::from_micros(rate.micros(frames));
        if let Some(encoder) = &mut encoder {
            let before = ups + downs;
            let mut written = Ok(());
            let emit = |event: spikewire_cameras::frame::PixelEvent| {
                *(if event.polarity == Polarity::Up { &mut ups } else { &mut downs }) += 1;
                if let (Some(sink), Ok(())) = (&mut sink, &written) {
                    written = sink.write(event);
                }
            };
            if options.interpolate {
                encoder.encode_interpolated(tick, &frame, emit)?;
            } else {
                encoder.encode_frame(tick, &frame, emit)?;
            }
            written?;
            busiest = busiest.max(ups + downs - before);
        }
        if let Some(preview) = &mut preview {
            preview.frame(frames, &frame)?;
        }
        frames += 1;
        bar.set_position(frames);
        bar.set_message(format!("{} events", ups + downs));
    }
    bar.finish_and_clear();
    if frames == 0 {
        bail!("{name}: holds no frame");
    }

    let seconds = rate.micros(frames) as f64 / 1e6;
    say!("{frames} frames of {} x {} pixels, {seconds:.2} s", size.0, size.1);
    if let Some(encoder) = encoder {
        let events = ups + downs;
        let per_second = events as f64 / seconds;
        say!(
            "{events} events, {ups} up and {downs} down: {per_second:.0} a second, at most {busiest} a frame"
        );
        if let Some(budget) = options.budget {
            say!(
                "{} events beyond {budget} a frame kept back, counted in each frame",
                encoder.over_budget()
            );
        }
    }
    if let Some(sink) = sink {
        say!("{} bytes written", sink.finish()?);
    }
    Ok(preview.map_or(Ok(()), Preview::finish)?)
}

fn encoder<C: PixelCode>(
    code: C,
    (width, height): (u16, u16),
    budget: Option<u32>,
) -> Result<DynamicFrameEncoder<C>> {
    let encoder = DynamicFrameEncoder::try_new(code, width, height)?;
    Ok(match budget {
        Some(budget) => encoder.try_with_budget(budget)?,
        None => encoder,
    })
}

/// Returns a progress bar that counts frames, with the total if it is known. The bar is hidden unless standard error is
/// a terminal.
fn bar(frames: Option<u64>) -> Result<ProgressBar> {
    if !io::stderr().is_terminal() {
        return Ok(ProgressBar::hidden());
    }
    Ok(match frames {
        Some(frames) => ProgressBar::new(frames).with_style(ProgressStyle::with_template(
            "{bar:40} {percent:>3} %  {human_pos} of {human_len} frames, {msg}, {eta} left",
        )?),
        None => ProgressBar::new_spinner().with_style(ProgressStyle::with_template(
            "{spinner} {elapsed} {human_pos} frames, {msg}",
        )?),
    })
}
