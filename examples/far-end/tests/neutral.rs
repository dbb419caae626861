//! When the command is neutral, and when it is not.

use far_end::{CHANNELS, Command, FarEnd, KEYFRAME_MS, SCHEMES, SILENCE_MS};
use spikewire::{
    Bank, EventQueue, Overflow, Tick,
    link::{MAX_FRAME, Session, Transmitter},
};

/// A sender, and what it has sent: one frame each.
struct Sender {
    bank: Bank<far_end::Schemes, CHANNELS>,
    queue: EventQueue<256>,
    transmitter: Transmitter,
    now: Tick,
}

impl Sender {
    fn new(starts: u32) -> Self {
        let bank = Bank::per_channel(SCHEMES);
        let transmitter = Transmitter::for_bank(&bank, 1_000, Session::counted(starts));
        Self { bank, queue: EventQueue::new(Overflow::DropOldest), transmitter, now: Tick::from(0) }
    }

    fn sample(&mut self, rate: f32) -> Vec<u8> {
        self.now += 1_000;
        self.bank.encode_into(self.now, [rate; CHANNELS], &self.queue);
        self.frames()
    }

    fn keyframe(&mut self) -> Vec<u8> {
        self.bank.keyframe_into(self.now, &self.queue);
        self.frames()
    }

    fn sensor_dies(&mut self) -> Vec<u8> {
        self.bank.reset_into(self.now, &self.queue);
        self.frames()
    }

    fn frames(&mut self) -> Vec<u8> {
        let mut events = self.queue.consumer().unwrap();
        let (mut frames, mut buffer) = (Vec::new(), [0; MAX_FRAME]);
        while let Some(frame) = self.transmitter.next_frame(&mut events, &mut buffer).unwrap() {
            frames.extend_from_slice(frame);
        }
        frames
    }
}

/// The command after these bytes; `None` if they are no frame.
fn after(far: &mut FarEnd, bytes: &[u8]) -> Option<Command> {
    let mut last = None;
    for byte in bytes.chunks(1) {
        far.take(0, byte, |_, _, _| (), |command| last = Some(command));
    }
    last
}

/// Both ends, with a first keyframe at a rate of 0.
fn running() -> (Sender, FarEnd) {
    let (mut sender, mut far) = (Sender::new(1), FarEnd::default());
    sender.sample(0.0);
    assert_eq!(after(&mut far, &sender.keyframe()), Some(Command::Damp([0; 3])));
    (sender, far)
}

#[test]
fn damps_what_it_knows() {
    let (mut sender, mut far) = running();
    // 0.1 rad/s is a spike.
    assert_eq!(after(&mut far, &sender.sample(0.15)), Some(Command::Damp([-12; 3])));
    assert_eq!(after(&mut far, &sender.sample(0.35)), Some(Command::Damp([-24; 3])));
}

#[test]
fn neutral_before_the_first_keyframe() {
    let (mut sender, mut far) = (Sender::new(1), FarEnd::default());
    sender.sample(0.0);
    assert_eq!(after(&mut far, &sender.sample(0.5)), Some(Command::Neutral));
    assert!(matches!(after(&mut far, &sender.keyframe()), Some(Command::Damp(_))));
}

#[test]
fn neutral_from_a_lost_frame_to_the_next_keyframe() {
    let (mut sender, mut far) = running();
    let lost = sender.sample(0.5);
    assert!(!lost.is_empty());
    assert_eq!(after(&mut far, &sender.sample(0.8)), Some(Command::Neutral));
    assert!(matches!(after(&mut far, &sender.keyframe()), Some(Command::Damp(_))));
}

#[test]
fn neutral_from_a_flipped_bit_to_the_next_keyframe() {
    let (mut sender, mut far) = running();
    let mut frame = sender.sample(0.5);
    let middle = frame.len() / 2;
    frame[middle] ^= 4;
    assert_eq!(after(&mut far, &frame), Some(Command::Neutral));
    // What cannot be read may look like the beginning of a frame, and holds back those behind it, until a silence.
    for bytes in [sender.sample(0.8), sender.sample(1.1)] {
        assert!(matches!(after(&mut far, &bytes), None | Some(Command::Neutral)));
    }
    far.silence(SILENCE_MS);
    assert!(matches!(after(&mut far, &sender.keyframe()), Some(Command::Damp(_))));
}

#[test]
fn neutral_as_soon_as_the_sensor_is_dead() {
    let (mut sender, mut far) = running();
    assert_eq!(after(&mut far, &sender.sensor_dies()), Some(Command::Neutral));
    sender.sample(0.5);
    assert_eq!(after(&mut far, &sender.keyframe()), Some(Command::Damp([-60; 3])));
}

#[test]
fn neutral_when_the_sender_starts_again() {
    let (_, mut far) = running();
    let mut other = Sender::new(2);
    other.sample(0.0);
    assert_eq!(after(&mut far, &other.sample(0.5)), Some(Command::Neutral));
}

#[test]
fn neutral_after_silence_to_the_next_keyframe() {
    let (mut sender, mut far) = running();
    assert_eq!(far.silence(SILENCE_MS - 1), None);
    assert_eq!(far.silence(SILENCE_MS), Some(Command::Neutral));
    assert_eq!(after(&mut far, &sender.sample(0.5)), Some(Command::Neutral));
    assert!(matches!(after(&mut far, &sender.keyframe()), Some(Command::Damp(_))));
}

#[test]
fn a_keyframe_after_silence_does_not_wait_for_the_end_of_a_cut_frame() {
    let (mut sender, mut far) = running();
    let whole = sender.sample(0.5);
    assert_eq!(after(&mut far, &whole[..whole.len() - 1]), None);
    assert_eq!(far.silence(SILENCE_MS), Some(Command::Neutral));
    assert!(matches!(after(&mut far, &sender.keyframe()), Some(Command::Damp(_))));
}

/// A loose wire brings bytes for ever: they must not keep the last command alive.
#[test]
fn bytes_that_are_no_frame_are_silence() {
    let (mut sender, mut far) = running();
    assert!(matches!(after(&mut far, &sender.sample(0.5)), Some(Command::Damp(_))));
    let whole = sender.keyframe();
    for (noise, what) in [(vec![0x55], "junk"), (whole[..whole.len() - 1].to_vec(), "a cut frame")]
    {
        let (_, mut far) = running();
        let mut neutral = None;
        for now in (0..1_000).step_by(10) {
            // A damaged frame may end what is exact, and says nothing else.
            far.take(
                now,
                &noise,
                |_, _, _| (),
                |command| assert_eq!(command, Command::Neutral, "{what}"),
            );
            neutral = neutral.or(far.silence(now).map(|command| (now, command)));
        }
        assert_eq!(neutral, Some((SILENCE_MS, Command::Neutral)), "{what}");
    }
}

#[test]
fn keyframes_alone_keep_a_sender_at_rest_alive_and_one_may_be_lost() {
    let (mut sender, mut far) = running();
    for now in 1..2_000 {
        let is_lost = now % (2 * KEYFRAME_MS) == 0;
        if now % KEYFRAME_MS == 0 {
            let frame = sender.keyframe();
            let bytes = if is_lost { &[][..] } else { &frame };
            far.take(now, bytes, |_, _, _| (), |_| ());
        }
        assert_eq!(far.silence(now), None, "{now} ms");
    }
}

/// The vehicle of [`SILENCE_MS`]: it must come to rest from where an old torque left it.
#[test]
fn an_old_torque_turns_a_nimble_multirotor_by_less_than_45_degrees() {
    let seconds = f64::from(SILENCE_MS) / 1e3;
    let turned = 0.5 * 100.0 * seconds * seconds;
    assert!(turned < std::f64::consts::FRAC_PI_4, "{turned} rad");
}

#[test]
fn bytes_of_a_command() {
    assert_eq!(Command::Neutral.bytes(), [0x5C, 0, 0, 0, 0, 0, 0, 0]);
    assert_eq!(Command::Damp([1, -2, 1000]).bytes(), [0x5C, 1, 1, 0, 0xFE, 0xFF, 0xE8, 3]);
}
