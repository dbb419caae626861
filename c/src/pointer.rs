//! Pointers from C, checked as far as can be known, as references.
//!
//! What cannot be known is what C promises: that a pointer which is neither null nor misaligned points to storage of
//! its type that nothing else uses during the call.

use core::mem::MaybeUninit;

use crate::Status;

/// Neither null nor misaligned.
pub(crate) fn check<T>(pointer: *const T) -> Result<(), Status> {
    if pointer.is_null() {
        Err(Status::NULL)
    } else if !pointer.is_aligned() {
        Err(Status::MISALIGNED)
    } else {
        Ok(())
    }
}

/// What is read.
///
/// # Safety
/// C's promise, and what it points to is a value.
pub(crate) unsafe fn shared<'a, T>(pointer: *const T) -> Result<&'a T, Status> {
    check(pointer)?;
    // SAFETY: neither null nor misaligned; the rest is the caller's promise.
    Ok(unsafe { &*pointer })
}

/// What is changed.
///
/// # Safety
/// C's promise, and what it points to is a value.
pub(crate) unsafe fn exclusive<'a, T>(pointer: *mut T) -> Result<&'a mut T, Status> {
    check(pointer)?;
    // SAFETY: neither null nor misaligned; the rest is the caller's promise.
    Ok(unsafe { &mut *pointer })
}

/// What is written.
///
/// # Safety
/// C's promise.
pub(crate) unsafe fn place<'a, T>(pointer: *mut T) -> Result<&'a mut MaybeUninit<T>, Status> {
    // SAFETY: any bytes are a `MaybeUninit`; the rest is the caller's promise.
    unsafe { exclusive(pointer.cast()) }
}

fn check_all<T>(pointer: *const T, length: usize) -> Result<(), Status> {
    if size_of::<T>().checked_mul(length).is_none_or(|bytes| bytes > isize::MAX as usize) {
        return Err(Status::BAD_LENGTH);
    }
    check(pointer)
}

/// What is read; null if there is none of it.
///
/// # Safety
/// C's promise, and what it points to are so many values.
pub(crate) unsafe fn slice<'a, T>(pointer: *const T, length: usize) -> Result<&'a [T], Status> {
    if length == 0 {
        return Ok(&[]);
    }
    check_all(pointer, length)?;
    // SAFETY: neither null nor misaligned, and not beyond the address space; the rest is the caller's promise.
    Ok(unsafe { core::slice::from_raw_parts(pointer, length) })
}

/// What is changed; null if there is none of it.
///
/// # Safety
/// C's promise, and what it points to are so many values.
pub(crate) unsafe fn slice_mut<'a, T>(
    pointer: *mut T,
    length: usize,
) -> Result<&'a mut [T], Status> {
    if length == 0 {
        return Ok(&mut []);
    }
    check_all(pointer, length)?;
    // SAFETY: neither null nor misaligned, and not beyond the address space; the rest is the caller's promise.
    Ok(unsafe { core::slice::from_raw_parts_mut(pointer, length) })
}

/// Whether two buffers share no byte.
pub(crate) fn apart<A, B>(
    a: *const A,
    a_length: usize,
    b: *const B,
    b_length: usize,
) -> Result<(), Status> {
    let (a_start, b_start) = (a.addr(), b.addr());
    let a_end = a_start.saturating_add(size_of::<A>().saturating_mul(a_length));
    let b_end = b_start.saturating_add(size_of::<B>().saturating_mul(b_length));
    if a_start < b_end && b_start < a_end { Err(Status::OVERLAPPING) } else { Ok(()) }
}
