//! The state of decoders whose codes stand for themselves: the value decoded last.

/// The state of a decoder that adds up nothing: the value decoded last, which holds while there is no spike. It starts as
/// the middle centre or cell. 4 bytes in `f32`.
#[derive(Clone, Copy, Debug)]
pub struct Held<S> {
    value: S,
}

impl<S: Copy> Held<S> {
    pub(super) const fn at(value: S) -> Self {
        Self { value }
    }

    pub(super) const fn value(&self) -> S {
        self.value
    }

    /// Takes a new value, if there is one, and returns the current one.
    #[inline]
    pub(super) fn or_hold(&mut self, value: Option<S>) -> S {
        if let Some(value) = value {
            self.value = value;
        }
        self.value
    }
}
