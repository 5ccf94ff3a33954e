"""The surface of the section as edges of the mesh: their degrees of freedom, in order around the section."""

from dataclasses import dataclass

import numpy as np

from coilset.model.physics.slice.slice import Slice

STRAIGHT = 0.95  # cosine of the angle between two edges below which they meet in a corner


@dataclass(frozen=True, eq=False)
class Boundary:
    """Edges of a section's surface.

    Attributes:
        blocks: of each edge's nodes in order along it, the section on the left, shape (edges, nodes).
        polynomials: shape functions of an edge, coefficients of t⁰, t¹, … on 0 ≤ t ≤ 1, shape (nodes, nodes).
        upward: mean component η of the outward normal of each edge, shape (edges,).
    """

    blocks: np.ndarray
    polynomials: np.ndarray
    upward: np.ndarray

    def corners(self, nodes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Edges that end at a corner of the section, and those that begin at one.

        Args:
            nodes: positions of the blocks in the section, shape (blocks, 2).
        """
        powers = np.arange(len(self.polynomials))
        slopes = [self.polynomials @ (powers * t ** np.maximum(powers - 1, 0)) for t in (1.0, 0.0)]
        ahead, behind = (np.einsum("a,eai->ei", slope, nodes[self.blocks]) for slope in slopes)
        ahead, behind = (along / np.linalg.norm(along, axis=1)[:, None] for along in (ahead, behind))
        follows = np.argmax(self.blocks[:, -1:] == self.blocks[:, 0], axis=1)
        ends = np.flatnonzero((ahead * behind[follows]).sum(axis=1) < STRAIGHT)
        return ends, follows[ends]

    @classmethod
    def of(cls, body: Slice) -> "Boundary":
        """The surface of a slice's section."""
        V, element = body.forms.V, body.forms.V.element.basix_element
        nodes = V.tabulate_dof_coordinates()[:, :2]
        blocks, upward = [], []
        for cell, side in body.section.sides():
            edge = V.dofmap.list[cell][element.entity_closure_dofs[1][side]]
            edge = np.array([edge[0], *edge[2:], edge[1]])  # of vertices first and inner nodes after
            inner = nodes[V.dofmap.list[cell]].mean(axis=0)
            chord = nodes[edge[-1]] - nodes[edge[0]]
            if len(edge) > 3 and np.linalg.norm(nodes[edge[1]] - nodes[edge[0]]) > 0.5 * np.linalg.norm(chord):
                edge[1:-1] = edge[-2:0:-1]
            left = chord[0] * (inner - nodes[edge[0]])[1] - chord[1] * (inner - nodes[edge[0]])[0]
            blocks.append(edge if left > 0 else edge[::-1])
            upward.append(-np.sign(left) * chord[0] / np.linalg.norm(chord))
        t = np.linspace(0.0, 1.0, len(blocks[0]))
        polynomials = np.ascontiguousarray(np.linalg.inv(np.vander(t, increasing=True)).T)
        return cls(np.array(blocks, np.int64), polynomials, np.array(upward))
