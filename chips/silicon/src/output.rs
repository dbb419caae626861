//! The output bus: REQ up, the receiver's ACK up, REQ down, ACK down. The chip stands still meanwhile.

/// What the bus holds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Output {
    acknowledge: [bool; 3],
    /// The neuron that fired.
    pub address: u8,
    /// REQ.
    pub request: bool,
    /// Holds the controller.
    pub is_busy: bool,
}

impl Output {
    /// A clock, with ACK and the spike that comes now.
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
