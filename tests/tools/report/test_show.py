"""A run for ParaView and as a film, read back."""

import numpy as np
import pytest
import pyvista as pv
from PIL import Image
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline
from vtkmodules.vtkFiltersGeometry import vtkGeometryFilter
from vtkmodules.vtkIOHDF import vtkHDFReader

from coilset.model.core.base.errors import InputError
from coilset.model.core.results.files.opened import open_run
from coilset.model.tools.figures.animation import animate
from coilset.model.tools.figures.display import ensure
from coilset.model.tools.figures.series import write_series

ANGLES = 24


@pytest.fixture(scope="module")
def run(folder):
    return open_run(folder)


@pytest.fixture(scope="module")
def read(run):
    return [pv.PVDReader(path) for path in write_series(run) if path.suffix == ".pvd"]


def test_the_file_of_all_times_holds_the_same(run):
    """As VTK's own reader of VTKHDF sees it."""
    for path in write_series(run):
        if path.suffix != ".vtkhdf":
            continue
        hdf, files = vtkHDFReader(), pv.PVDReader(path.with_suffix(".pvd"))
        hdf.SetFileName(str(path))
        hdf.UpdateInformation()
        times = hdf.GetOutputInformation(0).Get(vtkStreamingDemandDrivenPipeline.TIME_STEPS())
        assert list(times) == files.time_values
        for time in (times[0], times[-1]):
            hdf.UpdateTimeStep(time)
            ours, theirs = pv.wrap(hdf.GetOutput()), mesh(files, time)
            assert np.array_equal(ours.points, theirs.points)
            assert np.array_equal(ours.cells, theirs.cells)
            for name in (*theirs.point_data, *theirs.cell_data):
                assert np.array_equal(ours[name], theirs[name]), name


@pytest.mark.parametrize(
    ("there", "said"),
    [
        ((), "there is no summary.json"),
        (("summary.json",), "there is no points.nc"),
        (("summary.json", "inner/points.nc", "outer/points.nc"), "there is no points.nc; is {}/inner meant?"),
    ],
)
def test_a_folder_without_a_run_is_reported(tmp_path, there, said):
    """Such as that of a slice, or of a nest, which has a run in each of two folders."""
    for name in there:
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text("{}")
    with pytest.raises(InputError) as caught:
        open_run(tmp_path)
    assert str(caught.value) == f"{tmp_path}: holds no results of a run: {said.format(tmp_path)}"


def mesh(reader, time):
    reader.set_active_time_value(time)
    (one,) = reader.read()
    return one


def test_times_are_steps(run, read):
    line, wire, sections = read
    assert line.time_values == wire.time_values == list(range(7))
    assert sections.time_values == [0, 4, 6]


def test_the_line_is_that_of_the_stations(run, read):
    for time in (0, 3, 6):
        at = run.data["position"].values[0] if time == 0 else run.data["step_position"].sel(step=time).values
        assert np.array_equal(mesh(read[0], time).points, at)


def test_the_tube_is_closed_and_has_the_wires_volume(run, read):
    """Pappus: the area of a ring times the length of its centres' way; a ring is a polygon of 24 sides."""
    for time in (0, 4):
        outside = vtkGeometryFilter()  # pyvista's own is called otherwise in each of its versions
        outside.SetInputData(mesh(read[1], time))
        outside.Update()
        tube = pv.wrap(outside.GetOutput()).triangulate()
        assert tube.n_open_edges == 0
        x = run.data["position"].values[0] if time == 0 else run.data["step_position"].sel(step=time).values
        length = np.linalg.norm(np.diff(x, axis=0), axis=1).sum()
        area = 0.5 * ANGLES * np.sin(2.0 * np.pi / ANGLES) * 2.5**2
        assert tube.volume == pytest.approx(area * length, rel=0.01)  # chords of an eighth of a turn are 0.6 % short
    ends = mesh(read[1], 4)["shear_MPa"].reshape(-1, ANGLES)[[0, -1]]
    assert ends == pytest.approx(run.data["step_shear"].sel(step=4).values[[0, -1]], rel=1e-6)


def test_section_points_lie_in_the_wire_and_bring_their_state(run, read):
    shape = run.data["point_state"].shape[1:4]
    for time, snapshot in ((0, 0), (4, 1), (6, 2)):
        cloud = mesh(read[2], time)
        assert np.array_equal(cloud["t13"], run.data["point_state"].sel(component="t13").values[snapshot].ravel())
        points = cloud.points.reshape(*shape, 3)
        weight = run.data["weight"].values[..., None]
        centre = (points * weight).sum(axis=2, keepdims=True)
        off = np.hypot(run.data["y"].values, run.data["z"].values)
        assert np.linalg.norm(points - centre, axis=-1) == pytest.approx(np.broadcast_to(off, shape), rel=1e-6)
        inner = run.data["y"].values[0, 0].argmax()  # towards the axis
        assert np.all(np.hypot(*points[..., inner, :2].reshape(-1, 2).T) < np.hypot(*centre[..., :2].reshape(-1, 2).T))


def test_a_film_has_a_picture_for_each_step_and_the_start(run):
    if not ensure():
        pytest.skip("there is no display and no Xvfb")
    with Image.open(animate(run)) as film:
        assert film.n_frames == 7
        pictures = []
        for number in range(film.n_frames):
            film.seek(number)
            pictures.append(np.asarray(film.convert("RGB"), dtype=int))
    assert pictures[0].shape == (540, 720, 3)
    red = [np.count_nonzero((one[..., 0] > one[..., 2] + 60) & (one[..., 1] < 150)) for one in pictures]
    assert red[4] > 1.5 * red[0]  # at block the wire is red with stress, at the start it has none
