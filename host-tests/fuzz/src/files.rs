//! The laptop library's readers: files that are damaged, or made to harm. Each is read or refused.

use std::fs;
use std::io::Cursor;
use std::path::PathBuf;
use std::sync::OnceLock;

use flight_logs::{Damage, Kind, Reading};
use lab::coding::Coding;
use lab::events::{Format, read_events};
use lab::flight::Flight;
use lab::frames;
use lab::input::messages::overview;
use lab::input::{ChannelOptions, Chunk, InputOptions};
use lab::network::{self, Asked, Current, Decay, Fires, Reset};
use lab::spikes::{self, Item, Spikes};

use crate::script::Script;

/// Most samples, messages, frames or items that are read of one input.
const MOST: usize = 2_000;

/// Writes the bytes to a file in memory, where there is one, and returns its path.
fn file(name: &str, bytes: &[u8]) -> PathBuf {
    static ROOM: OnceLock<PathBuf> = OnceLock::new();
    let room = ROOM.get_or_init(|| {
        let memory = PathBuf::from("/dev/shm");
        let room = if memory.is_dir() { memory } else { std::env::temp_dir() };
        let own = room.join(format!("spikewire-fuzz-{}", std::process::id()));
        fs::create_dir_all(&own).expect("a directory for inputs");
        own
    });
    let path = room.join(name);
    fs::write(&path, bytes).expect("room for an input");
    path
}

/// Logs of every kind but `ULog`, told apart by how they start.
pub fn logs(bytes: &[u8]) {
    let path = file("log", bytes);
    let Ok(Some(kind)) = Kind::of(&path) else { return };
    let _ = overview(&path, kind, true, 1.5).is_ok();
    let Ok(mut log) = Reading::open(&path, kind, Damage::Skip) else { return };
    let mut count = 0;
    while count < MOST
        && let Ok(true) = log.advance()
    {
        count += 1;
        for field in [
            "rate",
            "few[0]",
            "few[4294967295]",
            "gyroADC[0]",
            "GyrX",
            "x[31]",
            "zmag",
            "header.seq",
            "time",
        ] {
            let _ = log.number(field).is_ok();
        }
        let _ = (log.text("header.frame_id"), log.time().is_ok(), log.place());
    }
}

/// PX4's logs.
pub fn ulog(bytes: &[u8]) {
    let path = file("log.ulg", bytes);
    for accept_cut in [false, true] {
        let _ = overview(&path, Kind::Ulog, accept_cut, 1.5).is_ok();
    }
    let channel = ChannelOptions {
        topic: Some("sensor_combined".into()),
        fields: vec!["gyro_rad[0]".into()],
        accept_cut: true,
        ..ChannelOptions::default()
    };
    samples(&InputOptions { input: path, channel });
}

/// Tables, of which the first byte says how they are read.
pub fn csv(bytes: &[u8]) {
    let mut script = Script::new(bytes);
    let how = script.byte();
    let input = file("table.csv", script.rest());
    let columns = [&["all"][..], &["1"], &["gyro_x"], &["2", "1"]][usize::from(how >> 1 & 3)];
    let channel = ChannelOptions {
        columns: columns.iter().map(|&name| name.to_owned()).collect(),
        rate: (how & 8 != 0).then_some(100.0),
        skip_non_finite: how & 1 == 0,
        ..ChannelOptions::default()
    };
    samples(&InputOptions { input, channel });
}

fn samples(options: &InputOptions) {
    let Ok(mut source) = options.open() else { return };
    let mut chunk = Chunk::default();
    for _ in 0..4 {
        if source.next(&mut chunk).is_err() || chunk.columns.first().is_none_or(Vec::is_empty) {
            break;
        }
        let lengths: Vec<usize> = chunk.columns.iter().map(Vec::len).collect();
        assert!(lengths.iter().all(|length| *length == lengths[0]), "columns of one length");
        assert!(chunk.times.is_empty() || chunk.times.len() == lengths[0], "a time a sample");
    }
}

/// Files of spikes, of which the codec is built that they name.
pub fn spikes(bytes: &[u8]) {
    let Ok((mut reader, _)) = spikes::Reader::open(Cursor::new(bytes), "the input") else { return };
    let mut before = 0;
    for _ in 0..MOST {
        match reader.next() {
            Ok(Item::Event { event, .. }) => {
                assert!(event.sample >= before, "samples go forward");
                before = event.sample;
            }
            Ok(Item::End { .. }) | Err(_) => break,
            Ok(_) => {}
        }
    }
    let _ = (reader.place(), reader.notes());
}

/// Streams of events in every format that has a name.
pub fn events(bytes: &[u8]) {
    const FORMATS: [&str; 13] = [
        "evt2,pixels=1",
        "evt21",
        "evt3",
        "link",
        "edvs:e0",
        "edvs:e1",
        "edvs:e2",
        "edvs:e3",
        "edvs:e4",
        "es",
        "evt2",
        "csv",
        "eieio,base=3,signed=1",
    ];
    let mut script = Script::new(bytes);
    let name = FORMATS[script.below(FORMATS.len())];
    let cut = 1 + script.below(60);
    let bytes = script.rest();
    let whole = read_events(bytes, name);
    let format: Format = name.parse().expect("a format");
    let mut reader = format.reader("the input");
    let mut items = Vec::new();
    let cut_well = bytes.chunks(cut).try_for_each(|piece| reader.read(piece, &mut items));
    let cut_well = cut_well.and_then(|()| reader.finish(&mut items));
    // Datagrams end where they are cut; all else is a stream.
    if let (Ok(whole), Ok(()), false) = (&whole, &cut_well, name.starts_with("eieio")) {
        let pieces = items.iter().filter(|item| {
            matches!(item, lab::events::Item::Event(_) | lab::events::Item::Pixel(_))
        });
        assert_eq!(
            whole.events.len() + whole.pixels.len(),
            pieces.count(),
            "{name}, cut into pieces of {cut}"
        );
    }
}

/// Files of parameters, and of flights.
pub fn toml(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    if let Ok(flight) = Flight::parse(text) {
        let again = Flight::parse(&flight.to_toml(&[])).expect("what is written is read");
        assert_eq!(again.to_toml(&[]), flight.to_toml(&[]));
    }
    let Ok(coding) = Coding::parse("the input", text) else { return };
    let again = Coding::parse("written", &coding.to_toml(&[])).expect("what is written is read");
    assert_eq!(again.to_toml(&[]), coding.to_toml(&[]));
}

/// Trained networks: NIR graphs and the plain form.
pub fn network(bytes: &[u8]) {
    let path = file("network", bytes);
    for (framework, dt) in
        [(network::Framework::SpikingJelly, None), (network::Framework::Norse, Some(0.001))]
    {
        let asked = network::Asked { framework: Some(framework), dt, ..Default::default() };
        if let Ok(file) = network::File::read(&path)
            && let Ok(trained) = file.on_chip(&asked, None)
        {
            let inputs = trained.inputs();
            assert!(inputs > 0, "a network without inputs");
        }
    }
    // On the controller, by rules that leave nothing open.
    for (reset, current) in [(Reset::ToValue, Current::New), (Reset::SubtractLate, Current::Old)] {
        let asked = Asked {
            framework: None,
            resets: vec![reset],
            fires: Some(Fires::At),
            decay: Some(Decay::Euler),
            current: Some(current),
            dt: Some(1e-4),
        };
        if let Ok(file) = network::File::read(&path)
            && let Ok(model) = file.on_controller(&asked)
        {
            let mut flown = model.as_flown();
            let last = flown.inputs().saturating_sub(1).min(65_535) as u16;
            for step in [&[0, last, 0][..], &[], &[last]] {
                flown.step(step);
                assert!(
                    flown.potentials().iter().all(|v| v.is_finite()),
                    "a potential without bounds"
                );
            }
        }
    }
}

/// Videos of YUV4MPEG2.
pub fn video(bytes: &[u8]) {
    const MAGIC: &[u8] = b"YUV4MPEG2 ";
    // All else would be handed to `ffmpeg`, or be a picture of a library's.
    if !bytes.starts_with(MAGIC) {
        return;
    }
    let Ok(mut video) = frames::open(&[file("video.y4m", bytes)]) else { return };
    let (width, height) = video.size();
    let mut frame = Vec::new();
    for _ in 0..20 {
        let Ok(true) = video.next(&mut frame) else { break };
        assert_eq!(frame.len(), usize::from(width) * usize::from(height));
    }
}
