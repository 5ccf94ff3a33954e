"""All cases of a sweep as one Parquet file, for pandas, polars and DuckDB, written as a stream.

It loads neither xarray nor matplotlib, which would take a third of the memory of a million cases.
"""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from coilset.model.core.base.version import versions
from coilset.model.core.results.files.folder import whole
from coilset.model.core.results.records.summary_entries import NUMBERS
from coilset.model.core.results.records.units import words_and_unit
from coilset.model.physics.working.working import names_of
from coilset.model.tools.sweep.journal import Records
from coilset.model.tools.sweep.keys import as_rod
from coilset.model.tools.sweep.plan import Plan

if TYPE_CHECKING:
    import pyarrow as pa

ROWS, BATCHES = 1_000, 5  # rows as Python objects at a time, and such batches in a row group: what memory holds


def write(path: str | Path, plan: Plan, records: Records) -> int | None:
    """Write one row for each record: case, model, inputs, key, status, reason, warnings, seconds, responses.

    Args:
        path: the file.
        plan: of the sweep.
        records: of its tasks, which are read one after the other. Rows are in their order, not in that of the plan:
            `case` is the number of the case there, from 0.

    Returns:
        The number of rows; None if pyarrow is not installed, and nothing is written.
    """
    try:
        import pyarrow as pa
        import pyarrow.parquet as pq
    except ImportError:
        return None
    schema, count = _schema(pa, plan), 0
    words = [field.name for field in schema if field.type == pa.string()]  # a dictionary of numbers takes 1 MB a column
    with whole(path) as partial, pq.ParquetWriter(partial, schema, compression="zstd", use_dictionary=words) as writer:
        group: list[pa.RecordBatch] = []
        for rows in _batches(plan, records):
            count += len(rows)
            group.append(pa.RecordBatch.from_pylist(rows, schema=schema))
            if len(group) == BATCHES:
                writer.write_table(pa.Table.from_batches(group))
                group.clear()
        writer.write_table(pa.Table.from_batches(group, schema))
    pa.default_memory_pool().release_unused()
    return count


def _batches(plan: Plan, records: Records) -> Iterator[list[dict[str, Any]]]:
    keys = plan.keys.array
    order = np.argsort(keys)
    rows: list[dict[str, Any]] = []
    numeric = _numeric(plan)
    for record in records:
        rod = corrects(plan, record)
        key = (record["key"] + "u" if rod else record["key"]).encode()
        first, last = (np.searchsorted(keys, key, side, sorter=order) for side in ("left", "right"))
        common = {
            "model": "rod" if rod else plan.spec.model,
            "key": record["key"],
            "status": record["status"],
            "reason": record["reason"],
            "warnings": words_of_warnings(record),
            "seconds": record["seconds"],
        }
        common |= {name.removeprefix("rod_"): value for name, value in responses_of(plan, record).items()}
        for case in order[first:last]:
            inputs = {
                name: value if number else str(value)
                for name, value, number in zip(plan.names, plan.rows[case], numeric, strict=True)
            }
            rows.append({"case": int(case)} | inputs | common)
        if len(rows) >= ROWS:
            yield rows
            rows = []
    yield rows


def _numeric(plan: Plan) -> list[bool]:
    """Which inputs are numbers in all cases."""
    return [plan.rows.is_numeric(k) for k in range(len(plan.names))]


def _schema(pa: Any, plan: Plan) -> "pa.Schema":
    """Columns with their units, and what the sweep was."""
    fields = [pa.field("case", pa.int64()), pa.field("model", pa.string())]
    for name, number in zip(plan.names, _numeric(plan), strict=True):
        fields.append(pa.field(name, pa.float64() if number else pa.string()))
    fields += [pa.field(name, pa.string()) for name in ("key", "status", "reason", "warnings")]
    fields.append(pa.field("seconds", pa.float64(), metadata={"units": "s"}))
    for name in (*NUMBERS, *names_of(plan.base.get("working") or {})):
        column = f"{name}_found" if name in plan.names else name
        words, unit = words_and_unit(name)
        fields.append(pa.field(column, pa.float64(), metadata={"units": unit, "long_name": words}))
    attributes = {"title": f"sweep {plan.path.stem}", "versions": versions(), "design": plan.spec.design}
    attributes |= {"inputs": json.dumps(plan.names), "cases": str(len(plan))}
    return pa.schema(fields, metadata=attributes)


def responses_of(plan: Plan, record: dict[str, Any]) -> dict[str, float]:
    """Numbers of the summary of a case that is done, by their names in the data set."""
    if record["status"] != "done":
        return {}
    prefix = "rod_" if corrects(plan, record) else ""
    return {
        f"{prefix}{name}" if prefix or name not in plan.names else f"{name}_found": np.nan if value is None else value
        for name, value in record["summary"].items()
        if value is None or (isinstance(value, (int, float)) and not isinstance(value, bool))
    }


def corrects(plan: Plan, record: dict[str, Any]) -> bool:
    """Whether it is a rod's record of a sweep of uniform rods."""
    return plan.spec.model == "uniform_rod" and as_rod(record["key"]) == record["key"]


def words_of_warnings(record: dict[str, Any]) -> str:
    """Names of a case's warnings."""
    return ", ".join(warning["name"] for warning in record["summary"].get("warnings", ()))
