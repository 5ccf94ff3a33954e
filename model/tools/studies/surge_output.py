"""A driven spring as files: a table over time, its main numbers, and a figure."""

from dataclasses import asdict
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from coilset.model.core.base.style import STYLE
from coilset.model.core.results.files.folder import subfolder, write_summary, write_table
from coilset.model.physics.vibration.driven import Driven
from coilset.model.tools.figures.png import save

UNITS = {"time": "s", "height": "mm", "top": "N", "bottom": "N", "contacts": ""}
WORK = ("kinetic", "stored", "supplied", "lost")  # N mm
TURNS = 12  # lines of the wire, at most


def summarise(driven: Driven) -> dict[str, Any]:
    """Main numbers, with units in their names."""
    fine, slow = driven.fine, driven.slow
    ends = {"driven": (fine.top, slow.top), "fixed": (fine.bottom, slow.bottom)}
    forces = {
        f"{name}_force_{which}{kind}_N": float(getattr(values, which)())
        for name, pair in ends.items()
        for kind, values in zip(("", "_slowly"), pair, strict=True)
        for which in ("max", "min")
    }
    return {
        **forces,
        "force_error_N": driven.error,
        "first_axial_mode_Hz": driven.axial,
        "time_step_s": driven.step,
        "contacts_at_rest": int(fine.contacts[0]),
        "contacts_max": int(fine.contacts.max()),
        "supplied_max_Nmm": float(fine.supplied.max()),
        "kinetic_max_Nmm": float(fine.kinetic.max()),
        "lost_in_steps_Nmm": float(fine.lost[-1]),
    }


def write_surge(folder: Path, driven: Driven, turns: np.ndarray) -> None:
    """Write surge.csv, a row for each step, with the height of the wire after each turn, and summary.json.

    Args:
        folder: made if needed.
        turns: of the stations, shape (n,).
    """
    subfolder(folder.parent, folder.name)
    columns = asdict(driven.fine)
    whole = _whole_turns(turns)
    names = [f"{name}_{unit}".rstrip("_") for name, unit in UNITS.items()] + [f"{name}_Nmm" for name in WORK]
    rows = zip(*(columns[name].tolist() for name in (*UNITS, *WORK)), columns["level"][:, whole].tolist(), strict=True)
    names += [f"turn_{turns[k] - turns[0]:.3g}_mm" for k in whole]
    write_table(folder / "surge.csv", names, ((*row[:-1], *row[-1]) for row in rows))
    write_summary(folder, summarise(driven))


def _whole_turns(turns: np.ndarray) -> list[int]:
    """Stations nearest to whole turns, less of them on a spring of many, without the ends."""
    along = turns - turns[0]
    each = max(int(np.ceil(along[-1] / TURNS)), 1)
    return [int(np.abs(along - turn).argmin()) for turn in range(each, int(np.ceil(along[-1] - 1e-9)), each)]


def draw_surge(path: Path, driven: Driven, turns: np.ndarray, title: str, source: str) -> None:
    """Draw forces, heights of the coils and energies over time.

    Args:
        path: PNG.
        turns: of the stations, shape (n,).
        title, source: lines above and below.
    """
    fine, slow = driven.fine, driven.slow
    ms = 1e3 * fine.time
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(12.0, 3.9), layout="constrained")
        forces, heights, work = figure.subplots(1, 3)
        forces.plot(1e3 * slow.time, slow.top, "k:", lw=1.0, label="pressed slowly")
        forces.plot(ms, fine.top, "C0-", lw=1.2, label="driven end")
        forces.plot(ms, fine.bottom, "C1-", lw=1.2, label="fixed end")
        forces.set(ylabel="force, N", title="Forces of the ends")
        heights.plot(ms, fine.height, "k-", lw=1.0, label="driven end")
        for number, station in enumerate(_whole_turns(turns)):
            label = "the wire after each turn" if number == 0 else None
            heights.plot(ms, fine.level[:, station], "C0-", lw=0.8, label=label)
        heights.set(ylabel="height, mm", title="The wave in the coils", ylim=(0.0, 1.3 * fine.height.max()))
        for name, colour in (("supplied", "k"), ("stored", "C0"), ("kinetic", "C1"), ("lost", "C2")):
            work.plot(ms, 1e-3 * getattr(fine, name), colour, lw=1.0, label=_WORDS[name])
        work.set(ylabel="energy, J", title="Energy")
        for axes in (forces, heights, work):
            axes.set(xlabel="time, ms", xlim=(0.0, ms[-1]))
            axes.grid()
            axes.legend(loc="upper right")
        low, high = forces.get_ylim()
        forces.set_ylim(low, high + 0.25 * (high - low))
        figure.suptitle(title, fontsize=9)
        figure.supxlabel(source, fontsize=6, color="0.5", x=0.99, ha="right")
    save(figure, path)


_WORDS = {
    "supplied": "supplied by the head",
    "stored": "in wire and contacts",
    "kinetic": "of motion",
    "lost": "lost in steps of time",
}
