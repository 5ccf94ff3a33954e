"""Every command refuses a target that cannot be written to, before it works; nothing is made."""

import pytest

from coilset.model.core.base.errors import InputError
from coilset.scripts.main import app
from coilset.scripts.terminal.target import file_targets, folder_target, sheet_targets

COMMANDS = [
    "solve CASE",
    "slice CASE",
    "mesh CASE",
    "sheet CASE",
    "sweep CASE",
    "verify",
    "bench",
    "material show ck15",
    "examples ck15_presetting",
    "design DESIGN",
]


@pytest.mark.parametrize("command", COMMANDS)
def test_an_empty_name_of_a_folder_is_not_where_we_are(example, tmp_path, monkeypatch, command):
    """As `--out "$NOWHERE"`."""
    monkeypatch.chdir(tmp_path)
    words = [str(example) if word == "CASE" else word for word in command.split()]
    with pytest.raises(InputError, match="--out: is empty; give a name"):
        app([*words, "--out", ""], prog_name="coilset", standalone_mode=False)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize("target", ["taken", "taken/below", "n" * 300, "a\0b"])
def test_a_target_that_cannot_be_gets_one_line(example, tmp_path, monkeypatch, command, target):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "taken").write_text("mine")
    words = [str(example) if word == "CASE" else word for word in command.split()]
    with pytest.raises(InputError, match="--out") as caught:
        app([*words, "--out", target], prog_name="coilset", standalone_mode=False)
    assert "\n" not in str(caught.value)
    assert [path.name for path in tmp_path.iterdir()] == ["taken"]


@pytest.mark.parametrize("target", ["offer.docx", "new/spring.stp"])
def test_a_sheet_of_another_kind_is_no_folder(tmp_path, monkeypatch, target):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputError, match=r"must end in .html, .pdf, .csv, .dxf, .step, or be a folder"):
        sheet_targets([target])
    assert sheet_targets(["results/v1.2", "offer.pdf"]) == ["results/v1.2", "offer.pdf"]


@pytest.mark.parametrize("target", ["new/x.foo", "new/x.stl", "new/x", ".msh", "new/x.vtu.gz"])
def test_a_mesh_of_no_format_makes_nothing(example, tmp_path, monkeypatch, target):
    """Not even the meshes before it, and its folder."""
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputError, match=r"--write: .*use \.vtu, \.msh, \.inp or \.xdmf") as caught:
        app(["mesh", str(example), "--no-pictures", "--write", "one/a.vtu", "--write", target], standalone_mode=False)
    assert "partial" not in str(caught.value)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("target", ["taken/x.msh", ".", "n" * 300 + ".msh"])
def test_a_mesh_that_cannot_be_written_gets_one_line(example, tmp_path, monkeypatch, target):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "taken").write_text("mine")
    with pytest.raises(InputError, match="--write"):
        app(["mesh", str(example), "--no-pictures", "--write", target], prog_name="coilset", standalone_mode=False)


@pytest.mark.parametrize("target", ["", ".", "taken/page.md", "n" * 300])
def test_a_page_that_cannot_be_written_gets_one_line_before_the_cases_run(tmp_path, monkeypatch, target):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "taken").write_text("mine")
    with pytest.raises(InputError, match="--page"):
        app(["verify", "two-circles", "--page", target], prog_name="coilset", standalone_mode=False)
    assert [path.name for path in tmp_path.iterdir()] == ["taken"]


def test_a_page_makes_its_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    command = ["verify", "two-circles", "--page", "new/page.md"]
    assert app(command, prog_name="coilset", standalone_mode=False) == 0
    assert "`two-circles`" in (tmp_path / "new" / "page.md").read_text()


def test_a_home_folder_that_the_shell_left_is_found(tmp_path, monkeypatch):
    """As in `--out=~/runs`."""
    monkeypatch.setenv("HOME", str(tmp_path))
    assert folder_target("~/runs") == str(tmp_path / "runs")
    assert file_targets(["~/wire.vtu", "wire.vtu"]) == [str(tmp_path / "wire.vtu"), "wire.vtu"]
