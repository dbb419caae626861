//! Events as the words of chips.

use core::{
    cell::Cell,
    convert::Infallible,
    fmt::{self, Write},
    hint::black_box,
    num::NonZeroU32,
};

use board::chip_bus::ChipBus;
use embedded_hal::delay::DelayNs;
use spikewire::{Bins, Event, FromEvents, Polarity, Tick};
use spikewire_chips::{
    AerPort, ChipError, ConvolutionEvent, DenseEvent, Input, OdinInput, TinyOdin, TinyOdinInput,
    pack_counts,
};

use super::{ensure, flight, meter::Cost};

#[inline(never)] // leaves the stack before the next one comes
pub fn measure(out: &mut impl Write) -> fmt::Result {
    word(
        out,
        "tinyodin-word",
        |event| tiny_odin(event).word::<(), ()>().ok(),
        |&word| Some((word as u16 >> 1, word & 1 == 1)),
    )?;
    word(
        out,
        "odin-word",
        |event| {
            let Event { address, polarity, .. } = event;
            let is_inhibitory = polarity == Polarity::Down;
            let input = OdinInput::Virtual { neuron: address as u8, weight: 7, is_inhibitory };
            input.word::<(), ()>().ok()
        },
        |&word| Some((word as u16 >> 8, word >> 4 & 1 == 0)),
    )?;
    tiny_odin_fed(out)?;
    akida_convolution(out)?;
    akida_dense(out)?;
    xylo(out)
}

fn tiny_odin(event: Event) -> TinyOdinInput {
    TinyOdinInput::Spike { pre: (event.address as u8) << 1 | u8::from(is_up(event)) }
}

fn is_up(event: Event) -> bool {
    event.polarity == Polarity::Up
}

/// Measures the making of a word, which tells address and polarity.
fn word<W: Copy>(
    out: &mut impl Write,
    name: &str,
    mut make: impl FnMut(Event) -> Option<W>,
    tells: impl Fn(&W) -> Option<(u16, bool)>,
) -> fmt::Result {
    let mut cost = Cost::default();
    let mut agrees = true;
    flight::events(|event| {
        let mut made = None;
        let count =
            cost.encoding(&mut |event, _: &mut [u8]| make(event), event, &mut [], &mut made);
        cost.add(1, 0, count);
        agrees &= made.as_ref().and_then(&tells) == Some((event.address, is_up(event)));
    });
    ensure(out, agrees, name)?;
    cost.print_event(out, name, "encode")
}

/// The handshake as well, with a chip that answers at once.
fn tiny_odin_fed(out: &mut impl Write) -> fmt::Result {
    let word = Cell::new(0);
    let port = || Answers { word: &word, is_requested: false };
    let mut chip = TinyOdin::new(ChipBus::default(), port(), 4);
    let registers = TinyOdinInput::registers(255, true, [0; 16]);
    let mut agrees = chip.reset(&mut port()).and_then(|gated| gated.run(&registers)).is_ok();
    let mut feed = |event: Event, _: &mut [u8]| {
        let mut running = chip.running()?;
        running.feed(FromEvents(core::iter::once(event)), tiny_odin, |_| ())
    };
    let mut cost = Cost::default();
    flight::events(|event| {
        let mut sent: Result<u32, ChipError<Infallible, Infallible>> = Ok(0);
        let count = cost.encoding(&mut feed, event, &mut [], &mut sent);
        cost.add(1, 0, count);
        let right = u32::from(event.address) << 1 | u32::from(is_up(event));
        agrees &= sent.is_ok_and(|sent| sent == 1) && word.replace(u32::MAX) == right;
    });
    ensure(out, agrees, "tinyodin")?;
    cost.print_event(out, "tinyodin", "encode")
}

/// A port on which all goes well.
struct Answers<'a> {
    word: &'a Cell<u32>,
    is_requested: bool,
}

impl DelayNs for Answers<'_> {
    fn delay_ns(&mut self, _: u32) {}
}

impl AerPort for Answers<'_> {
    type Error = Infallible;

    fn set_input(&mut self, word: u32) -> Result<(), Infallible> {
        self.word.set(word);
        Ok(())
    }

    fn set_input_request(&mut self, is_high: bool) -> Result<(), Infallible> {
        self.is_requested = is_high;
        Ok(())
    }

    fn input_acknowledge(&mut self) -> Result<bool, Infallible> {
        Ok(self.is_requested)
    }

    fn output_request(&mut self) -> Result<bool, Infallible> {
        Ok(false)
    }

    fn output(&mut self) -> Result<u8, Infallible> {
        Ok(0)
    }

    fn set_output_acknowledge(&mut self, _: bool) -> Result<(), Infallible> {
        Ok(())
    }

    fn set_reset(&mut self, _: bool) -> Result<(), Infallible> {
        Ok(())
    }
}

fn akida_convolution(out: &mut impl Write) -> fmt::Result {
    let mut encode = |event: Event, _: &mut [u8]| {
        let (x, feature) = (event.address, u16::from(is_up(event)));
        ConvolutionEvent { x, y: 0, feature, activation: 1 }.words::<()>().ok()
    };
    akida(out, "akd1500-convolution", &mut encode, |words| {
        let ConvolutionEvent { x, feature, .. } = ConvolutionEvent::from_words(words);
        Some((x, feature == 1))
    })
}

fn akida_dense(out: &mut impl Write) -> fmt::Result {
    let mut encode = |event: Event, _: &mut [u8]| {
        let feature = u32::from(event.address) << 1 | u32::from(is_up(event));
        DenseEvent { feature, activation: 1 }.words::<()>().ok()
    };
    akida(out, "akd1500-dense", &mut encode, |words| {
        let DenseEvent { feature, .. } = DenseEvent::from_words(words)?;
        Some((feature as u16 >> 1, feature & 1 == 1))
    })
}

/// Measures an event's two words, both ways.
fn akida(
    out: &mut impl Write,
    name: &str,
    encode: &mut impl FnMut(Event, &mut [u8]) -> Option<[u32; 2]>,
    tells: impl Fn([u32; 2]) -> Option<(u16, bool)>,
) -> fmt::Result {
    let (mut written, mut read) = (Cost::default(), Cost::default());
    let mut agrees = true;
    flight::events(|event| {
        let mut words = None;
        let writing = written.encoding(encode, event, &mut [], &mut words);
        written.add(1, 8, writing);
        let words = words.unwrap_or_default();
        let mut told = None;
        let reading = read.decoding(&mut |_| tells(black_box(words)), &[], &mut told);
        read.add(1, 8, reading);
        agrees &= told == Some((event.address, is_up(event)));
    });
    ensure(out, agrees, name)?;
    written.print_event(out, name, "encode")?;
    read.print_event(out, name, "decode")
}

/// Counts of 10 ms, packed for two registers.
fn xylo(out: &mut impl Write) -> fmt::Result {
    const STEP: NonZeroU32 = NonZeroU32::new(10_000).unwrap();
    let mut bins = Bins::<16>::new(Tick::from_micros(0), STEP).with_limit(15);
    let mut count = |event: Event, _: &mut [u8]| {
        let address = event.address << 1 | u16::from(is_up(event));
        let (mut steps, mut counts) = (0, None);
        while bins.add(Event { address, ..event }).is_err() {
            counts.get_or_insert(pack_counts(bins.take())); // those of silent steps are 0
            steps += 1;
        }
        (steps, counts)
    };
    let mut cost = Cost::default();
    let (mut events, mut counted) = (0, 0);
    flight::events(|event| {
        let mut given = (0, None);
        let instructions = cost.encoding(&mut count, event, &mut [], &mut given);
        let (steps, counts) = given;
        cost.add(1, 8 * steps, instructions);
        counted += counts.map_or(0, sum);
        events += 1;
    });
    counted += sum(pack_counts(bins.take())) + bins.saturated();
    ensure(out, counted == events, "xylo")?;
    cost.print_event(out, "xylo", "encode")
}

/// Of all counts in these words.
fn sum(words: [u32; 2]) -> u32 {
    let nibbles = |word: u32| (0..8).map(move |at| word >> (4 * at) & 0xF);
    words.into_iter().flat_map(nibbles).sum()
}
