"""The nest file: an outer and an inner spring, and how far their common seats press them."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

from annotated_types import Unit
from pydantic import Discriminator, Field, Tag

from coilset.model.core.base.entry import Strict, Whole, check_entries
from coilset.model.core.base.errors import InputError
from coilset.model.core.base.yaml import read_data
from coilset.model.core.case import Case, UnloadedCase, read_case

KIND = "a nest holds the entries outer:, inner: and loading:"
NAMES = ("outer", "inner")


class Member(Strict):
    """One of the two springs."""

    case: Annotated[str, Field(description="its case file, from the nest file's folder; a loading in it is not used")]


class Height(Strict):
    """A height of the common seats."""

    height: Annotated[float, Unit("mm"), Field(gt=0, description="distance of the seats, mm")]


class Press(Strict):
    """Move the seats."""

    to: Annotated[
        Annotated[Literal["block"], Tag("(block)")] | Annotated[Height, Tag("(height)")],
        Discriminator(lambda value: "(block)" if isinstance(value, str) else "(height)"),
        Field(description="block, of the spring that has it first, or {height: mm}"),
    ]
    steps: Annotated[Whole, Field(gt=0, le=100_000, description="number of equal steps")] = 12


class NestFile(Strict):
    """Two springs between the same seats. At the end both are released."""

    outer: Annotated[Member, Field(description="the spring outside")]
    inner: Annotated[Member, Field(description="the spring inside it")]
    loading: Annotated[
        list[Press],
        Field(
            min_length=1,
            strict=False,
            description="where the seats go, one after the other; from the height at "
            "which they touch the longer spring",
        ),
    ]


@dataclass(frozen=True)
class Nest:
    """The content of a nest file.

    Attributes:
        cases: of the outer and the inner spring.
        loading: as in the file.
        path: of the file.
        files: of the two cases.
    """

    cases: tuple[Case, Case]
    loading: tuple[Press, ...]
    path: Path
    files: tuple[Path, Path]


def read_nest(path: str | Path) -> Nest:
    """Read and check a nest file and the two case files that it names.

    Raises:
        InputError: one line with file, place, value and what would be right.
    """
    path = Path(path)
    data = check_entries(read_data(path, KIND), NestFile, path)
    cases, files = [], [path.parent / getattr(data, name).case for name in NAMES]
    for file in files:
        case = read_case(file, kind=UnloadedCase)
        if case.ends != "seats":
            raise InputError("a nest is compressed between seats; give ends: seats", "ends", file)
        if case.seats.bottom.moves or case.seats.top.moves:
            raise InputError(
                "seats that tilt or move aside are shared by both springs of a nest, which is not modelled; "
                "give rigid ones",
                "seats",
                file,
            )
        if "conical" in (case.seats.bottom.shape, case.seats.top.shape):
            raise InputError(
                "a cone touches each spring of a nest at a height of its own, so that they have none in "
                "common; give other seats",
                "seats",
                file,
            )
        if case.heat is not None:
            raise InputError("takes time to flow, and the seats of a nest take none; leave it out", "heat", file)
        cases.append(case)
    return Nest((cases[0], cases[1]), tuple(data.loading), path, (files[0], files[1]))
