//! Joints: banks that share a link, and the receivers at its far end, with addresses of their own and one fingerprint.

use crate::error::within;
use crate::event::{Bank, Schemes};
use crate::{ConfigError, Fingerprint};

/// What takes a range of a link's addresses: a [`Bank`](crate::Bank) at one end, a [`Receiver`](super::Receiver) at the other.
pub trait Part {
    /// How many addresses it takes.
    fn addresses(&self) -> usize;

    /// Sets its first address.
    fn set_first_address(&mut self, first_address: u16);

    /// The fingerprint of its schemes at its addresses, the same at both ends.
    fn fingerprint(&self) -> Fingerprint;

    /// Checks that it may be sampled every `period` µs.
    ///
    /// # Errors
    /// Returns an error if its parameters are those of another period.
    fn check_period(&self, _period: u32) -> Result<(), ConfigError> {
        Ok(())
    }

    /// Takes note of the parts that it is joined with.
    fn join(&mut self, _joint: Joint) {}
}

impl<T: Schemes<N>, const N: usize> Part for Bank<T, N> {
    fn addresses(&self) -> usize {
        self.addresses()
    }

    fn set_first_address(&mut self, first_address: u16) {
        self.set_first_address(first_address);
    }

    fn fingerprint(&self) -> Fingerprint {
        self.fingerprint()
    }

    fn check_period(&self, period: u32) -> Result<(), ConfigError> {
        self.check_period(period)
    }
}

/// What parts have in common that are [joined](join).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Joint {
    addresses: u32,
    fingerprint: Fingerprint,
}

impl Joint {
    /// How many addresses the parts take, from 0 on.
    pub const fn addresses(self) -> u32 {
        self.addresses
    }

    /// The fingerprint of all parts: see its [specification](Fingerprint#specification).
    pub const fn fingerprint(self) -> Fingerprint {
        self.fingerprint
    }
}

/// Joins what shares a link, once, before it is used: each part gets the addresses after those of the part before, and knows
/// the fingerprint of all. Join banks by [`Transmitter::for_banks`](super::Transmitter::for_banks), and their receivers by
/// this, in the same order: in another order the fingerprint is another one, and no value is exact.
///
/// ```
/// use spikewire::link::{Receiver, Session, Transmitter, join};
/// use spikewire::{Bank, temporal::{SendOnDelta, StepForward}};
///
/// static RATES: StepForward<i16> = StepForward::new(120);
/// static FORCES: SendOnDelta<i16, 16> = SendOnDelta::new(40);
///
/// let (mut gyro, mut accel) = (Bank::<_, 3>::new(&RATES), Bank::<_, 3>::new(&FORCES));
/// let link = Transmitter::for_banks(&mut [&mut gyro, &mut accel], 1_000, Session::counted(7))?;
///
/// // At the far end:
/// let (mut gyro, mut accel) = (Receiver::<_, 3>::new(&RATES), Receiver::<_, 3>::new(&FORCES));
/// let joint = join(&mut [&mut gyro, &mut accel])?;
/// assert_eq!(joint.addresses(), 6);
/// assert_eq!(gyro.fingerprint(), accel.fingerprint());
/// # let _ = link;
/// # Ok::<(), spikewire::ConfigError>(())
/// ```
///
/// # Errors
/// Returns an error if there is no part, or if the parts take more than 65 536 addresses.
pub fn join(parts: &mut [&mut dyn Part]) -> Result<Joint, ConfigError> {
    let addresses = parts.iter().map(|part| part.addresses()).fold(0, usize::saturating_add);
    within("addresses of all parts", addresses as f64, 1.0, 65_536.0)?;
    // A name first: with one fingerprint right after the other, their order would not matter.
    let mut joint = Joint { addresses: 0, fingerprint: Fingerprint::new("Joint") };
    for part in &mut *parts {
        part.set_first_address(joint.addresses as u16);
        joint.addresses = joint.addresses.wrapping_add(part.addresses() as u32);
        joint.fingerprint = joint.fingerprint.and(part.fingerprint());
    }
    joint.fingerprint = joint.fingerprint.number(parts.len() as u32);
    for part in parts {
        part.join(joint);
    }
    Ok(joint)
}
