//! Both ends of a flight, from the module that its file writes: bank and writer, reader and receiver.

use core::ffi::c_void;

use spikewire::link::{Receiver, Session, Transmitter, Withheld};
use spikewire::{Bank, Scheme, Tick};

use crate::argument::Number;
use crate::describe::Layout;
use crate::kept::Kept;
use crate::link::CReader;
pub use crate::link::ReaderCounts;
use crate::queue::{Queue, producer};
use crate::{Status, pointer};

/// What the header tells of a flight.
#[derive(Clone, Copy, Debug)]
pub struct Flight {
    /// Its name without `sw_`.
    pub name: &'static str,
    /// The type of its samples in C.
    pub sample: &'static str,
    /// Names of the channels, in the order of a sample.
    pub names: &'static [&'static str],
    /// Counts for one unit of each channel.
    pub counts: &'static [f64],
    /// µs from sample to sample.
    pub period: u32,
    /// Samples from one keyframe or heartbeat to the next.
    pub keyframe_every: u32,
    /// The encoders, with the filters before them.
    pub bank: Layout,
    /// The reader and the decoders.
    pub receiver: Layout,
}

/// The storage of a bank.
pub type NearEnd<P, const N: usize> = Kept<Bank<[&'static P; N], N>>;

/// The storage of a receiver.
pub type FarEnd<P, const N: usize, const EVENTS: usize> = Kept<Far<P, N, EVENTS>>;

/// A receiver behind its reader.
pub struct Far<P: Scheme + 'static, const N: usize, const EVENTS: usize> {
    reader: CReader,
    receiver: Receiver<[&'static P; N], N, EVENTS>,
}

/// Is handed the channel, the tick and the value of each keyframe, event or sample.
pub type TakeValue<S> = Option<unsafe extern "C" fn(*mut c_void, u16, u32, S)>;

/// The type of a flight's samples in C.
pub const fn sample_of<P: Scheme<Sample: Number>>() -> &'static str {
    <P::Sample as Number>::TYPE
}

/// Exports both ends of a flight under its name: `flight!(roll, flight)` gives `sw_roll_bank_encode`. The module is as
/// `spikewire_flight::rust` writes it.
#[macro_export]
macro_rules! flight {
    ($name:ident, $module:ident) => {
        use $crate::flight::{FarEnd, NearEnd, TakeValue};

        type Sample = <$module::Code as ::spikewire::Scheme>::Sample;

        /// The storage of the bank.
        pub type Near = NearEnd<$module::Code, { $module::CHANNELS }>;
        /// The storage of the receiver.
        pub type Far = FarEnd<$module::Code, { $module::CHANNELS }, { $module::EVENTS }>;

        /// What the header tells of it.
        pub fn description() -> $crate::Flight {
            $crate::Flight {
                name: stringify!($name),
                sample: $crate::flight::sample_of::<$module::Code>(),
                names: &$module::NAMES,
                counts: &$module::COUNTS,
                period: $module::PERIOD,
                keyframe_every: $module::KEYFRAME_EVERY,
                bank: $crate::Layout::of::<Near>(),
                receiver: $crate::Layout::of::<Far>(),
            }
        }

        $crate::flight!(@functions $name;
            bank_start(bank: *mut Near), $module::BANK;
            bank_encode(bank: *mut Near, now: u32, samples: *const Sample, queue: *mut $crate::Kept<$crate::Queue>);
            bank_keyframes(bank: *const Near, now: u32, queue: *mut $crate::Kept<$crate::Queue>);
            bank_rejected(bank: *const Near, count: *mut u32);
            writer_init(writer: *mut $crate::Kept<::spikewire::link::Transmitter>, session: u64), $module::transmitter;
            receiver_init(receiver: *mut Far), $module::receiver();
            receiver_take(receiver: *mut Far, bytes: *const u8, length: usize, take: TakeValue<Sample>, context: *mut ::core::ffi::c_void);
            receiver_advance(receiver: *mut Far, now: u32, take: TakeValue<Sample>, context: *mut ::core::ffi::c_void);
            receiver_exact(receiver: *const Far, channel: u16, value: *mut Sample);
            receiver_estimate(receiver: *const Far, channel: u16, value: *mut Sample);
            receiver_counts_of(receiver: *const Far, counts: *mut $crate::flight::ReaderCounts);
        );
    };

    (@functions $name:ident; $($function:ident($($argument:ident: $type:ty),*) $(, $more:expr)?;)*) => {
        $(
            #[unsafe(export_name = concat!("sw_", stringify!($name), "_", stringify!($function)))]
            unsafe extern "C" fn $function($($argument: $type),*) -> $crate::Status {
                // SAFETY: C's promise.
                unsafe { $crate::flight::$function($($argument),* $(, $more)?) }
            }
        )*
    };
}

/// Starts, or resets, the encoders.
///
/// # Safety
/// C's promise of [`pointer`].
pub unsafe fn bank_start<P: Scheme, const N: usize>(
    bank: *mut NearEnd<P, N>,
    start: Bank<[&'static P; N], N>,
) -> Status {
    // SAFETY: C's promise.
    unsafe { Kept::keep(bank, start) }.into()
}

/// Encodes a sample of each channel, and puts its events into a queue.
///
/// # Safety
/// C's promise of [`pointer`].
pub unsafe fn bank_encode<P: Scheme<Sample: Number>, const N: usize>(
    bank: *mut NearEnd<P, N>,
    now: u32,
    samples: *const P::Sample,
    queue: *mut Kept<Queue>,
) -> Status {
    let encode = || {
        // SAFETY: C's promise; any bytes are numbers.
        let (bank, samples) = unsafe { (Kept::exclusive(bank)?, pointer::slice(samples, N)?) };
        let samples = samples.try_into().map_err(|_| Status::BAD_LENGTH)?;
        // SAFETY: C's promise.
        let queue = unsafe { producer(queue)? };
        bank.encode_into(Tick::from(now), samples, queue);
        Ok(Status::OK)
    };
    encode().into()
}

/// Puts keyframes, or a heartbeat, into a queue.
///
/// # Safety
/// C's promise of [`pointer`].
pub unsafe fn bank_keyframes<P: Scheme, const N: usize>(
    bank: *const NearEnd<P, N>,
    now: u32,
    queue: *mut Kept<Queue>,
) -> Status {
    let put = || {
        // SAFETY: C's promise.
        let (bank, queue) = unsafe { (Kept::shared(bank)?, producer(queue)?) };
        bank.keyframe_into(Tick::from(now), queue);
        Ok(Status::OK)
    };
    put().into()
}

/// How many samples were not finite.
///
/// # Safety
/// C's promise of [`pointer`].
pub unsafe fn bank_rejected<P: Scheme, const N: usize>(
    bank: *const NearEnd<P, N>,
    count: *mut u32,
) -> Status {
    let read = || {
        // SAFETY: C's promise.
        let (bank, count) = unsafe { (Kept::shared(bank)?, pointer::place(count)?) };
        count.write(bank.rejected());
        Ok(Status::OK)
    };
    read().into()
}

/// Prepares the writer of the flight's frames.
///
/// # Safety
/// C's promise of [`pointer`].
pub unsafe fn writer_init(
    writer: *mut Kept<Transmitter>,
    session: u64,
    transmitter: fn(Session) -> Transmitter,
) -> Status {
    // SAFETY: C's promise.
    unsafe { Kept::keep(writer, transmitter(Session::random(session))) }.into()
}

/// Prepares a receiver.
///
/// # Safety
/// C's promise of [`pointer`].
pub unsafe fn receiver_init<P: Scheme, const N: usize, const EVENTS: usize>(
    far: *mut FarEnd<P, N, EVENTS>,
    receiver: Receiver<[&'static P; N], N, EVENTS>,
) -> Status {
    // SAFETY: C's promise.
    unsafe { Kept::keep(far, Far { reader: CReader::new(), receiver }) }.into()
}

/// Reads bytes that are cut anywhere, and decodes the frames that they complete.
///
/// # Safety
/// C's promise of [`pointer`].
pub unsafe fn receiver_take<P: Scheme, const N: usize, const EVENTS: usize>(
    far: *mut FarEnd<P, N, EVENTS>,
    bytes: *const u8,
    length: usize,
    take: TakeValue<P::Sample>,
    context: *mut c_void,
) -> Status {
    let read = || {
        // SAFETY: C's promise; any bytes are bytes.
        let (far, mut bytes) = unsafe { (Kept::exclusive(far)?, pointer::slice(bytes, length)?) };
        let Far { reader, receiver } = far;
        while let Some(received) = reader.next_frame(&mut bytes) {
            receiver.apply(&received, given(take, context));
        }
        Ok(Status::OK)
    };
    read().into()
}

/// Decodes the samples that are over at this time.
///
/// # Safety
/// C's promise of [`pointer`].
pub unsafe fn receiver_advance<P: Scheme, const N: usize, const EVENTS: usize>(
    far: *mut FarEnd<P, N, EVENTS>,
    now: u32,
    take: TakeValue<P::Sample>,
    context: *mut c_void,
) -> Status {
    let advance = || {
        // SAFETY: C's promise.
        let far = unsafe { Kept::exclusive(far)? };
        far.receiver.advance(Tick::from(now), given(take, context));
        Ok(Status::OK)
    };
    advance().into()
}

/// Hands a value to C, if C takes any.
fn given<S>(take: TakeValue<S>, context: *mut c_void) -> impl FnMut(u16, Tick, S) {
    move |channel, tick, value| {
        if let Some(take) = take {
            // SAFETY: C promises that it can be called with its context and a value.
            unsafe { take(context, channel, tick.micros(), value) };
        }
    }
}

/// Reads a channel's value if it is exact; otherwise the status says what is missing.
///
/// # Safety
/// C's promise of [`pointer`].
pub unsafe fn receiver_exact<P: Scheme, const N: usize, const EVENTS: usize>(
    far: *const FarEnd<P, N, EVENTS>,
    channel: u16,
    value: *mut P::Sample,
) -> Status {
    let read = || {
        // SAFETY: C's promise.
        let (far, value) = unsafe { (Kept::shared(far)?, pointer::place(value)?) };
        let receiver = &far.receiver;
        match receiver.exact(channel) {
            Some(exact) => {
                value.write(exact);
                Ok(Status::OK)
            }
            None => Err(receiver.withheld(channel).map_or(Status::BAD_CHOICE, Status::from)),
        }
    };
    read().into()
}

/// Reads a channel's value, exact or not.
///
/// # Safety
/// C's promise of [`pointer`].
pub unsafe fn receiver_estimate<P: Scheme, const N: usize, const EVENTS: usize>(
    far: *const FarEnd<P, N, EVENTS>,
    channel: u16,
    value: *mut P::Sample,
) -> Status {
    let read = || {
        // SAFETY: C's promise.
        let (far, value) = unsafe { (Kept::shared(far)?, pointer::place(value)?) };
        if usize::from(channel) >= N {
            return Err(Status::BAD_CHOICE);
        }
        value.write(far.receiver.estimate(channel));
        Ok(Status::OK)
    };
    read().into()
}

/// What the receiver's reader has seen.
///
/// # Safety
/// C's promise of [`pointer`].
pub unsafe fn receiver_counts_of<P: Scheme, const N: usize, const EVENTS: usize>(
    far: *const FarEnd<P, N, EVENTS>,
    counts: *mut ReaderCounts,
) -> Status {
    let count = || {
        // SAFETY: C's promise.
        let (far, counts) = unsafe { (Kept::shared(far)?, pointer::place(counts)?) };
        counts.write(ReaderCounts::of(&far.reader));
        Ok(Status::OK)
    };
    count().into()
}

impl From<Withheld> for Status {
    fn from(why: Withheld) -> Self {
        match why {
            Withheld::Keyframe => Self::NO_KEYFRAME,
            Withheld::Samples(_) => Self::NO_SAMPLES,
            Withheld::Spike => Self::NO_SPIKE,
            Withheld::Heartbeat => Self::NO_HEARTBEAT,
            Withheld::Clock => Self::NO_CLOCK,
            Withheld::Always => Self::FADING,
            Withheld::Description { .. } => Self::OTHER_FLIGHT,
            Withheld::Contradicted => Self::CONTRADICTED,
            _ => Self::WITHHELD,
        }
    }
}
