//! All public data can be logged: this compiles, or it does not.

use defmt::Format;
use fixed::types::{I8F8, I16F16};
use rand_pcg::Pcg32;
use spikewire::{
    Calibration, Conditions, ConfigError, Differences, Histogram, NeuronSpike, Polarity, Recovery,
    Sample, SampleKind, Spike, Unfit,
    filter::{Biquad, Filtered, FirstOrder},
    population::{
        FiredNeurons, Gaussian, Neuron, NeuronSlots, NonLinearSlots, Position, Probabilistic,
        RankOrder, SlotSpikes, Slots,
    },
    rate::{Bsa, BsaToolbox, Criterion, Hough, Scale, Shape, Taps, ThresholdHough},
    temporal::{MovingWindow, StepForward, TemporalContrast},
    timing::{
        Burst, BurstSpikes, FirstSpike, LatencyPhase, PhaseBits, PhaseSpikes, Slot, WeightedPhase,
    },
};

const fn is_format<T: Format>() {}

const fn is_format_in<S: Sample + Format>() {
    is_format::<TemporalContrast<S>>();
    is_format::<StepForward<S>>();
    is_format::<MovingWindow<S, 4>>();

    is_format::<Taps<S, 4>>();
    is_format::<Scale<S>>();
    is_format::<Criterion<S>>();
    is_format::<Hough<S, 4>>();
    is_format::<ThresholdHough<S, 4>>();
    is_format::<Bsa<S, 4>>();
    is_format::<BsaToolbox<S, 4>>();

    is_format::<Position<S, 4>>();
    is_format::<Gaussian<S, 4>>();
    is_format::<Slots<S, 4, 8>>();
    is_format::<NonLinearSlots<S, 4, 8>>();
    is_format::<RankOrder<S, 4, 2>>();
    is_format::<Probabilistic<S, Pcg32, 4, 8>>();

    is_format::<FirstSpike<S, 4>>();
    is_format::<LatencyPhase<S, 2, 16, 4>>();
    is_format::<WeightedPhase<S, 4>>();
    is_format::<Burst<S, 19>>();

    is_format::<Filtered<Biquad<S>, StepForward<S>>>();
    is_format::<FirstOrder<S>>();

    is_format::<Calibration<S>>();
    is_format::<Histogram<S, 4>>();
    is_format::<Conditions<S>>();
}

const _: () = {
    is_format::<(Spike, Polarity, NeuronSpike, Recovery, SampleKind, Unfit)>();
    is_format::<(Neuron<4>, SlotSpikes<4, 8>, NeuronSlots<4, 8>, FiredNeurons<4>)>();
    is_format::<(Slot<4>, PhaseSpikes<2, 16, 4>, PhaseBits<4>, BurstSpikes<19>)>();
    is_format::<(Shape, Differences, ConfigError)>();
    is_format_in::<f32>();
    is_format_in::<i16>();
    is_format_in::<I8F8>();
    is_format_in::<I16F16>();
};
