"""The wire's end faces as rigid heads: prescribed motion, and reactions by virtual work."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from dolfinx import fem
from numpy.typing import ArrayLike

from coilset.model.core.rotations.vectors import rotation_matrix

if TYPE_CHECKING:
    from coilset.model.physics.solid.solid import Solid


@dataclass(frozen=True)
class Motion:
    """Motion of a head from its initial position: rotated about its initial centre, then translated.

    Attributes:
        translation: mm, shape (3,).
        rotation: rotation vector, rad, shape (3,).
    """

    translation: tuple = (0.0, 0.0, 0.0)
    rotation: tuple = (0.0, 0.0, 0.0)

    def between(self, other: "Motion", part: float) -> "Motion":
        """The motion a fraction `part` of the way from this one to the other; both rotate about the same axis."""
        mix = lambda a, b: tuple((1 - part) * np.asarray(a, float) + part * np.asarray(b, float))  # noqa: E731
        return Motion(mix(self.translation, other.translation), mix(self.rotation, other.rotation))


@dataclass(frozen=True)
class Reaction:
    """Force and moment of a head on the wire.

    Attributes:
        force: N, shape (3,).
        moment: about the requested point, N mm, shape (3,).
    """

    force: np.ndarray
    moment: np.ndarray


class Head:
    """A rigid end face.

    Args:
        solid: "Solid".
        group: ``bottom`` or ``top``.

    Attributes:
        blocks: blocks of degrees of freedom on the face, ghosts included.
        centre: of the face at the start, mm, shape (3,).
        motion: the currently prescribed Motion.
    """

    def __init__(self, solid: "Solid", group: str) -> None:
        self.solid, self.group = solid, group
        mesh = solid.wire.mesh
        mesh.topology.create_connectivity(2, 3)
        self.blocks = fem.locate_dofs_topological(solid.V, 2, solid.wire.facets(group))
        self._start = solid.configuration.x[self.blocks].copy()
        end = 0.0 if group == "bottom" else solid.wire.length
        self.centre = solid.wire.place(np.array([[0.0, 0.0, end]]))[0]
        self.motion = Motion()

    def positions(self, motion: Motion) -> np.ndarray:
        """Position coefficients of the face's blocks after a motion, shape (blocks, 3), mm; they are linear in it."""
        R = rotation_matrix(motion.rotation)
        return (self._start - self.centre) @ R.T + self.centre + np.asarray(motion.translation)

    def reaction(self, forces: np.ndarray, point: ArrayLike) -> Reaction:
        """Force and moment of the head on the wire: the virtual work of the rigid modes, exact for the discrete body.

        Args:
            forces: internal forces, shape (owned blocks, 3), N.
            point: reference point of the moment, mm.
        """
        solid = self.solid
        mine = self.blocks[self.blocks < solid.configuration.owned]
        modes = solid.configuration.rigid_modes(solid.x[mine] - np.asarray(point, dtype=float))
        work = solid.comm.allreduce(np.einsum("kni,ni->k", modes, forces[mine]))
        return Reaction(work[:3], work[3:])
