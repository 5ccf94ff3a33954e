"""STEP files: the body in the file has the volume of the wire, and its ground faces are at the seats."""

import gmsh
import numpy as np
import pytest

from coilset.meshes.drawings import step as module
from coilset.meshes.drawings.step import step
from coilset.meshes.springs.spring import SpringSpec
from coilset.model.core.base.errors import CoilsetError
from coilset.scripts.main import app

SHORT = {"wire_diameter": 3.0, "mean_diameter": 20.0, "turns": 2.0, "pitch": 8.0}
GROUND = SHORT | {"end_coils": {"form": "closed and ground", "turns": 0.5, "transition": 0.25}}


def opened(content, path):
    """Volume, centre of mass, and the heights of the horizontal plane faces of the only body in a file."""
    path.write_bytes(content)
    gmsh.initialize(["test", "-v", "0"], readConfigFiles=False, interruptible=False)
    try:
        ((dimension, body),) = gmsh.model.occ.importShapes(str(path))
        assert dimension == 3
        gmsh.model.occ.synchronize()
        volume, centre = gmsh.model.occ.getMass(3, body), gmsh.model.occ.getCenterOfMass(3, body)
        planes = [tag for _, tag in gmsh.model.getEntities(2) if gmsh.model.getType(2, tag) == "Plane"]
        normals = {tag: gmsh.model.getNormal(tag, [0.5, 0.5]) for tag in planes}
        flat = [gmsh.model.occ.getCenterOfMass(2, tag)[2] for tag in planes if abs(normals[tag][2]) > 0.999]
        return volume, centre, sorted(flat)
    finally:
        gmsh.finalize()


def left_by_grinding(spring):
    """∫ (π r² − segments beyond the seats) ds by the formula of a circular segment."""
    turn = (np.arange(20_000) + 0.5) / 20_000 * spring.turns
    r, tilt = 0.5 * spring.wire_diameter(turn), np.linalg.norm(spring.tangent(turn)[:, :2], axis=1)
    area = np.pi * r**2
    for end in ("bottom", "top"):
        h = np.clip(spring.seat_level_distance(turn, end) / tilt, -r, r)
        area -= r**2 * np.arccos(h / r) - h * np.sqrt(r**2 - h**2)
    return float(np.mean(area * spring.speed(turn)) * spring.turns)


def test_a_ground_spring_at_any_height(tmp_path):
    spring = SpringSpec(**GROUND).build()
    height = 0.5 * (spring.block_height + spring.free_length)
    pressed = spring.at_height(height)
    content, stated = step(pressed)
    volume, centre, flat = opened(content, tmp_path / "spring.step")
    assert volume == pytest.approx(left_by_grinding(pressed), rel=1e-4)
    assert volume < 0.95 * pressed.volume
    assert stated == volume
    assert flat == pytest.approx([0.0, height], abs=1e-6)
    assert centre[2] == pytest.approx(0.5 * height, rel=1e-6)


@pytest.mark.parametrize(
    "wire",
    [
        {"wire_diameter": {"turns": [0, 0.75], "values": [3.0, 2.0], "interpolation": "linear"}, "hand": "left"},
        {"wire_diameter": None, "wire": {"tube": {"outer": 3.0, "inner": 1.5}}},
        {"wire_diameter": None, "wire": {"rectangle": {"width": 4.0, "height": 2.0, "corner": 0.3}}},
        {"hooks": {"bottom": {"shape": "german"}}},
    ],
    ids=["thinner and thinner", "tube", "rectangle", "hooks"],
)
def test_a_wire_that_is_cut_across_has_area_times_length(wire):
    """Pappus: the centre of area is on the centre line."""
    spring = SpringSpec(**SHORT | {"turns": 0.75} | wire).build()
    assert step(spring)[1] == pytest.approx(spring.volume, rel=1e-4)


def test_a_wire_that_is_thick_outside_has_more_than_area_times_length():
    """An egg whose centre of area is beyond the centre line by e: 2π (R + e) A a turn, of a flat coil."""
    wire = {"egg": {"inside": 0.8, "outside": 1.6, "distance": 2.0}}
    spring = SpringSpec(**SHORT | {"wire_diameter": None, "wire": wire, "pitch": 3.3, "turns": 0.5}).build()
    polygon = spring.section.polygon
    (y, z), (v, w) = polygon.T, np.roll(polygon, -1, axis=0).T
    double = y * w - v * z
    beyond = -1.6 * np.sum(double * (y + v)) / (3.0 * np.sum(double))  # y is towards the axis, in half the height
    _, volume = step(spring)
    assert beyond > 0.1
    assert volume / spring.volume - 1.0 == pytest.approx(beyond / 10.0, rel=0.01)


def test_a_body_that_is_not_the_wire_is_reported(monkeypatch):
    monkeypatch.setattr(module, "wire_volume", lambda spring: 1.01 * spring.volume)
    with pytest.raises(CoilsetError, match=r"a body of \d+\.?\d* mm³; the wire has"):
        step(SpringSpec(**SHORT | {"turns": 0.5}).build())


def test_both_commands_write_one(tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "case.yaml").write_text(
        "spring: {wire_diameter: 3, mean_diameter: 20, turns: 1.5, pitch: 8}\n"
        "material: {wire: EN 10270-1 SH}\nloading: [{to: block}]\n"
    )
    app(["sheet", "case.yaml", "--out", "a/free.step"], standalone_mode=False)
    app(["mesh", "case.yaml", "--write", "b/pressed.step", "--height", "10", "--no-pictures"], standalone_mode=False)
    assert "Statistics" not in capfd.readouterr().out  # which OpenCASCADE prints
    centres = [
        opened((tmp_path / name).read_bytes(), tmp_path / "x.step")[1][2] for name in ("a/free.step", "b/pressed.step")
    ]
    assert centres[1] == pytest.approx(5.0, rel=1e-3)
    assert centres[0] > 7.0
