"""`coilset slice`: a cylindrical spring as a 3D body, from a single section of its wire."""

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from mpi4py import MPI

from coilset.meshes.sections.shapes import parse
from coilset.meshes.springs.spring import SpringSpec
from coilset.model.core.base.errors import InputError, SolveError
from coilset.model.core.case import Case, read_case
from coilset.model.core.results.files.folder import clear, prepare, write_history, write_summary
from coilset.model.core.results.quantities import quantities
from coilset.model.core.results.records.provenance import origin
from coilset.model.physics.slice.analysis import ACROSS, SliceAnalysis, SliceStep
from coilset.model.tools.limits.case_warnings import case_warnings
from coilset.model.tools.studies.slice_summary import summarise
from coilset.scripts.terminal.console import Console
from coilset.scripts.terminal.progress import HEAD, step_row
from coilset.scripts.terminal.target import results_folder

NOTE = (
    "a slice has no ends: seats, coils that close one after another and bending of the axis are not included, so near "
    "block its force differs from that of solve (docs/slice.md)"
)


def slice_case(
    case_file: str | Path,
    out: str | Path | None = None,
    force: bool = False,
    settings: Sequence[str] = (),
    section: str | None = None,
    across: float | None = None,
    pictures: bool = True,
) -> None:
    """Run the slice of a case; see `coilset slice --help`.

    Raises:
        InputError, SolveError: the latter after the results so far are written.
    """
    if MPI.COMM_WORLD.rank:
        return  # a section is too small to be distributed
    console = Console()
    case = read_case(case_file, settings)
    folder = results_folder(out, f"{Path(case_file).stem}-slice")
    try:
        outline = parse(section) if section else None
        analysis = SliceAnalysis(case, outline, ACROSS if across is None else across)
    except InputError as error:
        raise _placed(error, case, case_file) from None
    prepare(folder, force)
    for warning in case_warnings(case, analysis.spring, analysis.law):
        console.warn(warning.message)
    targets = ", ".join(phase.label for phase in case.loading)
    console.say(f"{Path(case_file).name}: slice with {analysis.body.u.size + 2} unknowns, to {targets}")
    console.print(f"{HEAD}  contacts")
    failure = None
    try:
        analysis.run(lambda step: console.print(step_row(step) + ("  coils" if step.contacts else "")))
    except SolveError as error:
        failure = error
    summary = summarise(analysis)
    _write(folder, analysis, summary, pictures)
    _conclude(console, summary, folder)
    if failure is not None:
        raise failure


def _placed(error: InputError, case: Case, case_file: str | Path) -> InputError:
    """The error with the option, or the entry of the case file, that caused it."""
    group, _, entry = error.place.partition(".")
    if error.file:
        return error
    if group == "section":
        return InputError(error.problem, "--across" if entry == "across" else f"--section: {entry}")
    if group == "--section":
        return error
    given = case.spring.diameter_entry if isinstance(case.spring, SpringSpec) else "mean_diameter"
    return InputError(error.problem, error.place.replace("mean_diameter", given), case_file)


def _write(out: Path, analysis: SliceAnalysis, summary: dict[str, Any], pictures: bool) -> None:
    from coilset.model.tools.studies import slice_output as output

    clear(out)
    write_history(out, analysis.result.steps, SliceStep)
    output.write_fields(out, analysis)
    write_summary(out, {**summary, "origin": origin(analysis.case)})  # before the picture, which takes longest
    if pictures:
        output.figure(out / "section.png", analysis)


def _conclude(console: Console, summary: dict[str, Any], out: Path) -> None:
    console.quantities(quantities(summary))
    console.say(NOTE)
    console.say(f"  results in {out}{os.sep}", whole=True)
    for warning in summary["warnings"]:
        console.warn(warning["message"])
