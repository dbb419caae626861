//! Pointers from C, checked as far as can be known, as references.
//!
//! The rest is the promise of C's caller: a pointer that is neither null nor misaligned points to storage of its type
//! that nothing else uses during the call.

use core::mem::MaybeUninit;

use crate::Status;

/// Checks that a pointer is neither null nor misaligned.
pub(crate) fn check<T>(pointer: *const T) -> Result<(), Status> {
    if pointer.is_null() {
        Err(Status::NULL)
    } else if !pointer.is_aligned() {
        Err(Status::MISALIGNED)
    } else {
        Ok(())
    }
}

/// Borrows `*pointer`, after checking that it is not null and is aligned.
///
/// # Safety
/// `pointer` must be valid for reads of an initialised `T` for the whole call.
pub(crate) unsafe fn shared<'a, T>(pointer: *const T) -> Result<&'a T, Status> {
    check(pointer)?;
    // SAFETY: neither null nor misaligned; the rest is the caller's promise.
    Ok(unsafe { &*pointer })
}

/// Borrows `*pointer` mutably, after checking that it is not null and is aligned.
///
/// # Safety
/// `pointer` must be valid for reads and writes of an initialised `T` for the whole call.
pub(crate) unsafe fn exclusive<'a, T>(pointer: *mut T) -> Result<&'a mut T, Status> {
    check(pointer)?;
    // SAFETY: neither null nor misaligned; the rest is the caller's promise.
    Ok(unsafe { &mut *pointer })
}

/// Borrows `*pointer` as storage that may be uninitialised, after checking that it is not null and is aligned.
///
/// # Safety
/// `pointer` must be valid for writes of a `T` for the whole call.
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

/// Borrows `length` values from `pointer` on, which may be null if there are none.
///
/// # Safety
/// `pointer` must be valid for reads of `length` consecutive `T` for the whole call.
pub(crate) unsafe fn slice<'a, T>(pointer: *const T, length: usize) -> Result<&'a [T], Status> {
    if length == 0 {
        return Ok(&[]);
    }
    check_all(pointer, length)?;
    // SAFETY: neither null nor misaligned, and not beyond the address space; the rest is the caller's promise.
    Ok(unsafe { core::slice::from_raw_parts(pointer, length) })
}

/// Borrows `length` values from `pointer` on mutably, which may be null if there are none.
///
/// # Safety
/// `pointer` must be valid for reads and writes of `length` consecutive `T` for the whole call.
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

/// Borrows `length` values to read and as many to write, after checking that these share no byte with those or `kept`.
///
/// # Safety
/// `from` must be valid for reads, and `to` for writes, of `length` consecutive values for the whole call, initialised
/// unless any bytes are a value of the type.
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
