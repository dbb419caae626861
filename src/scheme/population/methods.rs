//! Methods that the population codes share, as macros.

/// The methods of a [`Scheme`](crate::Scheme) that follow from its `centres` and the state of its encoder.
macro_rules! centred {
    ($State:ty) => {
        crate::scheme::held::hold_value!($State);

        /// The middle centre.
        fn decoder_state(&self) -> crate::population::Held<S> {
            let centres = self.centres();
            crate::population::Held::at(centres.get(centres.len() / 2).copied().unwrap_or(S::ZERO))
        }

        fn neurons(&self) -> usize {
            self.centres().len()
        }
    };
}
pub(super) use centred;

/// The encoding methods of a [`Scheme`](crate::Scheme) whose `encode_into` fills an empty code.
macro_rules! encode_in_place {
    ($State:ty, $Code:ty) => {
        #[inline]
        fn encode(&self, state: &mut $State, sample: S) -> $Code {
            let mut code = <$Code>::EMPTY;
            self.encode_into(state, sample, &mut code);
            code
        }

        fn encode_slice(
            &self,
            state: &mut $State,
            samples: &[S],
            outputs: &mut [impl crate::Destination<$Code>],
        ) -> usize {
            for (output, &sample) in outputs.iter_mut().zip(samples) {
                output.write_with(<$Code>::EMPTY, |code| self.encode_into(state, sample, code));
            }
            samples.len().min(outputs.len())
        }
    };
}
pub(super) use encode_in_place;

/// The methods that begin an encoder of any size, whose first state is the same for all.
#[cfg(feature = "alloc")]
macro_rules! begin {
    ($State:ty) => {
        /// The state of an encoder before its first sample.
        pub fn state(&self) -> $State {
            <$State>::START
        }

        /// An encoder in its initial state.
        pub fn encoder(&self) -> crate::Encoder<'_, Self> {
            crate::Encoder::with_state(self, self.state())
        }
    };
}
#[cfg(feature = "alloc")]
pub(super) use begin;
