//! Vectors: whether the core has them, and the groups of neighbouring samples that fill them.

/// Whether the core has vector registers, in which the compiler lets loops over neighbouring samples run several
/// samples at a time. `cargo verify scalar` tests the loops of cores that have none: `--cfg without_vectors`.
pub(crate) const HAS_VECTORS: bool = !cfg!(without_vectors)
    && cfg!(any(target_feature = "sse2", target_feature = "neon", target_feature = "simd128"));

/// Groups of `N` items and what is left at the end; no groups on a core without vectors.
#[inline]
pub(crate) fn groups<T, const N: usize>(items: &[T]) -> (&[[T; N]], &[T]) {
    if HAS_VECTORS { items.as_chunks() } else { (&[], items) }
}

/// [`groups`] that can be written to.
#[inline]
pub(crate) fn groups_mut<T, const N: usize>(items: &mut [T]) -> (&mut [[T; N]], &mut [T]) {
    if HAS_VECTORS { items.as_chunks_mut() } else { (&mut [], items) }
}
