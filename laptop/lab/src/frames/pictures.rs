//! A sequence of pictures, a file each.

use super::video::{Rate, Video};
use anyhow::{Context, Result, bail};
use image::{DynamicImage, GrayImage};
use std::path::{Path, PathBuf};

/// Pictures in the order of their names, or as they were given.
pub(super) struct Pictures {
    files: Vec<PathBuf>,
    first: PathBuf,
    size: (u16, u16),
    index: usize,
}

/// Whether a file's name is that of a picture.
pub(super) fn is_picture(path: &Path) -> bool {
    const ENDINGS: [&str; 6] = ["png", "jpg", "jpeg", "pgm", "ppm", "pnm"];
    let ending = path.extension().unwrap_or_default().to_ascii_lowercase();
    ENDINGS.iter().any(|known| ending == *known)
}

fn read(path: &Path) -> Result<GrayImage> {
    let name = path.display();
    let picture =
        image::open(path).with_context(|| format!("{name}: cannot be read as a picture"))?;
    match picture {
        DynamicImage::ImageLuma16(_)
        | DynamicImage::ImageLumaA16(_)
        | DynamicImage::ImageRgb16(_)
        | DynamicImage::ImageRgba16(_)
        | DynamicImage::ImageRgb32F(_)
        | DynamicImage::ImageRgba32F(_) => {
            bail!("{name}: pixels of more than the 8 bits that are taken")
        }
        picture => Ok(picture.into_luma8()),
    }
}

impl Pictures {
    /// Takes the size from the first.
    ///
    /// # Errors
    /// The first cannot be read.
    pub(super) fn open(files: Vec<PathBuf>) -> Result<Self> {
        let first = files.first().context("no pictures")?.clone();
        let picture = read(&first)?;
        let size = [picture.width(), picture.height()].map(u16::try_from);
        let [Ok(width @ 1..), Ok(height @ 1..)] = size else {
            bail!(
                "{}: {} x {} pixels, where 1 to 65535 columns and rows are taken",
                first.display(),
                picture.width(),
                picture.height()
            );
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
            bail!(
                "{}: frame {} has {} x {} pixels, where {} has {width} x {height}",
                path.display(),
                self.index,
                picture.width(),
                picture.height(),
                self.first.display()
            );
        }
        *frame = picture.into_raw();
        self.index += 1;
        Ok(true)
    }
}
