//! Reads filters: by the name of a shape, as a list, or from a file.

use std::fs;
use std::path::Path;

use spikewire::rate::Shape;

use super::Value;
use super::error::{ErrorKind, Result};

/// Reads taps from a list or a file, or the name of a shape, which is checked. The path of a file is relative to
/// `directory`.
///
/// # Errors
/// Returns an error if there is no such shape or file, or if the list contains something else than numbers.
pub(super) fn read(text: &str, directory: &Path) -> Result<Value> {
    if let Some(taps) = shape(text) {
        return taps.map(|_| Value::Word(text.to_owned().into()));
    }
    let taps = listed(text).map_or_else(|| from_file(&directory.join(text)), Ok)?;
    Ok(Value::Numbers(taps))
}

/// Returns the taps of a shape, such as `triang:15`.
///
/// # Errors
/// Returns an error if there is no such shape.
pub fn taps(text: &str) -> Result<Vec<f64>> {
    shape(text).unwrap_or_else(|| Err(ErrorKind::NoShape.into()))
}

/// Returns the taps of a shape; `None` if the text does not name one.
fn shape(text: &str) -> Option<Result<Vec<f64>>> {
    let (shape, scale) =
        text.split_once(',').map_or((text, None), |(shape, scale)| (shape, Some(scale)));
    Some(match shape.split(':').collect::<Vec<_>>()[..] {
        ["triang", length] => shaped(Shape::Triangular, length, scale),
        ["hann", length] => shaped(Shape::Hann, length, scale),
        ["gauss", length] => shaped(Shape::Gaussian { alpha: 2.5 }, length, scale),
        ["gauss", length, alpha] => positive("alpha", alpha)
            .and_then(|alpha| shaped(Shape::Gaussian { alpha }, length, scale)),
        _ => return None,
    })
}

/// Parses taps separated by commas: `0.5,1,0.5`, or `1,` for a single one.
fn listed(text: &str) -> Option<Vec<f64>> {
    let taps = text.strip_suffix(',').or_else(|| text.contains(',').then_some(text))?;
    let taps =
        taps.split(',').map(|tap| tap.trim().parse().ok().filter(|tap: &f64| tap.is_finite()));
    taps.collect()
}

fn shaped(shape: Shape, length: &str, scale: Option<&str>) -> Result<Vec<f64>> {
    const LONGEST: usize = 4096;
    let Ok(length @ 1..=LONGEST) = length.parse() else {
        let length = length.to_owned();
        return Err(ErrorKind::LengthOfShape { length, most: LONGEST }.into());
    };
    let taps = (0..length).map(|tap| shape.at(tap, length));
    let factor = match scale.map(|scale| scale.split_once('=')) {
        None => 1.0,
        Some(Some(("peak", peak))) => positive("peak", peak)?,
        Some(Some(("sum", sum))) => {
            let sum = positive("sum", sum)?;
            sum / taps.clone().sum::<f64>()
        }
        Some(_) => return Err(ErrorKind::ScaleOfShape.into()),
    };
    Ok(taps.map(|tap| tap * factor).collect())
}

fn positive(part: &'static str, text: &str) -> Result<f64> {
    match text.parse() {
        Ok(value) if value > 0.0 && f64::is_finite(value) => Ok(value),
        _ => Err(ErrorKind::PartOfShape { part, text: text.to_owned() }.into()),
    }
}

fn from_file(path: &Path) -> Result<Vec<f64>> {
    let text = fs::read_to_string(path).map_err(|error| ErrorKind::NoTaps { error })?;
    let file = path.display().to_string();
    let mut taps = Vec::new();
    for (line, content) in (1..).zip(text.lines()) {
        let words = content.split([',', ' ', '\t']).filter(|word| !word.is_empty());
        for (place, word) in (1..).zip(words) {
            match word.parse::<f64>() {
                Ok(tap) if tap.is_finite() => taps.push(tap),
                _ => {
                    let word = word.to_owned();
                    return Err(ErrorKind::BadTap { file, line, number: place, word }.into());
                }
            }
        }
    }
    if taps.is_empty() {
        return Err(ErrorKind::NoTap { file }.into());
    }
    Ok(taps)
}

#[cfg(test)]
mod tests {
    use super::{Result, Value, taps};
    use std::path::Path;

    fn read(text: &str) -> Result<Value> {
        super::read(text, Path::new(""))
    }

    #[test]
    fn shapes_and_scales() {
        assert_eq!(taps("triang:3").unwrap(), [0.5, 1.0, 0.5]);
        assert_eq!(taps("triang:3,peak=4").unwrap(), [2.0, 4.0, 2.0]);
        assert_eq!(taps("triang:3,sum=1").unwrap(), [0.25, 0.5, 0.25]);
        assert_eq!(read("0.5,1,-2").unwrap(), Value::from(vec![0.5, 1.0, -2.0]));
        assert_eq!(read("4,").unwrap(), Value::from(vec![4.0]));
        assert!((taps("gauss:3:2").unwrap()[0] - (-2.0_f64).exp()).abs() < 1e-12);
        for bad in [
            "triang:0",
            "hann:x",
            "gauss:3:-1",
            "triang:3,sum=0",
            "triang:3,width=1",
            "box:3",
            "1,x",
            "1,inf",
        ] {
            assert!(read(bad).is_err(), "{bad}");
        }
    }
}
