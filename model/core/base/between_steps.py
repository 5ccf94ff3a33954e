"""The characteristic between the steps of a run: the one curve of which force, rate, sheet, comparison and figures are.

Between two steps it is a cubic of Hermite, with slopes of the parabolas through three steps, limited so that it stays
monotone (F. N. Fritsch and R. E. Carlson, SIAM J. Numer. Anal. 17, 1980). A part of fewer than three steps, or one
whose travel turns back, keeps its straight lines.

Where coils close or open between two steps the rate jumps on the way, and a cubic would go straight across the kink.
Closed coils are stiffer than open ones, so that the force lies below the chord and above both lines that lead on from
the steps before and behind. If the rate of the open coils is steady, it follows these lines to where they meet. Where
between lines and chord it is cannot be known without a step there: all of this counts as its error.
"""

import itertools
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from scipy.interpolate import PPoly

MAKERS = (0.3, 0.7)  # of the travel to block, between which EN 15800 measures the rate
FEW = 4  # points: with fewer, lines are straight
STEADY = 0.1  # of the jump of the rate: by less the rate of open coils changes before they close
DRAWN = 12  # points from a step to the next
FREE = 1e-3  # of the maximum force: under less, wound coils are closed
UNKNOWN = float("nan")


@dataclass(frozen=True)
class Between:
    """Force over the travel of some steps, in their order.

    Attributes:
        travel, force: mm and N; contacts: how many are closed, not a number where that is unknown.
        before, behind: slopes in front of the first point and behind the last one, N/mm, if they are known.
    """

    travel: np.ndarray
    force: np.ndarray
    contacts: np.ndarray
    before: float = UNKNOWN
    behind: float = UNKNOWN

    @classmethod
    def through(cls, travel: npt.ArrayLike, force: npt.ArrayLike, contacts: npt.ArrayLike | None = None) -> "Between":
        """The curve through points; without `contacts` it has no kinks."""
        x = np.asarray(travel, float)
        return cls(x, np.asarray(force, float), np.zeros(len(x)) if contacts is None else np.asarray(contacts, float))

    @cached_property
    def runs_on(self) -> bool:
        """Whether the travel never turns back, nor stays."""
        way = np.diff(self.travel)
        return bool(np.all(way > 0.0) or np.all(way < 0.0))

    @cached_property
    def _up(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Travel, force and contacts by ascending travel; slopes between them, two more at either end."""
        back = len(self.travel) > 1 and self.travel[-1] < self.travel[0]
        x, y, contacts = (
            values[::-1] if back else values for values in (self.travel, self.force, np.asarray(self.contacts, float))
        )
        first, last = (self.behind, self.before) if back else (self.before, self.behind)
        return x, y, contacts, np.array([UNKNOWN, first, *(np.diff(y) / np.diff(x)), last, UNKNOWN])

    @cached_property
    def _corners(self) -> dict[int, tuple[float, float] | None]:
        """Travel and force where the curve bends, by the number of the interval, ascending; None where the rate behind
        is not known: a straight line."""
        x, y, contacts, slopes = self._up
        found: dict[int, tuple[float, float] | None] = {}
        for k in range(len(x) - 1):
            early, left, chord, right = slopes[k : k + 4]
            if contacts[k] == contacts[k + 1] or not left < chord or right <= chord:
                continue
            steady = abs(left - early) <= STEADY * ((chord if np.isnan(right) else right) - left)
            if np.isnan(early):  # of two points, equal contacts show a line
                steady = k == 0 or bool(contacts[k - 1] == contacts[k])
            if steady and np.isnan(right):
                found[k] = None
            elif steady:
                at = (y[k] - y[k + 1] + right * x[k + 1] - left * x[k]) / (right - left)
                found[k] = float(at), float(y[k] + left * (at - x[k]))
        return found

    @cached_property
    def _cubic(self) -> "PPoly":
        """All pieces by ascending travel."""
        from scipy.interpolate import CubicHermiteSpline, PPoly

        x, y, *_ = self._up
        at, parts = [x[0]], []
        ends = [-1, *self._corners, len(x) - 1]
        for first, last in itertools.pairwise(ends):
            piece = slice(first + 1, last + 1)
            xs, ys = x[piece], y[piece]
            if len(xs) > 1:
                curved = len(xs) >= FEW
                parts.append(CubicHermiteSpline(xs, ys, _slopes(xs, ys)).c if curved else _lines(xs, ys))
                at.extend(xs[1:])
            if last in self._corners:
                corner = self._corners[last]
                bend = [corner] if corner else []
                xs, ys = np.array([(x[last], y[last]), *bend, (x[last + 1], y[last + 1])]).T
                parts.append(_lines(xs, ys))
                at.extend(xs[1:])
        return PPoly(np.concatenate(parts, axis=1), np.array(at))

    def at(self, travel: float) -> tuple[float, float, float]:
        """Force, N, its rate, N/mm, and how far the force may be from that by what is unknown between two steps, N."""
        if not self.runs_on:
            return self._on_lines(travel)
        x, y, contacts, slopes = self._up
        k = int(np.clip(np.searchsorted(x, travel), 1, len(x) - 1)) - 1
        force, rate = float(self._cubic(travel)), float(self._cubic(travel, 1))
        if np.abs(x[k : k + 2] - travel).min() <= 1e-9 * np.ptp(x):
            return force, rate, 0.0
        left, chord, right = slopes[k + 1 : k + 4]
        between = float(y[k] + chord * (travel - x[k]))
        away = abs(force - between)
        if contacts[k] != contacts[k + 1]:
            least = [y[k] + left * (travel - x[k])] if left < chord else []
            least += [y[k + 1] + right * (travel - x[k + 1])] if right > chord else []
            away = max(away, force - float(max(least, default=force)))
        return force, rate, away

    def _on_lines(self, travel: float) -> tuple[float, float, float]:
        order = np.argsort(self.travel, kind="stable")
        x, y = self.travel[order], self.force[order]
        k = int(np.clip(np.searchsorted(x, travel), 1, len(x) - 1))
        way = x[k] - x[k - 1]
        return float(np.interp(travel, x, y)), float((y[k] - y[k - 1]) / way) if way else UNKNOWN, 0.0

    def drawn(self) -> tuple[np.ndarray, np.ndarray]:
        """Travel and force of points on the curve, those of the steps and corners among them, in the steps' order."""
        if len(self.travel) < 2 or not self.runs_on:
            return self.travel, self.force
        x, y, *_ = self._up
        if len(x) < FEW and not self._corners:
            return self.travel, self.force
        ends = self._cubic.x
        fine = np.interp(np.arange(DRAWN * (len(ends) - 1) + 1) / DRAWN, np.arange(len(ends)), ends)
        forces = self._cubic(fine)
        forces[np.isin(fine, x)] = y
        return (fine, forces) if self.travel[-1] > self.travel[0] else (fine[::-1], forces[::-1])

    def rates_drawn(self) -> tuple[np.ndarray, np.ndarray]:
        """Travel and rate of points along the curve: those of its steps, and both rates of a corner, in that order."""
        x, corners = self._up[0], self._corners
        at, rates = [], []
        for k, one in enumerate(x):
            at.append(one)
            rates.append(float(self._cubic(one, 1)))
            if corner := corners.get(k):
                both = [(corner[0] + end) / 2.0 for end in (one, x[k + 1])]
                at += [corner[0]] * 2
                rates += [float(self._cubic(place, 1)) for place in both]
        found = np.array(at), np.array(rates)
        return found if self.travel[-1] > self.travel[0] else (found[0][::-1], found[1][::-1])


def _lines(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Coefficients of straight pieces."""
    rates = np.diff(y) / np.diff(x)
    return np.stack([0.0 * rates, 0.0 * rates, rates, y[:-1]])


def _slopes(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Slopes at points of which the cubic is monotone and, where nothing limits it, exact for a parabola."""
    way, chord = np.diff(x), np.diff(y) / np.diff(x)
    inner = (way[1:] * chord[:-1] + way[:-1] * chord[1:]) / (way[1:] + way[:-1])
    first, last = (chord[k] + way[k] * (chord[k] - chord[m]) / (way[k] + way[m]) for k, m in ((0, 1), (-1, -2)))
    slopes = np.concatenate([[first], inner, [last]])
    one, other = np.append(chord[0], chord), np.append(chord, chord[-1])
    least = np.where(one * other > 0.0, np.minimum(np.abs(one), np.abs(other)), 0.0)
    return np.where(slopes * one > 0.0, np.sign(slopes) * np.minimum(np.abs(slopes), 3.0 * least), 0.0)


def closed_rate(case: Mapping[str, Any], rate: float | None) -> float:
    """The rate of coils that touch, N/mm, if they are wound onto each other: the initial one; else not a number."""
    wound = (case.get("spring") or {}).get("initial_tension")
    return UNKNOWN if rate is None or not wound else rate


def part(
    travel: np.ndarray, force: np.ndarray, contacts: np.ndarray, first: int, last: int, closed: float = UNKNOWN
) -> Between:
    """The curve through the points from one to another of a history, with what the steps around them show.

    Args:
        travel, force, contacts: of all points, the unloaded spring first.
        first, last: the points.
        closed: rate of wound coils before they open.
    """
    points = slice(first, last + 1)
    x, y, count = travel[points], force[points], contacts[points].copy()
    sense = np.sign(x[-1] - x[0])
    before = behind = UNKNOWN
    if first and (travel[first] - travel[first - 1]) * sense > 0.0:
        before = (force[first] - force[first - 1]) / (travel[first] - travel[first - 1])
    way = travel[last + 1] - travel[last] if last + 1 < len(travel) else 0.0
    # a release begins at least as steeply as the load before it ended, as long as the coils stay closed
    if way and (way * sense > 0.0 or contacts[last + 1] > contacts[last - 1]):
        behind = (force[last + 1] - force[last]) / way
    if np.isfinite(closed):
        free = np.abs(y) <= FREE * np.abs(force).max()
        before, behind = closed if free[0] else before, closed if free[-1] else behind
        if first == 0:
            count[0] = UNKNOWN  # they may open in the first step
    return Between(x, y, count, float(before), float(behind))
