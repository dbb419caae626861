//! What every codec does, once for all of them; `define.rs` exports it under each codec's names.

use core::mem::MaybeUninit;

use spikewire::{
    Code, ConfigError, Destination, Event, Item, Keyframe, NeuronSpike, Output, Put, Sample,
    SampleKind, Scheme, Start, Tick,
};

use crate::code::CCode;
use crate::event::CNeuronSpike;
use crate::kept::Kept;
use crate::queue::{Queue, producer};
use crate::{Error, Stamp, Status, pointer};

/// A scheme that C can have: its encoder starts by itself, and its outputs go where C has room for codes.
pub trait Exported: Start<Code: CCode<Room: Destination<Self::Output>>> {}

impl<P: Start<Code: CCode<Room: Destination<P::Output>>>> Exported for P {}

/// C's room for a code of this scheme.
type Room<P> = <<P as Scheme>::Code as CCode>::Room;

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

/// Makes a codec of parameters, of whose list the number at `not_finite` is the first that is not finite.
///
/// # Safety
/// C's promise of [`pointer`].
pub unsafe fn init<P>(
    codec: *mut Codec<P>,
    mark: u32,
    error: *mut Error,
    made: Result<Result<P, ConfigError>, Status>,
    not_finite: Option<usize>,
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
        Ok(Err(error)) => match (error, not_finite) {
            (ConfigError::NotFinite { .. }, Some(index)) => {
                Error { index: index as u32, ..error.into() }
            }
            _ => error.into(),
        },
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
        // SAFETY: C's promise; any bytes are room.
        let room = unsafe { pointer::exclusive(code.cast::<Room<P>>()) }?;
        let output = scheme.encode(state, sample);
        if output.code().is_none() {
            return Err(Status::WAITING);
        }
        room.write(output);
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
        // SAFETY: C's promise; any bytes are samples, and room for codes.
        let (samples, rooms) =
            unsafe { pointer::from_to(encoder, samples, codes.cast::<Room<P>>(), count) }?;
        encode_apart(scheme, state, samples, rooms);
        Ok(Status::OK)
    };
    encode().into()
}

/// Out of line: the checks' pointers would take registers from the loop.
#[inline(never)]
fn encode_apart<P: Exported>(
    scheme: &P,
    state: &mut P::EncoderState,
    samples: &[P::Sample],
    rooms: &mut [Room<P>],
) {
    scheme.encode_slice(state, samples, rooms);
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

/// A code that C hands over.
///
/// # Safety
/// C's promise of [`pointer`], and that codes other than spikes come from this library.
#[inline]
unsafe fn given<C: CCode>(code: *const C) -> Result<C, Status> {
    // SAFETY: C's promise.
    Ok((*unsafe { pointer::shared(code.cast::<C::Given>()) }?).into())
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
        let (code, place) = unsafe { (given(code)?, pointer::place(value)?) };
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
    codes: *const P::Code,
    values: *mut P::Sample,
    count: usize,
) -> Status {
    let decode = || {
        // SAFETY: C's promise.
        let (scheme, state) = unsafe { Running::parts(decoder) }?;
        let codes = codes.cast::<<P::Code as CCode>::Given>();
        // SAFETY: C's promise; any bytes are samples, and codes other than spikes come from this library.
        let (codes, values) = unsafe { pointer::from_to(decoder, codes, values, count) }?;
        decode_apart(scheme, state, codes, values);
        Ok(Status::OK)
    };
    decode().into()
}

/// Out of line, as [`encode_apart`].
#[inline(never)]
fn decode_apart<P: Exported>(
    scheme: &P,
    state: &mut P::DecoderState,
    codes: &[<P::Code as CCode>::Given],
    values: &mut [P::Sample],
) {
    scheme.decode_slice(state, codes, values);
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
    // All values to come would be as little finite.
    let is_good =
        P::Sample::KIND != SampleKind::F32 || f32::from_bits(value.to_bits32()).is_finite();
    let parts = parts.and_then(|parts| is_good.then_some(parts).ok_or(Status::NOT_FINITE));
    parts
        .map(|(scheme, state)| scheme.resync(state, value))
        .map_or_else(|status| status, |()| Status::OK)
}

/// The neurons that fire.
///
/// # Safety
/// C's promise of [`pointer`].
pub unsafe fn firings<C: CCode>(
    code: *const C,
    into: *mut CNeuronSpike,
    capacity: usize,
    count: *mut usize,
) -> Status {
    let write = || {
        // SAFETY: C's promise; any bytes are a `MaybeUninit`.
        let (code, into, count) = unsafe {
            let into = pointer::slice_mut(into.cast::<MaybeUninit<CNeuronSpike>>(), capacity)?;
            (given(code)?, into, pointer::place(count)?)
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
pub unsafe fn assemble<C: CCode>(
    firings: *const CNeuronSpike,
    count: usize,
    code: *mut C,
) -> Status {
    let assemble = || {
        // SAFETY: C's promise; any bytes are firings.
        let (firings, place) = unsafe { (pointer::slice(firings, count)?, pointer::place(code)?) };
        place.write(C::assemble(firings.iter().map(|&firing| NeuronSpike::from(firing))));
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
        // SAFETY: C's promise; any bytes are samples, room for codes, and an encoder that is started or not.
        let (encoders, samples, rooms) = unsafe {
            (
                pointer::slice_mut(encoders, channels)?,
                pointer::slice(samples, channels)?,
                pointer::slice_mut(codes.cast::<Room<P>>(), channels)?,
            )
        };
        // SAFETY: C's promise; any bytes are a stamp.
        let (stamp, queue) = unsafe { (pointer::shared(stamp)?, producer(queue)?) };
        if encoders.iter().any(|encoder| encoder.codec.is_null()) {
            return Err(Status::NOT_STARTED);
        }
        for ((encoder, sample), room) in encoders.iter_mut().zip(samples).zip(rooms.iter_mut()) {
            // SAFETY: it is started.
            let (scheme, state) = unsafe { Running::parts(encoder) }?;
            room.write(scheme.encode(state, *sample));
        }
        // SAFETY: each room has an output.
        unsafe { put::<P::Code>(rooms, stamp, queue) };
        Ok(Status::OK)
    };
    encode().into()
}

/// Puts the events of codes, slot by slot if slots have a length.
///
/// # Safety
/// An output was put into each room.
unsafe fn put<C: CCode>(rooms: &[C::Room], stamp: &Stamp, mut queue: impl Put) {
    let slots = if stamp.slot_ticks > 0 { C::SLOTS } else { 1 };
    let mut tick = Tick::from(stamp.tick);
    for slot in 0..slots {
        let mut first = stamp.first_address;
        for room in rooms {
            // SAFETY: the caller's promise.
            let code = unsafe { C::read(room) };
            for NeuronSpike { neuron, slot: own, polarity } in code.iter().flat_map(Code::firings) {
                if slots == 1 || usize::from(own) == slot {
                    let address = first.wrapping_add(neuron);
                    queue.put(Item::Event(Event { tick, address, polarity }));
                }
            }
            first = first.wrapping_add(C::NEURONS as u16);
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
        let tick = Tick::from(stamp.tick);
        let mut address = stamp.first_address;
        let mut has_keyframe = false;
        for encoder in encoders {
            // SAFETY: it is a reference; whether it is started is checked.
            let (scheme, state) = unsafe { Running::parts(encoder) }?;
            if let Some(value) = scheme.keyframe(state) {
                queue.put(Item::Keyframe(Keyframe::new(tick, address, value)));
                has_keyframe = true;
            }
            address = address.wrapping_add(P::Code::NEURONS as u16);
        }
        if !has_keyframe {
            queue.put(Item::Heartbeat { tick, address: stamp.first_address });
        }
        Ok(Status::OK)
    };
    keyframes().into()
}
