"""The demos as pages: scripts in jupytext's percent format, their text as text and their code as code."""

import re
from pathlib import Path

from entry_pages import replace

DEMOS = Path(__file__).resolve().parents[2] / "examples" / "demos"
HEAD = """# Demos

Scripts that teach: each is short, runs as it stands (`scripts/coilset python examples/demos/NAME.py`), ends in an
asserted number and a figure, and is part of the test suite. Jupytext opens them as notebooks.

```{toctree}
:maxdepth: 1

"""


def write(folder: Path) -> None:
    """Write a page for each demo, and one that lists them."""
    folder.mkdir(parents=True, exist_ok=True)
    paths = sorted(DEMOS.glob("*.py"))
    for path in paths:
        picture = f"\n![the figure at the end](../../pictures/demos/{path.stem}.png)\n"
        replace(folder / f"{path.stem}.md", as_markdown(path.read_text(encoding="utf-8")) + picture)
    replace(folder / "index.md", HEAD + "".join(f"{path.stem}\n" for path in paths) + "```\n")


def as_markdown(script: str) -> str:
    """Cells of a script: comments of markdown cells as they are, all else in blocks of code."""
    parts = []
    for kind, body in re.findall(r"^# %%( \[markdown\])?\n(.*?)(?=^# %%|\Z)", script, re.MULTILINE | re.DOTALL):
        if kind:
            parts.append("\n".join(line.removeprefix("#").removeprefix(" ") for line in body.strip().splitlines()))
        else:
            parts.append(f"```python\n{body.strip()}\n```")
    return "\n\n".join(parts) + "\n"
