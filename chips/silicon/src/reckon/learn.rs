//! Learning on the chip, by eligibility propagation (e-prop), with weights that change by 1 at random.

use super::chip::{Clocked, Pair, ReckOn, State};
use super::lfsr::Bits;

/// The access to a memory of weights in a clock cycle; `None` if there is no access. Contains the address and, for a
/// write, the word to write and the mask of the bits that change.
type Access = Option<(usize, Option<(u128, u128)>)>;

/// The results of learning in one clock cycle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Learning {
    neuron: (bool, u8),
    pub(super) input_weights: Access,
    pub(super) recurrent_weights: Access,
    pub(super) output_weights: Access,
    /// For each of three kinds of weights (from inputs, between neurons, and to outputs), whether this clock cycle uses
    /// random numbers for it.
    pub(super) draws: [bool; 3],
    /// Slope of the surrogate gradient at the neuron's potential.
    slope: i8,
    signal: i16,
    regularised: u16,
}

/// A word of weights, and the random numbers that decide which of its weights change.
struct Move<'a> {
    weights: u128,
    random: &'a Bits,
    bits: u32,
    shift_right: u32,
    shift_left: u32,
}

impl Move<'_> {
    /// Returns the new word of weights, and a mask of the weights that change. `likely` takes the index of a weight in
    /// the word. It returns a measure of how likely this weight is to rise (if positive) or to fall (if negative), and
    /// whether the weight may change at all.
    fn apply(&self, likely: impl Fn(usize) -> (i32, bool)) -> (u128, u128) {
        let (mut data, mut mask) = (0, 0);
        for n in 0..16 {
            let (likely, is_enabled) = likely(n);
            let most = (1_u64 << self.bits) - 1;
            let weight = (self.weights >> (8 * n)) as i8;
            let is_lowest = likely == i32::MIN >> (32 - self.bits);
            let size = (u64::from(likely.unsigned_abs()) & most) << self.shift_left;
            let size = if size > most { most } else { size } >> self.shift_right;
            let moves =
                is_enabled && likely != 0 && (is_lowest || size >= self.draw(n as u32 * self.bits));
            let next = weight.saturating_add(if likely < 0 { -1 } else { 1 });
            let byte = if moves { next } else { weight };
            data |= u128::from(byte as u8) << (8 * n);
            mask |= (u128::from(moves) * 0xFF) << (8 * n);
        }
        (data, mask)
    }

    fn draw(&self, start: u32) -> u64 {
        let word = |at: u32| u128::from(*self.random.get(at as usize).unwrap_or(&0));
        let wide = word(start / 64) | word(start / 64 + 1) << 64;
        (wide >> (start % 64)) as u64 & ((1 << self.bits) - 1)
    }
}

const fn post(now: &Clocked) -> u8 {
    now.post_high << 4 | now.post_low >> 1
}

impl ReckOn {
    /// Returns whether this is the last clock cycle of learning.
    pub(super) fn learns_last(&self) -> bool {
        let now = &self.now;
        let last = self.register(95) as u8;
        if self.register(9) == 4 {
            post(now) == last && now.post_low & 1 == 1
        } else {
            now.post_high == last >> 4 && self.is_last_source()
        }
    }

    fn is_last_source(&self) -> bool {
        self.now.pre >> 1 == u16::from(self.last_source()) && self.now.pre & 1 == 1
    }

    /// Returns the difference between the target and the value of output `k`.
    fn error(&self, k: usize) -> i16 {
        if self.register(9) == 0 || !self.now.target_valid[1] || k as u32 > self.register(96) {
            return 0;
        }
        let potential = i32::from(self.now.outputs[k]);
        let y = match potential {
            _ if self.flag(27) => potential,
            2048.. => 2048,
            ..-2048 => 0,
            _ => (potential + 2048) >> 1,
        };
        let target = if self.flag(25) {
            i32::from(self.now.targets[k])
        } else {
            i32::from(usize::from(self.now.label) == k) * 2048
        };
        (target - y).clamp(i16::MIN.into(), i16::MAX.into()) as i16
    }

    /// Returns the learning signal of the current neuron: the sum of the outputs' errors, each times the weight from
    /// the neuron to that output.
    fn signal(&self) -> i16 {
        if self.register(9) & 3 == 0 {
            return 0;
        }
        let weight = |k: usize| i64::from((self.now.output_weights >> (8 * k)) as i8);
        let outputs = 0..=self.register(96) as usize;
        let sum: i64 = outputs.map(|k| i64::from(self.error(k)) * weight(k)).sum();
        (sum << self.register(18) >> 12).clamp(i16::MIN.into(), i16::MAX.into()) as i16
    }

    fn signed(&self, register: usize) -> i16 {
        self.register(register) as i16
    }
}

impl Learning {
    #[allow(clippy::too_many_lines, reason = "a clock is one thing")]
    pub(super) fn new(chip: &ReckOn, pair: &Pair) -> Self {
        let now = &chip.now;
        let register = |at| chip.register(at);
        let (is_learning, is_buffering) = (now.state == State::Learn, now.is_buffering);
        let (modes, is_valid) = (register(19), now.target_valid[1]);
        let is_odd = now.post_low & 1 == 1;
        let own = usize::from(now.post_low >> 1 & 1);
        let is_slope = is_learning && is_buffering;
        let slope = if is_odd && is_slope {
            let step = (70..74).position(|at| pair.potential[own] < chip.signed(at));
            ((register(74 + step.unwrap_or(4)) << 3) as i8) >> 3
        } else {
            0
        };
        let trace = pair.recurrent_trace[own] >> register(16);
        let above = trace.wrapping_sub(register(98) as u16) & 0xFFF;
        let mut learning = Self {
            neuron: (false, 0),
            input_weights: None,
            recurrent_weights: None,
            output_weights: None,
            draws: [false; 3],
            slope,
            signal: 0,
            regularised: if above > trace { 0 } else { above },
        };
        if !is_learning {
            return learning;
        }
        let post = post(now);
        if is_odd && post <= register(95) as u8 {
            learning.signal = chip.signal();
        }
        let (last, most) = (u16::from(chip.last_source()), register(95) as u16);
        let pre = now.pre >> 1;
        learning.neuron = if is_buffering {
            (u16::from(post) <= last && is_valid && now.post_low & 3 == 0, post >> 1)
        } else {
            (pre <= last && is_valid && now.pre & 3 == 0, (now.pre >> 2) as u8)
        };
        if is_buffering {
            let trace = pair.output_trace[own] >> register(17);
            let is_skipped = is_odd && trace == 0;
            let is = !is_skipped && u16::from(post) <= most && is_valid && register(9) != 0;
            learning.draws[2] = is && is_odd && register(9) & 4 != 0;
            let write = learning.draws[2].then(|| {
                let step = Move {
                    weights: now.output_weights,
                    random: &now.output_random.bits(),
                    bits: 28,
                    shift_right: register(83),
                    shift_left: register(84),
                };
                step.apply(|k| (i32::from(chip.error(k)) * i32::from(trace), true))
            });
            learning.output_weights = is.then_some((post.into(), write));
            return learning;
        }
        let rests = modes == 0 || now.regularised.iter().all(|&trace| trace == 0);
        let at = usize::from(now.pre & 2 != 0);
        let is_write = now.pre & 1 == 1;
        let address = usize::from(pre) << 4 | usize::from(now.post_high);
        let traces =
            [pair.input_trace[at] >> register(15), pair.recurrent_trace[at] >> register(16)];
        let lasts = [register(94) as u16, most];
        for n in 0..2 {
            let is_regularised = register(20) >> n & 1 == 1;
            let is_due = is_valid || modes >> 1 == 3 && is_regularised;
            let is_skipped = is_write && traces[n] == 0 && rests;
            if is_skipped || pre > lasts[n] || !is_due || register(9) >> n & 1 == 0 {
                continue;
            }
            learning.draws[n] = is_write;
            let write = is_write.then(|| {
                let (weights, random) = if n == 0 {
                    (now.input_weights, now.input_random.bits())
                } else {
                    (now.recurrent_weights, now.recurrent_random.bits())
                };
                let step = Move {
                    weights,
                    random: &random,
                    bits: 32,
                    shift_right: register(79 + 2 * n),
                    shift_left: register(80 + 2 * n),
                };
                let (mut data, mask) = step.apply(|lane| {
                    likely(chip, n, lane, traces[n], is_valid, modes != 0 && is_regularised)
                });
                if n == 1 && pre >> 4 == u16::from(now.post_high) {
                    data &= !(0xFF << (8 * (pre & 15)));
                }
                (data, mask)
            });
            let access = Some((address, write));
            if n == 0 {
                learning.input_weights = access;
            } else {
                learning.recurrent_weights = access;
            }
        }
        learning
    }

    pub(super) const fn neuron(&self) -> (bool, u8) {
        self.neuron
    }

    /// Advances the counters of learning. Stores the current neuron's slope of the surrogate gradient and its learning
    /// signal. The chip holds these values for sixteen neurons at a time.
    pub(super) fn clock(&self, chip: &ReckOn, new: &mut Clocked, next: State) {
        let now = &chip.now;
        let only_outputs = chip.register(9) == 4;
        let is_last_post = now.post_low == 31;
        if now.state != State::Learn && next == State::Learn {
            (new.pre, new.post_high, new.post_low, new.is_buffering) = (0, 0, 0, true);
        } else if now.state == State::Learn && now.is_buffering {
            new.post_low = (now.post_low + 1) & 31;
            if only_outputs && is_last_post {
                new.post_high = (now.post_high + 1) & 15;
            }
            new.is_buffering = only_outputs || !is_last_post;
        } else if now.state == State::Learn {
            let is_last = chip.is_last_source();
            new.pre = if is_last { 0 } else { (now.pre + 1) & 511 };
            new.post_high = (now.post_high + u8::from(is_last)) & 15;
            new.is_buffering = is_last;
        }
        if now.post_low & 1 == 1 {
            let at = usize::from(now.post_low >> 1);
            new.slopes[at] = self.slope;
            if chip.register(19) != 0 {
                new.regularised[at] = self.regularised;
            }
            if now.state == State::Learn {
                new.signals[at] = self.signal;
            }
        }
    }
}

/// Returns a measure of how likely a weight is to change, and whether the weight may change at all. The measure is
/// positive if the weight would rise, and negative if the weight would fall.
///
/// `n` is 0 for a weight from an input, and 1 for a weight from a neuron. `trace` is the trace of this input or neuron
/// (a measure of its recent spikes). `lane` is the index of the receiving neuron among the sixteen neurons of a word of
/// weights. `is_valid` tells whether `TARGET_VALID` is high. `is_regularised` tells whether weights of this kind also
/// change to limit how often neurons fire.
fn likely(
    chip: &ReckOn,
    n: usize,
    lane: usize,
    trace: u16,
    is_valid: bool,
    is_regularised: bool,
) -> (i32, bool) {
    let now = &chip.now;
    let register = |at| chip.register(at);
    let (modes, which) = (register(19), register(20));
    let above = u32::from(now.regularised[lane]);
    let is_enabled = is_valid && now.slopes[lane] != 0;
    let signal = i32::from(now.signals[lane]);
    let product = signal.wrapping_mul(trace.into()).wrapping_mul(now.slopes[lane].into());
    let product = if is_enabled { product } else { 0 };
    let additive = if modes & 2 != 0 && which >> n & 1 == 1 {
        (above << register(100 + 2 * n) >> register(99 + 2 * n)) as i32
    } else {
        0
    };
    let factor = if modes & 1 == 0 || which == 0 {
        16
    } else {
        16_u32.saturating_sub(above >> register(103))
    };
    let factor = if product < 0 { 16 } else { factor };
    let scaled = i64::from(product) * i64::from(factor);
    let sum = ((scaled >> 4) as i32).wrapping_sub(additive);
    let sum = if sum >= 0 && scaled >> 31 & 1 == 1 { i32::MIN } else { sum };
    (sum, is_enabled || is_regularised)
}
