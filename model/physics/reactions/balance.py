"""Global balance: at every cut, force and moment in the wire balance the external loads before the cut."""

import numpy as np

from coilset.model.core.equilibrium.system.heads import Heads
from coilset.model.core.equilibrium.system.layout import LineLayout
from coilset.model.core.equilibrium.system.system import System
from coilset.model.core.results.records.record import Snapshot
from coilset.model.physics.reactions.resultants import station_forces, station_moments


def imbalance(shot: Snapshot, system: System, control: Heads) -> tuple[float, float]:
    """Imbalance of seats, contacts and elements; collective, complete on rank 0.

    There is a cut in front of each element, on which no load acts between its nodes.

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
    behind = layout.line.in_order(layout.rod.wrenches_on_first_nodes())
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
    wrenches = behind[:, :3], behind[:, 3:] + np.cross(x[:-1], behind[:, :3])
    lacking = [a + np.vstack([b, np.zeros(3)]) for a, b in zip(before, wrenches, strict=True)]
    force, moment = (float(np.linalg.norm(lack, axis=1).max()) for lack in lacking)
    return force, moment
