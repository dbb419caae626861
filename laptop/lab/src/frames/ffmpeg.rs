//! Reads videos that are neither YUV4MPEG2 nor pictures by running `ffmpeg`.

use super::FramesKind;
use super::video::{Rate, Video};
use super::y4m::Y4m;
use crate::Result;
use std::env;
use std::io::{self, BufReader, Read};
use std::path::Path;
use std::process::{Child, ChildStdout, Command, Stdio};
use std::thread::JoinHandle;

/// Pixel format that `ffmpeg` is asked for: 8 bits of full-range brightness. `ffmpeg` then leaves the brightness of
/// grey and full-range videos unchanged. It expands a limited range, 16 to 235, to the full range, as [`Y4m`] does.
const GREY: &str = "gray";

/// The frames into which `ffmpeg` converts a file.
pub(super) struct Converted {
    video: Y4m<BufReader<ChildStdout>>,
    child: Child,
    said: Option<JoinHandle<String>>,
    name: String,
}

impl Converted {
    /// Starts `ffmpeg`, or the program named by the environment variable `FFMPEG`, on a file.
    ///
    /// # Errors
    /// Returns an error if `ffmpeg` is missing or cannot read the file.
    pub(super) fn open(input: &Path) -> Result<Self> {
        let name = input.display().to_string();
        let program = env::var_os("FFMPEG").unwrap_or_else(|| "ffmpeg".into());
        let started = Command::new(&program)
            .args(["-nostdin", "-v", "error", "-i"])
            .arg(input)
            .args(["-map", "0:v:0", "-pix_fmt", GREY, "-f", "yuv4mpegpipe", "-"])
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn();
        let mut child = started.map_err(|error| {
            let program = program.display().to_string();
            match error.kind() {
                io::ErrorKind::NotFound => FramesKind::NoFfmpeg { program }.at(&name),
                _ => FramesKind::NotStarted { program, error }.into(),
            }
        })?;
        let output = child.stdout.take().ok_or(FramesKind::NoOutput)?;
        let errors = child.stderr.take().ok_or(FramesKind::NoOutput)?;
        let mut said = Some(std::thread::spawn(move || {
            let mut text = Vec::new();
            let mut errors = errors;
            let _ = errors.by_ref().take(1 << 16).read_to_end(&mut text);
            // More text is of no use, but left unread it would block `ffmpeg`.
            let _ = io::copy(&mut errors, &mut io::sink());
            String::from_utf8_lossy(&text).trim().to_owned()
        }));
        match Y4m::open(BufReader::new(output), name.clone(), None) {
            Ok(video) => Ok(Self { video, child, said, name }),
            Err(error) => {
                let _ = child.kill();
                let _ = child.wait();
                match words(&mut said) {
                    text if text.is_empty() => Err(error),
                    said => Err(FramesKind::Ffmpeg { said }.at(name)),
                }
            }
        }
    }
}

/// Waits for the end of `ffmpeg`, and returns all its messages in one line. A second call returns an empty text.
fn words(said: &mut Option<JoinHandle<String>>) -> String {
    let text = said.take().and_then(|said| said.join().ok()).unwrap_or_default();
    text.lines().collect::<Vec<_>>().join("; ")
}

impl Video for Converted {
    fn size(&self) -> (u16, u16) {
        self.video.size()
    }

    fn rate(&self) -> Option<Rate> {
        self.video.rate()
    }

    fn frames(&self) -> Option<u64> {
        None
    }

    fn next(&mut self, frame: &mut Vec<u8>) -> Result<bool> {
        let Self { video, child, said, name } = self;
        if video.next(frame)? {
            return Ok(true);
        }
        if said.is_some() {
            let said = words(said);
            let status = child.wait()?;
            if !status.success() || !said.is_empty() {
                return Err(FramesKind::FfmpegEnded { status, said }.at(&*name));
            }
        }
        Ok(false)
    }
}

impl Drop for Converted {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
