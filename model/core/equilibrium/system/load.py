"""The load of a step: prescribed increments and external forces, or a fraction of them."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Protocol

import numpy as np
from petsc4py import PETSc

from coilset.model.core.base.agreement import max_of_ranks, sum_of_ranks
from coilset.model.core.base.extremes import largest
from coilset.model.core.equilibrium.system.layout import Layout
from coilset.model.core.runtime.kernels import njit


class Resistance(Protocol):
    """What resists the motion of the unknowns in a step of time: drag or inertia."""

    def forces(self, increments: np.ndarray) -> np.ndarray:
        """Forces at given increments, this rank's part, N and N mm."""
        ...

    def add_stiffness(self, matrix: PETSc.Mat) -> None:
        """Add their derivative to the tangent; collective."""
        ...


@dataclass(frozen=True)
class Drag:
    """A viscous drag on the unknowns over one time step: the forces c (x − x₀).

    Attributes:
        stiffness: c by this rank's unknowns, shape (size_local,), N/mm and N mm.
        origin: increments x₀ without drag, shape (size_local,), mm and rad.
    """

    stiffness: np.ndarray
    origin: np.ndarray

    def forces(self, increments: np.ndarray) -> np.ndarray:
        """Forces at given increments, this rank's part, N and N mm."""
        return self.stiffness * (increments - self.origin)

    def add_stiffness(self, matrix: PETSc.Mat) -> None:
        """Add c to the diagonal of the tangent; collective."""
        diagonal = matrix.createVecLeft()
        diagonal.setArray(self.stiffness)
        matrix.setDiagonal(diagonal, addv=PETSc.InsertMode.ADD_VALUES)


@dataclass(frozen=True)
class Load:
    """Prescribed increments and forces at the end of a step, by this rank's unknowns.

    Attributes:
        layout: Layout.
        held: places in this rank's part of a vector whose increments are prescribed, shape (h,).
        increments: shape (h,), mm and rad.
        loaded: places with an external force, shape (f,).
        forces: at the end of the step, shape (f,), N and N mm; moments are of the fixed frame.
        resistance: of the free unknowns, or None.
    """

    layout: Layout
    held: np.ndarray
    increments: np.ndarray
    loaded: np.ndarray
    forces: np.ndarray
    resistance: Resistance | None = None

    @classmethod
    def of(cls, layout: Layout, fixed: Mapping[int, float], forces: Mapping[int, float]) -> "Load":
        """From unknown → increment and unknown → force, each the same on every rank."""
        return cls(layout, *_mine(layout, fixed), *_mine(layout, forces))

    def scaled(self, factor: float) -> "Load":
        """The same unknowns, with increments and forces times `factor`."""
        load = replace(self, increments=factor * self.increments, forces=factor * self.forces)
        vars(load).update(is_held=self.is_held, supports=self.supports)  # found once for all of them
        return load

    def forces_at(self, load_factor: float, reactions: np.ndarray) -> np.ndarray:
        """Forces of a fraction of the step, shape (f,), N and N mm.

        Args:
            load_factor: from 0, the last equilibrium, to 1, the end of the step.
            reactions: internal forces of the last equilibrium, this rank's part, N and N mm.
        """
        return load_factor * self.forces + (1.0 - load_factor) * reactions[self.loaded]

    def out_of_balance(
        self,
        load_factor: float,
        internal: np.ndarray,
        reactions: np.ndarray,
        increments: np.ndarray,
        weight: float,
        F: np.ndarray,
    ) -> None:
        """Write into F the internal forces less those of a fraction of the step, and what `miss` does.

        Args:
            load_factor, reactions: as in `forces_at`.
            internal: internal forces, this rank's part, N and N mm.
            increments, weight: as in `miss`.
        """
        _out_of_balance(
            internal,
            reactions,
            self.loaded,
            self.forces,
            self.held,
            self.increments,
            load_factor,
            increments,
            weight,
            F,
        )

    def miss(self, load_factor: float, increments: np.ndarray, weight: float, F: np.ndarray) -> None:
        """Write into the held places of F by how much the increments miss a fraction of the step, times `weight`.

        Args:
            load_factor: the fraction.
            increments, F: this rank's parts.
        """
        _miss(self.held, self.increments, load_factor, increments, weight, F)

    def resisted(self, resistance: Resistance | None) -> "Load":
        """The same load with another resistance, or none."""
        return replace(self, resistance=resistance)

    @cached_property
    def is_held(self) -> np.ndarray:
        """Which places of this rank's part are held, shape (size_local,)."""
        held = np.zeros(self.layout.size_local, dtype=bool)
        held[self.held] = True
        return held

    @cached_property
    def supports(self) -> np.ndarray:
        """Places that are held or loaded, each once, ascending."""
        return np.union1d(self.held, self.loaded)

    @cached_property
    def prescribed(self) -> float:
        """Norm of the prescribed increments; collective when it is first requested."""
        return float(np.sqrt(sum_of_ranks(self.layout.comm, self.increments @ self.increments)))

    def multiple_of(self, other: "Load") -> float:
        """The factor by which it prescribes what another load on the same unknowns does; collective."""
        return sum_of_ranks(self.layout.comm, self.increments @ other.increments) / other.prescribed**2

    @cached_property
    def changes(self) -> bool:
        """Whether a part of the step is another problem than the whole: forces may differ from those at its start;
        collective when it is first requested."""
        return self.prescribed > 0.0 or sum_of_ranks(self.layout.comm, len(self.loaded)) > 0.0

    @cached_property
    def _greatest(self) -> float:
        """The greatest of the prescribed increments of all ranks; collective when it is first requested."""
        return max_of_ranks(self.layout.comm, largest(self.increments))

    def misses(self, increments: np.ndarray, load_factor: float) -> bool:
        """Whether the increments, this rank's part, miss prescribed ones by more than rounding; collective."""
        off = _largest_miss(self.held, self.increments, load_factor, increments)
        return max_of_ranks(self.layout.comm, off) > 1e-12 * self._greatest

    def reached(self, increments: np.ndarray) -> float:
        """Fraction of the step reached by the increments, from the largest prescribed one, else 1; collective."""
        size, part = 0.0, 1.0
        if len(self.held):
            greatest = int(np.abs(self.increments).argmax())
            size = float(abs(self.increments[greatest]))
            if size > 0.0:
                part = float(increments[self.held[greatest]] / self.increments[greatest])
        if self.layout.comm.size > 1:
            size, part = max(self.layout.comm.allgather((size, part)))
        return part if size > 0.0 else 1.0


def _mine(layout: Layout, entries: Mapping[int, float]) -> tuple[np.ndarray, np.ndarray]:
    """Places in this rank's part of a vector, and values, of entries by unknowns."""
    dofs = [dof for dof in entries if layout.start <= dof < layout.stop]
    return np.array(dofs, dtype=np.int64) - layout.start, np.array([entries[dof] for dof in dofs], dtype=float)


@njit(cache=True)
def _miss(
    held: np.ndarray, targets: np.ndarray, load_factor: float, increments: np.ndarray, weight: float, F: np.ndarray
) -> None:
    for k in range(len(held)):
        F[held[k]] = weight * (increments[held[k]] - load_factor * targets[k])


@njit(cache=True)
def _out_of_balance(
    reactions: np.ndarray,
    before: np.ndarray,
    loaded: np.ndarray,
    forces: np.ndarray,
    held: np.ndarray,
    targets: np.ndarray,
    load_factor: float,
    increments: np.ndarray,
    weight: float,
    F: np.ndarray,
) -> None:
    for k in range(len(F)):
        F[k] = reactions[k]
    for k in range(len(loaded)):
        F[loaded[k]] -= load_factor * forces[k] + (1.0 - load_factor) * before[loaded[k]]
    _miss(held, targets, load_factor, increments, weight, F)


@njit(cache=True)
def _largest_miss(held: np.ndarray, targets: np.ndarray, load_factor: float, increments: np.ndarray) -> float:
    """As `largest`, of what the increments miss."""
    found = 0.0
    for k in range(len(held)):
        miss = abs(increments[held[k]] - load_factor * targets[k])
        if not miss <= found:
            found = miss
    return found
