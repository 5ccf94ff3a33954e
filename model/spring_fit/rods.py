"""A press by the uniform rod, in milliseconds, and by the whole rod with its ends and contacts."""

import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import yaml
from mpi4py import MPI
from scipy.interpolate import PchipInterpolator

from coilset.model.base.entry import check_entries
from coilset.model.case.case import Case
from coilset.model.material.law.law import Law
from coilset.model.results.records.record import Step
from coilset.model.run.analysis import Analysis
from coilset.model.spring_fit.pressing import Pressing
from coilset.model.uniform_coil.equivalent import coil
from coilset.model.uniform_coil.rod import UniformState, press

PRESS, RELEASE = 24, 8  # steps of a branch


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


def steps(pressing: Pressing, material: Mapping[str, Any], ends: Sequence[float | None]) -> Sequence[Step]:
    """Steps of the rod between its seats, with its contacts and the past of its wire.

    Args:
        pressing: of which spring.
        material: content of a material file.
        ends: as in `uniform`.

    Raises:
        SolveError: if it finds no equilibrium.
        InputError: if the spring cannot go there.
    """
    furthest = pressing.furthest
    loading = [
        {"to": {"force": 0.0} if end is None else {"travel": min(end, furthest)}, "steps": RELEASE if k % 2 else PRESS}
        for k, end in enumerate(ends)
    ]
    with tempfile.TemporaryDirectory(prefix="coilset-") as folder:
        file = Path(folder, "material.yaml")
        file.write_text(yaml.safe_dump(dict(material)), encoding="utf-8")
        entries = {"material": str(file), "loading": loading, "accuracy": "none", "rates_at": []}
        case = check_entries(pressing.case.model_dump(mode="json") | entries, Case)
        return Analysis(case, MPI.COMM_SELF, detailed=False).run().steps


def whole(pressing: Pressing, material: Mapping[str, Any], ends: Sequence[float | None]) -> list[Branch]:
    """The press by the whole rod; see `steps`."""
    run = steps(pressing, material, ends)
    found, start = [], (0.0, 0.0)
    for number in range(len(ends)):
        points = [start, *((step.travel_mm, step.force_N) for step in run if step.phase == number)]
        found.append(_branch(*zip(*points, strict=True)))
        start = points[-1]
    return found
