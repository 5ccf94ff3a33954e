"""What the cases of a sweep show, in sentences: the titles of its figures."""

from collections.abc import Iterable, Sequence

import numpy as np
import xarray as xr

from coilset.model.core.results.records.labels import plain

FLAT = 1e-6  # of a response's range: a smaller change is none


def words(data: xr.Dataset, name: str) -> str:
    """An input or a response in words."""
    return str(data[name].attrs.get("long_name", name))


def number(value: float) -> str:
    """A number with four digits and the sign of print."""
    return plain(float(value)).replace("-", "−")


def extent(data: xr.Dataset, of: str) -> str:
    """From the least to the greatest value of a response."""
    low, high = number(data[of].min()), number(data[of].max())
    return f"The {words(data, of)} runs from {low} to {high} {data[of].attrs['units']}".rstrip()


def middle(data: xr.Dataset, of: str) -> str:
    """Where the middle 90 % of the cases are."""
    values = data[of].values[np.isfinite(data[of].values)]
    low, high = map(number, np.quantile(values, [0.05, 0.95]))
    return f"Nine in ten cases have a {words(data, of)} of {low} to {high} {data[of].attrs['units']}".rstrip()


def trend(data: xr.Dataset, of: str, x: str, lines: Iterable[np.ndarray]) -> str:
    """Whether a response grows or falls along an input.

    Args:
        data: of the sweep.
        of: the response.
        x: the input.
        lines: values of the response along the input, one array for each combination of the other inputs.
    """
    flat = FLAT * float(np.ptp(data[of].values[np.isfinite(data[of].values)]))
    steps = np.concatenate([np.diff(line[np.isfinite(line)]) for line in lines])
    falls, grows = bool((steps < -flat).any()), bool((steps > flat).any())
    if falls == grows:
        return extent(data, of)
    return f"{extent(data, of)}, and {'falls' if falls else 'grows'} with the {words(data, x)}"


def strongest(of: str, names: Sequence[str], correlation: np.ndarray, interval: np.ndarray) -> str:
    """Which input a response follows most clearly by rank, if any is sure.

    Args:
        of: the response in words.
        names: the inputs in words.
        correlation: shape (inputs,); interval: shape (inputs, 2).
    """
    if np.isnan(correlation).all():
        return f"No rank correlation with the {of} is known"
    first = int(np.nanargmax(np.abs(correlation)))
    if interval[first, 0] <= 0.0 <= interval[first, 1]:
        return f"No input moves the {of} more than chance would"
    way = "larger" if correlation[first] > 0.0 else "smaller"
    return f"A greater {names[first]} comes with a {way} {of} most clearly"


def share(of: str, names: Sequence[str], total: np.ndarray) -> str:
    """Which input causes most of the variance of a response."""
    first = int(np.argmax(total))
    return f"The {names[first]} has a part in {100.0 * total[first]:.0f} % of the variance of the {of}"


def refinement(data: xr.Dataset, of: str, last: Sequence[float]) -> str:
    """How much the last refinement of an input changes a response.

    Args:
        last: relative change of each input.
    """
    return f"The last refinement changes the {words(data, of)} by {plain(100.0 * max(last), 2)} % at most"
