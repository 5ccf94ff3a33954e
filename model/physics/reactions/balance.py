"""Global balance: at every cut, force and moment in the wire balance the external loads before the cut."""

from collections.abc import Sequence

import numpy as np

from coilset.model.core.equilibrium.system.heads import Heads
from coilset.model.core.equilibrium.system.layout import LineLayout
from coilset.model.core.equilibrium.system.system import System
from coilset.model.core.results.records.record import Snapshot
from coilset.model.physics.reactions.resultants import station_forces, station_moments


def section_wrenches(
    x: np.ndarray, triads: np.ndarray, resultants: np.ndarray, weights: Sequence[float]
) -> tuple[np.ndarray, np.ndarray]:
    """Force and moment of the wire behind a cut on the wire before it, for a cut through each element.

    No load acts on an element between its nodes, so the force is the mean over its sections, and the moment at
    its first node follows from the virtual work of the strains (5.2.4): E (Mt, M2 − Q3 l/2, M3 + Q2 l/2).

    Args:
        x: station positions, shape (n + 1, 3), mm.
        triads: of the elements (columns), shape (n, 3, 3).
        resultants: N, Q2, Q3, Mt, M2, M3 at the sections, shape (n, sections, 6), N and N mm.
        weights: of the sections.

    Returns:
        Forces and moments about the origin, shape (n, 3) each, N and N mm.
    """
    l = np.linalg.norm(np.diff(x, axis=0), axis=1)
    N, Q2, Q3, Mt, M2, M3 = np.einsum("ngi,g->in", resultants, weights)
    force = np.einsum("nij,jn->ni", triads, [N, Q2, Q3])
    moment = np.einsum("nij,jn->ni", triads, [Mt, M2 - 0.5 * Q3 * l, M3 + 0.5 * Q2 * l])
    return force, moment + np.cross(x[:-1], force)


def imbalance(shot: Snapshot, system: System, control: Heads) -> tuple[float, float]:
    """Imbalance of seats, contacts and section forces; collective, complete on rank 0.

    Args:
        shot: Snapshot of the equilibrium.
        system: System of a Rod at that equilibrium.
        control: Heads.

    Returns:
        Maximum imbalance of force over all cuts, N, and of moment about the origin, N mm. The last cut is behind the
            whole wire, so that the wrenches of both seats are checked too.
    """
    layout, x = system.layout, shot.x
    assert isinstance(layout, LineLayout)
    contacts = system.gathered_contacts()
    forces = station_forces(contacts, len(x))
    moments = station_moments(contacts, layout.gather(layout.rod.chart))
    for end, (station, _) in control.tips.items():
        reaction = control.on_tip(end)
        forces[station] += reaction[:3]
        moments[station] += reaction[3:]
    if system.comm.rank:
        return np.nan, np.nan
    before = np.cumsum(forces, axis=0), np.cumsum(np.cross(x, forces) + moments, axis=0)
    behind = section_wrenches(x, shot.triads, shot.resultants, layout.rod.element.weights)
    lacking = [a + np.vstack([b, np.zeros(3)]) for a, b in zip(before, behind, strict=True)]
    force, moment = (float(np.linalg.norm(lack, axis=1).max()) for lack in lacking)
    return force, moment
