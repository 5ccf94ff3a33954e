"""The contacts of a system on one or several ranks: each evaluates what acts on its own unknowns."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from mpi4py import MPI

from coilset.model.core.base.agreement import max_of_ranks
from coilset.model.core.contact.base import Contact, Contribution, Memory, TrialPositions
from coilset.model.core.equilibrium.system.layout import LineLayout
from coilset.model.core.equilibrium.system.nearby import Nearby

AUGMENTED = "multiplier_offset"  # the part of a memory that `augment` changes


class ContactParts:
    """Contacts, evaluated at positions of this rank's nodes.

    Args:
        layout: LineLayout.
        contacts: kinds of contact.

    Attributes:
        need_rotations: whether some kind needs the rotations of the nodes.
        detached: whether only coils touch each other, and no seat, guide or head.
    """

    def __init__(self, layout: LineLayout, contacts: Sequence[Contact]) -> None:
        self.layout, self.comm, self.contacts = layout, layout.comm, contacts
        self._nearby = Nearby(layout, contacts)
        self.need_rotations = any(contact.needs_rotations for contact in contacts)
        self.detached = False
        self._limiting_numbers = [number for number, contact in enumerate(contacts) if contact.limits_step]
        self._limiting = [contacts[number] for number in self._limiting_numbers]
        self._augmented = [contact for contact in contacts if contact.multiplier_offset is not None]
        self._kept = [contact.memory for contact in contacts if contact.memory is not None]

    def trial(self, x: np.ndarray, seats: np.ndarray, rotations: np.ndarray | None = None) -> TrialPositions:
        """TrialPositions from those of the local nodes; arguments as for `evaluate`; collective."""
        x, turned = self.layout.gather(x), None if rotations is None else self.layout.gather(rotations)
        return TrialPositions(x, seats, turned, self._nearby.part(x, seats))

    def evaluate(
        self, x: np.ndarray, seats: np.ndarray, rotations: np.ndarray | None
    ) -> tuple[list[Contribution], float, int]:
        """All contacts; collective.

        Args:
            x, rotations: of the local nodes, shape (nodes, 3), mm and rad.
            seats: of both seats, shape (12,).

        Returns:
            For each kind the elements that act on this rank's unknowns; the maximum penetration of coils and seats, mm,
            and the number of closed elements of all ranks.
        """
        trial = self.trial(x, seats, rotations)
        parts = [contact.evaluate(trial) for contact in self.contacts]
        if self.detached:
            pairs = zip(self.contacts, parts, strict=True)
            parts = [part if self._acts(contact) else part.only(np.arange(0)) for contact, part in pairs]
        deepest = max([parts[number].deepest for number in self._limiting_numbers], default=0.0)
        if self.comm.size == 1:
            return parts, deepest, sum([part.closed for part in parts])
        parts = [_those(part, self.layout.acts_here(part.dofs)) for part in parts]
        closed = sum(np.count_nonzero(part.bears & self.layout.begins_here(part.dofs)) for part in parts)
        found = np.empty((self.comm.size, 2))
        self.comm.Allgather(np.array([deepest, closed]), found)
        return parts, float(found[:, 0].max()), int(found[:, 1].sum())

    def _acts(self, contact: Contact) -> bool:
        return contact.end is None or not self.detached

    def max_penetration(self, x: np.ndarray, seats: np.ndarray) -> float:
        """Maximum penetration of coils and seats, mm, cheaper than `evaluate`; collective."""
        trial = self.trial(x, seats)
        limiting = [contact.max_penetration(trial) for contact in self._limiting if self._acts(contact)]
        deepest = max(limiting, default=0.0)
        return max_of_ranks(self.comm, deepest)

    def gathered(self, parts: list[Contribution]) -> list[Contribution]:
        """What `evaluate` gave, of all ranks, without stiffness, for output; collective.

        The elements come in the order of the ranks.
        """
        if self.comm.size == 1:
            return parts
        once = [replace(part, stiffness=part.pressure).only(self.layout.begins_here(part.dofs)) for part in parts]
        return [Contribution.joined(each) for each in zip(*self.comm.allgather(once), strict=True)]

    def iterate(self) -> None:
        """Note that a correction starts from the last evaluation."""
        for contact in self.contacts:
            contact.iterate()

    def forget_iterate(self) -> None:
        """Forget what the last correction predicts; the next state is another one."""
        for contact in self.contacts:
            contact.forget_iterate()

    def augment(self, x: np.ndarray, seats: np.ndarray) -> None:
        """Augment the contacts that have penetrated; collective."""
        trial = self.trial(x, seats)
        for contact in filter(self._acts, self._augmented):
            contact.augment(trial)
            if contact.memory is not None:
                self.share(contact.memory, [AUGMENTED])

    def share_memories(self) -> None:
        """Share the memories among all ranks, except what `augment` has shared already; collective."""
        for memory in self._kept:
            self.share(memory, [name for name in memory.stations if name != AUGMENTED])

    def share(self, memory: Memory, names: Sequence[str]) -> None:
        """Share arrays of a memory: each rank gives the values at its own stations to all; collective."""
        if self.comm.size == 1:
            return
        for name in names:
            stations, values = memory.stations[name], memory[name]
            values[~np.isin(stations, self.layout.own_stations)] = 0.0
            self.comm.Allreduce(MPI.IN_PLACE, values)


def _those(part: Contribution, elements: np.ndarray) -> Contribution:
    """`part.only` of booleans, without a copy where they are all true."""
    return part if elements.all() else part.only(elements)
