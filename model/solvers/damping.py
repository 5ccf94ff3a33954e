"""How far to go along a Newton correction where coils close and wire yields.

Contacts and yielding bend the residual: its norm often grows over a full correction that is right nevertheless, and a
search for a smaller norm (PETSc's `bt`) then creeps. Measured instead is the out-of-balance work along the correction,
s(λ) = y · F(x − λ y), as with Matthies and Strang: s falls from s(0) > 0 through zero where the energy is least.

A correction that presses coils far into each other is of no use either, since the wire yields in it: it goes only as
far as the contacts allow, and the next one sees them closed. If it was the one that meets the prescribed increments,
balance is sought there before it goes on (`System.share`).
"""

import numpy as np

GOOD = 0.3  # |s(λ)/s(0)| up to which a full correction is taken though the norm grows
AIM = 0.3  # |s(λ)/s(0)| to which a zero of s is sought
TRIES = 6
NARROW = 0.1  # share of the bracket that a try keeps away from its ends
BACK, LEAST = 0.4, 1e-3  # steps back where there is no zero of s, and where they end
QUARTER = 0.25  # step back where the law finds no stress


class Damping:
    """SNES's check before a line search (of type `basic`): scales the correction.

    Args:
        system: System.
        F: SNES's residual at x.
    """

    def __init__(self, system, F):
        self.system, self.F = system, F
        self.trial, self.force, self.free = (system.vector() for _ in range(3))

    def __call__(self, x, y):
        """Scale the correction `y`, by which SNES goes from `x` to x − y."""
        system = self.system
        system.bring_to(x)
        allowed = system.allowed_depth(system.depth)
        pending = system.misses(x)
        y.copy(self.free)
        system.clear_fixed(self.free)
        way, share, (s, n) = 1.0, 1.0, self._at(x, y, 1.0)
        if system.depth > allowed and (way := system.free_way(x, y, -1.0)) < 1.0:
            y.scale(way)
            self.free.scale(way)
            s, n = self._at(x, y, 1.0)
        work, norm = self.F.dot(self.free), self._free_norm(self.F)
        while s is None and share > LEAST:
            share *= QUARTER
            s, n = self._at(x, y, share)
        if s is not None and not pending and not (n < norm or abs(s) <= GOOD * abs(work)):
            share = self._zero(x, y, work, share, s) if work > 0.0 > s else self._back(x, y, norm, share, n)
        if share != 1.0:
            y.scale(share)
        if pending and way * share < 1.0:
            self.trial.waxpy(-1.0, y, x)
            system.share = system.reached(self.trial)

    def _at(self, x, y, share):
        """Work s and norm of the forces on the free unknowns at x − share · y; None where the law finds no stress."""
        self.trial.waxpy(-share, y, x)
        self.system.bring_to(self.trial)
        if self.system.failed:
            return None, np.inf
        self.system.balance(self.trial, self.force)
        return self.force.dot(self.free), self._free_norm(self.force)

    def _free_norm(self, F):
        F.copy(self.trial)
        self.system.clear_fixed(self.trial)
        return self.trial.norm()

    def _zero(self, x, y, work, share, s):
        """Share at which the work is near zero, by the Illinois rule."""
        low, s_low, high, s_high, side = 0.0, work, share, s, 0
        for _ in range(TRIES):
            margin = NARROW * (high - low)
            share = min(max((low * s_high - high * s_low) / (s_high - s_low), low + margin), high - margin)
            s, _ = self._at(x, y, share)
            if s is None:
                high, s_high = share, -work
                continue
            if abs(s) <= AIM * work:
                break
            if s > 0.0:
                low, s_low, s_high, side = share, s, s_high * (0.5 if side > 0 else 1.0), 1
            else:
                high, s_high, s_low, side = share, s, s_low * (0.5 if side < 0 else 1.0), -1
        return share

    def _back(self, x, y, norm, share, n):
        """Share at which the norm is less than at the start, or the least that was found."""
        best = n, share
        while share > LEAST and best[0] >= norm:
            share *= BACK
            best = min(best, (self._at(x, y, share)[1], share))
        return best[1]
