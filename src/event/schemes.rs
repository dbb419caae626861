//! The schemes of `N` channels: one that all share, or one for each.

use core::fmt;

use crate::Scheme;

/// One scheme for all of `N` channels, `&SCHEME`, or one for each, `[&FIRST, &SECOND]`. Sealed.
pub trait Schemes<const N: usize>: sealed::Sealed {
    /// The type of the schemes.
    type Scheme: Scheme;

    /// The channels: a state for each, next to the channel's own scheme if there is one.
    type Channels<D>;

    /// The channels, with the states that `make` returns.
    fn channels<D>(self, make: impl FnMut(&Self::Scheme) -> D) -> Self::Channels<D>;

    /// The scheme and the state of each channel, in their order.
    fn each<'a, D: 'a>(
        channels: &'a Self::Channels<D>,
    ) -> impl Iterator<Item = (&'a Self::Scheme, &'a D)>
    where
        Self: 'a;

    /// The scheme and the state of each channel, in their order.
    fn each_mut<'a, D: 'a>(
        channels: &'a mut Self::Channels<D>,
    ) -> impl Iterator<Item = (&'a Self::Scheme, &'a mut D)>
    where
        Self: 'a;
}

mod sealed {
    pub trait Sealed {}
    impl<P> Sealed for &P {}
    impl<P, const N: usize> Sealed for [&P; N] {}
}

impl<'p, P: Scheme, const N: usize> Schemes<N> for &'p P {
    type Scheme = P;
    type Channels<D> = (&'p P, [D; N]);

    fn channels<D>(self, mut make: impl FnMut(&P) -> D) -> Self::Channels<D> {
        (self, [(); N].map(|()| make(self)))
    }

    #[inline]
    fn each<'a, D: 'a>(
        (scheme, states): &'a Self::Channels<D>,
    ) -> impl Iterator<Item = (&'a P, &'a D)>
    where
        Self: 'a,
    {
        states.iter().map(|state| (*scheme, state))
    }

    #[inline]
    fn each_mut<'a, D: 'a>(
        (scheme, states): &'a mut Self::Channels<D>,
    ) -> impl Iterator<Item = (&'a P, &'a mut D)>
    where
        Self: 'a,
    {
        states.iter_mut().map(|state| (*scheme, state))
    }
}

impl<'p, P: Scheme, const N: usize> Schemes<N> for [&'p P; N] {
    type Scheme = P;
    /// A scheme and its state lie side by side, which takes one load where two arrays take two.
    type Channels<D> = [(&'p P, D); N];

    fn channels<D>(self, mut make: impl FnMut(&P) -> D) -> Self::Channels<D> {
        self.map(|scheme| (scheme, make(scheme)))
    }

    #[inline]
    fn each<'a, D: 'a>(channels: &'a Self::Channels<D>) -> impl Iterator<Item = (&'a P, &'a D)>
    where
        Self: 'a,
    {
        channels.iter().map(|(scheme, state)| (*scheme, state))
    }

    #[inline]
    fn each_mut<'a, D: 'a>(
        channels: &'a mut Self::Channels<D>,
    ) -> impl Iterator<Item = (&'a P, &'a mut D)>
    where
        Self: 'a,
    {
        channels.iter_mut().map(|(scheme, state)| (*scheme, state))
    }
}

/// The states of channels, for `Debug`.
pub(crate) struct States<'a, T: Schemes<N>, D, const N: usize>(pub(crate) &'a T::Channels<D>);

impl<T: Schemes<N>, D: fmt::Debug, const N: usize> fmt::Debug for States<'_, T, D, N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(T::each(self.0).map(|(_, state)| state)).finish()
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
