"""Rows of a spring's sheet: quantities by formula, how each was checked, the result of a run, and why they differ."""

from collections.abc import Iterator
from dataclasses import dataclass
from math import degrees, isfinite, sqrt

from coilset.model.tools.sheet.sheet import AT_BLOCK, Sheet
from coilset.model.tools.standards import en13906, en15800
from coilset.model.tools.standards.rate import pitch_compliance
from coilset.model.tools.wires.law import poisson_ratio

DERIVED, TWO, ONE, GIVEN = "derived", "two sources", "one source", "given"
SHORT = {"checked against a second source": TWO, "one source": ONE, "estimate": "estimate"}
FINISHED = "rate_30_70_after_N_per_mm"  # of the summary


@dataclass(frozen=True)
class Row:
    """A line of the sheet.

    Attributes:
        label, unit: of the quantity.
        value: by the formula; None if there is none, for the reason in `why`.
        formula: in the symbols of the standard.
        sure: how the formula or number was checked.
        found: value from the run.
        why: why the two differ, or why there is no value.
    """

    label: str
    value: float | None
    unit: str = ""
    formula: str = ""
    sure: str = ""
    found: float | None = None
    why: str = ""


def sections(sheet: Sheet) -> list[tuple[str, list[Row]]]:
    """All rows under their headings; headings without rows are omitted."""
    dimensions = ("Dimensions", list(_dimensions(sheet)))
    if sheet.pulled:
        endurance = list(_endurance(sheet))
        pulled = [dimensions, ("Extension spring, EN 13906-2", list(_pulled(sheet)))]
        return [*pulled, ("Endurance", endurance)] if endurance else pulled
    if sheet.turned:
        return [dimensions, ("Torsion spring, EN 13906-3", list(_turned(sheet)))]
    parts = {
        "Dimensions": _dimensions,
        "Rate, block and buckling": _spring,
        "Stresses at block": _stresses,
        "Working lengths": _working,
        "Frequency and energy": _dynamics,
        "Endurance": _endurance,
        f"Tolerances, EN 15800 grade {sheet.grade}": _tolerances,
    }
    return [(title, rows) for title, part in parts.items() if (rows := list(part(sheet)))]


def _dimensions(sheet: Sheet) -> Iterator[Row]:
    s, ρ = sheet.spring, sheet.elastic.density
    after, set_mm = sheet.at_run("free_length_after_mm"), sheet.at_run("set_mm")
    nominal = en13906.wire_length(s.D, s.turns)
    helix = sheet.helix if sheet.found else None
    mass = None if helix is None else 1e3 * en13906.mass(ρ, s.of_mass, helix)
    if s.wire is None:
        yield Row("wire diameter d", s.d, "mm", "", GIVEN)
    else:
        yield Row("wire height d", s.d, "mm", "along the spring", GIVEN)
        yield Row("wire width", s.wire.width, "mm", "", GIVEN)
        yield Row("torsion constant J", s.wire.torsion, "mm⁴", "Saint-Venant, computed", DERIVED)
        yield Row("section modulus W", s.wire.modulus, "mm³", "T/τ of straight wire, computed", DERIVED)
    yield Row("mean diameter D", s.D, "mm", "", GIVEN)
    yield Row("spring index w", s.index, "", "D/d", DERIVED)
    yield Row("active turns n", s.n, "", f"of {s.turns:g}, ends {s.ends}", GIVEN)
    note = "" if set_mm is None else f"set {round(set_mm, 6) + 0.0:.4g} mm"  # no -0 of a spring that stays elastic
    yield Row("free length L0", s.length, "mm", "", GIVEN, after, note)
    tails = f"with the {'hooks' if sheet.pulled else 'arms'}; " if sheet.beyond else ""
    yield Row("wire length l", nominal, "mm", "π D n_t", DERIVED, helix, f"{tails}the helix is longer by 1/cos α")
    formula = "ρ A l" if s.wire else "ρ π d² l/4"
    yield Row("mass m", 1e3 * en13906.mass(ρ, s.of_mass, nominal), "g", formula, DERIVED, mass, "as the wire length")
    if sheet.pulled or sheet.turned or s.wire:  # the formula of the growth is for round wire
        return
    growth = en13906.outer_diameter_growth(s.d, s.D, s.pitch)
    grown = sheet.found.growth if sheet.found and sheet.was_at_block else None
    yield Row(
        "growth of D to block",
        growth,
        "mm",
        "(m² − 0.8 m d − 0.2 d²)/(π² D)",
        DERIVED,
        grown,
        f"mean of the body; the formula is for ends that turn{', these are held' * sheet.held}",
    )


def _found_rate(sheet: Sheet) -> tuple[float | None, str]:
    """The rate of a run, N/mm, and which it is: of the finished spring where the run gives it."""
    finished = sheet.at_run(FINISHED)
    return (
        (sheet.at_run("rate_N_per_mm"), "at first touch") if finished is None else (finished, "of the finished spring")
    )


def _rate(sheet: Sheet) -> Row:
    """The rate, beside that of the finished spring where a run gives it."""
    found, which = _found_rate(sheet)
    why = f"{which}, where end turns carry load too; with curvature and direct shear"
    if sheet.at_run(FINISHED) is not None:
        why = f"{which}, between 30 and 70 % of its travel"
    wire = sheet.spring.wire
    formula = f"4 G J c/(π D³ n), c = {wire.curved:.4f} of the curved wire" if wire else "G d⁴/(8 D³ n)"
    return Row("rate R", sheet.rate, "N/mm", formula, DERIVED, found, why)


def _pulled(sheet: Sheet) -> Iterator[Row]:
    """Of a spring that the load program pulls, EN 13906-2: its body is that of a compression spring."""
    s, k = sheet.spring, en13906.stress_correction(sheet.spring.index)
    opened = sheet.at_run("open_rate_N_per_mm")
    if opened is None:
        yield _rate(sheet)
    else:
        of_body = None if sheet.beyond else opened
        yield Row("rate R", sheet.rate, "N/mm", "G d⁴/(8 D³ n)", DERIVED, of_body, "once the coils are open")
    if sheet.beyond:
        why = "with the wire's pitch and curvature"
        yield Row("  with hooks", sheet.pull_rate, "N/mm", "1/(1/R + ∫ m²/(E I, G J) ds)", DERIVED, opened, why)
    if sheet.tension:
        first, after = sheet.at_run("initial_tension_N"), sheet.at_run("initial_tension_after_N")
        errors = [sheet.at_run(f"estimated_initial_tension{when}_error_N") for when in ("", "_after")]
        before, left = ("" if error is None else f"± {error:.2g} N" for error in errors)
        why = before if after is None else f"{left} after the last release; {first:.4g} N {before} before".strip()
        yield Row("initial tension F0", sheet.tension, "N", "", GIVEN, first if after is None else after, why)
        τ0 = en13906.stress(sheet.tension, s.d, s.D)
        yield Row("  stress τ0", τ0, "MPa", "8 D F0/(π d³)", DERIVED)
    if s.wire:
        yield Row("all others", None, why="EN 13906-2 is for round wire")
        return
    for length in sorted(sheet.lengths):
        force = -sheet.force(length)
        finished = sheet.found.finished_force_at(length) if sheet.found else None
        # the formula is of the spring as wound, which is that of its first pull
        pull = sheet.found.first_force_at(length) if sheet.found and finished is None else finished
        found, why = None if pull is None else abs(pull), "first pull" if finished is None else "of the finished spring"
        τ = en13906.stress(force, s.d, s.D)
        yield Row(f"force at {length:.5g} mm", force, "N", sheet.force_formula, DERIVED, found, why)
        yield Row("  stress τ", τ, "MPa", "8 D F/(π d³)", DERIVED)
        yield Row("  corrected stress τk", k * τ, "MPa", "k τ", TWO)
        if sheet.hook_stress:
            formula = "q 32 F a/(π d³) + 4 N/(π d²), the greatest"
            yield Row("  bending stress of hooks", sheet.hook_stress * force, "MPa", formula, DERIVED)
    yield from _strength(sheet)


def _strength(sheet: Sheet) -> Iterator[Row]:
    """Rm, where it is known."""
    if sheet.wire:
        sure = SHORT[sheet.wire.entry.strength.sure]
        yield Row("minimum tensile strength Rm", sheet.least_strength, "MPa", sheet.wire.name, sure)
    elif sheet.strength is not None:
        yield Row("tensile strength Rm", sheet.strength, "MPa", "of the material file", GIVEN)


def _turned(sheet: Sheet) -> Iterator[Row]:
    """Of a spring that the load program turns, EN 13906-3."""
    if sheet.spring.wire:
        yield Row("all", None, why="EN 13906-3 is for round wire")
        return
    s, run = sheet.spring, sheet.at_run
    rate, q = en13906.turn_rate(sheet.elastic.young_modulus, s.d, s.D, s.n), en13906.bending_correction(s.index)
    why = "with the wire's pitch and curvature"
    turned = run("turn_rate_Nmm_per_deg")
    yield Row("rate R", rate, "N mm/°", "E d⁴/(3667 D n)", DERIVED, None if sheet.beyond else turned, why)
    rate = sheet.turn_rate
    if sheet.on_point:
        why = "without an arbor, which would take a part of the side force"
        yield Row("  with an arm on a point", rate, "N mm/°", "1/∫ m²/(E I, G J) ds, m = F a", DERIVED, turned, why)
        yield Row("  lever of its force F", sheet.on_point.lever, "mm", "h, about the axis", DERIVED)
    elif sheet.beyond:
        yield Row("  with clamped arms", rate, "N mm/°", "1/(1/R + ∫ ds/(E I, G J))", DERIVED, turned, why)
    yield Row("stress factor q", q, "", "(4 w² − w − 1)/(4 w (w − 1))", DERIVED)
    most = max(sheet.turns_to, key=abs, default=0.0)
    for turn in sheet.turns_to:
        torque, largest = rate * abs(turn), turn == most
        σ, flow = sheet.bending_stress(turn), "when last passed: less where the wire yielded, more on an arbor"
        found = sheet.found.torque_at(turn * (1.0 if most > 0.0 else -1.0)) if sheet.found else None
        yield Row(f"torque at {turn:.4g}°", torque, "N mm", "R α", DERIVED, None if found is None else abs(found), flow)
        formula = "32 M/(π d³)"
        if sheet.on_point:
            yield Row("  force on the arm F", torque / sheet.on_point.lever, "N", "M/h", DERIVED)
            formula = "32 F a/(π d³), where the coil is farthest from F"
        yield Row("  bending stress σ", σ, "MPa", formula, DERIVED)
        found = run("max_bending_inside_MPa") if largest else None
        found = None if found is None else abs(found)
        yield Row("  at the inside σq", q * σ, "MPa", "q σ", DERIVED, found, "largest at the inside")
        inner = en13906.turned_diameter(s.D, s.n, turn) - s.d
        found = run("inner_diameter_min_mm") if largest and turn > 0.0 else None
        yield Row("  inner diameter", inner, "mm", "D n/(n + α/360°) − d", DERIVED, found, "also off the axis")
    yield from _strength(sheet)


def _spring(sheet: Sheet) -> Iterator[Row]:
    s, e = sheet.spring, sheet.elastic
    rate, solid = sheet.rate, s.solid
    yield _rate(sheet)
    held, nu = "(½ − ν)" if sheet.held else "(1 − ν)/(2 (1 + ν))", poisson_ratio(e)
    if s.wire:
        held = "(3/2 − E I/(G J))" if sheet.held else "(G J/(E I) − ½)"
        nu = e.young_modulus * s.wire.in_plane / (e.shear_modulus * s.wire.torsion) - 1.0
    softer = pitch_compliance(s.pitch_angle, nu, "held" if sheet.held else "turning")
    formula = f"R/(1 + tan²α {held} + …), α = {degrees(s.pitch_angle):.1f}°"
    yield Row("R of a rising wire", rate / softer, "N/mm", formula, DERIVED)
    hot = en13906.is_hot_coiled(s.d)
    cold_formulas = {"closed and ground": "n_t d_max", "closed": "(n_t + 1.5) d_max"}
    formula = "(n_t − 0.3) d_max, hot coiled" if hot else cold_formulas.get(s.ends, "")
    why = "" if sheet.block is not None else f"no formula was found for {s.ends} ends{' of hot coiled springs' * hot}"
    yield Row("block length Lc", sheet.block, "mm", formula if sheet.block else "", ONE if hot else TWO, why=why)
    yield Row("block of the geometry", solid, "mm", "where the coils touch; Lc is an upper bound", DERIVED)
    force = None
    if sheet.was_at_block:
        closing = sheet.at_run("closing_force_N")
        force = sheet.at_run("force_max_N") if closing is None else closing
    yield Row(
        "force at block Fc",
        sheet.force(solid),
        "N",
        f"{sheet.force_formula}, L = {solid:.4g} mm",
        DERIVED,
        force,
        _why_block(sheet),
    )
    travel = s.buckling_travel(e.shear_modulus / e.young_modulus, sheet.seating)
    formula = f"Haringx, ν = {sheet.seating:g}; to block {s.length - solid:.4g} mm"
    never = "never buckles by the formula"
    why = "with its pitch, end turns and coils that touch, which the formula neglects" if isfinite(travel) else never
    yield Row(
        "travel to buckling",
        travel if isfinite(travel) else None,
        "mm",
        formula,
        DERIVED,
        sheet.at_run("buckling_travel_mm"),
        why,
    )


def _why_block(sheet: Sheet) -> str:
    if not sheet.was_at_block or not sheet.yield_stress:
        return ""
    first = sheet.yield_stress / sqrt(3)
    if sheet.stress(sheet.spring.solid) <= first:
        return "coils that close before block raise it"
    return f"plastic flow lowers it, τc is above the first yield of {first:.4g} MPa; coils that close raise it"


def _stresses(sheet: Sheet) -> Iterator[Row]:
    s, wire = sheet.spring, sheet.wire
    k, τ = s.correction, sheet.stress(s.solid)
    true = sheet.at_run("shear_max_MPa") if sheet.was_at_block else None
    formula = "D Fc/(2 W)" if s.wire else "8 D Fc/(π d³)"
    # none of the run beside it: of its force at block coils that lie on each other carry a part past the wire
    yield Row("stress τc", τ, "MPa", formula, DERIVED)
    formula = "of the elastic section in the coil, computed" if s.wire else "(w + 0.5)/(w − 0.75)"
    yield Row("stress correction k", k, "", formula, DERIVED if s.wire else TWO)
    why = "maximum true shear stress on the surface of the middle turns"
    yield Row("corrected stress τkc", k * τ, "MPa", "k τc", TWO, true, why)
    if wire is None:
        if sheet.strength is not None:
            yield Row("tensile strength Rm", sheet.strength, "MPa", "of the material file", GIVEN)
        return
    strength, share = wire.entry.strength, wire.entry.block_stress
    yield Row("minimum tensile strength Rm", wire.strength(s.d), "MPa", wire.name, SHORT[strength.sure])
    yield Row(
        "allowed at block", wire.block_stress(s.d), "MPa", f"{share.at(s.d):g} Rm, of the {share.of}", SHORT[share.sure]
    )


def _working(sheet: Sheet) -> Iterator[Row]:
    s, k = sheet.spring, sheet.spring.correction
    hot = en13906.is_hot_coiled(s.d)
    formula = "0.02 n (D + d), hot coiled" if hot else f"{'1.5 ' * sheet.dynamic}n (0.0015 D²/d + 0.1 d)"
    yield Row("minimum sum of gaps Sa", sheet.gaps, "mm", formula, ONE if hot else TWO)
    formula = "Lc + Sa" if sheet.block is not None else f"{s.solid:.4g} mm + Sa"
    yield Row("smallest length Ln", sheet.smallest, "mm", formula, ONE if hot else TWO)
    for length in sorted(sheet.lengths, reverse=True):
        τ, force = sheet.stress(length), sheet.found.force_at(length) if sheet.found else None
        real = None if force is None else en13906.stress(force, s.of_stress, s.D)
        yield Row(
            f"force at {length:.5g} mm",
            sheet.force(length),
            "N",
            sheet.force_formula,
            DERIVED,
            force,
            _why_force(sheet, length),
        )
        formula = "D F/(2 W)" if s.wire else "8 D F/(π d³)"
        yield Row("  stress τ", τ, "MPa", formula, DERIVED, real, "nominal, of the force found")
        yield Row("  corrected stress τk", k * τ, "MPa", "k τ", TWO, None if real is None else k * real, "the same")
        yield Row("  sum of gaps", length - sheet.shortest, "mm", f"L − {sheet.shortest:.4g} mm", DERIVED)


def _why_force(sheet: Sheet, length: float) -> str:
    after = sheet.at_run("free_length_after_mm")
    if after is None:
        return ""
    if after <= length:
        return f"before the spring has set; set to {after:.4g} mm it does not reach this length"
    return f"after setting R (L0 − L) is {sheet.rate * (after - length):.4g} N"


def _dynamics(sheet: Sheet) -> Iterator[Row]:
    s, e = sheet.spring, sheet.elastic
    # f ∝ √(R/m), by torsional stiffness and area
    d = s.of_rate**2 / s.of_mass if s.wire else s.d
    f = en13906.natural_frequency(e.shear_modulus, e.density, d, s.D, s.n)
    yield Row(
        "natural frequency",
        f,
        "Hz",
        "½ √(R/m) of the active turns, ends held" if s.wire else "d/(2π n D²) √(G/(2ρ)), ends held",
        DERIVED,
        _frequency(sheet),
        f"½ √(R/m) with the rate R found {_found_rate(sheet)[1]} and the helix's mass",
    )
    work = sheet.found.work_to(s.solid + AT_BLOCK * s.d) if sheet.found and sheet.was_at_block else None
    yield Row(
        "work to block",
        1e-3 * en13906.energy(sheet.rate, s.length - s.solid),
        "J",
        "R s²/2",
        DERIVED,
        None if work is None else 1e-3 * work,
        "∫ F ds of the first compression, plastic work in it",
    )


def _frequency(sheet: Sheet) -> float | None:
    """Of a half wave along the active turns, Hz, with the rate of the run; None without one."""
    s, (rate, _) = sheet.spring, _found_rate(sheet)
    active = en13906.mass(sheet.elastic.density, s.of_mass, sheet.helix * s.n / s.turns)
    return None if rate is None else 0.5 * sqrt(1e3 * rate / active)  # 1 N/mm = 10³ kg/s²


def _endurance(sheet: Sheet) -> Iterator[Row]:
    cycle, endured = sheet.cycle, sheet.endured
    if cycle is None:
        return
    yield Row("lower stress τk1", cycle.lower, "MPa", "k τ", TWO)
    yield Row("range τkh", cycle.upper - cycle.lower, "MPa", "τk2 − τk1", TWO)
    if endured is None:
        why = f"no fatigue data for {sheet.wire.name}, {sheet.surface}" if sheet.wire else "give --wire"
        yield Row("permissible stress range", None, "MPa", why=why)
        return
    residual = sheet.residual
    shifted = None if residual is None else endured.stress_range(cycle.shifted(residual).lower)
    counted = {
        "preset": "the line is of preset springs, so it may count twice",
        "not preset": "the line is of springs that were not preset, so it counts once",
        "not stated": "whether the line is of preset springs is not stated, so it may count twice",
    }
    why = "" if residual is None else f"with the residual {residual:.1f} MPa; {counted[endured.springs]}"
    formula = f"Goodman, {endured.times} times, {endured.surface}, {endured.tested}"
    formula += ", compression springs; without the hooks" if sheet.pulled else ""
    yield Row("permissible stress range", endured.stress_range(cycle.lower), "MPa", formula, ONE, shifted, why)


def _tolerances(sheet: Sheet) -> Iterator[Row]:
    s, grade = sheet.spring, sheet.grade
    reason = en15800.outside(s.d, s.D, s.n, s.length) if s.wire is None else "its wire is not round"
    if reason:
        yield Row("all", None, why=f"EN 15800 does not cover it: {reason}")
        return
    found = en15800.tolerances(grade, sheet.elastic.shear_modulus, s.d, s.D, s.n, s.length)
    yield Row("mean diameter ±", found.coil_diameter, "mm", "table", TWO)
    yield Row("free length ±", found.free_length, "mm", "a_F k_f Q/R", TWO)
    for length in sorted(sheet.lengths, reverse=True):
        spread = en15800.force_tolerance(grade, s.d, s.D, s.n, sheet.stated_force(length))
        yield Row(f"force at {length:.5g} mm ±", spread, "N", "(a_F k_f + 0.015 F) Q", TWO)
    yield Row("lean e1", found.lean, "mm", f"{en15800.LEAN[grade]:g} L0", ONE)
    if s.ends == "closed and ground":
        yield Row("parallelism e2", found.parallelism, "mm", f"{en15800.PARALLELISM[grade]:g} De", ONE)
