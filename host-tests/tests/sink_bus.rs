//! The sinks for SPI and serial ports: exact transactions, and nothing lost on any error.

use std::cell::Cell;
use std::collections::VecDeque;
use std::convert::Infallible;
use std::future::Future;
use std::pin::pin;
use std::task::{Context, Poll, Waker};

use crate::bus::Failing;
use embedded_hal::digital::{ErrorType, InputPin};
use embedded_hal::spi::ErrorKind;
use embedded_hal_mock::eh1::digital::{Mock as Pin, State, Transaction as Level};
use embedded_hal_mock::eh1::spi::{Mock, Transaction};
use embedded_io::WriteReady;
use spikewire::link::{Coding, MAX_FRAME, Reader, Session, Transmitter};
use spikewire::out::{AlwaysReady, AsyncSpiSink, SerialSink, SinkError, SpiSink};
use spikewire::{Event, EventQueue, FromEvents, Item, Overflow, Polarity, Put, Source, Tick};
use spikewire_cameras::format::{Edvs, EdvsEncoder, EdvsTime, Formatted};

const FORMAT: Edvs = Edvs::new(EdvsTime::None);

fn events(count: u16) -> Vec<Event> {
    (0..count)
        .map(|address| Event { tick: Tick::from(0), address, polarity: Polarity::Up })
        .collect()
}

fn batch() -> Formatted<EdvsEncoder> {
    Formatted::new(FORMAT.encoder())
}

fn bytes(addresses: std::ops::Range<u8>) -> Vec<u8> {
    addresses.flat_map(|address| [0x80, 0x80 | address]).collect()
}

fn write(bytes: Vec<u8>) -> [Transaction<u8>; 3] {
    [
        Transaction::transaction_start(),
        Transaction::write_vec(bytes),
        Transaction::transaction_end(),
    ]
}

#[test]
fn a_batch_is_one_transaction() {
    let expected = [write(bytes(0..4)), write(bytes(4..8)), write(bytes(8..10))].concat();
    let mut sink = SpiSink::<_, _, 9>::new(Mock::new(&expected), batch());
    let mut source = FromEvents(events(10).into_iter());
    assert_eq!(sink.send(&mut source), Ok(8));
    assert_eq!(source.0.len(), 5, "one event is held, the others are left where they are");
    assert_eq!(sink.send(&mut source), Ok(8));
    assert_eq!(sink.send(&mut source), Ok(4));
    assert_eq!(sink.send(&mut source), Ok(0));
    sink.release().0.done();
}

#[test]
fn an_error_at_every_transaction_keeps_the_events() {
    for index in 0..3 {
        let expected = [write(bytes(0..4)), write(bytes(4..8)), write(bytes(8..10))].concat();
        let device = Failing { device: Mock::new(&expected), left: index };
        let mut sink = SpiSink::<_, _, 8>::new(device, batch());
        let mut source = FromEvents(events(10).into_iter());
        for _ in 0..index {
            assert_eq!(sink.send(&mut source), Ok(8));
        }
        assert_eq!(sink.send(&mut source), Err(SinkError::Bus(ErrorKind::Other)));
        assert!(sink.waiting() > 0);
        while sink.send(&mut source).unwrap() > 0 {}
        sink.release().0.device.done();
    }
}

#[test]
fn a_receiver_that_is_not_ready_gets_nothing() {
    let mut ready = Pin::new(&[Level::get(State::Low), Level::get(State::High)]);
    let spi = Mock::new(&write(bytes(0..3)));
    let mut sink = SpiSink::<_, _, 8, _>::with_ready(spi, batch(), ready.clone());
    let mut source = FromEvents(events(3).into_iter());
    assert_eq!(sink.send(&mut source), Err(SinkError::Busy));
    assert_eq!(sink.send(&mut source), Ok(6));
    assert_eq!(sink.send(&mut source), Ok(0), "nothing to send: the pin is not looked at");
    sink.release().0.done();
    ready.done();
}

/// A pin that cannot be read.
#[derive(Debug)]
struct Broken;

impl ErrorType for Broken {
    type Error = ErrorKind2;
}

#[derive(Debug)]
struct ErrorKind2;

impl embedded_hal::digital::Error for ErrorKind2 {
    fn kind(&self) -> embedded_hal::digital::ErrorKind {
        embedded_hal::digital::ErrorKind::Other
    }
}

impl InputPin for Broken {
    fn is_high(&mut self) -> Result<bool, ErrorKind2> {
        Err(ErrorKind2)
    }
    fn is_low(&mut self) -> Result<bool, ErrorKind2> {
        Err(ErrorKind2)
    }
}

#[test]
fn a_pin_that_cannot_be_read_is_an_error() {
    let mut sink = SpiSink::<_, _, 8, _>::with_ready(Mock::new(&[]), batch(), Broken);
    assert_eq!(sink.send(FromEvents(events(1).into_iter())), Err(SinkError::Pin));
    assert_eq!(sink.waiting(), 2);
    sink.release().0.done();
}

fn now<F: Future>(future: F) -> F::Output {
    match pin!(future).poll(&mut Context::from_waker(Waker::noop())) {
        Poll::Ready(output) => output,
        Poll::Pending => panic!("the mock is always ready"),
    }
}

#[test]
fn the_asynchronous_sink_does_the_same() {
    let expected = [write(bytes(0..4)), write(bytes(4..6))].concat();
    let mut sink = AsyncSpiSink::<_, _, 8>::new(Mock::new(&expected), batch());
    let mut source = FromEvents(events(6).into_iter());
    assert_eq!(now(sink.send(&mut source)), Ok(8));
    assert_eq!(now(sink.send(&mut source)), Ok(4));
    assert_eq!(now(sink.send(&mut source)), Ok(0));
    sink.release().0.done();
}

/// A transmitter may be lent, and a receiver without a pin is always ready.
#[test]
fn a_batch_that_is_lent_is_filled() {
    let mut batch = batch();
    let mut sink = SpiSink::<_, _, 9>::new(Mock::new(&write(bytes(0..3))), &mut batch);
    assert_eq!(sink.send(FromEvents(events(3).into_iter())), Ok(6));
    sink.release().0.done();
    assert_eq!([AlwaysReady.is_high(), AlwaysReady.is_low()], [Ok(true), Ok(false)]);
}

/// Every item goes to both ends of a fork.
#[test]
fn a_fork_puts_into_two_queues() {
    let queues = [(); 2].map(|()| EventQueue::<4>::new(Overflow::Refuse));
    let item = Item::Event(events(1)[0]);
    (&queues[0], &queues[1]).put(item);
    for queue in &queues {
        assert_eq!(queue.consumer().unwrap().take().map(|taken| taken.item), Some(item));
    }
}

#[test]
fn a_queue_goes_out_as_frames() {
    let queue = EventQueue::<64>::new(Overflow::Refuse);
    for event in events(20) {
        queue.push(event).unwrap();
    }
    let mut port = [0; 64];
    let transmitter = Transmitter::new(Coding::for_channels(32, 1_000), Session::counted(0));
    let mut sink = SerialSink::<_, _, MAX_FRAME>::new(&mut port[..], transmitter);
    let mut consumer = queue.consumer().unwrap();
    let sent = sink.send(&mut consumer).unwrap();
    assert_eq!(sink.send(&mut consumer), Ok(0));
    let mut reader = Reader::<MAX_FRAME>::new();
    let received = reader.next_frame(&mut &port[..sent]).unwrap().frame.events().count();
    assert_eq!(received, 20);
}

/// Takes up to this many bytes a call; 0 stands for an error, -1 for a port that is closed.
struct Port {
    calls: VecDeque<i32>,
    taken: Vec<u8>,
}

impl embedded_io::ErrorType for Port {
    type Error = embedded_io::ErrorKind;
}

impl embedded_io::Write for Port {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, embedded_io::ErrorKind> {
        let length = match self.calls.pop_front() {
            Some(0) => return Err(embedded_io::ErrorKind::TimedOut),
            Some(-1) => return Ok(0),
            Some(most) => bytes.len().min(most as usize),
            None => bytes.len(),
        };
        self.taken.extend(&bytes[..length]);
        Ok(length)
    }

    fn flush(&mut self) -> Result<(), embedded_io::ErrorKind> {
        Ok(())
    }
}

#[test]
fn a_serial_port_gets_every_byte_once_whatever_happens() {
    for index in 0..6 {
        for (failure, expected) in
            [(0, SinkError::Bus(embedded_io::ErrorKind::TimedOut)), (-1, SinkError::Closed)]
        {
            let mut calls = VecDeque::from([3, 1, 4, 1, 5]);
            calls.insert(index.min(5), failure);
            let mut sink = SerialSink::<_, _, 8>::new(Port { calls, taken: vec![] }, batch());
            let mut source = FromEvents(events(10).into_iter());
            let mut failures = 0;
            loop {
                match sink.send(&mut source) {
                    Ok(0) => break,
                    Ok(_) => {}
                    Err(error) => {
                        assert_eq!(error, expected);
                        assert!(sink.waiting() > 0);
                        failures += 1;
                    }
                }
            }
            assert_eq!(failures, 1);
            assert_eq!(sink.release().taken, bytes(0..10));
        }
    }
}

/// Keeps what it takes until there are 64 bytes, as a USB port does, or until it is flushed.
struct Packets<'a> {
    kept: Vec<u8>,
    arrived: Vec<u8>,
    is_read: &'a Cell<bool>,
}

impl<'a> Packets<'a> {
    fn new(is_read: &'a Cell<bool>) -> Self {
        Self { kept: vec![], arrived: vec![], is_read }
    }
}

impl embedded_io::ErrorType for Packets<'_> {
    type Error = Infallible;
}

impl embedded_io::Write for Packets<'_> {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        assert!(self.write_ready()?, "waits for ever");
        if self.kept.len() == 64 {
            self.arrived.append(&mut self.kept);
        }
        let length = bytes.len().min(64 - self.kept.len());
        self.kept.extend(&bytes[..length]);
        Ok(length)
    }

    fn flush(&mut self) -> Result<(), Infallible> {
        self.arrived.append(&mut self.kept);
        Ok(())
    }
}

impl WriteReady for Packets<'_> {
    fn write_ready(&mut self) -> Result<bool, Infallible> {
        Ok(self.kept.len() < 64 || self.is_read.get())
    }
}

#[test]
fn what_a_port_keeps_arrives_by_flushing() {
    let is_read = Cell::new(true);
    let mut sink = SerialSink::<_, _, 64>::new(Packets::new(&is_read), batch());
    assert_eq!(sink.send(FromEvents(events(9).into_iter())), Ok(18));
    assert_eq!(sink.flush(), Ok(()));
    assert_eq!(sink.release().arrived, bytes(0..9));
}

#[test]
fn flushing_sends_what_waits_in_the_sink_too() {
    let calls = VecDeque::from([3, 0, 1]);
    let mut sink = SerialSink::<_, _, 8>::new(Port { calls, taken: vec![] }, batch());
    assert!(sink.send(FromEvents(events(4).into_iter())).is_err());
    assert_eq!((sink.waiting(), sink.flush()), (5, Ok(())));
    assert_eq!(sink.release().taken, bytes(0..4));
}

#[test]
fn a_port_that_nobody_reads_is_never_waited_for() {
    let is_read = Cell::new(false);
    let mut sink = SerialSink::<_, _, 48>::new(Packets::new(&is_read), batch());
    let mut source = FromEvents(events(48).into_iter());
    assert_eq!(sink.try_send(&mut source), Ok(48));
    assert_eq!(sink.try_send(&mut source), Err(SinkError::Busy));
    assert_eq!(sink.waiting(), 32);
    assert_eq!(sink.try_send(&mut source), Err(SinkError::Busy));
    is_read.set(true);
    assert_eq!(sink.try_send(&mut source), Ok(32));
    let port = sink.release();
    assert_eq!([port.arrived, port.kept].concat(), bytes(0..48));
}

#[test]
fn errors_say_what_is_wrong() {
    let said = SinkError::Bus(ErrorKind::Overrun).to_string();
    assert_eq!(said, "the bus failed: Overrun");
    assert_eq!(SinkError::<Infallible>::Busy.to_string(), "the receiver is not ready");
}
