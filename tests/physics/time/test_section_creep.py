"""Creep of sections: the torsion bar in closed form, stationary torsion, and the section's tangent over time."""

import numpy as np
import pytest
from scipy.special import hyp2f1

from coilset.meshes.springs.placement import straight
from coilset.model.core.material.law.file import MaterialFile
from coilset.model.core.material.law.law import Law
from coilset.model.core.section.kinds import KINDS, make_sections
from coilset.model.core.section.rules import polar
from coilset.model.physics.time.creep.law import CreepLaw

G, A, N, P, RIM = 80000.0, 1e-20, 6.0, 0.3, 700.0  # of γ = A τ^N t^p
R = 2.5


def creeping(hardening="time", exponent=N, power=P, yielding=False):
    """A law with γ = A τ^N t^p in shear: c₀/σ₀^N = A/√3^(N+1)."""
    hard = {"k0_squared": 2 / 3 * 250.0**2, "a1": 1.0, "a2": 4000.0}
    constants = {
        "temperature": 293.15,
        "elasticity": {"G": G, "nu": 0.3},
        "isotropic": hard if yielding else "none",
        "kinematic": "none",
        "non_normality": "none",
    }
    creep = {
        "form": "norton_bailey",
        "strain": A * 500.0**exponent / 3 ** (0.5 * (exponent + 1)),
        "stress": 500.0,
        "exponent": exponent,
        "time_exponent": power,
        "hardening": hardening,
    }
    about = {
        "name": "synthetic",
        "description": "a law",
        "source": "none",
        "units": "N, mm, K",
        "creep": creep,
        "validity": {"plastic_work": 100, "remark": "none"},
        "temperatures": [constants],
    }
    return Law(MaterialFile.model_validate(about))


class Section:
    """One element of a rod under section strains and time."""

    def __init__(self, law, kind="plane", radial=12, angular=12, placement=None):
        self.sections = make_sections(
            kind,
            law,
            law.parameters(),
            polar(radial, angular),
            np.array([R]),
            straight(1) if placement is None else placement,
        )
        self.creep = CreepLaw(law.data.creep, law.parts())
        self.state = self.sections.initial_state() | {
            "strain": np.zeros((1, 2, 6)),
            "clock": self.creep.clock(0, 293.15),
        }
        self.s, self.D = np.empty((1, 2, 6)), np.empty((1, 2, 6, 6))

    def go(self, strain, hours, keep=True):
        """Section forces at strains, shape (6,), and a time."""
        trial = {name: values.copy() for name, values in self.state.items()}
        trial["clock"] = self.creep.clock(hours, 293.15, self.state["clock"])
        trial["strain"] = np.broadcast_to(strain, (1, 2, 6)).copy()
        assert self.sections.update(trial["strain"], self.state, trial, self.s, self.D)
        if keep:
            self.state = trial
        return self.s[0, 0].copy()

    def shear(self):
        """τ and its place ρ at the points of the first section."""
        columns = self.sections.components
        rows = self.state["point_state"][0, 0]
        return np.hypot(rows[:, columns.index("t12")], rows[:, columns.index("t13")])


@pytest.mark.parametrize(("hours", "known"), [(1.0, 0.951753), (1e3, 0.809369), (1e5, 0.668594)])
def test_relaxation_of_a_torsion_bar(hours, known):
    """Time hardening: M/M0 = ₂F₁(1/(N−1), 4/(N−1); 1 + 4/(N−1); −z), z = (N−1) G A t^p τR^(N−1)."""
    z = (N - 1) * G * A * hours**P * RIM ** (N - 1)
    closed = hyp2f1(1 / (N - 1), 4 / (N - 1), 1 + 4 / (N - 1), -z)
    assert closed == pytest.approx(known, abs=1e-6)
    bar, twist = Section(creeping()), np.array([0, 0, 0, RIM / (G * R), 0, 0])
    start, n = bar.go(twist, 0.0)[3], 12
    assert start == pytest.approx(np.pi / 2 * R**3 * RIM, rel=1e-3)
    for t in hours * 10.0 ** np.linspace(-6, 0, n):
        end = bar.go(twist, t)[3]
    assert end / start == pytest.approx(closed, rel=2e-3)


@pytest.mark.parametrize(
    "kind", [pytest.param(kind, marks=pytest.mark.slow) if kind == "warping" else kind for kind in KINDS]
)
def test_stationary_torsion(kind):
    """Steady creep at constant torque M: τ = τR (r/R)^(1/N) with M = 2π R³ τR/(3 + 1/N), whatever came before."""
    exponent, torque = 4.0, 8000.0
    bar = Section(creeping(exponent=exponent, power=1.0), kind)
    strain = np.zeros(6)
    rim = torque * (3 + 1 / exponent) / (2 * np.pi * R**3)
    rate = A * rim**exponent / R  # of twist, at last
    for hours in (0.0, *(10.0 ** np.linspace(-3, 2.0, 50) * rim / (G * R * rate))):
        for _ in range(20):
            s = bar.go(strain, hours, keep=False)
            strain = strain + np.linalg.solve(bar.D[0, 0], [0, 0, 0, torque, 0, 0] - s)
            if np.abs([0, 0, 0, torque, 0, 0] - s).max() < 1e-8 * torque:
                break
        bar.go(strain, hours)
    rho = np.linalg.norm(polar(12, 12).points, axis=1)
    np.testing.assert_allclose(bar.shear(), rim * rho ** (1 / exponent), rtol=2e-3)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("yielding", [False, True])
def test_tangent_over_time(kind, yielding):
    """s(e + h v) − s(e) − h D v falls as h² in a curved wire that creeps, and yields."""
    rng = np.random.default_rng(4)
    place = straight(1)
    if kind != "plane":
        place = place._replace(curvature=np.full((1, 2), 0.05), torsion=np.full((1, 2), 0.01))
    section = Section(creeping("strain", yielding=yielding), kind, 4, 12, place)
    unit = np.array([1, 1, 1, 1 / R, 1 / R, 1 / R])
    section.go(2e-3 * unit * rng.normal(size=6), 0.0)
    section.go(section.state["strain"][0, 0] + 1e-3 * unit * rng.normal(size=6), 10.0)
    strain = section.state["strain"][0, 0] + 2e-3 * unit * rng.normal(size=6)
    steps, v = 10.0 ** np.arange(-2, -4.01, -0.5), 2e-3 * unit * rng.normal(size=6)
    s, D = section.go(strain, 1e4, keep=False), section.D[0, 0].copy()
    rest = [np.linalg.norm((section.go(strain + h * v, 1e4, keep=False) - s - h * D @ v) / unit) for h in steps]
    slope = np.polyfit(np.log(steps), np.log(rest), 1)[0]
    assert slope == pytest.approx(2, abs=0.15)
