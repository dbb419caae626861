//! Every method, on values of which the compiler knows nothing.

use core::hint::black_box;

use spikewire::{
    Bank, Code, Encoder, Event, EventQueue, Output, Overflow, Polarity, Readout, Scheme, Start,
    Tick,
    link::{MAX_FRAME, Reader, Receiver},
};

pub static EVENTS: EventQueue<16> = EventQueue::new(Overflow::DropOldest);

/// Uses a value where the compiler cannot see how.
pub fn hide<T>(value: T) {
    drop(black_box(value));
}

/// A time.
pub fn tick() -> Tick {
    black_box(Tick::from_micros(1))
}

/// An event.
pub fn event() -> Event {
    black_box(Event { tick: tick(), address: 2, polarity: Polarity::Up })
}

/// A scheme whose encoder starts by itself.
pub fn scheme<P: Start>(scheme: &P) {
    codec(scheme, P::START);
    let mut encoder = black_box(scheme.encoder());
    encoder.reset();
    hide(encoder.rejected());
    bank(scheme, P::START);
    let mut bank = black_box(Bank::<_, 2>::new(scheme));
    bank.encode(tick(), black_box([P::Sample::default(); 2]), hide);
    bank.reset_into(tick(), &EVENTS);
    hide(bank);
    ends(scheme);
}

/// A scheme, from a state of its encoder.
pub fn codec<P: Scheme>(scheme: &P, start: P::EncoderState) {
    let mut encoder = black_box(Encoder::with_state(scheme, start));
    let mut decoder = black_box(scheme.decoder());
    let samples = black_box([P::Sample::default(); 4]);

    encoder.prime(black_box(&samples));
    let mut outputs = samples.map(|sample| encoder.encode(sample));
    black_box(encoder.encode_slice(&samples, &mut outputs));
    for code in black_box(outputs).into_iter().filter_map(Output::code) {
        for firing in code.firings() {
            black_box(firing);
        }
        black_box(P::Code::assemble(code.firings()));
        let mut values = [decoder.decode(code)];
        black_box(decoder.decode_slice(black_box(&[code]), &mut values));
        black_box(values);
    }
    while let Some(code) = encoder.finish_next() {
        black_box(decoder.decode(code));
    }
    encoder.finish().for_each(hide);
    if let Some(value) = encoder.keyframe() {
        decoder.resync(value);
    }
    black_box(decoder.held());
    black_box(encoder.rejected());
    decoder.reset();
    black_box((encoder, decoder));
}

/// A bank of one channel, from a state of its encoder.
pub fn bank<P: Scheme>(scheme: &P, start: P::EncoderState) {
    let bank = Bank::<_, 1>::with_states(scheme, [start]).with_slot_ticks(black_box(10));
    let Ok(mut bank) = black_box(bank).try_with_first_address(black_box(3)) else { return };
    bank.encode_into(tick(), black_box([P::Sample::default()]), &EVENTS);
    bank.keyframe_into(tick(), &EVENTS);
    hide((bank.keyframe(black_box(0)), bank.rejected()));
}

/// What makes values of a scheme's events: a readout, and a receiver of two channels.
pub fn ends<P: Scheme>(scheme: &P) {
    let events = black_box([event(); 5]);
    let events = events.get(..black_box(5)).unwrap_or_default();
    let readout = Readout::<_, 2>::new(scheme).with_slot_ticks(black_box(10));
    if let Ok(mut readout) = black_box(readout).try_with_first_address(black_box(3)) {
        readout.resync(black_box(1), black_box(P::Sample::default()));
        hide(readout.decode(tick(), events));
        readout.reset();
        hide(readout);
    }
    let receiver = Receiver::<_, 2>::new(scheme).with_slot_ticks(black_box(10));
    let Ok(mut receiver) = black_box(receiver).try_with_first_address(black_box(3)) else { return };
    let mut reader = black_box(Reader::<MAX_FRAME>::new());
    let mut input = black_box(&[0_u8; 9][..]);
    while let Some(received) = reader.next_frame(&mut input) {
        receiver.apply(&received, |channel, tick, value| hide((channel, tick, value)));
    }
    receiver.advance(tick(), |channel, tick, value| hide((channel, tick, value)));
    receiver.mark_stale();
    hide((receiver.exact(black_box(1)), receiver.estimate(black_box(1))));
    hide((receiver.outside(), receiver.misfits(), reader));
}
