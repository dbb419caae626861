"""How the spikes of one sample stand in a message, and back."""

from dataclasses import dataclass
from typing import List, Sequence

# Of these one neuron fires several times a sample, and only how often matters.
_COUNTED = ("sod", "if", "lif")


@dataclass(frozen=True)
class Layout:
    """The numbers of a `spyke`, or of a `spyke_array` where a scheme has several neurons or sub-timesteps.

    Codecs write the spikes of a sample as cells of -1, 0 and 1: sub-timestep after sub-timestep, in each neuron by
    neuron. So does an array; of schemes whose one neuron fires several times a sample, the number is their sum.
    """

    scheme: str
    neurons: int
    slots: int

    @property
    def is_counted(self) -> bool:
        """Whether the number is a count."""
        return self.scheme in _COUNTED

    @property
    def length(self) -> int:
        """How many numbers a message has."""
        return 1 if self.is_counted else self.neurons * self.slots

    @property
    def is_array(self) -> bool:
        """Whether the message is a `spyke_array`."""
        return self.length > 1

    def spikes(self, cells: Sequence[int]) -> List[int]:
        """The numbers of a message."""
        return [sum(cells)] if self.is_counted else list(cells)

    def cells(self, spikes: Sequence[int]) -> List[int]:
        """The cells of a message's numbers. `ValueError`: they are not of this scheme."""
        if len(spikes) != self.length:
            raise ValueError(f"{len(spikes)} numbers a message, where {self.scheme} has {self.length}")
        if not self.is_counted:
            return list(spikes)
        count = spikes[0]
        if abs(count) > self.slots:
            raise ValueError(f"spike {count}, where {self.scheme} has {-self.slots} to {self.slots}")
        return [1 if count > 0 else -1] * abs(count) + [0] * (self.slots - abs(count))
