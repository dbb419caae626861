//! Events, keyframes and breaks as C sees them.

use spikewire::{Event, Item, Keyframe, NeuronSpike, Polarity, SampleKind, Taken, Tick};

/// One neuron's spike within the code of one sample.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct CNeuronSpike {
    /// The neuron within its channel, from 0.
    pub neuron: u16,
    /// The sub-timestep within the sample, from 0.
    pub slot: u16,
    /// 1 or -1.
    pub polarity: i8,
}

/// When a sample was taken, and under which addresses its spikes go out.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Stamp {
    /// µs, wrapping.
    pub tick: u32,
    /// The length of a sub-timestep in µs; 0: all events of a sample have its tick.
    pub slot_ticks: u32,
    /// The address of the first channel's first neuron.
    pub first_address: u16,
}

/// What an item is.
pub(crate) mod kind {
    pub(crate) const EVENT: u8 = 0;
    pub(crate) const KEYFRAME: u8 = 1;
    pub(crate) const BREAK: u8 = 2;
    pub(crate) const HEARTBEAT: u8 = 3;
}

/// An event, a keyframe, a break or a heartbeat.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct CItem {
    /// µs, wrapping.
    pub tick: u32,
    /// A keyframe's sample, as its bits.
    pub bits: u32,
    /// How many items were lost before this one.
    pub lost: u32,
    /// The neuron.
    pub address: u16,
    /// What it is.
    pub kind: u8,
    /// A keyframe's sample type, as a link numbers them.
    pub sample_kind: u8,
    /// An event's direction, 1 or -1.
    pub polarity: i8,
}

const fn sign(polarity: Polarity) -> i8 {
    match polarity {
        Polarity::Up => 1,
        Polarity::Down => -1,
    }
}

pub(crate) const fn polarity(sign: i8) -> Polarity {
    if sign < 0 { Polarity::Down } else { Polarity::Up }
}

impl From<NeuronSpike> for CNeuronSpike {
    fn from(firing: NeuronSpike) -> Self {
        let NeuronSpike { neuron, slot, polarity } = firing;
        Self { neuron, slot, polarity: sign(polarity) }
    }
}

impl From<CNeuronSpike> for NeuronSpike {
    fn from(firing: CNeuronSpike) -> Self {
        let CNeuronSpike { neuron, slot, polarity: direction } = firing;
        Self { neuron, slot, polarity: polarity(direction) }
    }
}

impl From<Taken> for CItem {
    fn from(taken: Taken) -> Self {
        let Taken { lost, item } = taken;
        let tick = item.tick().micros();
        let none = Self {
            tick,
            bits: 0,
            lost,
            address: 0,
            kind: kind::BREAK,
            sample_kind: 0,
            polarity: 0,
        };
        match item {
            Item::Event(Event { address, polarity, .. }) => {
                Self { kind: kind::EVENT, address, polarity: sign(polarity), ..none }
            }
            Item::Keyframe(Keyframe { address, kind, bits, .. }) => {
                Self { kind: kind::KEYFRAME, address, bits, sample_kind: kind.to_byte(), ..none }
            }
            Item::Heartbeat { address, .. } => Self { kind: kind::HEARTBEAT, address, ..none },
            Item::Break(_) => none,
        }
    }
}

impl CItem {
    /// The item, unless there is no such kind.
    pub(crate) fn item(&self) -> Option<Item> {
        let Self { tick, bits, address, .. } = *self;
        let tick = Tick::from(tick);
        Some(match self.kind {
            kind::EVENT => Item::Event(Event { tick, address, polarity: polarity(self.polarity) }),
            kind::KEYFRAME => {
                let kind = SampleKind::from_byte(self.sample_kind)?;
                Item::Keyframe(Keyframe { tick, address, kind, bits })
            }
            kind::HEARTBEAT => Item::Heartbeat { tick, address },
            kind::BREAK => Item::Break(tick),
            _ => return None,
        })
    }
}
