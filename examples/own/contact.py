"""A kind of contact of one's own: a mandrel inside a slender spring, which keeps it from buckling far.

scripts/coilset python examples/own/contact.py
"""

import numpy as np

from coilset.api import Case, solve
from coilset.model.core.contact.base import Contact, Contribution, TrialPositions, one_sided

STIFFNESS, ONSET = 2000.0, 0.005  # of each station, N/mm, and the distance over which contact sets in, mm


class Mandrel(Contact):
    """A smooth cylinder about the spring's axis, pressed by the stations of the wire."""

    name, aside = "mandrel", 0  # what acts on a station depends on this station only

    def __init__(self, radius: float, wire_radius: float, stations: np.ndarray) -> None:
        self.reach_of_axis, self.number = radius + wire_radius, np.arange(len(stations))
        self.dofs = 3 * self.number[:, None] + np.arange(2)  # x and y of each station

    def evaluate(self, trial: TrialPositions) -> Contribution:
        """The gap is ρ − R − r; with n = x/ρ its gradient is n and its second derivative (1 − n nᵀ)/ρ."""
        x = trial.x[:, :2]
        ρ = np.linalg.norm(x, axis=1)
        n, gap = x / ρ[:, None], ρ - self.reach_of_axis
        force, stiffness = one_sided(gap, np.full(len(gap), STIFFNESS), ONSET)
        nn = n[:, :, None] * n[:, None, :]
        K = stiffness[:, None, None] * nn - force[:, None, None] * (np.eye(2) - nn) / ρ[:, None, None]
        onset = np.full(len(gap), STIFFNESS * ONSET)
        return Contribution(self.dofs, -force[:, None] * n, K, force, -gap, self.number, onset)


spring = {"wire_diameter": 2.0, "mean_diameter": 20.0, "turns": 24, "pitch": 8.0}
mesh = {"elements_per_turn": 8, "section": {"radial": 2, "angular": 8}}
loading = [{"to": {"travel": 60.0}, "steps": 6}]
case = Case(
    {"spring": spring, "material": "elastic", "ends": "clamped", "mesh": mesh, "loading": loading}
    | {"accuracy": "none"}
)
deflections = {}
for name, contacts in (("free", None), ("guided", lambda points, stations: [Mandrel(8.0, 1.0, stations)])):
    x = solve(case, contacts=contacts).data["position"].to_numpy()[-1]
    deflections[name] = float(np.linalg.norm(np.mean(x[92:100, :2], axis=0)))  # of the middle turn
    print(f"{name}: the axis is {deflections[name]:.2f} mm aside at half height")
assert deflections["guided"] < 2.0 < 5.0 < deflections["free"]
