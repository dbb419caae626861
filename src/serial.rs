//! What serde does not derive: arrays of any length, written as sequences.

use serde::{Serialize, Serializer, ser::SerializeSeq};

/// For `#[serde(serialize_with = …)]`.
pub(crate) fn array<T: Serialize, S: Serializer, const N: usize>(
    items: &[T; N],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(items)
}

/// A sequence whose length is counted first: compact formats write it before the items.
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
