"""What every kind of contact gives to the equilibrium: forces and stiffness on named degrees of freedom.

Degrees of freedom are numbered independently of the partition: 3 i + k is the displacement k of station i; after
those of the n stations come x, y, z and rotations θx, θy, θz of the bottom and of the top seat, 3 n + j, and after
these the stations' rotations since the last equilibrium, 3 n + 12 + 3 i + k. Every rank evaluates the contacts that act
on its own degrees of freedom: those of its part of the wire, and those of other parts near it, see
coilset.model.core.equilibrium.system.nearby.

Every kind is a `Contact`.
"""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from typing import NamedTuple

import numpy as np

from coilset.meshes.springs.ends import ENDS as ENDS
from coilset.model.core.body.state import State, Where
from coilset.model.core.contact.curve import WirePoints
from coilset.model.core.contact.elements import Room, extent_of_contact

SEAT_DOFS = 6  # x, y, z, θx, θy, θz; see plate.py
LEVEL = 2  # the one along the spring's axis
# A point counts as closed from this part of c w on, the force of its stiffness c over the distance w of its onset: by
# the law of the onset, c p²/(4 w), it has then sunk in by 4e-4 w, two millionths of a millimetre for a wire of 5 mm.
# Smaller forces are within the tolerance of the iteration.
CLOSED_OF_ONSET_FORCE = 4e-8


class Memory:
    """Named arrays that a contact carries from one equilibrium to the next, its part of the state.

    It writes the trial arrays and also reads those of the last equilibrium.

    Args:
        stations: name → station of each row of that array. The rank of the station has the row after an evaluation;
            the others may not. Arrays that are not named are known to every rank.
        arrays: name → values at the start, the same on every rank.

    Attributes:
        state: State that holds them.
    """

    def __init__(self, stations: Mapping[str, np.ndarray], **arrays: np.ndarray) -> None:
        self.state, self.stations = State(), dict(stations)
        for name, values in arrays.items():
            self.state.add(name, np.array(values, dtype=float), Where.SHARED)

    def committed(self, name: str) -> np.ndarray:
        """The array at the last equilibrium."""
        return self.state[name].equilibrium

    def __getitem__(self, name: str) -> np.ndarray:
        return self.state[name].trial

    def __setitem__(self, name: str, values: np.ndarray | float) -> None:
        self.state[name].trial[...] = values


class Part(NamedTuple):
    """The part of the wire on which a rank evaluates contacts: its own and what is near it.

    Attributes:
        elements: ranges of elements, ascending, shape (k, 2).
        own: which stations are the rank's own, shape (n,), bool.
    """

    elements: np.ndarray
    own: np.ndarray


class TrialPositions(NamedTuple):
    """Where stations and seats are at a trial state.

    Attributes:
        x: station positions, shape (n, 3), mm.
        seats: x, y, z and rotation vector of the bottom seat, then of the top seat, shape (12,), mm and rad.
        rotations: rotation vectors of the stations since the last equilibrium, shape (n, 3), rad, or None if no contact
            needs them.
        part: the part of the wire on which contacts are evaluated, or None if it is all of it.
    """

    x: np.ndarray
    seats: np.ndarray
    rotations: np.ndarray | None = None
    part: Part | None = None

    def points(self, points: WirePoints) -> np.ndarray:
        """Numbers of those of the wire's points at which contacts are evaluated."""
        return points.numbers if self.part is None else points.of(self.part.elements)


@dataclass(frozen=True)
class Contribution:
    """Forces and stiffness of m contact elements on k degrees of freedom each.

    Attributes:
        dofs: shape (m, k).
        forces: internal forces, the gradient of the contact's potential, shape (m, k), N.
        stiffness: shape (m, k, k), N/mm.
        pressure: compressive force of each element, positive when closed, shape (m,), N.
        penetration: how far the bodies overlap, shape (m,), mm; negative where they do not.
        point: number of each element's point or pair in its kind of contact, shape (m,).
        onset_force: c w of each element, shape (m,), N; 0 where there is none.
    """

    dofs: np.ndarray
    forces: np.ndarray
    stiffness: np.ndarray
    pressure: np.ndarray
    penetration: np.ndarray
    point: np.ndarray
    onset_force: np.ndarray

    @staticmethod
    def room(m: int, k: int) -> Room:
        """Arrays for up to m elements on k degrees of freedom each, not yet written, in the order of the attributes."""
        point, dofs = np.empty(m, np.int64), np.empty((m, k), np.int64)
        return dofs, np.empty((m, k)), np.empty((m, k, k)), np.empty(m), np.empty(m), point, np.empty(m)

    def only(self, elements: np.ndarray) -> "Contribution":
        """Some of the elements, given as numbers or as booleans."""
        return Contribution(*(getattr(self, field.name)[elements] for field in fields(self)))

    @classmethod
    def joined(cls, parts: Sequence["Contribution"]) -> "Contribution":
        """The elements of several parts, one after the other."""
        names = [field.name for field in fields(cls)]
        return cls(*(np.concatenate([getattr(part, name) for part in parts]) for name in names))

    @cached_property
    def bears(self) -> np.ndarray:
        """Which elements are closed, shape (m,)."""
        return self.pressure > CLOSED_OF_ONSET_FORCE * self.onset_force

    @cached_property
    def _extent(self) -> tuple[int, float]:
        if not len(self.point):
            return 0, 0.0
        return extent_of_contact(self.pressure, self.onset_force, CLOSED_OF_ONSET_FORCE, self.penetration)

    @property
    def closed(self) -> int:
        """Number of closed elements."""
        return self._extent[0]

    @property
    def deepest(self) -> float:
        """Maximum penetration, mm; 0 where no contact."""
        return self._extent[1]


def one_sided(g: np.ndarray, c: np.ndarray, onset: float) -> tuple[np.ndarray, np.ndarray]:
    """Compressive force and stiffness of one-sided springs whose contact sets in over a short distance.

    Contact pressure builds up gradually: with the penetration p = −g the force is c p²/(4w) up to p = 2w and
    c (p − w) beyond. Without such an onset the tangent jumps, and a line search can get stuck at the kink.

    Args:
        g: gaps, negative where the bodies overlap, shape (m,), mm.
        c: stiffness, shape (m,), N/mm.
        onset: w, mm.

    Returns:
        Force, positive where the bodies touch, N, and its derivative by p, N/mm.
    """
    within = np.clip(-g, 0.0, 2.0 * onset)
    return c * (within**2 / (4.0 * onset) + np.maximum(-g - 2.0 * onset, 0.0)), c * within / (2.0 * onset)


class Contact(ABC):
    """A kind of contact. What not every kind has comes with a default.

    Attributes:
        name: for labels.
        end: the rigid body that presses on the wire: seat `bottom` or `top`, `arbor` or `sleeve`; None between coils.
        needs_rotations: whether it needs `TrialPositions.rotations`.
        has_potential: whether its stiffness is symmetric.
        points: the wire's points on which it acts, which `Contribution.point` counts; None of a kind without.
        lengths: length of wire assigned to each of these, shape (m,), mm.
        memory: arrays that it carries from one equilibrium to the next; the owner of the state commits and restores
            them. None of a kind without.
        limits_step: whether it limits the penetration that a correction of the iteration may cause.
        multiplier_offset: the offset by which each point is pressed in addition to its penetration, mm, part of the
            memory; None of a kind whose penetration no augmented Lagrangian reduces.
        aside: number of stations; None of a kind that requires the positions of all stations. Else what acts on a
            station depends on those that are up to `aside` further along the wire from it, on points of the wire within
            `reach` of these, and on the stations up to `aside` further from those.
    """

    name: str
    end: str | None = None
    needs_rotations: bool = False
    has_potential: bool = True
    points: WirePoints | None = None
    lengths: np.ndarray = np.empty(0)
    memory: Memory | None = None
    limits_step: bool = False
    multiplier_offset: np.ndarray | None = None
    aside: int | None = None

    @abstractmethod
    def evaluate(self, trial: TrialPositions) -> Contribution:
        """Forces and stiffness at a trial state. A kind with a memory writes its trial arrays."""

    def max_penetration(self, trial: TrialPositions) -> float:
        """Maximum penetration, mm; 0 where no contact. Cheaper than `evaluate`, and writes nothing."""
        return 0.0

    def augment(self, trial: TrialPositions) -> None:
        """Increase each point's offset by its penetration, so that the next equilibrium needs less penetration."""

    @property
    def reach(self) -> float:
        """Distance, mm; see `aside`."""
        return 0.0

    def acts_on_seats(self, stations: np.ndarray, x: np.ndarray, seats: np.ndarray, span: np.ndarray) -> np.ndarray:
        """Which of some stations may be among those with which it acts on the seats, shape (m,), bool.

        Args:
            stations: their numbers, shape (m,).
            x: their positions, shape (m, 3), mm.
            seats: of both seats, shape (12,).
            span: how far stations that are `aside` of each other are apart along each axis at most, shape (3,), mm.
        """
        return np.zeros(len(stations), dtype=bool)

    def iterate(self) -> None:
        """Note that a correction starts from the state of the last evaluation, with its stiffness."""

    def forget_iterate(self) -> None:
        """Discard the predictions of the last correction; the next state is another one."""
