//! The flight controller: a bank, a queue, a transmitter, and beside them a decoder for each channel that loses nothing.

use spikewire::{
    Bank, Decoder, EventQueue, Item, Overflow, Put, Scheme, Source, Tick,
    link::{Session, Transmitter},
    temporal::StepForward,
};

use crate::world::{CHANNELS, PERIOD};

/// A spike for every 0.1 rad/s.
static RATE: StepForward<f32> = StepForward::new(0.1);
/// A spike for every 0.5 m/s².
static ACCELERATION: StepForward<f32> = StepForward::new(0.5);
pub const SCHEMES: Schemes = [&RATE, &RATE, &RATE, &ACCELERATION, &ACCELERATION, &ACCELERATION];
pub type Schemes = [&'static StepForward<f32>; CHANNELS];

/// Items that the queue holds.
const ROOM: usize = 64;

pub struct Sender {
    starts: u32,
    micros: u64,
    bank: Bank<Schemes, CHANNELS>,
    queue: EventQueue<ROOM>,
    transmitter: Transmitter,
    decoders: [Decoder<'static, StepForward<f32>>; CHANNELS],
    /// What the decoders hold, from the first sample on.
    truth: Option<[f32; CHANNELS]>,
    /// Items that were offered to the queue, and those that were taken from it.
    offered: u32,
    taken: u32,
    told: u32,
}

impl Sender {
    pub fn new(starts: u32, micros: u64) -> Self {
        let bank = Bank::per_channel(SCHEMES);
        let transmitter = Transmitter::for_bank(&bank, PERIOD, Session::counted(starts));
        Self {
            starts,
            micros,
            bank,
            queue: EventQueue::new(Overflow::DropOldest),
            transmitter,
            decoders: SCHEMES.map(Scheme::decoder),
            truth: None,
            offered: 0,
            taken: 0,
            told: 0,
        }
    }

    pub const fn starts(&self) -> u32 {
        self.starts
    }

    pub const fn truth(&self) -> Option<[f32; CHANNELS]> {
        self.truth
    }

    pub fn lost(&self) -> u32 {
        self.queue.lost()
    }

    pub fn rejected(&self) -> u32 {
        self.bank.rejected()
    }

    /// A period without a sample.
    pub const fn wait(&mut self) {
        self.micros += PERIOD as u64;
    }

    /// What the interrupt does.
    pub fn sample(&mut self, samples: [f32; CHANNELS]) {
        self.wait();
        let Self { bank, queue, decoders, truth, offered, .. } = self;
        let truth = truth.get_or_insert_with(|| {
            for (decoder, sample) in decoders.iter_mut().zip(samples) {
                decoder.resync(sample);
            }
            samples
        });
        let tick = Tick::from_micros(self.micros);
        bank.encode_into(tick, samples, Beside { queue, offered, decoders, truth });
    }

    /// A keyframe of each channel.
    pub fn keyframe(&mut self) {
        let Self { bank, queue, decoders, truth: Some(truth), offered, .. } = self else { return };
        let tick = Tick::from_micros(self.micros);
        bank.keyframe_into(tick, Beside { queue, offered, decoders, truth });
    }

    /// What main does: the next frame of what waits.
    pub fn frame<'a>(&mut self, buffer: &'a mut [u8]) -> Result<Option<&'a [u8]>, &'static str> {
        self.transmitter.observe(Tick::from_micros(self.micros));
        let consumer = self.queue.consumer().ok_or("there is a consumer already")?;
        let counted = Counted { items: consumer, taken: &mut self.taken, told: &mut self.told };
        self.transmitter.next_frame(counted, buffer).map_err(|_| "a frame found no room")
    }

    /// Every item was taken, or its loss was told in its place.
    pub fn is_accounted_for(&self) -> bool {
        self.offered == self.taken + self.queue.lost() && self.told == self.queue.lost()
    }
}

/// The queue, and the decoders beside it.
struct Beside<'a> {
    queue: &'a EventQueue<ROOM>,
    offered: &'a mut u32,
    decoders: &'a mut [Decoder<'static, StepForward<f32>>; CHANNELS],
    truth: &'a mut [f32; CHANNELS],
}

impl Put for Beside<'_> {
    fn put(&mut self, item: Item) {
        *self.offered += 1;
        if let Item::Event(event) = item {
            let channel = usize::from(event.address);
            self.truth[channel] = self.decoders[channel].decode(event.polarity.into());
        }
        let mut queue = self.queue;
        queue.put(item);
    }
}

/// A queue's other end, which counts.
struct Counted<'a, T> {
    items: T,
    taken: &'a mut u32,
    told: &'a mut u32,
}

impl<T: Source> Source for Counted<'_, T> {
    fn take(&mut self) -> Option<spikewire::Taken> {
        let taken = self.items.take()?;
        *self.taken += 1;
        *self.told += taken.lost;
        Some(taken)
    }
}
