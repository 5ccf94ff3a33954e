"""Meshes of sections: areas, surfaces, and wrong outlines."""

import gmsh
import numpy as np
import pytest
import ufl
from dolfinx import fem

from coilset.meshes.sections.mesh import section_mesh
from coilset.meshes.sections.shapes import Curve, Oval, Trapezoid, Tube, parse, rectangle, round_wire
from coilset.model.core.base.errors import InputError


def area(section):
    return fem.assemble_scalar(fem.form(fem.Constant(section.mesh, 1.0) * ufl.dx))


def outline(n=24):
    angle = 2 * np.pi * np.arange(n) / n
    return np.stack([3 * np.cos(angle), 2 * np.sin(angle)], axis=1)


@pytest.mark.parametrize(
    ("shape", "exact", "tolerance"),
    [
        (round_wire(5.0), np.pi * 2.5**2, 1e-4),
        (Oval(4.0, 6.0), np.pi * 6, 1e-4),
        (Oval(6.0, 4.0), np.pi * 6, 1e-4),
        (Tube(5.0, 3.0), np.pi * 4, 1e-4),
        (rectangle(4.0, 6.0), 24.0, 1e-12),
        (rectangle(4.0, 6.0, 0.5), 24 - (4 - np.pi) * 0.25, 1e-4),
        (Trapezoid(4.0, 5.0, 6.0), 22.0, 1e-12),
        (Curve(outline()[::-1]), 0.5 * 24 * 6 * np.sin(np.pi / 12), 1e-12),  # clockwise, a polygon
        (Curve(outline(), smooth=True), np.pi * 6, 1e-3),
    ],
)
def test_area(shape, exact, tolerance):
    section = section_mesh(shape, 5.0)
    assert area(section) == pytest.approx(exact, rel=tolerance)
    assert section.area == pytest.approx(exact, rel=max(tolerance, 1e-3 if isinstance(shape, Curve) else 0))


def test_curved_sides_converge_with_their_degree():
    errors = {d: [abs(area(section_mesh(round_wire(5.0), a, d)) / (np.pi * 6.25) - 1) for a in (4, 8)] for d in (2, 3)}
    assert errors[2][0] / errors[2][1] > 2**3.5
    assert errors[3][1] < errors[2][1] / 3


def test_extent_and_surface():
    section = section_mesh(Trapezoid(4.0, 5.0, 6.0, 0.0), 5.0)
    assert section.extent == pytest.approx((-2.0, 2.0, -3.0, 3.0), abs=1e-9)
    length = fem.assemble_scalar(fem.form(fem.Constant(section.mesh, 1.0) * ufl.ds))
    assert length == pytest.approx(5.0 + 6.0 + 2 * np.hypot(4.0, 0.5), rel=1e-9)
    assert len(section.facets) > 12


def test_words_and_files(tmp_path):
    assert parse("oval:4:5") == Oval(4.0, 5.0)
    assert parse("rectangle:4:5:0.5") == Trapezoid(4.0, 5.0, 5.0, 0.5)
    path = tmp_path / "outline.csv"
    np.savetxt(path, outline(), delimiter=",", header="xi,eta", comments="")
    assert section_mesh(parse(str(path))).area == pytest.approx(0.5 * 24 * 6 * np.sin(np.pi / 12), rel=1e-9)
    assert section_mesh(parse(f"smooth:{path}")).area == pytest.approx(6 * np.pi, rel=1e-3)


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("oval:4", "not a section"),
        ("oval:4:x", "not a section"),
        ("star:3", "not a section"),
        ("round:-5", "positive"),
        ("rectangle:4:5:3", "more than the sides allow"),
        ("rectangle:4:5:-1", "radius from 0"),
        ("none.csv", "cannot be read"),
    ],
)
def test_wrong_words(text, problem):
    with pytest.raises(InputError, match=problem) as caught:
        section_mesh(parse(text))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("points", "problem"),
    [
        ([(0, 0), (1, 0)], "three points"),
        ([(0, 0), (1, 0), (2, 0)], "no area"),
        ([(0, 0), (2, 2), (2, 0), (0, 1)], "crosses or touches itself"),
        ([(0, 0), (4, 0), (4, 4), (2, 4), (3, 0), (2.5, 4), (0, 4)], "crosses or touches itself"),
        ([(0, 0), (1, np.nan), (1, 1)], "three points"),
    ],
)
def test_wrong_outlines(points, problem):
    with pytest.raises(InputError, match=problem):
        Curve(np.array(points, float))


def test_points_given_twice_and_sides_of_one_straight_line():
    square = Curve(np.array([(0, 0), (1, 0), (2, 0), (2, 0), (2, 2), (1, 2), (0, 2), (0, 0)], float))
    assert len(square.points) == 6
    assert section_mesh(square, 3.0).area == pytest.approx(4.0, rel=1e-12)


def test_an_outline_that_cannot_be_filled():
    class Touching:
        def draw(self):
            occ = gmsh.model.occ
            places = (-2, -2), (2, -2), (2, 2), (0, 2), (1, 0), (1, 2), (-2, 2)
            tags = [occ.addPoint(*place, 0) for place in places]
            return [occ.addLine(tag, tags[i - 6]) for i, tag in enumerate(tags)]

    with pytest.raises(InputError, match=r"section\.points: the curve cannot be filled") as caught:
        section_mesh(Touching(), 3.0)
    assert "\n" not in str(caught.value)


def test_a_spline_that_crosses_itself_between_its_points():
    points = [(-0.09, 1.03), (-0.5, -1.93), (-0.55, -2.41), (-0.45, -2.66), (0.22, -2.74), (0.93, -2.58), (0.55, -0.13)]
    assert section_mesh(Curve(np.array(points)), 3.0).area > 0
    with pytest.raises(InputError, match=r"section\.points: the curve crosses itself between its points"):
        section_mesh(Curve(np.array(points), smooth=True), 3.0)


@pytest.mark.parametrize(
    ("shape", "middle"),
    [
        (round_wire(5.0), (-2.5, 2.5)),
        (Oval(4.0, 5.0), (-2.0, 2.0)),
        (rectangle(4.0, 6.0, 0.5), (-2.0, 2.0)),
        (Curve(np.array([(-2.5, -2.5), (2.5, -2.5), (0, 2.5)])), (-1.25, 1.25)),
        (Curve(np.array([(-2.5, 0), (2.5, 0), (0, 2.5)])), (-2.5, 2.5)),
        (Curve(np.array([(-2.5, 1), (2.5, 1), (0, 2.5)])), None),
    ],
)
def test_middle(shape, middle):
    found = section_mesh(shape, 3.0).middle
    assert found is None if middle is None else found == pytest.approx(middle, abs=1e-12)


def test_wrong_line_of_a_file(tmp_path):
    path = tmp_path / "outline.csv"
    path.write_text("xi,eta\n0,0\n1,zero\n1,1\n")
    with pytest.raises(InputError, match="line 3"):
        Curve.read(path)


def test_the_first_line_of_a_file_is_a_point_unless_it_names_the_columns(tmp_path):
    path, square = tmp_path / "outline.csv", "-2,-2\n2,-2\n2,2\n-2,2\n"
    for head, encoding in (("", "utf-8"), ("", "utf-8-sig"), ("xi,eta\n", "utf-8-sig")):
        path.write_text(head + square, encoding=encoding)
        assert len(Curve.read(path).points) == 4
    path.write_text(square.replace("-2,-2", "-2,-2x"))
    with pytest.raises(InputError, match=r"line 1: '-2,-2x' is not a pair"):
        Curve.read(path)
