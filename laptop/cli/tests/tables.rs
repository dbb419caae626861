//! Tests with tables as other programs write them, and with files that are not tables.

mod common;

use common::{file, good, good_bytes, ran, refused, spikewire_bytes, table, train};
use flate2::Compression;
use flate2::write::GzEncoder;
use std::fs;
use std::io::Write;

const SF: &str = "encode --scheme sf --threshold 0.5";

fn zstd(bytes: &[u8]) -> Vec<u8> {
    ruzstd::encoding::compress_to_vec(bytes, ruzstd::encoding::CompressionLevel::Fastest)
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

#[test]
fn other_encodings_and_compressed_tables_are_read() {
    let text = "t,roll µ,x\n0,1,0\n0.005,1,1\n";
    let utf16 = |to_bytes: fn(u16) -> [u8; 2]| -> Vec<u8> {
        text.encode_utf16().flat_map(to_bytes).collect()
    };
    let latin1: Vec<u8> = text.chars().map(|letter| letter as u8).collect();
    let with_mark = |mark: &[u8], text: &[u8]| [mark, text].concat();
    let (little, big) = (utf16(u16::to_le_bytes), utf16(u16::to_be_bytes));
    for (what, bytes) in [
        ("UTF-8", text.as_bytes().to_vec()),
        ("UTF-8, marked", with_mark(b"\xef\xbb\xbf", text.as_bytes())),
        ("Latin-1", latin1),
        ("UTF-16, marked", with_mark(b"\xff\xfe", &little)),
        ("UTF-16, marked, big", with_mark(b"\xfe\xff", &big)),
        ("UTF-16", little.clone()),
        ("UTF-16, big", big),
        ("gzip", gzip(text.as_bytes())),
        ("Zstandard", zstd(text.as_bytes())),
        ("Zstandard of UTF-16, marked", zstd(&with_mark(b"\xff\xfe", &little))),
        ("gzip of UTF-16", gzip(&with_mark(b"\xff\xfe", &little))),
    ] {
        for channel in ["x", "3"] {
            let ran = spikewire_bytes(&format!("{SF} --column {channel} -"), &bytes);
            let output = String::from_utf8(ran.output).unwrap();
            assert!(output.contains("\n1,0,1,5000\n"), "{what}: {}", ran.stderr);
        }
        let ran = good_bytes(&format!("{SF} --column 2 -"), &bytes);
        assert!(String::from_utf8(ran.output).unwrap().contains("# column=roll µ\n"), "{what}");
    }
    // A file of spikes, redirected by a shell that writes UTF-16.
    let spikes = good(&format!("{SF} -"), &table(&[0.0, 1.0])).output;
    let wide: Vec<u8> = spikes.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let decoded = good_bytes("decode", &with_mark(b"\xff\xfe", &wide)).output;
    assert_eq!(decoded, good("decode", &spikes).output.as_bytes());
}

/// A Zstandard file may consist of several frames, and some of them may be skippable. Compressors that use several
/// cores write such files.
#[test]
fn all_frames_of_zstandard_are_read() {
    let skipped = b"\x5a\x2a\x4d\x18\x03\0\0\0abc";
    let (first, rest) = (zstd(b"x\n0\n1"), zstd(b".5\n0\n"));
    let whole = [&first[..], skipped, &rest, skipped].concat();
    let ran = good_bytes(&format!("{SF} -"), &whole).output;
    assert!(String::from_utf8(ran).unwrap().contains("# samples=3\n"));
    let mut damaged = whole.clone();
    damaged[first.len() - 1] ^= 1;
    for (bytes, words) in [
        (&whole[..whole.len() - skipped.len() - 1], "standard input"),
        (&whole[..first.len() + 9], "standard input"),
        (&damaged[..], "damaged"),
    ] {
        let ran = spikewire_bytes(&format!("{SF} -"), bytes);
        assert!(ran.status == 2 && ran.stderr.contains(words), "{}", ran.stderr);
    }
}

/// Returns an array as `NumPy` writes it.
fn npy(descr: &str, shape: &str, data: &[&[u8]]) -> Vec<u8> {
    let header = format!("{{'descr': {descr}, 'fortran_order': False, 'shape': {shape}, }}\n");
    let length = (header.len() as u16).to_le_bytes();
    [b"\x93NUMPY\x01\0", &length[..], header.as_bytes(), &data.concat()].concat()
}

#[test]
fn arrays_of_numpy_are_read() {
    let spikes = |array: &[u8], column: &str| {
        let ran = good_bytes(&format!("{SF} {column} -"), array);
        String::from_utf8(ran.output).unwrap()
    };
    let row = |time: i64, x: f64| [time.to_le_bytes(), x.to_le_bytes()].concat();
    let fields = npy("[('t_ms', '<i8'), ('x', '<f8')]", "(2,)", &[&row(0, 0.0), &row(5, 1.0)]);
    assert!(spikes(&fields, "").contains("\n1,0,1,5000\n"));
    assert_eq!(spikes(&gzip(&fields), ""), spikes(&fields, ""));
    let text = npy(
        "[('s', '|S3'), ('x', '>f4'), ('i', '|i1')]",
        "(2,)",
        &[b"abc\0\0\0\0\0", b"abc\x3f\x80\0\0\xff"],
    );
    assert!(spikes(&text, "--column x").contains("\n1,0,1\n"));
    assert!(spikes(&text, "--column i").contains("\n1,0,-1\n"));
    let plain = npy("'<u2'", "(2, 3)", &[&[1, 0, 2, 0, 3, 0, 1, 0, 2, 0, 4, 0]]);
    assert!(spikes(&plain, "--column 3").contains("# first=3\n"));
    assert!(spikes(&plain, "--column 3").contains("\n1,0,1\n"));
    // Stored column by column.
    let mut turned = npy("'<u2'", "(2, 3)", &[&[1, 0, 1, 0, 2, 0, 2, 0, 3, 0, 4, 0]]);
    let at = turned.windows(5).position(|own| own == b"False").unwrap();
    turned[at..at + 5].copy_from_slice(b"True ");
    assert_eq!(spikes(&turned, "--column 3"), spikes(&plain, "--column 3"));
    for (array, words) in [
        (npy("'<c16'", "(1,)", &[&[0; 16]]), "no array of numbers"),
        (npy("'<f8'", "(1, 1, 1)", &[&[0; 8]]), "one or two dimensions"),
        (npy("[('x', '<f8', (2,))]", "(1,)", &[&[0; 16]]), "no array of numbers"),
        (npy("'<f8'", "(2,)", &[&[0; 15]]), "standard input"),
        (npy("'<f8'", "(2, 1000000000)", &[]), "no array of numbers"),
        (b"\x93NUMPY\x01\0\xff\xff{}".to_vec(), "no array of numbers"),
    ] {
        let ran = spikewire_bytes(&format!("{SF} -"), &array);
        assert!(ran.status == 2 && ran.stderr.contains(words), "{words}: {}", ran.stderr);
    }
}

#[test]
fn other_files_are_named() {
    for (start, words) in [
        (&b"PK\x03\x04\x14\x00\x06\x00\x08\x00\x00\x00\x21\x00"[..], "spreadsheet"),
        (b"\xa3\x95\x80\x80\x59FMT\x00BBnNZ\x00\x00\x00\x00", "the log ends within a message"),
        (b"#ROSBAG V2.0\nE", "the bag ends within the record"),
        (b"\x89MCAP0\r\n\x01\x00\x00", "the file ends within the record"),
        (b"SQLite format 3\0\x10\0", "shorter than its head"),
        (b"\x00\x01\x02\x03\x04\x05", "binary, no table"),
        (b"\x1f\x8b\x08\x00", "cannot be unpacked"),
    ] {
        let (_directory, path) = file("log.bin", start);
        refused(&format!("{SF} {path}"), "", &[words, "log.bin"]);
    }
}

#[test]
fn a_binary_file_is_no_file_of_spikes() {
    let mut noise: Vec<u8> =
        (0..5000_u32).map(|byte| (byte.wrapping_mul(2_654_435_761) >> 13) as u8).collect();
    for start in
        [&b"\x7fELF\x02\x01\x01"[..], b"# spikewire=1\n\x01\x02", b"\xff\xd8\xff\xe0\x00\x10JFIF"]
    {
        noise.splice(..start.len(), start.iter().copied());
        let (_directory, path) = file("spikes", &noise);
        let report = common::spikewire(&format!("decode {path}"), "");
        assert_eq!((report.status, report.stderr.lines().count()), (2, 1), "{}", report.stderr);
        assert!(report.stderr.contains("binary") && report.stderr.len() < 300, "{}", report.stderr);
    }
}

/// The program reads a table even if the values in its first 20 000 rows are missing.
#[test]
fn missing_values_may_come_first() {
    let late = [vec![f64::NAN; 20_000], vec![0.0, 1.0]].concat();
    let ran = good(&format!("{SF} --skip-non-finite -"), &table(&late)).output;
    assert_eq!(train(&ran)[20_001], 1);
    assert!(ran.contains("# first=0\n"), "{}", &ran[..200]);
}

#[test]
fn outputs_never_overwrite_their_input() {
    let (directory, path) = file("x.csv", table(&[0.0, 1.0]));
    let link = directory.path().join("link.csv");
    std::os::unix::fs::symlink(&path, &link).unwrap();
    for output in [path.clone(), link.display().to_string()] {
        refused(&format!("{SF} {path} -o {output}"), "", &["the input itself"]);
    }
    let spikes = directory.path().join("spikes.csv").display().to_string();
    ran!("{SF} {path} -o {spikes}");
    let before = fs::read(&spikes).unwrap();
    refused(&format!("decode {spikes} -o {spikes}"), "", &["the input itself"]);
    for command in ["convert --from csv --to csv", "listen --from csv"] {
        refused(&format!("{command} {spikes} -o {spikes}"), "", &["the input itself"]);
    }
    let picture = directory.path().join("x.svg").display().to_string();
    fs::copy(&path, &picture).unwrap();
    let plot = format!("plot --scheme sf --threshold 1 {picture} -o {picture}");
    refused(&plot, "", &["the input itself"]);
    let status = std::process::Command::new(env!("CARGO_BIN_EXE_spikewire"))
        .args(["decode", "-", "-o", &spikes])
        .stdin(fs::File::open(&spikes).unwrap())
        .stderr(std::process::Stdio::null())
        .status();
    assert_eq!(status.unwrap().code(), Some(2));
    assert_eq!(fs::read(&spikes).unwrap(), before);
}

#[test]
fn outputs_follow_links() {
    let directory = tempfile::tempdir().unwrap();
    let at = |name: &str| directory.path().join(name);
    fs::create_dir(at("runs")).unwrap();
    fs::write(at("runs/old.csv"), "old").unwrap();
    for (link, to, file) in [
        ("latest.csv", "runs/old.csv", "runs/old.csv"),
        ("next.csv", "runs/new.csv", "runs/new.csv"),
    ] {
        std::os::unix::fs::symlink(to, at(link)).unwrap();
        good(&format!("{SF} - -o {}", at(link).display()), &table(&[0.0, 1.0]));
        assert!(fs::symlink_metadata(at(link)).unwrap().is_symlink(), "{link}");
        assert!(fs::read_to_string(at(file)).unwrap().starts_with("# spikewire=1\n"), "{file}");
    }
}
