"""Where the force goes: resultants at both ends of the spring in every step, pressure along the wire, active turns."""

import csv
from dataclasses import asdict, dataclass, fields
from pathlib import Path

import numpy as np

from coilset.model.contact.base import ENDS
from coilset.model.contact.resultants import Wrench, station_forces, station_moments
from coilset.model.results.folder import whole

FAINT = 1e-6  # axial forces below this share of the greatest one so far have no centre and load no turns
ROUNDING = 2e-13  # axial forces below this share of E A are rounding, whatever came before


@dataclass(frozen=True)
class Bearing:
    """What one seat, or clamped head, does to the spring.

    Attributes:
        force_N: axial force, compression positive.
        lateral_x_N, lateral_y_N: force across the axis, with that of a held tip.
        moment_x_Nmm, moment_y_Nmm, moment_z_Nmm: about the point where the axis meets the seat, with those of a held
            tip; z along the axis.
        centre_x_mm, centre_y_mm: where the resultant crosses the seat (force centre), from the axis.
        eccentricity_mm: its distance from the axis.
        pressure_x_mm, pressure_y_mm: centre of the seat's pressure alone, without what a held tip takes.
        length_mm: length of wire in contact with the seat, to the spacing of its points.
        down_turns: turns from the wire's tip to the farthest place where it touches the seat.
        tilt_rad: angle between the seat's axis and the spring's.
    """

    force_N: float
    lateral_x_N: float
    lateral_y_N: float
    moment_x_Nmm: float
    moment_y_Nmm: float
    moment_z_Nmm: float
    centre_x_mm: float
    centre_y_mm: float
    eccentricity_mm: float
    pressure_x_mm: float
    pressure_y_mm: float
    length_mm: float
    down_turns: float
    tilt_rad: float


@dataclass(frozen=True)
class Resultants:
    """Both ends after one step.

    Attributes:
        step: number of the step.
        active_turns: turns that bear the load, ∫ (Mt/(F r))² dt: the number of turns under the torque F r throughout
            that would hold as much torsional energy, as in R = G d⁴/(64 r³ n).
        free_turns: turns of wire that touch neither seat nor coil.
        bottom, top: Bearings.
        pressure: one row for each point of the wire that bears: number of the kind of contact, number of the point,
            force per length of wire in N/mm; shape (m, 3). Between coils it is twice what the point itself has found,
            for both wires look for each other with half of the bedding each.
    """

    step: int
    active_turns: float
    free_turns: float
    bottom: Bearing
    top: Bearing
    pressure: np.ndarray

    def row(self):
        """As flat entries, without the pressure."""
        flat = {"step": self.step, "active_turns": self.active_turns, "free_turns": self.free_turns}
        for end in ENDS:
            flat |= {f"{end}_{name}": value for name, value in asdict(getattr(self, end)).items()}
        return flat

    @classmethod
    def from_row(cls, row, pressure):
        """The reverse of `row`."""
        ends = [Bearing(**{item.name: row[f"{end}_{item.name}"] for item in fields(Bearing)}) for end in ENDS]
        return cls(row["step"], row["active_turns"], row["free_turns"], *ends, pressure)


def observe(analysis, step):
    """Resultants of the equilibrium that was just reached; collective.

    Args:
        analysis: Analysis.
        step: Step.

    Returns:
        Resultants, the same on every rank.
    """
    system, x = analysis.system, analysis.system.gather(analysis.rod.x)
    parts = list(zip(system.contacts, system.contributions, strict=True))
    greatest = max(abs(other.force_N) for other in [*analysis.result.steps, step])
    faint = max(FAINT * greatest, ROUNDING * analysis.law.E * np.pi * analysis.wire_radius.max() ** 2)
    pressure = pressures(parts)
    bearings = [bearing(analysis, end, x, parts, faint) for end in ENDS]
    active = active_turns(analysis, step.force_N) if abs(step.force_N) > faint else np.nan
    return Resultants(step.number, active, free_turns(analysis, pressure), *bearings, pressure)


def end_wrench(analysis, end, x, parts):
    """Wrench of everything that an end's seat, or its held dofs, does to the wire."""
    own = [part for contact, part in parts if contact.end == end]
    station, components = analysis.drive.tips[end]
    reaction = np.zeros(6)
    reaction[components] = analysis.system.values(
        analysis.system.internal, analysis.system.station_dofs[station, components]
    )
    moments = station_moments(own, analysis.system.gather(analysis.rod.chart))
    held = Wrench.of(reaction[None, :3], x[[station]], reaction[None, 3:])
    return Wrench.of(station_forces(own, len(x)), x, moments) + held


def bearing(analysis, end, x, parts, faint):
    """The Bearing of an end."""
    wrench, centre = end_wrench(analysis, end, x, parts), analysis.drive.centre(end, x)
    side = 1.0 if end == "bottom" else -1.0  # the bottom pushes up
    crossing = wrench.crossing(centre) if abs(wrench.force[2]) > faint else np.full(2, np.nan)
    spot, length, down = np.full(2, np.nan), 0.0, 0.0
    for contact, part in parts:
        if contact.end == end and contact.points is not None:
            bears = part.bears
            number, wire = part.point[bears], contact.points
            points = wire.at(x)[number]
            length += float(wire.length[number].sum())
            down = float(np.abs(wire.turns[number] - wire.turns[contact.tip]).max(initial=down))
            if part.pressure.sum() > faint:
                spot = part.pressure[bears] @ points[:, :2] / part.pressure[bears].sum()
    numbers = (side * wrench.force[2], *wrench.force[:2], *wrench.about(centre), *crossing, np.hypot(*crossing), *spot,
               length, down, analysis.drive.tilt(end))  # fmt: skip
    return Bearing(*map(float, numbers))


def active_turns(analysis, force):
    """∫ (Mt/(F r))² dt over all turns, with the mean torque Mt and the distance r from the axis of each element."""
    rod, line = analysis.rod, analysis.rod.line
    owned = line.element[: line.owned_cells]
    torque = rod.s.values[:, :, 3].mean(axis=1)
    r = np.hypot(*rod.x[rod.cells].mean(axis=1)[:, :2].T)
    share = (torque / (force * r)) ** 2 @ np.diff(analysis.turns)[owned]
    return float(analysis.comm.allreduce(share))


def pressures(parts):
    """Rows of Resultants.pressure: forces of each kind of contact summed over the elements at a point of the wire."""
    rows = [np.empty((0, 3))]
    for kind, (contact, part) in enumerate(parts):
        if contact.points is None or not len(part.point):
            continue
        force = np.bincount(part.point, np.where(part.bears, part.pressure, 0.0), len(contact.points))
        bears = np.flatnonzero(force)
        halves = 1.0 if contact.end else 2.0
        rows.append(np.stack([np.full(len(bears), kind), bears, halves * force[bears] / contact.lengths[bears]], 1))
    return np.concatenate(rows)


def free_turns(analysis, pressure):
    """Turns of wire that touch nothing, each point for the turns that it stands for."""
    points = next((contact.points for contact in analysis.system.contacts if contact.points is not None), None)
    if points is None:
        return float("nan")
    step = 0.5 * np.diff(points.turns)
    share = np.append(step, 0.0) + np.append(0.0, step)
    return float(share.sum() - share[np.unique(pressure[:, 1].astype(int))].sum())


def write_seats(folder, resultants):
    """seats.csv: one row a step."""
    with whole(Path(folder) / "seats.csv") as path, open(path, "w", newline="", encoding="utf-8") as file:
        rows = [one.row() for one in resultants]
        writer = csv.DictWriter(file, list(rows[0]) if rows else ["step"])
        writer.writeheader()
        writer.writerows(rows)
