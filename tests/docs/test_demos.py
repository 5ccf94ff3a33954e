"""Each demo runs as it stands; its own assertions judge it. It ends in a figure, and its page has all of it."""

import runpy
import sys
from pathlib import Path

import matplotlib.figure
import pytest

REPOSITORY = Path(__file__).resolve().parents[2]
DEMOS = sorted((REPOSITORY / "examples" / "demos").glob("*.py"))


@pytest.mark.parametrize("path", DEMOS, ids=lambda path: path.stem)
def test_a_demo_runs(path):
    assert "\nassert " in path.read_text(encoding="utf-8")
    assert isinstance(runpy.run_path(str(path))["figure"], matplotlib.figure.Figure)
    assert (REPOSITORY / "docs" / "pictures" / "demos" / f"{path.stem}.png").is_file()


def test_a_page_has_all_code_of_its_demo(monkeypatch):
    monkeypatch.syspath_prepend(str(REPOSITORY / "docs" / "generators"))
    from demo_pages import as_markdown

    script = DEMOS[0].read_text(encoding="utf-8")
    page = as_markdown(script)
    assert page.startswith("# ")
    code = [line for line in script.splitlines() if line and not line.startswith("#")]
    assert [line for line in code if line not in page] == []
    sys.modules.pop("demo_pages")
