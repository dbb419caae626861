//! Feeds the events of a source to the chip.

use embedded_hal::spi::SpiDevice;

use super::aer::Carries;
use super::{AerPort, Input, Outcome, Running};
use spikewire::{Event, Source};

impl<I: Input, D: SpiDevice, P: AerPort> Running<'_, I, D, P> {
    /// Sends all events of `events` to the chip, and the time steps that pass between these events. Returns the number
    /// of events sent. Each event is sent as the input that `to_input` returns for it, for example by
    /// [`Describe::input_for`](super::Describe::input_for). If `to_input` returns `None`, the event is dropped and
    /// [counted](super::Counters::unmapped_events). Items that are not events, such as keyframes, are skipped.
    ///
    /// To feed from a queue, pass the result of `waiting()` on the queue's consumer. This source contains only the
    /// items that are in the queue at the time of that call. Therefore `feed` returns even if events arrive faster than
    /// the chip takes them.
    ///
    /// The events' ticks must not decrease. An event whose time step is over is sent in the current time step, and
    /// counted as [late](super::Counters::late_events).
    ///
    /// # Errors
    /// Returns the errors of [`send`](Self::send). After an error, call `feed` again with the remaining events. No
    /// event is lost or sent twice, with two exceptions. An event whose input is invalid is dropped. An event may be
    /// sent again after a reset, and is then [counted](super::Counters::repeated_events).
    pub fn feed<A: Into<Option<I>>>(
        &mut self,
        mut events: impl Source,
        mut to_input: impl FnMut(Event) -> A,
        mut on_output: impl FnMut(u8),
    ) -> Outcome<u32, D, P> {
        self.chip.aer.finish(&mut on_output)?;
        let mut sent = 0_u32;
        while let Some(event) = self.chip.held.take().or_else(|| self.next_of(&mut events)) {
            let Some(input) = to_input(event).into() else {
                let count = &mut self.chip.counters.unmapped_events;
                *count = count.saturating_add(1);
                continue;
            };
            let word = input.word()?;
            self.feed_word(word, event, &mut on_output)?;
            sent = sent.wrapping_add(1);
        }
        Ok(sent)
    }

    /// Sends the time steps up to the tick of `event`, then `word`, the input word for `event`. If an error occurs
    /// before the word is on the bus, stores `event` for the next call.
    fn feed_word(
        &mut self,
        word: u32,
        event: Event,
        on_output: &mut impl FnMut(u8),
    ) -> Outcome<(), D, P> {
        self.chip.held = Some(event);
        self.advance_with(event.tick, on_output)?;
        self.chip.aer.begin(word, Carries::Event(event), on_output)?;
        self.chip.held = None;
        Ok(self.chip.aer.finish(on_output)?)
    }

    fn next_of(&mut self, events: &mut impl Source) -> Option<Event> {
        let event = events.take_event()?;
        if self.chip.time.is_some_and(|time| time.is_over(event.tick)) {
            let count = &mut self.chip.counters.late_events;
            *count = count.saturating_add(1);
        }
        Some(event)
    }
}
