//! The code of the six channels, chosen by what a flight needs.
//!
//! Step forward, with one spike a sample, falls behind in flight: at 800 Hz and thresholds of 6 °/s and 0.05 g it follows
//! 4800 °/s² and 40 g/s. The recorded hexarotor, which ends in a crash, has up to 62 300 °/s² and 1116 g/s, and 1 g of
//! vibration at 200 Hz is 1257 g/s. So a sample has up to sixteen spikes here. Of that flight, between its samples along
//! straight lines to 800 a second (`tests/all/code.rs`):
//!
//! | | spikes a second | RMSE of rates, °/s | of accelerations, g | samples left behind | most spikes of all channels in a sample |
//! |---|--:|--:|--:|--:|--:|
//! | step forward, 6 °/s and 0.05 g | 860 | 13.1 | 0.31 | 5294 | 6 |
//! | this code, 6 °/s and 0.1 g | 713 | 2.3 | 0.04 | 0 | 43 |

use spikewire::temporal::SendOnDelta;

/// The most spikes that a channel has for a sample.
pub const MOST: usize = 16;

/// A spike for every 6 °/s; up to 76 800 °/s² at 800 samples a second.
pub static RATE: SendOnDelta<f32, MOST> = SendOnDelta::new(6.0);

/// A spike for every 0.1 g; up to 1280 g/s at 800 samples a second.
pub static ACCELERATION: SendOnDelta<f32, MOST> = SendOnDelta::new(0.1);

/// Those of six channels.
pub type Schemes<S = f32> = [&'static SendOnDelta<S, MOST>; 6];

/// Rates about x, y and z, in °/s, then accelerations along them, in g.
pub const SCHEMES: Schemes = [&RATE, &RATE, &RATE, &ACCELERATION, &ACCELERATION, &ACCELERATION];
