//! The way to a chip and back: queue, link, sinks, chips and formats, on buses that do nothing.

use core::{
    convert::Infallible,
    hint::black_box,
    num::NonZeroU32,
    pin::{Pin, pin},
    task::{Context, Poll, Waker},
};

use embedded_hal::{
    delay::DelayNs,
    digital::{self, InputPin},
    spi::{self, ErrorKind, Operation, SpiDevice},
};
use spikewire::{
    Bank, Bins, Consumer, EventQueue, FromEvents, FromItems, Item, Keyframe, Overflow, Put,
    Readout, Sample, SampleKind, Source, SpscQueue, Tick,
    link::{Coding, FrameView, Framer, MAX_FRAME, Reader, Receiver, Session, Transmitter, join},
    out::{AsyncSpiSink, Batch, SerialSink, SpiSink},
    temporal::StepForward,
};
use spikewire_cameras::format::{
    Edvs, EdvsTime, EventDecoder, EventFormat, EventStream, Evt2, Formatted, eieio,
};
use spikewire_chips::{
    AerPort, Akd1500, ConvolutionEvent, DenseEvent, Describe, Input, InputBank, NetworkBytes, Odin,
    OdinChip, OdinInput, OdinRegisters, OdinSynapse, Registers, Running, Spikes, Steps, StepsLayer,
    StepsState, TinyOdin, TinyOdinInput, Xylo, XyloMap,
};

use crate::exercise::{EVENTS, event, hide, tick};
use crate::reckon;

pub fn link() {
    time();
    hide(queue().is_none());
    hide(lock_free().is_none());
    hide(framed(const { &StepForward::<f32>::new(1.0) }).is_none());
    hide(framed(const { &StepForward::<i16>::new(1) }).is_none());
    hide(formats().is_none());
    hide(sinks().is_none());
    let registers = TinyOdinInput::registers(black_box(3), true, [0; 16]);
    family(TinyOdin::new(Bus, Bus, black_box(3)), &registers, 1);
    let synapse = OdinSynapse { weight: black_box(1), is_mapped: true };
    family(Odin::new(Bus, Bus, black_box(3)), &OdinRegisters::PLAIN, synapse);
    reckon::reckon();
    memory();
    counts();
}

fn time() {
    let (a, b) = (tick(), tick());
    hide((a.since(b), a.is_before(b), a.widen(black_box(3)), a.shifted(black_box(-1))));
    hide((a + black_box(7), a.micros(), Tick::from(black_box(7))));
    hide(SampleKind::from_byte(black_box(7)).map(|kind| (kind.to_byte(), kind.size())));
}

fn items() -> [Item; 4] {
    let keyframe = Keyframe::new(tick(), black_box(1), black_box(0.5_f32));
    hide((keyframe.value::<f32>(), keyframe.value::<i16>()));
    let heartbeat = Item::Heartbeat { tick: tick(), address: black_box(1) };
    black_box([event().into(), keyframe.into(), heartbeat, Item::Break(tick())])
}

/// Takes all that a source has.
fn drain(mut source: impl Source) {
    while let Some(taken) = source.take() {
        hide((taken.is_after_break(), taken.item.tick(), taken));
    }
    hide(source.take_event());
}

fn queue() -> Option<()> {
    let own = black_box(EventQueue::<3>::new(black_box(Overflow::Refuse)));
    for item in items() {
        (&own).put(item);
        hide((own.push(item).is_err(), EVENTS.push(item).is_err()));
    }
    let mut consumer = own.consumer()?;
    drain(consumer.waiting());
    drain(&mut consumer);
    let queue = consumer.queue();
    hide((queue.len(), queue.is_empty(), queue.capacity(), queue.peak()));
    hide((queue.lost(), queue.refused(), queue.consumer().is_some()));
    hide(poll(pin!(consumer.wait())));
    drop(consumer);
    drain(FromItems(items().into_iter()).at_most(black_box(2)));
    drain(FromEvents([event(); 2].into_iter()));
    Some(())
}

/// Polls a future once.
fn poll<F: Future>(future: Pin<&mut F>) -> Poll<F::Output> {
    future.poll(&mut Context::from_waker(Waker::noop()))
}

fn lock_free() -> Option<()> {
    let queue = black_box(SpscQueue::<4>::new());
    let (mut producer, mut consumer) = queue.split()?;
    for item in items() {
        producer.push(item);
        producer.put(item);
    }
    hide((producer.lost(), consumer.len(), consumer.is_empty(), consumer.lost()));
    drain(&mut consumer);
    Some(())
}

fn framed<S: Sample>(scheme: &'static StepForward<S>) -> Option<()> {
    let coding = black_box(Coding::for_channels(black_box(3), black_box(1_000)));
    let mut bank = black_box(Bank::per_channel([scheme; 3]));
    bank.encode_into(tick(), black_box([S::default(); 3]), &EVENTS);
    bank.keyframe_into(tick(), &EVENTS);
    bank.reset_into(tick(), &EVENTS);

    let mut events = EVENTS.consumer()?;
    let session = Session::counted(black_box(1));
    let described = Transmitter::try_for_bank(&bank, black_box(1_000), session).ok()?;
    let mut other = black_box(Bank::<_, 2>::new(scheme));
    let joined =
        Transmitter::for_banks(&mut [&mut bank, &mut other], black_box(1_000), session).ok()?;
    hide(joined.foreign());
    let mut transmitter = black_box(described.with_label(black_box("roll")));
    transmitter.observe(tick());
    hide(transmitter.leaps());
    let mut reader = black_box(Reader::<MAX_FRAME>::new());
    let receiver = black_box(Receiver::<_, 3, 0>::per_channel([scheme; 3]));
    let mut tolerant = receiver.with_clock_tolerance(black_box(9)).with_label(black_box("roll"));
    hide(join(&mut [&mut tolerant]).is_ok());
    hide(tolerant.fingerprint());
    let mut receiver = black_box(tolerant);
    let mut buffer = black_box([0; 300]);
    while let Ok(Some(bytes)) =
        transmitter.next_frame(&mut events, buffer.get_mut(..black_box(300)).unwrap_or_default())
    {
        let mut input = black_box(bytes);
        while let Some(received) = reader.next_frame(&mut input) {
            hide((received.is_after_break(), received.gap));
            receiver.apply(&received, |channel, tick, value| hide((channel, tick, value)));
        }
    }
    hide(reader.next_after_silence().map(|received| received.is_start));
    hide((reader.frames(), reader.lost_frames(), reader.bad_checksums(), reader.skipped()));
    hide((reader.repeated(), reader.late(), receiver.exact(black_box(1))));
    hide((receiver.withheld(black_box(1)), receiver.compared(), receiver.contradicted()));
    hide(black_box(Readout::<_, 3>::per_channel([scheme; 3])).decode(tick(), &[event()]));

    let mut framer = black_box(Framer::new(coding, Session::counted(black_box(1))));
    framer.mark_loss();
    let mut frame = framer.start(tick(), &mut buffer).ok()?;
    let keyframe = Keyframe::new(tick(), black_box(0), S::default());
    hide((frame.keyframe(keyframe), frame.event(event()), frame.is_empty(), frame.events()));
    let bytes = black_box(frame.finish());
    hide(FrameView::length(bytes));
    let (view, length) = FrameView::new(bytes).ok()?;
    hide((view.number(), view.micros(), view.is_first(), view.tick(), view.period()));
    hide(view.is_after_loss());
    view.heartbeats().for_each(hide);
    let mut events = view.events();
    events.by_ref().for_each(hide);
    view.keyframes().for_each(hide);
    hide((events.is_complete(), length));
    Some(())
}

fn formats() -> Option<()> {
    let mut events = EVENTS.consumer()?;
    for time in
        [EdvsTime::None, EdvsTime::Delta, EdvsTime::Bits16, EdvsTime::Bits24, EdvsTime::Bits32]
    {
        let camera = black_box(Edvs::new(time).with_up_as_zero());
        let mut decoder = camera.decoder();
        decoder.set_tick(tick());
        format(&mut events, camera.encoder_from(tick()), decoder);
    }
    let log = EventStream::decoder_from(tick());
    hide(log.is_foreign());
    format(&mut events, EventStream::encoder_from(tick()), log);
    format(&mut events, Evt2::encoder(), black_box(Evt2::file_decoder()));
    let mut bytes = black_box([0; 32]);
    let length = eieio::encode(black_box(Some(1)), black_box([1, 2]), &mut bytes).unwrap_or(0);
    let datagram = bytes.get(..length).and_then(eieio::decode);
    hide(datagram.map(|datagram| datagram.keys().for_each(hide)));
    Some(())
}

fn format(events: &mut Consumer<'_>, encoder: impl EventFormat, mut decoder: impl EventDecoder) {
    let mut batch = black_box(Formatted::new(encoder));
    let mut bytes = black_box([0; 32]);
    let length = batch.fill(events, &mut bytes);
    let bytes = bytes.get(..length).unwrap_or_default();
    decoder.decode(black_box(bytes)).for_each(hide);
    hide((decoder.skipped(), decoder.is_partial(), batch.unencodable(), batch.format().retimed()));
}

fn sinks() -> Option<()> {
    let mut events = EVENTS.consumer()?;
    let mut sink =
        black_box(SpiSink::<_, _, 32, _>::with_ready(Bus, Formatted::new(Evt2::encoder()), Bus));
    hide((sink.send(&mut events).is_ok(), sink.waiting(), sink.batch().unencodable()));
    hide(sink.release());
    let mut sink = black_box(AsyncSpiSink::<_, _, 32>::new(Bus, Formatted::new(Evt2::encoder())));
    hide(poll(pin!(sink.send(&mut events))).map(|sent| sent.is_ok()));
    let session = black_box(Session::random(black_box(1)));
    let transmitter = Transmitter::new(black_box(Coding::for_channels(3, 1)), session);
    let mut sink = black_box(SerialSink::<_, _, 64>::new(Bus, transmitter));
    hide((sink.send(&mut events).is_ok(), sink.try_send(&mut events).is_ok()));
    hide((sink.flush().is_ok(), sink.waiting()));
    hide(sink.release());
    Some(())
}

fn family<I: Input>(chip: OdinChip<I, Bus, Bus>, registers: &I::Registers, synapse: I::Synapse) {
    let mut chip = black_box(chip).with_time_step(black_box(NonZeroU32::MIN));
    let (a, b, c) = black_box((1, 2, 3));
    let mut out = |neuron: u8| hide(neuron);
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
            network.answers(tick(), |event| spikes.push(event))(a);
            hide((network.input(3).is_some(), spikes.as_slice().len()));
            if let Ok(running) = gated.run(&network.registers()) {
                hide(is_witness_right(running, &network));
            }
        }
    }
    if let Ok(gated) = chip.gated() {
        hide(gated.run(registers).is_ok());
    }
    if let Ok(mut running) = chip.running() {
        hide([
            running.send(black_box(I::LEAK_ALL), &mut out).is_ok(),
            feed(&mut running),
            step(&mut running),
            running.advance(tick(), &mut out).is_ok(),
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

fn feed<I: Input>(chip: &mut Running<'_, I, Bus, Bus>) -> bool {
    let Some(mut events) = EVENTS.consumer() else { return false };
    chip.feed(events.waiting(), |_| black_box(I::LEAK_ALL), hide).is_ok()
}

fn is_witness_right<I: Input>(chip: Running<'_, I, Bus, Bus>, network: &impl Describe<I>) -> bool {
    let layers = black_box([StepsLayer { neurons: 3, loops: false }]);
    let steps = black_box(Steps {
        inputs: 2,
        has_bias: false,
        rows: &[1],
        layers: &layers,
        rungs: 3,
        leaks: &[],
        lift: 0,
        own_leaks: &[],
    });
    chip.check_witness(&steps, network, hide).is_ok()
}

/// A step in which neurons compare once.
fn step<I: Input>(chip: &mut Running<'_, I, Bus, Bus>) -> bool {
    let layer = black_box(StepsLayer { neurons: 3, loops: true });
    let (layers, leaks) = (black_box([layer; 2]), black_box([&[0, 2][..], &[1]]));
    let own_leaks = black_box([3; 6]);
    let steps = black_box(Steps {
        inputs: 2,
        has_bias: true,
        rows: &[2, 1],
        layers: &layers,
        rungs: 3,
        leaks: &leaks,
        lift: 2,
        own_leaks: &own_leaks,
    });
    hide((steps.first_rise(), steps.all_rows()));
    let mut state = black_box(StepsState::REST);
    chip.step(&steps, &mut state, black_box([1, 9]), hide).is_ok()
}

fn memory() {
    let mut chip = black_box(Akd1500::new(Bus));
    let words = black_box([1; 70]);
    let some = words.get(..black_box(70)).unwrap_or_default();
    hide(chip.program(black_box(0xFC00_0020), some).is_ok());
    let event = black_box(ConvolutionEvent { x: 1, y: 2, feature: 3, activation: 4 });
    hide((event.words::<()>(), ConvolutionEvent::from_words(black_box([1, 2]))));
    let event = black_box(DenseEvent { feature: 3, activation: 4 });
    hide((event.words::<()>(), DenseEvent::from_words(black_box([1, 2]))));
}

fn counts() {
    let Some(mut events) = EVENTS.consumer() else { return };
    let bins = black_box(Bins::<16>::new(tick(), black_box(NonZeroU32::MAX)));
    let mut bins = bins.with_limit(black_box(15));
    let mut xylo = black_box(Xylo::new(Bus, XyloMap::a2(1), 3));
    while let Some(event) = events.take_event() {
        if bins.add(event).is_err() {
            hide((
                xylo.set_input(black_box(InputBank::First), bins.take()).is_ok(),
                xylo.step().is_ok(),
                xylo.clear_input().is_ok(),
            ));
        }
    }
    hide((bins.is_over(tick()), bins.start(), bins.late(), bins.outside(), bins.saturated()));
}

/// Every bus and pin there is.
pub struct Bus;

impl spi::ErrorType for Bus {
    type Error = ErrorKind;
}

impl SpiDevice for Bus {
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), ErrorKind> {
        hide(operations);
        black_box(Err(ErrorKind::Other))
    }
}

impl embedded_hal_async::spi::SpiDevice for Bus {
    async fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), ErrorKind> {
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
