//! Framed events over any transport of bytes that keeps their order: UART, SPI to an FPGA, USB, TCP.
//!
//! # Specification, version 3
//!
//! A link is a run of frames. All numbers are little endian.
//!
//! | byte | field | |
//! |---|---|---|
//! | 0 | magic | `A5` |
//! | 1 | version and flags | version 3 in bits 4 to 6; flags 1 *lost*, 2 *keyframes*, 4 *first*, 8 *fingerprint*, 128 *described* |
//! | 2-7 | number | of the frame: that of the session first, +1 each, modulo 2⁴⁸ |
//! | 8-13 | time | µs, modulo 2⁴⁸; that of the keyframes, from which the first event's time is counted |
//! | 14-15 | period | µs from sample to sample, 1 to 65 535 |
//! | 16 | coding | address bits in the low nibble, jitter bits in the high one |
//! | 17 | length | bytes of fingerprint, keyframes and events, 0 to 255 |
//! | | fingerprint | with the flag *fingerprint*: the 4 bytes of a [`Fingerprint`](crate::Fingerprint) |
//! | | keyframes | with the flag *keyframes*: their count, their sample type, then each its address (2 bytes) and bits (2 or 4, or none) |
//! | | events | a string of bits, below |
//! | | checksum | CRC-32/ISO-HDLC, the one of zlib, of all bytes before it |
//!
//! **Flags:** *lost*, the sender lost items before this frame, its encoders changed without events, or it does not know
//! the time since the frame before; *first*, the first frame of a session; *described*, in every frame of a sender that has
//! a fingerprint, which comes in the first frame and in later ones. **Sample types:** 0 is `f32`; 1 to 17 are fixed
//! point of 16 bits with 0 to 16 fraction bits; 18 to 50 are fixed point of 32 bits with 0 to 32 fraction bits; 255 has no
//! bits, for heartbeats.
//!
//! **Number:** a session begins at a number of its own, which [`Session`] spreads over all 2⁴⁸. One number thus tells a
//! reader whose frame it is and how many are missing: 0 ahead, none; up to 2²⁴-1 ahead (35 minutes of 8000 frames a
//! second), as many; up to 65 536 behind, the frame is late; anything else is another session, or the same after a longer
//! outage. So is a frame with the flag *first*, unless it is the first frame that came, once more; and one whose number and
//! time tell of different orders, by more than 2¹⁶ µs. After a gap as after a start no value is exact. However many
//! frames are lost, a frame continues the one before only by being the next one, or by a chance of one in 2⁴⁸. (A session and a sequence of 16
//! bits each take 4 bytes, too few: 65 536 lost frames, 8 s of them, look like none, and so do sessions that come again.)
//!
//! **Time:** a receiver has no clock; what it knows of elapsed time is the difference of two frames' times, which is right
//! for outages of up to 4.4 years. A rate code needs it to count the samples without events, which change its value. The
//! sender extends the 32-bit ticks of its items, which wrap after 71.6 minutes: it must know a tick at least every 2³⁰ µs
//! (17.9 minutes), by an item or by [`Transmitter::observe`]. A larger step of ticks has the flag *lost*. Events of a frame
//! lie up to 2²⁹ µs from its time.
//!
//! **Events** follow each other without a gap, each byte filled from its high bit; the last is filled
//! up with 0. `code(v, k)` is the exponential Golomb code: with `n = (v >> k) + 1`, as many 0 as `n`
//! has bits after its first 1, then `n`, then the low `k` bits of `v`. An event is
//!
//! - `0` if it has the tick of the event before and a higher address (the first event: the first
//!   tick and any address), then `code(address - previous address - 1, address bits)`;
//! - `1` otherwise, then its time since the event before as `steps * period + jitter`, both signed,
//!   the jitter at most half a period: `code(zigzag(steps - 1), 0)`, `code(zigzag(jitter), jitter
//!   bits)`, `code(address, address bits)`, where zigzag maps 0, -1, 1, -2 to 0, 1, 2, 3;
//! - then `1` for up or `0` for down.
//!
//! Fewer than 8 bits at the end, all 0, are no event. With six channels an event thus takes 3 to 7 bits; the first
//! event at a new tick takes 2 more if the tick is one period later, and still more otherwise.
//!
//! **Keyframes** give the value that the decoder of each address should hold after the events of earlier frames and
//! before those of this one. They make the decoder of a temporal code exact again after a loss.
//!
//! **Heartbeats** are the keyframes of codes without keyframes. They say that a sample was taken at the frame's time, and
//! that its events lie in earlier frames: a receiver then knows that samples are whole though no event comes, and when
//! those with sub-timesteps begin, also if it joins late or the link was down. Their address is the bank's first.
//!
//! **Fingerprint:** the first frame has it, every frame 2¹⁹ µs (0.52 s) or more after the last one that had it, and a
//! frame with keyframes or heartbeats if three or more came since without it. A receiver with other schemes, or one that
//! has not heard it yet, thus calls no value exact; it costs at most a byte a frame on average, or 8 bytes a second.
//!
//! **Order:** a reader delivers frames by rising number. It leaves out frames that are repeated or late.
//!
//! **Resynchronisation:** after a byte that is not the magic, a wrong header or a wrong checksum, the reader goes on
//! with the next byte. Frames that are lost this way leave a gap in the numbers.
//!
//! # Parts
//!
//! - **Sending:** a [`Transmitter`] takes items from a queue and turns them into frames, in their order. It is made of a
//!   [`Framer`], which numbers frames, and a [`FrameWriter`], which writes one.
//! - **Receiving:** a [`Reader`] finds frames in bytes cut anywhere, a [`FrameView`] reads one in place, and a
//!   [`Receiver`] decodes them and knows which values are exact.
//!
//! ```
//! use spikewire::{Bank, EventQueue, Overflow, Tick, link::*, temporal::StepForward};
//!
//! static GYRO: StepForward<f32> = StepForward::new(0.1);
//! let mut bank = Bank::<_, 3>::new(&GYRO);
//! static EVENTS: EventQueue<64> = EventQueue::new(Overflow::DropOldest);
//! let mut transmitter = Transmitter::for_bank(&bank, 1_000, Session::counted(1)); // a sample every 1000 µs
//! let mut reader = Reader::<MAX_FRAME>::new();
//! let mut receiver = Receiver::<_, 3>::new(&GYRO);
//!
//! // In the interrupt:
//! for (micros, rate) in [(1_000, 0.0), (2_000, 0.3), (3_000, 0.35)] {
//!     bank.encode_into(Tick::from_micros(micros), [rate, 0.0, -rate], &EVENTS);
//! }
//! bank.keyframe_into(Tick::from_micros(3_000), &EVENTS); // once a second, after a sample
//!
//! // In main:
//! let mut events = EVENTS.consumer().expect("the only consumer");
//! let mut buffer = [0; MAX_FRAME];
//! while let Some(bytes) = transmitter.next_frame(&mut events, &mut buffer)? {
//!     let mut input = bytes; // what arrives at the other end
//!     while let Some(received) = reader.next_frame(&mut input) {
//!         receiver.apply(&received, |_, _, _| ());
//!     }
//! }
//! assert_eq!(receiver.exact(0), Some(0.2));
//! assert_eq!(receiver.exact(2), Some(-0.2));
//! # Ok::<(), LinkError>(())
//! ```

mod bits;
mod delta;
mod error;
mod frame;
mod joint;
mod pace;
mod reader;
mod receiver;
mod session;
mod time;
mod transmitter;
mod trust;
mod withheld;
mod writer;

pub use error::LinkError;
pub use frame::{Events, FrameView, MAX_FRAME, MIN_FRAME};
pub use joint::{Joint, Part, join};
pub use pace::{CLOCK_TOLERANCE, longest_slot};
pub use reader::{Gap, Reader, Received};
pub use receiver::Receiver;
pub use session::Session;
pub use transmitter::Transmitter;
pub use withheld::Withheld;
pub use writer::{Coding, FrameWriter, Framer};
