//! `convert`: round trips through every event format, and the limits of each format.

mod common;

use common::{file, good_bytes, ran, refused, spikewire_bytes};
use std::fmt::Write;

/// Formats that can express any event with a 14-bit address, provided that time rises in small steps.
const FORMATS: [&str; 13] = [
    "link",
    "link,period=5000,channels=6,jitter=5",
    "edvs:e1",
    "edvs:e1,up=0",
    "edvs:e2",
    "edvs:e3",
    "edvs:e4",
    "edvs:e4,up=0",
    "es",
    "evt2",
    "evt3",
    "eieio,base=9,step=1,signed=1",
    "csv",
];

/// Returns a CSV table of events, given as (tick, address, polarity).
fn table(events: impl IntoIterator<Item = (u32, u16, i8)>) -> String {
    let mut table = "tick,address,polarity\n".to_owned();
    for (tick, address, polarity) in events {
        writeln!(table, "{tick},{address},{polarity}").unwrap();
    }
    table
}

/// Returns a CSV table of 1499 events, with three at each tick, and addresses up to 16 383.
fn events() -> String {
    table((1..1500_u32).map(|i| {
        let address = (i * 7919 % 16_384) as u16;
        (i / 3 * 997, address, if i % 5 < 2 { -1 } else { 1 })
    }))
}

fn convert(from: &str, to: &str, input: &[u8]) -> common::RanBytes {
    good_bytes(&format!("convert --from {from} --to {to}"), input)
}

/// Returns the lines of a CSV table, without comments.
fn rows(table: &[u8]) -> String {
    let text = str::from_utf8(table).unwrap();
    text.lines()
        .filter(|line| !line.starts_with('#'))
        .fold(String::new(), |rows, line| rows + line + "\n")
}

#[test]
fn every_format_gives_back_what_it_was_given() {
    let events = events();
    for format in FORMATS {
        let there = convert("csv", format, events.as_bytes());
        assert!(there.stderr.contains("1499 events at"), "{format}: {}", there.stderr);
        assert!(!there.stderr.contains("another time"), "{format}: {}", there.stderr);
        let back = convert(format, "csv", &there.output);
        assert_eq!(rows(&back.output), events, "{format}");
        assert!(back.stderr.contains("\n0 bytes skipped\n"), "{format}: {}", back.stderr);
    }
}

#[test]
fn every_format_is_read_from_every_other() {
    let events = events();
    for from in FORMATS {
        let bytes = convert("csv", from, events.as_bytes()).output;
        for to in ["link", "edvs:e1", "es", "evt2"] {
            let direct = convert("csv", to, events.as_bytes()).output;
            assert!(convert(from, to, &bytes).output == direct, "{from} to {to}");
        }
    }
}

#[test]
fn bytes_are_golden() {
    let bytes =
        |format: &str, tick| convert("csv", format, table([(tick, 0x105, 1)]).as_bytes()).output;
    assert_eq!(bytes("edvs:e0", 0), [0x82, 0x85]);
    assert_eq!(bytes("edvs:e1", 0x80), [0x82, 0x85, 0x01, 0x80]);
    assert_eq!(bytes("edvs:e2,up=0", 0x1234), [0x82, 0x05, 0x12, 0x34]);
    assert_eq!(bytes("edvs:e4", 0x1234_5678), [0x82, 0x85, 0x12, 0x34, 0x56, 0x78]);
    assert_eq!(bytes("es", 300), b"Event Stream\x02\0\0\0\xFF\x2E\x06\x05\x01\x01");
    assert!(bytes("evt2", 0x41).ends_with(&[0x01, 0, 0, 0x80, 0x00, 0x28, 0x48, 0x10]));
    assert!(bytes("evt2", 0x41).starts_with(b"% evt 2.0\n"));
    let eieio = [1, 0x38, 0x34, 0x12, 0, 0, 5, 1, 7, 0];
    assert_eq!(bytes("eieio,base=0x70000,step=1", 0x1234), eieio);
    assert_eq!(bytes("csv", 7), b"tick,address,polarity\n7,261,1\n");
}

#[test]
fn datagrams_hold_a_time_step_of_up_to_255_keys() {
    let events = table((0..600).map(|i| (i / 300 * 2000, i as u16, 1)));
    let there = convert("csv", "eieio", events.as_bytes());
    assert_eq!(there.output.len(), 4 * 6 + 600 * 4);
    assert_eq!(rows(&convert("eieio", "csv", &there.output).output), events);
    let both = table([(0, 3, -1), (0, 3, 1)]);
    let there = convert("csv", "eieio,signed=1", both.as_bytes());
    assert_eq!(there.output, [2, 0x38, 0, 0, 0, 0, 6, 0, 0, 0, 7, 0, 0, 0]);
    // Keys without a time stamp take the last one; keys below the base are skipped.
    let bytes = [1, 0x38, 9, 0, 0, 0, 1, 0, 0, 0, 2, 8, 0, 0, 0, 0, 3, 0, 0, 0];
    let read = convert("eieio,base=1,step=1", "csv", &bytes);
    assert_eq!(rows(&read.output), table([(9, 0, 1), (9, 2, 1)]));
    assert!(read.stderr.contains("\n4 bytes skipped\n"), "{}", read.stderr);
    let (_directory, path) = file("x", [&bytes[..10], &[1, 8, 1, 0, 0, 0].repeat(20_000)].concat());
    let late = ran!("convert --from eieio,base=1,step=1 --to csv {path}").output;
    assert_eq!(late.matches("\n9,0,1").count(), 20_001);
}

#[test]
fn a_long_silence_takes_bytes_but_no_memory() {
    let events = table([(5, 0, 1), (100_000_000, 1, -1)]);
    let there = convert("csv", "es", events.as_bytes());
    assert_eq!(there.output.len(), 16 + 5 + 99_999_995 / 254 + 5);
    let (_directory, path) = file("x.es", &there.output);
    let back = ran!("convert --from es --to csv {path}");
    assert_eq!(back.output, events);
}

#[test]
fn rows_that_no_address_has_are_reported() {
    // An address has 16 bits, 5 of them for the row: row 31 fits, row 32 does not.
    let words = [8_u32 << 28, 1 << 28 | 3 << 11 | 31, 1 << 28 | 3 << 11 | 32];
    let read = convert("evt2", "csv", &words.map(u32::to_le_bytes).concat());
    assert_eq!(rows(&read.output), table([(0, 31 << 11 | 3, 1)]));
    let note = "\nevents without an address, in rows from 32 on: 1; `evt2,pixels=1` reads";
    assert!(read.stderr.contains(note), "{}", read.stderr);
    let read = convert("evt2,pixels=1", "csv", &words.map(u32::to_le_bytes).concat());
    assert_eq!(rows(&read.output), "tick,x,y,polarity\n0,3,31,1\n0,3,32,1\n");
}

/// Returns a table of 1000 events of a camera of 640 x 480 pixels.
fn pixels() -> String {
    let mut table = "tick,x,y,polarity\n".to_owned();
    for i in 0..1000_u32 {
        let polarity = if i % 3 == 0 { -1 } else { 1 };
        writeln!(table, "{},{},{},{polarity}", i / 4 * 977, i * 7919 % 640, i * 104_729 % 480)
            .unwrap();
    }
    table
}

#[test]
fn the_events_of_a_camera_keep_their_columns_and_rows() {
    let table = pixels();
    for format in ["evt2,width=640,height=480", "evt2", "evt3", "es,width=640,height=480", "csv"] {
        let there = convert("csv", format, table.as_bytes());
        assert!(there.stderr.contains(", 1000 events at 1000 pixels"), "{}", there.stderr);
        let (name, _) = format.split_once(',').unwrap_or((format, ""));
        let back = convert(name, "csv", &there.output);
        assert_eq!(rows(&back.output), table, "{format}");
        assert!(back.stderr.contains("\n0 bytes skipped\n"), "{format}: {}", back.stderr);
    }
    let sized = convert("csv", "evt3,width=640,height=480", table.as_bytes()).output;
    assert!(sized.starts_with(b"% evt 3.0\n% format EVT3;height=480;width=640\n"));
    // The input's header has the size.
    let es = convert("evt3", "es", &sized).output;
    assert_eq!(es[15..20], [1, 0x80, 2, 0xE0, 1]);
    assert_eq!(rows(&convert("es", "csv", &es).output), table);
    // A picture of the size that stands for addresses is one row higher.
    let far = "tick,x,y,polarity\n5,2047,31,1\n";
    let raw = convert("csv", "evt2,width=2048,height=32", far.as_bytes()).output;
    assert_eq!(rows(&convert("evt2", "csv", &raw).output), far);

    refused("convert --from csv --to es", &table, &["es,width=320,height=240"]);
    refused("convert --from csv --to link", &table, &["events of a camera have columns and rows"]);
    refused("convert --from csv --to evt2,width=9", &table, &["width= and height= go together"]);
    refused("convert --from csv --to evt21", &table, &["evt21 is read, and not written"]);
    let dropped = good_bytes("convert --from csv --to edvs:e2 --drop", table.as_bytes());
    assert!(dropped.stderr.contains("1000 events dropped"), "{}", dropped.stderr);
}

#[test]
fn what_frames_writes_is_read_back_whole() {
    let mut video = b"YUV4MPEG2 W96 H80 F25:1 Cmono\n".to_vec();
    for frame in 0..6_u32 {
        video.extend(b"FRAME\n");
        video.extend((0..96 * 80_u32).map(|pixel| (pixel * 7 + frame * 61) as u8));
    }
    let (directory, path) = file("x.y4m", video);
    let events = |name: &str| {
        let output = directory.path().join(name);
        ran!("frames {path} --threshold 10 -o {}", output.display());
        std::fs::read(output).unwrap()
    };
    let table = String::from_utf8(events("x.csv")).unwrap();
    assert!(table.lines().count() > 10_000);
    assert_eq!(rows(&convert("csv", "csv", table.as_bytes()).output), table);
    assert_eq!(rows(&convert("es", "csv", &events("x.es")).output), table);
    assert_eq!(rows(&convert("evt2", "csv", &events("x.raw")).output), table);
}

/// As a `GenX320` sends it by default: a word has up to 32 pixels.
#[test]
fn evt21_is_read_as_what_its_header_says() {
    let words: [u64; 5] = [
        0x8000_0001_0000_0000,
        0x10C2_000A_0000_0005,
        0x0003_000B_0000_0001,
        0x8000_0002_0000_0000,
        0x1141_000C_8000_0001,
    ];
    let little: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
    let halves: Vec<u8> =
        words.iter().flat_map(|word| word.rotate_left(32).to_le_bytes()).collect();
    let header = |order: &str| {
        format!(
            "% camera_integrator_name Prophesee\n% evt 2.1\n\
             % format EVT21;height=320;width=320;endianness={order}\n% end\n"
        )
    };
    let table =
        "tick,x,y,polarity\n67,64,10,1\n67,66,10,1\n64,96,11,-1\n133,32,12,1\n133,63,12,1\n";
    for (order, words) in [("little", &little), ("legacy", &halves)] {
        let file = [header(order).as_bytes(), words].concat();
        assert_eq!(rows(&convert("evt21", "csv", &file).output), table, "{order}");
    }
    let file = [header("little").as_bytes(), &little].concat();
    // Without the word in the header, the words show the order of their bytes, or the user says it.
    let header_only = header("little").replace(";endianness=little", "");
    for (name, words) in [("little", &little), ("legacy", &halves)] {
        let file = [header_only.as_bytes(), words].concat();
        let there = convert("evt21", "csv", &file);
        assert_eq!(rows(&there.output), table, "{name}");
        let said = format!("by the words it is `{name}`");
        assert!(there.stderr.contains(&said), "{}", there.stderr);
        let legacy = u8::from(name == "legacy");
        let there = convert(&format!("evt21,legacy={legacy}"), "csv", &file);
        assert_eq!(rows(&there.output), table, "{name}");
        assert!(!there.stderr.contains("by the words"), "{}", there.stderr);
    }
    // An event before any time: both orders can be, and neither begins with the time.
    for words in [&little, &halves] {
        let file = [header_only.as_bytes(), &words[8..]].concat();
        let (_directory, path) = common::file("x.raw", file);
        let said = ["the words do not show it", "`evt21,legacy=1` (IMX636)"];
        refused(&format!("convert --from evt21 --to csv {path}"), "", &said);
    }
    // In more than a few words, only one order can be, wherever the stream begins.
    let mut state = 1_u32;
    let mut many: Vec<u64> = Vec::new();
    for time in 0..200_u64 {
        for _ in 0..5 {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let (pixel, kind) = (1_u64 << (state >> 27), u64::from(state >> 9 & 1));
            let (x, y) = (u64::from(state >> 12 & 7) * 32, u64::from(state >> 15 & 255));
            many.push(kind << 60 | x << 43 | y << 32 | pixel);
        }
        many.push(8 << 60 | time << 32);
    }
    let little: Vec<u8> = many.iter().flat_map(|word| word.to_le_bytes()).collect();
    let halves: Vec<u8> = many.iter().flat_map(|word| word.rotate_left(32).to_le_bytes()).collect();
    let events = rows(&convert("evt21,legacy=0", "csv", &little).output);
    assert!(events.lines().count() > 900, "{}", events.lines().count());
    for words in [&little, &halves] {
        assert_eq!(rows(&convert("evt21", "csv", words).output), events);
    }

    let text = |bytes: &[u8]| bytes.to_vec();
    for (format, file, said) in [
        ("evt2", text(&file), "the header says EVT 2.1, which the format `evt21` reads"),
        ("evt3", text(&file), "the header says EVT 2.1, which the format `evt21` reads"),
        ("evt21", header("big").into_bytes(), "endianness=big"),
    ] {
        let (_directory, path) = common::file("x.raw", file);
        refused(&format!("convert --from {format} --to csv {path}"), "", &[said]);
    }
}

#[test]
fn a_file_of_spikes_that_is_cut_is_refused() {
    let scheme = "encode --scheme sf --threshold 0.1 --column gyro_x";
    let spikes = ran!("{scheme} {}", common::flight("hexarotor.csv")).output;
    let cut = spikes.match_indices('\n').nth(500).unwrap().0;
    for (length, word) in [(cut, "cut short"), (spikes.len() - 2, "its end says 140")] {
        refused("convert --from csv --to link", &spikes[..length], &["standard input: ", word]);
    }
}

#[test]
fn a_file_that_is_cut_anywhere_gives_the_events_before_the_cut() {
    let events = table((0..9).map(|i| (i * 400, i as u16, 1)));
    let whole = rows(events.as_bytes());
    // A cut before the first event or frame leaves too little to recognise the format.
    let cut = |format: &str, bytes: &[u8]| {
        let read = spikewire_bytes(&format!("convert --from {format} --to csv"), bytes);
        assert!(read.status == 0 || read.stderr.contains("another format"), "{}", read.stderr);
        read
    };
    for format in ["link", "edvs:e1", "edvs:e4", "es", "evt2", "eieio,step=1"] {
        let bytes = convert("csv", format, events.as_bytes()).output;
        for length in (0..bytes.len()).step_by(5) {
            let read = cut(format, &bytes[..length]);
            assert!(whole.starts_with(&rows(&read.output)), "{format} cut to {length}");
        }
        let read = cut(format, &bytes[..bytes.len() - 1]);
        let is_told =
            read.stderr.contains("the end is cut") || !read.stderr.contains("\n0 bytes skipped");
        assert!(is_told, "{format}: {}", read.stderr);
    }
}

#[test]
fn damage_in_a_link_costs_frames_that_are_counted() {
    let events = events();
    let bytes = convert("csv", "link", events.as_bytes()).output;
    let frames = {
        let report = convert("link", "csv", &bytes).stderr;
        let line = report.lines().nth(1).unwrap();
        line.split(' ').next().unwrap().parse::<usize>().unwrap()
    };
    assert!(frames > 10);
    for at in (0..bytes.len()).step_by(bytes.len() / 37) {
        let mut damaged = bytes.clone();
        damaged[at] ^= 0x10;
        let read = convert("link", "csv", &damaged);
        let rows = rows(&read.output);
        assert!(rows.lines().all(|row| events.contains(row)), "flip at {at}");
        assert!(
            read.stderr.contains(&format!("{} frames:", frames - 1)),
            "flip at {at}: {}",
            read.stderr
        );
        assert!(!read.stderr.contains("\n0 bytes skipped"), "flip at {at}: {}", read.stderr);
    }
    let middle = convert("link", "csv", &bytes[100..]);
    assert!(!middle.stderr.contains("\n0 bytes skipped"), "{}", middle.stderr);
    assert!(events.ends_with(rows(&middle.output).split_once('\n').unwrap().1));
}

#[test]
fn a_camera_is_read_from_the_middle_of_its_stream() {
    let events = table((0..50).map(|i| (i * 100, (i % 8) as u16, 1)));
    let bytes = convert("csv", "edvs:e2", events.as_bytes()).output;
    let read = convert("edvs:e2", "csv", &bytes[2..]);
    assert!(read.stderr.contains("\n2 bytes skipped\n"), "{}", read.stderr);
    assert!(events.ends_with(rows(&read.output).split_once('\n').unwrap().1));
}

#[test]
fn bytes_of_another_format_are_refused() {
    let words = "nothing that any of these would say\n".repeat(9);
    for (format, what) in [
        ("link", "no link frame in the 324 bytes"),
        ("edvs:e4", "no edvs:e4 event in the 324 bytes"),
        ("eieio", "no eieio event in the 324 bytes"),
    ] {
        let from = format!("--from {format}");
        refused(
            &format!("convert {from} --to es"),
            &words,
            &[what, "standard input: no ", "are they of another format?"],
        );
        refused(&format!("listen {from}"), &words, &[what, "\n324 bytes skipped\n"]);
    }
    let zeros = "\x7f".repeat(400);
    refused("convert --from evt2 --to csv", &zeros, &["no evt2 event in the 400 bytes"]);
    for format in FORMATS.iter().filter(|format| !format.contains("csv")) {
        ran!("convert --from {format} --to csv");
        let none = convert("csv", format, table([]).as_bytes()).output;
        good_bytes(&format!("listen --from {format}"), &none);
    }
}

#[test]
fn nothing_half_written_stays() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("events.es");
    refused(
        &format!("convert --from csv --to es -o {}", path.display()),
        &(events() + "1,2,up\n"),
        &["polarity `up`"],
    );
    assert_eq!(std::fs::read_dir(directory.path()).unwrap().count(), 0);
}
