"""Residual and tangent of a body and its contacts, as functions of one vector of increments."""

from collections.abc import Callable, Sequence
from functools import cached_property, partial
from typing import Any, NamedTuple

import numpy as np
from dolfinx import la
from petsc4py import PETSc

from coilset.model.core.body.body import Body, Moment
from coilset.model.core.body.state import Where
from coilset.model.core.contact.base import Contact, Contribution
from coilset.model.core.equilibrium.system.contact_parts import ContactParts
from coilset.model.core.equilibrium.system.layout import Layout, LineLayout
from coilset.model.core.equilibrium.system.load import Load
from coilset.model.core.equilibrium.system.matrix import TangentMatrix
from coilset.model.core.equilibrium.system.sums import add_vectors

EXPIRED = b""  # in the place of the increments of an evaluation


class Evaluation(NamedTuple):
    """What the last evaluation found.

    Attributes:
        increments: this rank's part of the vector that it was made at; they may not be those of the state any more.
        has_stress: on every rank and at every point?
        contributions: of the contacts, in their order, those of their elements that act on this rank's unknowns; empty
            where there is no stress.
        penetration: of coils and seats, the maximum over all ranks, mm.
        closed: number of closed contact elements of all ranks.
    """

    increments: np.ndarray
    has_stress: bool
    contributions: list[Contribution]
    penetration: float = 0.0
    closed: int = 0


class System:
    """Residual and tangent.

    Args:
        body: Body.
        layout: Layout of its unknowns, a LineLayout if there are contacts.
        contacts: kinds of contact, see coilset.model.core.contact.base.
        seats: x, y, z and rotations of the bottom seat, then those of the top seat at the start, shape (12,), mm and
            rad; None for a body without seats.

    Attributes:
        state: the body's State, with `seats`, the contacts' memories, the `increments` of the last step, those of the
            step before it, and the internal forces `reactions` beside the body's fields.
        increments: PETSc's vector of the trial increments, that of the state.
        internal: internal forces at the last evaluation, without constraints and loads, that of the state.
        touching: ContactParts, if there are contacts.
        fixed: FixedStations, those that go with a rigid head which rotates.
        last: Evaluation.
        evaluations: number of states that were evaluated so far.
    """

    def __init__(
        self, body: Body, layout: Layout, contacts: Sequence[Contact] = (), seats: np.ndarray | None = None
    ) -> None:
        self.body, self.layout, self.comm, self.contacts = body, layout, layout.comm, list(contacts)
        self.state = body.state
        self.memories = [contact.memory for contact in self.contacts if contact.memory is not None]
        self._seats = None if seats is None else self.state.add("seats", np.array(seats, float), Where.SHARED)
        self._extra = body.extra or self._seats
        for number, memory in enumerate(self.memories):
            self.state.include(f"contact_{number}_", memory.state)
        trial = self.state.add("increments", np.zeros(layout.size_local), Where.UNKNOWN).trial
        self.increments = layout.vector(trial)
        self.state.add("increments_before", np.zeros(layout.size_local), Where.UNKNOWN)  # of the step before the last
        self._reactions = self.state.add("reactions", np.zeros(layout.size_local), Where.UNKNOWN)
        self.internal = layout.vector(self._reactions.trial)
        self._body_increments = body.increment.x.array
        if self.contacts:
            self.touching = ContactParts(self.line, self.contacts)
        self.fixed: list[Any] = []
        self._is_rotation = np.zeros(layout.size_local, dtype=bool)
        self._is_rotation[body.rotation_dofs[body.rotation_dofs < layout.owned]] = True
        self.last, self.evaluations = Evaluation(np.full(layout.size_local, np.nan), True, []), 0
        self._evaluated = EXPIRED

    @cached_property
    def _local(self) -> la.Vector:
        """The body's unknowns of this rank and after them the ghosts'; one rank alone hardly ever needs it."""
        return la.vector(self.layout.index_map, self.layout.block_size)

    # ---- evaluation ------------------------------------------------------------------------------------------------

    @property
    def seats(self) -> np.ndarray:
        """x, y, z and rotations of both seats in the trial state, shape (12,), mm and rad."""
        assert self._seats is not None, "this body has no seats"
        return self._seats.trial

    @property
    def line(self) -> LineLayout:
        """The layout of a body with stations, which contacts need."""
        assert isinstance(self.layout, LineLayout)
        return self.layout

    def evaluate(self, increments: PETSc.Vec) -> bool:
        """Bring the trial state to increments, unless it is there; False if some point has no stress; collective."""
        values = increments.getArray(readonly=True)
        content = values.tobytes()  # bytes are compared several times as fast as numbers
        same = content == self._evaluated
        if self.comm.size > 1:
            same = self.comm.allreduce(int(same)) == self.comm.size
        if not same:
            self.expire()
            self._body_increments[: self.layout.owned] = values[: self.layout.owned]
            if self.comm.size > 1:
                self.body.increment.x.scatter_forward()
            if self._extra is not None:
                np.add(self._extra.equilibrium, self.layout.extra(values), out=self._extra.trial)
            self._evaluate_trial(values.copy())
            self._evaluated = content
        return self.last.has_stress

    def _evaluate_trial(self, values: np.ndarray) -> None:
        self.evaluations += 1
        self.last = Evaluation(values, False, [])  # the new contacts' stiffness takes the memory of the old
        has_stress = self.body.update()
        if self.comm.size > 1:
            has_stress = self.comm.allreduce(int(has_stress)) == self.comm.size
        for station in self.fixed:
            station.follow()
        if not has_stress:
            self.last = Evaluation(values, False, [])
        elif not self.contacts:
            self.last = Evaluation(values, True, [])
        else:
            self.last = Evaluation(values, True, *self._touch())
        if has_stress:
            self._assemble(self.body.internal_forces, self._reactions.trial)
            self.internal.stateIncrease()  # its entries have changed behind PETSc's back

    @property
    def acting(self) -> list[Contribution]:
        """Contributions of the last evaluation to the unknowns: forces on a station of a head act on the head."""
        parts = self.last.contributions
        for station in self.fixed:
            parts = station.carried(parts)
        return parts

    def _touch(self) -> tuple[list[Contribution], float, int]:
        """Contributions, penetration and number of closed elements of an Evaluation."""
        rotations = None
        if self.touching.need_rotations:
            rotations = self._body_increments[self.line.rod.rotation_dofs]
        return self.touching.evaluate(self.state["x"].trial, self.seats, rotations)

    def _assemble(self, add: Callable[[np.ndarray], None], values: np.ndarray) -> None:
        """Write this rank's internal forces: what `add` adds to its unknowns and the ghosts', and those of contacts."""
        values[:] = 0.0
        if self.comm.size == 1:
            add(values)
        else:
            local = self._local
            local.array[:] = 0.0
            add(local.array)
            local.scatter_reverse(la.InsertMode.add)
            values[: self.layout.owned] = local.array[: self.layout.owned]
        for part in self.acting:
            if len(part.dofs):
                add_vectors(self.line.contact_dofs, part.dofs, part.forces, self.layout.start, values)

    def with_ghosts(self, values: np.ndarray) -> np.ndarray:
        """The body's unknowns of this rank's part `values` of a vector, and after them the ghosts'; collective.

        The next call overwrites what it gives.
        """
        self._local.array[: self.layout.owned] = values[: self.layout.owned]
        self._local.scatter_forward()
        return self._local.array

    def expire(self) -> None:
        """The next evaluation is to be made, wherever it is: something else than the increments has changed."""
        self._evaluated = EXPIRED

    def expire_at_equilibrium(self) -> None:
        """As `expire`, with the body's increments those of the last equilibrium: none."""
        self._body_increments[:] = 0.0
        self.expire()

    def pass_time(self, middle: Moment, end: Moment) -> None:
        """Let the step that begins take time; see Body."""
        self.body.pass_time(middle, end)
        self.expire()

    @property
    def max_penetration(self) -> float:
        """Maximum penetration of coils and seats at the last evaluation, mm; infinite where no stress was found."""
        return self.last.penetration if self.last.has_stress else np.inf

    @property
    def is_symmetric(self) -> bool:
        """Is the tangent symmetric in equilibrium? Friction has no potential."""
        return all(contact.has_potential for contact in self.contacts)

    @property
    def touches(self) -> bool:
        """Is any contact closed at the last evaluation, on any rank?"""
        return self.last.closed > 0

    def detach(self) -> None:
        """Take away whatever touches the wire from outside, until `attach`: coils alone still touch each other."""
        if self.contacts:
            self.touching.detached = True
        self.expire()

    def attach(self) -> None:
        """The reverse of `detach`."""
        if self.contacts:
            self.touching.detached = False
        self.expire()

    def gathered_contacts(self) -> list[Contribution]:
        """Contributions of all ranks at the last evaluation, without stiffness, for output; collective."""
        return self.touching.gathered(self.last.contributions) if self.contacts else []

    # ---- transactions ----------------------------------------------------------------------------------------------

    def commit(self) -> None:
        """Make the trial state the equilibrium; collective."""
        self.body.advance()
        if self.contacts:
            self.touching.share_memories()
        self.state.commit()
        self.expire_at_equilibrium()
        self._free_dropped()

    def restore(self) -> None:
        """Go back to the last equilibrium; collective."""
        self.state.restore()
        self._body_increments[:] = 0.0
        self._evaluate_trial(np.zeros(self.layout.size_local))
        self.expire()
        self._free_dropped()

    def _free_dropped(self) -> None:
        """Free the PETSc objects that Python has dropped, which PETSc keeps on several ranks; collective."""
        if self.comm.size > 1:
            PETSc.garbage_cleanup(self.comm)

    def reset_contacts(self) -> None:
        """Restore the contacts' memories to the last equilibrium."""
        for memory in self.memories:
            memory.state.restore()
        self.forget_iterate()

    def forget_iterate(self) -> None:
        """Discard the tractions predicted for the last correction; the next state is another one."""
        if self.contacts:
            self.touching.forget_iterate()
        self.expire()

    def augment(self) -> None:
        """Augment the contacts that have penetrated (augmented Lagrange), from now on; collective."""
        if self.contacts:
            self.touching.augment(self.state["x"].trial, self.seats)
        self.expire()

    # ---- residual and tangent --------------------------------------------------------------------------------------

    def residual(self, increments: PETSc.Vec, load: Load, load_factor: float, F: PETSc.Vec) -> None:
        """Internal minus external forces into F; increment minus prescribed increment where it is held; collective.

        Moments on nodes are those of the fixed frame, m: their charts ψ get Tᵀ m, as δω = T δψ does the work m · δω.
        Where there is no stress F is infinite: PETSc's line searches go back, and the step is cut.
        """
        if not self.evaluate(increments):
            F.set(np.inf)
            return
        self._out_of_balance(self._reactions.trial, load, load_factor, F)

    def _out_of_balance(self, internal: np.ndarray, load: Load, load_factor: float, F: PETSc.Vec) -> None:
        values, x, weight = F.getArray(), self.last.increments, self.body.constraint_weight
        moments = len(load.loaded) > 0 and self._is_rotation[load.loaded].any()
        if moments:
            np.subtract(internal, self._forces_in_charts(load, load_factor), out=values)
        else:
            load.out_of_balance(load_factor, internal, self._reactions.equilibrium, x, weight, values)
        if load.resistance is not None:
            values += load.resistance.forces(x)
        if moments or load.resistance is not None:
            load.miss(load_factor, x, weight, values)

    def _forces_in_charts(self, load: Load, load_factor: float) -> np.ndarray:
        """Forces on all of this rank's unknowns, moments of the fixed frame as the nodes' charts have them."""
        forces = np.zeros(self.layout.size_local)
        forces[load.loaded] = load.forces_at(load_factor, self._reactions.equilibrium)
        self.body.to_charts(forces)
        return forces

    def tangent(
        self,
        increments: PETSc.Vec,
        load: Load,
        matrix: TangentMatrix,
        at_step_start: bool = False,
        share: float | None = None,
    ) -> None:
        """Derivative of the residual into `matrix`; collective.

        Args:
            increments, load: as in `residual`.
            matrix: written.
            at_step_start: begin with a matrix that has places for the contacts as they are now only.
            share: build it with the section forces predicted after this share of the correction, see `predict`.
        """
        self.evaluate(increments)
        self.last_tangent(load, matrix, at_step_start, share)

    def last_tangent(
        self, load: Load, matrix: TangentMatrix, at_step_start: bool = False, share: float | None = None
    ) -> None:
        """Assemble `tangent` with the moduli of the last evaluation, at the present trial state; collective."""
        if self.contacts:
            self.touching.iterate()
        matrix.fill(self.acting, at_step_start, share)
        if load.resistance is not None:
            load.resistance.add_stiffness(matrix.mat)
        matrix.hold(load.held)

    # ---- mixed integration point (MIP) iteration -------------------------------------------------------------------

    def predict(self, correction: np.ndarray) -> None:
        """Let the body predict its section forces after a correction of the last evaluation, this rank's part."""
        local = self._local
        local.array[: self.layout.owned] = correction[: self.layout.owned]
        if self.comm.size > 1:
            local.scatter_forward()
        self.body.predict(local.array)

    def predict_from_equilibrium(self, correction: np.ndarray) -> None:
        """As `predict`, from the last equilibrium; collective."""
        self.expire_at_equilibrium()
        if not self.body.recall():
            self.evaluate(self.layout.vector())
        self.predict(correction)

    def first_order_residual(self, load: Load, load_factor: float, share: float, F: PETSc.Vec) -> None:
        """As `residual` at the last evaluation, with the body's `first_order_forces`; collective."""
        internal = np.empty(self.layout.size_local)
        self._assemble(partial(self.body.first_order_forces, share=share), internal)
        self._out_of_balance(internal, load, load_factor, F)
