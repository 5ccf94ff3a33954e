"""The sweep file: a base case, the entries that vary, the design that combines them, and the figures."""

from collections.abc import Sequence
from difflib import get_close_matches
from typing import Annotated, Any, Literal, Self

import numpy as np
from annotated_types import Unit
from pydantic import AfterValidator, BeforeValidator, Discriminator, Field, Tag, model_validator

from coilset.model.core.base.entry import Strict, Whole, shortened
from coilset.model.core.results.records.summary_entries import NUMBERS
from coilset.model.physics.working.working import is_working_number

AT_ONCE = 65_536  # quantiles, each of which takes 200 bytes while it is computed
LISTED = 8  # maximum number of names in a message
RESPONSES = (*NUMBERS, "seconds")  # of a case's summary, and its duration


def are_numbers(values: Sequence[Any]) -> bool:
    """Whether values are all numbers, and none of them true or false."""
    return all(isinstance(value, (int, float)) and not isinstance(value, bool) for value in values)


class Input(Strict):
    """Entries common to all varied inputs."""

    entries: Annotated[
        list[str] | None,
        Field(min_length=1, description="entries of the case that take the value; default: the name of the input"),
    ] = None
    label: Annotated[str | None, Field(description="label in figures")] = None
    unit: Annotated[str | None, Field(description="unit in figures; default: that of the entries")] = None

    @property
    def is_numeric(self) -> bool:
        """Whether all its values are numbers."""
        return True


class Values(Input):
    """A list of values; a sampling design picks each equally often."""

    values: Annotated[list[Any], Field(min_length=1, description="numbers, words or any other YAML values")]

    @property
    def is_numeric(self) -> bool:
        """Whether all its values are numbers."""
        return are_numbers(self.values)

    def grid(self) -> list[Any]:
        """The values."""
        return list(self.values)

    def at(self, q: Sequence[float] | np.ndarray) -> list[Any]:
        """Values at the probabilities `q`, 0 ≤ q < 1."""
        return [self.values[min(int(part * len(self.values)), len(self.values) - 1)] for part in q]


class Range(Input):
    """A range; a sampling design distributes values uniformly over it."""

    start: Annotated[float, Unit("of the entry"), Field(alias="from", description="first value")]
    stop: Annotated[float, Unit("of the entry"), Field(alias="to", description="last value")]
    count: Annotated[Whole | None, Field(ge=2, le=1_000_000, description="number of values in a grid")] = None
    spacing: Annotated[Literal["linear", "log"], Field(description="equal differences or equal ratios")] = "linear"

    @model_validator(mode="after")
    def _order(self) -> Self:
        if self.start >= self.stop:
            raise ValueError(f"from {self.start:g} to {self.stop:g} is not a range; 'from' must be the smaller one")
        if self.spacing == "log" and self.start <= 0:
            raise ValueError(f"equal ratios need a positive start, not {self.start:g}")
        return self

    def grid(self) -> list[Any]:
        """`count` values, including both ends."""
        if self.count is None:
            raise ValueError("a grid needs 'count', the number of values in the range")
        return self.at(np.linspace(0.0, 1.0, self.count)).tolist()

    def at(self, q: Sequence[float] | np.ndarray) -> np.ndarray:
        """Values at the probabilities `q`."""
        if self.spacing == "log":
            return self.start * (self.stop / self.start) ** np.asarray(q)
        return self.start + (self.stop - self.start) * np.asarray(q)


class Normal(Input):
    """Manufacturing scatter: normal about the mean; parts outside mean ± tolerance are rejected."""

    mean: Annotated[float, Unit("of the entry"), Field(description="middle of the tolerance")]
    tolerance: Annotated[float, Unit("of the entry"), Field(gt=0, description="half the width of the tolerance")]
    sigmas: Annotated[
        float,
        Unit("standard deviations"),
        Field(gt=0, le=10, description="number of standard deviations in the tolerance"),
    ] = 3.0

    def grid(self) -> list[Any]:
        """A scatter has no grid."""
        raise ValueError("a scatter has no grid; use the design latin_hypercube, sobol or sobol_indices")

    def at(self, q: Sequence[float] | np.ndarray) -> np.ndarray:
        """Values at the probabilities `q`, the quantiles of the truncated normal distribution."""
        from scipy import stats  # loads for half a second, and most runs from Python vary nothing

        scatter = stats.truncnorm(-self.sigmas, self.sigmas, loc=self.mean, scale=self.tolerance / self.sigmas)
        q = np.asarray(q)
        return np.concatenate([scatter.ppf(part) for part in np.array_split(q, len(q) // AT_ONCE + 1)])


def _kind(value: Any) -> str:
    """The kind of an input, from the entries that only this kind has."""
    given = value if isinstance(value, dict) else getattr(value, "__dict__", {})
    if "values" in given:
        return "(values)"
    return "(normal)" if "mean" in given or "tolerance" in given else "(range)"


AnyInput = Annotated[
    Annotated[Values, Tag("(values)")] | Annotated[Range, Tag("(range)")] | Annotated[Normal, Tag("(normal)")],
    Discriminator(_kind),
    BeforeValidator(lambda value: {"values": value} if isinstance(value, list) else value),
]


class Lines(Strict):
    """A response over one input, with one line per value of a second input and one panel per value of a third."""

    kind: Literal["lines"]
    of: Annotated[str, Field(description="entry of the summary, such as set_mm")] = "set_mm"
    x: Annotated[str, Field(description="the input along the axis")]
    colour: Annotated[str | None, Field(description="the input with one line per value")] = None
    panels: Annotated[str | None, Field(description="the input with one panel per value")] = None


class Map(Strict):
    """A response over two inputs, as contours."""

    kind: Literal["map"]
    of: Annotated[str, Field(description="entry of the summary")] = "set_mm"
    x: Annotated[str, Field(description="the input along the horizontal axis")]
    y: Annotated[str, Field(description="the input along the vertical axis")]


class Family(Strict):
    """The force–travel curves of all cases, coloured by an input or a response."""

    kind: Literal["characteristics"]
    colour: Annotated[str, Field(description="an input, or an entry of the summary")] = "set_mm"


class Scatter(Strict):
    """A response over each input in turn, and its distribution."""

    kind: Literal["scatter"]
    of: Annotated[str, Field(description="entry of the summary")] = "set_mm"


class Sensitivity(Strict):
    """Sensitivity of a response to each input: Sobol indices if the design allows, else rank correlations."""

    kind: Literal["sensitivity"]
    of: Annotated[list[str], Field(min_length=1, description="entries of the summary")] = Field(["set_mm"])


class Convergence(Strict):
    """Deviation of a response from its value at the largest value of each input; for the design one_at_a_time."""

    kind: Literal["convergence"]
    of: Annotated[list[str], Field(min_length=1, description="entries of the summary")] = Field(["set_mm"])


def _figure(value: Any) -> str:
    """Tag of a figure: its kind."""
    return f"({value.get('kind') if isinstance(value, dict) else getattr(value, 'kind', None)})"


AnyFigure = Annotated[
    Annotated[Lines, Tag("(lines)")]
    | Annotated[Map, Tag("(map)")]
    | Annotated[Family, Tag("(characteristics)")]
    | Annotated[Scatter, Tag("(scatter)")]
    | Annotated[Sensitivity, Tag("(sensitivity)")]
    | Annotated[Convergence, Tag("(convergence)")],
    Discriminator(
        _figure,
        custom_error_type="figure",
        custom_error_message="kind must be lines, map, characteristics, scatter, sensitivity or convergence",
    ),
]

# of the data set itself, besides `curve_...`
TAKEN = ("case", "step", "key", "status", "reason", "warnings", "seconds")


def _free(name: str) -> str:
    """Not the name of something else in the data set."""
    if name in TAKEN or name.startswith("curve_"):
        raise ValueError(f"'{shortened(name)}' is a name of the results; give another one, with entries:")
    return name


Name = Annotated[str, Field(pattern=r"^[A-Za-z_][A-Za-z0-9_.]*$"), AfterValidator(_free)]
"""Of a variable in the data set."""

GRIDS = ("grid", "together", "one_at_a_time")
SAMPLES = ("latin_hypercube", "sobol", "random", "sobol_indices")


class SweepSpec(Strict):
    """A sweep."""

    case: Annotated[str, Field(description="file of the base case, relative to the folder of the sweep file")]
    change: Annotated[dict[str, Any], Field(description="entries replaced in every case")] = Field({})
    vary: Annotated[dict[Name, AnyInput], Field(min_length=1, description="entry, or a name with `entries`, → values")]
    design: Annotated[
        Literal["grid", "together", "one_at_a_time", "latin_hypercube", "sobol", "random", "sobol_indices"],
        Field(description="how the inputs are combined"),
    ] = "grid"
    samples: Annotated[
        Whole | None, Field(ge=2, le=100_000_000, description="number of cases of a sampling design")
    ] = None
    seed: Annotated[Whole, Field(ge=0, description="seed of the random numbers of a sampling design")] = 0
    model: Annotated[
        Literal["rod", "uniform_rod"],
        Field(
            description="what computes each case: the rod, or in milliseconds a coil whose state is the same along it"
        ),
    ] = "rod"
    rods: Annotated[
        Whole,
        Field(
            ge=0, description="with `model: uniform_rod`: number of cases, the first ones, that the rod computes too"
        ),
    ] = 0
    time_limit: Annotated[float | None, Unit("s"), Field(gt=0, description="seconds after which a case is stopped")] = (
        None
    )
    figures: Annotated[
        list[AnyFigure] | None, Field(description="figures to draw; default: those that suit the design")
    ] = None

    @model_validator(mode="after")
    def _design_fits(self) -> Self:
        if self.design in SAMPLES and self.samples is None:
            raise ValueError(f"the design {self.design} needs 'samples'")
        if self.design in GRIDS and self.samples is not None:
            raise ValueError(f"the design {self.design} has no 'samples': its number of cases follows from the values")
        if self.rods and (self.model == "rod" or self.design not in SAMPLES):
            raise ValueError("'rods' needs 'model: uniform_rod', whose estimates they correct, and a sampling design")
        if self.design in ("sobol", "sobol_indices") and self.samples is not None and self.samples & (self.samples - 1):
            raise ValueError(f"the design {self.design} needs a power of 2 as 'samples', not {self.samples}")
        return self

    @model_validator(mode="after")
    def _figures_fit(self) -> Self:
        """Check, before any case runs, that every name in a figure is an input or a response."""
        responses = [f"{name}_found" if name in self.vary else name for name in RESPONSES]
        for number, figure in enumerate(self.figures or []):
            for role in ("x", "y", "panels", "colour", "of"):
                either = role == "colour" and figure.kind == "characteristics"
                known = responses if role == "of" else [*self.vary, *responses] if either else list(self.vary)
                for name in _names(getattr(figure, role, None)):
                    of_working = role == "of" or either
                    if name not in known and not (of_working and is_working_number(name)):
                        what = "no response of a case" if of_working else "none of the varied inputs"
                        near = get_close_matches(name, known, 1)
                        there = f"there are {', '.join(known)}" if len(known) <= LISTED else f"one is {known[0]}"
                        hint = f"is {near[0]} meant?" if near else there
                        raise ValueError(f"figures.{number}.{role}: '{shortened(name)}' is {what}; {hint}")
                    if figure.kind == "map" and role in ("x", "y") and not self.vary[name].is_numeric:
                        raise ValueError(
                            f"figures.{number}.{role}: '{shortened(name)}' has values that are no "
                            "numbers, and a map needs numbers; give kind: lines"
                        )
        return self


def _names(value: str | list[str] | None) -> list[str]:
    return [value] if isinstance(value, str) else value or []
