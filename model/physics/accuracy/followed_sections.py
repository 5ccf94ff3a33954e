"""Some of a rod's sections followed as other ones, with more points or other kinematics: what the rod's leave out.

The forces of a coil are nearly determined by its load, and the strains along its wire only by how far its ends have
come. A followed section therefore takes the strains e + δ at which its forces differ from the rod's, s, by a multiple
of the greatest that the rod's section has borne, d, which does no work on δ:

    s_followed(e + δ) = s(e) + μ d,    d · δ = 0.

The work of μ d on the deformation of the step, over its travel, is the error of the force; on the elastic deformation
of the first step it is what is left at the release, as in `coilset.model.physics.accuracy.step_error`. Wire with a past
has it in the followed sections, too. Along the rod's own strains, δ = 0, a tube whose sections warp as they yield would
take a path that it does not take: three fifths of the error of its force would be found, and none of that of its set.
"""

import math
from collections.abc import Callable

import numpy as np
from mpi4py import MPI

from coilset.model.core.base.agreement import max_of_ranks, sum_of_ranks
from coilset.model.core.base.errors import CoilsetError
from coilset.model.core.base.package import package
from coilset.model.core.results.surface import Inside
from coilset.model.core.rod.rod import Rod
from coilset.model.core.section.kinds import make_sections
from coilset.model.core.section.rules import DiskRule

PAST = "coilset.model.physics.manufacture.initial_state"  # the door to what manufacture leaves in the wire
UPDATES = 2  # of a section in a step, to find its strains


class FollowedSections:
    """Some of a rod's sections as others.

    Args:
        rod: Rod.
        spring: the entries of its case if manufacture leaves stress in the wire; None if it does not.
        inside: where the inside of the coil is on the wire's surface.
        elements: number of those whose sections are followed, evenly spread along the wire.
        kind, rule, degree: of these sections, as in `make_sections`.
    """

    def __init__(
        self, rod: Rod, spring: object, inside: Inside, elements: int, kind: str, rule: DiskRule, degree: int
    ) -> None:
        self.rod, self.comm, self.inside = rod, rod.comm, inside
        along = rod.line.element[: len(rod.radius)]  # the same elements on any number of ranks
        stride = max(1, math.ceil(rod.mesh.topology.index_map(1).size_global / elements))
        self.cells = np.flatnonzero(along % stride == stride // 2)
        self.sections = make_sections(
            kind,
            rod.law,
            rod.parameters,
            rule,
            rod.radius[self.cells],
            rod.placement.part(self.cells),
            rod.temperature,
            degree,
        )
        self.start = self.sections.initial_state()
        if spring is not None:
            give = package(PAST, "wire with a past").give_sections_past
            _together(self.comm, lambda: give(self.sections, rule, self.start, rod, spring))
        self.strain = self._strain()
        self.shift, self.greatest = np.zeros_like(self.strain), np.zeros_like(self.strain)
        self.start["strain"] = self.strain.copy()
        self.trial = {name: values.copy() for name, values in self.start.items()}
        self._clock(self.start)
        self.length = stride * rod.l0[self.cells, None, None] * np.array(rod.element.weights)[:, None]
        self.surface = self.rod.surface_state[self.cells].copy()
        self.first: tuple[np.ndarray, float] | None = None
        self.lost = False

    def _strain(self) -> np.ndarray:
        return self.rod.state["strain"].equilibrium[self.cells].copy()

    def _clock(self, state: dict[str, np.ndarray]) -> None:
        if "clock" in self.rod.state:
            state["clock"] = self.rod.state["clock"].equilibrium.copy()

    def follow(self, travel: float, still: bool) -> float:
        """Error of the force after the last step, of so much travel, mm, or `still`; collective, N."""
        error, change = self._advance()
        if self.first is None and abs(travel) > 0.0:
            self.first = change, travel
        first, unit = self.first or (change, math.inf)
        return self._work(error, first) / unit if still else self._work(error, change) / travel

    def _advance(self) -> tuple[np.ndarray, np.ndarray]:
        """Error μ d of the section forces after the last step, and the rod's change of strain, (cells, sections, 6)."""
        strain, ours = self._strain(), self.rod.coefficients.s[self.cells]
        self._clock(self.trial)
        change, self.strain = strain - self.strain, strain
        greater = self._size(ours) > self._size(self.greatest)
        self.greatest = np.where(greater[..., None], ours, self.greatest)
        forces, D, error = np.zeros_like(strain), np.zeros((*strain.shape, 6)), np.zeros_like(strain)
        if len(self.cells):
            for _ in range(UPDATES):
                self.trial["strain"] = strain + self.shift
                good = self.sections.update(self.trial["strain"], self.start, self.trial, forces, D)
                self.lost = self.lost or not good
                if self.lost:
                    break
                error = self._balance(forces - ours, D)
            self.sections.update_surface(self.trial["strain"], self.start, self.trial)
        self.start, self.trial = self.trial, self.start
        self.surface = self.rod.surface_state[self.cells].copy()
        return error, change

    def _size(self, forces: np.ndarray) -> np.ndarray:
        """Square of section forces, moments over the wire's radius, N², shape (cells, sections)."""
        radius = self.rod.radius[self.cells, None, None]
        return np.sum(np.concatenate([forces[..., :3], forces[..., 3:] / radius], axis=-1) ** 2, axis=-1)

    def _balance(self, difference: np.ndarray, D: np.ndarray) -> np.ndarray:
        """Correct δ by Newton's method; the error μ d, shape (cells, sections, 6)."""
        size = np.sqrt(self._size(self.greatest))[..., None]
        d = np.divide(self.greatest, size, out=np.zeros_like(difference), where=size > 0.0)
        K, f = np.zeros((*size.shape[:2], 7, 7)), np.zeros((*size.shape[:2], 7))
        K[..., :6, :6], K[..., :6, 6], K[..., 6, :6], K[..., 6, 6] = D, -d, d, size[..., 0] == 0.0
        f[..., :6], f[..., 6] = -difference, -np.sum(d * self.shift, axis=-1)
        try:
            found = np.linalg.solve(K, f[..., None])[..., 0]
        except np.linalg.LinAlgError:
            self.lost = True
            return difference
        self.shift = self.shift + found[..., :6]
        return found[..., 6:] * d

    def _work(self, error: np.ndarray, change: np.ndarray) -> float:
        """Work of a section-force error on increments of strain, N mm; not a number where the law found no stress."""
        work = sum_of_ranks(self.comm, float(np.sum(self.length * error * change)))
        return math.nan if max_of_ranks(self.comm, float(self.lost)) else work

    def surface_error(self) -> float:
        """Largest difference of shear stress at the inside after the last step that was followed, MPa; collective."""
        ours = self.inside.shear(self.surface, self.rod.sections.components)
        theirs = self.inside.shear(self.start["surface_state"], self.sections.components)
        return max_of_ranks(self.comm, float(np.abs(theirs - ours).max(initial=0.0)))


def _together(comm: MPI.Comm, action: Callable[[], object]) -> None:
    """Do something on each rank; where it fails on one, all raise its CoilsetError; collective."""
    problem = None
    try:
        action()
    except CoilsetError as error:
        problem = str(error)
    problem = next((one for one in comm.allgather(problem) if one), None)
    if problem:
        raise CoilsetError(problem)
