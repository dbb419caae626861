//! The codes of the six channels, chosen by what a flight needs.
//!
//! Step forward, with one spike a sample, falls behind in flight: at 800 Hz and thresholds of 6 °/s and 0.05 g it follows
//! 4800 °/s² and 40 g/s. The recorded hexarotor, which ends in a crash, has up to 62 300 °/s² and 1116 g/s, and 1 g of
//! vibration at 200 Hz is 1257 g/s. So a sensor with 800 or 1000 samples a second has up to sixteen spikes a sample. Of
//! that flight, between its samples along straight lines to 800 a second (`tests/all/code.rs`):
//!
//! | | spikes a second | RMSE of rates, °/s | of accelerations, g | samples left behind | most spikes of all channels in a sample |
//! |---|--:|--:|--:|--:|--:|
//! | step forward, 6 °/s and 0.05 g | 860 | 13.1 | 0.31 | 5294 | 6 |
//! | this code, 6 °/s and 0.1 g | 713 | 2.3 | 0.04 | 0 | 43 |

use spikewire::temporal::SendOnDelta;

/// The most spikes that a channel has for a sample.
pub const MOST: usize = 16;

/// The code of a channel.
pub type Jumps = SendOnDelta<i16, MOST>;

/// A channel whose threshold is the sensor's count nearest to `value`, where `range` is what 2¹⁵ counts are.
pub const fn threshold(value: f32, range: f32) -> Jumps {
    SendOnDelta::new((value / range * 32_768.0 + 0.5) as i16)
}
