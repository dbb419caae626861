//! Serialization that serde does not derive: arrays of any length, and structs that leave out their inner structure.

use serde::ser::{SerializeSeq, SerializeStruct};
use serde::{Serialize, Serializer};

/// Serializes an array of any length; for `#[serde(serialize_with = …)]`.
pub(crate) fn array<T: Serialize, S: Serializer, const N: usize>(
    items: &[T; N],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(items)
}

/// Serializes a sequence. It is counted first, as compact formats write the length before the items.
pub(crate) fn sequence<I, S>(items: impl Fn() -> I, serializer: S) -> Result<S::Ok, S::Error>
where
    I: Iterator<Item: Serialize>,
    S: Serializer,
{
    let mut sequence = serializer.serialize_seq(Some(items().count()))?;
    for item in items() {
        sequence.serialize_element(&item)?;
    }
    sequence.end()
}

/// Serializes a struct of these fields.
pub(crate) fn fields<A: Serialize, B: Serialize, C: Serialize, S: Serializer>(
    name: &'static str,
    (first, a): (&'static str, &A),
    (second, b): (&'static str, &B),
    (third, c): (&'static str, &C),
    serializer: S,
) -> Result<S::Ok, S::Error> {
    let mut fields = serializer.serialize_struct(name, 3)?;
    fields.serialize_field(first, a)?;
    fields.serialize_field(second, b)?;
    fields.serialize_field(third, c)?;
    fields.end()
}
