//! Writes settings as a constant for firmware, or as a TOML file for other commands.

use crate::Result;
use crate::coding::Coding;
use crate::scheme::Scheme;
use catalogue::run::{Constant, Settings};
use spikewire_flight::escaped;

/// Writes settings as a Rust constant, with `comments` before it. The constant is named after the channel, and compiles
/// where the crate `spikewire` is a dependency.
///
/// # Errors
/// Returns an error if the scheme cannot be written as a constant.
pub fn rust(
    comments: &[String],
    channel: &str,
    scheme: Scheme,
    settings: &Settings,
) -> Result<String> {
    let Constant { scheme: kind, value } = scheme.constant(settings)?;
    let comments: Vec<String> =
        comments.iter().map(|line| format!("/// {}\n", escaped(line))).collect();
    let name = constant_name(channel);
    // One long line, left to the formatter of whoever pastes it.
    Ok(format!("{}pub static {name}: {kind} = {value};\n", comments.concat()))
}

/// Writes settings as a TOML file of parameters, with `comments` at its start.
pub fn toml(comments: &[String], scheme: Scheme, settings: &Settings) -> String {
    Coding::of_settings(scheme, settings).to_toml(comments)
}

/// Returns the name of a channel's constant: `GYRO_RAD_0` for `gyro_rad[0]`.
fn constant_name(channel: &str) -> String {
    let words = channel.split(|letter: char| !letter.is_ascii_alphanumeric());
    let words: Vec<String> =
        words.filter(|word| !word.is_empty()).map(str::to_ascii_uppercase).collect();
    match words.join("_") {
        name if name.is_empty() => "CHANNEL".to_owned(),
        name if name.starts_with(|first: char| first.is_ascii_digit()) => format!("CHANNEL_{name}"),
        name => name,
    }
}

#[cfg(test)]
mod tests {
    use super::constant_name;

    #[test]
    fn names_of_constants() {
        for (channel, name) in [
            ("gyro_x", "GYRO_X"),
            ("gyro_rad[0]", "GYRO_RAD_0"),
            ("gyro_x (rad/s)", "GYRO_X_RAD_S"),
            ("2", "CHANNEL_2"),
            ("µ", "CHANNEL"),
        ] {
            assert_eq!(constant_name(channel), name);
        }
    }
}
