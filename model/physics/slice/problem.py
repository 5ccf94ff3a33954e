"""The slice on the solver of springs: what drives it, in the place of a spring's heads, and single steps."""

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from coilset.model.core.base.errors import SolveError
from coilset.model.core.contact.base import SEAT_DOFS
from coilset.model.core.equilibrium.newton.methods import rod_method
from coilset.model.core.equilibrium.newton.newton import Newton, Start
from coilset.model.core.equilibrium.path.continuation import Continuation
from coilset.model.core.equilibrium.path.program import LoadProgram, Stage, StepTaken
from coilset.model.core.equilibrium.settings import Drive, StepControl
from coilset.model.core.equilibrium.system.factors import FILL_REDUCING
from coilset.model.core.equilibrium.system.heads import AXIAL, When
from coilset.model.core.equilibrium.system.layout import SEATS, Layout
from coilset.model.core.equilibrium.system.load import Load
from coilset.model.core.equilibrium.system.system import System
from coilset.model.physics.slice.contact import SelfContact
from coilset.model.physics.slice.pressure import Pressure
from coilset.model.physics.slice.slice import Slice
from coilset.model.physics.slice.watch import Watch

# A fill-reducing order eliminates the dense rows and columns of h̄ and λ last.
OPTIONS = {"pc_factor_mat_ordering_type": FILL_REDUCING, "pc_factor_fill": 3.0, "snes_max_it": 20}
STEPS = StepControl(smallest=2.0**-8)
PRECISION = 1e-6  # ε of (6.3.1): out-of-balance forces relative to the change of force and torque in the step
TURNING = AXIAL + SEAT_DOFS // 2  # the freedom that λ drives: the top head about the axis


@dataclass(frozen=True)
class Effort:
    """Effort for an equilibrium: Newton iterations and cuts of the step."""

    iterations: int
    cuts: int


class SliceProblem:
    """Takes a slice from equilibrium to equilibrium, driven as the top head of a spring of so many turns.

    Args:
        free_ends: the ends may turn about the coil's axis (no torque); otherwise they cannot (λ = 1).
        contact: SelfContact of the body; without it coils pass through each other.
        turns: of the spring; free_length: its height, mm, by default that of its turns.

    Attributes:
        measure: see Heads.
        system, newton, continuation, program: the solver's.
    """

    measure = AXIAL

    def __init__(
        self,
        body: Slice,
        free_ends: bool = False,
        contact: SelfContact | None = None,
        turns: float = 1.0,
        free_length: float | None = None,
    ):
        self.body, self.free_ends, self._angle = body, free_ends, 2.0 * np.pi * turns
        self.free_length = self._angle * body.coil.rise if free_length is None else free_length
        body.contact, body.turns = contact, free_ends
        self._layout = layout = Layout(body.V, extra=2)
        centre = int(np.argmin(np.linalg.norm(body.start - [body.coil.radius, 0.0, 0.0], axis=1)))
        # translation along the axis and rotation about it change nothing: they are fixed at the middle of the section
        self._gauge = {3 * centre + 1: 0.0, 3 * centre + 2: 0.0}
        self._numbers = {AXIAL: layout.size - 2, TURNING: layout.size - 1}  # unknowns of h̄ and λ
        self._per_unknown = {AXIAL: self._angle, TURNING: self._angle / body.coil.radius}
        self.system = System(body, layout)
        self.newton = Newton(self.system, rod_method("newton", 1, OPTIONS), PRECISION)
        self.continuation = Continuation(self.newton, STEPS, starts=self._starts)
        self.program = LoadProgram(self, self.continuation)
        self.system.restore()

    # ---- as the heads of a spring ----------------------------------------------------------------------------------

    def load(self, values: Mapping[int, float], forces: Mapping[int, float], kept: Collection[int] = ()) -> Load:
        """The load from the last equilibrium to values and forces of freedoms, see Heads."""
        now, fixed, loaded = self.freedoms("equilibrium"), dict(self._gauge), dict[int, float]()
        (loaded if self.free_ends else fixed)[self._numbers[TURNING]] = 0.0
        for freedom, value in values.items():
            fixed[self._numbers[freedom]] = (value - now[freedom]) / self._per_unknown[freedom]
        for freedom, force in forces.items():
            loaded[self._numbers[freedom]] = force * self._per_unknown[freedom] / self._angle
        return Load.of(self._layout, fixed, loaded)

    def freedom_at(self, height: float) -> float:
        """Value of the axial freedom at a height, mm."""
        return height - self.free_length

    def freedoms(self, when: When) -> np.ndarray:
        """Values of the heads' freedoms, of which two may differ from 0, shape (12,), mm and rad."""
        values, numbers, coil = np.zeros(SEATS), getattr(self.body.extra, when), self.body.coil
        values[[AXIAL, TURNING]] = self._angle * (numbers / [1.0, coil.radius] - [coil.rise, 1.0])
        return values

    def reactions(self, when: When) -> np.ndarray:
        """Forces that are conjugate to the freedoms, shape (12,), N and N mm."""
        values = np.zeros(SEATS)
        values[[AXIAL, TURNING]] = getattr(self.system.state["reactions"], when)[-2:] * [1.0, self.body.coil.radius]
        return values

    @property
    def height(self) -> float:
        """Of the spring at the last equilibrium, mm."""
        return self.free_length + float(self.freedoms("equilibrium")[AXIAL])

    @property
    def force(self) -> float:
        """Axial force at the last equilibrium, compression positive, N."""
        return -float(self.reactions("equilibrium")[AXIAL])

    @property
    def torque(self) -> float:
        """About the axis at the last equilibrium, N mm."""
        return float(self.reactions("equilibrium")[TURNING])

    @property
    def pressure(self) -> Pressure:
        """Of the contact at the last equilibrium."""
        return self.body.pressure

    def let_go(self) -> None:
        """Go to the coil without force and torque, whether or not its ends may turn; within an excursion.

        Raises:
            SolveError: if there is no equilibrium.
        """
        turns, free = self.body.turns, self.free_ends
        self.body.turns = self.free_ends = True
        try:
            self.go_to_force(0.0)
        finally:
            self.body.turns, self.free_ends = turns, free

    # ---- steps -----------------------------------------------------------------------------------------------------

    def run(self, stage: Stage) -> Iterator[StepTaken]:
        """Go through a stage, step by step.

        Raises:
            SolveError: if there is no equilibrium or no stress at an output point; the last equilibrium is kept.
        """
        self.program.begin(0)
        try:
            yield from self.program.run(stage)
        except SolveError:
            self.system.restore()
            raise

    def go_to_rise(self, rise: float, turn: float | None = None, hours: float = 0.0) -> Effort:
        """Find the equilibrium at a rise h̄, mm/rad, in one step, which is cut if it is not found.

        Args:
            rise: h̄ at the end of the step.
            turn: λ at the end of the step if the ends are turned; not with free ends.
            hours: that it takes.

        Raises:
            SolveError: as `run`.
        """
        self.body.turns = self.free_ends or turn is not None
        drives = () if turn is None else (Drive(TURNING, "value", self._angle * (turn - 1.0)),)
        height = self.free_length + self._angle * (rise - self.body.coil.rise)
        label = f"a pitch of {2 * np.pi * rise:g} mm"
        return self._go(Stage("height", height, 1, label, hours, None, True, drives))

    def go_to_force(self, force: float) -> Effort:
        """Find the equilibrium under an axial force, compression positive, N; otherwise as `go_to_rise`."""
        return self._go(Stage("force", force, 1, f"{force:g} N", 0.0, None, True))

    def _go(self, stage: Stage) -> Effort:
        taken = list(self.run(stage))
        return Effort(sum(step.outcome.iterations for step in taken), sum(step.cuts for step in taken))

    def probe(self, rise: float, watch: Watch) -> tuple[float, np.ndarray]:
        """Response to a small change of the rise from the last equilibrium, which is kept.

        Returns:
            Axial force, compression positive, N, and the stress at the points of the watch in the section's axes, MPa.
        """
        load = self.load({AXIAL: self._angle * (rise - self.body.coil.rise)}, {})
        read = lambda: (-float(self.reactions("trial")[AXIAL]), watch.section_stress(watch.evaluate()))  # noqa: E731
        return self.continuation.probe(load, read)[1]

    def _starts(self, load: Load, size: float) -> Iterator[Start]:
        """The linear response with the last moduli, unless the load reverses; then the last equilibrium."""
        iteration, system = self.newton.iteration, self.system
        system.expire_at_equilibrium()
        if self.program.stage.hours:  # what is out of balance after this time then drives the step
            system.evaluate(self._layout.vector())
        system.last_tangent(load, iteration.matrix)
        start, forces = self._layout.vector(), self._layout.vector()
        values = forces.getArray()
        values[:] = -system.state["reactions"].trial
        values[load.loaded] += load.forces
        values[load.held] = load.increments
        ksp = iteration.snes.getKSP()
        ksp.setOperators(iteration.matrix.mat)
        ksp.solve(forces, start)
        rise = self._numbers[AXIAL]
        if start.getArray(readonly=True)[rise] * system.state["increments"].equilibrium[rise] >= 0.0:
            yield Start(start, 1)
        yield Start()
