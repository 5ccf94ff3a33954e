"""Results folders that are nearly right: one file of a run's folder spoilt, in its text, its bytes or its arrays."""

import json
import shutil
from pathlib import Path

import h5py
import numpy as np
from fuzz_files import shipped, spoilt_entries, spoilt_text
from fuzz_tables import spoilt_cells
from hypothesis import strategies as st

CASE = """
spring: {wire_diameter: 5.0, mean_diameter: 40.0, turns: 2.5, pitch: 12.0}
mesh: {elements_per_turn: 8, section: {rule: abramowitz9}}
accuracy: 0.1
working: {lengths: [30, 25]}
limits: {set: [0, 20]}
loading: [{to: block, steps: 3}, {to: {force: 0}, steps: 2}]
"""
NUMBERS = [np.nan, np.inf, 0.0, -1.0, 1e300]


@st.composite
def spoil_bytes(draw, path: Path) -> None:
    """Cut a file off, or change some of its bytes."""
    content = bytearray(path.read_bytes())
    if draw(st.booleans()):
        del content[draw(st.integers(0, len(content))) :]
    for _change in range(draw(st.integers(0, 8)) if content else 0):
        content[draw(st.integers(0, len(content) - 1))] = draw(st.integers(0, 255))
    path.write_bytes(bytes(content))


@st.composite
def spoilt_array(draw, array: np.ndarray) -> np.ndarray:
    """An array of another shape or kind, or with numbers that it cannot have."""
    change = draw(st.sampled_from(["shape", "flat", "words", "whole", "number"]))
    if change == "number" and array.dtype.kind == "f" and array.size:
        array.flat[draw(st.integers(0, array.size - 1))] = draw(st.sampled_from(NUMBERS))
        return array
    if change == "whole" and array.dtype.kind == "f":
        return np.full_like(array, draw(st.sampled_from(NUMBERS)))
    if change == "words":
        return np.full(array.shape, b"x", "S1")
    return array.reshape(-1) if change == "flat" or not array.ndim else array[: len(array) // 2]


@st.composite
def spoil_points(draw, path: Path) -> None:
    """Take a variable of points.nc away, give it another name, or other numbers."""
    with h5py.File(path, "a") as file:
        name = draw(st.sampled_from(sorted(file)))
        change = draw(st.sampled_from(["remove", "rename", "array", "array", "attribute"]))
        if change == "rename":
            file.move(name, draw(st.sampled_from(["x", f"{name}s"])))
        elif change == "attribute":
            for one in list(file[name].attrs):
                if one in ("units", "coordinates", "_FillValue"):
                    del file[name].attrs[one]
        else:
            values, about = file[name][...], dict(file[name].attrs)
            del file[name]
            if change == "array":
                made = file.create_dataset(name, data=draw(spoilt_array(values)))
                for one, value in about.items():
                    if one not in ("CLASS", "NAME", "DIMENSION_LIST", "REFERENCE_LIST"):
                        made.attrs[one] = value


@st.composite
def spoil_archive(draw, path: Path) -> None:
    """Take an array of a checkpoint away, or give it other numbers."""
    with np.load(path) as file:
        arrays = {name: file[name] for name in file.files}
    name = draw(st.sampled_from(sorted(arrays)))
    if draw(st.booleans()):
        del arrays[name]
    else:
        arrays[name] = draw(spoilt_array(arrays[name].copy()))
    np.savez(path, **arrays)


@st.composite
def spoilt_folder(draw, results: Path, folder: Path) -> Path:
    """A copy of a results folder with one of its files spoilt."""
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(results, folder)
    files = [path for path in sorted(folder.rglob("*")) if path.suffix in (".json", ".csv", ".nc", ".npz", ".jsonl")]
    path = draw(st.sampled_from(files))
    way = draw(st.sampled_from(["entries", "entries", "text", "bytes", "remove"]))
    if way == "remove":
        path.unlink()
    elif way == "bytes":
        draw(spoil_bytes(path))
    elif path.suffix in (".nc", ".npz"):
        draw(spoil_points(path) if path.suffix == ".nc" else spoil_archive(path))
    elif way == "entries" and path.suffix == ".json":
        path.write_text(json.dumps(draw(spoilt_entries(json.loads(path.read_text())))))
    else:
        text = shipped.__wrapped__(path)
        changed = draw(spoilt_cells(text) if way == "entries" and path.suffix == ".csv" else spoilt_text(text))
        path.write_text(changed, encoding="utf-8", errors="replace")
    return folder
