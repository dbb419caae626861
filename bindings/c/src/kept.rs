//! Storage in which a call keeps a value for later calls.

use core::mem::MaybeUninit;

use crate::{Status, pointer};

/// A value, behind a mark that tells whether there is one: not in storage that is all 0, as a static is.
#[repr(C)]
pub struct Kept<T> {
    mark: u32,
    value: MaybeUninit<T>,
}

impl<T> Kept<T> {
    const MARK: u32 = 0x5350_4b57;

    /// Keeps a value.
    ///
    /// # Safety
    /// C's promise of [`pointer`].
    pub(crate) unsafe fn keep(storage: *mut Self, value: T) -> Result<Status, Status> {
        // SAFETY: the caller's promise.
        let storage = unsafe { pointer::place(storage) }?;
        storage.write(Self { mark: Self::MARK, value: MaybeUninit::new(value) });
        Ok(Status::OK)
    }

    /// The value, to be read.
    ///
    /// # Safety
    /// C's promise of [`pointer`].
    pub(crate) unsafe fn shared<'a>(storage: *const Self) -> Result<&'a T, Status> {
        // SAFETY: the caller's promise; any bytes are a mark and a `MaybeUninit`.
        let storage = unsafe { pointer::shared(storage) }?;
        if storage.mark != Self::MARK {
            return Err(Status::NOT_STARTED);
        }
        // SAFETY: the mark was written with a value, and C changes neither.
        Ok(unsafe { storage.value.assume_init_ref() })
    }

    /// The value, to be changed.
    ///
    /// # Safety
    /// C's promise of [`pointer`].
    pub(crate) unsafe fn exclusive<'a>(storage: *mut Self) -> Result<&'a mut T, Status> {
        // SAFETY: the caller's promise; any bytes are a mark and a `MaybeUninit`.
        let storage = unsafe { pointer::exclusive(storage) }?;
        if storage.mark != Self::MARK {
            return Err(Status::NOT_STARTED);
        }
        // SAFETY: the mark was written with a value, and C changes neither.
        Ok(unsafe { storage.value.assume_init_mut() })
    }

    /// Where the value is, for one whose parts several contexts use at once: no reference to all of it is made.
    ///
    /// # Safety
    /// C's promise of [`pointer`].
    pub(crate) unsafe fn raw(storage: *mut Self) -> Result<*mut T, Status> {
        pointer::check(storage)?;
        // SAFETY: neither null nor misaligned; the rest is the caller's promise. The mark does not change any more.
        let mark = unsafe { (&raw const (*storage).mark).read() };
        if mark != Self::MARK {
            return Err(Status::NOT_STARTED);
        }
        // SAFETY: as above.
        Ok(unsafe { &raw mut (*storage).value }.cast())
    }
}
