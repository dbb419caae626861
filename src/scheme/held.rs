//! The state of decoders that hold the value decoded last, for codes of the value itself instead of its changes.

/// The state of a decoder that holds the value decoded last until the next spike. Each scheme says which value it
/// starts from: population codes from the middle centre. 4 bytes in `f32`.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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

/// The methods of a [`Scheme`](crate::Scheme) whose decoder's state is [`Held`], and whose encoder's state counts the
/// samples that it rejects.
macro_rules! hold_value {
    ($State:ty) => {
        fn rejected(state: &$State) -> u32 {
            state.tally.rejected()
        }

        fn held(&self, state: &crate::scheme::held::Held<S>) -> Option<S> {
            Some(state.value())
        }

        fn resync(&self, state: &mut crate::scheme::held::Held<S>, value: S) {
            *state = crate::scheme::held::Held::at(value);
        }
    };
}
pub(super) use hold_value;
