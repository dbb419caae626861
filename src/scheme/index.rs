//! Numbers of neurons and of slots that are known to be below a limit.

/// Defines a type of whole numbers below its parameter: two bytes, also as an `Option`.
macro_rules! index {
    ($(#[$doc:meta])* $Index:ident<$LIMIT:ident>, $format:tt) => {
        $(#[$doc])*
        ///
        /// Two bytes, also as an `Option`.
        #[derive(Clone, Copy, PartialEq, Eq, Hash)]
        pub struct $Index<const $LIMIT: usize>(core::num::NonZeroU16);

        impl<const $LIMIT: usize> $Index<$LIMIT> {
            /// The one with this index, if there is one.
            pub const fn new(index: u16) -> Option<Self> {
                if (index as usize) < $LIMIT { Self::counted(index.wrapping_add(1)) } else { None }
            }

            #[doc = concat!("Its index, 0 to `", stringify!($LIMIT), " - 1`.")]
            pub const fn index(self) -> u16 {
                self.0.get() - 1
            }

            /// The one with this number, from 1; `None` for 0.
            pub(super) const fn counted(number: u16) -> Option<Self> {
                match core::num::NonZeroU16::new(number) {
                    Some(number) => Some(Self(number)),
                    None => None,
                }
            }
        }

        impl<const $LIMIT: usize> core::fmt::Debug for $Index<$LIMIT> {
            fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
                f.debug_tuple(stringify!($Index)).field(&self.index()).finish()
            }
        }

        #[cfg(feature = "defmt")]
        impl<const $LIMIT: usize> defmt::Format for $Index<$LIMIT> {
            fn format(&self, f: defmt::Formatter<'_>) {
                defmt::write!(f, $format, self.index());
            }
        }

        /// Its index.
        #[cfg(feature = "serde")]
        impl<const $LIMIT: usize> serde::Serialize for $Index<$LIMIT> {
            fn serialize<Z: serde::Serializer>(&self, serializer: Z) -> Result<Z::Ok, Z::Error> {
                serializer.serialize_newtype_struct(stringify!($Index), &self.index())
            }
        }
    };
}
pub(super) use index;
