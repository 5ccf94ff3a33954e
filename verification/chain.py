"""Chains of rods, as in most benchmarks: nodes one after the other, driven in equal steps."""

from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy as np

from coilset.model.core.base.errors import SolveError
from coilset.model.core.material import library
from coilset.model.core.material.law.file import MaterialFile
from coilset.model.core.material.law.law import Law
from coilset.model.core.section.rules import DiskRule, polar
from coilset.verification.frame import Frame

ALL = range(6)  # components of a node
X, Y, Z, ROTATION_X, ROTATION_Y, ROTATION_Z = ALL


def elastic(E: float, nu: float) -> Law:
    """An elastic law with moduli other than the library's; E in MPa."""
    data = library.load("elastic").data.model_dump()
    data["temperatures"][0]["elasticity"] |= {"G": E / (2.0 * (1.0 + nu)), "nu": nu}
    return Law(MaterialFile.model_validate(data))


def chain(
    nodes: np.ndarray,
    radius: float,
    law: Law,
    rule: DiskRule | None = None,
    held: Iterable[tuple[int, Iterable[int]]] = ((0, ALL),),
    **options: Any,
) -> Frame:
    """A Frame whose rods join each node with the next one.

    Args:
        nodes: shape (n, 3), mm.
        radius: mm.
        law: material law.
        rule: of the section; default 2 × 8 points, exact for an elastic one.
        held: as for Frame; default: the first node is clamped.
        options: further ones of Frame.
    """
    pairs = [(k, k + 1) for k in range(len(nodes) - 1)]
    return Frame(nodes, pairs, radius, law, rule or polar(2, 8), held, **options)


def straight(length: float, elements: int) -> np.ndarray:
    """Nodes along x, shape (elements + 1, 3), mm."""
    return np.linspace([0.0, 0.0, 0.0], [length, 0.0, 0.0], elements + 1)


def drive(
    frame: Frame,
    steps: int,
    moves: Mapping[int, float] | None = None,
    forces: Mapping[int, float] | None = None,
    after: Callable[[], object] = lambda: None,
) -> list[int]:
    """Go in equal steps; each but the first starts from the last one's increments.

    Args:
        frame: Frame.
        steps: number of steps.
        moves: dof → displacement over all steps, mm or rad.
        forces: dof → force at the end of the steps, N or N mm.
        after: called after each step.

    Returns:
        Iterations of each step.

    Raises:
        SolveError: if a step does not converge.
    """
    counts = []
    for k in range(1, steps + 1):
        part = {dof: value / steps for dof, value in (moves or {}).items()}
        loads = {dof: value * k / steps for dof, value in (forces or {}).items()}
        outcome = frame.step(moves=part, forces=loads, predictor_scale=None if k == 1 else 1.0)
        if not outcome.converged:
            raise SolveError(f"step {k} of {steps}: {outcome.reason}")
        counts.append(outcome.iterations)
        after()
    return counts


def layered_bar(
    length: float,
    radius: float,
    elements: int,
    y: np.ndarray,
    area: np.ndarray,
    moduli: Mapping[str, float],
    way: np.ndarray,
) -> np.ndarray:
    """Forces of a cantilever with linear kinematic hardening, whose tip goes to the deflections `way`, mm; in N.

    Args:
        length, radius, elements: of the bar, mm.
        y, area: height and area of the section's layers, mm, mm².
        moduli: E, G, yield_stress and H, the slope of the axial stress over the plastic strain, MPa.
        way: deflections of the tip along y.

    Raises:
        SolveError: if a step does not converge.
    """
    E, G, H, k0 = moduli["E"], moduli["G"], moduli["H"], 2.0 / 3.0 * moduli["yield_stress"] ** 2  # k0: k² of deviators
    data = library.load("linear_kinematic").data.model_dump()
    constants = {
        "elasticity": {"G": G, "nu": E / 2.0 / G - 1.0},
        "isotropic": {"k0_squared": k0},
        "kinematic": {"a5": 1.0, "a6": 2.0 / 3.0 * H / np.sqrt(6.0 * k0), "a7": 0.0},
    }
    data["temperatures"] = [data["temperatures"][0] | constants]
    aside = np.sqrt((1.0 - (y / radius) ** 2) / 3.0)  # two points a layer, so that the bar is stiff in all directions
    both = np.concatenate([np.stack([y / radius, z], axis=1) for z in (aside, -aside)])
    rule = DiskRule(both, np.tile(0.5 * area / area.sum(), 2), "layers")
    bar = chain(straight(length, elements), radius, Law(MaterialFile.model_validate(data)), rule)
    forces, tip = [], bar.dof(elements, Y)
    for change in np.diff(way, prepend=0.0):
        drive(bar, 1, {tip: change})
        forces.append(bar.force(tip))
    return np.array(forces)
