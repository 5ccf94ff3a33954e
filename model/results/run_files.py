"""All files of a run, without pictures."""

from pathlib import Path
from typing import Any

from coilset.model.results.files.folder import DERIVED, clear, write_history, write_seats, write_summary
from coilset.model.results.records.record import Result, Setup


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
