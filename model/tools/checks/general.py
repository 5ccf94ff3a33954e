"""Checks of all kinds of springs: guides, fatigue, temperature, index, tolerances, limits of the case."""

from collections.abc import Iterator

import numpy as np

from coilset.model.core.material.law.law import CELSIUS
from coilset.model.core.results.loading import Loading
from coilset.model.core.results.records.units import words_and_unit
from coilset.model.tools.checks.check import Check
from coilset.model.tools.checks.permissible import COLD_INDEX, COMPUTED, GIVEN, HOT_INDEX, ONE, TWO
from coilset.model.tools.checks.subject import Subject
from coilset.model.tools.checks.turned import largest_turn
from coilset.model.tools.sheet.rows import SHORT
from coilset.model.tools.standards import en13906, en15800, goodman


def guides(one: Subject) -> Iterator[Check]:
    """Room between the coils and an arbor inside or a sleeve around them."""
    arbor, sleeve = one.case.contact.arbor, one.case.contact.sleeve
    spring, t = one.spring, one.spring.breaks
    mean, wire = 2.0 * spring.mean_radius(t), spring.wire_diameter(t)
    if arbor is not None:
        inner = float((mean - spring.width * wire).min())
        source = "inner diameter, no side force"
        if one.loading is Loading.TURNED and (turn := largest_turn(one)) is not None and one.made is not None:
            s = one.made.spring
            inner = en13906.turned_diameter(s.D, s.n, turn) - s.d
            source = "D n/(n + α/360°) − d, EN 13906-3"
        run = one.summary.get("inner_diameter_min_mm")
        remark = "the run pressed the coils onto it" if run is not None and run <= arbor else ""
        name = "inner diameter on the arbor"
        yield Check(name, inner, low=arbor, unit="mm", source=source, sure=COMPUTED, remark=remark)
    if sleeve is not None:
        outer = float((mean + spring.width * wire).max())
        if one.loading is Loading.COMPRESSED and one.made is not None and one.made.spring.wire is None:
            s = one.made.spring
            outer += en13906.outer_diameter_growth(s.d, s.D, s.pitch)
        source = "De + ΔDe to block, EN 13906-1"
        yield Check("outer diameter in the sleeve", outer, high=sleeve, unit="mm", source=source, sure=COMPUTED)


def fatigue(one: Subject) -> Iterator[Check]:
    """The run's safety by each criterion, or the wire's Goodman line, between the outermost working states."""
    found = one.summary.get("fatigue") or ()
    for entry in found:
        source = f"endured {entry['endured_MPa']:.4g} MPa, endurance of the case"
        yield Check(f"fatigue safety, {entry['criterion']}", entry["safety"], low=1.0, source=source, sure=GIVEN)
    if found or len(one.states) < 2 or one.loading is Loading.TURNED:
        return
    stresses = [one.coil.correction * one.coil.stress(state.force) for state in (one.states[0], one.states[-1])]
    cycle, name = goodman.Cycle(*stresses), "fatigue, τk2"
    remark = f"τk1 = {stresses[0]:.4g} MPa" + (", the coils alone" if one.loading is Loading.PULLED else "")
    surface = one.made.surface if one.made is not None else "as coiled"
    endurance = one.wire.endurance(surface) if one.wire is not None else None
    if endurance is None:
        wire = f"{one.case.material}" if one.wire is None else f"{one.wire.name}, {surface}"
        because = f"no fatigue line of {wire} was found; give endurance in the case"
        yield Check(name, cycle.upper, unit="MPa", because=because, remark=remark)
        return
    line = goodman.line(endurance, one.coil.d)
    source = f"Goodman, {line.times} times, {line.surface}, {line.tested}"
    because = one.warmth if one.is_warm else ""
    yield Check(
        name,
        cycle.upper,
        high=line.upper(cycle.lower),
        unit="MPa",
        source=source,
        sure=SHORT[endurance.sure],
        because=because,
        remark=remark,
    )


def temperature(one: Subject) -> Iterator[Check]:
    """The highest one, against that up to which the wire is used."""
    most, name = max(one.temperatures), "temperature"
    entry = one.wire.entry.highest_temperature if one.wire is not None else None
    if entry is None:
        if one.is_warm:
            what = "the material of the case" if one.wire is None else one.wire.name
            because = f"up to which temperature {what} is used was found in no source"
            yield Check(name, most - CELSIUS, unit="°C", because=because)
        return
    limit = entry.at(one.coil.d) - CELSIUS
    source = f"use of {one.wire.name}" if one.wire else ""
    yield Check(name, most - CELSIUS, high=limit, unit="°C", source=source, sure=SHORT[entry.sure])


def index(one: Subject) -> Check:
    """D/d, where it is nearest to a limit."""
    t = one.spring.breaks
    values = 2.0 * one.spring.mean_radius(t) / (one.spring.wire_diameter(t) * max(1.0, one.spring.width))
    low, high = HOT_INDEX if one.is_hot_coiled else COLD_INDEX
    nearest = float(values[int(np.argmin(np.minimum(values - low, high - values)))])
    part = {Loading.COMPRESSED: 1, Loading.PULLED: 2, Loading.TURNED: 3}[one.loading]
    source = f"{'hot' if one.is_hot_coiled else 'cold'} coiled, EN 13906-{part}"
    return Check("index D/d", nearest, low=low, high=high, source=source, sure=ONE if one.is_hot_coiled else TWO)


def tolerance(one: Subject) -> Iterator[Check]:
    """Whether EN 15800 has a tolerance of the spring; half the width of each limit against that of its best grade."""
    if one.loading is not Loading.COMPRESSED:
        norm = "DIN 2097" if one.loading is Loading.PULLED else "DIN 2194"
        because = f"EN 15800 is for compression springs, and no open source of {norm} was found; agree limits"
        yield Check("tolerance of the load", None, because=because)
        return
    made = one.made
    reason = one.no_formula if made is None else ""
    if made is not None:
        s = made.spring
        reason = "its wire is not round" if s.wire else en15800.outside(s.d, s.D, s.n, s.length) or ""
    if made is None or reason:
        because = f"EN 15800 does not cover it: {reason}; agree limits with the maker"
        yield Check("tolerance", None, because=because)
        return
    s, G = made.spring, made.elastic.shear_modulus
    force = abs(one.states[-1].force) if one.states else None
    given = list(one.summary.get("limits") or ())
    for entry in given:
        half, name = 0.5 * (entry["high"] - entry["low"]), entry["name"]
        if name == "free_length_after_mm":
            best, unit = en15800.tolerances(1, G, s.d, s.D, s.n, s.length).free_length, "mm"
        elif name.startswith("force_at_"):
            middle = 0.5 * (entry["high"] + entry["low"])
            best, unit = en15800.force_tolerance(1, s.d, s.D, s.n, middle), "N"
        else:
            continue
        words, _ = words_and_unit(name)
        yield Check(f"± of the {words}", half, low=best, unit=unit, source="EN 15800 grade 1", sure=TWO)
    if not given:
        spread = force is not None and en15800.force_tolerance(made.grade, s.d, s.D, s.n, force)
        free = en15800.tolerances(made.grade, G, s.d, s.D, s.n, s.length).free_length
        remark = f"L0 ± {free:.3g} mm" + (f", {force:.4g} ± {spread:.3g} N" if spread else "")
        low, high = en15800.INDICES
        source = f"EN 15800 has tolerances, grade {made.grade}"
        yield Check("tolerance, by D/d", s.index, low=low, high=high, source=source, sure=TWO, remark=remark)


def limits(one: Subject) -> Iterator[Check]:
    """Those that the case gives of its results."""
    for entry in one.summary.get("limits") or ():
        words, unit = words_and_unit(entry["name"])
        because = "the run has no such result" if entry["value"] is None else ""
        yield Check(words, entry["value"], entry["low"], entry["high"], unit, entry["source"], "", because)
