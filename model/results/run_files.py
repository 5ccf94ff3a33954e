"""All files of a run, without pictures."""

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from coilset.model.results.files.folder import DERIVED, clear, write_history, write_seats, write_summary
from coilset.model.results.records.record import Result, Setup
from coilset.model.results.records.summary import summarise

if TYPE_CHECKING:  # loading what reads takes longer than a short run
    from coilset.model.results.files.opened import Run


def write_run(out: Path, setup: Setup, result: Result, summary: dict[str, Any], made_with: dict[str, Any]) -> None:
    """Write the results of a run, without pictures, into its folder."""
    from coilset.model.results.files import dataset
    from coilset.model.results.files.fields import write_fields

    clear(out, DERIVED)  # a continued run still has the pictures and the page of before
    write_history(out, result.steps)
    write_seats(out, result.seats)
    points = dataset.point_state(setup, result)
    dataset.write_points(out, dataset.with_origin(points, setup, result, made_with))
    write_fields(out, setup, result.snapshots)
    write_summary(out, {**summary, "origin": made_with})


def run_of(setup: Setup, result: Result, made_with: dict[str, Any]) -> "Run":
    """Records as the Run that figures take, by way of a temporary folder."""
    from coilset.model.results.files.opened import open_run

    with TemporaryDirectory() as folder:
        write_run(Path(folder), setup, result, summarise(setup, result), made_with)
        return open_run(folder)
