"""Checks of a law that comes from outside, at the door: compilation, results, determinism, state, tangent, directions.

A law is driven along random strain paths, from small increments, where most laws are elastic, to large ones. What is
refused here would later show as an iteration that does not converge, or as a result that nobody can explain.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from numba.core.errors import NumbaError, UnsupportedBytecodeError

from coilset.model.core.base.errors import InputError

SIZES = (1e-5, 1e-4, 3e-4, 1e-3, 3e-3)  # strain increments
PATHS, STEPS = 4, 12
STEP = 1e-6  # of the Taylor test, over the increment
WRONG = 2  # states of a path at which a kink may lie between the points of the Taylor test
Point = tuple[np.ndarray, np.ndarray, np.ndarray]  # stress, state and tangent


def check_law(update: Callable[..., bool], parameters: np.ndarray, width: int) -> tuple[tuple[float, float], bool]:
    """Check a compiled law of three stresses and a state of the given width.

    Returns:
        E and G of the unstressed point, MPa, and whether stresses turn with strains about the wire's axis.

    Raises:
        InputError: one line with what is wrong.
    """

    def at(stress: np.ndarray, state: np.ndarray, strain: np.ndarray) -> Point:
        new = np.full(3, np.nan), np.full(width, np.nan), np.full((3, 3), np.nan)
        before = stress.copy(), state.copy(), strain.copy(), parameters.copy()
        solved = update(stress, state, strain, parameters, *new)
        given = stress, state, strain, parameters
        if any(not np.array_equal(a, b) for a, b in zip(before, given, strict=True)):
            raise _wrong("writes into its arguments; only new_stress, new_state and tangent are written")
        if solved is None:
            raise _wrong("returns nothing; it must return True where it has found a solution, or False")
        if not solved:
            raise _wrong(f"finds no solution at the strain increment {strain}, from the stress {stress}")
        if not all(np.isfinite(one).all() for one in new):
            raise _wrong("leaves entries of new_stress, new_state or tangent unset or not finite")
        return new

    zero, nothing = np.zeros(3), np.zeros(width)
    try:
        C = at(zero, nothing, 1e-9 * np.ones(3))[2]
    except (NumbaError, UnsupportedBytecodeError, TypeError) as error:  # the last of another number of arguments
        raise _wrong(f"numba cannot compile it: {str(error).strip().splitlines()[0]}") from None
    if not (C[0, 0] > 0.0 and C[1, 1] > 0.0):
        raise _wrong(f"is not stiff where nothing is strained: ∂σ11/∂ε11 = {C[0, 0]:g}, ∂τ12/∂γ12 = {C[1, 1]:g}")
    rng, turned = np.random.default_rng(5), True
    for size in SIZES:
        for _path in range(PATHS):
            turned &= _check_path(at, size * rng.normal(size=(STEPS, 3)), width)
    return (float(C[0, 0]), float(C[1, 1])), bool(turned)


def _check_path(at: Callable[..., Point], increments: np.ndarray, width: int) -> bool:
    """Check along a path; whether the law is the same for all directions across the wire there."""
    stress, state, wrong = np.zeros(3), np.zeros(width), 0
    other, other_state, same = np.zeros(3), np.zeros(width), True
    turn = _turned(0.7)
    for strain in increments:
        new_stress, new_state, C = at(stress, state, strain)
        again = at(stress, state, strain)
        if not (np.array_equal(new_stress, again[0]) and np.array_equal(new_state, again[1])):
            raise _wrong("gives two answers for the same arguments: what it remembers belongs into the state")
        wrong += not _tangent_is_right(at, stress, state, strain, C)
        other, other_state, _ = at(other, other_state, turn @ strain)
        size = float(np.abs(new_stress).max()) + 1e-9
        same &= bool(np.abs(other - turn @ new_stress).max() < 1e-6 * size)
        stress, state = new_stress, new_state
        still = at(stress, state, np.zeros(3))
        if np.abs(still[0] - stress).max() > 1e-7 * size:
            raise _wrong("changes the stress where no strain is added: stress and state do not belong together")
    if wrong > WRONG:
        raise _wrong(f"fails the Taylor test of its tangent at {wrong} of {len(increments)} states")
    return same


def _tangent_is_right(at: Callable[..., Point], stress: Any, state: Any, strain: Any, C: np.ndarray) -> bool:
    """Whether ∂σ/∂ε agrees with central differences to 1e-4 of its greatest entry."""
    h = STEP * float(np.abs(strain).max()) ** 0.5 * 1e-2
    found = np.empty((3, 3))
    for j in range(3):
        aside = h * np.eye(3)[j]
        found[:, j] = (at(stress, state, strain + aside)[0] - at(stress, state, strain - aside)[0]) / (2.0 * h)
    return bool(np.abs(found - C).max() <= 1e-4 * np.abs(C).max())


def _turned(angle: float) -> np.ndarray:
    """Of (σ11, τ12, τ13) or (ε11, γ12, γ13) about the wire's axis."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])


def _wrong(problem: str) -> InputError:
    return InputError(problem, "law")
