//! Framed events over any transport of bytes that keeps their order: UART, SPI to an FPGA, USB, TCP.
//!
//! # Specification, version 4
//!
//! A link is a run of frames, full ones and short ones. All numbers are little endian. A full frame can be read by itself:
//!
//! | byte | field | |
//! |---|---|---|
//! | 0 | magic | `A5` |
//! | 1 | version and flags | version 4 in bits 4 to 6; flags 1 *lost*, 2 *keyframes*, 4 *first*, 8 *fingerprint* |
//! | 2-7 | number | of the frame: that of the session first, +1 each, modulo 2⁴⁸ |
//! | 8-13 | time | µs, modulo 2⁴⁸; that of the keyframes, from which the first event's time is counted |
//! | 14-16 | period | µs from sample to sample, 1 to 16 777 215 |
//! | 17 | coding | address bits in the low nibble, jitter bits in the high one |
//! | 18 | step bits | of a step number, 0 to 4 |
//! | 19-20 | count | number of the frame's point on the grid, modulo 2 to the power of the *grid bits* |
//! | 21-22 | jitter | µs from that point to the frame's time, signed |
//! | 23 | length | bytes of fingerprint, keyframes and events, 0 to 255 |
//! | | fingerprint | with the flag *fingerprint*: the 4 bytes of a [`Fingerprint`](crate::Fingerprint) |
//! | | keyframes | with the flag *keyframes*: their count, their sample type, then each its address (2 bytes), its bits (2 or 4, or none), and with step bits the step number of its address (1 byte), which heartbeats lack |
//! | | events | a string of bits, below |
//! | | checksum | CRC-32/ISO-HDLC, the one of zlib, of all bytes before it |
//!
//! A short frame leaves out what its reader knows of the frame before:
//!
//! | byte | field | |
//! |---|---|---|
//! | 0 | magic and length | `60` and the length less 1, 0 to 14, or 15 where a byte with the length follows, 16 to 255; with keyframes 16 more |
//! | 1 or 2 | number | its low 8 bits |
//! | | keyframes | as in a full frame, if it has some |
//! | | time | the first of a string of bits: the count in as many bits as the grid bits are, then the jitter as `code(zigzag(jitter), jitter bits)` |
//! | | events | which follow in the same string of bits |
//! | | checksum | CRC-32 of what the frame leaves out, below, and of all its bytes before it |
//!
//! **Flags:** *lost*, the sender lost items before this frame, its encoders changed without events, or it does not know
//! the time since the frame before; *first*, the first frame of a session. **Sample types:** 0 is `f32`; 1 to 17 are fixed
//! point of 16 bits with 0 to 16 fraction bits; 18 to 50 are fixed point of 32 bits with 0 to 32 fraction bits; 255 has no
//! bits, for heartbeats.
//!
//! **Full frames** are the first four of a session, each with the flag *lost*, and one that comes 2¹⁹ µs (0.52 s) or more after
//! the last full one; half of that if it begins with keyframes or heartbeats. A sender with a fingerprint has it in every
//! full frame. A frame is full, too, if its point lies more than half of all counts after that of the frame before, or more
//! than an eighth before it, and if the bits of its time are 32 or more.
//!
//! **Grid:** the points of time a period apart, from the first frame of a session on, which is point 0. A frame belongs to
//! the point nearest to its time. The grid bits are 21 less the bits of the period, 16 at most and 0 at least, so that counts
//! begin anew every 1 to 2 seconds (of a period of 15 µs or less, sooner). Where the jitter does not fit its field, a full
//! frame moves the grid to its time.
//!
//! **What a short frame leaves out** counts in its checksum, before its own bytes: period (3 bytes), coding, step bits, 1 if
//! the sender has a fingerprint and 0 if not, fingerprint (4 bytes, or 0), the frame's number without its low 8 bits (5
//! bytes), and the time of the last point whose count was 0 (6 bytes). A reader completes a number from that of the frame
//! it delivered last: up to 32 frames back, or ahead; and a count from that frame's: up to an eighth of all counts back, or
//! ahead. Lost frames thus do no harm, full ones neither, until 223 are missing or a second has passed; and a frame of another
//! session, time or description fails its check, but for a chance of one in 2³². The next full frame is the next that is
//! read then. [`Reader::is_interrupted`] tells that bytes come and no frame.
//!
//! **Number:** a session begins at a number of its own, which [`Session`] spreads over all 2⁴⁸. One number thus tells a
//! reader whose frame it is and how many are missing: 0 ahead, none; up to 2²⁴-1 ahead (35 minutes of 8000 frames a
//! second), as many; up to 65 536 behind, the frame is late; anything else is another session, or the same after a longer
//! outage. So is a frame with the flag *first*, unless it is the first frame that came, once more; and one whose number and
//! time tell of different orders, by more than 2¹⁶ µs. After a gap as after a start no value is exact. However many
//! frames are lost, a full frame continues the one before only by being the next one, or by a chance of one in 2⁴⁸.
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
//! - then `1` for up or `0` for down;
//! - then, with step bits, if it is the first event of its address in the frame and the address is 15 or less, the step
//!   number of its address after the event.
//!
//! Fewer than 8 bits at the end, all 0, are no event. With six channels an event thus takes 3 to 7 bits; the first
//! event at a new tick takes 2 more if the tick is one period later, and still more otherwise.
//!
//! **Step numbers:** how many events of an address went up since the session began, less how many went down, modulo 2 to
//! the power of the step bits. After frames were lost, a receiver of a step code takes as many steps as bring it to the
//! number of the next event by the fewest steps. After a loss of fewer net steps than half of that power its value is the
//! sender's again, bit for bit in fixed point, rounded otherwise in `f32`. It stays an estimate until its keyframe: one of
//! the frames that are missing may have been the first of a session near this one, or have told of lost items.
//!
//! **Keyframes** give the value that the decoder of each address should hold after the events of earlier frames and
//! before those of this one. They make the decoder of a temporal code exact again after a loss.
//!
//! **Heartbeats** are the keyframes of codes without keyframes. They say that a sample was taken at the frame's time, and
//! that its events lie in earlier frames: a receiver then knows that samples are whole though no event comes, and when
//! those with sub-timesteps begin, also if it joins late or the link was down. Their address is the bank's first.
//!
//! **Order:** a reader delivers frames by rising number. It leaves out frames that are repeated or late.
//!
//! **Resynchronisation:** after a byte that begins no frame, a wrong header or a wrong checksum, the reader goes on
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
mod crc;
mod delta;
mod error;
mod frame;
mod joint;
mod known;
mod pace;
mod reader;
mod receiver;
mod session;
mod steps;
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
