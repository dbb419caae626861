//! Weights and spikes drawn at random.

/// A generator of Marsaglia's kind.
pub const fn next(state: u32) -> u32 {
    let state = state ^ (state << 13);
    let state = state ^ (state >> 17);
    state ^ (state << 5)
}

/// Weights of 8 bits.
pub const fn bytes<const IN: usize, const OUT: usize>(mut state: u32) -> [[i8; OUT]; IN] {
    let mut rows = [[0; OUT]; IN];
    let mut row = 0;
    while row < IN {
        let mut column = 0;
        while column < OUT {
            state = next(state);
            rows[row][column] = (state >> 16) as i8;
            column += 1;
        }
        row += 1;
    }
    rows
}

/// Weights between -1 and 1.
pub const fn floats<const IN: usize, const OUT: usize>(mut state: u32) -> [[f32; OUT]; IN] {
    let mut rows = [[0.0; OUT]; IN];
    let mut row = 0;
    while row < IN {
        let mut column = 0;
        while column < OUT {
            state = next(state);
            rows[row][column] = (state >> 8) as f32 / 8_388_608.0 - 1.0;
            column += 1;
        }
        row += 1;
    }
    rows
}

/// Draws `some` of `all` numbers, and calls `chosen` with each, rising.
pub fn choose(state: &mut u32, some: usize, all: usize, mut chosen: impl FnMut(usize)) {
    let mut left = some;
    for number in 0..all {
        *state = next(*state);
        // As probable as those that are still wanted are among those that are left.
        if (*state >> 8) as usize % (all - number) < left {
            left -= 1;
            chosen(number);
        }
    }
}
