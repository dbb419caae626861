/// `gyro_z` through t-hsa in q16.16, by `spikewire tune`: 70.72 % of the samples without a spike,
/// RMSE 0.304506; on held-out blocks 71.81 % and 0.361565.
pub static GYRO_Z: spikewire::rate::ThresholdHough<fixed::types::I16F16, 17> =
    spikewire::rate::ThresholdHough::new(
        spikewire::rate::Taps::new([
            fixed::types::I16F16::from_bits(7729),
            fixed::types::I16F16::from_bits(15457),
            fixed::types::I16F16::from_bits(23186),
            fixed::types::I16F16::from_bits(30915),
            fixed::types::I16F16::from_bits(38644),
            fixed::types::I16F16::from_bits(46372),
            fixed::types::I16F16::from_bits(54101),
            fixed::types::I16F16::from_bits(61830),
            fixed::types::I16F16::from_bits(69559),
            fixed::types::I16F16::from_bits(61830),
            fixed::types::I16F16::from_bits(54101),
            fixed::types::I16F16::from_bits(46372),
            fixed::types::I16F16::from_bits(38644),
            fixed::types::I16F16::from_bits(30915),
            fixed::types::I16F16::from_bits(23186),
            fixed::types::I16F16::from_bits(15457),
            fixed::types::I16F16::from_bits(7729),
        ]),
        fixed::types::I16F16::from_bits(30852),
    )
    .with_shift(fixed::types::I16F16::from_bits(-184995));
