"""The page docs/verification.md, made from the records of the cases."""

import json
from pathlib import Path
from typing import Any

from coilset.verification import registry

HEAD = """# Verification: what is compared, and with what deviation

`coilset verify` runs these cases, or those that are named; `--fast` those that take seconds, which are part of the
tests; `--list` names them. It ends with one table of every number: computed, reference, deviation, tolerance and
verdict. For a number that is shown but cannot be judged, and for a case that is not met, the reason is given. The
references are closed solutions, published tables, integrals, or integrations of other equations by other means
(`verification/references/`); each case's docstring states where they come from and what its tolerance is based on.

This page is written by `coilset verify --page docs/verification.md` from the records in `results/verify/`; a case
without a record there keeps its previous rows. Of the *n* numbers with one source, the one that uses most of its
tolerance is given.

| case | against | n | number nearest its limit | computed | reference | deviation | tolerance | verdict |
|---|---|---|---|---|---|---|---|---|
"""


def page(folder: str | Path, before: str = "") -> str:
    """The page in Markdown.

    Args:
        folder: with a record.json for each case, in a folder of its name.
        before: the page as it was: a case without a record keeps its rows, or is listed as not run if it has none.
    """
    lines, texts = [], []
    for name in registry.names():
        case, file = registry.load(name), Path(folder) / name / "record.json"
        speed = "" if case.fast else " *(slow)*"
        texts.append(f"- **{name}**{speed}: {case.title}" + (f". *Not met*: {case.unmet}" if case.unmet else ""))
        record = json.loads(file.read_text(encoding="utf-8")) if file.exists() else {"checks": []}
        checks, stopped = record["checks"], record.get("stopped", "")
        # a record from before there were verdicts counts as none
        if not stopped and (not checks or "verdict" not in checks[0]):
            kept = [line for line in before.splitlines() if line.startswith(f"| `{name}` |")]
            lines += kept or [_line(f"`{name}`", "", "", "", "", "", "", "", "not run")]
            continue
        groups: dict[tuple[str, bool], list[dict[str, Any]]] = {}
        for check in checks:
            groups.setdefault((check["source"], bool(check["reason"])), []).append(check)
        for (source, _), group in groups.items():
            worst = max(group, key=lambda check: (check["verdict"] == "not met", _used(check)))
            failed = sum(check["verdict"] == "not met" for check in group)
            verdict = f"{failed} of {len(group)} not met" if failed else worst["verdict"]
            lines.append(_line(f"`{name}`", source, str(len(group)), worst["quantity"], *_numbers(worst), verdict))
        if stopped:
            lines.append(_line(f"`{name}`", "", "", "", "", "", "", "", f"stopped: {stopped}"))
    return HEAD + "\n".join(lines) + "\n\n## The cases\n\n" + "\n".join(texts) + "\n"


def _line(*cells: str) -> str:
    """A row of the table."""
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def _used(check: dict[str, Any]) -> float:
    """The share of its tolerance that a number uses; for a number that is not judged, its deviation."""
    deviation = check["deviation"]
    if deviation is None:
        return float("inf")
    if check["kind"] == "at_most":
        return deviation
    return abs(deviation) / (check["tolerance"] or 1.0)


def _numbers(check: dict[str, Any]) -> tuple[str, str, str, str]:
    """Computed, reference, deviation and tolerance as text."""
    ours = "–" if check["ours"] is None else f"{check['ours']:.6g}"
    if check["kind"] == "at_most":
        return ours, f"≤ {check['reference'] + check['tolerance']:.6g}", "", ""
    number = percent if check["kind"] == "relative" else lambda value: f"{value:+.2g}"
    tolerance = "–" if check["tolerance"] is None else number(check["tolerance"]).lstrip("+")
    deviation = "–" if check["deviation"] is None else number(check["deviation"])
    return ours, f"{check['reference']:.6g}", deviation, tolerance


def percent(value: float) -> str:
    """A fraction in percent, signed."""
    return f"{100.0 * value:+.3g} %"
