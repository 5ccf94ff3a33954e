"""Closed loop of elastic strain, with and without the material's spin: what remains, and what the rates alone leave

A bar is stretched by 1 %, twisted to 2 % at its surface, shortened and twisted back. Hooke's law leaves nothing. The
rates with spin in the form of the thesis (5.2.33), after Zaremba and Jaumann, do not derive from an energy: some stress
remains even if they are integrated exactly (M. Kojić and K.-J. Bathe, Computers and Structures 26 (1987) 175). At the
shear angle γ they are

    σ′ = −τ,  τ′ = G + ½ σ:    s = σ + 2G turns with γ/√2,   s = s0 cos(γ/√2) − √2 τ0 sin(γ/√2),
                                                              τ = τ0 cos(γ/√2) + s0/√2 sin(γ/√2),

so that ½ E ε γ of shear remains to first order, 21.0 MPa here where σ rose to 2,100 MPa. The program's stress is a
function of the elastic strain, namely the one that the closed form gives after stretch and twist
(`back_stresses/spin.py`): both components must agree with the closed form as long as the bar is only stretched
and then twisted, and nothing may remain.

Tolerance: 1e-6 MPa, in any number of steps; the maximum found is 3e-10.
"""

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from coilset.model.core.base.style import STYLE
from coilset.model.core.material import library
from coilset.model.core.material.law.law import Law
from coilset.model.core.section.rules import DiskRule
from coilset.verification.chain import ALL, ROTATION_X, X, chain, drive, straight
from coilset.verification.study import Study

FAST = True
LENGTH, RADIUS, STRETCH, SHEAR = 10.0, 1.0, 0.01, 0.02
STEPS = (1, 10, 40)  # of each of the four parts
SOURCE, CLOSED = "rates in closed form", 1e-6  # MPa
RING = DiskRule(
    np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]]), np.full(4, 0.25), "four points of the surface"
)


def loop(law: Law, steps: int) -> np.ndarray:
    """σ and τ of the surface on the way, MPa, shape (4 steps + 1, 2)."""
    frame = chain(straight(LENGTH, 1), RADIUS, law, RING, [(0, ALL), (1, range(1, 6))])
    pull, turn, rows = frame.dof(1, X), frame.dof(1, ROTATION_X), [(0.0, 0.0)]
    length, twist = LENGTH * np.expm1(STRETCH), SHEAR / RADIUS * LENGTH
    # φ′ refers to the current length: as the bar is shortened, it is turned back so that γ stays the same
    more = twist * np.expm1(STRETCH)

    def keep() -> None:
        rows.append((frame.rod.point_state[0, 0, 0, 0], frame.rod.point_state[0, 0, 0, 2]))

    for way, angle in ((length, 0.0), (0.0, twist + more), (-length, -more), (0.0, -twist)):
        drive(frame, steps, {pull: way, turn: angle}, after=keep)
    return np.array(rows)


def closed_form(law: Law) -> np.ndarray:
    """σ and τ by the rates alone at the start and at the ends of the four parts, MPa, shape (5, 2)."""

    def twisted(state: np.ndarray, γ: float) -> np.ndarray:
        (σ, τ), turn = np.add(state, (2.0 * law.G, 0.0)), γ / np.sqrt(2.0)
        end = σ * np.cos(turn) - np.sqrt(2.0) * τ * np.sin(turn), τ * np.cos(turn) + σ / np.sqrt(2.0) * np.sin(turn)
        return np.array(end) - (2.0 * law.G, 0.0)

    states = [np.zeros(2), np.array([law.E * STRETCH, 0.0])]
    states.append(twisted(states[-1], SHEAR))
    states.append(states[-1] - states[1])
    states.append(twisted(states[-1], -SHEAR))
    return np.array(states)


def run(study: Study) -> None:
    """What remains with and without spin."""
    law, none = library.load("elastic", spin=True), library.load("elastic", spin=False)
    exact, rows, paths = closed_form(law), [], {}
    for steps in STEPS:
        paths[steps] = path = loop(law, steps)
        rows.append([steps, *path[2 * steps], *path[-1]])
        for k, name in enumerate("στ"):
            study.check(
                f"{name} stretched and twisted, with spin, {steps} steps per part, MPa",
                path[2 * steps, k],
                exact[2, k],
                SOURCE,
                CLOSED,
                "absolute",
            )
        study.check(
            f"remaining stress with spin, {steps} steps per part, MPa",
            np.abs(path[-1]).max(),
            0.0,
            "a closed path",
            CLOSED,
            "absolute",
        )
    left = np.abs(loop(none, STEPS[1])[-1]).max()
    study.check("remaining stress without spin, MPa", left, 0.0, "Hooke's law", CLOSED, "absolute")
    columns = ["steps per part", "σ, twisted", "τ, twisted", "remaining σ", "remaining τ"]
    study.table("with spin, MPa", columns, rows)
    study.note(f"The rates alone leave {exact[-1, 1]:.2f} MPa of shear, however small the steps are.")
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(5.2, 3.8), layout="constrained")
        axes = figure.add_subplot()
        axes.plot(*paths[STEPS[1]].T, "o-", ms=3, lw=0.9, label=f"coilset, {STEPS[1]} steps per part")
        axes.plot(*exact.T, "kx", ms=7, label=SOURCE)
        axes.set(xlabel="σ in MPa", ylabel="τ in MPa", title="Closed loop of elastic strain, with spin")
        axes.grid(lw=0.3)
        axes.legend(fontsize=8)
    study.figure("elastic_strain_loop", figure)
