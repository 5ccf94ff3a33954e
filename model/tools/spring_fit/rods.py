"""A press by the uniform rod, in milliseconds, and by the whole rod with its ends and contacts."""

import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import yaml
from mpi4py import MPI
from scipy.interpolate import PchipInterpolator

from coilset.model.compose.analysis import Analysis
from coilset.model.core.base.entry import check_entries
from coilset.model.core.case.case import Case
from coilset.model.core.material.law.law import Law
from coilset.model.core.results.records.record import Step
from coilset.model.core.results.records.releases import releases
from coilset.model.physics.manufacture.entries import Relief
from coilset.model.physics.uniform_coil.equivalent import coil
from coilset.model.physics.uniform_coil.past import coiled
from coilset.model.physics.uniform_coil.rod import UniformState, press
from coilset.model.tools.spring_fit.pressing import Pressing

PRESS, RELEASE = 24, 8  # steps of a branch of the uniform rod
LAST = 0.15  # of the force: end coils open in the last part of a release, which has steps of its own


class Steps(NamedTuple):
    """How finely a rod follows a press: steps down, back, over the last part; and what its mesh has unlike the case's.

    Attributes:
        press, back, last: numbers of steps.
        mesh: entries of the mesh, but for its section.
        section: rings and angles of its section.
        shaped: whether `section` holds for any wire; else only for round wire that was not coiled.
    """

    press: int
    back: int
    last: int
    mesh: Mapping[str, Any] = {}
    section: Mapping[str, int] = {}
    shaped: bool = True


USUAL = Steps(12, 8, 12, {}, {"radial": 5, "angular": 12}, False)  # half of the default's time, its curves
COARSE = Steps(12, 3, 3, {"elements_per_turn": 8, "sagitta": None}, {"radial": 4, "angular": 12})  # to begin with


@dataclass(frozen=True)
class Branch:
    """Force over travel of one branch, at the ends of its steps, in ascending travel; mm and N."""

    travel: np.ndarray
    force: np.ndarray

    @cached_property
    def _curve(self) -> PchipInterpolator:
        return PchipInterpolator(self.travel, self.force)

    def at(self, travel: np.ndarray) -> np.ndarray:
        """Force, N, straight beyond the ends."""
        inside = np.clip(travel, self.travel[0], self.travel[-1])
        return self._curve(inside) + self.slope(travel) * (travel - inside)

    def slope(self, travel: np.ndarray) -> np.ndarray:
        """Rate, N/mm."""
        return self._curve.derivative()(np.clip(travel, self.travel[0], self.travel[-1]))

    def places(self, count: int) -> np.ndarray:
        """Travels at equal distances from its lower to its upper end, shape (count,)."""
        return np.linspace(self.travel[0], self.travel[-1], count)

    @property
    def free(self) -> float:
        """The travel at its lower end, mm."""
        return float(self.travel[0])


def _branch(travel: npt.ArrayLike, force: npt.ArrayLike) -> Branch:
    """Of steps in any order; those that add no travel are left out."""
    x, y = np.asarray(travel, float), np.asarray(force, float)
    order = np.argsort(x, kind="stable")
    x, y = x[order], y[order]
    new = np.append(True, np.diff(x) > 1e-9 * max(abs(x[0]), abs(x[-1])))
    return Branch(x[new], y[new])


def uniform(pressing: Pressing, law: Law, ends: Sequence[float | None]) -> list[Branch]:
    """The press by the uniform rod.

    Args:
        pressing: of which spring.
        law: of its wire.
        ends: as in Pressing, of the spring alone.

    Raises:
        SolveError: if there is no equilibrium.
    """
    state: np.ndarray | UniformState = coil(pressing.spring)
    if pressing.coiled:
        state = _coiled(law, tuple(coil(pressing.spring).tolist()), pressing.relief, pressing.case.temperature)
    free, temperature = pressing.case.ends_turn, pressing.case.temperature
    travel, force, found = 0.0, 0.0, []
    for number, end in enumerate(ends):
        steps = RELEASE if number % 2 else PRESS
        if end is None:
            forces = np.linspace(force, 0.0, steps + 1)
            way, state = press(state, law, forces=forces[1:], free_ends=free, temperature=temperature)
            travels = np.append(travel, way[0])
        else:
            travels = np.linspace(travel, end, steps + 1)
            way, state = press(state, law, travels=travels[1:], free_ends=free, temperature=temperature)
            forces = np.append(force, way[0])
        travel, force = float(travels[-1]), float(forces[-1])
        found.append(_branch(travels, forces))
    return found


@lru_cache(maxsize=4)
def _coiled(law: Law, one: tuple[float, ...], relief: Relief | None, temperature: float | None) -> UniformState:
    return coiled(np.array(one), law, relief, temperature)


def steps(
    pressing: Pressing, material: Mapping[str, Any], ends: Sequence[float | None], fine: Steps = USUAL
) -> list[list[Step]]:
    """Steps of each branch of the rod between its seats, with its contacts and the past of its wire.

    Where lengths are measured, they are of the spring that nothing holds: a release ends at its travel.

    Args:
        pressing: of which spring.
        material: content of a material file.
        ends: as in `uniform`.
        fine: how finely.

    Raises:
        SolveError: if it finds no equilibrium.
        InputError: if the spring cannot go there.
    """
    program = list(_program(pressing, ends, fine))
    with tempfile.TemporaryDirectory(prefix="coilset-") as folder:
        file = Path(folder, "material.yaml")
        file.write_text(yaml.safe_dump(dict(material)), encoding="utf-8")
        loading = [phase for _, phase in program]
        entries = pressing.case.model_dump(mode="json")
        release = "free" if pressing.lengths else "held"  # a tester holds the spring whose force it reads
        entries |= {"material": str(file), "loading": loading, "accuracy": "none", "rates_at": [], "release": release}
        section = entries["mesh"]["section"]
        if section["kind"] != "warping":
            entries["mesh"] |= fine.mesh
            if fine.shaped or (entries["spring"].get("wire") is None and not pressing.coiled):
                section |= fine.section
        analysis = Analysis(check_entries(entries, Case), MPI.COMM_SELF, detailed=False)
        result = analysis.run()
    freed = {one.step.number: one.set for one in releases(analysis.setup, result) if one.snapshot.free}
    run = [replace(step, travel_mm=freed.get(step.number, step.travel_mm)) for step in result.steps]
    return [[step for step in run if program[step.phase][0] == branch] for branch in range(len(ends))]


def _program(pressing: Pressing, ends: Sequence[float | None], fine: Steps) -> Iterator[tuple[int, dict[str, Any]]]:
    """The branch of each phase, and the phase."""
    furthest = pressing.furthest
    for branch, end in enumerate(ends):
        if end is not None:
            yield branch, {"to": {"travel": min(end, furthest)}, "steps": fine.back if branch % 2 else fine.press}
            continue
        top = LAST * float(np.max(pressing.force[pressing.branch == branch - 1], initial=0.0))
        if top > 0.0:  # free lengths have no force
            yield branch, {"to": {"force": top}, "steps": fine.back}
        yield branch, {"to": {"force": 0.0}, "steps": fine.last}


def whole(
    pressing: Pressing, material: Mapping[str, Any], ends: Sequence[float | None], fine: Steps = USUAL
) -> tuple[list[Branch], float]:
    """The press by the whole rod, and the greatest plastic work per volume, N/mm²; see `steps`."""
    run = steps(pressing, material, ends, fine)
    found, start = [], (0.0, 0.0)
    for branch in run:
        points = [start, *((step.travel_mm, step.force_N) for step in branch)]
        found.append(_branch(*zip(*points, strict=True)))
        start = points[-1]
    return found, max(step.plastic_work_max_N_per_mm2 for branch in run for step in branch)
