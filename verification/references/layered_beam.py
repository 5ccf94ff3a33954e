"""A cantilever of round bar far beyond yield: a geometrically exact plane beam of layers, without elements.

With the angle θ(s) of the section, its strains and the position of the axis are (E. Reissner, ZAMP 23 (1972) 795)

    x′ = (1 + ε) cos θ − γ sin θ,   y′ = (1 + ε) sin θ + γ cos θ,   θ′ = κ.

A transverse dead force F at the tip leaves N = F sin θ, Q = F cos θ and M = F (x(L) − x(s)) in every section. The
sections at Gauss points of the whole length are brought to these resultants together, so that no displacement is
interpolated between nodes. The rates of strain of a layer at height y, and what works on those of ε, γ and κ, are

    ε̇11 = ε̇/(1 + ε) − κ̇ y,   γ̇12 = γ̇,   N = ∫ σ dA/(1 + ε),   Q = ∫ τ dA,   M = −∫ σ y dA,

the same shear in all layers (no shear factor, as in the thesis). A layer's stress follows the rates (3.1.6) to (3.1.8)
in σ and τ, as in `section_integrals.plastic_path`, by Heun's method in sub-steps, after each of which the active
deviator is scaled back to the yield surface. Of the program only the material's functions k²(b*), ζ(b*), κ(b*) are
used.
"""

import numpy as np

from coilset.model.core.material.law.law import Law

SECTIONS, LAYERS = 10, 16
SUB_STEPS = 12  # of a step
PRECISION = 1e-8  # of the resultants
PROBE = 1e-7  # strain, for the tangents of a section
ITERATIONS, LARGE = 15, 0.1  # of Newton's method; strain in a step
SMALLEST_PART = 1e-5  # of the length

Points = np.ndarray
"""σ, τ, B11, B12, b* of all layers of all sections, shape (5, sections, layers), MPa."""


class LayeredCantilever:
    """A straight cantilever under a transverse force at its tip.

    Args:
        law: material that hardens, or departs from normality; spin is neglected.
        length, radius: mm.

    Attributes:
        force: N.
    """

    def __init__(self, law: Law, length: float, radius: float) -> None:
        self.law, self.radius, self.length = law, radius, length
        self.s, self._to = _integration(SECTIONS, length)
        # Gauss-Chebyshev of the second kind: ∫ f 2 √(R² − y²) dy over the height
        angle = np.pi * np.arange(1, LAYERS + 1) / (LAYERS + 1)
        self.y = radius * np.cos(angle)
        self.area = 2.0 * radius**2 * np.pi / (LAYERS + 1) * np.sin(angle) ** 2
        self.strains = np.zeros((3, SECTIONS))
        self.points: Points = np.zeros((5, SECTIONS, LAYERS))
        self.force, self._deflection = 0.0, 0.0
        self._last = np.zeros((3, SECTIONS)), 0.0, 1.0  # increments of strains, force and deflection

    def bend(self, deflection: float) -> float:
        """Move the tip across to a deflection, mm, in parts where Newton's method needs them; returns the force, N.

        Raises:
            RuntimeError: no equilibrium was found.
        """
        part = deflection - self._deflection
        while self._deflection != deflection:
            left = deflection - self._deflection
            if self._bend(deflection if abs(part) >= abs(left) else self._deflection + part):
                part *= 1.5
            else:
                part *= 0.5
                if abs(part) < SMALLEST_PART * self.length:
                    raise RuntimeError(f"no equilibrium of the cantilever beyond {self._deflection:g} mm")
        return self.force

    def _bend(self, deflection: float) -> bool:
        """Take one step; is there an equilibrium?"""
        share = (deflection - self._deflection) / self._last[2]
        strains, force = self.strains + share * self._last[0], self.force + share * self._last[1]
        unit = self.law.first_yield() * self.area.sum()
        size = unit * np.array([[1.0], [1.0], [self.radius]])
        for _ in range(ITERATIONS):
            if not np.abs((strains - self.strains) * [[1.0], [1.0], [self.radius]]).max() < LARGE:
                break
            probes = PROBE * np.array([1.0, 1.0, 1.0 / self.radius])
            points, all_found = self._resultants(np.stack([strains, *(strains + np.diag(probes)[:, :, None])]))
            found = all_found[0]
            tangents = np.moveaxis((all_found[1:] - found) / probes[:, None, None], 0, 1)
            wanted, slopes, tip, tip_slope = self._statics(strains, force)
            residual = np.append(((found - wanted) / size).ravel(), (tip - deflection) / self.length)
            if np.abs(residual).max() < PRECISION:
                self._last = strains - self.strains, force - self.force, deflection - self._deflection
                self.strains, self.points, self.force, self._deflection = strains, points, force, deflection
                return True
            n = 3 * SECTIONS
            matrix = np.zeros((n + 1, n + 1))
            matrix[:n, :n] = -force * slopes.reshape(n, n)
            for i in range(SECTIONS):
                at = i + SECTIONS * np.arange(3)
                matrix[np.ix_(at, at)] += tangents[:, :, i]
            matrix[:n, n] = -(wanted / force if force else self._statics(strains, 1.0)[0]).ravel()
            matrix[:n] /= np.repeat(size, SECTIONS)[:, None]
            matrix[n, :n] = tip_slope.ravel() / self.length
            change = np.linalg.solve(matrix, residual)
            strains = strains - change[:n].reshape(3, SECTIONS)
            force -= float(change[n])
        return False

    def _statics(self, strains: np.ndarray, force: float) -> tuple[np.ndarray, np.ndarray, float, np.ndarray]:
        """N, Q, M that hold the force, shape (3, sections); their derivatives by the strains at a unit force, shape (3,
        sections, 3, sections); the tip's deflection, mm, and its derivatives, shape (3, sections)."""
        inner, whole = self._to[:-1], self._to[-1]
        ε, γ, κ = strains
        θ = inner @ κ
        cos, sin = np.cos(θ), np.sin(θ)
        dx, dy = (1.0 + ε) * cos - γ * sin, (1.0 + ε) * sin + γ * cos
        # of x′ and y′ by the strains of all sections
        x_slope = np.stack([np.diag(cos), np.diag(-sin), -dy[:, None] * inner], axis=1)
        y_slope = np.stack([np.diag(sin), np.diag(cos), dx[:, None] * inner], axis=1)
        to_tip = whole - inner
        wanted = force * np.stack([sin, cos, to_tip @ dx])
        slopes = np.zeros((3, SECTIONS, 3, SECTIONS))
        slopes[0, :, 2], slopes[1, :, 2] = cos[:, None] * inner, -sin[:, None] * inner
        slopes[2] = np.tensordot(to_tip, x_slope, 1)
        return wanted, slopes, float(whole @ dy), np.tensordot(whole, y_slope, 1)

    def _resultants(self, strains: np.ndarray) -> tuple[Points, np.ndarray]:
        """N, Q, M of the sections after increments from the last equilibrium, all at once, and the points of the first.

        Args:
            strains: shape (increments, 3, sections).
        """
        number = len(strains)
        now, before = (np.concatenate(list(at), axis=1) for at in (strains, [self.strains] * number))
        ends = [np.stack([np.log1p(at[0]), *at[1:]]) for at in (before, now)]
        axis, angle, bend = (change[:, None] for change in ends[1] - ends[0])
        points = self._follow(np.tile(self.points, (1, number, 1)), axis - bend * self.y, angle + 0.0 * self.y)
        normal, shear = points[0] * self.area, points[1] * self.area
        force = normal.sum(axis=1) / (1.0 + now[0])
        found = np.stack([force, shear.sum(axis=1), -normal @ self.y]).reshape(3, number, SECTIONS)
        return points[:, :SECTIONS], np.moveaxis(found, 1, 0)

    def _follow(self, points: Points, stretch: np.ndarray, shear: np.ndarray) -> Points:
        """The points after increments of the logarithmic strain and of the shear."""
        stretch, shear = stretch / SUB_STEPS, shear / SUB_STEPS
        for _ in range(SUB_STEPS):
            trial = points.copy()
            trial[0] += self.law.E * stretch
            trial[1] += self.law.G * shear
            flows = self._excess(trial) > 0.0
            if flows.any():
                start = points[:, flows]
                elastic = self._elastic_part(start, stretch[flows], shear[flows])
                left = 1.0 - elastic
                e, g = stretch[flows], shear[flows]
                start = start + elastic * np.stack([self.law.E * e, self.law.G * g, 0 * e, 0 * e, 0 * e])
                e, g = left * e, left * g
                first = self._rates(start, e, g)
                second = self._rates(start + first, e, g)
                trial[:, flows] = self._drawn_back(start + 0.5 * (first + second))
            points = trial
        return points

    def _excess(self, points: Points) -> np.ndarray:
        """n:n − k² of the active deviator n, MPa²."""
        n1, n2 = 2.0 / 3.0 * points[0] - points[2], points[1] - points[3]
        return 1.5 * n1**2 + 2.0 * n2**2 - self.law.functions(points[4])[0]

    def _elastic_part(self, start: Points, stretch: np.ndarray, shear: np.ndarray) -> np.ndarray:
        """Part of an elastic increment that ends on the yield surface."""
        n1, n2 = 2.0 / 3.0 * start[0] - start[2], start[1] - start[3]
        d1, d2 = 2.0 / 3.0 * self.law.E * stretch, self.law.G * shear
        a, b = 1.5 * d1**2 + 2.0 * d2**2, 1.5 * n1 * d1 + 2.0 * n2 * d2
        c = np.minimum(self._excess(start), 0.0)
        root = np.sqrt(np.maximum(b**2 - a * c, 0.0)) - b
        return np.clip(np.divide(root, a, out=np.ones_like(a), where=a > 0.0), 0.0, 1.0)

    def _rates(self, y: Points, strain: np.ndarray, angle: np.ndarray) -> Points:
        """Increments of a point on the yield surface; those of `plastic_path` times the time."""
        σ, τ, B1, B2, work = y
        k2, dk2, ζ, _, κ, _ = self.law.functions(work)
        n1, n2 = 2.0 / 3.0 * σ - B1, τ - B2
        m, c = (2.0 - κ * dk2) / ((2.0 * ζ + dk2) * k2), 1.0 + κ * ζ
        a11, a12 = 1.0 / self.law.E + (2.0 / 3.0 * κ + m * n1 * n1) / c, 2.0 * m * n2 * n1 / c
        a22 = 1.0 / self.law.G + 2.0 * (κ + 2.0 * m * n2 * n2) / c
        det = a11 * a22 - a12 * a12
        dσ, dτ = (a22 * strain - a12 * angle) / det, (a11 * angle - a12 * strain) / det
        ep, gp = strain - dσ / self.law.E, angle - dτ / self.law.G
        return np.stack([dσ, dτ, ζ * ep, 0.5 * ζ * gp, 1.5 * n1 * ep + n2 * gp])

    def _drawn_back(self, points: Points) -> Points:
        """The points with the active deviator scaled to the yield surface, which Heun's method leaves a little."""
        k2 = self.law.functions(points[4])[0]
        n1, n2 = 2.0 / 3.0 * points[0] - points[2], points[1] - points[3]
        scale = np.sqrt(k2 / (1.5 * n1**2 + 2.0 * n2**2))
        points[0] += 1.5 * (scale - 1.0) * n1
        points[1] += (scale - 1.0) * n2
        return points


def _integration(count: int, length: float) -> tuple[np.ndarray, np.ndarray]:
    """Gauss points of a length, shape (n,), and the matrix that integrates a function of its values there from 0 to
    each of them and, in the last row, over the length, shape (n + 1, n)."""
    ξ, w = np.polynomial.legendre.leggauss(count)
    to_modes = (np.arange(count)[:, None] + 0.5) * np.polynomial.legendre.legvander(ξ, count - 1).T * w
    integrals = np.stack([np.polynomial.legendre.Legendre.basis(k).integ(lbnd=-1)(ξ) for k in range(count)], axis=1)
    return 0.5 * length * (1.0 + ξ), 0.5 * length * np.vstack([integrals @ to_modes, w])
