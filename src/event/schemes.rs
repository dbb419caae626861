//! The schemes of `N` channels: one that all share, or one for each.

use crate::Scheme;

/// One scheme for all of `N` channels, `&SCHEME`, or one for each, `[&FIRST, &SECOND]`. Sealed.
pub trait Schemes<const N: usize>: sealed::Sealed {
    /// The type of the schemes.
    type Scheme: Scheme;

    /// The schemes, in the order of the channels.
    fn each(&self) -> impl Iterator<Item = &Self::Scheme>;

    /// The results of `make` for each scheme, in the order of the channels.
    fn map_each<R>(&self, make: impl FnMut(&Self::Scheme) -> R) -> [R; N];
}

mod sealed {
    pub trait Sealed {}
    impl<P> Sealed for &P {}
    impl<P, const N: usize> Sealed for [&P; N] {}
}

impl<P: Scheme, const N: usize> Schemes<N> for &P {
    type Scheme = P;

    #[inline]
    fn each(&self) -> impl Iterator<Item = &P> {
        core::iter::repeat_n(*self, N)
    }

    fn map_each<R>(&self, mut make: impl FnMut(&P) -> R) -> [R; N] {
        [(); N].map(|()| make(self))
    }
}

impl<P: Scheme, const N: usize> Schemes<N> for [&P; N] {
    type Scheme = P;

    #[inline]
    fn each(&self) -> impl Iterator<Item = &P> {
        self.iter().copied()
    }

    fn map_each<R>(&self, make: impl FnMut(&P) -> R) -> [R; N] {
        self.map(make)
    }
}

/// The sample type of the schemes.
pub(crate) type SampleOf<T, const N: usize> = <<T as Schemes<N>>::Scheme as Scheme>::Sample;
/// The code of one sample.
pub(crate) type CodeOf<T, const N: usize> = <<T as Schemes<N>>::Scheme as Scheme>::Code;
/// The state of an encoder.
pub(crate) type EncoderStateOf<T, const N: usize> =
    <<T as Schemes<N>>::Scheme as Scheme>::EncoderState;
/// The state of a decoder.
pub(crate) type DecoderStateOf<T, const N: usize> =
    <<T as Schemes<N>>::Scheme as Scheme>::DecoderState;
