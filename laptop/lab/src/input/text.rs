//! Opens tables as text. Compressed tables and tables in UTF-16 are converted.

use super::TableKind;
use crate::Result;
use crate::error::At;
use flight_logs::Packing;
use std::io::{self, Cursor, Read};

/// Number of bytes that are read from the start of a file to recognise the kind of the file.
const HEAD: usize = 16;

const PARQUET: &str = if cfg!(feature = "datasets") {
    "a Parquet file; it is read from a file only, not compressed once more"
} else {
    "a Parquet file; export it as CSV"
};

/// Kinds of files that are not tables. Each entry has the first bytes of such a file, and a text for the user. The text
/// names the kind of file and suggests what to do.
const OTHERS: [(&[u8], &str); 12] = [
    (b"PK\x03\x04", "a zip archive or a spreadsheet; export it as CSV"),
    (b"\xd0\xcf\x11\xe0", "an old spreadsheet; export it as CSV"),
    (b"\xa3\x95", "an ArduPilot log; it is read from a file only"),
    (b"H Product:Blackbox", "a Betaflight log; it is read from a file only"),
    (b"#ROSBAG", "a ROS bag; it is read from a file only"),
    (b"SQLite format 3", "a database, perhaps a ROS 2 bag; those are read from a file only"),
    (b"\x89MCAP", "an MCAP file; it is read from a file only"),
    (b"PAR1", PARQUET),
    (b"ARROW1", "an Arrow or Feather file; export it as Parquet or CSV"),
    (b"\x89HDF", "an HDF5 or MATLAB file; export it as CSV"),
    (b"MATLAB", "a MATLAB file; export it as CSV"),
    (b"ULog", "a flight log; it is read from a file only"),
];

/// Returns a reader of a file as text. Unpacks files that are packed with gzip or zstd, and converts UTF-16 to UTF-8.
/// Does not change text in any other encoding that extends ASCII. `name` is the file's name in errors.
///
/// # Errors
/// Returns an error if the file is not text.
pub fn text(input: impl Read + 'static, name: &str) -> Result<Box<dyn Read>> {
    let (head, input) = unpacked(input, name)?;
    decode(&head, input, name)
}

/// Decompresses a file. Returns its first bytes, and a reader of the whole file.
///
/// # Errors
/// Returns an error if the file cannot be read or decompressed.
pub(super) fn unpacked(input: impl Read + 'static, name: &str) -> Result<(Vec<u8>, Box<dyn Read>)> {
    let (head, input) = peek(input).at(|| name)?;
    let Some(packing) = Packing::of(&head) else { return Ok((head, Box::new(input))) };
    let (head, input) =
        peek(packing.reader(input)).map_err(|error| TableKind::NotUnpacked { error }.at(name))?;
    Ok((head, Box::new(input)))
}

/// Decodes a name in a table from UTF-8, or from Latin-1 if the bytes are not UTF-8.
pub(super) fn name(bytes: &[u8]) -> String {
    match str::from_utf8(bytes) {
        Ok(text) => text.trim().to_owned(),
        Err(_) => encoding::latin(bytes).trim().to_owned(),
    }
}

/// Formats bytes for a message. Bytes that are not UTF-8 and control characters are escaped; a long text is cut after
/// 60 characters.
pub fn shown(bytes: &[u8]) -> String {
    const MOST: usize = 60;
    let mut text = String::new();
    for chunk in bytes.utf8_chunks() {
        for own in chunk.valid().chars() {
            if own.is_control() { text.extend(own.escape_default()) } else { text.push(own) }
        }
        text.extend(chunk.invalid().escape_ascii().map(char::from));
    }
    match text.char_indices().nth(MOST) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text,
    }
}

/// Converts text in UTF-16 to UTF-8, and removes the byte order mark of UTF-8. Other text stays as it is. `head` holds
/// the first bytes of the input.
///
/// # Errors
/// Returns an error if the input is not text.
pub(super) fn decode(head: &[u8], input: impl Read + 'static, name: &str) -> Result<Box<dyn Read>> {
    let is_utf16 = head.len() >= 4 && head.len().is_multiple_of(2);
    match *head {
        [0xff, 0xfe, ..] => return encoding::utf16(input, false, name),
        [0xfe, 0xff, ..] => return encoding::utf16(input, true, name),
        [1..=255, 0, 1..=255, 0, ..] if is_utf16 => return encoding::utf16(input, false, name),
        [0, 1..=255, 0, 1..=255, ..] if is_utf16 => return encoding::utf16(input, true, name),
        [0xef, 0xbb, 0xbf, ..] => {
            let mut input = input;
            input.read_exact(&mut [0; 3])?;
            return Ok(Box::new(input));
        }
        _ => {}
    }
    for (start, what) in OTHERS {
        // Only `HEAD` bytes of the file are known, fewer than some of these starts have.
        if head.starts_with(&start[..start.len().min(HEAD)]) {
            return Err(TableKind::NoTable { what }.at(name));
        }
    }
    if head.iter().any(|byte| matches!(byte, 0..=8 | 14..=31)) {
        return Err(TableKind::NoTable { what: "binary, no table" }.at(name));
    }
    Ok(Box::new(input))
}

/// Reads the first bytes of an input. Returns these bytes, and a reader of the whole input.
fn peek<R: Read>(mut input: R) -> io::Result<(Vec<u8>, impl Read + use<R>)> {
    let mut head = Vec::new();
    input.by_ref().take(HEAD as u64).read_to_end(&mut head)?;
    Ok((head.clone(), Cursor::new(head).chain(input)))
}

#[cfg(not(target_family = "wasm"))]
mod encoding {
    use crate::Result;
    use encoding_rs::{UTF_16BE, UTF_16LE, WINDOWS_1252};
    use encoding_rs_io::DecodeReaderBytesBuilder;
    use std::borrow::Cow;
    use std::io::Read;

    pub(super) fn latin(bytes: &[u8]) -> Cow<'_, str> {
        WINDOWS_1252.decode_without_bom_handling(bytes).0
    }

    #[expect(clippy::unnecessary_wraps, reason = "in a browser it is refused")]
    pub(super) fn utf16(
        input: impl Read + 'static,
        is_big_endian: bool,
        _: &str,
    ) -> Result<Box<dyn Read>> {
        let encoding = if is_big_endian { UTF_16BE } else { UTF_16LE };
        Ok(Box::new(DecodeReaderBytesBuilder::new().encoding(Some(encoding)).build(input)))
    }
}

/// Text decoders for the web page. They decode only Latin-1, because the conversion tables of all encodings would make
/// up a tenth of the page. The browser decodes files in other encodings before this library reads them.
#[cfg(target_family = "wasm")]
mod encoding {
    use crate::Result;
    use crate::input::TableKind;
    use std::io::Read;

    pub(super) fn latin(bytes: &[u8]) -> String {
        bytes.iter().copied().map(char::from).collect()
    }

    pub(super) fn utf16(_: impl Read + 'static, _: bool, name: &str) -> Result<Box<dyn Read>> {
        Err(TableKind::NoTable { what: "text in UTF-16; save it as UTF-8" }.at(name))
    }
}
