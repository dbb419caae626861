//! What the decoders of the population codes keep.

/// The state of a population code's decoder: the value decoded last, which holds where no neuron fires.
/// 4 bytes in `f32`. It is the middle centre at first.
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

    /// The new value, or the one before where there is none.
    #[inline]
    pub(super) fn or_hold(&mut self, value: Option<S>) -> S {
        if let Some(value) = value {
            self.value = value;
        }
        self.value
    }
}
