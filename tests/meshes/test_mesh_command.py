"""`coilset mesh`: what it prints, draws and writes, for every shipped spring."""

from pathlib import Path

import matplotlib.image
import meshio
import numpy as np
import pytest

from coilset.meshes.drawings import view
from coilset.meshes.drawings.drawing import drawing
from coilset.meshes.springs.spring import SpringSpec
from coilset.model.core.base.errors import CoilsetError, InputError
from coilset.model.core.case import read_case
from coilset.model.tools.figures import display
from coilset.scripts.commands.mesh import mesh

SPRINGS = Path(__file__).parents[2] / "examples" / "springs"


@pytest.mark.parametrize("case", sorted(SPRINGS.glob("*.yaml")), ids=lambda path: path.stem)
def test_every_example_has_its_data(case, capsys):
    mesh(case, pictures=False)
    printed = capsys.readouterr().out
    for label in ("turns", "active turns", "wire length", "mass", "free length", "spring index D/d", "rate"):
        assert label in printed
    assert "warning" not in printed


def test_data_of_the_cylinder(capsys):
    mesh(SPRINGS / "cylinder.yaml", pictures=False, settings=["mesh.elements_per_turn=20"])
    rows = dict(line.strip().split("   ", 1) for line in capsys.readouterr().out.splitlines() if "   " in line.strip())
    rows = {label: value.strip() for label, value in rows.items()}
    assert rows["free length"] == "35 mm"
    assert rows["block length"] == "17.5 mm"
    assert rows["wire length"] == "315.59 mm"  # 2.5 √((40 π)² + 12²)
    assert rows["mass"] == "48.64 g"  # · π 5²/4 · 7.85e-3 g/mm³
    assert rows["rate G d⁴/(8 D³ n), EN 13906-1"] == "41.016 N/mm"  # G = 84000 MPa of Ck 15
    assert rows["elements"] == "50"


@pytest.mark.parametrize(
    ("loading", "rate"),
    [("", "13906-2, of the body"), ("loading: [{to: {force: 0, top: {turn: 90}}}]", "rate E I/l, EN 13906-3 ")],
)
def test_closed_coils_have_their_data_with_a_load_program_or_without(tmp_path, capsys, loading, rate):
    """They were refused for their travel, and without a program for that."""
    case = tmp_path / "door.yaml"
    spring = "spring: {wire_diameter: 6.35, inner_diameter: 50.8, turns: 20, pitch: 6.35}"
    case.write_text(f"{spring}\nmaterial: {{wire: ASTM A229}}\nends: clamped\n{loading}\n", encoding="utf-8")
    mesh(case, pictures=False)
    printed = capsys.readouterr().out
    assert rate in printed
    assert "length of the body" in printed
    assert "travel to block" not in printed


def test_files_and_pictures(tmp_path, capsys):
    out, file = tmp_path / "out", tmp_path / "new" / "spring.vtu"
    mesh(SPRINGS / "closed_and_ground.yaml", out=out, write=[str(file)])
    assert len(meshio.read(file).cells[0].data) == 120
    for name in ("drawing.png", "spring.png"):
        image = matplotlib.image.imread(out / name)[..., :3]
        assert 0.02 < np.mean(image.min(axis=-1) < 0.95) < 0.6  # neither empty nor full
    with pytest.raises(InputError, match="already exists; use --overwrite to overwrite it"):
        mesh(SPRINGS / "closed_and_ground.yaml", out=out)
    with pytest.raises(InputError, match="coils overlap"):  # the spring is judged first, as in the tutorial
        mesh(SPRINGS / "cylinder.yaml", out=out, settings=["spring.pitch=3"])
    mesh(SPRINGS / "closed_and_ground.yaml", out=out, write=[str(file)], force=True)


@pytest.mark.parametrize("setting", ["corner=0.5", "corner=0.8", "corner=0.2"])
def test_flat_sides_are_ground_at_both_ends(setting):
    """They graze the plane where the ground faces begin. The wire is whole between the planes, the faces are there."""
    spring = read_case(SPRINGS / "die_spring.yaml", [f"spring.wire.rectangle.{setting}"]).spring.build()
    surface = view.tube(spring)
    assert surface.bounds[4:] == pytest.approx((0.0, spring.free_length), abs=1e-6)
    assert 0.8 * spring.volume < surface.volume < 0.95 * spring.volume
    sized = surface.compute_cell_sizes(length=False, volume=False)
    for level in (0.0, spring.free_length):
        z = surface.points[surface.regular_faces][..., 2]
        face = sized["Area"][(np.abs(z - level) < 1e-6).all(axis=1)].sum()
        assert face == pytest.approx(0.75 * np.pi * (15.0**2 - 9.0**2), rel=0.05)  # three quarters of a turn


def test_a_picture_that_cannot_be_drawn_is_a_warning(tmp_path, monkeypatch, capsys):
    def fail(*_):
        raise ValueError("the surface is open\nin many places")

    monkeypatch.setattr(view, "picture", fail)
    monkeypatch.setattr(display, "ensure", lambda: True)
    mesh(SPRINGS / "cylinder.yaml", out=tmp_path)
    said = capsys.readouterr()
    assert "warning: spring.png is not drawn: the surface is open\n" in said.out + said.err
    assert [path.name for path in tmp_path.iterdir()] == ["drawing.png"]


def test_gmsh_writes_small_letters_only(tmp_path):
    file = tmp_path / "spring.MSH"
    with pytest.raises(InputError, match=r"--write: gmsh accepts lower-case suffixes only; give \.msh"):
        mesh(SPRINGS / "cone.yaml", pictures=False, write=[str(file)])
    assert not file.exists()


@pytest.mark.parametrize("suffix", [".msh", ".vtu"])
def test_a_mesh_in_a_place_that_cannot_be_written_is_one_line(suffix):
    with pytest.raises(CoilsetError, match=rf"^/proc/self/mesh\{suffix}: cannot be written: "):
        mesh(SPRINGS / "cylinder.yaml", pictures=False, write=[f"/proc/self/mesh{suffix}"])


def test_wrong_case_names_file_and_entry(capsys):
    case = SPRINGS / "cone.yaml"
    with pytest.raises(InputError, match=r"cone\.yaml: spring\.mean_diameter: the wire is thicker than the coil"):
        mesh(case, pictures=False, settings=["spring.wire_diameter=11"])


@pytest.mark.parametrize(("hand", "rises"), [("right", 1), ("left", -1)])
def test_side_view_shows_the_hand(hand, rises):
    """Seen from outside, the near half turns of a right-hand helix rise to the right."""
    spring = SpringSpec(wire_diameter=5.0, mean_diameter=40.0, turns=3.0, pitch=12.0, hand=hand).build()
    wires = sorted(drawing(spring).axes[0].collections, key=lambda wire: wire.get_zorder())
    nearest = np.array([piece[0] for piece in wires[-1].get_segments()])
    left, right = nearest[np.argmin(nearest[:, 0])], nearest[np.argmax(nearest[:, 0])]
    assert np.sign(right[1] - left[1]) == rises
