//! Names of a flight's channels: the axis of the sensor that each takes. `cargo xtask new-firmware` checks a flight's file by
//! this file, too.

/// rad of 1°.
pub(crate) const RADIANS: f64 = core::f64::consts::PI / 180.0;
/// m/s² of 1 g.
pub(crate) const G: f64 = 9.806_65;

/// Ends of names that are units.
const ENDS: [&[u8]; 5] = [b"_dps", b"_deg_s", b"_rad_s", b"_m_s2", b"_g"];

/// Returns the axis of a channel's name: rates about x, y and z are 0 to 2, accelerations 3 to 5.
pub(crate) const fn axis(name: &str) -> Option<usize> {
    let bytes = name.as_bytes();
    let mut end = bytes.len();
    while end > 0 && matches!(bytes[end - 1], b']' | b')' | b' ') {
        end -= 1;
    }
    let mut unit = 0;
    while unit < ENDS.len() {
        if ends_with(bytes, end, ENDS[unit]) {
            end -= ENDS[unit].len();
        }
        unit += 1;
    }
    let letter = if end > 0 { bytes[end - 1].to_ascii_lowercase() } else { 0 };
    let own = match letter {
        b'x' | b'0' => 0,
        b'y' | b'1' => 1,
        b'z' | b'2' => 2,
        _ => return None,
    };
    if has(bytes, b"acc") {
        Some(3 + own)
    } else if has(bytes, b"gyro") || has(bytes, b"rate") {
        Some(own)
    } else {
        None
    }
}

/// Returns whether the first `end` bytes of a text end with a part, in lower case or not.
const fn ends_with(text: &[u8], end: usize, part: &[u8]) -> bool {
    if end < part.len() {
        return false;
    }
    let mut at = 0;
    while at < part.len() {
        if !text[end - part.len() + at].eq_ignore_ascii_case(&part[at]) {
            return false;
        }
        at += 1;
    }
    true
}

/// Returns whether a text has a part, in lower case or not.
const fn has(text: &[u8], part: &[u8]) -> bool {
    let mut end = part.len();
    while end <= text.len() {
        if ends_with(text, end, part) {
            return true;
        }
        end += 1;
    }
    false
}
