"""Content of the data sheet of a spring: its head, drawing, tables, diagrams and remarks."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from coilset.meshes.springs.geometry import Spring
from coilset.model.core.case import Case
from coilset.model.core.results.loading import Loading, loading_of
from coilset.model.core.results.quantities import greatest_force, quantity
from coilset.model.core.results.records.labels import lives_text
from coilset.model.core.results.records.record import Limit
from coilset.model.core.results.records.units import words_and_unit
from coilset.model.physics.working.working import number_name
from coilset.model.tools.checks.check import Check, Verdict, sentence
from coilset.model.tools.document.diagrams import diagrams
from coilset.model.tools.document.entries import SheetSpec
from coilset.model.tools.document.view import Drawing, Level, view
from coilset.model.tools.document.words import Words
from coilset.model.tools.figures.panels.panel import Panel
from coilset.model.tools.limits.limits import case_limits
from coilset.model.tools.sheet.rows import Row, sections
from coilset.model.tools.sheet.sheet import Sheet
from coilset.model.tools.standards import en15800

MOST_LEVELS = 6  # lengths on the drawing; the table has all
DRAWN = {"free_length_after_mm": "free length L0", "rate_30_70_after_N_per_mm": "rate R"}
FINISHED = ("set_mm", "residual_shear_inside_MPa")
TURNED = ("turn_set_deg", "residual_bending_inside_MPa", "torque_max_Nmm")
TAILS = ("hooks", "arms")
ALL = ("all", "all others")  # rows of what a table has not


@dataclass(frozen=True)
class Line:
    """A line of a table: what it is, by the formula, by the run, and its unit."""

    label: str
    value: str
    found: str = ""
    unit: str = ""


@dataclass(frozen=True)
class Document:
    """The content of a sheet, in one language.

    Attributes:
        title: of the kind of spring.
        head: names and values of its head.
        basis: where the numbers are from.
        checks: what is permitted, cells of each check and where its limit is from; verdict: what they say together.
        drawing: side view with dimensions.
        body: the spring, as it is drawn.
        tables: headings with their lines.
        has_run: whether the tables have a column of a run.
        panels: diagrams.
        remarks: what must be said beside.
        words: of the language.
    """

    title: str
    head: list[tuple[str, str]]
    basis: str
    checks: list[tuple[tuple[str, ...], str]]
    verdict: str
    drawing: Drawing
    body: Spring
    tables: list[tuple[str, list[Line]]]
    has_run: bool
    panels: list[Panel]
    remarks: list[str]
    words: Words


def document(
    case: Case,
    spring: Spring,
    sheet: Sheet,
    checks: Sequence[Check],
    run: str,
    remarks: Sequence[str],
    words: Words,
) -> Document:
    """The document of a sheet.

    Args:
        case, spring: of the sheet.
        sheet: its numbers, with those of a run if there is one.
        checks: what is permitted of the spring.
        run: name of the run; empty without one.
        remarks: warnings.
        words: of the language.
    """
    limits = {limit.name: limit for limit in case_limits(case, spring, sheet.elastic.shear_modulus)}
    head = [(words(name), value) for name, value in (case.sheet or SheetSpec()).model_dump().items()]
    norms = "EN 13906-2" if sheet.pulled else "EN 13906-3" if sheet.turned else "EN 13906-1, EN 15800"
    shown = _shown(sheet, spring)
    without = f"Calculated by the formulas of {norms}, before a run"
    basis = f"Results of the run {run}, beside the formulas of {norms}" if run else without
    kind = "Extension spring" if sheet.pulled else "Torsion spring" if sheet.turned else "Compression spring"
    parts = sections(sheet)
    missing = [
        f"{title if row.label.strip() in ALL else row.label.strip()}: {row.why}"
        for title, rows in parts
        for row in rows
        if _empty(row) and row.why
    ]
    tables = [(words("Design"), [*_design(sheet, spring, words), *_tails(case, words)])]
    tables += [(words(title), [_line(row, words) for row in rows if not _empty(row)]) for title, rows in parts]
    summary = sheet.found.summary if sheet.found else {}
    tables += [
        (words("Finished spring"), list(_finished(summary, words))),
        (words("Limits"), list(_limit_lines(limits.values(), summary, words))),
        (words("Fatigue of the run"), list(_fatigue(summary, words))),
    ]
    return Document(
        words(kind),
        head,
        words(basis),
        [_checked(one, words) for one in checks],
        words(sentence(checks)),
        _view(sheet, shown, limits, words),
        shown,
        [(title, lines) for title, lines in tables if lines],
        bool(run),
        [_translated(panel, words) for panel in diagrams(sheet, limits)],
        [*_not_known(checks), *missing, *remarks],
        words,
    )


def _checked(one: Check, words: Words) -> tuple[tuple[str, ...], str]:
    """Cells of a check, and where its limit is from."""
    name, verdict, *numbers = one.cells
    return (words(name), words(verdict), *(words.comma(number) for number in numbers)), one.basis


def _not_known(checks: Sequence[Check]) -> Iterator[str]:
    """Why checks say nothing, and what would make them."""
    for one in checks:
        if one.verdict is Verdict.NOT_KNOWN:
            yield f"{one.name} is not known, because {one.because}"


def _empty(row: Row) -> bool:
    return row.value is None and row.found is None


def _line(row: Row, words: Words) -> Line:
    return Line(words(row.label), words.number(row.value), words.number(row.found), row.unit)


def _design(sheet: Sheet, spring: Spring, words: Words) -> Iterator[Line]:
    s, width = sheet.spring, spring.width * sheet.spring.d
    if sheet.wire:
        yield Line(words("wire"), sheet.wire.name)
    yield Line(words("coiling direction"), words("right" if spring.hand > 0 else "left"))
    if not (sheet.pulled or sheet.turned):
        yield Line(words("ends"), words(s.ends))
    yield Line(words("total turns nt"), words.number(s.turns))
    yield Line(words("outer diameter De"), words.number(s.D + width), unit="mm")
    yield Line(words("inner diameter Di"), words.number(s.D - width), unit="mm")


def _tails(case: Case, words: Words) -> Iterator[Line]:
    """The hooks of an extension spring, the arms of a torsion spring."""
    hooks, arms = (getattr(case.spring, name, None) for name in TAILS)
    for end in ("bottom", "top"):
        if hook := getattr(hooks, end, None):
            yield Line(words(f"{end} hook"), words(hook.shape))
        if arm := getattr(arms, end, None):
            yield Line(words(f"{end} arm"), words(arm.direction))
            yield Line(words("  straight part"), words.number(arm.length), unit="mm")
            for bend in arm.bends:
                yield Line(words(f"  bent {bend.towards} by"), words.number(bend.angle), unit="°")
                yield Line(words("  straight behind the bend"), words.number(bend.length), unit="mm")


def _limit_lines(limits: Any, summary: Mapping[str, Any], words: Words) -> Iterator[Line]:
    for limit in limits:
        name, unit = words_and_unit(limit.name)
        result = summary.get(limit.name)
        mark = "" if result is None else " ✓" if limit.margin(result) >= 0.0 else " ✗"
        value = words.number(result)
        between = f"{words.number(limit.low)} … {words.number(limit.high)}"
        yield Line(words(DRAWN.get(limit.name, name)), between, value, unit + mark)


def _finished(summary: Mapping[str, Any], words: Words) -> Iterator[Line]:
    """What only a run has: the set, residual stress, and the true stress at the working lengths with its safety."""
    number = words.number
    for name in TURNED if loading_of(summary) is Loading.TURNED else (*FINISHED, greatest_force(summary)):
        one = quantity(summary, name)
        if one.value is not None:
            yield Line(words(one.words), "", words.comma(one.number), one.unit)
    for state in summary.get("working") or ():
        if "length_wanted" in state and not state["reason"]:
            place = f"{state['length_wanted']:g} mm"
            for name, label, unit in (
                ("shear_surface_MPa", "greatest shear stress at", "MPa"),
                ("safety", "safety against the allowable at", ""),
            ):
                if state.get(name) is not None:
                    yield Line(words(f"{label} {place}"), "", number(state[name]), unit)


def _fatigue(summary: Mapping[str, Any], words: Words) -> Iterator[Line]:
    for entry in summary.get("fatigue") or ():
        yield Line(words(f"safety, {entry['criterion']}"), "", words.number(entry["safety"], 3))
        if entry.get("lives"):
            lives = lives_text(entry["lives"], "").replace(", ", "; ")
            yield Line(words("  cycles that 10, 50, 90 % do not survive"), "", words.comma(lives))


def _free_length(sheet: Sheet) -> float:
    """After the run, or as drawn; mm. Coils that are not pulled are drawn no longer than they were wound."""
    after = sheet.at_run("free_length_after_mm") or sheet.spring.length
    return after if sheet.pulled else min(after, sheet.spring.length)


def _shown(sheet: Sheet, spring: Spring) -> Spring:
    """The finished spring of a run, or the drawn one."""
    s, free = sheet.spring, _free_length(sheet)
    return spring.at_height(free) if s.solid < free < s.length and not sheet.pulled else spring


def _view(sheet: Sheet, spring: Spring, limits: Mapping[str, Limit], words: Words) -> Drawing:
    """The spring with its dimensions and their tolerances."""
    s, width = sheet.spring, spring.width * sheet.spring.d
    free = _free_length(sheet)
    compressed = not (sheet.pulled or sheet.turned)  # EN 15800 is for compression springs
    covered = compressed and s.wire is None and en15800.outside(s.d, s.D, s.n, s.length) is None
    shear = sheet.elastic.shear_modulus
    given = en15800.tolerances(sheet.grade, shear, s.d, s.D, s.n, s.length) if covered else None
    number = words.number

    def about(value: float, name: str, spread: float | None) -> str:
        limit = limits.get(name)
        if limit is not None:
            return f"{number(value)} ({number(limit.low)} … {number(limit.high)})"
        return number(value) if spread is None else f"{number(value)} ± {number(spread, 2)}"

    free_text = about(free, "free_length_after_mm", given.free_length if given else None)
    levels, loads = [Level(sheet.spring.length if sheet.pulled else free, f"L0 = {free_text}", spring.levels[0])], []
    for k, length in enumerate(sorted(sheet.lengths, reverse=not sheet.pulled)[: MOST_LEVELS - 1], 1):
        force = sheet.stated_force(length)
        spread = en15800.force_tolerance(sheet.grade, s.d, s.D, s.n, force) if covered else None
        text = about(abs(force) if sheet.pulled else force, number_name("force", length), spread)
        loads.append(Level(length, f"L{k} = {number(length)}   F{k} = {text} N"))
    if sheet.pulled:  # beyond the drawing
        levels.append(Level(spring.body_length, f"LK = {number(spring.body_length)}"))
    if compressed:
        levels += loads
        levels.append(Level(sheet.smallest, f"Ln = {number(sheet.smallest)}"))
        levels.append(Level(sheet.shortest, f"Lc = {number(sheet.shortest)}"))
    mean = about(s.D, "", given.coil_diameter if given else None)
    widths = [
        (s.D - width, f"Di = {number(s.D - width)}"),
        (s.D, f"D = {mean}"),
        (s.D + width, f"De = {number(s.D + width)}"),
    ]
    tolerance = sheet.tolerance_of_wire
    wire = number(s.d) if s.wire is None else f"{number(s.wire.width)} × {number(s.d)}"
    notes = [words("coiled right-hand" if spring.hand > 0 else "coiled left-hand")]
    notes += [load.text for load in loads] if sheet.pulled else []
    if given:
        notes.append(f"e1 ≤ {number(given.lean, 3)}")
        notes += [f"e2 ≤ {number(given.parallelism, 3)}"] if s.ends == "closed and ground" else []
    return view(
        spring, levels, widths, f"d = {wire}" + (f" ± {number(tolerance, 2)}" if tolerance else ""), notes, number
    )


def _translated(panel: Panel, words: Words) -> Panel:
    """A panel with its title, legend and axes in another language."""
    traces = [trace | ({"name": words(trace["name"])} if "name" in trace else {}) for trace in panel.traces]
    axes = {name: entry | {"title": {"text": words(entry["title"]["text"])}} for name, entry in panel.layout.items()}
    return replace(panel, title=words(panel.title), traces=traces, layout=axes)
