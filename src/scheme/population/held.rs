//! The state of the population codes' decoders: the value decoded last.

/// The state of a population code's decoder: the value decoded last, which holds while no neuron fires. It starts as
/// the middle centre. 4 bytes in `f32`.
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
