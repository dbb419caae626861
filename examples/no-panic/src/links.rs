//! The way to a chip and back: queue, link, sinks, chips and formats, on buses that do nothing.

use core::convert::Infallible;
use core::hint::black_box;
use core::num::NonZeroU32;
use embedded_hal::{
    delay::DelayNs,
    digital::{self, InputPin},
    spi::{self, ErrorKind, Operation, SpiDevice},
};
use spikewire::{
    Bank, Bins, Event, EventSource, Polarity, Readout,
    chip::{
        AerPort, Akd1500, ConvolutionEvent, DenseEvent, Describe, Input, InputBank, NetworkBytes,
        Odin, OdinChip, OdinInput, OdinRegisters, OdinSynapse, Registers, Spikes, TinyOdin,
        TinyOdinInput, Xylo, XyloMap,
    },
    format::{Edvs, EdvsTime, EventDecoder, EventFormat, EventStream, Evt2, eieio},
    link::{Coding, FrameView, Framer, MAX_FRAME, Raw, Reader, Receiver, Transmitter},
    population::{Centres, Position, ReceptiveFields, Slots},
    sink::{Batch, EventQueue, Formatted, Overflow, SerialSink, SpiSink},
    temporal::{StepDecoder, StepForward},
    tick,
};

static EVENTS: EventQueue<16> = EventQueue::new(Overflow::DropOldest);

/// Uses a value where the compiler cannot see how.
fn hide<T>(value: T) {
    drop(black_box(value));
}

pub fn link() {
    queue();
    framed(const { StepForward::<f32>::checked(1.0) });
    framed(const { StepForward::<i16>::checked(1) });
    formats();
    sinks();
    let registers = TinyOdinInput::registers(black_box(3), true, [0; 16]);
    family(TinyOdin::new(Bus, Bus, black_box(3)), &registers, 1);
    let synapse = OdinSynapse { weight: black_box(1), is_mapped: true };
    family(Odin::new(Bus, Bus, black_box(3)), &OdinRegisters::PLAIN, synapse);
    memory();
    counts();
    readouts();
}

fn event() -> Event {
    black_box(Event { tick: 1, address: 2, polarity: Polarity::Up })
}

fn queue() {
    let own = EventQueue::<3>::new(black_box(Overflow::Refuse));
    for queue in [own.push(event()), EVENTS.push(event())] {
        hide(queue.is_err());
    }
    hide((own.pop(), EVENTS.len(), EVENTS.lost(), EVENTS.refused(), EVENTS.peak()));
    EVENTS.drain().into_iter().for_each(hide);
    let (a, b) = black_box((1, 2));
    hide((tick::difference(a, b), tick::widen(a, black_box(3)), tick::compare(a, b)));
}

fn framed<S: Raw>(scheme: StepForward<S>) {
    let coding = black_box(Coding::for_channels(black_box(3), black_box(1_000)));
    let mut bank = Bank::<_, 3>::new(black_box(scheme));
    bank.encode(black_box(0), black_box([S::default(); 3]), |event| hide(EVENTS.push(event)));
    bank.encode_into(black_box(0), black_box([S::default(); 3]), &EVENTS);

    let mut transmitter = black_box(Transmitter::<S, 3>::new(coding));
    transmitter.keyframe(bank.snapshot(black_box(5), EVENTS.mark()));
    let mut reader = black_box(Reader::<MAX_FRAME>::new());
    let mut receiver: Receiver<S, 3> = Receiver::new(scheme);
    let mut buffer = black_box([0; 300]);
    while let Ok(Some(bytes)) =
        transmitter.next_frame(&EVENTS, buffer.get_mut(..black_box(300)).unwrap_or_default())
    {
        let mut input = black_box(bytes);
        while let Some(received) = reader.next_frame(&mut input) {
            receiver.apply(&received, |channel, tick, value| hide((channel, tick, value)));
        }
    }
    let mut framer = black_box(Framer::new(coding));
    framer.mark_loss();
    if let Ok(mut frame) = framer.start(black_box(1), &mut buffer) {
        hide((frame.keyframe(black_box(0), S::default()), frame.event(event()), frame.is_empty()));
        if let Ok((view, length)) = FrameView::new(black_box(frame.finish())) {
            hide((view.events().count(), view.keyframes().count(), length));
        }
    }
    hide((receiver.exact(black_box(1)), receiver.estimate(black_box(1)), receiver.misfits()));
    hide((reader.lost_frames(), reader.skipped(), transmitter.dropped_keyframes()));
    hide::<Receiver<S, 1>>(Receiver::from_decoders([decoder(scheme)]));
}

fn decoder<S: Raw>(scheme: StepForward<S>) -> StepDecoder<S> {
    spikewire::Scheme::decoder(scheme)
}

fn formats() {
    for time in
        [EdvsTime::None, EdvsTime::Delta, EdvsTime::Bits16, EdvsTime::Bits24, EdvsTime::Bits32]
    {
        let camera = black_box(Edvs::new(time));
        format(camera.encoder(), camera.decoder());
    }
    format(EventStream::encoder(), EventStream::decoder());
    format(Evt2::encoder(), black_box(Evt2::file_decoder()));
    let mut bytes = black_box([0; 32]);
    let length = eieio::encode(black_box(Some(1)), black_box([1, 2]), &mut bytes).unwrap_or(0);
    let datagram = bytes.get(..length).and_then(eieio::decode);
    hide(datagram.map(|datagram| datagram.keys().count()));
}

fn format(encoder: impl EventFormat, mut decoder: impl EventDecoder) {
    let mut batch = black_box(Formatted::new(encoder));
    let mut bytes = black_box([0; 32]);
    let length = batch.fill(&mut (&EVENTS), &mut bytes);
    let bytes = bytes.get(..length).unwrap_or_default();
    decoder.decode(black_box(bytes)).for_each(hide);
    hide((decoder.skipped(), batch.unspeakable()));
}

fn sinks() {
    let mut sink =
        black_box(SpiSink::<_, _, 32, _>::with_ready(Bus, Formatted::new(Evt2::encoder()), Bus));
    hide((sink.send(&EVENTS).is_ok(), sink.waiting()));
    let transmitter = Transmitter::<i16, 3>::new(black_box(Coding::for_channels(3, 1)));
    let mut sink = black_box(SerialSink::<_, _, 64>::new(Bus, transmitter));
    hide((sink.send(&EVENTS).is_ok(), sink.try_send(&EVENTS).is_ok()));
    hide((sink.flush().is_ok(), sink.waiting()));
}

fn family<I: Input>(chip: OdinChip<I, Bus, Bus>, registers: &I::Registers, synapse: I::Synapse) {
    let mut chip = black_box(chip).with_time_step(black_box(NonZeroU32::MIN));
    let (a, b, c) = black_box((1, 2, 3));
    let mut out = |neuron| hide(neuron);
    if let Ok(mut gated) = chip.reset(&mut Bus) {
        hide([
            gated.set_neuron(a, &black_box(I::DISABLED)).is_ok(),
            gated.neuron(a).is_ok(),
            gated.set_synapse(a, b, black_box(synapse)).is_ok(),
            gated.synapse(a, b).is_ok(),
            gated.set_neuron_byte(a, b, c).is_ok(),
            gated.neuron_byte(a, b).is_ok(),
        ]);
        if let Ok(network) = NetworkBytes::<I>::new(black_box(&[0; 64])) {
            hide(gated.load(&network, |progress| hide(progress.done)).is_ok());
            hide(gated.verify(&network, |progress| hide(progress.done)).is_ok());
            let mut copy = [0; 64];
            hide(NetworkBytes::<I>::write(&network, &mut copy).is_ok());
            let mut spikes = Spikes::<4>::new();
            network.answers(5, |event| spikes.push(event))(a);
            hide((network.input(3).is_some(), spikes.as_slice().len()));
            hide(gated.run(&network.registers()).is_ok());
        }
    }
    if let Ok(gated) = chip.gated() {
        hide(gated.run(registers).is_ok());
    }
    if let Ok(mut running) = chip.running() {
        hide([
            running.send(black_box(I::LEAK_ALL), &mut out).is_ok(),
            running.feed(&EVENTS, |_| black_box(I::LEAK_ALL), &mut out).is_ok(),
            running.advance(black_box(5), &mut out).is_ok(),
            running.poll(&mut out).is_ok(),
            running.open_loop().and_then(|running| running.gate(&mut out)).is_ok(),
        ]);
    }
    hide(chip.counters().resets);
    let virtual_events = (
        TinyOdinInput::Virtual { neuron: a, weight: black_box(1) }.word::<(), ()>(),
        OdinInput::Virtual { neuron: a, weight: b, is_inhibitory: true }.word::<(), ()>(),
    );
    hide(virtual_events);
}

fn memory() {
    let mut chip = black_box(Akd1500::new(Bus));
    let words = black_box([1; 70]);
    let some = words.get(..black_box(70)).unwrap_or_default();
    hide(chip.program(black_box(0x20), some).is_ok());
    let event = black_box(ConvolutionEvent { x: 1, y: 2, feature: 3, activation: 4 });
    hide((event.words::<()>(), ConvolutionEvent::from_words(black_box([1, 2]))));
    let event = black_box(DenseEvent { feature: 3, activation: 4 });
    hide((event.words::<()>(), DenseEvent::from_words(black_box([1, 2]))));
}

fn counts() {
    let mut bins = black_box(Bins::<16>::new(0, NonZeroU32::MAX)).with_limit(black_box(15));
    let mut xylo = black_box(Xylo::new(Bus, XyloMap::a2(1), 3));
    while let Some(event) = (&EVENTS).next_event() {
        if bins.add(event).is_err() {
            hide((
                xylo.set_input(black_box(InputBank::First), bins.take()).is_ok(),
                xylo.step().is_ok(),
            ));
        }
    }
    hide((bins.is_over(black_box(3)), bins.late(), bins.outside(), bins.saturated()));
}

fn readouts() {
    static CENTRES: Centres<f32, 5> = Centres::<f32, _>::linear(0.0, 1.0);
    static FIELDS: ReceptiveFields<f32, 5, 10> =
        ReceptiveFields::<f32, _, _>::checked(0.0, 1.0, 1.5);
    let events = black_box([event(); 5]);
    let events = events.get(..black_box(5)).unwrap_or_default();
    hide(Readout::<_, 2>::new(StepForward::<f32>::checked(1.0)).decode(black_box(1), events));
    hide(Readout::<_, 2>::new(Position::new(&CENTRES)).decode(black_box(1), events));
    let slots = Readout::<_, 2>::new(Slots::new(&FIELDS));
    hide(slots.with_slot_ticks(black_box(10)).decode(black_box(1), events));
}

/// Every bus and pin there is.
struct Bus;

impl spi::ErrorType for Bus {
    type Error = ErrorKind;
}

impl SpiDevice for Bus {
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), ErrorKind> {
        hide(operations);
        black_box(Err(ErrorKind::Other))
    }
}

impl digital::ErrorType for Bus {
    type Error = Infallible;
}

impl InputPin for Bus {
    fn is_high(&mut self) -> Result<bool, Infallible> {
        Ok(black_box(true))
    }

    fn is_low(&mut self) -> Result<bool, Infallible> {
        Ok(black_box(false))
    }
}

impl DelayNs for Bus {
    fn delay_ns(&mut self, ns: u32) {
        hide(ns);
    }
}

impl embedded_io::ErrorType for Bus {
    type Error = embedded_io::ErrorKind;
}

impl embedded_io::Write for Bus {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, embedded_io::ErrorKind> {
        hide(bytes);
        black_box(Ok(1))
    }

    fn flush(&mut self) -> Result<(), embedded_io::ErrorKind> {
        black_box(Ok(()))
    }
}

impl embedded_io::WriteReady for Bus {
    fn write_ready(&mut self) -> Result<bool, embedded_io::ErrorKind> {
        Ok(black_box(true))
    }
}

impl AerPort for Bus {
    type Error = ErrorKind;

    fn set_input(&mut self, word: u32) -> Result<(), ErrorKind> {
        hide(word);
        black_box(Ok(()))
    }

    fn set_input_request(&mut self, is_high: bool) -> Result<(), ErrorKind> {
        hide(is_high);
        black_box(Ok(()))
    }

    fn input_acknowledge(&mut self) -> Result<bool, ErrorKind> {
        black_box(Ok(true))
    }

    fn output_request(&mut self) -> Result<bool, ErrorKind> {
        black_box(Ok(true))
    }

    fn output(&mut self) -> Result<u8, ErrorKind> {
        black_box(Ok(1))
    }

    fn set_output_acknowledge(&mut self, is_high: bool) -> Result<(), ErrorKind> {
        hide(is_high);
        black_box(Ok(()))
    }

    fn set_reset(&mut self, is_high: bool) -> Result<(), ErrorKind> {
        hide(is_high);
        black_box(Ok(()))
    }
}

impl Registers for Bus {
    type Error = ErrorKind;

    fn write(&mut self, address: u16, value: u32) -> Result<(), ErrorKind> {
        hide((address, value));
        black_box(Ok(()))
    }

    fn read(&mut self, address: u16) -> Result<u32, ErrorKind> {
        hide(address);
        black_box(Ok(1))
    }
}
