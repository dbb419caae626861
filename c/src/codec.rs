//! What every codec does, once for all of them; `define.rs` exports it under each codec's names.

use core::any::TypeId;
use core::mem::MaybeUninit;

use spikewire::{
    Code, ConfigError, Event, Firing, Item, Keyframe, Output, Put, Spike, Start, Tick,
};

use crate::event::CFiring;
use crate::kept::Kept;
use crate::queue::{Queue, producer};
use crate::{Error, Stamp, Status, pointer};

/// A scheme that C can have: its encoder starts by itself, and its outputs can be made of codes.
pub trait Exported: Start<Code: 'static, Output: 'static + From<Self::Code>> {}

impl<P: Start<Code: 'static, Output: 'static + From<P::Code>>> Exported for P {}

/// A spike's byte where a rate code waits for later samples.
pub const WAITING: i8 = 2;

/// What a rate code returns is a spike's byte, or [`WAITING`]: checked here, as the language does not promise it.
const WAITS: () = {
    const fn byte(output: Option<Spike>) -> i8 {
        // SAFETY: it is a byte, and has no padding, or this does not compile.
        unsafe { core::mem::transmute::<Option<Spike>, i8>(output) }
    }
    assert!(byte(None) == WAITING);
    assert!(byte(Some(Spike::Up)) == 1 && byte(Some(Spike::Down)) == -1);
    assert!(byte(Some(Spike::None)) == 0);
};

/// Outputs whose bytes are those of codes: codes themselves, and spikes for which a rate code waits.
fn is_output<P: Exported>() -> bool {
    let () = WAITS;
    let output = TypeId::of::<P::Output>();
    output == TypeId::of::<P::Code>() || output == TypeId::of::<Option<Spike>>()
}

/// A scheme's parameters in the caller's storage, or in flash.
#[repr(C)]
pub struct Codec<P> {
    /// Which codec it is, if it is one.
    made: u32,
    scheme: P,
}

impl<P> Codec<P> {
    /// A codec of this mark.
    pub const fn new(made: u32, scheme: P) -> Self {
        Self { made, scheme }
    }
}

/// The mark of a codec: FNV-1a of its name, and not 0.
pub const fn mark(name: &str) -> u32 {
    let (mut mark, mut rest) = (0x811c_9dc5_u32, name.as_bytes());
    while let [byte, after @ ..] = rest {
        mark = (mark ^ *byte as u32).wrapping_mul(0x0100_0193);
        rest = after;
    }
    mark | 1
}

/// A codec and what its encoder or its decoder keeps. All 0, as a static is, it is not started.
#[repr(C)]
pub struct Running<P, T> {
    codec: *const Codec<P>,
    state: MaybeUninit<T>,
}

/// The storage of an encoder.
pub type Encoder<P> = Running<P, <P as spikewire::Scheme>::EncoderState>;
/// The storage of a decoder.
pub type Decoder<P> = Running<P, <P as spikewire::Scheme>::DecoderState>;

impl<P, T> Running<P, T> {
    /// # Safety
    /// C's promise of [`pointer`].
    unsafe fn start(
        storage: *mut Self,
        codec: *const Codec<P>,
        mark: u32,
        state: impl FnOnce(&P) -> T,
    ) -> Result<Status, Status> {
        // SAFETY: C's promise; a codec is numbers, and its mark tells whether it is one.
        let scheme = unsafe { pointer::shared(codec) }?;
        if scheme.made != mark {
            return Err(Status::NOT_MADE);
        }
        // SAFETY: C's promise.
        let storage = unsafe { pointer::place(storage) }?;
        storage.write(Self { codec, state: MaybeUninit::new(state(&scheme.scheme)) });
        Ok(Status::OK)
    }

    /// # Safety
    /// C's promise of [`pointer`].
    #[inline]
    unsafe fn parts<'a>(storage: *mut Self) -> Result<(&'a P, &'a mut T), Status> {
        // SAFETY: C's promise; any bytes are a pointer and a `MaybeUninit`.
        let storage = unsafe { pointer::exclusive(storage) }?;
        if storage.codec.is_null() {
            return Err(Status::NOT_STARTED);
        }
        // SAFETY: the pointer was checked at the start, when the state was written; C promises that the codec is
        // still there, and changes neither.
        unsafe { Ok((&(*storage.codec).scheme, storage.state.assume_init_mut())) }
    }
}

fn is_spike<C: 'static>() -> bool {
    TypeId::of::<C>() == TypeId::of::<Spike>()
}

/// The code of no spike.
fn silence<C: Code>() -> C {
    C::assemble(core::iter::empty())
}

/// Makes a codec of parameters.
///
/// # Safety
/// C's promise of [`pointer`].
pub unsafe fn init<P>(
    codec: *mut Codec<P>,
    mark: u32,
    error: *mut Error,
    made: Result<Result<P, ConfigError>, Status>,
) -> Status {
    let told = match made {
        Ok(Ok(scheme)) => {
            // SAFETY: C's promise.
            match unsafe { pointer::place(codec) } {
                Ok(place) => {
                    place.write(Codec { made: mark, scheme });
                    Error::of(Status::OK)
                }
                Err(status) => Error::of(status),
            }
        }
        Ok(Err(error)) => error.into(),
        Err(status) => Error::of(status),
    };
    if !error.is_null() {
        // SAFETY: C's promise.
        match unsafe { pointer::place(error) } {
            Ok(place) => _ = place.write(told),
            Err(status) => return status,
        }
    }
    told.status
}

/// Starts an encoder.
///
/// # Safety
/// C's promise of [`pointer`].
pub unsafe fn encoder_start<P: Exported>(
    encoder: *mut Encoder<P>,
    codec: *const Codec<P>,
    mark: u32,
) -> Status {
    // SAFETY: C's promise.
    unsafe { Running::start(encoder, codec, mark, |_| P::START) }.into()
}

/// Starts a decoder.
///
/// # Safety
/// C's promise of [`pointer`].
pub unsafe fn decoder_start<P: Exported>(
    decoder: *mut Decoder<P>,
    codec: *const Codec<P>,
    mark: u32,
) -> Status {
    // SAFETY: C's promise.
    unsafe { Running::start(decoder, codec, mark, P::decoder_state) }.into()
}

/// Encodes one sample.
///
/// # Safety
/// C's promise of [`pointer`].
#[inline]
pub unsafe fn encode<P: Exported>(
    encoder: *mut Encoder<P>,
    sample: P::Sample,
    code: *mut P::Code,
) -> Status {
    let encode = || {
        // SAFETY: C's promise.
        let (scheme, state) = unsafe { Running::parts(encoder) }?;
        // SAFETY: C's promise.
        let place = unsafe { pointer::place(code) }?;
        place.write(scheme.encode(state, sample).code().ok_or(Status::WAITING)?);
        Ok(Status::OK)
    };
    encode().into()
}

/// Encodes samples in order.
///
/// # Safety
/// C's promise of [`pointer`].
#[inline]
pub unsafe fn encode_slice<P: Exported>(
    encoder: *mut Encoder<P>,
    samples: *const P::Sample,
    codes: *mut P::Code,
    count: usize,
) -> Status {
    let encode = || {
        // SAFETY: C's promise.
        let (scheme, state) = unsafe { Running::parts(encoder) }?;
        // SAFETY: C's promise; any bytes are samples.
        let samples = unsafe { pointer::slice(samples, count) }?;
        pointer::apart(samples.as_ptr(), count, codes, count)?;
        pointer::apart(encoder, 1, codes, count)?;
        if !is_output::<P>() {
            return Err(Status::BAD_CHOICE); // no scheme has such outputs
        }
        // SAFETY: C's promise; any bytes are a `MaybeUninit`.
        let codes = unsafe { pointer::slice_mut(codes.cast::<MaybeUninit<P::Code>>(), count) }?;
        if is_spike::<P::Code>() {
            // SAFETY: a spike is a byte, and so is what a rate code returns; 0 is one of either.
            unsafe { codes.as_mut_ptr().write_bytes(0, codes.len()) };
        } else {
            const { assert!(size_of::<P::Output>() == size_of::<P::Code>()) };
            for code in codes.iter_mut() {
                code.write(silence());
            }
        }
        // SAFETY: all are written, and outputs are codes, or spikes for which `WAITS` tells that they have their bytes.
        let outputs =
            unsafe { core::slice::from_raw_parts_mut(codes.as_mut_ptr().cast(), codes.len()) };
        scheme.encode_slice(state, samples, outputs);
        Ok(Status::OK)
    };
    encode().into()
}

/// Writes a code, or in the place of a spike that the encoder waits.
#[inline]
fn write_output<P: Exported>(place: &mut MaybeUninit<P::Code>, output: P::Output) {
    const {
        // A code that has no byte for waiting comes at once.
        assert!(P::LATENCY == 0 || size_of::<P::Code>() == 1);
    }
    match output.code() {
        Some(code) => _ = place.write(code),
        // SAFETY: it is a byte, as asserted above, in storage that C reads as bytes.
        None if size_of::<P::Code>() == 1 => unsafe {
            place.as_mut_ptr().cast::<i8>().write(WAITING);
        },
        None => _ = place.write(silence()),
    }
}

/// Reads what [`write_output`] wrote.
#[inline]
fn read_output<P: Exported>(place: &MaybeUninit<P::Code>) -> Option<P::Code> {
    // SAFETY: the byte of a spike was written.
    if is_spike::<P::Code>() && unsafe { place.as_ptr().cast::<i8>().read() } == WAITING {
        return None;
    }
    // SAFETY: it was written, and does not say that the encoder waits.
    Some(unsafe { place.assume_init_read() })
}

/// At the end of a recording, the next code that still waits.
///
/// # Safety
/// C's promise of [`pointer`].
pub unsafe fn finish<P: Exported>(encoder: *mut Encoder<P>, code: *mut P::Code) -> Status {
    let finish = || {
        // SAFETY: C's promise.
        let (scheme, state) = unsafe { Running::parts(encoder) }?;
        // SAFETY: C's promise.
        let place = unsafe { pointer::place(code) }?;
        place.write(scheme.finish_next(state).ok_or(Status::NOTHING)?);
        Ok(Status::OK)
    };
    finish().into()
}

/// Starts from the samples before the first.
///
/// # Safety
/// C's promise of [`pointer`].
pub unsafe fn prime<P: Exported>(
    encoder: *mut Encoder<P>,
    past: *const P::Sample,
    count: usize,
) -> Status {
    let prime = || {
        // SAFETY: C's promise.
        let (scheme, state) = unsafe { Running::parts(encoder) }?;
        // SAFETY: C's promise; any bytes are samples.
        scheme.prime(state, unsafe { pointer::slice(past, count) }?);
        Ok(Status::OK)
    };
    prime().into()
}

/// The value that a decoder should hold now.
///
/// # Safety
/// C's promise of [`pointer`].
pub unsafe fn keyframe<P: Exported>(encoder: *const Encoder<P>, value: *mut P::Sample) -> Status {
    let keyframe = || {
        // SAFETY: C's promise; the state is only read.
        let (scheme, state) = unsafe { Running::parts(encoder.cast_mut()) }?;
        // SAFETY: C's promise.
        let place = unsafe { pointer::place(value) }?;
        place.write(scheme.keyframe(state).ok_or(Status::NOTHING)?);
        Ok(Status::OK)
    };
    keyframe().into()
}

/// How many samples were not finite.
///
/// # Safety
/// C's promise of [`pointer`].
pub unsafe fn rejected<P: Exported>(encoder: *const Encoder<P>, count: *mut u32) -> Status {
    let rejected = || {
        // SAFETY: C's promise; the state is only read.
        let (_, state) = unsafe { Running::parts(encoder.cast_mut()) }?;
        // SAFETY: C's promise.
        unsafe { pointer::place(count) }?.write(P::rejected(state));
        Ok(Status::OK)
    };
    rejected().into()
}

/// Whether bytes from C are codes; of codes other than spikes, C promises it.
#[inline]
fn check_codes<C: 'static>(codes: &[MaybeUninit<C>]) -> Result<(), Status> {
    if !is_spike::<C>() {
        return Ok(());
    }
    // SAFETY: spikes are bytes, and C promises that they are written.
    let bytes = unsafe { core::slice::from_raw_parts(codes.as_ptr().cast::<u8>(), codes.len()) };
    // Four at a time: a byte is its lowest bit, or all ones if its highest is.
    let other = |word: u32| {
        let negative = (word >> 7) & 0x0101_0101;
        word ^ ((negative << 8).wrapping_sub(negative) | (word & 0x0101_0101))
    };
    let (words, rest) = bytes.as_chunks();
    let words = words.iter().fold(0, |found, word| found | other(u32::from_ne_bytes(*word)));
    let is_other = rest.iter().fold(words, |found, &byte| found | other(byte.into()) & 0xff) != 0;
    if is_other { Err(Status::BAD_CODE) } else { Ok(()) }
}

/// The codes that C hands over.
///
/// # Safety
/// C's promise of [`pointer`], and that codes other than spikes come from this library.
#[inline]
unsafe fn codes<'a, C: 'static>(codes: *const C, count: usize) -> Result<&'a [C], Status> {
    // SAFETY: C's promise; any bytes are a `MaybeUninit`.
    let bytes = unsafe { pointer::slice(codes.cast::<MaybeUninit<C>>(), count) }?;
    check_codes(bytes)?;
    // SAFETY: spikes are checked; other codes come from this library, as C promises.
    Ok(unsafe { core::slice::from_raw_parts(bytes.as_ptr().cast(), bytes.len()) })
}

/// One of them.
///
/// # Safety
/// As of [`codes`].
#[inline]
unsafe fn one<C: Code + 'static>(code: *const C) -> Result<C, Status> {
    // SAFETY: the caller's promise.
    unsafe { codes(code, 1) }?.first().copied().ok_or(Status::NULL)
}

/// Decodes the code of one sample.
///
/// # Safety
/// C's promise of [`pointer`].
#[inline]
pub unsafe fn decode<P: Exported>(
    decoder: *mut Decoder<P>,
    code: *const P::Code,
    value: *mut P::Sample,
) -> Status {
    let decode = || {
        // SAFETY: C's promise.
        let (scheme, state) = unsafe { Running::parts(decoder) }?;
        // SAFETY: C's promise.
        let (code, place) = unsafe { (one(code)?, pointer::place(value)?) };
        place.write(scheme.decode(state, code));
        Ok(Status::OK)
    };
    decode().into()
}

/// Decodes codes in order.
///
/// # Safety
/// C's promise of [`pointer`].
#[inline]
pub unsafe fn decode_slice<P: Exported>(
    decoder: *mut Decoder<P>,
    from: *const P::Code,
    values: *mut P::Sample,
    count: usize,
) -> Status {
    let decode = || {
        // SAFETY: C's promise.
        let (scheme, state) = unsafe { Running::parts(decoder) }?;
        // SAFETY: C's promise.
        let from = unsafe { codes(from, count) }?;
        pointer::apart(from.as_ptr(), count, values, count)?;
        pointer::apart(decoder, 1, values, count)?;
        // SAFETY: C's promise; any bytes are samples.
        scheme.decode_slice(state, from, unsafe { pointer::slice_mut(values, count) }?);
        Ok(Status::OK)
    };
    decode().into()
}

/// The value that a decoder holds until the next spike.
///
/// # Safety
/// C's promise of [`pointer`].
pub unsafe fn held<P: Exported>(decoder: *const Decoder<P>, value: *mut P::Sample) -> Status {
    let held = || {
        // SAFETY: C's promise; the state is only read.
        let (scheme, state) = unsafe { Running::parts(decoder.cast_mut()) }?;
        // SAFETY: C's promise.
        let place = unsafe { pointer::place(value) }?;
        place.write(scheme.held(state).ok_or(Status::NOTHING)?);
        Ok(Status::OK)
    };
    held().into()
}

/// Sets a decoder to a known value.
///
/// # Safety
/// C's promise of [`pointer`].
pub unsafe fn resync<P: Exported>(decoder: *mut Decoder<P>, value: P::Sample) -> Status {
    // SAFETY: C's promise.
    let parts = unsafe { Running::parts(decoder) };
    parts
        .map(|(scheme, state)| scheme.resync(state, value))
        .map_or_else(|status| status, |()| Status::OK)
}

/// The neurons that fire.
///
/// # Safety
/// C's promise of [`pointer`].
pub unsafe fn firings<C: Code + 'static>(
    code: *const C,
    into: *mut CFiring,
    capacity: usize,
    count: *mut usize,
) -> Status {
    let write = || {
        // SAFETY: C's promise; any bytes are a `MaybeUninit`.
        let (code, into, count) = unsafe {
            let into = pointer::slice_mut(into.cast::<MaybeUninit<CFiring>>(), capacity)?;
            (one(code)?, into, pointer::place(count)?)
        };
        let all = count.write(0);
        let mut into = into.iter_mut();
        for firing in code.firings() {
            into.next().ok_or(Status::TOO_SMALL)?.write(firing.into());
            *all = all.wrapping_add(1);
        }
        Ok(Status::OK)
    };
    write().into()
}

/// The code that neurons make up.
///
/// # Safety
/// C's promise of [`pointer`].
pub unsafe fn assemble<C: Code + 'static>(
    firings: *const CFiring,
    count: usize,
    code: *mut C,
) -> Status {
    let assemble = || {
        // SAFETY: C's promise; any bytes are firings.
        let (firings, place) = unsafe { (pointer::slice(firings, count)?, pointer::place(code)?) };
        place.write(C::assemble(firings.iter().map(|&firing| Firing::from(firing))));
        Ok(Status::OK)
    };
    assemble().into()
}

/// Encodes one sample of each channel, and puts their events into a queue in the order of time.
///
/// # Safety
/// C's promise of [`pointer`].
#[inline]
pub unsafe fn bank<P: Exported>(
    encoders: *mut Encoder<P>,
    samples: *const P::Sample,
    codes: *mut P::Code,
    channels: usize,
    stamp: *const Stamp,
    queue: *mut Kept<Queue>,
) -> Status {
    let encode = || {
        pointer::apart(samples, channels, codes, channels)?;
        pointer::apart(encoders, channels, codes, channels)?;
        // SAFETY: C's promise; any bytes are samples, a `MaybeUninit`, and an encoder that is started or not.
        let (encoders, samples, codes) = unsafe {
            (
                pointer::slice_mut(encoders, channels)?,
                pointer::slice(samples, channels)?,
                pointer::slice_mut(codes.cast::<MaybeUninit<P::Code>>(), channels)?,
            )
        };
        // SAFETY: C's promise; any bytes are a stamp.
        let (stamp, queue) = unsafe { (pointer::shared(stamp)?, producer(queue)?) };
        if encoders.iter().any(|encoder| encoder.codec.is_null()) {
            return Err(Status::NOT_STARTED);
        }
        for ((encoder, sample), code) in encoders.iter_mut().zip(samples).zip(codes.iter_mut()) {
            // SAFETY: it is started.
            let (scheme, state) = unsafe { Running::parts(encoder) }?;
            write_output::<P>(code, scheme.encode(state, *sample));
        }
        put::<P>(codes, stamp, queue);
        Ok(Status::OK)
    };
    encode().into()
}

/// Puts the events of codes, slot by slot if slots have a length.
fn put<P: Exported>(codes: &[MaybeUninit<P::Code>], stamp: &Stamp, mut queue: impl Put) {
    let slots = if stamp.slot_ticks > 0 { P::Code::SLOTS } else { 1 };
    let mut tick = Tick::from(stamp.tick);
    for slot in 0..slots {
        let mut first = stamp.first_address;
        for code in codes {
            let firings = read_output::<P>(code);
            for Firing { neuron, slot: own, polarity } in firings.iter().flat_map(Code::firings) {
                if slots == 1 || usize::from(own) == slot {
                    let address = first.wrapping_add(neuron);
                    queue.put(Item::Event(Event { tick, address, polarity }));
                }
            }
            first = first.wrapping_add(P::Code::NEURONS as u16);
        }
        tick += stamp.slot_ticks;
    }
}

/// Puts a keyframe of each channel that has one into a queue.
///
/// # Safety
/// C's promise of [`pointer`].
pub unsafe fn keyframes<P: Exported>(
    encoders: *mut Encoder<P>,
    channels: usize,
    stamp: *const Stamp,
    queue: *mut Kept<Queue>,
) -> Status {
    let keyframes = || {
        // SAFETY: C's promise; any bytes are a stamp, and an encoder that is started or not.
        let (encoders, stamp, queue) = unsafe {
            (pointer::slice_mut(encoders, channels)?, pointer::shared(stamp)?, producer(queue)?)
        };
        let mut address = stamp.first_address;
        for encoder in encoders {
            // SAFETY: it is a reference; whether it is started is checked.
            let (scheme, state) = unsafe { Running::parts(encoder) }?;
            if let Some(value) = scheme.keyframe(state) {
                queue.put(Item::Keyframe(Keyframe::new(Tick::from(stamp.tick), address, value)));
            }
            address = address.wrapping_add(P::Code::NEURONS as u16);
        }
        Ok(Status::OK)
    };
    keyframes().into()
}
