//! What the firmware calls in a word, in full.

/// A scheme as one would look it up.
pub fn full_name(scheme: &str) -> &str {
    match scheme {
        "tbr" => "temporal contrast (TBR)",
        "sf" => "step forward (SF)",
        "mw" => "moving window (MW)",
        "hsa" => "Hough spiker (HSA)",
        "t-hsa" => "threshold Hough spiker (T-HSA)",
        "bsa" => "Ben's spiker (BSA)",
        "bsa-mul" => "Ben's spiker, multiplicative",
        "bsa-toolbox" => "Ben's spiker, as in the toolbox",
        "position" => "position",
        "position-gauss" => "position, dense in the middle",
        "grf" => "Gaussian receptive fields (GRF)",
        "grf-slots" => "GRF with sub-timesteps",
        "grf-prob" => "GRF with probabilistic spiking",
        other => other,
    }
}
