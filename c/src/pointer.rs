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

/// What is read and, as long, what is written; it shares no byte with what is read, nor with what is `kept`.
///
/// # Safety
/// C's promise, and what they point to are so many values, or any bytes are.
#[inline]
pub(crate) unsafe fn from_to<'a, K, A, B>(
    kept: *const K,
    from: *const A,
    to: *mut B,
    length: usize,
) -> Result<(&'a [A], &'a mut [B]), Status> {
    if length == 0 {
        return Ok((&[], &mut []));
    }
    if length > isize::MAX as usize / size_of::<A>().max(size_of::<B>()) {
        return Err(Status::BAD_LENGTH);
    }
    check(from)?;
    check(to)?;
    apart(from, length, to, length)?;
    apart(kept, 1, to, length)?;
    // SAFETY: neither null nor misaligned, apart, and not beyond the address space; the rest is the caller's promise.
    unsafe {
        Ok((core::slice::from_raw_parts(from, length), core::slice::from_raw_parts_mut(to, length)))
    }
}

/// Whether two buffers share no byte; both are within the address space.
pub(crate) fn apart<A, B>(
    a: *const A,
    a_length: usize,
    b: *const B,
    b_length: usize,
) -> Result<(), Status> {
    let (a, a_bytes) = (a.addr(), size_of::<A>().wrapping_mul(a_length));
    let (b, b_bytes) = (b.addr(), size_of::<B>().wrapping_mul(b_length));
    let overlap = b.wrapping_sub(a) < a_bytes || a.wrapping_sub(b) < b_bytes;
    if overlap { Err(Status::OVERLAPPING) } else { Ok(()) }
}
