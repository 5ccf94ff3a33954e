"""The sheet of a spring: the input of the formulas of EN 13906-1 and EN 15800, and the values that rows share."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import degrees

from coilset.meshes.springs.geometry import Spring
from coilset.model.core.case import Case
from coilset.model.core.case.phases import Phase
from coilset.model.core.material.law.steel import Elastic
from coilset.model.tools.sheet.from_results import Found
from coilset.model.tools.standards import en13906, en15800, goodman
from coilset.model.tools.standards.buckling import SEATING
from coilset.model.tools.standards.cylinder import Cylinder
from coilset.model.tools.standards.rate import OnPoint
from coilset.model.tools.wires.wire import Wire

AT_BLOCK = 0.01  # of the wire diameter: a run closer than this to the block length of the geometry reached block


@dataclass(frozen=True)
class Sheet:
    """The input of the sheet; lengths in mm.

    Attributes:
        spring: the cylinder.
        elastic: moduli and density.
        helix: true length of the wire's centre line, mm.
        wire: standard wire, for strength, allowed stress and endurance; None if the material is not a standard wire.
        lengths: working lengths.
        grade: of EN 15800.
        surface: `as coiled` or `shot peened`, for endurance.
        dynamic: whether the load alternates, which affects Sa.
        found: results of a run; None without one.
        held: whether the ends of the run cannot turn about the spring's axis.
        yield_stress: of the run's material in tension, MPa; None if it is unknown or the material is elastic.
        strength: tensile strength Rm that the material's file gives, MPa; None if it gives none.
        pulled: whether the load program pulls the spring, see EN 13906-2.
        turned: whether it turns the spring, see EN 13906-3.
        turns_to: rotations that the load program goes to, degrees, positive in the winding direction.
        tension: initial tension F0 of coils wound onto each other, N.
        beyond: compliance of hooks, mm/N, or of arms, rad/(N mm).
        hook_stress: greatest stress along the wire of the hooks for 1 N, MPa; 0 without hooks.
        seating: coefficient ν of the ends, by which it buckles.
        on_point: of a torsion spring with an arm on a point; None of others.
    """

    spring: Cylinder
    elastic: Elastic
    helix: float
    wire: Wire | None = None
    lengths: Sequence[float] = ()
    grade: en15800.Grade = 2
    surface: str = "as coiled"
    dynamic: bool = False
    found: Found | None = None
    held: bool = False
    yield_stress: float | None = None
    strength: float | None = None
    pulled: bool = False
    turned: bool = False
    turns_to: Sequence[float] = ()
    tension: float = 0.0
    beyond: float = 0.0
    hook_stress: float = 0.0
    on_point: OnPoint | None = None
    seating: float = SEATING

    @property
    def rate(self) -> float:
        """R, N/mm."""
        return en13906.rate(self.elastic.shear_modulus, self.spring.of_rate, self.spring.D, self.spring.n)

    @property
    def pull_rate(self) -> float:
        """R with hooks, N/mm."""
        return 1.0 / (1.0 / self.rate + self.beyond)

    @property
    def turn_rate(self) -> float:
        """R of a torsion spring with its arms, N mm/°."""
        if self.on_point:
            return 1.0 / degrees(self.on_point.compliance)
        body = en13906.turn_rate(self.elastic.young_modulus, self.spring.d, self.spring.D, self.spring.n)
        return 1.0 / (1.0 / body + degrees(self.beyond))

    def bending_stress(self, turn: float) -> float:
        """Nominal bending stress of a torsion spring at a rotation, degrees, where it is greatest, MPa."""
        σ = en13906.bending_stress(self.turn_rate * abs(turn), self.spring.d)
        return self.on_point.greatest * σ if self.on_point else σ

    def force(self, length: float) -> float:
        """Nominal force at a length, N: R (L0 − L), or that of coils of variable pitch, which close one by one.

        Pulled it is negative: up to F0 hooks alone give way, by c F; beyond, L − L0 = c F + (F − F0)/R.
        """
        travel = self.spring.length - length
        if self.pulled:
            if self.beyond and -travel < self.beyond * self.tension:
                return travel / self.beyond
            return (travel - self.tension / self.rate) * self.pull_rate
        if not self.spring.pitches:
            return self.rate * travel
        return self.spring.series_force(travel, self.rate * self.spring.n)

    def length(self, force: float) -> float:
        """Nominal length under a force, mm, by the rate."""
        if self.pulled:
            return self.spring.length - self.beyond * force - min(force + self.tension, 0.0) / self.rate
        return self.spring.length - force / self.rate

    def stated_force(self, length: float) -> float:
        """Force at a length that a drawing states, N: that of the run, else the nominal one."""
        found = self.found.force_at(length) if self.found else None
        return self.force(length) if found is None else found

    @property
    def force_formula(self) -> str:
        """How `force` is found, in symbols."""
        if self.pulled and self.tension:
            return "L − L0 = c F + (F − F0)/R, c of hooks" if self.beyond else "F0 + R (L − L0)"
        if self.pulled:
            return "R (L − L0)"
        return "s = ∫ min(F/R₁, p − d) dt" if self.spring.pitches else "R (L0 − L)"

    def stress(self, length: float) -> float:
        """Nominal uncorrected shear stress at a length, MPa."""
        return en13906.stress(self.force(length), self.spring.of_stress, self.spring.D)

    @property
    def block(self) -> float | None:
        """Lc of the standard, mm; None for ends without a formula."""
        s = self.spring
        return en13906.block_length(s.ends, s.turns, s.d + self.tolerance_of_wire, en13906.is_hot_coiled(s.d))

    @property
    def shortest(self) -> float:
        """The block length from which gaps are counted: Lc of the standard, or the geometry's where there is none."""
        return self.spring.solid if self.block is None else self.block

    @property
    def gaps(self) -> float:
        """Minimum sum of the gaps Sa, mm."""
        s = self.spring
        return en13906.gap_sum(s.d, s.D, s.n, self.dynamic)

    @property
    def smallest(self) -> float:
        """Smallest working length Ln = Lc + Sa, mm."""
        return self.shortest + self.gaps

    @property
    def tolerance_of_wire(self) -> float:
        """Tolerance of d included in d_max, mm; 0 if unknown."""
        return (self.wire.diameter_tolerance(self.spring.d) if self.wire else None) or 0.0

    @property
    def cycle(self) -> goodman.Cycle | None:
        """Least and greatest corrected stress at the working lengths, pulled or pressed; None with fewer than two."""
        if len(self.lengths) < 2:
            return None
        stresses = [self.spring.correction * abs(self.stress(length)) for length in self.lengths]
        return goodman.Cycle(min(stresses), max(stresses))

    @property
    def residual(self) -> float | None:
        """Residual stress of the run that shifts the cycle, MPa; that of coils wound onto each other is their F0."""
        return self.found.residual if self.found and not self.pulled else None

    @property
    def least_strength(self) -> float | None:
        """Rm of the standard wire, or of the material's file, MPa; None if neither is known."""
        return self.wire.strength(self.spring.d) if self.wire else self.strength

    @property
    def endured(self) -> goodman.Line | None:
        """Endurance of the wire; None if unknown."""
        endurance = self.wire.endurance(self.surface) if self.wire else None
        return goodman.line(endurance, self.spring.d) if endurance else None

    @property
    def was_at_block(self) -> bool:
        """Whether the run came to the block length of the geometry."""
        if self.found is None:
            return False
        return bool(self.found.heights.min() < self.spring.solid + AT_BLOCK * self.spring.d)

    def at_run(self, name: str) -> float | None:
        """An entry of the run's summary; None without a run, or if the run did not get that far."""
        return self.found.get(name) if self.found else None


def pulled_lengths(case: Case, spring: Spring) -> list[float]:
    """Heights above the free length that a load program goes to, mm."""
    goals = [phase.goal(spring.free_length, spring.block_height) for phase in case.targets]
    return sorted({value for kind, value in goals if kind == "height" and value > spring.free_length})


def working_lengths(phases: Sequence[Phase], free_length: float, rate: float, block: float) -> list[float]:
    """Lengths that a load program goes to, mm, strictly between block and the unloaded spring.

    Args:
        phases: the case's `loading`.
        free_length: L0, mm.
        rate: R, for force targets, N/mm.
        block: block length of the geometry, mm.
    """
    found: list[float] = []
    for phase in phases:
        kind, value = phase.goal(free_length, block)
        length = value if kind == "height" else free_length - value / rate
        if block < length < free_length and all(abs(length - other) > 1e-9 for other in found):
            found.append(length)
    return found
