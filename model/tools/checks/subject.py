"""What is checked: the spring of a case, its wire, its states by the run or else by formulas."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from coilset.meshes.springs.geometry import Spring
from coilset.model.core.base.errors import InputError
from coilset.model.core.case import Case
from coilset.model.core.case.loading import is_turned, pulls
from coilset.model.core.case.material import case_elastic, case_law, case_strength
from coilset.model.core.case.phases import TimePhase
from coilset.model.core.material.law.law import CELSIUS
from coilset.model.core.material.law.steel import Elastic
from coilset.model.core.results.loading import Loading, loading_of
from coilset.model.tools.sheet.sheet import Sheet
from coilset.model.tools.standards import en13906
from coilset.model.tools.standards.rate import WireNumbers
from coilset.model.tools.wires import wire
from coilset.model.tools.wires.wire import ROOM_TEMPERATURE, Wire

NEAR_ROOM = 1.0  # K


@dataclass(frozen=True)
class Coil:
    """The active coil that a force along the axis stresses most, where D/d³ is greatest; lengths in mm.

    Attributes:
        d, D: wire and mean coil diameter; turn: where it is.
        of_stress: diameter of the round wire with the same stress by a torque.
        correction: greatest shear stress over the nominal one.
    """

    d: float
    D: float
    turn: float
    of_stress: float
    correction: float

    @classmethod
    def of(cls, spring: Spring) -> "Coil":
        """That of a spring."""
        start, end = spring.bottom.end_turns, spring.turns - spring.top.end_turns
        t = np.unique(np.concatenate([np.linspace(start, end, 257), spring.breaks]))
        t = t[(t >= start) & (t <= end)]
        wires, coils = spring.wire_diameter(t), 2.0 * spring.mean_radius(t)
        worst = int(np.argmax(coils / wires**3))
        d, D = float(wires[worst]), float(coils[worst])
        if spring.section is None:
            return cls(d, D, float(t[worst]), d, en13906.stress_correction(D / d))
        numbers = WireNumbers.of(spring.section, d, D)
        return cls(d, D, float(t[worst]), numbers.of_stress, numbers.correction)

    def stress(self, force: float) -> float:
        """Nominal uncorrected shear stress by a force, N, in MPa; positive."""
        return abs(en13906.stress(force, self.of_stress, self.D))


@dataclass(frozen=True)
class State:
    """A working state of the finished spring: length in mm, force in N, and whether a run gives it."""

    length: float
    force: float
    by_run: bool

    @property
    def place(self) -> str:
        """In words."""
        return f"at {self.length:.4g} mm"


@dataclass(frozen=True)
class Subject:
    """A spring and what is known of it.

    Attributes:
        case, spring: the spring is built from the case.
        made: its Sheet; None of a spring that is no cylinder of one wire.
        no_formula: why there is none.
        summary: of the run; empty without one.
        wire: of a standard, by its name; None of another material.
        strength: least tensile strength Rm, MPa; None if it is not known.
        elastic: moduli at the case's temperature.
    """

    case: Case
    spring: Spring
    made: Sheet | None
    no_formula: str
    summary: Mapping[str, Any]
    wire: Wire | None
    strength: float | None
    elastic: Elastic
    dynamic: bool = False
    loading: Loading = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "loading", self._loading())

    def _loading(self) -> Loading:
        if self.summary:
            return loading_of(self.summary)
        if is_turned(self.case, self.spring):
            return Loading.TURNED
        return Loading.PULLED if pulls(self.case, self.spring) else Loading.COMPRESSED

    @cached_property
    def coil(self) -> Coil:
        """The most stressed active coil."""
        return Coil.of(self.spring)

    @property
    def is_hot_coiled(self) -> bool:
        """Whether its wire is too thick to be coiled cold."""
        return en13906.is_hot_coiled(self.coil.d)

    @cached_property
    def states(self) -> tuple[State, ...]:
        """Working states: of the run, and those at lengths of the sheet."""
        found = list(self._reached())
        if self.made is not None:
            known = {round(one.length, 6) for one in found}
            for length in self.made.lengths:
                if round(length, 6) not in known:
                    run = self.made.found.force_at(length) if self.made.found else None
                    force = self.made.force(length) if run is None else run
                    found.append(State(length, force, run is not None))
        return tuple(sorted(found, key=lambda one: abs(one.force)))

    def _reached(self) -> Iterator[State]:
        for one in self.summary.get("working") or ():
            if not one["reason"]:
                yield State(one["length_mm"], one["force_N"], True)

    @property
    def free_length(self) -> float:
        """Of the finished spring where a run gives it, else as wound, mm."""
        after = self.summary.get("free_length_after_mm")
        return float(self.spring.free_length if after is None else after)

    @property
    def temperatures(self) -> tuple[float, ...]:
        """That of the case and those of its times, K; 20 °C without any."""
        given = [self.case.temperature, *(one.temperature for one in self.case.loading if isinstance(one, TimePhase))]
        return tuple(one for one in given if one is not None) or (ROOM_TEMPERATURE,)

    @property
    def is_warm(self) -> bool:
        """Whether it is warmer than where its wire's strength is known."""
        return max(self.temperatures) > ROOM_TEMPERATURE + NEAR_ROOM

    @property
    def warmth(self) -> str:
        """Why a limit is not known at this temperature, and what would make it known."""
        name = "the material" if self.wire is None else self.wire.name
        return (
            f"how the strength of {name} falls to {max(self.temperatures) - CELSIUS:.0f} °C was found in no "
            "source; below the limit of 20 °C, ask the wire's maker for its relaxation at this stress"
        )

    @property
    def no_strength(self) -> str:
        """Why there is no limit of the stress, and what would make it known."""
        return (
            f"the tensile strength of {self.case.material} is not known; give tensile_strength in its file, or a wire "
            "by its name"
        )


def subject(
    case: Case, spring: Spring, made: Sheet | None, summary: Mapping[str, Any], no_formula: str = ""
) -> Subject:
    """What is checked of a case; `made` is its sheet, None with the reason `no_formula`.

    Raises:
        InputError: a material that cannot be read.
    """
    if made is not None:
        known, strength, elastic = made.wire, made.least_strength, made.elastic
        return Subject(case, spring, made, "", summary, known, strength, elastic, made.dynamic)
    named = getattr(case.material, "wire", None)
    elastic = case_elastic(case, case_law(case, spring))
    known = wire(named) if named else None
    return Subject(case, spring, None, no_formula, summary, known, _strength(case, spring), elastic)


def _strength(case: Case, spring: Spring) -> float | None:
    try:
        return case_strength(case, spring)
    except InputError:  # a wire whose strength at this diameter is not known
        return None
