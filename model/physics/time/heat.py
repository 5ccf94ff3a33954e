"""Warm wire: what plastic work heats at the section points is conducted along the wire between the steps of a rod.

Within a step the law is adiabatic: each point warms as it flows. Then the heat equation goes on by the seconds that the
step took, with what the sections got as its source, and all points of a section follow its mean. Differences across the
section even out as their slowest mode does, with the rate 3.39 a/r² (1.84², the first zero of J₁′), a = k/(ρ c). The
section's thermal strain reaches the rod in its next step. Stress follows G(T), E(T) in increments, as within the law.

In a material that creeps it follows them at once, as in `creep`. There the surroundings' temperature may be driven, and
equilibrium is found again after the heat of each step.
"""

import numpy as np

from coilset.model.core.base.agreement import max_of_ranks
from coilset.model.core.body.state import Where
from coilset.model.core.material.law.law import Law
from coilset.model.core.rod.rod import Rod
from coilset.model.core.rod.section_states import CLOCKS
from coilset.model.core.section.fibres import FibreSections
from coilset.model.core.section.kinds import cut_points
from coilset.model.core.section.rules import spread
from coilset.model.physics.time.creep.law import HOURS, TEMPERATURE
from coilset.model.physics.time.heat_equation import HeatConstants, HeatEquation

SLOWEST = 1.8411837813406593**2
COLUMN = 7  # of the points' temperature
FIELDS = "point_state", "surface_state"  # those of a finer path end like this, too


def heat_constants(law: Law, conductivity: float, convection: float, tips: float, surroundings: float) -> HeatConstants:
    """Constants of a material with heating; W/(m K), W/(m² K), W/K of each tip, K."""
    heating = law.data.heating
    assert heating is not None
    capacity = heating.density * heating.specific_heat
    return HeatConstants(capacity, conductivity, 1e-3 * convection, 1e3 * tips, surroundings)


class WireHeat:
    """Carries heat along a rod whose material warms by plastic work.

    Args:
        rod: Rod, with sections of fibres.

    Attributes:
        equation: HeatEquation.
        start_content: heat in the wire at the start, ∫ ρ c (T − T∞) dV, N mm; the same on every rank.
        creeps: does the material creep, too? Then the rod's clock has the surroundings' temperature.
    """

    def __init__(self, rod: Rod, constants: HeatConstants) -> None:
        self.rod, mesh = rod, rod.mesh
        cells = mesh.topology.index_map(1)
        radius = np.empty(cells.size_local + cells.num_ghosts)
        radius[:] = rod.largest_radius
        radius[: len(rod.radius)] = rod.radius
        stretch, left = np.ones((2, len(radius), len(rod.element.abscissae)))
        stretch[: len(rod.radius)] = rod.placement.stretch
        assert isinstance(rod.sections, FibreSections)
        bend = rod.placement.curvature if rod.sections.curved else np.zeros_like(rod.placement.curvature)
        rule, cut = rod.rule, cut_points(rod.rule, rod.placement)
        places, weights = spread(rule.points, rule.weights, bend.shape, cut)
        g = 1.0 - bend[..., None] * rod.radius[:, None, None] * places[..., 0]
        left[: len(rod.radius)] = np.sum(weights * g, axis=-1)  # 1 of a round section, whose centre is on its axis
        self._weights = weights * g
        self._left = left[: len(rod.radius)]
        self.equation = HeatEquation(rod.line, radius, constants, rod.temperature, rod.element, stretch, left)
        self._nodes = rod.state.add("temperature", np.full(len(rod.x), rod.temperature), Where.STATION)
        self.start_content = self.equation.content
        self._totals = rod.state.add("heat", np.zeros(2), Where.SHARED)  # generated, given off
        self._clock = rod.state.add("heat_clock", np.array([0.0, rod.temperature, 0.0]), Where.SHARED)
        self.creeps = rod.in_time is not None
        for clock in (rod.state[name] for name in CLOCKS if self.creeps):
            clock.equilibrium[TEMPERATURE] = clock.trial[TEMPERATURE] = constants.surroundings

    @property
    def generated(self) -> float:
        """Heat of plastic work up to now, N mm."""
        return float(self._totals.equilibrium[0])

    @property
    def given_off(self) -> float:
        """Heat that air and seats got up to now, N mm."""
        return float(self._totals.equilibrium[1])

    def catch_up(self) -> None:
        """Let heat flow up to the time of the rod's clock, with the surroundings' temperature there; collective."""
        clock = self.rod.clock
        self.equation.surroundings.value = clock[TEMPERATURE]
        self.advance(3600.0 * float(clock[HOURS] - self._clock.equilibrium[HOURS]))

    def advance(self, seconds: float) -> None:
        """Let a step have taken some seconds; changes the last equilibrium; collective."""
        rod, equation, cells = self.rod, self.equation, len(self.rod.radius)
        equation.temperature.x.array[equation.dofs] = self._nodes.equilibrium
        mean = np.sum(self._weights * rod.state["point_state"].equilibrium[..., COLUMN], axis=-1) / self._left
        got = np.pi * rod.radius[:, None] ** 2 * self._left * equation.constants.capacity
        equation.source[:] = 0.0
        equation.source[:cells] = got * (mean - equation.at_sections(rod.element.xi)[:cells])
        before = equation.content
        equation.advance(0.0)
        still = equation.at_sections(rod.element.xi)[:cells]
        generated = equation.content - before
        equation.source[:] = 0.0
        given_off = equation.advance(seconds)
        self._warm(mean, still, equation.at_sections(rod.element.xi)[:cells], seconds)
        totals = self._totals.equilibrium
        totals += generated, given_off
        self._nodes.equilibrium[:] = equation.temperature.x.array[equation.dofs]
        hottest = max_of_ranks(rod.comm, self._nodes.equilibrium.max(initial=0.0))
        self._clock.equilibrium[:2] = self._clock.equilibrium[0] + seconds / 3600.0, hottest
        rod.state.restore()

    def _warm(self, mean: np.ndarray, still: np.ndarray, now: np.ndarray, seconds: float) -> None:
        """Bring the sections' points to the temperatures after conduction.

        Args:
            mean: of the sections, before; still, now: those of the equation before and after, K, shape (cells,
                sections).
            seconds: in which differences fade that the equation does not see, in a section and within an element.
        """
        rod, constants = self.rod, self.equation.constants
        rate = constants.conductivity / constants.capacity
        across = np.exp(-SLOWEST * rate * seconds / rod.radius**2)[:, None]
        along = np.exp(-(np.pi**2) * rate * seconds / rod.l0**2)[:, None]
        after = now + (mean - still) * along
        low, high = rod.law.temperature_range  # outside it only by rounding
        for name, field in rod.state.items():
            if name.endswith(FIELDS):
                temperature = field.equilibrium[..., COLUMN]
                left = (temperature - mean[..., None]) * across[..., None]
                reached = np.clip(after[..., None] + left, low, high)
                if self.creeps:
                    (E0, G0), (E1, G1) = rod.law.moduli(temperature), rod.law.moduli(reached)
                    field.equilibrium[..., 0] *= E1 / E0
                    field.equilibrium[..., 1:3] *= (G1 / G0)[..., None]
                temperature[:] = reached
        if mean.size:
            change = np.vectorize(rod.law.thermal_strain)(np.clip(mean, low, high), np.clip(after, low, high))
            rod.state["strain"].equilibrium[..., 0] += change  # of the chord; a wire that grows evenly turns nowhere
