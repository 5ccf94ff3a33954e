"""The past of a rod's wire: coiled from straight wire, it is not free of stress before its first load."""

import numpy as np

from coilset.meshes.errors import InputError, SolveError
from coilset.meshes.placement import STRAIGHT
from coilset.model.rod.rod import Rod
from coilset.model.section.coiling import coil

DIGITS = 9  # to which sections must agree to be coiled alike


def coil_wire(rod: Rod) -> float:
    """Give all sections the stresses that coiling leaves; collective.

    Args:
        rod: whose sections know the wire's curvature; its equilibrium is replaced, without a force on any section.

    Returns:
        Mean diameter to which the wire was coiled at mid-wire, before it sprang back, mm.

    Raises:
        InputError: if the wire cannot be coiled to the spring.
    """
    place, problem = rod.placement, None
    tight = np.zeros((2, *place.curvature.shape))
    try:
        _coil_sections(rod, tight)
    except SolveError as error:
        problem = str(error)
    problem = next((one for one in rod.mesh.comm.allgather(problem) if one), None)
    if problem:
        wanted = "'coiling' needs a wire that yields and keeps its shape"
        raise InputError(f"{wanted}: {problem}", "spring.made_by")
    rod.state.restore()
    rod.update()
    ordered = rod.mesh.comm.bcast(rod.line.in_order(np.moveaxis(tight, 0, -1)))
    curvature, torsion = ordered[len(ordered) // 2, 0]
    return float(2.0 * curvature / (curvature**2 + torsion**2))


def _coil_sections(rod: Rod, tight: np.ndarray) -> None:
    """Write the states of all sections, and their curvature and torsion before they sprang back."""
    place = rod.placement
    radius = np.broadcast_to(rod.radius[:, None], place.curvature.shape)
    wires = np.stack([radius, place.curvature, place.torsion], axis=-1).reshape(-1, 3)
    size = np.abs(wires).max(axis=0, initial=0.0)
    alike = np.round(wires / np.where(size > 0.0, size, 1.0), DIGITS)
    _, first, which = np.unique(alike, axis=0, return_index=True, return_inverse=True)
    virgin, guess = rod.sections.initial_state()["point_state"], None
    points, surface = (rod.state[name].equilibrium for name in ("point_state", "surface_state"))
    for k, (radius, curvature, torsion) in enumerate(wires[first]):
        if curvature < STRAIGHT:
            continue
        if guess is not None:  # as the last one, turned by as much more as this one is
            guess = guess[0] + curvature - wires[first][k - 1, 1], guess[1] + torsion - wires[first][k - 1, 2]
        coiled = coil(rod.parameters, rod.rule, radius, curvature, torsion, virgin[0, 0, :1], guess=guess)
        guess = coiled.turned
        here = np.nonzero((which == k).reshape(place.curvature.shape))
        points[here], surface[here] = coiled.points, coiled.surface
        tight[0][here], tight[1][here] = coiled.curvature, coiled.torsion
