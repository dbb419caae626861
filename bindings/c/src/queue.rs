//! The queue from the interrupt that encodes to main, in the caller's storage.

use spikewire::{Source, SpscConsumer, SpscProducer, SpscQueue};

use crate::event::CItem;
use crate::kept::Kept;
use crate::{Status, pointer};

/// The two ends of a queue. Its items are in storage that it points to.
pub struct Queue {
    producer: SpscProducer<'static>,
    consumer: SpscConsumer<'static>,
}

/// Makes a queue of the largest of these lengths that the storage has room for.
macro_rules! lengths {
    ($storage:expr, $bytes:expr, $($length:literal)*) => {
        $(
            if size_of::<SpscQueue<$length>>() <= $bytes {
                // SAFETY: C promises so many bytes that nothing else uses while the queue lives.
                let queue = unsafe { pointer::place($storage.cast::<SpscQueue<$length>>()) }?;
                return Ok(queue.write(SpscQueue::new()).split());
            }
        )*
    };
}

type Ends = Option<(SpscProducer<'static>, SpscConsumer<'static>)>;

unsafe fn made(storage: *mut usize, bytes: usize) -> Result<Ends, Status> {
    lengths!(storage, bytes, 4096 2048 1024 512 256 128 64 32 16 8);
    Err(Status::TOO_SMALL)
}

/// Makes an empty queue in storage of so many bytes.
#[unsafe(no_mangle)]
unsafe extern "C" fn sw_queue_init(
    queue: *mut Kept<Queue>,
    storage: *mut usize,
    bytes: usize,
) -> Status {
    let is_apart = pointer::apart(queue, 1, storage.cast::<u8>(), bytes);
    // SAFETY: C's promise.
    let result = is_apart.and_then(|()| unsafe { made(storage, bytes) });
    let kept = result.and_then(|ends| ends.ok_or(Status::NULL)).and_then(|(producer, consumer)| {
        // SAFETY: C's promise.
        unsafe { Kept::keep(queue, Queue { producer, consumer }) }
    });
    kept.into()
}

/// The end for the interrupt. The other end may be in use meanwhile: they share nothing but what the crate's queue
/// shares between its ends.
///
/// # Safety
/// C's promise, for this end.
pub(crate) unsafe fn producer<'a>(
    queue: *mut Kept<Queue>,
) -> Result<&'a mut SpscProducer<'static>, Status> {
    // SAFETY: C's promise.
    let queue = unsafe { Kept::raw(queue) }?;
    // SAFETY: C promises that one context at a time puts; the other end is no part of this reference.
    unsafe { pointer::exclusive(&raw mut (*queue).producer) }
}

/// The end for main.
///
/// # Safety
/// C's promise, for this end.
pub(crate) unsafe fn consumer<'a>(
    queue: *mut Kept<Queue>,
) -> Result<&'a mut SpscConsumer<'static>, Status> {
    // SAFETY: C's promise.
    let queue = unsafe { Kept::raw(queue) }?;
    // SAFETY: C promises that one context at a time takes; the other end is no part of this reference.
    unsafe { pointer::exclusive(&raw mut (*queue).consumer) }
}

/// Appends an item; if there is no room, it is lost and counted.
#[unsafe(no_mangle)]
unsafe extern "C" fn sw_queue_put(queue: *mut Kept<Queue>, item: *const CItem) -> Status {
    // SAFETY: C's promise.
    let result = unsafe { producer(queue) }.and_then(|producer| {
        // SAFETY: C's promise; any bytes are an item.
        let item = unsafe { pointer::shared(item) }?;
        producer.push(item.item().ok_or(Status::BAD_CHOICE)?);
        Ok(Status::OK)
    });
    result.into()
}

/// Takes the oldest item.
#[unsafe(no_mangle)]
unsafe extern "C" fn sw_queue_take(queue: *mut Kept<Queue>, item: *mut CItem) -> Status {
    // SAFETY: C's promise.
    let result = unsafe { consumer(queue) }.and_then(|consumer| {
        // SAFETY: C's promise.
        let place = unsafe { pointer::place(item) }?;
        place.write(consumer.take().ok_or(Status::NOTHING)?.into());
        Ok(Status::OK)
    });
    result.into()
}

/// How many items are in the queue, and how many were lost since it was made.
#[unsafe(no_mangle)]
unsafe extern "C" fn sw_queue_counts(
    queue: *mut Kept<Queue>,
    length: *mut u32,
    lost: *mut u32,
) -> Status {
    // SAFETY: C's promise.
    let result = unsafe { consumer(queue) }.and_then(|consumer| {
        // SAFETY: C's promise.
        let (length, lost) = unsafe { (pointer::place(length)?, pointer::place(lost)?) };
        length.write(consumer.len() as u32);
        lost.write(consumer.lost());
        Ok(Status::OK)
    });
    result.into()
}
