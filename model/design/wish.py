"""The wish: a case, the entries to find, their bounds, and the conditions that its run must meet."""

import copy
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Self

from annotated_types import Unit
from pydantic import AfterValidator, BeforeValidator, Field, model_validator

from coilset.model.base.entry import Strict, check_entries, shortened
from coilset.model.base.errors import InputError
from coilset.model.base.yaml import read_data
from coilset.model.case.case import Case, check, read_case_data
from coilset.model.case.settings import located

KIND = "a wish holds the entries find: and such_that:, and those of a case or case: with the name of its file"


class Bounds(Strict):
    """Bounds of an entry; `[9, 15]` in short."""

    low: Annotated[float, Unit("of the entry"), Field(alias="from", description="minimum value")]
    high: Annotated[float, Unit("of the entry"), Field(alias="to", description="maximum value")]

    @model_validator(mode="after")
    def _order(self) -> Self:
        if self.low >= self.high:
            raise ValueError(f"from {self.low:g} to {self.high:g} is not a range; 'from' must be the smaller one")
        return self


def _pair(value: Any) -> Any:
    """`[9, 15]` as a group."""
    if isinstance(value, list | tuple) and len(value) == 2:
        return {"from": value[0], "to": value[1]}
    if isinstance(value, dict | Bounds):
        return value
    raise ValueError("must be the minimum and the maximum value, as in [9, 15]")


def _not_zero(value: float) -> float:
    """Not 0."""
    if value == 0.0:
        raise ValueError("must not be 0: conditions are met relative to their size")
    return value


Millimetres = Annotated[float, Unit("mm"), Field(gt=0)]
Newtons = Annotated[float, Unit("N"), Field(gt=0)]
Stress = Annotated[float, Unit("MPa"), AfterValidator(_not_zero)]


class ForceAt(Strict):
    """A force at a height.

    It is read where the program's last phase to this height ends; without one, the spring goes there afterwards.
    """

    height: Annotated[Millimetres, Field(description="distance between the seats, mm")]
    N: Annotated[Newtons, Field(description="axial force at this height, N")]


class Conditions(Strict):
    """Conditions on the results at the end of the load program, as in `summary.json`."""

    free_length_after_mm: Annotated[Millimetres | None, Field(description="free length after the program, mm")] = None
    free_length_before_mm: Annotated[Millimetres | None, Field(description="free length as wound, mm")] = None
    set_mm: Annotated[Millimetres | None, Field(description="loss of free length, mm")] = None
    block_height_mm: Annotated[Millimetres | None, Field(description="height at which all coils touch, mm")] = None
    rate_N_per_mm: Annotated[
        float | None, Unit("N/mm"), Field(gt=0, description="initial rate of the spring as wound, N/mm")
    ] = None
    force_max_N: Annotated[Newtons | None, Field(description="maximum force of the program, N")] = None
    force_at: Annotated[
        list[ForceAt],
        BeforeValidator(lambda value: [value] if isinstance(value, dict | ForceAt) else value),
        Field(default_factory=list, strict=False, description="a force at a height, or a list of them"),
    ]
    residual_shear_inside_MPa: Annotated[
        Stress | None,
        Field(description="residual shear stress at the inside of the coil, MPa; presetting makes it negative"),
    ] = None
    shear_inside_max_MPa: Annotated[
        Stress | None, Field(description="maximum shear stress at the inside of the coil, MPa")
    ] = None
    plastic_work_max_N_per_mm2: Annotated[
        float | None, Unit("N/mm²"), Field(gt=0, description="maximum plastic work b* on the surface, N/mm²")
    ] = None

    @model_validator(mode="after")
    def _some(self) -> Self:
        if not any(value for _, value in self):
            raise ValueError("there is no condition; give one, as in free_length_after_mm: 50")
        return self


Name = Annotated[str, Field(pattern=r"^[A-Za-z_][A-Za-z0-9_.]*$")]


class WishSpec(Strict):
    """A wish. Besides these entries it holds those of a case, or `case` names the file of one."""

    case: Annotated[str | None, Field(description="file of the case, relative to the folder of the wish")] = None
    find: Annotated[
        dict[Name, Annotated[Bounds, BeforeValidator(_pair)]],
        Field(min_length=1, description="entry of the case → minimum and maximum value"),
    ]
    such_that: Annotated[Conditions, Field(description="the results that the run is to have")]
    trade_offs: Annotated[
        dict[Name, Annotated[list[Any], Field(min_length=1)]],
        Field(
            default_factory=dict, description="entry of the case → other values for which the wish is also estimated"
        ),
    ]

    @model_validator(mode="after")
    def _enough(self) -> Self:
        conditions = sum(len(value) if isinstance(value, list) else value is not None for _, value in self.such_that)
        if conditions < len(self.find):
            raise ValueError(
                f"{len(self.find)} unknowns and {conditions} condition(s): give as many conditions as "
                "unknowns, or more, which are met as well as they can be (least squares)"
            )
        for name in self.trade_offs:
            if name in self.find:
                raise ValueError(f"trade_offs.{name}: is an unknown; give an entry that is not")
        return self


@dataclass(frozen=True)
class Wish:
    """A wish, read and checked.

    Attributes:
        spec: WishSpec.
        base: raw data of the case; paths in it are absolute.
        file: where the wish came from, for messages.
    """

    spec: WishSpec
    base: dict[str, Any]
    file: Path

    def check(self, data: dict[str, Any]) -> Case:
        """The Case of raw data; raises InputError."""
        return check(data, self.file)


def read_wish(path: str | Path) -> Wish:
    """Read and check a wish.

    Raises:
        InputError: one line with file, place, value and what would be right.
    """
    data, path = read_data(path, KIND), Path(path)
    own = {name: value for name, value in data.items() if name in WishSpec.model_fields}
    base = {name: value for name, value in data.items() if name not in own}
    if not {"find", "such_that"} & data.keys():
        raise InputError(KIND, "", path)
    spec, folder = check_entries(own, WishSpec, path), path.parent
    if spec.case is not None:
        if base:
            raise InputError(
                "is an entry of a case, and case: names one already; give it there, or leave case: out",
                shortened(next(iter(base))),
                path,
            )
        base, folder = read_case_data(folder / spec.case), (folder / spec.case).parent
    base = copy.deepcopy({name: located(name, value, folder.absolute()) for name, value in base.items()})
    check(base, path if spec.case is None else folder / Path(spec.case).name)
    return Wish(spec, base, path)
