"""Shipped springs over the number of section points: force at block and set against a rule of 12 × 36 points

In torsion the edge of the elastic core lies between two rings; in the bending of coils that touch, between two angles.
These kinks cause the error of a rule. Rings rotated relative to each other by half a step have twice as many angles
together. Every shipped spring is compressed to block and released with the default rule, with 4 × 12 points and with
the finest rule, some also with the thesis's section (`plane`). The section is also examined alone: a bar of Ck 15 and
of an ideally plastic law, bent about all axes to 2, 5 and 20 times its curvature at yield (see bending-directions for
the same in rods).

Tolerance: 0.2 % in force and set for the default rule, and in the moment.
"""

import time

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from mpi4py import MPI

from coilset.model.compose.analysis import Analysis
from coilset.model.compose.examples import EXAMPLES
from coilset.model.compose.summary import summarise
from coilset.model.core.base.style import STYLE
from coilset.model.core.case import read_case
from coilset.model.core.case.case import ANGLES, SectionSpec
from coilset.model.core.material import library
from coilset.model.core.material.law.law import Law
from coilset.model.core.material.point import points
from coilset.model.core.section.rules import DiskRule, polar
from coilset.verification.study import Study

FAST = False
Rule = tuple[int, int, bool]  # rings, angles, staggered
SPEC = SectionSpec()
DEFAULT: Rule = (SPEC.radial, ANGLES, SPEC.staggered)
RULES: tuple[Rule, ...] = ((4, 12, False), DEFAULT)
PLANE = ("closed_and_ground", "cone", "cylinder")  # springs that are also compressed with the thesis's section
LIMIT: Rule = (12, 36, True)
TOLERANCE = 2e-3
STEPS = 12  # each way, equal ones, so that all rules take the same path
FACTORS = (2.0, 5.0, 20.0)  # curvature over that at yield
AXES = np.radians(np.arange(0.0, 180.0, 3.0))
BENDING_STEPS = 40  # from one curvature to the next


def press(file: str, kind: str, rule: Rule) -> tuple[float, float, int, float, bool]:
    """Maximum force, N, set, mm, states evaluated, seconds of the processor, and whether coils slipped past others."""
    names = ("radial", "angular", "staggered")
    settings = [f"mesh.section.{name}={value}".lower() for name, value in zip(names, rule, strict=True)]
    settings += [f"mesh.section.kind={kind}", *(f"loading.{k}.steps={STEPS}" for k in (0, 1))]
    analysis = Analysis(read_case(EXAMPLES / file, settings), MPI.COMM_SELF)
    begin = time.process_time()
    found = summarise(analysis.setup, analysis.run())
    slipped = any(warning["name"] == "coils slipped" for warning in found["warnings"])
    return found["force_max_N"], found["set_mm"], found["evaluations"], time.process_time() - begin, slipped


def label(rule: Rule) -> str:
    """As in `8 × 20, turned`."""
    return f"{rule[0]} × {rule[1]}{', turned' if rule[2] else ''}"


def moments(law: Law, rule: DiskRule, axes: np.ndarray) -> np.ndarray:
    """Bending moment over π r³ at FACTORS times the curvature at yield about axes, shape (factors, axes), MPa."""
    places = np.outer(np.sin(axes), rule.points[:, 0]) + np.outer(np.cos(axes), rule.points[:, 1])
    state, found, before = points.initial_state(law, places.size), [], 0.0
    for factor in FACTORS:
        strain = np.zeros((places.size, 3))
        strain[:, 0] = places.ravel() * (factor - before) * law.yield_stress / law.E / BENDING_STEPS
        for _ in range(BENDING_STEPS):
            state = points.update(law, state, strain)[0]
        found.append((state[:, 0].reshape(places.shape) * places) @ rule.weights)
        before = factor
    return np.array(found)


def run(study: Study) -> None:
    """All springs, both kinds; and the bar."""
    files = [f"springs/{path.name}" for path in sorted((EXAMPLES / "springs").glob("*.yaml"))]
    errors: dict[Rule, list[np.ndarray]] = {rule: [] for rule in RULES}
    rows = []
    for file in files:
        for kind, rules in (("curved", RULES), ("plane", (DEFAULT,))):
            if kind == "plane" and file[8:-5] not in PLANE:
                continue
            limit = press(file, kind, LIMIT)
            for rule in rules:
                found = press(file, kind, rule)
                off = np.array(found[:2]) / limit[:2] - 1.0
                rows.append([file[8:-5], kind, label(rule), *found[:2], *(100.0 * off), *found[2:4], *limit[2:4]])
                if kind == "curved":
                    errors[rule].append(off)
                if rule == DEFAULT:
                    for k, name in enumerate(("force at block, N", "set, mm")):
                        numbers = f"{file[8:-5]}, {kind}, {name}", found[k], limit[k], f"{label(LIMIT)} points"
                        if limit[-1]:
                            study.shown(*numbers, "coils slip past each other, sooner or later by the least difference")
                        else:
                            study.check(*numbers, TOLERANCE)
    columns = [
        "spring",
        "kind",
        "rule",
        "force, N",
        "set, mm",
        "force off, %",
        "set off, %",
        "states",
        "s",
        "states of the limit",
        "s of the limit",
    ]
    study.table("to block and back", columns, rows)
    bent = bend(study)
    draw(study, [file[8:-5] for file in files], errors, bent)


def bend(study: Study) -> dict[tuple[str, Rule], np.ndarray]:
    """Maximum error of the moment over all axes, by law and rule, shape (factors,)."""
    found = {}
    for name in ("ck15", "ideal_plastic"):
        law = library.load(name)
        exact = moments(law, polar(48, 192, True), AXES[:1])
        for rule in RULES:
            found[name, rule] = np.abs(moments(law, polar(*rule), AXES) / exact - 1.0).max(axis=1)
        for factor, worst in zip(FACTORS, found[name, DEFAULT], strict=True):
            study.check(
                f"maximum error of the moment, {name}, {factor:g} κy",
                worst,
                0.0,
                "48 × 192 points",
                TOLERANCE,
                "absolute",
            )
    rows = [[name, label(rule), *(100.0 * worst)] for (name, rule), worst in found.items()]
    columns = ["law", "rule", *(f"{factor:g} κy" for factor in FACTORS)]
    study.table("maximum error of the bending moment over all axes, %", columns, rows)
    return found


def draw(
    study: Study, names: list[str], errors: dict[Rule, list[np.ndarray]], bent: dict[tuple[str, Rule], np.ndarray]
) -> None:
    """Errors of force and set over the springs, and of the moment over the curvature."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(10.0, 3.8), layout="constrained")
        axes = figure.subplots(1, 3, width_ratios=[3, 3, 2])
        for k, what in enumerate(("force at block", "set")):
            for rule, found in errors.items():
                axes[k].plot(100.0 * np.array(found)[:, k], names, "o", ms=4, label=label(rule))
            axes[k].axvspan(-100.0 * TOLERANCE, 100.0 * TOLERANCE, color="0.93")
            axes[k].set(xlabel="deviation from the finest rule in %", title=what)
        axes[1].set_yticks([])
        for (law, rule), worst in bent.items():
            style = "-" if law == "ck15" else ":"
            axes[2].plot(FACTORS, 100.0 * worst, style, color=f"C{RULES.index(rule)}", marker="o", ms=3, lw=1)
        axes[2].axhline(100.0 * TOLERANCE, color="0.6", lw=0.8)
        axes[2].set(xscale="log", yscale="log", xlabel="κ over κ at yield", ylabel="maximum error in %")
        axes[2].set_xticks(FACTORS, [f"{factor:g}" for factor in FACTORS])
        axes[2].set_yticks([0.1, 0.2, 0.5, 1.0, 2.0], ["0.1", "0.2", "0.5", "1", "2"])
        axes[2].minorticks_off()
        axes[2].set_title("bar bent about all axes\n(dotted: ideally plastic)")
        axes[0].legend(fontsize=7)
    study.figure("section_rule", figure)
