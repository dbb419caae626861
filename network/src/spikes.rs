//! Lists of spikes.

use spikewire::{Event, Polarity, Tick};

/// A list of the inputs or neurons that fired in a step, up to `MOST`.
///
/// Between a [`Bank`](spikewire::Bank) and a network it collects the events of a sample:
///
/// ```
/// use spikewire::{Bank, Tick, temporal::StepForward};
/// use spikewire_network::Spikes;
///
/// static GYRO: StepForward<f32> = StepForward::new(0.1);
/// let mut bank = Bank::<_, 3>::new(&GYRO);
/// let mut inputs = Spikes::<6>::new();
/// for (millis, rates) in [[0.0; 3], [0.2, 0.0, -0.3]].into_iter().enumerate() {
///     inputs.clear();
///     let tick = Tick::from_micros(1_000 * millis as u64);
///     bank.encode(tick, rates, |event| inputs.push_signed(event));
/// }
/// assert_eq!(inputs.as_slice(), [0, 5]); // channel 0 up, channel 2 down
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Spikes<const MOST: usize> {
    list: [u16; MOST],
    count: usize,
    lost: u32,
}

impl<const MOST: usize> Spikes<MOST> {
    /// Makes an empty list.
    pub const fn new() -> Self {
        const { assert!(MOST <= 1 << 16, "numbers of neurons have 16 bits") };
        Self { list: [0; MOST], count: 0, lost: 0 }
    }

    /// Appends an input's number; if the list is full, the input is lost and counted.
    #[inline]
    pub fn push(&mut self, input: u16) {
        if !self.append(input) {
            self.lost = self.lost.saturating_add(1);
        }
    }

    /// Appends an event's address; ignores its direction.
    #[inline]
    pub fn push_event(&mut self, event: Event) {
        self.push(event.address);
    }

    /// Appends twice an event's address, plus 1 if it goes down. Use it for codes with a direction, whose channels have
    /// an input for each direction.
    #[inline]
    pub fn push_signed(&mut self, event: Event) {
        let falls = u16::from(event.polarity == Polarity::Down);
        match event.address.checked_mul(2) {
            Some(up) => self.push(up | falls),
            None => self.lost = self.lost.saturating_add(1),
        }
    }

    #[inline(always)]
    pub(crate) fn append(&mut self, input: u16) -> bool {
        let slot = self.list.get_mut(self.count);
        let is_free = slot.is_some();
        if let Some(slot) = slot {
            *slot = input;
            self.count = self.count.wrapping_add(1);
        }
        is_free
    }

    /// Empties the list; the count of lost inputs stays.
    #[inline(always)]
    pub fn clear(&mut self) {
        self.count = 0;
    }

    /// Returns the numbers, in the order in which they were appended.
    #[inline(always)]
    pub fn as_slice(&self) -> &[u16] {
        self.list.get(..self.count).unwrap_or_default()
    }

    /// Returns the number of inputs that were lost because the list was full.
    pub const fn lost(&self) -> u32 {
        self.lost
    }

    /// Returns the spikes as events for a queue, a link or a [`Readout`](spikewire::Readout). The first neuron has the
    /// address `first_address`. Addresses above 65 535 are left out.
    pub fn events(&self, tick: Tick, first_address: u16) -> impl Iterator<Item = Event> {
        events(self.as_slice(), tick, first_address)
    }
}

/// Returns the neurons that fired as events.
pub(crate) fn events(fired: &[u16], tick: Tick, first: u16) -> impl Iterator<Item = Event> {
    let event = move |address| Event { tick, address, polarity: Polarity::Up };
    fired.iter().filter_map(move |&neuron| first.checked_add(neuron)).map(event)
}

impl<const MOST: usize> Default for Spikes<MOST> {
    fn default() -> Self {
        Self::new()
    }
}
