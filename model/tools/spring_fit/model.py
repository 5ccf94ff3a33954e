"""What a set of constants predicts for all readings: the unknowns, and the residuals in terms of the tester's error.

A reading weighs as much as it is certain: its variance is (e_F F)² + (R e_s)², with the tester's relative error of
force e_F, its error of travel or length e_s, and the local rate R. Where a press turns, the travel of a single reading
decides how far the wire flows; it is an unknown itself, whose deviation counts as one more residual over e_s.

The tester itself may be unknown: its compliance c and the offset s₀ of its zero make the spring's travel s − s₀ − c F,
its friction makes the force F (1 ± μ), more when pressed and less when released.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from coilset.model.core.base.errors import InputError, SolveError
from coilset.model.core.material.law.law import Law
from coilset.model.tools.spring_fit import rods
from coilset.model.tools.spring_fit.laws import CONSTANTS, TRIAL, Form
from coilset.model.tools.spring_fit.pressing import Pressing
from coilset.model.tools.spring_fit.rods import Branch

TESTER = {"friction": "", "compliance": "mm/N", "offset": "mm"}
LOGARITHMIC = ("G", "yield_stress", "rise", "rate")
STEPS = {"share": 1e-3, "friction": 1e-4, "compliance": 1e-7, "offset": 1e-3}  # for slopes; others 1e-3
BOUNDS = {
    "yield_stress": (2.0, 9.0),
    "rise": (-2.0, 9.0),
    "rate": (-12.0, 8.5),
    "share": (0.0, 1.0),
    "friction": (0.0, 0.3),
    "compliance": (0.0, 1e-2),
    "offset": (-5.0, 5.0),
}
TURNS = 2.0  # mm, within which the travel of a turn is sought
CLOSED = 3.0  # times the least rate so far: beyond it coils have closed, and the wire is not what gives way
LEAST = 0.005  # of the maximum force, below which a reading is of a spring that stands free
SAME = 0.05  # of the tester's errors, below which one whole rod counts for two shares
HOPELESS = 1e6  # residuals where there is no equilibrium


@dataclass(frozen=True)
class Errors:
    """Of the tester: relative error of force, and error of travel and length, mm."""

    force: float = 0.005
    travel: float = 0.02


@dataclass(frozen=True)
class Missing:
    """What the whole rod has more than the uniform one at each reading of each pressing, N or mm, at unknowns."""

    at: np.ndarray
    more: tuple[np.ndarray, ...]


@dataclass(frozen=True)
class Model:
    """Presses, a law with unknown constants, and what is known.

    Attributes:
        pressings: of springs of the same wire.
        form: of the law.
        known: constants and properties of the tester that are not fitted.
        fitted: names of those that are.
        errors: of the tester.
        weights: standard deviation of each reading of each pressing, N, or mm of lengths; infinite if it is not used.
        missing: what the whole rod has more than the uniform one, at several unknowns, in ascending shares.
        slopes_missing: its derivatives by the unknowns, shape (readings, unknowns); 0 for a share with a threshold.
        work: greatest plastic work per volume of the last whole rods, N/mm².
    """

    pressings: tuple[Pressing, ...]
    form: Form
    known: Mapping[str, float]
    fitted: tuple[str, ...]
    errors: Errors = Errors()
    weights: tuple[np.ndarray, ...] = ()
    missing: tuple[Missing, ...] = ()
    slopes_missing: tuple[np.ndarray, ...] = ()
    work: float = 0.0

    @property
    def turns(self) -> list[tuple[int, int]]:
        """Pressing and branch of each turn whose travel is an unknown."""
        return [(k, number) for k, one in enumerate(self.pressings) for number in one.presses]

    @property
    def readings(self) -> int:
        """Number of the readings that are used."""
        return int(sum(np.isfinite(one).sum() for one in self.weights))

    def start(self, values: Mapping[str, float]) -> np.ndarray:
        """The vector of unknowns."""
        first = [math.log(values[name]) if name in LOGARITHMIC else values[name] for name in self.fitted]
        return np.array([*first, *[0.0] * len(self.turns)])

    @property
    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Least and greatest unknowns."""
        ends = [BOUNDS.get(name, (-20.0, 20.0)) for name in self.fitted] + [(-TURNS, TURNS)] * len(self.turns)
        return tuple(np.array(one) for one in zip(*ends, strict=True))  # type: ignore[return-value]

    def values(self, x: np.ndarray) -> dict[str, float]:
        """Constants and properties of the tester, known and fitted."""
        pairs = zip(self.fitted, x.tolist(), strict=False)
        found = {name: math.exp(value) if name in LOGARITHMIC else value for name, value in pairs}
        return {**dict.fromkeys(TESTER, 0.0), **self.known, **found}

    def ends(self, x: np.ndarray, number: int) -> list[float | None]:
        """Travel of the spring alone at the ends of the branches of a pressing."""
        one, values = self.pressings[number], self.values(x)
        moved = dict(zip(self.turns, x[len(self.fitted) :].tolist(), strict=True))
        found: list[float | None] = []
        for branch, end in enumerate(one.ends):
            if end is None:
                found.append(None)
                continue
            here = np.flatnonzero(one.branch == branch)
            force = float(one.force[here[-1]]) if len(here) and not one.lengths else 0.0
            travel = end - values["offset"] - values["compliance"] * force + moved.get((number, branch), 0.0)
            found.append(min(travel, one.furthest))
        return found

    def predicted(self, x: np.ndarray, number: int, branches: Sequence[Branch]) -> np.ndarray:
        """Readings of a pressing from these branches: force at its travels, or the travel where it is free."""
        one, values = self.pressings[number], self.values(x)
        found = np.empty(len(one.travel))
        travel = one.travel - values["offset"] - values["compliance"] * one.force
        for branch, curve in enumerate(branches):
            here = one.branch == branch
            if one.lengths:
                found[here] = curve.free
            else:
                found[here] = curve.at(travel[here]) * (1.0 + values["friction"] * (-1.0 if branch % 2 else 1.0))
        return found

    def uniform(self, x: np.ndarray) -> list[np.ndarray]:
        """Readings by the uniform rod alone.

        Raises:
            SolveError: if there is no equilibrium.
        """
        values = self.values(x)
        constants = tuple(values[name] for name in CONSTANTS)
        return [
            self.predicted(x, k, _uniform(one, self.form, constants, tuple(self.ends(x, k))))
            for k, one in enumerate(self.pressings)
        ]

    @property
    def share(self) -> int | None:
        """Number of the share among the unknowns, if it is one."""
        return self.fitted.index("share") if "share" in self.fitted else None

    @property
    def threshold(self) -> int | None:
        """Number of a fitted share that changes nothing up to a threshold: of wire that has not flowed before."""
        return None if any(one.coiled for one in self.pressings) else self.share

    def lacking(self, x: np.ndarray, number: int) -> np.ndarray:
        """What the whole rod has more at the readings of a pressing, linear between the shares at which it is known."""
        known = [one.more[number] + self.slopes_missing[number] @ (x - one.at) for one in self.missing]
        if len(known) == 1 or self.share is None:
            return known[-1]
        shares = [one.at[self.share] for one in self.missing]
        k = int(np.clip(np.searchsorted(shares, x[self.share]), 1, len(shares) - 1))
        part = float(np.clip((x[self.share] - shares[k - 1]) / (shares[k] - shares[k - 1]), 0.0, 1.0))
        return (1.0 - part) * known[k - 1] + part * known[k]

    def residual(self, x: np.ndarray) -> np.ndarray:
        """Deviations of the readings that are used, and of the turns, over their standard deviations."""
        turns = x[len(self.fitted) :] / self.errors.travel
        try:
            found = self.uniform(x)
        except (SolveError, InputError, OverflowError):  # constants far from those of any wire
            return np.append(np.full(self.readings, HOPELESS), turns)
        parts = []
        for k, (one, ours, weight) in enumerate(zip(self.pressings, found, self.weights, strict=True)):
            measured = one.travel if one.lengths else one.force
            used = np.isfinite(weight)
            parts.append(((ours + self.lacking(x, k) - measured) / weight)[used])
        return np.concatenate([*parts, turns])

    def slopes(self, x: np.ndarray, unknowns: Sequence[int] | np.ndarray | None = None) -> np.ndarray:
        """Derivatives of the residuals by some unknowns, all by default, by differences that stay within the bounds."""
        here, columns = self.residual(x), []
        for k in range(len(x)) if unknowns is None else unknowns:
            step = self._step(x, k)
            moved = x.copy()
            moved[k] += step
            columns.append((self.residual(moved) - here) / step)
        return np.array(columns).T

    def corrected(self, x: np.ndarray) -> "Model":
        """The model with what coarse whole rods of these constants have more, and the weights that follow from them.

        Raises:
            SolveError: if a whole rod finds no equilibrium.
        """
        whole, _ = self._whole(x, rods.COARSE)
        weights = tuple(self._weights(*pair) for pair in zip(self.pressings, whole, strict=True))
        return replace(self, missing=(Missing(x.copy(), self._difference(x, whole)),), weights=weights)

    def with_slopes(self, x: np.ndarray) -> "Model":
        """The model with the derivatives by the unknowns, at these, of what coarse whole rods have more.

        Raises:
            SolveError: if a whole rod finds no equilibrium.
        """
        here = self._difference(x, self._whole(x, rods.COARSE)[0])
        slopes = tuple(np.zeros_like(one) for one in self.slopes_missing)
        for k in range(len(x)):
            if k == self.threshold:
                continue  # it acts beyond a threshold: `with_shares` follows it
            step = self._step(x, k)
            moved = x.copy()
            moved[k] += step
            turn = k - len(self.fitted)
            changed = range(len(self.pressings)) if turn < 0 else [self.turns[turn][0]]
            for number in changed:
                branches, _ = self._pressed(moved, number, rods.COARSE)
                there = self.predicted(moved, number, branches) - self.uniform(moved)[number]
                slopes[number][:, k] = (there - here[number]) / step
        return replace(self, slopes_missing=slopes)

    def with_shares(self, x: np.ndarray, shares: Sequence[float]) -> "Model":
        """The model with what coarse whole rods of these shares have more, all at the same other unknowns.

        One found at other constants beside one found at these would make the share seem determined: below its
        threshold all have the same. Where the uniform rods of neighbouring shares read the same, one whole rod
        counts for them.

        Args:
            x: other unknowns.
            shares: of kinematic hardening.

        Raises:
            SolveError: if a whole rod finds no equilibrium.
        """
        assert self.share is not None
        found: list[Missing] = []
        last: list[np.ndarray] = []
        for share in sorted(shares):
            at = x.copy()
            at[self.share] = share
            ours = self.uniform(at)
            if last and self._alike(ours, last):
                found.append(Missing(at, found[-1].more))
                continue
            last = ours
            found.append(Missing(at, self._difference(at, self._whole(at, rods.COARSE)[0])))
        return replace(self, missing=tuple(found))

    def _alike(self, ours: Sequence[np.ndarray], others: Sequence[np.ndarray]) -> bool:
        """Whether the readings differ by less than a tester resolves."""
        return all(
            float(np.max(np.abs(one - other) / weight)) < SAME
            for one, other, weight in zip(ours, others, self.weights, strict=True)
        )

    def shifted(self, x: np.ndarray) -> "Model":
        """The model that is the whole rod's, on the mesh of the case, at these unknowns.

        What shares have more than others stays, and so do the slopes.

        Raises:
            SolveError: if the whole rod finds no equilibrium.
        """
        branches, work = self._whole(x, rods.USUAL)
        now, missing = self._difference(x, branches), []
        for one in self.missing:
            at = x.copy()
            if self.share is not None:
                at[self.share] = one.at[self.share]
            more = tuple(self.lacking(at, k) + here - self.lacking(x, k) for k, here in enumerate(now))
            missing.append(Missing(at, more))
        return replace(self, missing=tuple(missing), work=work)

    def like(self, other: "Model") -> "Model":
        """The model with what whole rods have more in a fit of other springs that were pressed in the same way.

        The travel of a turn is an unknown beside what was read, which is another one here.
        """
        ends = [np.array([one.pressings[k].ends[branch] for k, branch in one.turns]) for one in (other, self)]
        moved = np.append(np.zeros(len(self.fitted)), ends[0] - ends[1])
        missing = tuple(replace(one, at=one.at + moved) for one in other.missing)
        return replace(self, missing=missing, slopes_missing=other.slopes_missing, weights=other.weights)

    def _whole(self, x: np.ndarray, fine: rods.Steps) -> tuple[list[list[Branch]], float]:
        runs = [self._pressed(x, number, fine) for number in range(len(self.pressings))]
        return [branches for branches, _ in runs], max(work for _, work in runs)

    def _pressed(self, x: np.ndarray, number: int, fine: rods.Steps) -> tuple[list[Branch], float]:
        """One press by the whole rod, and the greatest plastic work per volume."""
        material = self.form.material(self.values(x), TRIAL)
        return rods.whole(self.pressings[number], material, self.ends(x, number), fine)

    def _difference(self, x: np.ndarray, whole: Sequence[Sequence[Branch]]) -> tuple[np.ndarray, ...]:
        """Readings by whole rods less those by uniform ones."""
        return tuple(self.predicted(x, k, whole[k]) - ours for k, ours in enumerate(self.uniform(x)))

    def _step(self, x: np.ndarray, k: int) -> float:
        """Of unknown k, for slopes, within its bounds."""
        step = STEPS.get(self.fitted[k], 1e-3) if k < len(self.fitted) else 1e-3
        return step if x[k] + step <= self.bounds[1][k] else -step

    def uncorrected(self) -> "Model":
        """The model of uniform rods alone, with the rate of the readings' straight beginning."""
        unknowns = len(self.fitted) + len(self.turns)
        nothing = tuple(np.zeros(len(one.travel)) for one in self.pressings)
        slopes = tuple(np.zeros((len(one.travel), unknowns)) for one in self.pressings)
        weights = []
        for one in self.pressings:
            top = int(np.argmax(one.force))
            line = (
                Branch(np.array([0.0, one.travel[top]]), np.array([0.0, one.force[top]])) if not one.lengths else None
            )
            weights.append(self._weights(one, [line] * len(one.ends) if line else []))
        return replace(
            self,
            missing=(Missing(np.zeros(unknowns), nothing),),
            slopes_missing=slopes,
            weights=tuple(weights),
        )

    def _weights(self, one: Pressing, branches: Sequence[Branch]) -> np.ndarray:
        """Standard deviations of the readings of a pressing."""
        found = np.full(len(one.travel), self.errors.travel)
        for branch, curve in enumerate(branches if not one.lengths else ()):
            here = one.branch == branch
            rate = curve.slope(one.travel[here])
            typical = float(np.median(curve.slope(curve.places(21))))
            found[here] = np.hypot(self.errors.force * one.force[here], rate * self.errors.travel)
            closed = (rate > CLOSED * typical) | (one.force[here] < LEAST * one.force.max())
            found[here] = np.where(closed, np.inf, found[here])
        return found


def names(form: Form, known: Mapping[str, float], tester: Sequence[str]) -> tuple[str, ...]:
    """What is fitted: the constants that are not known, and properties of the tester."""
    constants = [name for name in CONSTANTS if name not in known]
    if known.get("rise") == 0.0:
        constants = [name for name in constants if name not in ("rate", "share")]
    return (*constants, *tester)


@lru_cache(maxsize=32)
def _uniform(one: Pressing, form: Form, constants: tuple[float, ...], ends: tuple[float | None, ...]) -> list[Branch]:
    """A press by the uniform rod; kept, as a slope by one unknown changes few of them."""
    return rods.uniform(one, _law(form, constants), ends)


@lru_cache(maxsize=2)
def _law(form: Form, constants: tuple[float, ...]) -> Law:
    return form.law(dict(zip(CONSTANTS, constants, strict=True)))
