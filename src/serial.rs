//! Serialization that serde does not derive: arrays of any length, and structs without their inner structure.

use serde::ser::{SerializeSeq, SerializeStruct};
use serde::{Serialize, Serializer};

/// An array of any length; for `#[serde(with = …)]`.
pub(crate) mod array {
    use core::fmt::{Formatter, Result as Written};
    use core::marker::PhantomData;

    use bytemuck::Pod;
    use serde::de::{Deserialize, Deserializer, Error, SeqAccess, Visitor};
    use serde::{Serialize, Serializer};

    pub(crate) fn serialize<T: Serialize, S: Serializer, const N: usize>(
        items: &[T; N],
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(items)
    }

    /// Reads an array; refuses any other number of items.
    pub(crate) fn deserialize<
        'de,
        T: Pod + Deserialize<'de>,
        D: Deserializer<'de>,
        const N: usize,
    >(
        deserializer: D,
    ) -> Result<[T; N], D::Error> {
        deserializer.deserialize_seq(Items(PhantomData))
    }

    struct Items<T, const N: usize>(PhantomData<T>);

    impl<'de, T: Pod + Deserialize<'de>, const N: usize> Visitor<'de> for Items<T, N> {
        type Value = [T; N];

        fn expecting(&self, formatter: &mut Formatter) -> Written {
            write!(formatter, "{N} items")
        }

        fn visit_seq<A: SeqAccess<'de>>(self, mut sequence: A) -> Result<[T; N], A::Error> {
            let mut items = [T::zeroed(); N];
            for (seen, item) in items.iter_mut().enumerate() {
                let next = sequence.next_element()?;
                *item = next.ok_or_else(|| Error::invalid_length(seen, &self))?;
            }
            match sequence.next_element::<T>()? {
                None => Ok(items),
                Some(_) => Err(Error::invalid_length(N.wrapping_add(1), &self)),
            }
        }
    }
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
