"""Provenance of a run: the whole case, the content of the files that it names, the program and the machine."""

import hashlib
import platform
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from coilset.model.core.base.content import described
from coilset.model.core.base.errors import InputError
from coilset.model.core.base.version import __version__, versions
from coilset.model.core.case import Case
from coilset.model.core.case.material import case_law

DIGEST_BYTES = 16


def contents(case: Case) -> dict[str, str]:
    """Digests of the files that the case refers to, by entry: constants of the material, file of the spring.

    Raises:
        InputError: if a file cannot be read or is wrong.
    """
    law = case_law(case, case.spring.build())
    found = {"material": _digest(law.content())}
    file = getattr(case.spring, "file", None)
    if file is not None:
        try:
            found["spring.file"] = _digest(Path(file).read_bytes())
        except OSError as error:
            raise InputError(f"cannot be read: {error.strerror}", "spring.file", file) from None
    return found


def provenance(case: Case) -> dict[str, object]:
    """Version, the program's content and contents, for a checkpoint; raises as `contents`."""
    return {"version": __version__, "program": described(), "contents": contents(case)}


def origin(case: Case) -> dict[str, Any]:
    """Everything needed to run a case again and to recognise it, so that results are self-contained.

    Returns:
        Plain data: the `case` with all its defaults, the constants of its `material`, digests of the `contents` that it
        names, `program` (digest of its content, and the commit in a checkout), `versions`, `date` (UTC) and `platform`.
    """
    law = case_law(case, case.spring.build())
    return {
        "case": case.model_dump(mode="json"),
        "material": law.data.model_dump(mode="json"),
        "contents": contents(case),
        "program": described(),
        "versions": versions(),
        "date": datetime.now(UTC).isoformat(timespec="seconds"),
        "platform": platform.platform(),
    }


def changed(then: object, now: dict[str, object]) -> str | None:
    """The first entry whose content has changed, `version` for another program, or None; see `provenance`."""
    then = then if isinstance(then, dict) else {}
    if then.get("version") != now["version"]:
        return "version"
    before, contents_now = then.get("contents"), now["contents"]
    if not isinstance(before, dict) or not isinstance(contents_now, dict):
        return "version"
    return next((entry for entry in {**before, **contents_now} if before.get(entry) != contents_now.get(entry)), None)


def _digest(content: bytes) -> str:
    return hashlib.blake2b(content, digest_size=DIGEST_BYTES).hexdigest()
