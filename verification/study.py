"""The output of a verification case: judged numbers, tables, notes and figures."""

import json
import math
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, SupportsFloat

import numpy as np
from matplotlib.figure import Figure

from coilset.model.core.results.files.folder import make, whole
from coilset.model.tools.figures.png import add_title, save

KINDS = ("relative", "absolute", "at_most")


@dataclass(frozen=True)
class Check:
    """One number against its reference.

    Attributes:
        quantity: what it is, with its unit.
        ours, reference: the numbers.
        source: where the reference comes from.
        tolerance: maximum deviation.
        kind: `relative`: |ours/reference − 1|; `absolute`: |ours − reference|; `at_most`: ours − reference.
        reason: why the number is shown but not judged; empty if it is judged.
    """

    quantity: str
    ours: float
    reference: float
    source: str
    tolerance: float
    kind: str = "relative"
    reason: str = ""

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise ValueError(f"kind '{self.kind}' is none of {', '.join(KINDS)}")
        if self.kind == "relative" and self.reference == 0.0:
            raise ValueError(f"{self.quantity}: there is no relative deviation from 0; use 'absolute'")

    @property
    def deviation(self) -> float:
        """According to the kind; signed, except for its use in `passed`."""
        difference = self.ours - self.reference
        return difference / abs(self.reference) if self.kind == "relative" else difference

    @property
    def passed(self) -> bool:
        """Within the tolerance; never for NaN. Says nothing of a number that is not judged."""
        deviation = self.deviation if self.kind == "at_most" else abs(self.deviation)
        return bool(deviation <= self.tolerance)

    @property
    def judged(self) -> bool:
        """Does the verdict depend on it?"""
        return not self.reason

    @property
    def used(self) -> float:
        """Share of the tolerance that the deviation uses; 0 where only a bound is required."""
        return 0.0 if self.kind == "at_most" or not self.tolerance else abs(self.deviation) / self.tolerance

    @property
    def told(self) -> str:
        """The deviation in words."""
        size, limit = (_plainly(value, self.kind) for value in (self.deviation, self.tolerance))
        return f"{self.quantity}, off by {size} ({limit} allowed; reference: {self.source})"

    @property
    def verdict(self) -> str:
        """`met`, `not met`, or `not judged` with the reason."""
        if not self.judged:
            return f"not judged: {self.reason}"
        return "met" if self.passed else "not met"


class Study:
    """Collects what a case finds; numbers may be NumPy's.

    Args:
        folder: where figures and record.json go; created if missing.

    Attributes:
        stopped: what ended the case before its end; empty if it came there.
    """

    def __init__(self, folder: str | Path) -> None:
        self.folder = Path(folder)
        make(self.folder)
        self.stopped = ""
        self.checks: list[Check] = []
        self.tables: list[dict[str, Any]] = []
        self.notes: list[str] = []
        self.figures: list[str] = []
        self._drawn: dict[str, Figure] = {}

    def check(
        self,
        quantity: str,
        ours: SupportsFloat,
        reference: SupportsFloat,
        source: str,
        tolerance: float = 0.0,
        kind: str = "relative",
    ) -> None:
        """Judge a number; see Check."""
        self.checks.append(Check(quantity, float(ours), float(reference), source, float(tolerance), kind))

    def shown(self, quantity: str, ours: SupportsFloat, reference: SupportsFloat, source: str, reason: str) -> None:
        """Keep a number and its reference without judging it, with the reason; see Check."""
        kind = "relative" if reference else "absolute"
        self.checks.append(Check(quantity, float(ours), float(reference), source, float("nan"), kind, reason))

    def table(self, title: str, columns: Iterable[str], rows: Iterable[Iterable[object]]) -> None:
        """Keep a table for information; its rows hold numbers and texts, None for an empty cell."""
        self.tables.append(
            {"title": title, "columns": list(columns), "rows": [[plain(value) for value in row] for row in rows]}
        )

    def note(self, text: str) -> None:
        """Keep a sentence for the reader."""
        self.notes.append(text)

    def figure(self, name: str, figure: Figure) -> None:
        """A matplotlib Figure, which `write` writes as NAME.png with the finding over it."""
        self._drawn[f"{name}.png"] = figure
        self.figures.append(f"{name}.png")

    @property
    def finding(self) -> str:
        """What the numbers say, in a sentence: the one that is nearest its limit, or how many are beyond."""
        judged = [check for check in self.checks if check.judged]
        off = sum(not check.passed for check in judged)
        if off or not judged:
            return f"{off} of {len(judged)} numbers are beyond their tolerance" if judged else ""
        near = max(judged, key=lambda check: check.used)
        count = "The number is" if len(judged) == 1 else f"All {len(judged)} numbers are"
        return f"{count} within tolerance" + (f"; nearest its limit is {near.told}" if near.used else "")

    @property
    def passed(self) -> bool:
        """The case came to its end, and all of its judged numbers, one at least, are within their tolerances."""
        judged = [check for check in self.checks if check.judged]
        return not self.stopped and bool(judged) and all(check.passed for check in judged)

    def write(self, name: str) -> None:
        """The figures, and record.json."""
        for file, figure in self._drawn.items():
            add_title(figure, self.finding)
            save(figure, self.folder / file)
        checks = [asdict(check) | {"deviation": check.deviation, "verdict": check.verdict} for check in self.checks]
        record = {
            "case": name,
            "passed": self.passed,
            "stopped": self.stopped,
            "checks": checks,
            "tables": self.tables,
            "notes": self.notes,
            "figures": self.figures,
        }
        with whole(self.folder / "record.json") as path:
            path.write_text(json.dumps(json_ready(record), indent=1, ensure_ascii=False) + "\n", encoding="utf-8")


def _plainly(value: float, kind: str) -> str:
    return (f"{100.0 * value:.2g} %" if kind == "relative" else f"{value:.2g}").replace("-", "−")


def plain(value: object) -> object:
    """A Python number or text for NumPy's."""
    return value.item() if isinstance(value, np.generic) else value


def json_ready(value: object) -> object:
    """The same with None for numbers that JSON does not know."""
    if isinstance(value, dict):
        return {key: json_ready(entry) for key, entry in value.items()}
    if isinstance(value, list):
        return [json_ready(entry) for entry in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
