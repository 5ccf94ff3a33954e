"""Formulas of the site need no network where MathJax is installed."""

import importlib.util
from pathlib import Path
from types import SimpleNamespace

import pytest

GENERATORS = Path(__file__).resolve().parents[2] / "docs" / "generators"


@pytest.fixture
def formulas():
    spec = importlib.util.spec_from_file_location("formulas", GENERATORS / "formulas.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_mathjax_is_copied_into_the_site(formulas, tmp_path):
    """What the configuration names lies beside the pages afterwards: the script and its combined configuration."""
    if not formulas.configuration():
        pytest.skip("libjs-mathjax is not installed here")
    formulas.copy(SimpleNamespace(outdir=tmp_path), None)
    static, configuration = tmp_path / "_static", formulas.configuration()
    assert (static / configuration["mathjax_path"]).stat().st_size > 50_000
    for name in configuration["mathjax2_config"]["config"]:
        assert (static / "mathjax" / "config" / name).stat().st_size > 100_000


def test_without_mathjax_sphinx_decides(formulas, tmp_path, monkeypatch):
    monkeypatch.setattr(formulas, "INSTALLED", tmp_path / "none")
    formulas.copy(SimpleNamespace(outdir=tmp_path), None)
    assert formulas.configuration() == {}
    assert list(tmp_path.iterdir()) == []
