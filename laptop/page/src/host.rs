//! The border to JavaScript, and the only `unsafe` of the page: `js/wasm.js` is its other side.
//!
//! JavaScript allocates the bytes of a request and hands them over with a call, which answers through the imports
//! before it returns. What an import is given is copied there at once.

#![allow(unsafe_code)]

use flight_logs::files::Bytes;
use serde::Serialize;
use std::io;

#[link(wasm_import_module = "page")]
unsafe extern "C" {
    /// Takes the answer, as JSON.
    fn answer(text: *const u8, length: usize);
    /// Takes an array of the answer: its name, the kind of its numbers, and these.
    fn array(name: *const u8, length: usize, kind: u32, numbers: *const u8, bytes: usize);
    /// Takes how far the work is, as JSON, and the arrays so far.
    fn progress(text: *const u8, length: usize);
    /// Takes the words of a panic, after which nothing may be called any more.
    fn panicked(text: *const u8, length: usize);
    /// Returns the length of a lent file, in bytes.
    fn size(file: u32) -> f64;
    /// Reads a lent file from a place on, and returns how many bytes were read, or -1.
    fn read(file: u32, place: f64, into: *mut u8, length: usize) -> i32;
    /// Waits for bytes of the board, and returns how many came: 0 at the end, or -1 where the browser cannot wait.
    fn board(into: *mut u8, length: usize) -> i32;
}

/// Returns a place for so many bytes, which the next call takes over.
#[unsafe(no_mangle)]
pub extern "C" fn allocate(length: usize) -> *mut u8 {
    Box::into_raw(vec![0_u8; length].into_boxed_slice()).cast()
}

/// Answers the request, whose bytes `allocate` gave.
///
/// # Safety
/// `request` must come from `allocate(length)`, and must not be used again.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn call(request: *mut u8, length: usize) {
    // SAFETY: `allocate` made it of a box of this length, as the caller promises.
    let request = unsafe { Box::from_raw(std::ptr::slice_from_raw_parts_mut(request, length)) };
    std::panic::set_hook(Box::new(|told| {
        let words = told.to_string();
        // SAFETY: the bytes are valid for the call.
        unsafe { panicked(words.as_ptr(), words.len()) };
    }));
    let text = crate::ask::answered(&request).to_string();
    // SAFETY: the bytes are valid for the call.
    unsafe { answer(text.as_ptr(), text.len()) };
}

/// Numbers of a kind that JavaScript has arrays of.
pub(crate) trait Number: Copy {
    /// What `js/wasm.js` calls the kind.
    const KIND: u32;
}

impl Number for f64 {
    const KIND: u32 = 0;
}
impl Number for u32 {
    const KIND: u32 = 1;
}
impl Number for u16 {
    const KIND: u32 = 2;
}
impl Number for u8 {
    const KIND: u32 = 3;
}

/// Adds an array to the answer.
pub(crate) fn send<N: Number>(name: &str, numbers: &[N]) {
    // SAFETY: both are valid for the call, and any number is bytes.
    unsafe {
        array(
            name.as_ptr(),
            name.len(),
            N::KIND,
            numbers.as_ptr().cast(),
            std::mem::size_of_val(numbers),
        );
    }
}

/// Tells how far the work is.
pub(crate) fn tell(told: &impl Serialize) {
    if let Ok(text) = serde_json::to_string(told) {
        // SAFETY: the bytes are valid for the call.
        unsafe { progress(text.as_ptr(), text.len()) };
    }
}

/// A file that JavaScript holds, by its number there.
pub(crate) struct Dropped(pub u32);

impl Bytes for Dropped {
    fn len(&self) -> u64 {
        // SAFETY: it takes and gives numbers.
        unsafe { size(self.0) as u64 }
    }

    fn read_at(&self, place: u64, into: &mut [u8]) -> io::Result<usize> {
        // SAFETY: `into` is valid for writes of its length during the call.
        let read = unsafe { read(self.0, place as f64, into.as_mut_ptr(), into.len()) };
        usize::try_from(read).map_err(|_| io::Error::other("the browser cannot read it"))
    }
}

/// Waits for bytes of the board that JavaScript listens to; there are none at the end.
pub(crate) fn hear(buffer: &mut [u8]) -> io::Result<&[u8]> {
    // SAFETY: `buffer` is valid for writes of its length until the call returns, however late.
    let count = unsafe { board(buffer.as_mut_ptr(), buffer.len()) };
    let count = usize::try_from(count)
        .map_err(|_| io::Error::other("this browser's WebAssembly cannot wait"))?;
    Ok(&buffer[..count])
}
