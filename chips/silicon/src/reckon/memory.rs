//! A memory that stores words only up to the highest address written, because a microcontroller that runs the model has
//! no room for all words.

use alloc::vec::Vec;
use core::iter::repeat_n;
use core::ops::Index;

/// A memory of 128-bit words, which are all 0 until they are written.
#[derive(Clone, Debug)]
pub struct Memory {
    /// The words from address 0 to the highest address written; the words after them are 0.
    words: Vec<u128>,
    length: usize,
}

impl Memory {
    pub(super) const fn new(length: usize) -> Self {
        Self { words: Vec::new(), length }
    }

    /// Writes a word.
    ///
    /// # Panics
    /// Panics if `at` is not below the number of words.
    pub fn set(&mut self, at: usize, word: u128) {
        assert!(at < self.length, "a memory of {} words has no word {at}", self.length);
        if at >= self.words.len() {
            if word == 0 {
                return;
            }
            self.words.resize(at + 1, 0);
        }
        self.words[at] = word;
    }

    /// Returns all words, in order, including those that were never written.
    pub fn iter(&self) -> impl Iterator<Item = u128> {
        self.words.iter().copied().chain(repeat_n(0, self.length - self.words.len()))
    }
}

impl Index<usize> for Memory {
    type Output = u128;

    fn index(&self, at: usize) -> &u128 {
        self.words.get(at).unwrap_or(&0)
    }
}
