//! Tables as other programs write them, and files that are none.

mod common;

use common::{file, good, good_bytes, refused, spikewire_bytes, table, train};
use flate2::Compression;
use flate2::write::GzEncoder;
use std::fs;
use std::io::Write;

const SF: &str = "encode --scheme sf --threshold 0.5";

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

#[test]
fn delimiters_are_found() {
    for (signal, options) in [
        ("t;x\n0;0\n0.005;1\n", ""),
        ("t\tx\n0\t0\n0.005\t1\n", ""),
        ("t|x\n0|0\n0.005|1\n", ""),
        // As a spreadsheet in most of Europe writes it.
        ("t;x\n0;0\n0,005;1,0\n", ""),
        ("\"t\";\"x, of the body\"\n0;0\n0.005;1\n", ""),
        ("# by a logger\n\nt;x\n0;0\n0.005;1\n", ""),
        ("t x\n0 0\n0.005 1\n", "--delimiter space"),
        ("t:x\n0:0\n0.005:1\n", "--delimiter :"),
    ] {
        let ran = good(&format!("{SF} {options} -"), signal);
        assert!(ran.output.contains("\n1,0,1,5000\n"), "{signal}: {}", ran.output);
    }
    refused(&format!("{SF} --delimiter ab -"), "x\n1\n", &["one character, `tab` or `space`"]);
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
        ("gzip of UTF-16", gzip(&with_mark(b"\xff\xfe", &little))),
    ] {
        for channel in ["x", "3"] {
            let ran = spikewire_bytes(&format!("{SF} --column {channel} -"), &bytes);
            let output = String::from_utf8(ran.output).unwrap();
            assert!(output.contains("\n1,0,1,5000\n"), "{what}: {}", ran.told);
        }
        let ran = good_bytes(&format!("{SF} --column 2 -"), &bytes);
        assert!(String::from_utf8(ran.output).unwrap().contains("# column=roll µ\n"), "{what}");
    }
    // A file of spikes through a shell that writes UTF-16.
    let spikes = good(&format!("{SF} -"), &table(&[0.0, 1.0])).output;
    let wide: Vec<u8> = spikes.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let decoded = good_bytes("decode", &with_mark(b"\xff\xfe", &wide)).output;
    assert_eq!(decoded, good("decode", &spikes).output.as_bytes());
}

#[test]
fn other_files_are_named() {
    for (start, words) in [
        (&b"PK\x03\x04\x14\x00\x06\x00\x08\x00\x00\x00\x21\x00"[..], "spreadsheet"),
        (b"\xa3\x95\x80\x80\x59FMT\x00BBnNZ\x00\x00\x00\x00", "mavlogdump.py"),
        (b"#ROSBAG V2.0\nE", "a log needs --topic and --field"),
        (b"\x89MCAP0\r\n\x01\x00\x00", "a log needs --topic and --field"),
        (b"SQLite format 3\0\x10\0", "a log needs --topic and --field"),
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
        let told = common::spikewire(&format!("decode {path}"), "");
        assert_eq!((told.status, told.told.lines().count()), (2, 1), "{}", told.told);
        assert!(told.told.contains("binary") && told.told.len() < 300, "{}", told.told);
    }
}

#[test]
fn missing_values_are_skipped_if_that_is_wanted() {
    for missing in ["NA", "", "n/a", "NULL", "None", "-", "NaN", "<NA>"] {
        let signal = format!("t,x\n0,0\n0.005,{missing}\n0.01,1\n");
        refused(&format!("{SF} -"), &signal, &["line 3, column x", "--skip-non-finite"]);
        let ran = good(&format!("{SF} --skip-non-finite -"), &signal);
        assert!(ran.output.contains("# rejected=1,1\n2,0,1,10000\n"), "{missing}: {}", ran.output);
        assert!(ran.told.contains("1 samples were not finite or missing"), "{}", ran.told);
    }
    refused(&format!("{SF} --skip-non-finite -"), "x\n1\nabc\n", &["`abc` is not a number"]);
    let none = table(&[f64::NAN; 10]);
    let words = ["none of the 10 samples is finite"];
    refused(&format!("{SF} --skip-non-finite -"), &none, &words);
    let (_directory, path) = file("none.csv", none);
    refused(&format!("score --skip-non-finite {path}"), "", &words);
    // However late the first comes.
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
    good(&format!("{SF} {path} -o {spikes}"), "");
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
