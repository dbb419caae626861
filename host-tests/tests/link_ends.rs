//! Ends that a stranger wires: banks that share a link, joined or not; numbers that do not go together; sessions that are
//! used again.

use crate::beside::Items;
use spikewire::filter::{Biquad, FirstOrder};
use spikewire::link::{
    Coding, FrameView, MAX_FRAME, Reader, Receiver, Session, Transmitter, Withheld, join,
};
use spikewire::population::{Position, Slots};
use spikewire::rate::{Hough, Taps};
use spikewire::temporal::{SendOnDelta, StepForward, TemporalContrast};
use spikewire::{
    Bank, ConfigError, Event, Fingerprint, FromItems, Item, Keyframe, Polarity, Sample, Scheme,
    Start, Taken, Tick,
};

const PERIOD: u32 = 1_000;
const CHANNELS: usize = 3;
/// Samples from one keyframe to the next.
const BEAT: u32 = 10;
const SAMPLES: u32 = 1_000;

static RATES: StepForward<i16> = StepForward::new(12);
static FORCES: SendOnDelta<i16, 16> = SendOnDelta::new(5);
static CONTRAST: TemporalContrast<i16> = TemporalContrast::new(12);
static POSITION: Position<i16, 9> = Position::linear(-100..=100);
static HOUGH: Hough<f32, 7> = Hough::new(Taps::triangular(0.5));

fn tick(sample: u32) -> Tick {
    Tick::from(1_000_000 + sample * PERIOD)
}

/// A signal of this height for each channel, which moves from sample to sample.
fn signal<S: Sample>(sample: u32, height: f64) -> [S; CHANNELS] {
    std::array::from_fn(|channel| {
        let time = f64::from(sample) * 0.05 + channel as f64;
        S::from_f64(height * (time.sin() + 0.3 * (3.1 * time).cos()))
    })
}

/// What a receiver should hold.
struct Beside<'a, P: Scheme> {
    scheme: &'a P,
    encoders: [P::EncoderState; CHANNELS],
    decoders: [P::DecoderState; CHANNELS],
    values: [P::Sample; CHANNELS],
}

impl<'a, P: Start> Beside<'a, P> {
    fn new(scheme: &'a P) -> Self {
        Self {
            scheme,
            encoders: [P::START; CHANNELS],
            decoders: [(); CHANNELS].map(|()| scheme.decoder_state()),
            values: [P::Sample::default(); CHANNELS],
        }
    }

    fn sample(&mut self, samples: [P::Sample; CHANNELS], has_keyframe: bool) {
        use spikewire::Output;
        for (channel, sample) in samples.into_iter().enumerate() {
            let (encoder, decoder) = (&mut self.encoders[channel], &mut self.decoders[channel]);
            if let Some(code) = self.scheme.encode(encoder, sample).code() {
                self.values[channel] = self.scheme.decode(decoder, code);
            }
            if let Some(keyframe) = self.scheme.keyframe(encoder).filter(|_| has_keyframe) {
                self.scheme.resync(decoder, keyframe);
                self.values[channel] = keyframe;
            }
        }
    }

    /// How many values are called exact, and how many of them are not.
    fn compare<const EVENTS: usize>(
        &self,
        receiver: &Receiver<&P, CHANNELS, EVENTS>,
    ) -> [usize; 2] {
        let mut claims = [0, 0];
        for (channel, truth) in (0..).zip(self.values) {
            if let Some(exact) = receiver.exact(channel) {
                claims[0] += 1;
                claims[1] += usize::from(exact.to_bits32() != truth.to_bits32());
            }
        }
        claims
    }
}

/// Two banks and two receivers, and what was claimed of each bank.
struct Pair<'a, P: Scheme, Q: Scheme> {
    schemes: (&'a P, &'a Q),
    banks: (Bank<&'a P, CHANNELS>, Bank<&'a Q, CHANNELS>),
    receivers: (Receiver<&'a P, CHANNELS, 64>, Receiver<&'a Q, CHANNELS, 64>),
    claims: [[usize; 2]; 2],
}

impl<'a, P: Start, Q: Start> Pair<'a, P, Q> {
    fn new(one: &'a P, other: &'a Q) -> Self {
        Self {
            schemes: (one, other),
            banks: (Bank::new(one), Bank::new(other)),
            receivers: (Receiver::new(one), Receiver::new(other)),
            claims: [[0; 2]; 2],
        }
    }

    /// Flies with both banks in one queue.
    fn fly(&mut self, link: &mut Transmitter) {
        let mut beside = (Beside::new(self.schemes.0), Beside::new(self.schemes.1));
        let mut reader = Reader::<MAX_FRAME>::new();
        for number in 0..SAMPLES {
            let has_keyframe = number % BEAT == BEAT - 1;
            let (rates, forces) = (signal(number, 100.0), signal(number + 40, 70.0));
            let mut items = Items::default();
            self.banks.0.encode_into(tick(number), rates, &mut items);
            self.banks.1.encode_into(tick(number), forces, &mut items);
            if has_keyframe {
                self.banks.0.keyframe_into(tick(number), &mut items);
                self.banks.1.keyframe_into(tick(number), &mut items);
            }
            beside.0.sample(rates, has_keyframe);
            beside.1.sample(forces, has_keyframe);
            let (mut source, mut buffer) = (FromItems(items.0.into_iter()), [0; MAX_FRAME]);
            while let Some(mut bytes) = link.next_frame(&mut source, &mut buffer).unwrap() {
                while let Some(received) = reader.next_frame(&mut bytes) {
                    self.receivers.0.apply(&received, |_, _, _| ());
                    self.receivers.1.apply(&received, |_, _, _| ());
                }
            }
            let now = tick(number) + PERIOD;
            self.receivers.0.advance(now, |_, _, _| ());
            self.receivers.1.advance(now, |_, _, _| ());
            let claims = [beside.0.compare(&self.receivers.0), beside.1.compare(&self.receivers.1)];
            for (sum, claims) in self.claims.iter_mut().zip(claims) {
                sum[0] += claims[0];
                sum[1] += claims[1];
            }
        }
    }
}

/// Banks that are joined: each receiver is right, and nothing is outside.
fn fly_joined<P: Start, Q: Start>(one: &P, other: &Q) {
    let mut pair = Pair::new(one, other);
    let banks: &mut [&mut dyn spikewire::link::Part] = &mut [&mut pair.banks.0, &mut pair.banks.1];
    let mut link = Transmitter::for_banks(banks, PERIOD, Session::counted(7)).unwrap();
    let joint = join(&mut [&mut pair.receivers.0, &mut pair.receivers.1]).unwrap();
    assert_eq!(joint.addresses() as usize, CHANNELS * (one.neurons() + other.neurons()));
    pair.fly(&mut link);
    for [exact, wrong] in pair.claims {
        assert!(exact > 2_900 && wrong == 0, "{:?}", pair.claims);
    }
    assert_eq!((pair.receivers.0.outside(), pair.receivers.1.outside()), (0, 0));
    assert_eq!((link.foreign(), pair.receivers.0.misfits(), pair.receivers.1.misfits()), (0, 0, 0));
}

#[test]
fn joined_banks_share_a_link() {
    fly_joined(&RATES, &FORCES);
    fly_joined(&FORCES, &CONTRAST);
    fly_joined(&RATES, &POSITION);
    fly_joined(&POSITION, &FORCES);
    fly_joined(&HOUGH, &RATES);
    fly_joined(&POSITION, &HOUGH);
}

#[test]
fn ends_that_are_joined_in_another_order_are_not_the_same() {
    let mut pair = Pair::new(&RATES, &FORCES);
    let banks: &mut [&mut dyn spikewire::link::Part] = &mut [&mut pair.banks.0, &mut pair.banks.1];
    let mut link = Transmitter::for_banks(banks, PERIOD, Session::counted(7)).unwrap();
    join(&mut [&mut pair.receivers.1, &mut pair.receivers.0]).unwrap();
    pair.fly(&mut link);
    assert_eq!(pair.claims, [[0; 2]; 2]);
    assert!(matches!(pair.receivers.0.withheld(0), Some(Withheld::Description { .. })));
}

/// The label counts at both ends, and joining does not take it away.
#[test]
fn joined_ends_have_one_label() {
    let mut bank = Bank::<_, 1>::new(&RATES);
    let mut other = Bank::<_, 1>::new(&RATES);
    let (mut one, mut two) = (Receiver::<_, 1>::new(&RATES), Receiver::<_, 1>::new(&RATES));
    one = one.with_label("gyro, accel");
    let of_banks = join(&mut [&mut bank, &mut other]).unwrap().fingerprint();
    let of_receivers = join(&mut [&mut one, &mut two]).unwrap().fingerprint();
    assert_eq!(of_banks, of_receivers);
    let [first, second] = [bank.fingerprint(), other.fingerprint()];
    assert_eq!(of_banks, Fingerprint::new("Joint").and(first).and(second).number(2));
    assert_eq!(
        (one.fingerprint(), two.fingerprint()),
        (of_banks.labelled("gyro, accel"), of_banks)
    );
    assert_eq!(two.with_label("x").fingerprint(), of_banks.labelled("x"));
}

#[test]
fn what_cannot_be_joined_is_an_error() {
    static WIDE: Position<f32, 1_000> = Position::linear(0.0..=1.0);
    let error = join(&mut []).unwrap_err().to_string();
    assert_eq!(error, "addresses of all parts 0 must lie in 1..=65536");
    let (mut one, mut two) = (Bank::<_, 40>::new(&WIDE), Bank::<_, 40>::new(&WIDE));
    let error = join(&mut [&mut one, &mut two]).unwrap_err().to_string();
    assert_eq!(error, "addresses of all parts 80000 must lie in 1..=65536");
    assert_eq!(join(&mut [&mut one]).unwrap().addresses(), 40_000);
}

/// A bank that is not joined, with addresses of its own: the transmitter refuses its items, and counts them.
#[test]
fn a_foreign_bank_is_noticed_by_the_sender() {
    let mut pair = Pair::new(&RATES, &FORCES);
    pair.banks.1 = pair.banks.1.with_first_address(3);
    let mut link = Transmitter::for_bank(&pair.banks.0, PERIOD, Session::counted(7));
    pair.fly(&mut link);
    let [[exact, wrong], others] = pair.claims;
    assert!(exact > 2_900 && wrong == 0, "{:?}", pair.claims);
    assert_eq!(others, [0, 0]);
    assert!(link.foreign() > 500, "{}", link.foreign());
    assert_eq!(pair.receivers.0.outside(), 0);
}

/// What was lost before an item of a foreign bank may be the bank's own.
#[test]
fn a_loss_before_a_foreign_item_is_told() {
    let bank = Bank::<_, 1>::new(&RATES).with_first_address(5);
    let mut link = Transmitter::for_bank(&bank, PERIOD, Session::counted(7));
    let event = |address| Event { tick: tick(1), address, polarity: Polarity::Up };
    let items = [
        Taken::from(event(4)),
        Taken::from(event(5)),
        Taken { lost: 2, item: Item::Event(event(6)) },
        Taken { lost: 1, item: Item::Heartbeat { tick: tick(1), address: 0 } },
        Taken::from(Item::Keyframe(Keyframe::new(tick(1), 6, 3_i16))),
        Taken::from(event(5)),
    ];
    let (mut source, mut buffer) = (FromItems(items.into_iter()), [0; MAX_FRAME]);
    let mut frames = Vec::new();
    while let Some(bytes) = link.next_frame(&mut source, &mut buffer).unwrap() {
        let (frame, _) = FrameView::new(bytes).unwrap();
        frames.push((frame.is_after_loss(), frame.events().map(|event| event.address).collect()));
    }
    assert_eq!(frames, [(false, vec![5]), (true, vec![]), (true, vec![5])]);
    assert_eq!(link.foreign(), 4);
}

/// Two banks that are not joined, with the same addresses, whose keyframes come together: no value is exact, and it is
/// told why.
#[test]
fn banks_with_the_same_addresses_are_noticed_by_their_keyframes() {
    let heard = |mut pair: Pair<'_, StepForward<i16>, StepForward<i16>>| {
        let mut link = Transmitter::for_bank(&pair.banks.0, PERIOD, Session::counted(7));
        pair.fly(&mut link);
        (pair.claims, pair.receivers.0.withheld(0))
    };
    let (claims, why) = heard(Pair::new(&RATES, &RATES));
    assert_eq!((claims[0], why), ([0, 0], Some(Withheld::Contradicted)));
    // A code whose keyframes contradict no value before them.
    let mut pair = Pair::new(&CONTRAST, &CONTRAST);
    let mut link = Transmitter::for_bank(&pair.banks.0, PERIOD, Session::counted(7));
    pair.fly(&mut link);
    assert_eq!(pair.claims[0], [0, 0]);
    assert_eq!(pair.receivers.0.withheld(0), Some(Withheld::Contradicted));
    assert!(pair.receivers.0.contradicted() > 50);
}

/// Nor does a code without keyframes take the spikes of two banks for those of one.
#[test]
fn spikes_of_two_banks_make_no_code() {
    let mut pair = Pair::new(&POSITION, &POSITION);
    let mut link = Transmitter::for_bank(&pair.banks.0, PERIOD, Session::counted(7));
    pair.fly(&mut link);
    let [[_, wrong], _] = pair.claims;
    assert_eq!(wrong, 0, "{:?}", pair.claims);
    assert!(pair.receivers.0.misfits() > 500);
}

/// A link of one channel whose items are put by hand.
struct Hand {
    link: Transmitter,
    reader: Reader<MAX_FRAME>,
    receiver: Receiver<&'static StepForward<i16>, 1>,
    now: u32,
}

impl Hand {
    fn new() -> Self {
        let receiver = Receiver::new(&RATES);
        let coding = Coding::for_channels(1, PERIOD);
        let link = Transmitter::new(coding, Session::counted(7));
        let link = link.with_fingerprint(receiver.fingerprint());
        Self { link, reader: Reader::new(), receiver, now: 0 }
    }

    fn keyframe(&mut self, value: i16) -> Option<i16> {
        self.now += 1;
        self.send(Item::Keyframe(Keyframe::new(tick(self.now), 0, value)));
        self.receiver.exact(0)
    }

    fn event(&mut self, polarity: Polarity) {
        self.now += 1;
        self.send(Item::Event(Event { tick: tick(self.now), address: 0, polarity }));
    }

    fn send(&mut self, item: Item) {
        let mut buffer = [0; MAX_FRAME];
        let bytes = self.link.next_frame(FromItems([item].into_iter()), &mut buffer).unwrap();
        let mut bytes = bytes.unwrap();
        let received = self.reader.next_frame(&mut bytes).unwrap();
        self.receiver.apply(&received, |_, _, _| ());
    }
}

/// A keyframe that contradicts, though the fingerprint is the receiver's own and nothing was lost, makes the sender one that
/// is not believed until 256 keyframes agree.
#[test]
fn a_contradiction_under_the_same_fingerprint_withholds() {
    let mut hand = Hand::new();
    assert_eq!(hand.keyframe(5), Some(5));
    assert_eq!(hand.keyframe(5), Some(5));
    assert_eq!(hand.keyframe(6), None);
    assert_eq!(hand.receiver.withheld(0), Some(Withheld::Contradicted));
    assert_eq!((hand.receiver.compared(), hand.receiver.contradicted()), (2, 1));
    for _ in 0..255 {
        assert_eq!(hand.keyframe(6), None);
    }
    assert_eq!((hand.keyframe(6), hand.receiver.withheld(0)), (Some(6), None));
    // Two contradictions take twice as many.
    hand.keyframe(7);
    hand.keyframe(8);
    for _ in 0..511 {
        assert_eq!(hand.keyframe(8), None);
    }
    assert_eq!(hand.keyframe(8), Some(8));
    // A start is believed at once.
    assert_eq!(hand.keyframe(9), None);
    hand.link = Transmitter::new(Coding::for_channels(1, PERIOD), Session::counted(8))
        .with_fingerprint(hand.receiver.fingerprint());
    assert_eq!(hand.keyframe(1), Some(1));
}

/// Each fingerprint is compared, not the first one alone.
#[test]
fn a_sender_that_changes_its_fingerprint_is_not_believed() {
    let mut hand = Hand::new();
    assert_eq!(hand.keyframe(5), Some(5));
    let own = hand.receiver.fingerprint();
    hand.link = hand.link.with_fingerprint(Fingerprint::from_bits(9));
    let heard: Vec<_> = (0..600).map(|_| hand.keyframe(5)).collect();
    assert_eq!(heard.last(), Some(&None), "a full frame tells it");
    let other = Withheld::Description { own, sender: Fingerprint::from_bits(9) };
    assert_eq!(hand.receiver.withheld(0), Some(other));
    hand.link = hand.link.with_fingerprint(own);
    assert!(
        (0..600).any(|_| hand.keyframe(5) == Some(5)),
        "and believed once it has the right one"
    );
}

/// Keyframes that come once more in a frame are compared, also those of a code whose keyframes hold no value before them.
#[test]
fn keyframes_that_come_twice_in_a_frame_are_compared() {
    for (addresses, contradicted) in
        [(&[0, 1][..], 0), (&[0, 0], 1), (&[0, 1, 0, 1], 2), (&[0, 1, 1, 0, 1], 3)]
    {
        let mut receiver = Receiver::<_, 2>::new(&CONTRAST);
        let mut link = Transmitter::new(Coding::for_channels(2, PERIOD), Session::counted(7));
        let keyframes = (0..).zip(addresses);
        let items = keyframes
            .map(|(value, &address)| Item::Keyframe(Keyframe::new(tick(1), address, value as i16)));
        let (mut source, mut buffer) = (FromItems(items), [0; MAX_FRAME]);
        let mut reader = Reader::<MAX_FRAME>::new();
        let mut frames = 0;
        while let Some(mut bytes) = link.next_frame(&mut source, &mut buffer).unwrap() {
            receiver.apply(&reader.next_frame(&mut bytes).unwrap(), |_, _, _| ());
            frames += 1;
        }
        assert_eq!(frames, 1);
        assert_eq!((receiver.compared(), receiver.contradicted()), (contradicted, contradicted));
        assert_eq!(receiver.exact(0).is_some(), contradicted == 0, "{addresses:?}");
    }
}

/// A frame without a fingerprint says nothing of the sender's schemes: what was known of them stays so.
#[test]
fn a_frame_without_a_fingerprint_changes_no_verdict() {
    for sender in [None, Some(Fingerprint::from_bits(9))] {
        let mut hand = Hand::new();
        let coding = Coding::for_channels(1, PERIOD);
        let unnamed = Transmitter::new(coding, Session::counted(7)).with_full_every(0);
        let own = hand.receiver.fingerprint();
        hand.link = unnamed.with_fingerprint(sender.unwrap_or(own));
        assert_eq!(hand.keyframe(5), sender.is_none().then_some(5));
        // The same session without a fingerprint, from its second frame on.
        hand.link = unnamed;
        let first = [Item::Keyframe(Keyframe::new(tick(1), 0, 5_i16))];
        hand.link.next_frame(FromItems(first.into_iter()), &mut [0; MAX_FRAME]).unwrap();
        assert_eq!(hand.keyframe(5), sender.is_none().then_some(5), "{sender:?}");
        if let Some(sender) = sender {
            assert_eq!(hand.receiver.withheld(0), Some(Withheld::Description { own, sender }));
            continue;
        }
        // A sender that was known to have the same schemes is believed again after 256 keyframes that agree.
        assert_eq!(hand.keyframe(6), None);
        let heard: Vec<_> = (0..256).map(|_| hand.keyframe(6)).collect();
        assert_eq!(heard.last(), Some(&Some(6)));
    }
}

/// The numbers of a sender's steps begin anew with it: none of those before heals a step of another start.
#[test]
fn step_numbers_of_another_start_heal_nothing() {
    let mut hand = Hand::new();
    let start = |starts| {
        let link = Transmitter::new(Coding::for_channels(1, PERIOD), Session::counted(starts));
        link.with_step_bits(3).with_full_every(0)
    };
    hand.link = start(7);
    assert_eq!(hand.keyframe(0), Some(0));
    for steps in 1..=5 {
        hand.event(Polarity::Up);
        assert_eq!(hand.receiver.exact(0), Some(12 * steps));
    }
    hand.link = start(8);
    hand.event(Polarity::Up);
    assert_eq!((hand.receiver.exact(0), hand.receiver.estimate(0)), (None, 12 * 6));
}

fn refusal<P: Start>(scheme: &P, slot_ticks: u32, period: u32) -> Option<String> {
    let bank = Bank::<_, 1>::new(scheme).with_slot_ticks(slot_ticks);
    let error = Transmitter::try_for_bank(&bank, period, Session::counted(7)).err();
    let mut joined = bank.clone();
    let banks: &mut [&mut dyn spikewire::link::Part] = &mut [&mut joined];
    let joint: Option<ConfigError> =
        Transmitter::for_banks(banks, period, Session::counted(7)).err();
    assert_eq!(error, joint);
    error.map(|error| error.to_string())
}

/// A filter for another rate has another corner.
#[test]
fn a_filter_for_another_rate_is_refused() {
    let low_pass = Biquad::low_pass(40.0, 500.0).before(RATES);
    let says = "rate of the filter 500 must lie in 950..=1050";
    assert_eq!(refusal(&low_pass, 0, 1_000).as_deref(), Some(says));
    assert_eq!(refusal(&low_pass, 0, 2_000), None);
    for (rate, is_refused) in [(470.0, true), (476.0, false), (524.0, false), (530.0, true)] {
        let filters = [
            refusal(&Biquad::notch(40.0, rate, 2.0).before(RATES), 0, 2_000),
            refusal(&FirstOrder::low_pass(40.0, rate).before(RATES), 0, 2_000),
            refusal(
                &Biquad::low_pass(40.0, 500.0)
                    .before(FirstOrder::low_pass(40.0, rate).before(RATES)),
                0,
                2_000,
            ),
        ];
        assert!(filters.iter().all(|refusal| refusal.is_some() == is_refused), "{filters:?}");
    }
}

#[test]
#[should_panic(expected = "rate of the filter must lie in 950..=1050")]
fn a_filter_for_another_rate_stops_the_start() {
    let low_pass = Biquad::low_pass(40.0, 500.0).before(RATES);
    let bank = Bank::<_, 1>::new(&low_pass);
    let _ = Transmitter::for_bank(&bank, 1_000, Session::counted(7));
}

/// Sub-timesteps that are longer than a sample are refused where they are sent; those that leave no room for a fast clock,
/// where the clock's tolerance is known.
#[test]
fn sub_timesteps_have_room_in_a_period() {
    static SLOTS: Slots<f32, 8, 8> = Slots::new(0.0..=2.0, 1.5);
    let says = "time of all sub-timesteps 1008 must lie in 0..=1000";
    assert_eq!(refusal(&SLOTS, 126, 1_000).as_deref(), Some(says));
    assert_eq!(refusal(&SLOTS, 125, 1_000), None);
    assert_eq!(refusal(&RATES, 5_000, 1_000), None, "a code whose values they do not tell");
    for (tolerance, fits) in
        [(0, true), (20_000, true), (62_000, true), (63_000, false), (100_000, false)]
    {
        let mut bank = Bank::<_, 1>::new(&SLOTS).with_slot_ticks(125);
        let mut link = Transmitter::for_bank(&bank, PERIOD, Session::counted(7));
        let receiver = Receiver::<_, 1>::new(&SLOTS).with_slot_ticks(125);
        let mut receiver = receiver.with_clock_tolerance(tolerance);
        let mut reader = Reader::<MAX_FRAME>::new();
        let mut items = Items::default();
        for number in 0..3 {
            bank.encode_into(tick(number), [0.7], &mut items);
            bank.keyframe_into(tick(number), &mut items);
        }
        let (mut source, mut buffer) = (FromItems(items.0.into_iter()), [0; MAX_FRAME]);
        while let Some(mut bytes) = link.next_frame(&mut source, &mut buffer).unwrap() {
            let frame = reader.next_frame(&mut bytes).unwrap();
            receiver.apply(&frame, |_, _, _| ());
        }
        let why = receiver.withheld(0);
        let is_refused = matches!(why, Some(Withheld::Slots { slots: 8, slot_ticks: 125, .. }));
        assert_eq!(is_refused, !fits, "{tolerance}: {why:?}");
    }
}

/// Frames of a session, each with a keyframe of this value.
fn run(session: Session, value: i16, count: usize, full_every: u32) -> Vec<Vec<u8>> {
    let receiver = Receiver::<_, 1>::new(&RATES);
    let mut link = Transmitter::new(Coding::for_channels(1, PERIOD), session)
        .with_fingerprint(receiver.fingerprint())
        .with_full_every(full_every);
    let one = |number: usize| {
        let keyframe = Keyframe::new(tick(50 * number as u32), 0, value);
        let mut buffer = [0; MAX_FRAME];
        let items = [Item::Keyframe(keyframe)];
        link.next_frame(FromItems(items.into_iter()), &mut buffer).unwrap().unwrap().to_vec()
    };
    (0..count).map(one).collect()
}

/// A receiver that joined late and never had the first frame of a session hears another start with the same session: within
/// 16 frames it goes on with that, and meanwhile calls no value of the other exact but the last.
#[test]
fn a_session_that_is_used_again_is_heard_within_sixteen_frames() {
    used_again(0, 15);
    // Short frames that cannot be read are none of the sixteen, but a late full one then counts for eight.
    used_again(1 << 19, 27);
}

fn used_again(full_every: u32, most_left_out: usize) {
    for joined in [1, 5, 14, 15, 16, 17, 40, 144, 255, 256, 300] {
        for heard in [3, 12, 20, 100] {
            for first_lost in [0, 1, 3] {
                let (one, two) = (
                    run(Session::counted(7), 0, joined + heard, full_every),
                    run(Session::counted(7), 5_000, 400, full_every),
                );
                let (mut reader, mut receiver) =
                    (Reader::<MAX_FRAME>::new(), Receiver::<_, 1>::new(&RATES));
                let mut left_out = 0;
                for frame in &one[joined..] {
                    let mut bytes = &frame[..];
                    if let Some(received) = reader.next_frame(&mut bytes) {
                        receiver.apply(&received, |_, _, _| ());
                    }
                }
                for frame in &two[first_lost..] {
                    let mut bytes = &frame[..];
                    let Some(frame) = reader.next_frame(&mut bytes) else {
                        left_out += 1;
                        continue;
                    };
                    receiver.apply(&frame, |_, _, _| ());
                    let is_old = receiver.exact(0).is_some_and(|exact| exact < 5_000);
                    assert!(!is_old, "{joined} {heard} {first_lost}");
                }
                assert_eq!(receiver.exact(0), Some(5_000));
                // At once by its first frame, if the other had gone on for longer than frames are late.
                let is_known = first_lost == 0 && joined + heard > 16 && full_every == 0;
                let most = if is_known { 0 } else { most_left_out };
                assert!(left_out <= most, "{joined} {heard} {first_lost}: {left_out}");
            }
        }
    }
}
