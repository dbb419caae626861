//! `listen` decodes a board's frames to exactly the values that the board holds, from files, pipes and serial ports.

mod common;

use common::{good_bytes, refused, spikewire_bytes};
use fixed::types::I8F8;
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{OptionalActions, tcgetattr, tcsetattr};
use spikewire::link::{Coding, Framer, MAX_FRAME, Session, Transmitter};
use spikewire::population::{Position, Slots};
use spikewire::rate::{Bsa, Hough, Taps, ThresholdHough};
use spikewire::temporal::{MovingWindow, SendOnDelta, StepForward, TemporalContrast};
use spikewire::{Bank, Code, FromItems, Item, Put, Readout, Sample, Scheme, Spike, Start, Tick};
use std::fs::{self, File};
use std::io::{Read, Write};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

const CHANNELS: usize = 3;

/// The data of a simulated board, which also decodes its own spikes.
struct Board<S> {
    /// Frames that the board sent.
    frames: Vec<Vec<u8>>,
    /// Values that the board's own decoders returned, as (tick in µs, address, value).
    values: Vec<(u32, u16, S)>,
}

/// A link transmitter, and the frames that it has sent so far.
struct Sender(Transmitter, Vec<Vec<u8>>);

impl Sender {
    fn new() -> Self {
        let session = Session::counted(7);
        Self(Transmitter::new(Coding::for_channels(3, 1000), session), Vec::new())
    }

    fn send(&mut self, items: Items) {
        let (mut items, mut buffer) = (FromItems(items.0.into_iter()), [0; MAX_FRAME]);
        while let Some(frame) = self.0.next_frame(&mut items, &mut buffer).unwrap() {
            self.1.push(frame.to_vec());
        }
    }
}

/// Returns sample number `sample` of three sine waves with an amplitude of 100.
fn waves<S: Sample>(sample: u32) -> [S; CHANNELS] {
    [0.05, 0.07, 0.11].map(|pace: f64| S::from_f64((f64::from(sample) * pace).sin() * 100.0))
}

/// List of the items that a bank of encoders puts out.
#[derive(Default)]
struct Items(Vec<Item>);

impl Put for &mut Items {
    fn put(&mut self, item: Item) {
        self.0.push(item);
    }
}

/// Simulates a board with a temporal code that encodes [`waves`] for 400 samples, with a keyframe every 100 samples.
fn board<P: Start<Code = Spike>>(schemes: &[P; CHANNELS]) -> Board<P::Sample> {
    let mut bank = Bank::<_, CHANNELS>::per_channel(schemes.each_ref());
    let mut decoders = schemes.each_ref().map(P::decoder);
    let (mut sender, mut values) = (Sender::new(), Vec::new());
    for sample in 0..400 {
        let tick = Tick::from(sample * 1000);
        let mut items = Items::default();
        bank.encode_into(tick, waves(sample), &mut items);
        // The moving window of the test has filled at sample 3.
        if sample == 3 || sample % 100 == 0 {
            bank.keyframe_into(tick, &mut items);
        }
        for item in &items.0 {
            match item {
                Item::Event(event) => {
                    let decoder = &mut decoders[usize::from(event.address)];
                    let value = decoder.decode(event.polarity.into());
                    values.push((event.tick.micros(), event.address, value));
                }
                // The board's own decoders start from the keyframe's value too.
                Item::Keyframe(keyframe) => {
                    decoders[usize::from(keyframe.address)].resync(keyframe.value().unwrap());
                }
                Item::Heartbeat { .. } => {}
                Item::Break(_) => unreachable!(),
            }
        }
        sender.send(items);
    }
    Board { frames: sender.1, values }
}

/// Simulates a board with a rate or population code. The board's decoder returns a value for each channel in each
/// sample. The address of a value is the address of its channel's first neuron.
fn sampled_board<P: Start>(scheme: &P, slot_ticks: u32) -> Board<P::Sample> {
    // With sub-timesteps, the receiver measures the sample period from heartbeats.
    board_since_boot(scheme, slot_ticks, 0, if slot_ticks > 0 { 20 } else { 100 })
}

/// Simulates a board with a rate or population code. The board booted `uptime` µs ago, and sends a heartbeat every
/// `beat` samples.
fn board_since_boot<P: Start>(
    scheme: &P,
    slot_ticks: u32,
    uptime: u64,
    beat: u32,
) -> Board<P::Sample> {
    let mut bank = Bank::<_, CHANNELS>::new(scheme).with_slot_ticks(slot_ticks);
    let mut readout = Readout::<_, CHANNELS>::new(scheme).with_slot_ticks(slot_ticks);
    let (mut sender, mut values) = (Sender::new(), Vec::new());
    for sample in 0..400_u32 {
        let tick = Tick::from_micros(uptime + u64::from(sample) * 1000);
        let mut events = Vec::new();
        bank.encode(tick, waves(sample), |event| events.push(event));
        for (channel, value) in readout.decode(tick, &events).into_iter().enumerate() {
            let address = channel * <P as Scheme>::Code::NEURONS;
            values.push((tick.micros(), address as u16, value));
        }
        let mut items = Items(events.into_iter().map(Item::Event).collect());
        if sample.is_multiple_of(beat) {
            bank.keyframe_into(tick, &mut items);
        }
        sender.send(items);
    }
    Board { frames: sender.1, values }
}

/// Decodes `frames` with `listen`, and checks that each value marked `exact` equals the board's. Returns all lines that
/// `listen` wrote.
fn assert_sampled<S: Sample>(board: &Board<S>, frames: &[Vec<u8>], options: &str) -> Vec<Line> {
    let heard = good_bytes(&format!("listen {options}"), &frames.concat());
    let lines = values(&heard.output);
    let exact = lines.iter().filter(|line| line.known == "exact");
    assert!(exact.clone().count() > 500, "{options}: {}", heard.stderr);
    for line in exact {
        let is_same =
            |&(tick, address, _): &(u32, u16, S)| (tick, address) == (line.tick, line.address);
        let (.., value) = board.values.iter().copied().find(is_same).unwrap();
        assert_eq!(S::from_f64(line.value), value, "{options}: {line:?}");
    }
    lines
}

fn three_floats() -> Board<f32> {
    board(&[7.5, 3.1, 12.7].map(StepForward::<f32>::new))
}

const THREE: &str = "--scheme sf --thresholds 7.5,3.1,12.7";

/// A line that `listen` prints for a value.
#[derive(Debug, PartialEq)]
struct Line {
    tick: u32,
    address: u16,
    value: f64,
    known: String,
}

fn values(table: &[u8]) -> Vec<Line> {
    let lines = str::from_utf8(table).unwrap().lines();
    lines
        .skip(1)
        .filter(|line| !line.starts_with('#'))
        .map(|line| {
            let [tick, address, value, known] = line.split(',').collect::<Vec<_>>()[..] else {
                panic!("{line}");
            };
            Line {
                tick: tick.parse().unwrap(),
                address: address.parse().unwrap(),
                value: value.parse().unwrap(),
                known: known.to_owned(),
            }
        })
        .collect()
}

/// Decodes the board's frames with `listen`, and checks that each event's value is marked `exact` and equals the
/// board's.
fn assert_exact<S: Sample>(board: &Board<S>, options: &str) {
    let heard = good_bytes(&format!("listen {options}"), &board.frames.concat());
    let heard: Vec<Line> =
        values(&heard.output).into_iter().filter(|value| value.known != "keyframe").collect();
    assert!(heard.len() == board.values.len() && heard.len() > 200, "{options}: {}", heard.len());
    for (heard, &(tick, address, value)) in heard.iter().zip(&board.values) {
        assert_eq!(
            (heard.tick, heard.address, heard.known.as_str()),
            (tick, address, "exact"),
            "{options}"
        );
        assert_eq!(S::from_f64(heard.value), value, "{options}");
    }
}

#[test]
fn values_are_those_of_the_board_bit_for_bit() {
    let board_f32 = three_floats();
    let heard = good_bytes(&format!("listen {THREE}"), &board_f32.frames.concat());
    let text = str::from_utf8(&heard.output).unwrap();
    let bits: Vec<u32> = text
        .lines()
        .filter(|line| line.ends_with(",exact"))
        .map(|line| line.split(',').nth(2).unwrap().parse::<f32>().unwrap().to_bits())
        .collect();
    assert!(bits.iter().copied().eq(board_f32.values.iter().map(|(_, _, value)| value.to_bits())));

    let counts = board(&[7, 3, 12].map(StepForward::<i16>::new));
    assert_exact(&counts, "--sample i16 --scheme sf --thresholds 7,3,12");
    let q8_8 = board(&[StepForward::<I8F8>::new(I8F8::from_bits(7)); 3]);
    assert_exact(&q8_8, "--sample q8.8 --scheme sf --threshold 0.02734375");
    let contrast = board(&[TemporalContrast::<f32>::new(1.5).with_step(3.0); 3]);
    assert_exact(&contrast, "--scheme tbr --threshold 1.5 --step 2x");
    let window = board(&[MovingWindow::<f32, 4>::new(2.5); 3]);
    assert_exact(&window, "--scheme mw --threshold 2.5 --window 3");
}

#[test]
fn values_of_rate_and_population_codes_are_those_of_the_board() {
    let rate = "--filter triang:15,peak=20 --shift -100";
    let range = "--min -100 --max 100";
    let hough = Hough::new(Taps::<f32, 15>::triangular(20.0)).with_shift(-100.0);
    let hough = sampled_board(&hough, 0);
    let options = format!("--scheme hsa {rate}");
    let lines = assert_sampled(&hough, &hough.frames, &options);
    let end = lines.last().unwrap();
    assert_eq!((end.tick, end.address, end.known.as_str()), (399_000, 2, "exact"));

    let counts = ThresholdHough::new(Taps::<i16, 15>::triangular(20), 17).with_shift(-100);
    let counts = sampled_board(&counts, 0);
    assert_sampled(&counts, &counts.frames, &format!("--sample i16 --scheme t-hsa {rate}"));
    let bsa = Bsa::subtractive(Taps::<f32, 15>::triangular(20.0), 5.0).with_shift(-100.0);
    let bsa = sampled_board(&bsa, 0);
    assert_sampled(&bsa, &bsa.frames, &format!("--scheme bsa {rate}"));

    // The decoder has one type for up to 64 neurons, and one for more.
    let few = sampled_board(&Position::<f32, 20>::linear(-100.0..=100.0), 0);
    let lines = assert_sampled(&few, &few.frames, &format!("--scheme grf --neurons 20 {range}"));
    assert_eq!(lines.len(), 3 * 400);
    assert!(lines.iter().skip(3).all(|line| [0, 20, 40].contains(&line.address)));
    let many = sampled_board(&Position::<i16, 100>::linear(-100..=100), 0);
    let options = format!("--sample i16 --scheme position --neurons 100 {range}");
    assert_sampled(&many, &many.frames, &options);
    let slots = sampled_board(&Slots::<f32, 15, 10>::new(-100.0..=100.0, 1.5), 50);
    let options = format!("--scheme grf-slots --neurons 15 --slots 10 {range} --slot-ticks 50");
    assert_sampled(&slots, &slots.frames, &options);
}

#[test]
fn after_a_lost_frame_rate_codes_are_estimates_for_as_long_as_the_filter() {
    let scheme = Hough::new(Taps::<f32, 15>::triangular(20.0)).with_shift(-100.0);
    let board = sampled_board(&scheme, 0);
    let lost = board.frames.len() / 2;
    let frames = [&board.frames[..lost], &board.frames[lost + 1..]].concat();
    let options = "--scheme hsa --filter triang:15,peak=20 --shift -100";
    let lines = assert_sampled(&board, &frames, options);
    let stale = lines.iter().skip_while(|line| line.known == "estimate");
    let stale = stale.filter(|line| line.known == "estimate").count();
    assert!((3 * 14..3 * 30).contains(&stale), "{stale}");
    assert_eq!(lines.last().unwrap().known, "exact");
}

#[test]
fn send_on_delta_is_heard_spike_by_spike() {
    let scheme = SendOnDelta::<f32, 4>::new(3.1);
    let mut bank = Bank::<_, CHANNELS>::new(&scheme);
    let (mut sender, mut items) = (Sender::new(), Items::default());
    for sample in 0..400 {
        let tick = Tick::from(sample * 1000);
        bank.encode_into(tick, waves(sample), &mut items);
        if sample == 0 {
            bank.keyframe_into(tick, &mut items);
        }
    }
    sender.send(items);
    let heard = good_bytes("listen --scheme sod --threshold 3.1 --spikes 4", &sender.1.concat());
    let lines = values(&heard.output);
    assert!(lines.len() > 1000 && lines.iter().all(|line| line.known != "estimate"));
    for channel in 0..3 {
        let end = lines.iter().rfind(|line| line.address == channel).unwrap();
        assert_eq!(Some(end.value as f32), bank.keyframe(channel.into()));
    }
}

#[test]
fn after_a_lost_frame_values_are_estimates_until_the_next_keyframe() {
    let board = three_floats();
    let keyframes = |frame: &Vec<u8>| frame[1] & 2 != 0;
    let lost = board.frames.iter().skip(20).position(|frame| !keyframes(frame)).unwrap() + 20;
    let mut frames = board.frames.clone();
    frames.remove(lost);
    let heard = good_bytes(&format!("listen {THREE}"), &frames.concat());
    assert!(heard.stderr.contains(" 1 lost in 1 gaps"), "{}", heard.stderr);
    let text = str::from_utf8(&heard.output).unwrap();
    let (before, after) = text.split_once("# lost_frames=1\n").unwrap();
    assert!(!before.contains("estimate"));
    let (stale, fresh) = after.split_once(",keyframe\n").unwrap();
    assert!(stale.contains("estimate") && !stale.contains("exact"), "{stale}");
    assert!(fresh.contains("exact") && !fresh.contains("estimate"), "{fresh}");
    // After the keyframe, the values are the board's again.
    let end = values(fresh.as_bytes()).pop().unwrap();
    let &(tick, address, value) = board.values.last().unwrap();
    assert_eq!((end.tick, end.address, end.value as f32), (tick, address, value));
}

#[test]
fn damage_a_cut_end_and_a_start_in_the_middle_are_counted() {
    let frames = three_floats().frames;
    let (count, all) = (frames.len(), frames.concat());
    let changed = |change: &dyn Fn(&mut Vec<Vec<u8>>)| {
        let mut frames = frames.clone();
        change(&mut frames);
        frames.concat()
    };
    let nothing_skipped = "\n0 bytes skipped\n".to_owned();
    let skipped =
        |frame: usize, but: usize| format!("\n{} bytes skipped\n", frames[frame].len() - but);
    for (bytes, words) in [
        (
            changed(&|frames| frames[10][7] ^= 1),
            [format!("{} frames: 1 lost in 1 gaps, ", count - 1), skipped(10, 0)],
        ),
        // A damaged length that exceeds the rest of the input does not hide the frames after it: of a short frame, with
        // the longest length that its first byte has.
        (
            changed(&|frames| frames[count - 3][0] |= 0x0E),
            [format!("{} frames: 1 lost in 1 gaps, ", count - 1), " bad checksums".into()],
        ),
        (
            all[..all.len() - 1].to_vec(),
            [format!("{} frames: 0 lost", count - 1), skipped(count - 1, 1)],
        ),
        (
            all[frames[0].len() + 3..].to_vec(),
            [format!("{} frames: 0 lost", count - 2), skipped(1, 3)],
        ),
        (
            changed(&|frames| frames.insert(4, frames[4].clone())),
            [" 1 repeated".into(), nothing_skipped],
        ),
        (Vec::new(), ["0 frames: 0 lost".into(), "0 restarts".into()]),
    ] {
        let report = good_bytes(&format!("listen {THREE}"), &bytes).stderr;
        assert!(words.iter().all(|word| report.contains(word)), "{words:?}: {report}");
    }
}

#[test]
fn events_without_a_decoder_are_counted() {
    let board = three_floats();
    let two = good_bytes("listen --scheme sf --thresholds 7.5,3.1", &board.frames.concat());
    let outside = board.values.iter().filter(|(_, address, _)| *address == 2).count() + 5;
    let report = format!("\n{outside} events and keyframes at addresses without a decoder\n");
    assert!(two.stderr.contains(&report) && !two.stderr.contains("contradict"), "{}", two.stderr);
    assert!(values(&two.output).iter().all(|value| value.address < 2));

    let narrow =
        good_bytes("listen --sample i16 --scheme sf --threshold 7", &board.frames.concat());
    let report = "\n15 keyframes of another sample type\n";
    assert!(narrow.stderr.contains(report), "{}", narrow.stderr);
    assert!(values(&narrow.output).iter().all(|value| value.known == "estimate"));

    let other =
        good_bytes("listen --scheme hsa --filter triang:3 --shift 0", &board.frames.concat());
    let report = "\n15 keyframes, which this scheme does not have: is --scheme the sender's?\n";
    assert!(
        other.stderr.contains(report) && !other.stderr.contains("sample type"),
        "{}",
        other.stderr
    );
}

#[test]
fn keyframes_of_step_forward_tell_wrong_parameters() {
    let bytes = three_floats().frames.concat();
    let report = |options: &str| good_bytes(&format!("listen {options}"), &bytes).stderr;
    assert!(!report(THREE).contains("contradict"));
    // All keyframes but the first of each of the 3 channels.
    let all = "12 of 12 keyframes contradict the values before them: are --scheme, --threshold and";
    for wrong in ["--scheme sf --thresholds 7.5,6.2,12.7", "--scheme sf --threshold 1"] {
        assert!(report(wrong).contains(" of 12 keyframes contradict"), "{}", report(wrong));
    }
    assert!(report("--scheme sf --threshold 90").contains(all));
    let other = report("--scheme sf --threshold 9 --sample q16.16");
    assert!(other.contains("\n15 keyframes of another sample type\n"), "{other}");
    // Keyframes of temporal contrast hold the sample, which no decoded value must equal.
    let contrast = board(&[TemporalContrast::<f32>::new(1.5).with_step(3.0); 3]);
    let report = good_bytes("listen --scheme tbr --threshold 9", &contrast.frames.concat()).stderr;
    assert!(!report.contains("contradict"), "{report}");
}

/// In a code with sub-timesteps, a sample is divided into short slots of time. `listen` decodes such a code no matter
/// how long the board has been running. If no value is exact, standard error gives the reason.
#[test]
fn slots_are_decoded_after_any_uptime() {
    let scheme = Slots::<f32, 15, 10>::new(-100.0..=100.0, 1.5);
    let options = "--scheme grf-slots --neurons 15 --slots 10 --min=-100 --max 100 --slot-ticks";
    for minutes in [0_u64, 36, 37, 71, 72, 83, 5_256_000] {
        let uptime = minutes * 60_000_000 + 42_000_123;
        let board = board_since_boot(&scheme, 50, uptime, 20);
        assert_sampled(&board, &board.frames, &format!("{options} 50"));
    }
    let silent = board_since_boot(&scheme, 50, 83 * 60_000_000, u32::MAX);
    // The first two frames hold the first sample and the only heartbeat.
    let heard = good_bytes(&format!("listen {options} 50"), &silent.frames[2..].concat());
    assert_eq!(values(&heard.output).len(), 0);
    assert!(heard.stderr.contains("\nno value is exact: no heartbeat since"), "{}", heard.stderr);
    let board = board_since_boot(&scheme, 50, 0, 20);
    let heard = good_bytes(&format!("listen {options} 101"), &board.frames.concat());
    let why = "\nno value is exact: 10 sub-timesteps of 101 µs are longer than a period of 980 µs, the shortest that the clock's tolerance allows\n";
    assert!(heard.stderr.contains(why), "{}", heard.stderr);
}

#[test]
fn a_loss_at_the_sender_is_reported() {
    let mut framer = Framer::new(Coding::for_channels(1, 1000), Session::counted(7));
    let mut buffer = [0; 64];
    let mut bytes = framer.start(Tick::from(0), &mut buffer).unwrap().finish().to_vec();
    framer.mark_loss();
    bytes.extend(framer.start(Tick::from(0), &mut buffer).unwrap().finish());
    let heard = good_bytes("listen", &bytes);
    assert_eq!(heard.output, b"tick,address,polarity\n# restart\n# lost_events\n");
    assert!(
        heard.stderr.contains("\n1 frames before which the sender lost events\n"),
        "{}",
        heard.stderr
    );
}

#[test]
fn settings_that_no_link_can_carry_are_refused() {
    let many = vec!["1"; 257].join(",");
    refused(&format!("listen --scheme sf --thresholds {many}"), "", &["1 to 256 channels"]);
    let foreign = spikewire_bytes("listen --from es", b"Event Stream\x02\0\0\x02");
    assert_eq!(foreign.status, 2);
    assert!(foreign.stderr.contains("generic events"), "{}", foreign.stderr);
}

/// Opens a pseudo-terminal in raw mode, as a serial line. Returns the board's end, the path of the laptop's end, and a
/// handle that keeps the laptop's end open.
fn serial_line() -> (File, String, File) {
    let board = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC).unwrap();
    grantpt(&board).unwrap();
    unlockpt(&board).unwrap();
    let name = ptsname(&board, Vec::new()).unwrap().into_string().unwrap();
    let open = File::options().read(true).write(true).open(&name).unwrap();
    let mut settings = tcgetattr(&open).unwrap();
    settings.make_raw();
    tcsetattr(&open, OptionalActions::Now, &settings).unwrap();
    (board.into(), name, open)
}

/// Waits until the program ends, checks that its exit status is 0, and returns its standard error.
fn finish(child: Child) -> String {
    let done = child.wait_with_output().unwrap();
    let report = String::from_utf8(done.stderr).unwrap();
    assert!(done.status.success(), "{report}");
    report
}

fn spawn(arguments: &str, report: impl Into<Stdio>) -> Child {
    Command::new(env!("CARGO_BIN_EXE_spikewire"))
        .args(arguments.split_whitespace())
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(report)
        .spawn()
        .unwrap()
}

/// Waits until the program has written `count` lines to standard output, and returns them.
fn lines(child: &mut Child, count: usize) -> String {
    let (mut lines, mut byte) = (Vec::new(), [0]);
    for _ in 0..count {
        while byte != *b"\n" {
            child.stdout.as_mut().unwrap().read_exact(&mut byte).unwrap();
            lines.extend(byte);
        }
        byte = [0];
    }
    String::from_utf8(lines).unwrap()
}

#[test]
fn a_serial_port_is_heard_until_its_time_is_over() {
    let (mut line, name, _open) = serial_line();
    let bytes = three_floats().frames.concat();
    let mut child =
        spawn(&format!("listen {THREE} --baud 115200 --seconds 2 {name}"), Stdio::piped());
    // A pseudo-terminal buffers at most 4095 bytes that are not read yet.
    for piece in bytes.chunks(bytes.len() / 3 + 1) {
        line.write_all(piece).unwrap();
        std::thread::sleep(Duration::from_millis(100));
    }
    let mut output = Vec::new();
    child.stdout.take().unwrap().read_to_end(&mut output).unwrap();
    let report = finish(child);
    assert_eq!(output, good_bytes(&format!("listen {THREE}"), &bytes).output, "{report}");
    assert!(report.contains("\n0 bytes skipped\n"), "{report}");
}

#[test]
fn a_port_may_say_nothing_that_is_understood() {
    let (mut line, name, _open) = serial_line();
    let child = spawn(&format!("listen --baud 115200 --seconds 1 {name}"), Stdio::piped());
    line.write_all(b"hello").unwrap();
    let report = finish(child);
    assert!(report.contains("no link frame in the 5 bytes"), "{report}");
}

#[test]
fn a_camera_without_times_takes_those_of_arrival() {
    let (mut line, name, _open) = serial_line();
    let mut child =
        spawn(&format!("listen --from edvs:e0 --baud 115200 --seconds 3 {name}"), Stdio::piped());
    line.write_all(&[0x81, 0x82]).unwrap();
    let first = lines(&mut child, 2);
    std::thread::sleep(Duration::from_millis(20));
    line.write_all(&[0x81, 0x82]).unwrap();
    let second = lines(&mut child, 1);
    assert!(child.wait().unwrap().success());
    let tick = |line: &str| {
        line.lines().last().unwrap().split(',').next().unwrap().parse::<u32>().unwrap()
    };
    assert!(tick(&second) - tick(&first) >= 20_000, "{first}{second}");
}

#[test]
fn ctrl_c_keeps_what_was_heard() {
    let (mut line, name, _open) = serial_line();
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("heard.csv");
    let options = format!("listen --from edvs:e4 --baud 115200 {name}");
    let mut piped = spawn(&options, Stdio::piped());
    line.write_all(&[0x81, 0x82, 0, 0, 0, 9]).unwrap();
    lines(&mut piped, 2);
    assert!(interrupt(piped).contains("6 bytes, 1 events"));

    let child = spawn(&format!("{options} -o {}", path.display()), Stdio::piped());
    wait_for_file(directory.path());
    line.write_all(&[0x81, 0x82, 0, 0, 0, 9, 0x81]).unwrap();
    let report = interrupt(child);
    assert!(report.contains("7 bytes, 1 events") && report.contains("the end is cut"), "{report}");
    assert_eq!(fs::read(&path).unwrap(), b"tick,address,polarity\n9,130,1\n");
}

/// Waits until the directory holds a file: `listen` creates its output file when it is ready to receive. Panics after
/// 10 s.
fn wait_for_file(directory: &Path) {
    for _ in 0..1000 {
        if fs::read_dir(directory).unwrap().count() > 0 {
            return;
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    panic!("no file in 10 s");
}

/// Sends Ctrl-C (SIGINT) to the program, waits until it ends, and returns its standard error.
fn interrupt(child: Child) -> String {
    let id = child.id().to_string();
    assert!(Command::new("kill").args(["-INT", &id]).status().unwrap().success());
    finish(child)
}

#[test]
fn a_port_that_goes_away_is_an_error_and_what_came_is_kept() {
    let (mut line, name, open) = serial_line();
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("heard.csv");
    let file = path.display();
    let child =
        spawn(&format!("listen --from edvs:e4 --baud 115200 {name} -o {file}"), Stdio::piped());
    wait_for_file(directory.path());
    drop(open);
    line.write_all(&[0x81, 0x82, 0, 0, 0, 9]).unwrap();
    // Time for the program to read: a pseudo-terminal that hangs up discards unread bytes.
    std::thread::sleep(Duration::from_secs(1));
    drop(line);
    let done = child.wait_with_output().unwrap();
    let report = String::from_utf8(done.stderr).unwrap();
    assert_eq!(done.status.code(), Some(2), "{report}");
    assert!(
        report.contains("6 bytes, 1 events")
            && report.contains(&format!("error: {name}: the port is gone")),
        "{report}"
    );
    assert_eq!(fs::read(&path).unwrap(), b"tick,address,polarity\n9,130,1\n");
}

#[test]
fn a_terminal_shows_counts_while_they_grow() {
    let (mut line, name, _open) = serial_line();
    let (mut screen, _, terminal) = serial_line();
    let mut child = spawn(&format!("listen --baud 115200 --seconds 3 {name}"), terminal);
    for frame in three_floats().frames.iter().take(60) {
        line.write_all(frame).unwrap();
        std::thread::sleep(Duration::from_millis(25));
    }
    let mut output = Vec::new();
    child.stdout.take().unwrap().read_to_end(&mut output).unwrap();
    assert!(child.wait().unwrap().success());
    let mut shown = Vec::new();
    let mut buffer = [0; 4096];
    while let Ok(count @ 1..) = screen.read(&mut buffer) {
        shown.extend(&buffer[..count]);
    }
    let shown = String::from_utf8_lossy(&shown);
    assert!(shown.contains("/s 0:") && shown.contains(" 0 lost in 0 gaps"), "{shown}");
    assert!(shown.contains("60 frames: 0 lost in 0 gaps"), "{shown}");
}

#[test]
fn values_are_drawn_in_a_terminal_alone() {
    let board = board(&[50.0, 60.0, 70.0].map(StepForward::<f32>::new));
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("bytes");
    fs::write(&path, board.frames.concat()).unwrap();
    let listen = format!("listen {} --live", path.display());
    let sf = format!("{listen} --scheme sf --thresholds 50,60,70");
    refused(&listen, "", &["--live draws values: it needs --flight or --scheme"]);
    refused(&sf, "", &["--live draws in a terminal, and standard output is none"]);

    let (terminal, _, open) = serial_line();
    let size = rustix::termios::Winsize { ws_row: 24, ws_col: 80, ws_xpixel: 0, ws_ypixel: 0 };
    rustix::termios::tcsetwinsize(&open, size).unwrap();
    let end = || Stdio::from(open.try_clone().unwrap());
    let mut program = Command::new(env!("CARGO_BIN_EXE_spikewire"));
    program.args(sf.split_whitespace()).stdin(end()).stdout(end()).stderr(Stdio::piped());
    let child = program.spawn().unwrap();
    drop((program, open));
    let (mut terminal, mut drawn) = (terminal, Vec::new());
    let mut bytes = [0; 4096];
    // A terminal that nobody has open any more is an error.
    while let Ok(count @ 1..) = terminal.read(&mut bytes) {
        drawn.extend_from_slice(&bytes[..count]);
        if bytes[..count].ends_with(b"\x1b[6n") {
            terminal.write_all(b"\x1b[1;1R").unwrap(); // where the cursor is
        }
    }
    finish(child);
    let drawn = String::from_utf8_lossy(&drawn);
    for words in ["channel", "exact", "▀", "▄", "frames"] {
        assert!(drawn.contains(words), "{words}: {drawn}");
    }
}
