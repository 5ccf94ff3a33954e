"""Where compiled functions are kept between runs."""

import hashlib
import os
import sys
from pathlib import Path

SOURCES = Path(__file__).resolve().parent


def keep_by_content() -> None:
    """Give each version of the compiled functions a folder of its own in numba's cache.

    Numba compiles a function anew when its own file changes, but not when one that it calls does, and would go on with
    what it compiled against the old one.
    """
    content = hashlib.sha256()
    for path in sorted(SOURCES.rglob("*.py")):
        text = path.read_bytes()
        if b"njit" in text:
            content.update(text)
    root = os.environ.get("NUMBA_CACHE_DIR") or Path.home() / ".cache" / "coilset" / "numba"
    version = content.hexdigest()[:16]
    if Path(root).name != version:  # a process started by this one has it already
        os.environ["NUMBA_CACHE_DIR"] = str(Path(root) / version)
    if "numba" in sys.modules:  # it has read its environment
        sys.modules["numba"].config.CACHE_DIR = os.environ["NUMBA_CACHE_DIR"]
