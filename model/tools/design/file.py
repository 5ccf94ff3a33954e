"""The file of a design: a case, the unknowns in it, and the conditions that its run must meet."""

import copy
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Self

from annotated_types import Unit
from pydantic import AfterValidator, BeforeValidator, Discriminator, Field, Tag, model_validator

from coilset.model.core.base.entry import Strict, check_entries, shortened
from coilset.model.core.base.errors import InputError, naming
from coilset.model.core.base.yaml import read_data
from coilset.model.core.case.case import Case, check, read_case_data
from coilset.model.core.case.settings import located
from coilset.model.physics.working.working import QUANTITIES, is_working_number, number_name
from coilset.model.tools.design.unknowns import Choices, Name, Unknown, refuse_twice

KIND = "a design file holds the entries find: and such_that:, and those of a case or case: with the name of its file"


def _of_working(name: str) -> str:
    """A number of a working state."""
    if not is_working_number(name):
        numbers = ", ".join(number_name(quantity, 37) for quantity in QUANTITIES if quantity != "length")
        raise ValueError(f"'{shortened(name)}' is no number of a working state; they are {numbers}, length_at_250_mm")
    return name


class Limits(Strict):
    """Limits of a result in place of a value."""

    at_least: Annotated[float | None, Unit("of the result"), Field(description="minimum")] = None
    at_most: Annotated[float | None, Unit("of the result"), Field(description="maximum")] = None

    @model_validator(mode="after")
    def _order(self) -> Self:
        if self.at_least is None and self.at_most is None:
            raise ValueError("is empty; give at_least or at_most, or both, as in {at_least: 24, at_most: 26}")
        if None not in (self.at_least, self.at_most) and self.at_least >= self.at_most:  # type: ignore[operator]
            raise ValueError(
                f"at_least {self.at_least:g} leaves nothing below at_most {self.at_most:g}; for one value "
                "give the number alone"
            )
        return self


OR_LIMITS = Discriminator(lambda value: "(limits)" if isinstance(value, dict | Limits) else "(value)")
OrLimits = Annotated[Limits, Tag("(limits)")]
Positive = Field(gt=0)
Length = Annotated[Annotated[float, Unit("mm"), Positive, Tag("(value)")] | OrLimits, OR_LIMITS]
Signed = Annotated[Annotated[float, Unit("mm"), Tag("(value)")] | OrLimits, OR_LIMITS]
Load = Annotated[Annotated[float, Unit("N"), Tag("(value)")] | OrLimits, OR_LIMITS]
Force = Annotated[Annotated[float, Unit("N"), Positive, Tag("(value)")] | OrLimits, OR_LIMITS]
Rate = Annotated[Annotated[float, Unit("N/mm"), Positive, Tag("(value)")] | OrLimits, OR_LIMITS]
TurnRate = Annotated[Annotated[float, Unit("N mm/°"), Positive, Tag("(value)")] | OrLimits, OR_LIMITS]
Torque = Annotated[Annotated[float, Unit("N mm"), Tag("(value)")] | OrLimits, OR_LIMITS]
Turn = Annotated[Annotated[float, Unit("degrees"), Tag("(value)")] | OrLimits, OR_LIMITS]
Work = Annotated[Annotated[float, Unit("N/mm²"), Positive, Tag("(value)")] | OrLimits, OR_LIMITS]
Size = Annotated[Annotated[float, Tag("(value)")] | OrLimits, OR_LIMITS]
Stress = Annotated[Annotated[float, Unit("MPa"), Tag("(value)")] | OrLimits, OR_LIMITS]


class ForceAt(Strict):
    """A force at a height.

    It is read where the program's last phase to this height ends; without one, the spring goes there afterwards.
    """

    height: Annotated[float, Unit("mm"), Field(gt=0, description="distance between the seats, mm")]
    N: Annotated[Load, Field(description="axial force at this height, N, negative in tension; a number or limits")]


class Conditions(Strict):
    """Conditions on the results at the end of the load program, as in `summary.json`: a number, or limits."""

    free_length_after_mm: Annotated[Length | None, Field(description="free length after the program, mm")] = None
    free_length_before_mm: Annotated[Length | None, Field(description="free length as wound, mm")] = None
    set_mm: Annotated[Signed | None, Field(description="loss of free length, mm; negative of an extension spring")] = (
        None
    )
    block_height_mm: Annotated[Length | None, Field(description="height at which all coils touch, mm")] = None
    rate_N_per_mm: Annotated[Rate | None, Field(description="initial rate of the spring as wound, N/mm")] = None
    force_max_N: Annotated[
        Load | None, Field(description="force of largest magnitude of the program, N; negative in tension")
    ] = None
    open_rate_N_per_mm: Annotated[Rate | None, Field(description="rate of an extension spring with open coils")] = None
    initial_tension_after_N: Annotated[
        Force | None, Field(description="initial tension that the last release leaves, N")
    ] = None
    turn_rate_Nmm_per_deg: Annotated[TurnRate | None, Field(description="rate of a torsion spring, N mm/°")] = None
    torque_max_Nmm: Annotated[Torque | None, Field(description="maximum torque of a torsion spring, N mm")] = None
    turn_set_deg: Annotated[
        Turn | None, Field(description="rotation that a torsion spring keeps, degrees, with the sign of its rotation")
    ] = None
    inner_diameter_min_mm: Annotated[
        Length | None, Field(description="smallest inner diameter of the coils under load, for an arbor, mm")
    ] = None
    force_at: Annotated[
        list[ForceAt],
        BeforeValidator(
            lambda value: [value] if isinstance(value, dict | ForceAt) else value,
            json_schema_input_type=ForceAt | list[ForceAt],
        ),
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
        Work | None, Field(description="maximum plastic work b* on the surface, N/mm²")
    ] = None

    working: Annotated[
        dict[Annotated[str, AfterValidator(_of_working)], Size],
        Unit("of the result"),
        Field(
            description="numbers of the finished spring at working lengths, such as force_at_37_N: 250 or "
            "safety_at_37: {at_least: 1.1}"
        ),
    ] = Field(default_factory=dict)

    @model_validator(mode="after")
    def _some(self) -> Self:
        if all(value in (None, [], {}) for _, value in self):
            raise ValueError("there is no condition; give one, as in free_length_after_mm: 50")
        return self


class DesignFile(Strict):
    """A design. Besides these entries it holds those of a case, or `case` names the file of one."""

    case: Annotated[str | None, Field(description="file of the case, relative to the folder of this file")] = None
    find: Annotated[
        dict[Name, Unknown],
        Field(
            min_length=1,
            description="the unknowns: entry of the case, or a name with `entries`, → range, factor or choices",
        ),
    ]
    such_that: Annotated[
        Conditions,
        Field(
            default_factory=Conditions.model_construct,
            description="the conditions: results that the run is to have, beside the limits of the case",
        ),
    ]
    trade_offs: Annotated[
        dict[Name, Annotated[list[Any], Field(min_length=1)]],
        Field(default_factory=dict, description="entry of the case → other values for which the design is estimated"),
    ]

    @model_validator(mode="after")
    def _driven_once(self) -> Self:
        refuse_twice(self.find)
        driven = {entry: name for name, one in self.find.items() for entry in one.driven(name)}
        for name in self.trade_offs:
            if name in driven:
                raise ValueError(f"trade_offs.{name}: is an unknown; give an entry that is not")
        return self

    def refuse_too_few(self, limits: int) -> None:
        """Reject fewer conditions than unknowns; so many `limits` of the case are conditions too.

        Raises:
            InputError: with both numbers.
        """
        conditions = limits + sum(
            len(value) if isinstance(value, list | dict) else value is not None for _, value in self.such_that
        )
        ranges = [name for name, one in self.find.items() if not isinstance(one, Choices)]
        if conditions < len(ranges):
            raise InputError(
                f"{len(ranges)} unknowns and {conditions} condition(s): give as many conditions as "
                "unknowns, or more, which are met as well as they can be (least squares)"
            )


@dataclass(frozen=True)
class Design:
    """A design file, read and checked.

    Attributes:
        spec: its own entries.
        base: raw data of the case; paths in it are absolute.
        file: where it came from, for messages.
    """

    spec: DesignFile
    base: dict[str, Any]
    file: Path

    def check(self, data: dict[str, Any]) -> Case:
        """The Case of raw data; raises InputError."""
        return check(data, self.file)


def read_design_file(path: str | Path) -> Design:
    """Read and check the file of a design.

    Raises:
        InputError: one line with file, place, value and what would be right.
    """
    data, path = read_data(path, KIND), Path(path)
    own = {name: value for name, value in data.items() if name in DesignFile.model_fields}
    base = {name: value for name, value in data.items() if name not in own}
    if not {"find", "such_that"} & data.keys():
        raise InputError(KIND, "", path)
    spec, folder = check_entries(own, DesignFile, path), path.parent
    if spec.case is not None:
        if base:
            raise InputError(
                "is an entry of a case, and case: names one already; give it there, or leave case: out",
                shortened(next(iter(base))),
                path,
            )
        base, folder = read_case_data(folder / spec.case), (folder / spec.case).parent
    base = copy.deepcopy({name: located(name, value, folder.absolute()) for name, value in base.items()})
    case = check(base, path if spec.case is None else folder / Path(spec.case).name)
    with naming(path):
        spec.refuse_too_few(len(case.limits or ()))
    return Design(spec, base, path)
