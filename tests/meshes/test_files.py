"""Meshes as files, and springs read back from them as measured centre lines."""

import gmsh
import meshio
import numpy as np
import pytest

from coilset.meshes.drawings.export import write_mesh
from coilset.meshes.measured.measured import MeasuredSpec
from coilset.meshes.springs.spring import SpringSpec
from coilset.model.core.base.errors import InputError
from coilset.model.core.case import check

ENDS = {"form": "closed and ground"}
FORMATS = [".msh", ".vtu", ".vtk", ".xdmf", ".inp", ".med", ".csv"]


@pytest.fixture(scope="module")
def barrel():
    """A left-hand spring with everything that can change along the wire."""
    wire = {"turns": [0, 2, 4, 7.25], "values": [4.0, 5.0, 5.0, 4.5], "interpolation": "monotone"}
    return SpringSpec(
        wire_diameter=wire,
        mean_diameter={"shape": "barrel", "ends": 30.0, "middle": 50.0},
        turns=7.25,
        free_length=110.0,
        hand="left",
        end_coils=ENDS,
    ).build()


def write(spring, path, per_turn=16):
    turns = spring.stations(per_turn)
    if path.suffix == ".csv":
        table = np.column_stack([spring.centre_line(turns), spring.wire_diameter(turns)])
        np.savetxt(path, table, delimiter=",", header="x,y,z,wire_diameter", comments="", fmt="%.9f")
    else:
        write_mesh(spring, turns, path)


@pytest.mark.parametrize("suffix", FORMATS)
def test_round_trip(barrel, tmp_path, suffix):
    path = tmp_path / f"spring{suffix}"
    write(barrel, path)
    has_wire = suffix != ".inp"
    spec = MeasuredSpec(file=str(path), end_coils=ENDS, **({} if has_wire else {"wire_diameter": 4.5}))
    spring, t = spec.build(), np.linspace(0, 7.25, 500)
    assert spring.hand == -1
    assert spring.turns == pytest.approx(7.25, rel=1e-9)
    assert spring.active_turns == pytest.approx(5.25, rel=1e-9)
    # a cubic spline through 16 points a turn; the pitch's transitions have corners in their second derivative
    np.testing.assert_allclose(spring.centre_line(t)[:, :2], barrel.centre_line(t)[:, :2], atol=2e-4)
    np.testing.assert_allclose(spring.tangent(t), barrel.tangent(t), atol=2e-4)
    if has_wire:
        # PCHIP through the points of another PCHIP is not the same curve, but close
        np.testing.assert_allclose(spring.wire_diameter(t), barrel.wire_diameter(t), atol=0.01)
        np.testing.assert_allclose(spring.centre_line(t)[:, 2], barrel.centre_line(t)[:, 2], atol=2e-4)
        assert spring.free_length == pytest.approx(110, rel=1e-6)
        assert spring.block_height == pytest.approx(barrel.block_height, rel=2e-3)


def test_helix_is_read_back_exactly(tmp_path):
    helix = SpringSpec(wire_diameter=5.0, mean_diameter=40.0, turns=2.5, pitch=12.0).build()
    write(helix, tmp_path / "helix.vtu", per_turn=8)
    spring, t = MeasuredSpec(file=str(tmp_path / "helix.vtu")).build(), np.linspace(0, 2.5, 99)
    np.testing.assert_allclose(spring.centre_line(t), helix.centre_line(t), atol=1e-10)
    np.testing.assert_allclose(spring.curvature(t), helix.curvature(t), rtol=1e-10)


def test_path_counts_from_the_folder_of_the_case(barrel, tmp_path):
    write(barrel, tmp_path / "scan.csv")
    data = {"spring": {"file": "scan.csv", "end_coils": ENDS}, "loading": [{"to": "block"}]}
    assert check(data, tmp_path / "case.yaml").spring.build().turns == pytest.approx(7.25)


def test_noise_is_smoothed(tmp_path):
    helix = SpringSpec(wire_diameter=5.0, mean_diameter=40.0, turns=4.0, pitch=12.0).build()
    turns = np.linspace(0, 4, 401)
    noisy = helix.centre_line(turns) + np.random.default_rng(1).normal(scale=0.05, size=(401, 3))
    np.savetxt(tmp_path / "noisy.csv", noisy, delimiter=",", header="x,y,z", comments="")
    spec = {"file": str(tmp_path / "noisy.csv"), "wire_diameter": 5.0}
    rough, smooth = MeasuredSpec(**spec).build(), MeasuredSpec(**spec, noise=0.05).build()
    t = np.linspace(0.2, 3.8, 300)
    true = helix.curvature(t)
    # 401 points and few pieces: the mean over some 100 points, 0.05/√100 mm, and curvature with the same share of r
    assert np.abs(smooth.mean_radius(t) - 20).max() < 0.03
    assert np.abs(smooth.curvature(t) / true - 1).max() < 0.02
    assert np.abs(rough.curvature(t) / true - 1).max() > 0.5


def test_gmsh_groups(barrel, tmp_path):
    path = tmp_path / "spring.msh"
    turns = barrel.stations(16)
    write_mesh(barrel, turns, path)
    gmsh.initialize(["test", "-v", "1"], readConfigFiles=False, interruptible=False)
    try:
        gmsh.open(str(path))
        groups = {gmsh.model.getPhysicalName(dim, tag): (dim, tag) for dim, tag in gmsh.model.getPhysicalGroups()}
        counts, nodes = {}, {}
        for name, (dim, tag) in groups.items():
            entities = gmsh.model.getEntitiesForPhysicalGroup(dim, tag)
            counts[name] = sum(len(gmsh.model.mesh.getElements(dim, entity)[1][0]) for entity in entities)
            nodes[name] = gmsh.model.mesh.getNodesForPhysicalGroup(dim, tag)[1].reshape(-1, 3)
    finally:
        gmsh.finalize()
    # one end turn of 16 elements at either end
    assert counts == {"wire": len(turns) - 1, "end coils": 32, "bottom end": 1, "top end": 1}
    ends = barrel.centre_line(np.array([0.0, barrel.turns]))
    np.testing.assert_allclose(nodes["bottom end"], ends[:1], atol=1e-9)
    np.testing.assert_allclose(nodes["top end"], ends[1:], atol=1e-9)


@pytest.mark.parametrize("suffix", [".inp", ".INP"])
def test_abaqus_sets(barrel, tmp_path, suffix):
    write_mesh(barrel, barrel.stations(16), tmp_path / f"spring{suffix}")
    mesh = meshio.read(tmp_path / f"spring{suffix}")
    assert len(mesh.cell_sets["end_coils"][0]) == 32
    assert mesh.point_sets["top_end"].tolist() == [len(mesh.points) - 1]


@pytest.mark.parametrize("suffix", [".stl", ".unknown"])
def test_formats_without_wires_are_refused(barrel, tmp_path, suffix):
    path = tmp_path / f"spring{suffix}"
    with pytest.raises(InputError, match=r"use \.vtu, \.msh, \.inp or \.xdmf"):
        write_mesh(barrel, barrel.stations(16), path)
    assert not path.exists()


@pytest.mark.parametrize("failure", [ModuleNotFoundError("No module named 'netCDF4'"), AssertionError()])
def test_formats_whose_writers_fail_get_one_line(barrel, tmp_path, monkeypatch, failure):
    """As those of .e, whose library may be missing, and of .bdf do."""

    def fail(*_, **__):
        raise failure

    monkeypatch.setattr(meshio.Mesh, "write", fail)
    reason = str(failure) or "AssertionError"
    with pytest.raises(InputError, match=f"meshio cannot write the wire in this format: {reason}; use"):
        write_mesh(barrel, barrel.stations(16), tmp_path / "spring.e")


HEAD = "x,y,z,wire_diameter\n"
POINTS = [f"{20 * np.cos(a):.6f},{20 * np.sin(a):.6f},{3 * a:.6f},5\n" for a in np.arange(0, 12, 0.5)]

WRONG_TABLES = [
    ("", "line 1: the columns must be x,y,z or x,y,z,wire_diameter, not ''"),
    ("x\n", "line 1: the columns must be x,y,z or x,y,z,wire_diameter, not 'x'"),
    (HEAD + "1,2,3\n", "line 2, column wire_diameter: '' is not a number"),
    (HEAD + "1,2,three,5\n", "line 2, column z: 'three' is not a number"),
    (HEAD + "".join(POINTS[:3]), "has 3 points; a centre line needs 5 or more"),
    (
        HEAD + "".join(POINTS) + "1,nan,3,5\n",
        "line 26, column y: 'nan' is not a number",
    ),
    (
        HEAD + "".join(POINTS).replace(",5\n", ",0\n"),
        "point 1: 20, 0, 0, 0: must be finite numbers and a wire diameter above 0",
    ),
    (
        HEAD + "".join(POINTS[:9] + POINTS[5:]),
        "point 10: the wire does not continue around the z axis here; the axis of the spring must be the z axis, and "
        "no point may occur twice",
    ),
    (HEAD + "".join(POINTS[::5]), "point 2: is 143° away from point 1; must be at most 120°"),
    (
        "".join([HEAD.replace(",wire_diameter", ""), *(row.replace(",5\n", "\n") for row in POINTS)]),
        "has no wire_diameter; give spring.wire_diameter",
    ),
    # from the tenth to the twelfth point, 0.716 to 0.875 turns from the first
    (
        HEAD + "".join([*POINTS[:9], *(row.replace(",5\n", ",20\n") for row in POINTS[9:12]), *POINTS[12:]]),
        "the wire is thicker than the coil allows: D/d = 2 at turn 0.776, must be at least 3",
    ),
]


@pytest.mark.parametrize(("text", "message"), WRONG_TABLES, ids=[message[:50] for _, message in WRONG_TABLES])
def test_wrong_table_has_its_message(tmp_path, text, message):
    path = tmp_path / "scan.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError) as error:
        MeasuredSpec(file=str(path)).build()
    assert str(error.value) == f"{path}: {message}"


def test_wrong_meshes_have_their_messages(tmp_path):
    points = np.array([[20 * np.cos(a), 20 * np.sin(a), 3 * a] for a in np.arange(0, 12, 0.5)])
    line = np.stack([np.arange(23), np.arange(1, 24)], axis=1)
    for cells, message in (
        ([("line", np.vstack([line, [[3, 9]]]))], "its line elements are not one open chain: 2 ends, 2 branches"),
        ([("line", np.delete(line, 7, axis=0))], "its line elements are not one open chain: 4 ends, 0 branches"),
        ([("vertex", np.arange(24)[:, None])], "has no line elements; the wire must be a chain of them"),
    ):
        meshio.Mesh(points, cells).write(tmp_path / "wire.vtu")
        with pytest.raises(InputError) as error:
            MeasuredSpec(file=str(tmp_path / "wire.vtu"), wire_diameter=5.0).build()
        assert str(error.value) == f"{tmp_path / 'wire.vtu'}: {message}"
    with pytest.raises(InputError, match="there is no such file"):
        MeasuredSpec(file=str(tmp_path / "none.vtu")).build()
    with pytest.raises(InputError, match="is a folder; give a file"):
        MeasuredSpec(file=str(tmp_path)).build()
    (tmp_path / "broken.vtu").write_text("no mesh", encoding="utf-8")
    with pytest.raises(InputError, match="meshio cannot read it"):
        MeasuredSpec(file=str(tmp_path / "broken.vtu")).build()


def test_order_of_points_and_elements_does_not_matter(tmp_path):
    """Nodes and elements shuffled, elements turned round, quadratic elements: it is the same wire."""
    turns, shuffle = np.linspace(0, 2.5, 41), np.random.default_rng(2).permutation(41)
    helix = SpringSpec(wire_diameter=5.0, mean_diameter=40.0, turns=2.5, pitch=12.0).build()
    place = np.argsort(shuffle)  # where node i of the wire went
    quadratic = np.stack([place[0:-1:2], place[2::2], place[1::2]], axis=1)[::-1]
    quadratic[::3, :2] = quadratic[::3, 1::-1]
    meshio.Mesh(helix.centre_line(turns)[shuffle], [("line3", quadratic)]).write(tmp_path / "wire.vtu")
    spring = MeasuredSpec(file=str(tmp_path / "wire.vtu"), wire_diameter=5.0).build()
    np.testing.assert_allclose(spring.centre_line(turns), helix.centre_line(turns), atol=1e-9)


@pytest.mark.parametrize("downwards", [False, True])
@pytest.mark.parametrize(("step", "problem"), [(0.0, "the wire does not"), (0.4, "is 144° away from point {}")])
def test_the_number_of_a_wrong_point_is_that_in_the_file(tmp_path, downwards, step, problem):
    steps = np.full(39, 0.075)
    steps[3] = step  # from the fourth point to the fifth
    helix = SpringSpec(wire_diameter=5.0, mean_diameter=40.0, turns=4.0, pitch=12.0).build()
    points = helix.centre_line(np.append(0.0, np.cumsum(steps)))
    np.savetxt(tmp_path / "scan.csv", points[:: -1 if downwards else 1], delimiter=",", header="x,y,z", comments="")
    before, number = (37, 36) if downwards else (4, 5)
    with pytest.raises(InputError, match=f"point {number}: {problem.format(before)}"):
        MeasuredSpec(file=str(tmp_path / "scan.csv"), wire_diameter=5.0).build()


def test_the_number_of_a_wrong_line_counts_empty_ones(tmp_path):
    (tmp_path / "scan.csv").write_text("\nx,y,z\n\n1,2,3\n1,2,x\n")
    with pytest.raises(InputError, match="line 5, column z: 'x' is not a number"):
        MeasuredSpec(file=str(tmp_path / "scan.csv"), wire_diameter=5.0).build()
