"""The classes of the schemes. Generated from the catalogue; a test says how when it has changed."""

from typing import Literal

from numpy.random import Generator

from ._arrays import Number, Numbers, Whole
from ._scheme import Scheme

class TemporalContrast(Scheme):
    """Temporal contrast (TBR), `tbr`: good for changes, as an event camera sees them; drifts.

    threshold:
        what the difference from the sample before must exceed, above 0 (a number, in the signal's unit, such as 0.1)
    factor:
        in the place of a threshold: the differences' mean and this many of their standard deviations (a number, such
        as 0.5)
    magnitudes:
        with a factor: mean and deviation of the differences' magnitudes (True or False)
    step:
        what the decoder adds for a spike, as a number or in thresholds, `2x` (a text, a number or numbers, in the
        signal's unit; 1x unless given)
    start:
        the value before the first sample, whose spike then counts; unless given, the first sample is where the
        decoder starts (a number, in the signal's unit, such as 0; the first sample unless given)
    sample:
        the type that it computes in: "f32", "i16", "i32", or fixed point such as "q8.8" and "q16.16"; samples are
        rounded to it
    paper:
        the settings of the paper, scaled to the signal's range, for what is not given

    >>> import numpy as np, spikewire as sw
    >>> x = 3 * np.sin(np.linspace(0, 20, 300))
    >>> spikes = sw.TemporalContrast(threshold=0.1).encode(x)
    >>> spikes.count > 0, spikes.decode().shape
    (True, (300,))
    """

    def __init__(
        self,
        *,
        threshold: Number | Numbers | None = None,
        factor: Number | Numbers | None = None,
        magnitudes: bool | None = None,
        step: str | Number | Numbers | None = None,
        start: Number | Numbers | None = None,
        sample: str = "f32",
        paper: bool = False,
    ) -> None: ...

class AdaptiveContrast(Scheme):
    """Adaptive temporal contrast, `atbr`: good for changes whose size differs much between rest and flight; drifts.

    threshold:
        the smallest threshold, above 0: what a change from sample to sample must exceed at rest (a number, in the
        signal's unit, such as 0.1)
    doublings:
        how often the threshold doubles at most, 0 to 15 (a whole number, such as 4)
    start:
        the value before the first sample, whose spike then counts; unless given, the first sample is where the
        decoder starts (a number, in the signal's unit, such as 0; the first sample unless given)
    sample:
        the type that it computes in: "f32", "i16", "i32", or fixed point such as "q8.8" and "q16.16"; samples are
        rounded to it
    paper:
        the settings of the paper, scaled to the signal's range, for what is not given

    >>> import numpy as np, spikewire as sw
    >>> x = 3 * np.sin(np.linspace(0, 20, 300))
    >>> spikes = sw.AdaptiveContrast(threshold=0.1, doublings=4).encode(x)
    >>> spikes.count > 0, spikes.decode().shape
    (True, (300,))
    """

    def __init__(
        self,
        *,
        threshold: Number | Numbers | None = None,
        doublings: Whole | None = None,
        start: Number | Numbers | None = None,
        sample: str = "f32",
        paper: bool = False,
    ) -> None: ...

class MovingWindow(Scheme):
    """Moving window (MW), `mw`: good for changes against a short past; drifts.

    threshold:
        what the distance from the mean must exceed, above 0; the decoder's step (a number, in the signal's unit, such
        as 0.1)
    window:
        samples of the running mean less one, as the paper counts: `5` takes 6; 0 to 16383 (a whole number, in
        samples, such as 5)
    start:
        the value before the first sample, whose spike then counts; unless given, the first sample is where the
        decoder starts (a number, in the signal's unit, such as 0; the first sample unless given)
    sample:
        the type that it computes in: "f32", "i16", "i32", or fixed point such as "q8.8" and "q16.16"; samples are
        rounded to it
    paper:
        the settings of the paper, scaled to the signal's range, for what is not given

    >>> import numpy as np, spikewire as sw
    >>> x = 3 * np.sin(np.linspace(0, 20, 300))
    >>> spikes = sw.MovingWindow(threshold=0.1, window=5).encode(x)
    >>> spikes.count > 0, spikes.decode().shape
    (True, (300,))
    """

    def __init__(
        self,
        *,
        threshold: Number | Numbers | None = None,
        window: Whole | None = None,
        start: Number | Numbers | None = None,
        sample: str = "f32",
        paper: bool = False,
    ) -> None: ...

class StepForward(Scheme):
    """Step forward (SF), `sf`: good for following a signal closely with few spikes, while it changes by a threshold a sample at most.

    threshold:
        the step, above 0: what the distance from the baseline must exceed (a number, in the signal's unit, such as
        0.1)
    start:
        the value before the first sample, whose spike then counts; unless given, the first sample is where the
        decoder starts (a number, in the signal's unit, such as 0; the first sample unless given)
    sample:
        the type that it computes in: "f32", "i16", "i32", or fixed point such as "q8.8" and "q16.16"; samples are
        rounded to it
    paper:
        the settings of the paper, scaled to the signal's range, for what is not given

    >>> import numpy as np, spikewire as sw
    >>> x = 3 * np.sin(np.linspace(0, 20, 300))
    >>> spikes = sw.StepForward(threshold=0.1).encode(x)
    >>> spikes.count > 0, spikes.decode().shape
    (True, (300,))
    """

    def __init__(
        self,
        *,
        threshold: Number | Numbers | None = None,
        start: Number | Numbers | None = None,
        sample: str = "f32",
        paper: bool = False,
    ) -> None: ...

class SendOnDelta(Scheme):
    """Send-on-delta, `sod`: good for following a signal that jumps by several thresholds a sample.

    threshold:
        the step, above 0: what the distance from the baseline must exceed (a number, in the signal's unit, such as
        0.1)
    spikes:
        most spikes a sample, 1 to 127 (a whole number, such as 4)
    start:
        the value before the first sample, whose spike then counts; unless given, the first sample is where the
        decoder starts (a number, in the signal's unit, such as 0; the first sample unless given)
    sample:
        the type that it computes in: "f32", "i16", "i32", or fixed point such as "q8.8" and "q16.16"; samples are
        rounded to it
    paper:
        the settings of the paper, scaled to the signal's range, for what is not given

    >>> import numpy as np, spikewire as sw
    >>> x = 3 * np.sin(np.linspace(0, 20, 300))
    >>> spikes = sw.SendOnDelta(threshold=0.1, spikes=4).encode(x)
    >>> spikes.count > 0, spikes.decode().shape
    (True, (300,))
    """

    def __init__(
        self,
        *,
        threshold: Number | Numbers | None = None,
        spikes: Whole | None = None,
        start: Number | Numbers | None = None,
        sample: str = "f32",
        paper: bool = False,
    ) -> None: ...

class AdaptiveStepForward(Scheme):
    """Adaptive step forward, `asf`: good for following a signal that jumps, with one spike a sample at most.

    threshold:
        the smallest step, above 0: what the distance from the baseline must exceed at rest (a number, in the signal's
        unit, such as 0.1)
    doublings:
        how often the step doubles at most, 0 to 30 (a whole number, such as 3)
    run:
        how many spikes in one direction double the step, 1 to 8 (a whole number; 2 unless given)
    start:
        the value before the first sample, whose spike then counts; unless given, the first sample is where the
        decoder starts (a number, in the signal's unit, such as 0; the first sample unless given)
    sample:
        the type that it computes in: "f32", "i16", "i32", or fixed point such as "q8.8" and "q16.16"; samples are
        rounded to it
    paper:
        the settings of the paper, scaled to the signal's range, for what is not given

    >>> import numpy as np, spikewire as sw
    >>> x = 3 * np.sin(np.linspace(0, 20, 300))
    >>> spikes = sw.AdaptiveStepForward(threshold=0.1, doublings=3).encode(x)
    >>> spikes.count > 0, spikes.decode().shape
    (True, (300,))
    """

    def __init__(
        self,
        *,
        threshold: Number | Numbers | None = None,
        doublings: Whole | None = None,
        run: Whole | None = None,
        start: Number | Numbers | None = None,
        sample: str = "f32",
        paper: bool = False,
    ) -> None: ...

class Bsa(Scheme):
    """Ben's spiker (BSA), `bsa`: good for a rate code of either sign of taps; with the toolbox's indices the paper's tables.

    filter:
        `triang:15`, `hann:24`, `gauss:15`, `gauss:15:2.5` (with alpha), taps as in `0.5,1,0.5`, or a FILE of them, 1
        to 4096; `,peak=2` or `,sum=1` after a shape scales it (a text, or the taps, in the signal's unit, such as
        triang:15,peak=2)
    shift:
        what the filters add up on, the signal's minimum; samples below it cannot be coded (a number, in the signal's
        unit, such as -2.5; the signal's minimum unless given)
    form:
        as published (aligned), or as in the paper's tables (toolbox) ("aligned" or "toolbox"; aligned unless given)
    criterion:
        aligned: e1 <= e2 - threshold (sub, unless given) or e1 <= e2 * threshold (mul) ("sub" or "mul")
    threshold:
        sub: 0 or more, in the signal's unit; mul and toolbox: a factor above 0 and below 4 (a number, such as 0.955)
    sample:
        the type that it computes in: "f32", "i16", "i32", or fixed point such as "q8.8" and "q16.16"; samples are
        rounded to it
    paper:
        the settings of the paper, scaled to the signal's range, for what is not given

    >>> import numpy as np, spikewire as sw
    >>> x = 3 * np.sin(np.linspace(0, 20, 300))
    >>> spikes = sw.Bsa(filter='triang:15,peak=2', threshold=0.955).encode(x)
    >>> spikes.count > 0, spikes.decode().shape
    (True, (300,))
    """

    def __init__(
        self,
        *,
        filter: str | Numbers | None = None,
        shift: Number | Numbers | None = None,
        form: Literal["aligned", "toolbox"] | None = None,
        criterion: Literal["sub", "mul"] | None = None,
        threshold: Number | Numbers | None = None,
        sample: str = "f32",
        paper: bool = False,
    ) -> None: ...

class Hough(Scheme):
    """Hough spiker (HSA), `hsa`: good for a value that is never above the signal.

    filter:
        `triang:15`, `hann:24`, `gauss:15`, `gauss:15:2.5` (with alpha), taps as in `0.5,1,0.5`, or a FILE of them, 1
        to 4096; `,peak=2` or `,sum=1` after a shape scales it (a text, or the taps, in the signal's unit, such as
        triang:15,peak=2)
    shift:
        what the filters add up on, the signal's minimum; samples below it cannot be coded (a number, in the signal's
        unit, such as -2.5; the signal's minimum unless given)
    sample:
        the type that it computes in: "f32", "i16", "i32", or fixed point such as "q8.8" and "q16.16"; samples are
        rounded to it
    paper:
        the settings of the paper, scaled to the signal's range, for what is not given

    >>> import numpy as np, spikewire as sw
    >>> x = 3 * np.sin(np.linspace(0, 20, 300))
    >>> spikes = sw.Hough(filter='triang:15,peak=2').encode(x)
    >>> spikes.count > 0, spikes.decode().shape
    (True, (300,))
    """

    def __init__(
        self,
        *,
        filter: str | Numbers | None = None,
        shift: Number | Numbers | None = None,
        sample: str = "f32",
        paper: bool = False,
    ) -> None: ...

class ThresholdHough(Scheme):
    """Threshold Hough spiker (T-HSA), `t-hsa`: good for the nearest reconstruction of the rate codes at the paper's settings.

    filter:
        `triang:15`, `hann:24`, `gauss:15`, `gauss:15:2.5` (with alpha), taps as in `0.5,1,0.5`, or a FILE of them, 1
        to 4096; `,peak=2` or `,sum=1` after a shape scales it (a text, or the taps, in the signal's unit, such as
        triang:15,peak=2)
    shift:
        what the filters add up on, the signal's minimum; samples below it cannot be coded (a number, in the signal's
        unit, such as -2.5; the signal's minimum unless given)
    threshold:
        by how much the signal may fall short of the filter in all, 0 or more (a number, in the signal's unit, such as
        0.1)
    sample:
        the type that it computes in: "f32", "i16", "i32", or fixed point such as "q8.8" and "q16.16"; samples are
        rounded to it
    paper:
        the settings of the paper, scaled to the signal's range, for what is not given

    >>> import numpy as np, spikewire as sw
    >>> x = 3 * np.sin(np.linspace(0, 20, 300))
    >>> spikes = sw.ThresholdHough(filter='triang:15,peak=2', threshold=0.1).encode(x)
    >>> spikes.count > 0, spikes.decode().shape
    (True, (300,))
    """

    def __init__(
        self,
        *,
        filter: str | Numbers | None = None,
        shift: Number | Numbers | None = None,
        threshold: Number | Numbers | None = None,
        sample: str = "f32",
        paper: bool = False,
    ) -> None: ...

class IntegrateAndFire(Scheme):
    """Integrate and fire (IF), `if`: good for a mean, and an integral that never drifts: a gyroscope's angle.

    threshold:
        what the samples add up to at a spike, above 0 (a number, in the signal's unit, such as 0.5)
    reference:
        the value without spikes (a number, in the signal's unit; 0 unless given)
    power:
        the decoder's mean is over about 2^POWER samples, and so long a leak lasts: 1 to 15 (a whole number; 4 unless
        given)
    spikes:
        most spikes a sample, 1 to 127 (a whole number, such as 4)
    sample:
        the type that it computes in: "f32", "i16", "i32", or fixed point such as "q8.8" and "q16.16"; samples are
        rounded to it
    paper:
        the settings of the paper, scaled to the signal's range, for what is not given

    >>> import numpy as np, spikewire as sw
    >>> x = 3 * np.sin(np.linspace(0, 20, 300))
    >>> spikes = sw.IntegrateAndFire(threshold=0.5, spikes=4).encode(x)
    >>> spikes.count > 0, spikes.decode().shape
    (True, (300,))
    """

    def __init__(
        self,
        *,
        threshold: Number | Numbers | None = None,
        reference: Number | Numbers | None = None,
        power: Whole | None = None,
        spikes: Whole | None = None,
        sample: str = "f32",
        paper: bool = False,
    ) -> None: ...

class LeakyIntegrateAndFire(Scheme):
    """Leaky integrate and fire (LIF), `lif`: good for a mean that forgets, silent for what stays small.

    threshold:
        what the samples add up to at a spike, above 0 (a number, in the signal's unit, such as 0.5)
    reference:
        the value without spikes (a number, in the signal's unit; 0 unless given)
    power:
        the decoder's mean is over about 2^POWER samples, and so long a leak lasts: 1 to 15 (a whole number; 4 unless
        given)
    spikes:
        most spikes a sample, 1 to 127 (a whole number, such as 4)
    sample:
        the type that it computes in: "f32", "i16", "i32", or fixed point such as "q8.8" and "q16.16"; samples are
        rounded to it
    paper:
        the settings of the paper, scaled to the signal's range, for what is not given

    >>> import numpy as np, spikewire as sw
    >>> x = 3 * np.sin(np.linspace(0, 20, 300))
    >>> spikes = sw.LeakyIntegrateAndFire(threshold=0.5, spikes=4).encode(x)
    >>> spikes.count > 0, spikes.decode().shape
    (True, (300,))
    """

    def __init__(
        self,
        *,
        threshold: Number | Numbers | None = None,
        reference: Number | Numbers | None = None,
        power: Whole | None = None,
        spikes: Whole | None = None,
        sample: str = "f32",
        paper: bool = False,
    ) -> None: ...

class SigmaDelta(Scheme):
    """Sigma-delta (regular rate), `sigma-delta`: good for a mean from one neuron, the more exact the longer it is taken.

    min:
        lower end of the neurons' range: the signal's minimum (a number, in the signal's unit, such as -2.5; the
        signal's minimum unless given)
    max:
        upper end of the neurons' range: the signal's maximum (a number, in the signal's unit, such as 2.5; the
        signal's maximum unless given)
    mean:
        how the decoder takes the mean of spikes: an `average` that forgets, or a `window` ("average" or "window";
        average unless given)
    power:
        the mean is over about 2^POWER samples: 1 to 15, of a window 0 to 12 (a whole number; 4 unless given)
    sample:
        the type that it computes in: "f32", "i16", "i32", or fixed point such as "q8.8" and "q16.16"; samples are
        rounded to it
    paper:
        the settings of the paper, scaled to the signal's range, for what is not given

    >>> import numpy as np, spikewire as sw
    >>> x = 3 * np.sin(np.linspace(0, 20, 300))
    >>> spikes = sw.SigmaDelta().encode(x)
    >>> spikes.count > 0, spikes.decode().shape
    (True, (300,))
    """

    def __init__(
        self,
        *,
        min: Number | Numbers | None = None,
        max: Number | Numbers | None = None,
        mean: Literal["average", "window"] | None = None,
        power: Whole | None = None,
        sample: str = "f32",
        paper: bool = False,
    ) -> None: ...

class Bernoulli(Scheme):
    """Bernoulli (random rate), `bernoulli`: good for a mean by chance, from your generator, as networks are trained with.

    min:
        lower end of the neurons' range: the signal's minimum (a number, in the signal's unit, such as -2.5; the
        signal's minimum unless given)
    max:
        upper end of the neurons' range: the signal's maximum (a number, in the signal's unit, such as 2.5; the
        signal's maximum unless given)
    mean:
        how the decoder takes the mean of spikes: an `average` that forgets, or a `window` ("average" or "window";
        average unless given)
    power:
        the mean is over about 2^POWER samples: 1 to 15, of a window 0 to 12 (a whole number; 4 unless given)
    seed:
        where the generator starts; each channel draws from a stream of its own (a whole number, or a
        numpy.random.Generator; fresh draws in each call unless given)
    sample:
        the type that it computes in: "f32", "i16", "i32", or fixed point such as "q8.8" and "q16.16"; samples are
        rounded to it
    paper:
        the settings of the paper, scaled to the signal's range, for what is not given

    >>> import numpy as np, spikewire as sw
    >>> x = 3 * np.sin(np.linspace(0, 20, 300))
    >>> spikes = sw.Bernoulli().encode(x)
    >>> spikes.count > 0, spikes.decode().shape
    (True, (300,))
    """

    def __init__(
        self,
        *,
        min: Number | Numbers | None = None,
        max: Number | Numbers | None = None,
        mean: Literal["average", "window"] | None = None,
        power: Whole | None = None,
        seed: Whole | Generator | None = None,
        sample: str = "f32",
        paper: bool = False,
    ) -> None: ...

class WeightedBurst(Scheme):
    """Bursts of doubling weight, `burst-weighted`: good for a mean from one neuron, where few spikes may tell little and many in a row much.

    min:
        lower end of the neurons' range: the signal's minimum (a number, in the signal's unit, such as -2.5; the
        signal's minimum unless given)
    max:
        upper end of the neurons' range: the signal's maximum (a number, in the signal's unit, such as 2.5; the
        signal's maximum unless given)
    weight:
        what the first spike of a burst weighs, above 0; after DOUBLINGS, max - min at least (a number, in the
        signal's unit, such as 1)
    doublings:
        how often the weight doubles at most, 0 to 14 (a whole number; 3 unless given)
    mean:
        how the decoder takes the mean of spikes: an `average` that forgets, or a `window` ("average" or "window";
        average unless given)
    power:
        the mean is over about 2^POWER samples: 1 to 15, of a window 0 to 12 (a whole number; 4 unless given)
    sample:
        the type that it computes in: "f32", "i16", "i32", or fixed point such as "q8.8" and "q16.16"; samples are
        rounded to it
    paper:
        the settings of the paper, scaled to the signal's range, for what is not given

    >>> import numpy as np, spikewire as sw
    >>> x = 3 * np.sin(np.linspace(0, 20, 300))
    >>> spikes = sw.WeightedBurst(weight=1).encode(x)
    >>> spikes.count > 0, spikes.decode().shape
    (True, (300,))
    """

    def __init__(
        self,
        *,
        min: Number | Numbers | None = None,
        max: Number | Numbers | None = None,
        weight: Number | Numbers | None = None,
        doublings: Whole | None = None,
        mean: Literal["average", "window"] | None = None,
        power: Whole | None = None,
        sample: str = "f32",
        paper: bool = False,
    ) -> None: ...

class Position(Scheme):
    """Position, `position`: good for a value, dense where it matters.

    centres:
        `linear`, `gaussian`, or a rising list such as `-1,-0.2,0,0.2,1` (a text, a number or numbers, in the signal's
        unit; linear unless given)
    neurons:
        how many neurons share the range, 3 to 1024 (a whole number, such as 20)
    min:
        lower end of the neurons' range: the signal's minimum (a number, in the signal's unit, such as -2.5; the
        signal's minimum unless given)
    max:
        upper end of the neurons' range: the signal's maximum (a number, in the signal's unit, such as 2.5; the
        signal's maximum unless given)
    sample:
        the type that it computes in: "f32", "i16", "i32", or fixed point such as "q8.8" and "q16.16"; samples are
        rounded to it
    paper:
        the settings of the paper, scaled to the signal's range, for what is not given

    >>> import numpy as np, spikewire as sw
    >>> x = 3 * np.sin(np.linspace(0, 20, 300))
    >>> spikes = sw.Position(neurons=20).encode(x)
    >>> spikes.count > 0, spikes.decode().shape
    (True, (300,))
    """

    def __init__(
        self,
        *,
        centres: str | Number | Numbers | None = None,
        neurons: Whole | None = None,
        min: Number | Numbers | None = None,
        max: Number | Numbers | None = None,
        sample: str = "f32",
        paper: bool = False,
    ) -> None: ...

class Gaussian(Scheme):
    """Gaussian receptive fields (GRF), `grf`: good for a value over an even range.

    neurons:
        how many neurons share the range, 3 to 1024 (a whole number, such as 20)
    min:
        lower end of the neurons' range: the signal's minimum (a number, in the signal's unit, such as -2.5; the
        signal's minimum unless given)
    max:
        upper end of the neurons' range: the signal's maximum (a number, in the signal's unit, such as 2.5; the
        signal's maximum unless given)
    sample:
        the type that it computes in: "f32", "i16", "i32", or fixed point such as "q8.8" and "q16.16"; samples are
        rounded to it
    paper:
        the settings of the paper, scaled to the signal's range, for what is not given

    >>> import numpy as np, spikewire as sw
    >>> x = 3 * np.sin(np.linspace(0, 20, 300))
    >>> spikes = sw.Gaussian(neurons=20).encode(x)
    >>> spikes.count > 0, spikes.decode().shape
    (True, (300,))
    """

    def __init__(
        self,
        *,
        neurons: Whole | None = None,
        min: Number | Numbers | None = None,
        max: Number | Numbers | None = None,
        sample: str = "f32",
        paper: bool = False,
    ) -> None: ...

class Slots(Scheme):
    """GRF with sub-timesteps, `grf-slots`: good for a value finer than the neurons, by spike time.

    neurons:
        how many neurons share the range, 3 to 1024 (a whole number, such as 20)
    min:
        lower end of the neurons' range: the signal's minimum (a number, in the signal's unit, such as -2.5; the
        signal's minimum unless given)
    max:
        upper end of the neurons' range: the signal's maximum (a number, in the signal's unit, such as 2.5; the
        signal's maximum unless given)
    slots:
        sub-timesteps a sample, 2 to 256 (a whole number, such as 10)
    beta:
        distance of the centres in widths of a field, so the smaller, the wider, above 0 (a number; 1.5 unless given)
    floor:
        neurons below this level of the slots are silent (a whole number; 1 unless given)
    sample:
        the type that it computes in: "f32", "i16", "i32", or fixed point such as "q8.8" and "q16.16"; samples are
        rounded to it
    paper:
        the settings of the paper, scaled to the signal's range, for what is not given

    >>> import numpy as np, spikewire as sw
    >>> x = 3 * np.sin(np.linspace(0, 20, 300))
    >>> spikes = sw.Slots(neurons=20, slots=10).encode(x)
    >>> spikes.count > 0, spikes.decode().shape
    (True, (300,))
    """

    def __init__(
        self,
        *,
        neurons: Whole | None = None,
        min: Number | Numbers | None = None,
        max: Number | Numbers | None = None,
        slots: Whole | None = None,
        beta: Number | Numbers | None = None,
        floor: Whole | None = None,
        sample: str = "f32",
        paper: bool = False,
    ) -> None: ...

class Probabilistic(Scheme):
    """GRF with probabilistic spiking, `grf-prob`: good for a value by chance, from your generator.

    neurons:
        how many neurons share the range, 3 to 1024 (a whole number, such as 20)
    min:
        lower end of the neurons' range: the signal's minimum (a number, in the signal's unit, such as -2.5; the
        signal's minimum unless given)
    max:
        upper end of the neurons' range: the signal's maximum (a number, in the signal's unit, such as 2.5; the
        signal's maximum unless given)
    beta:
        distance of the centres in widths of a field, so the smaller, the wider, above 0 (a number; 1.5 unless given)
    seed:
        where the generator starts; each channel draws from a stream of its own (a whole number, or a
        numpy.random.Generator; fresh draws in each call unless given)
    sample:
        the type that it computes in: "f32", "i16", "i32", or fixed point such as "q8.8" and "q16.16"; samples are
        rounded to it
    paper:
        the settings of the paper, scaled to the signal's range, for what is not given

    >>> import numpy as np, spikewire as sw
    >>> x = 3 * np.sin(np.linspace(0, 20, 300))
    >>> spikes = sw.Probabilistic(neurons=20).encode(x)
    >>> spikes.count > 0, spikes.decode().shape
    (True, (300,))
    """

    def __init__(
        self,
        *,
        neurons: Whole | None = None,
        min: Number | Numbers | None = None,
        max: Number | Numbers | None = None,
        beta: Number | Numbers | None = None,
        seed: Whole | Generator | None = None,
        sample: str = "f32",
        paper: bool = False,
    ) -> None: ...

class NonLinearGaussian(Scheme):
    """Non-linear Gaussian receptive fields (GRF), `grf-nonlinear`: good for a value, finer where it is most of the time.

    centres:
        `companded`, dense in the middle; `quantiles`, dense where the signal is; or a rising list such as
        `-1,-0.2,0,0.2,1` (a text, a number or numbers, in the signal's unit; companded unless given)
    widths:
        `spacing`, as wide as the distance between a centre's neighbours, one number for all fields, or a list (a
        text, a number or numbers, in the signal's unit; spacing unless given)
    companding:
        how much denser companded centres are in the middle, above 0 (a number; 255 unless given)
    neurons:
        how many neurons share the range, 3 to 1024 (a whole number, such as 20)
    min:
        lower end of the neurons' range: the signal's minimum (a number, in the signal's unit, such as -2.5; the
        signal's minimum unless given)
    max:
        upper end of the neurons' range: the signal's maximum (a number, in the signal's unit, such as 2.5; the
        signal's maximum unless given)
    sample:
        the type that it computes in: "f32", "i16", "i32", or fixed point such as "q8.8" and "q16.16"; samples are
        rounded to it
    paper:
        the settings of the paper, scaled to the signal's range, for what is not given

    >>> import numpy as np, spikewire as sw
    >>> x = 3 * np.sin(np.linspace(0, 20, 300))
    >>> spikes = sw.NonLinearGaussian(neurons=20).encode(x)
    >>> spikes.count > 0, spikes.decode().shape
    (True, (300,))
    """

    def __init__(
        self,
        *,
        centres: str | Number | Numbers | None = None,
        widths: str | Number | Numbers | None = None,
        companding: Number | Numbers | None = None,
        neurons: Whole | None = None,
        min: Number | Numbers | None = None,
        max: Number | Numbers | None = None,
        sample: str = "f32",
        paper: bool = False,
    ) -> None: ...

class NonLinearSlots(Scheme):
    """Non-linear GRF with sub-timesteps, `grf-nonlinear-slots`: good for a value finer than the neurons, by spike time, and finest where it is most of the time.

    centres:
        `companded`, dense in the middle; `quantiles`, dense where the signal is; or a rising list such as
        `-1,-0.2,0,0.2,1` (a text, a number or numbers, in the signal's unit; companded unless given)
    widths:
        `spacing`, as wide as the distance between a centre's neighbours, one number for all fields, or a list (a
        text, a number or numbers, in the signal's unit; spacing unless given)
    companding:
        how much denser companded centres are in the middle, above 0 (a number; 255 unless given)
    neurons:
        how many neurons share the range, 3 to 1024 (a whole number, such as 20)
    min:
        lower end of the neurons' range: the signal's minimum (a number, in the signal's unit, such as -2.5; the
        signal's minimum unless given)
    max:
        upper end of the neurons' range: the signal's maximum (a number, in the signal's unit, such as 2.5; the
        signal's maximum unless given)
    slots:
        sub-timesteps a sample, 2 to 256 (a whole number, such as 10)
    beta:
        distance of the centres in widths of a field, so the smaller, the wider, above 0 (a number; 1.5 unless given)
    floor:
        neurons below this level of the slots are silent (a whole number; 1 unless given)
    sample:
        the type that it computes in: "f32", "i16", "i32", or fixed point such as "q8.8" and "q16.16"; samples are
        rounded to it
    paper:
        the settings of the paper, scaled to the signal's range, for what is not given

    >>> import numpy as np, spikewire as sw
    >>> x = 3 * np.sin(np.linspace(0, 20, 300))
    >>> spikes = sw.NonLinearSlots(neurons=20, slots=10).encode(x)
    >>> spikes.count > 0, spikes.decode().shape
    (True, (300,))
    """

    def __init__(
        self,
        *,
        centres: str | Number | Numbers | None = None,
        widths: str | Number | Numbers | None = None,
        companding: Number | Numbers | None = None,
        neurons: Whole | None = None,
        min: Number | Numbers | None = None,
        max: Number | Numbers | None = None,
        slots: Whole | None = None,
        beta: Number | Numbers | None = None,
        floor: Whole | None = None,
        sample: str = "f32",
        paper: bool = False,
    ) -> None: ...

class RankOrder(Scheme):
    """Rank order, `rank-order`: good for a value finer than the neurons, by who fires first.

    centres:
        `linear`, or a rising list such as `-1,-0.2,0,0.2,1` (a text, a number or numbers, in the signal's unit;
        linear unless given)
    neurons:
        how many neurons share the range, 3 to 1024 (a whole number, such as 20)
    min:
        lower end of the neurons' range: the signal's minimum (a number, in the signal's unit, such as -2.5; the
        signal's minimum unless given)
    max:
        upper end of the neurons' range: the signal's maximum (a number, in the signal's unit, such as 2.5; the
        signal's maximum unless given)
    spikes:
        how many neurons fire for a sample, 1 to all, at most 256 (a whole number, such as 3)
    sample:
        the type that it computes in: "f32", "i16", "i32", or fixed point such as "q8.8" and "q16.16"; samples are
        rounded to it
    paper:
        the settings of the paper, scaled to the signal's range, for what is not given

    >>> import numpy as np, spikewire as sw
    >>> x = 3 * np.sin(np.linspace(0, 20, 300))
    >>> spikes = sw.RankOrder(neurons=20, spikes=3).encode(x)
    >>> spikes.count > 0, spikes.decode().shape
    (True, (300,))
    """

    def __init__(
        self,
        *,
        centres: str | Number | Numbers | None = None,
        neurons: Whole | None = None,
        min: Number | Numbers | None = None,
        max: Number | Numbers | None = None,
        spikes: Whole | None = None,
        sample: str = "f32",
        paper: bool = False,
    ) -> None: ...

class FirstSpike(Scheme):
    """Time to first spike, `ttfs`: good for a value by one spike's time, the larger the earlier.

    edges:
        `linear`, `log`, or a rising list such as `0.1,0.3,1`, each of which is a slot (a text, a number or numbers,
        in the signal's unit; linear unless given)
    slots:
        sub-timesteps a sample, 2 to 256 (a whole number; 16 unless given)
    ratio:
        of `log`, the range over the part of it that has no spike, above 1 (a number; 32 unless given)
    min:
        lower end of the neurons' range: the signal's minimum (a number, in the signal's unit, such as -2.5; the
        signal's minimum unless given)
    max:
        upper end of the neurons' range: the signal's maximum (a number, in the signal's unit, such as 2.5; the
        signal's maximum unless given)
    sample:
        the type that it computes in: "f32", "i16", "i32", or fixed point such as "q8.8" and "q16.16"; samples are
        rounded to it
    paper:
        the settings of the paper, scaled to the signal's range, for what is not given

    >>> import numpy as np, spikewire as sw
    >>> x = 3 * np.sin(np.linspace(0, 20, 300))
    >>> spikes = sw.FirstSpike().encode(x)
    >>> spikes.count > 0, spikes.decode().shape
    (True, (300,))
    """

    def __init__(
        self,
        *,
        edges: str | Number | Numbers | None = None,
        slots: Whole | None = None,
        ratio: Number | Numbers | None = None,
        min: Number | Numbers | None = None,
        max: Number | Numbers | None = None,
        sample: str = "f32",
        paper: bool = False,
    ) -> None: ...

class LatencyPhase(Scheme):
    """Latency-phase, `latency-phase`: good for channels that share one line, told apart by the phase of their spikes.

    neurons:
        how many carry each sample, from 1 on (a whole number; 4 unless given)
    latencies:
        how many a sample may have, 2 to 255; with the period at most 257 (a whole number; 32 unless given)
    period:
        of the oscillation in slots, a power of 2 (a whole number; 4 unless given)
    spacing:
        from one neuron's peaks to the next's, in slots (a whole number; 1 unless given)
    min:
        lower end of the neurons' range: the signal's minimum (a number, in the signal's unit, such as -2.5; the
        signal's minimum unless given)
    max:
        upper end of the neurons' range: the signal's maximum (a number, in the signal's unit, such as 2.5; the
        signal's maximum unless given)
    sample:
        the type that it computes in: "f32", "i16", "i32", or fixed point such as "q8.8" and "q16.16"; samples are
        rounded to it
    paper:
        the settings of the paper, scaled to the signal's range, for what is not given

    >>> import numpy as np, spikewire as sw
    >>> x = 3 * np.sin(np.linspace(0, 20, 300))
    >>> spikes = sw.LatencyPhase().encode(x)
    >>> spikes.count > 0, spikes.decode().shape
    (True, (300,))
    """

    def __init__(
        self,
        *,
        neurons: Whole | None = None,
        latencies: Whole | None = None,
        period: Whole | None = None,
        spacing: Whole | None = None,
        min: Number | Numbers | None = None,
        max: Number | Numbers | None = None,
        sample: str = "f32",
        paper: bool = False,
    ) -> None: ...

class WeightedPhase(Scheme):
    """Weighted phase, `weighted-phase`: good for a value in binary digits: the finest in few sub-timesteps.

    slots:
        digits a sample, 2 to 16 (a whole number; 8 unless given)
    min:
        lower end of the neurons' range: the signal's minimum (a number, in the signal's unit, such as -2.5; the
        signal's minimum unless given)
    max:
        upper end of the neurons' range: the signal's maximum (a number, in the signal's unit, such as 2.5; the
        signal's maximum unless given)
    sample:
        the type that it computes in: "f32", "i16", "i32", or fixed point such as "q8.8" and "q16.16"; samples are
        rounded to it
    paper:
        the settings of the paper, scaled to the signal's range, for what is not given

    >>> import numpy as np, spikewire as sw
    >>> x = 3 * np.sin(np.linspace(0, 20, 300))
    >>> spikes = sw.WeightedPhase().encode(x)
    >>> spikes.count > 0, spikes.decode().shape
    (True, (300,))
    """

    def __init__(
        self,
        *,
        slots: Whole | None = None,
        min: Number | Numbers | None = None,
        max: Number | Numbers | None = None,
        sample: str = "f32",
        paper: bool = False,
    ) -> None: ...

class Burst(Scheme):
    """Burst coding, `burst`: good for a value by the count and the interval of its spikes.

    slots:
        sub-timesteps a sample, 2 to 256 (a whole number; 19 unless given)
    spikes:
        most spikes a sample, 1 to 255 (a whole number; 5 unless given)
    shortest:
        shortest interval in slots, from 1 on (a whole number; 2 unless given)
    longest:
        longest interval in slots, up to 255 (a whole number; 10 unless given)
    min:
        lower end of the neurons' range: the signal's minimum (a number, in the signal's unit, such as -2.5; the
        signal's minimum unless given)
    max:
        upper end of the neurons' range: the signal's maximum (a number, in the signal's unit, such as 2.5; the
        signal's maximum unless given)
    sample:
        the type that it computes in: "f32", "i16", "i32", or fixed point such as "q8.8" and "q16.16"; samples are
        rounded to it
    paper:
        the settings of the paper, scaled to the signal's range, for what is not given

    >>> import numpy as np, spikewire as sw
    >>> x = 3 * np.sin(np.linspace(0, 20, 300))
    >>> spikes = sw.Burst().encode(x)
    >>> spikes.count > 0, spikes.decode().shape
    (True, (300,))
    """

    def __init__(
        self,
        *,
        slots: Whole | None = None,
        spikes: Whole | None = None,
        shortest: Whole | None = None,
        longest: Whole | None = None,
        min: Number | Numbers | None = None,
        max: Number | Numbers | None = None,
        sample: str = "f32",
        paper: bool = False,
    ) -> None: ...

schemes: dict[str, type[Scheme]]
NAMES: list[str]
