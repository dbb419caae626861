//! Frames to events: every pixel sends the whole thresholds between its base and its sample.
//!
//! The base is the sample, or the level of its logarithm. All in whole numbers.

/// How the pixels of a camera fire.
#[derive(Clone, Debug)]
pub(crate) struct FrameLaw {
    /// What each sample from 0 to 255 is as a base.
    pub(crate) bases: Vec<i64>,
    /// The threshold upwards.
    pub(crate) on: i64,
    /// The threshold downwards.
    pub(crate) off: i64,
    /// The most events of a pixel and frame.
    pub(crate) most: i64,
    /// The frames of silence after one with events.
    pub(crate) refractory: u32,
    /// The most events of a frame.
    pub(crate) budget: Option<i64>,
}

/// What became of a frame.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FrameOutcome {
    /// The events of every pixel, negative if they go down.
    pub(crate) counts: Vec<i64>,
    /// The bases after the frame.
    pub(crate) bases: Vec<i64>,
    /// Events that were due and beyond the budget.
    pub(crate) kept_back: i64,
}

/// Samples as they are, with one threshold.
pub(crate) fn frame_intensity(threshold: i64, most: i64) -> FrameLaw {
    let bases = (0..256).collect();
    FrameLaw { bases, on: threshold, off: threshold, most, refractory: 0, budget: None }
}

/// Levels of a logarithm, so many for a factor of e.
pub(crate) fn frame_log(scale: i64, on: i64, off: i64, most: i64) -> FrameLaw {
    let bases = (0..256).map(|sample| log_level(scale, sample)).collect();
    FrameLaw { bases, on, off, most, refractory: 0, budget: None }
}

/// Linear up to 20, rounded half up.
fn log_level(scale: i64, sample: i64) -> i64 {
    let v = sample as f64;
    let f = if v <= 20.0 { v * 20_f64.ln() / 20.0 } else { v.ln() };
    (scale as f64 * f + 0.5).floor() as i64
}

/// All frames, row-major. The first sets the bases, and has no events.
pub(crate) fn frame_events(law: &FrameLaw, frames: &[Vec<u8>]) -> Vec<FrameOutcome> {
    let Some(first) = frames.first() else { return Vec::new() };
    let level = |sample: u8| law.bases[usize::from(sample)];
    let mut bases: Vec<i64> = first.iter().map(|&sample| level(sample)).collect();
    let mut silent = vec![0; first.len()];
    let nothing = FrameOutcome { counts: vec![0; first.len()], bases: bases.clone(), kept_back: 0 };
    let mut outcomes = vec![nothing];
    for frame in &frames[1..] {
        let mut left = law.budget.unwrap_or(i64::MAX);
        let mut kept_back = 0;
        let mut counts = vec![0; frame.len()];
        for (pixel, &sample) in frame.iter().enumerate() {
            if silent[pixel] > 0 {
                silent[pixel] -= 1;
                continue;
            }
            let away = level(sample) - bases[pixel];
            // Strictly: n events where n thresholds lie below, and do not reach, the sample.
            let due = if away > 0 { (away - 1) / law.on } else { -((-away - 1).max(0) / law.off) };
            let due = due.clamp(-law.most, law.most);
            let sent = due.clamp(-left, left);
            left -= sent.abs();
            kept_back += (due - sent).abs();
            bases[pixel] += sent * if sent > 0 { law.on } else { law.off };
            if sent != 0 {
                silent[pixel] = law.refractory;
            }
            counts[pixel] = sent;
        }
        outcomes.push(FrameOutcome { counts, bases: bases.clone(), kept_back });
    }
    outcomes
}

/// The events of a frame in their order, each with its time, its pixel and its sign: event j of n in the slot
/// ⌈(j+1)K/n⌉-1 of K, whose time is `before + ⌊(slot+1)(now-before)/K⌋`.
pub(crate) fn frame_interpolated(
    counts: &[i64],
    most: i64,
    before: i64,
    now: i64,
) -> Vec<(i64, usize, i64)> {
    let mut events = Vec::new();
    for (pixel, &count) in counts.iter().enumerate() {
        let n = count.abs();
        for j in 0..n {
            let slot = ((j + 1) * most + n - 1) / n - 1;
            events.push((slot, pixel, count.signum()));
        }
    }
    events.sort_unstable();
    let time = |slot: i64| before + (slot + 1) * (now - before) / most;
    events.into_iter().map(|(slot, pixel, sign)| (time(slot), pixel, sign)).collect()
}

/// The sample that a base stands for: how many neighbours' middles lie below it.
pub(crate) fn frame_value(law: &FrameLaw, base: i64) -> u8 {
    law.bases.windows(2).filter(|pair| 2 * base > pair[0] + pair[1]).count() as u8
}

/// v2e's model of a dynamic vision sensor without noise, leak, filter and refractory period (`v2ecore`, Hu, Liu,
/// Delbruck 2021): the events of every pixel and frame, in single precision as there. It fires where a threshold is
/// reached, and as often as it is.
pub(crate) fn v2e_events(frames: &[Vec<u8>], on: f32, off: f32) -> Vec<Vec<i64>> {
    let lin_log = |sample: u8| {
        let x = f64::from(sample);
        let y = if x <= 20.0 { x * (1.0 / 20.0 * 20_f64.ln()) } else { x.ln() };
        ((y * 1e8).round_ties_even() / 1e8) as f32
    };
    let Some(first) = frames.first() else { return Vec::new() };
    let mut bases: Vec<f32> = first.iter().map(|&sample| lin_log(sample)).collect();
    let mut all = vec![vec![0; first.len()]];
    for frame in &frames[1..] {
        let count = |(base, &sample): (&mut f32, &u8)| {
            let away = lin_log(sample) - *base;
            let ups = (away.max(0.0) / on).floor();
            let downs = ((-away).max(0.0) / off).floor();
            *base += ups * on;
            *base -= downs * off;
            ups as i64 - downs as i64
        };
        all.push(bases.iter_mut().zip(frame).map(count).collect());
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn worked_by_hand() {
        let law = frame_intensity(10, 4);
        let frames = [vec![100, 100, 0, 255], vec![103, 95, 255, 20]];
        let outcomes = frame_events(&law, &frames);
        assert_eq!(outcomes[1].counts, [0, 0, 4, -4]);
        assert_eq!(outcomes[1].bases, [100, 100, 40, 215]);

        let law = frame_log(1024, 205, 205, 9);
        let outcomes = frame_events(&law, &[vec![100], vec![150]]);
        assert_eq!(outcomes[1].counts, [2]);
        assert_eq!(frame_value(&law, outcomes[1].bases[0]), 149);
        assert_eq!(law.bases.iter().sum::<i64>(), 1_178_453);
        assert_eq!(frame_log(46, 9, 9, 1).bases.iter().sum::<i64>(), 52_936);
    }

    #[test]
    fn slots_of_a_frame() {
        // Two of four fall into the slots 1 and 3, one into 3, four into all.
        let events = frame_interpolated(&[2, 0, -1, 4], 4, 1000, 1010);
        let expected = [
            (1002, 3, 1),
            (1005, 0, 1),
            (1005, 3, 1),
            (1007, 3, 1),
            (1010, 0, 1),
            (1010, 2, -1),
            (1010, 3, 1),
        ];
        assert_eq!(events, expected);
    }
}
