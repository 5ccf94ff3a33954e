"""Fatigue of the finished spring between its outermost working states, at every point of the wire's surface.

The stress there is that of the run: it has the residual stress of coiling, presetting, relief and peening in it, once.
"""

from collections.abc import Iterator
from functools import lru_cache
from typing import Any

import numpy as np

from coilset.model.core.base.warning import Warning
from coilset.model.core.results import surface
from coilset.model.core.results.records.record import Result, Setup, Working, WorkingState
from coilset.model.physics.fatigue.cycle import Cycle, tensors
from coilset.model.physics.fatigue.strength import Strength


def between(working: Working | None) -> tuple[WorkingState, WorkingState] | None:
    """The working states of the least and the greatest force; None with fewer than two."""
    reached = [] if working is None else [one for one in working.reached if one.snapshot is not None]
    if len(reached) < 2:
        return None
    return min(reached, key=lambda one: one.force), max(reached, key=lambda one: one.force)


def usage(setup: Setup, result: Result) -> tuple[tuple[str, np.ndarray, float], ...]:
    """Name of each criterion, its amplitudes on the surface, shape (n, sections, angles), and what is endured, MPa."""
    return () if setup.strength is None or result.working is None else _usage(setup.strength, result.working)


@lru_cache(maxsize=1)  # summary, warnings, data set and figures need it; a search over planes takes seconds
def _usage(strength: Strength, working: Working) -> tuple[tuple[str, np.ndarray, float], ...]:
    states = between(working)
    if states is None:
        return ()
    first, second = (
        tensors(one.snapshot.surface_state, one.snapshot.components) for one in states if one.snapshot is not None
    )
    return tuple(strength.loads(Cycle.between(first, second)))


def fatigue(setup: Setup, result: Result) -> tuple[dict[str, Any], ...]:
    """Entries of summary.json, one for each criterion: where the wire breaks first, safety and lives."""
    found = []
    for name, loads, endured in usage(setup, result):
        top = surface.peak(loads, setup.section_turns, setup.inside)
        safety = endured / max(top.value, 1e-300)
        assert setup.strength is not None
        entry = {"criterion": name, "amplitude_MPa": top.value, "endured_MPa": endured, "safety": safety}
        lives = setup.strength.lives(safety)
        found.append(entry | {"turn": top.turn, "angle_deg": top.angle, "lives": lives})
    return tuple(found)


def fatigue_warnings(setup: Setup, result: Result) -> Iterator[Warning]:
    """Criteria by which the spring does not endure, or that there are no two working states between which it works."""
    if setup.strength is None or result.working is None:
        return
    if between(result.working) is None:
        message = "fatigue needs two working states that the finished spring can have; it has fewer"
        yield Warning("fatigue", "working", message)
    for entry in fatigue(setup, result):
        if entry["safety"] < 1.0:
            top = f"{entry['amplitude_MPa']:.4g} MPa at turn {entry['turn']:.2f}"
            message = (
                f"by {entry['criterion']} the wire does not endure {setup.strength.cycles:.3g} cycles: its amplitude "
                f"of {top} is above {entry['endured_MPa']:.4g} MPa"
            )
            yield Warning("fatigue", entry["criterion"], message, entry["safety"], 1.0)
