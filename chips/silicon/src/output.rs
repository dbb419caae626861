//! The output bus of tinyODIN and ODIN, with its 4-phase handshake: the chip raises REQ, the receiver raises ACK, REQ
//! falls, ACK falls. The chip does nothing else meanwhile.

/// The state of the output bus.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Output {
    acknowledge: [bool; 3],
    /// The neuron that fired.
    pub address: u8,
    /// Level of REQ.
    pub request: bool,
    /// Whether the controller must wait because a handshake is under way.
    pub is_busy: bool,
}

impl Output {
    /// Advances by one clock cycle. `acknowledge` is the level of ACK; `spike` is the neuron of a new spike, if there
    /// is one.
    pub fn clock(&mut self, acknowledge: bool, spike: Option<u8>) {
        let [first, now, before] = self.acknowledge;
        match spike {
            Some(address) if !now => {
                (self.address, self.request, self.is_busy) = (address, true, true);
            }
            _ if now => (self.request, self.is_busy) = (false, true),
            _ if before => (self.request, self.is_busy) = (false, false),
            _ => {}
        }
        self.acknowledge = [acknowledge, first, now];
    }
}
