"""A coil without pitch, pulled along its axis beyond yield and released: displacements of a ring sector by splines.

Beside u_z = c θ only u_θ = ψ(r, z) is left (O. Göhner, Ingenieur-Archiv 1, 1930, of the elastic ring), and of the
strains

    γ_θz = c/r + ∂ψ/∂z,    γ_θr = ∂ψ/∂r − ψ/r.

A law of von Mises has no other stresses than τ_θz and τ_θr then, hardened or not. ∫ (τ_θz δγ_θz + τ_θr δγ_θr) r dA = 0
for all δψ is equilibrium, and the force is ∫ τ_θz dA. ψ is odd in z: the upper half of a symmetric section is enough.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import BSpline

DEGREE = 3  # of the splines
TOLERANCE = 1e-11  # of the work of the forces out of balance over that of the first of them
ITERATIONS, SHORTEST, ROUND = 60, 1e-3, 40
Places = tuple[np.ndarray, np.ndarray, np.ndarray]
Section = Callable[[np.ndarray, np.ndarray], Places]


def tube(outer: float, inner: float) -> Section:
    """A tube of two diameters, mm, or a disk whose inner one is 0; see `Ring`."""

    def place(a: np.ndarray, b: np.ndarray) -> Places:
        radius, thick = 0.5 * (inner + (outer - inner) * a), 0.5 * (outer - inner)
        cos, sin = np.cos(np.pi * b), np.sin(np.pi * b)
        slopes = np.array([[thick * cos, -np.pi * radius * sin], [thick * sin, np.pi * radius * cos]])
        return radius * cos, radius * sin, slopes

    return place


def rectangle(width: float, height: float) -> Section:
    """A rectangle with sharp corners, mm, the width across the coil's axis; see `Ring`."""

    def place(a: np.ndarray, b: np.ndarray) -> Places:
        one, zero = np.ones_like(a), np.zeros_like(a)
        slopes = np.array([[width * one, zero], [zero, 0.5 * height * one]])
        return width * (a - 0.5), 0.5 * height * b, slopes

    return place


@dataclass(frozen=True)
class Steel:
    """Von Mises with isotropic hardening.

    Attributes:
        G: shear modulus, MPa.
        curve: yield stress in tension of the plastic strain and its slope, MPa.
    """

    G: float
    curve: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]

    def respond(self, shear: np.ndarray, state: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Stress, its derivatives and the new state by one step of backward Euler.

        Args:
            shear: strains γ at its end, shape (2, points).
            state: plastic parts of γ and the plastic strain at its beginning, shape (3, points).

        Returns:
            τ, MPa, shape (2, points), ∂τ/∂γ, shape (2, 2, points), and the state at its end.
        """
        root, elastic = np.sqrt(3.0), self.G * (shear - state[:2])
        size, flow = np.hypot(*elastic), np.zeros(shear.shape[1])
        flows = root * size > self.curve(state[2])[0]
        for _ in range(ROUND):
            stress, slope = self.curve(state[2] + flow)
            change = (root * size - 3.0 * self.G * flow - stress) / (3.0 * self.G + slope)
            flow = np.where(flows, flow + change, 0.0)
        slope, along = self.curve(state[2] + flow)[1], elastic / np.maximum(size, 1e-300)
        kept = 1.0 - root * self.G * flow / np.maximum(size, 1e-300)
        τ, direct = kept * elastic, along[:, None] * along
        across = np.eye(2)[:, :, None] - direct
        soft = np.where(flows, self.G * slope / (3.0 * self.G + slope), self.G)
        return τ, kept * self.G * across + soft * direct, np.array([*(shear - τ / self.G), state[2] + flow])


class Ring:
    """A turn of a coil without pitch.

    Args:
        radius: of the coil, mm.
        section: place (y, z) on its upper half, y towards the axis, and its slopes [[y,a, y,b], [z,a, z,b]], of
            0 ≤ a, b ≤ 1; z vanishes at b = 0, its inside is a = 1, b = 0, and a tube's z vanishes at b = 1, too.
        steel: Steel.
        pieces: of the splines along a and along b.

    Attributes:
        travel, force: of a turn, mm and N.
        inside: shear stress τ_θz at the inside, MPa.
    """

    def __init__(self, radius: float, section: Section, steel: Steel, pieces: tuple[int, int]) -> None:
        (a, weight_a, of_a), (b, weight_b, of_b) = (_splines(*one) for one in zip(pieces, (1.0, 0.0), strict=True))
        closed = abs(float(section(np.ones(1), np.ones(1))[1][0])) < 1e-9  # the other end is on the axis of symmetry
        of_b = of_b[:, :, 1 : -1 if closed else None]
        weights = np.outer(weight_a, weight_b).ravel()
        A, B = (grid.ravel() for grid in np.meshgrid(a, b, indexing="ij"))
        y, _, slopes = section(A, B)
        products = [np.einsum("pk,ql->pqkl", of_a[i], of_b[j]).reshape(len(A), -1) for i, j in ((0, 0), (1, 0), (0, 1))]
        inverse = np.linalg.inv(np.moveaxis(slopes, 2, 0))
        ψ_y, ψ_z = (products[1] * inverse[:, 0, k, None] + products[2] * inverse[:, 1, k, None] for k in range(2))
        r = radius - y
        self._B = np.array([ψ_z, -ψ_y - products[0] / r[:, None]])
        self._rise = np.array([1.0 / r, np.zeros_like(r)])
        self._weight = 2.0 * weights * np.linalg.det(np.moveaxis(slopes, 2, 0)) * r
        self._steel, self._state = steel, np.zeros((3, len(r)))
        self._x = np.zeros(self._B.shape[2] + 1)
        self.force = self.inside = 0.0

    @property
    def travel(self) -> float:
        """Of a turn, mm."""
        return float(2.0 * np.pi * self._x[-1])

    def go_to(self, travel: float | None) -> None:
        """To a travel, mm, or, if that is None, to no force.

        Raises:
            RuntimeError: if Newton's method finds no equilibrium.
        """
        x, first = self._x.copy(), 0.0
        n = len(x) if travel is None else len(x) - 1
        if travel is not None:
            x[-1] = travel / (2.0 * np.pi)
        for _ in range(ITERATIONS):
            f, K, τ, state = self._evaluate(x)
            step = np.zeros_like(x)
            step[:n] = np.linalg.solve(K[:n, :n], f[:n])
            work, part = float(f[:n] @ step[:n]), 1.0
            first = max(first, work)
            if work <= TOLERANCE * first:
                break
            while abs(self._evaluate(x - part * step)[0][:n] @ step[:n]) > 0.9 * work and part > SHORTEST:
                part *= 0.5
            x -= part * step
        else:
            raise RuntimeError("no equilibrium of the ring")
        self._x, self._state, self.force = x, state, float(f[-1])
        self.inside = float(τ[0, -1])

    def _evaluate(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Forces on ψ and on the rise, their derivatives, stresses and state."""
        B = np.concatenate([self._B, self._rise[:, :, None]], axis=2)
        τ, C, state = self._steel.respond(B @ x, self._state)
        CB = np.einsum("ijp,jpk->ipk", C * self._weight, B)
        K = sum(B[i].T @ CB[i] for i in range(2))
        return np.einsum("ipk,ip->k", B, τ * self._weight), np.asarray(K), τ, state


def _splines(pieces: int, end: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Gauss's points of 0 … 1 and an end of it, which weighs nothing, their weights, and splines with their slopes.

    Returns:
        Points and weights, shape (points,); values and slopes, shape (2, points, splines).
    """
    knots = np.concatenate([np.zeros(DEGREE), np.linspace(0.0, 1.0, pieces + 1), np.ones(DEGREE)])
    x, w = np.polynomial.legendre.leggauss(DEGREE + 1)
    t = np.append((np.arange(pieces)[:, None] + 0.5 * (x + 1.0)) / pieces, end)
    spline = BSpline(knots, np.eye(pieces + DEGREE), DEGREE)
    return t, np.append(np.tile(0.5 * w / pieces, pieces), 0.0), np.array([spline(t), spline.derivative()(t)])
