"""What schemes are called: by the toolbox, and by spikewire's catalogue."""

# The schemes of the toolbox, by the names that its launch files and messages have.
_OF_TOOLBOX = {
    "temporal_contrast": "tbr",
    "step_forward": "sf",
    "moving_window": "mw",
    "bsa": "bsa",
    "hsa": "hsa",
    "threshold_hsa": "t-hsa",
    "gaussian_fields": "grf",
}
# GRF as the toolbox's node has it: its neurons are numbered from 0 where the paper's centres are from 1.
GAUSSIAN_FIELDS = "gaussian_fields"
_SAME = {name: word for word, name in _OF_TOOLBOX.items() if word != GAUSSIAN_FIELDS}


def toolbox_range(low: float, high: float, neurons: int) -> tuple[float, float]:
    """The range in which our neurons have the centres that the toolbox's have for this one: a field lower."""
    field = (high - low) / max(neurons - 2, 1)
    return low - field, high - field


def of_catalogue(name: str) -> str:
    """The catalogue's name of a scheme that is called by either name, or by the catalogue's with underscores."""
    return _OF_TOOLBOX.get(name, name.replace("_", "-"))


def published(name: str) -> str:
    """What messages call a scheme of the catalogue: as the toolbox does where it has the same."""
    return _SAME.get(name, name)
