//! Reads a sequence of picture files as a video. Each file is a frame.

use super::FramesKind;
use super::video::{Rate, Video};
use crate::Result;
use image::{DynamicImage, GrayImage};
use std::path::{Path, PathBuf};

/// Picture files in the order of the frames, all of one size.
pub(super) struct Pictures {
    files: Vec<PathBuf>,
    first: PathBuf,
    size: (u16, u16),
    index: usize,
}

/// Returns whether a file's extension, such as `png`, is that of a picture.
pub(super) fn is_picture(path: &Path) -> bool {
    const ENDINGS: [&str; 6] = ["png", "jpg", "jpeg", "pgm", "ppm", "pnm"];
    let ending = path.extension().unwrap_or_default().to_ascii_lowercase();
    ENDINGS.iter().any(|known| ending == *known)
}

fn read(path: &Path) -> Result<GrayImage> {
    let picture = image::open(path).map_err(|error| FramesKind::NoPicture { error }.at(path))?;
    match picture {
        DynamicImage::ImageLuma16(_)
        | DynamicImage::ImageLumaA16(_)
        | DynamicImage::ImageRgb16(_)
        | DynamicImage::ImageRgba16(_)
        | DynamicImage::ImageRgb32F(_)
        | DynamicImage::ImageRgba32F(_) => Err(FramesKind::DeepPixels.at(path)),
        picture => Ok(picture.into_luma8()),
    }
}

impl Pictures {
    /// Opens picture files, which must all have the size of the first.
    ///
    /// # Errors
    /// Returns an error if the first picture cannot be read.
    pub(super) fn open(files: Vec<PathBuf>) -> Result<Self> {
        let first = files.first().ok_or(FramesKind::NoPictures)?.clone();
        let picture = read(&first)?;
        let size = [picture.width(), picture.height()].map(u16::try_from);
        let [Ok(width @ 1..), Ok(height @ 1..)] = size else {
            let (width, height) = picture.dimensions();
            return Err(FramesKind::Size { width, height }.at(first.as_path()));
        };
        Ok(Self { files, first, size: (width, height), index: 0 })
    }
}

impl Video for Pictures {
    fn size(&self) -> (u16, u16) {
        self.size
    }

    fn rate(&self) -> Option<Rate> {
        None
    }

    fn frames(&self) -> Option<u64> {
        Some(self.files.len() as u64)
    }

    fn next(&mut self, frame: &mut Vec<u8>) -> Result<bool> {
        let Some(path) = self.files.get(self.index) else { return Ok(false) };
        let picture = read(path)?;
        let (width, height) = self.size;
        if picture.dimensions() != (width.into(), height.into()) {
            let first = self.first.display().to_string();
            let (width, height) = picture.dimensions();
            let (frame, of_first) = (self.index, self.size);
            let kind = FramesKind::OtherSize { frame, width, height, first, of_first };
            return Err(kind.at(path.as_path()));
        }
        *frame = picture.into_raw();
        self.index += 1;
        Ok(true)
    }
}
