"""Heat of presetting along the wire: a fin in closed form, energy, and the adiabatic and the isothermal limit

A straight wire that is heated uniformly and loses heat to air along its length and to a seat at each tip has the steady
temperature

    T − T∞ = q/(h U) [1 − g cosh(m x)/(k A m sinh(m L/2) + g cosh(m L/2))],   m² = h U/(k A),

with x measured from its middle. The error of linear elements falls with the square of their length; a step of 10⁹ s
reaches the steady state.

A spring of a made-up material, whose yield stress falls by 20 % in 280 K, is pressed far beyond yield and released. 90
% of its plastic work heats it, which lowers its force by 0.12 %. Within a microsecond it is adiabatic, as the law
itself is; over 10⁷ s, with strong convection, it is isothermal except for the heating within a step, which decreases
with the number of steps. In between, the work equals stored energy plus heat, and all the heat is either still in the
wire or has been given off.

Tolerances: fin, 0.1 % of the temperature range and 0.02 in the order; adiabatic limit, 10⁻⁶; isothermal limit, 20 % of
the effect of heating, with 40 steps (6 % found); energy, 0.5 % with 16 elements a turn (0.21 % found; 0.53 with 8, also
in 80 steps, 0.08 with 32).
"""

import matplotlib as mpl
import numpy as np
import yaml
from matplotlib.figure import Figure
from mpi4py import MPI

from coilset.meshes.line import line_mesh
from coilset.model.compose.analysis import Analysis
from coilset.model.core.base.style import STYLE
from coilset.model.core.case.case import check
from coilset.model.physics.time.heat_equation import HeatConstants, HeatEquation
from coilset.verification.study import Study

FAST = False
LENGTH, RADIUS, LONG = 200.0, 2.5, 1e9  # mm, s
FIN = HeatConstants(capacity=3.6, conductivity=50.0, convection=0.02, tips=300.0, surroundings=300.0)
HEAT = 5.0  # N/s, of a length
ELEMENTS = (10, 20, 40, 80)
DISSIPATED = 0.9
STEPS = 40


def fin(elements: int) -> tuple[np.ndarray, np.ndarray]:
    """Places (mm from the middle) and steady temperatures (K)."""
    stations = np.zeros((elements + 1, 3))
    stations[:, 0] = np.linspace(-0.5 * LENGTH, 0.5 * LENGTH, elements + 1)
    equation = HeatEquation(line_mesh(stations, MPI.COMM_SELF), np.full(elements, RADIUS), FIN, 300.0)
    equation.source[:] = HEAT * LONG
    equation.advance(LONG)
    places = equation.temperature.function_space.tabulate_dof_coordinates()[:, 0]
    order = np.argsort(places)
    return places[order], equation.temperature.x.array[order]


def exact(x: np.ndarray) -> np.ndarray:
    """The closed form."""
    area, around = np.pi * RADIUS**2, 2.0 * np.pi * RADIUS
    m = np.sqrt(FIN.convection * around / (FIN.conductivity * area))
    end = FIN.conductivity * area * m * np.sinh(0.5 * m * LENGTH) + FIN.tips * np.cosh(0.5 * m * LENGTH)
    return FIN.surroundings + HEAT / (FIN.convection * around) * (1.0 - FIN.tips * np.cosh(m * x) / end)


def material(study: Study, warms: bool) -> str:
    """A material file for the spring, with or without heating by plastic work."""

    def at(temperature: float, k0_squared: float) -> dict[str, object]:
        return {
            "temperature": temperature,
            "elasticity": {"G": 79000.0, "nu": 0.29},
            "isotropic": {"k0_squared": k0_squared, "a1": 1.0, "a2": 10666.667},
            "kinematic": "none",
            "non_normality": "none",
        }

    about = {
        "name": "warming",
        "description": "synthetic",
        "source": "synthetic",
        "units": "N, mm, K",
        "validity": {"plastic_work": 300.0, "remark": "synthetic"},
        "temperatures": [at(293.15, 666666.67), at(573.15, 426666.67)],
    }
    if warms:
        about["heating"] = {"dissipated": DISSIPATED, "density": 7.85e-9, "specific_heat": 4.6e8}
    path = study.folder / f"{'warming' if warms else 'isothermal'}.yaml"
    path.write_text(yaml.safe_dump(about), encoding="utf-8")
    return str(path)


def preset(file: str, seconds: float | None = None, steps: int = STEPS, elements: int = 8, **heat: float) -> Analysis:
    """A spring that has been compressed and released, each in `seconds`."""
    loading = [{"to": {"travel": 45.0}, "steps": steps}, {"to": {"force": 0.0}, "steps": steps // 5}]
    case = check(
        {
            "spring": {"wire_diameter": 2 * RADIUS, "mean_diameter": 40.0, "turns": 1.0, "pitch": 60.0},
            "ends": "clamped",
            "material": file,
            "temperature": 293.15,
            "mesh": {"elements_per_turn": elements, "section": {"radial": 6, "angular": 12}},
            "loading": [phase | ({"seconds": seconds} if seconds else {}) for phase in loading],
        }
        | ({"heat": heat} if heat else {})
    )
    analysis = Analysis(case, MPI.COMM_SELF)
    analysis.run()
    return analysis


def work(analysis: Analysis) -> tuple[float, float]:
    """Work of the force, and the remaining elastic energy, N mm."""
    force, travel = (
        np.array([0.0, *(getattr(step, name) for step in analysis.result.steps)]) for name in ("force_N", "travel_mm")
    )
    done = float(np.sum(0.5 * (force[1:] + force[:-1]) * np.diff(travel)))
    rod, place = analysis.rod, analysis.rod.placement
    s11, t12, t13 = np.moveaxis(rod.point_state[..., :3], -1, 0)
    g = 1.0 - place.curvature[..., None] * rod.radius[:, None, None] * rod.rule.points[:, 0]
    density = 0.5 * s11**2 / analysis.law.E + 0.5 * (t12**2 + t13**2) / analysis.law.G
    section = np.pi * rod.radius[:, None] ** 2 * np.sum(rod.rule.weights * g * density, axis=-1)
    return done, float(np.sum(rod.element.weights * rod.l0[:, None] * place.stretch * section))


def run(study: Study) -> None:
    """The fin, the limits, and the energy."""
    errors = []
    for elements in ELEMENTS:
        x, found = fin(elements)
        errors.append(np.abs(found - exact(x)).max() / np.ptp(exact(x)))
    order = np.polyfit(np.log(ELEMENTS), -np.log(errors), 1)[0]
    study.check("fin of 80 elements, maximum error over the range", errors[-1], 0.0, "closed form", 1e-3, "absolute")
    study.check("fin, order of the error in the element length", order, 2.0, "linear elements", 0.02, "absolute")

    warming, isothermal = material(study, True), material(study, False)
    springs = {
        "adiabatic": preset(warming),
        "isothermal": preset(isothermal),
        "in 1 µs": preset(warming, 1e-6, conductivity=50.0),
        "in 10⁷ s": preset(warming, 1e7, conductivity=50.0, convection=1000.0),
        "in 2 s": preset(warming, 2.0, elements=16, conductivity=50.0, convection=20.0, tips=1.0),
    }
    force = {name: one.result.greatest_force for name, one in springs.items()}
    study.check("maximum force, preset in 1 µs, N", force["in 1 µs"], force["adiabatic"], "adiabatic law", 1e-6)
    cost = force["isothermal"] - force["adiabatic"]
    study.check(
        "loss of force through heating that remains in 10⁷ s, N",
        force["isothermal"] - force["in 10⁷ s"],
        0.0,
        "isothermal law",
        0.2 * cost,
        "absolute",
    )
    slow = springs["in 2 s"]
    assert slow.heat is not None
    done, stays = work(slow)
    stored = (1.0 - DISSIPATED) * (done - stays)
    study.check(
        "stored energy and heat, N mm, preset in 2 s",
        stored + stays + slow.heat.generated,
        done,
        "work of the force",
        5e-3,
    )
    rise = slow.heat.equation.content - slow.heat.start_content
    study.check(
        "heat in the wire and given off, N mm", rise + slow.heat.given_off, slow.heat.generated, "heat generated", 5e-3
    )
    study.table(
        "Preset of one turn",
        ["", "maximum force, N", "free height, mm", "hottest wire, K"],
        [
            [name, force[name], one.result.steps[-1].seat_height_mm, one.result.steps[-1].temperature_K]
            for name, one in springs.items()
        ],
    )
    study.figure("heat_along_wire", figure(errors, slow))


def figure(errors: list[float], spring: Analysis) -> Figure:
    """Errors of the fin, and temperature along the wire of the spring."""
    with mpl.rc_context(STYLE):
        picture = Figure(figsize=(9.0, 3.8), layout="constrained")
        left, right = picture.subplots(1, 2)
        left.loglog(ELEMENTS, errors, "o-", label="coilset")
        left.loglog(ELEMENTS, errors[0] * (np.array(ELEMENTS) / ELEMENTS[0]) ** -2.0, "k--", lw=0.8, label="slope −2")
        left.set_xticks(ELEMENTS, [str(n) for n in ELEMENTS])
        left.xaxis.set_minor_locator(mpl.ticker.NullLocator())
        left.set(
            xlabel="elements",
            ylabel="error over the range of temperature",
            title="A fin: the error falls with the square\nof the element's length",
        )
        left.legend()
        temperature = spring.layout.gather(spring.rod.state["temperature"].equilibrium)
        right.plot(spring.setup.turns, temperature - 293.15, "o-")
        right.set(
            xlabel="turns from the bottom tip",
            ylabel="temperature above the air's in K",
            title=f"Preset in 2 × 2 s, the wire is up to\n{temperature.max() - 293.15:.2g} K warmer",
        )
    return picture
