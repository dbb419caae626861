//! The figures of Tables I and II, as the paper prints them.

/// The benchmark's cases: durations of the signals, in seconds.
pub const CASES: [usize; 5] = [1, 5, 15, 50, 100];

/// Number of signals in each case.
pub const TESTS: usize = 1000;

/// The schemes in the columns of Tables I and II, from left to right.
pub const SCHEMES: [&str; 6] = ["TBR", "MW", "SF", "BSA", "HSA", "T-HSA"];

/// One of the paper's two tables.
pub struct Table {
    /// Title of the table.
    pub title: &'static str,
    /// Means of the table's figure over the signals of a case, indexed by case and then by scheme.
    pub means: [[f64; 6]; 5],
    /// Standard deviations of the table's figure over the signals of a case, indexed by case and then by scheme.
    pub deviations: [[f64; 6]; 5],
    /// Number of decimals that the paper prints.
    pub decimals: usize,
}

impl Table {
    /// Returns the largest error that rounding causes in a printed figure: half a unit of the last decimal.
    pub fn rounding(&self) -> f64 {
        0.5 * 10_f64.powi(-(self.decimals as i32))
    }
}

/// The paper's Table I: spiking efficiency in percent.
pub const EFFICIENCY: Table = Table {
    title: "Table I, spiking efficiency in %",
    means: [
        [36.7, 29.2, 74.6, 45.8, 74.0, 62.4],
        [36.7, 27.5, 73.4, 33.1, 64.5, 57.5],
        [36.6, 27.2, 73.2, 30.0, 62.1, 55.8],
        [36.7, 27.1, 73.2, 29.3, 61.6, 55.6],
        [36.6, 27.1, 73.2, 29.0, 61.4, 55.5],
    ],
    deviations: [
        [4.1, 3.4, 2.0, 1.8, 1.3, 1.1],
        [1.7, 1.5, 0.9, 1.3, 1.0, 1.1],
        [1.0, 0.9, 0.5, 0.8, 0.6, 0.6],
        [0.6, 0.5, 0.3, 0.4, 0.3, 0.3],
        [0.4, 0.3, 0.2, 0.2, 0.2, 0.2],
    ],
    decimals: 1,
};

/// The paper's Table II: root mean square error.
pub const RMSE: Table = Table {
    title: "Table II, root mean square error",
    means: [
        [0.80, 0.68, 0.26, 0.84, 0.97, 0.68],
        [1.41, 1.11, 0.26, 0.64, 0.62, 0.39],
        [2.24, 1.74, 0.26, 0.60, 0.51, 0.30],
        [3.90, 2.94, 0.26, 0.58, 0.48, 0.26],
        [5.55, 4.14, 0.26, 0.57, 0.46, 0.25],
    ],
    deviations: [
        [0.39, 0.24, 0.01, 0.04, 0.05, 0.03],
        [0.68, 0.54, 0.01, 0.02, 0.03, 0.01],
        // 0.06 does not fit its column. The comments of the toolbox's Benchmark.m, which hold the same tables to four
        // decimals, have 0.0059 here.
        [1.17, 0.86, 0.00, 0.01, 0.02, 0.06],
        [2.00, 1.57, 0.00, 0.00, 0.01, 0.00],
        [2.98, 2.17, 0.00, 0.00, 0.01, 0.00],
    ],
    decimals: 2,
};

/// Indices of the case and the scheme of the one standard deviation in [`RMSE`] that is a misprint.
pub const MISPRINT: (usize, usize) = (2, 5);
