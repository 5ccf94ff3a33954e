"""All that a picture shows is in it: springs of any shape, programs of many cycles, numbers of any size."""

import itertools
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.image import imread
from mpi4py import MPI
from scipy.interpolate import RegularGridInterpolator

from coilset.model.compose.analysis import Analysis
from coilset.model.compose.run_files import run_of
from coilset.model.core.base.style import QUARTERED, round_end
from coilset.model.core.case import check, read_case
from coilset.model.core.results.files.checkpoint import Checkpoint
from coilset.model.core.results.records.labels import plain
from coilset.model.core.results.records.provenance import origin
from coilset.model.core.results.records.record import BucklingMode, Step
from coilset.model.tools.figures.display import ensure
from coilset.model.tools.figures.panels import buckling, seats
from coilset.model.tools.figures.panels.characteristic import characteristic
from coilset.model.tools.figures.panels.goodman import goodman as goodman_panel
from coilset.model.tools.figures.panels.panel import GREY
from coilset.model.tools.figures.panels.section_map import element_at, shear_map
from coilset.model.tools.figures.png import png_figure, write_png
from coilset.model.tools.figures.scene import (
    ABOVE,
    BAR,
    COLUMN,
    LABELS,
    MOST_HEIGHT,
    WIDTH,
    Arrangement,
    caption,
    springs,
)
from coilset.model.tools.figures.wire_surface import inside
from coilset.model.tools.standards import goodman


@pytest.mark.parametrize("springs", [1, 2, 4])
@pytest.mark.parametrize(("across", "tall"), [(45.0, 35.0), (0.55, 0.6), (45.0, 800.0), (400.0, 10.0), (20.0, 160.0)])
def test_springs_are_whole_in_their_picture(across, tall, springs):
    view = Arrangement.of(across, tall, springs)
    assert view.scale * (view.column * (springs - 1) + across) < WIDTH
    assert view.scale * (tall + ABOVE * across) <= view.height - LABELS - BAR + 1
    assert view.height <= MOST_HEIGHT + 1
    assert view.scale * view.column >= min(COLUMN, WIDTH / springs) - 1e-9  # labels do not overlap
    assert view.column > across


@pytest.mark.parametrize(
    ("greatest", "end"), [(197.3, 200.0), (65.8, 80.0), (2.0, 2.0), (0.0, 1.0), (3.1e-7, 4e-7), (9.9e5, 1e6)]
)
def test_scales_end_on_few_digits(greatest, end):
    assert round_end(greatest, QUARTERED) == pytest.approx(end)
    labels = np.linspace(0.0, round_end(greatest, QUARTERED), 5)  # as many as the colour bar has, of three digits each
    assert [float(f"{label:.3g}") for label in labels] == pytest.approx(labels, rel=1e-9)


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"),
        (-0.0, "0"),
        (258.28, "258.3"),
        (120165.57, "120,166"),
        (1.10254, "1.103"),
        (0.00421, "0.00421"),
        (35.0, "35"),
        (-1.5e-9, "0"),
        (1e7, "10,000,000"),
        (99.996, "100"),
    ],
)
def test_numbers_of_any_size_are_plain(value, text):
    assert plain(value) == text


@pytest.fixture(scope="module")
def analysis(example):
    settings = ["mesh.elements_per_turn=8", "mesh.section.rule=abramowitz9", "loading=[{to: {travel: 1}, steps: 1}]"]
    analysis = Analysis(read_case(example, settings), MPI.COMM_SELF)
    analysis.run()
    return analysis


def opened(analysis, result=None, **of_setup):
    """A result, opened from its files; some entries of the setup replaced."""
    result = result or analysis.result
    return run_of(replace(analysis.setup, **of_setup), result, origin(analysis.case))


def stepped(analysis, steps, phases=("travel 1 mm",), seats=MappingProxyType({})):
    """The result with other steps, each with the first step's seats and frame, and a snapshot for each phase."""
    result = analysis.result
    return replace(
        result,
        steps=tuple(steps),
        seats=tuple(replace(result.seats[0], step=one.number, **seats.get(one.number, {})) for one in steps),
        frames=result.frames[:1] * len(steps),
        snapshots=(result.snapshots[0], *(replace(result.snapshots[-1], name=name) for name in phases)),
    )


def a_step(number, phase=0, travel=1.0, force=9.0):
    return Step(number, phase, 1.0, 35.0 - travel, travel, force, 1, 1, 0, 0, 0, 0.0)


def laid_out(*panels):
    """The figure of panels, and its renderer."""
    figure = png_figure(panels)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    return figure, canvas.get_renderer()


@pytest.mark.parametrize("aside", [-150.0, 150.0])
def test_a_buckled_spring_is_whole_in_its_picture(analysis, tmp_path, aside):
    """It goes off its axis to one side."""
    if not ensure():
        pytest.skip("no display and no Xvfb")
    shots = []
    for shot in analysis.result.snapshots:
        z = shot.x[:, 2] / shot.x[-1, 2]
        shots.append(replace(shot, x=shot.x + np.stack([aside * z * (1.0 - z) * 4.0, 0.0 * z, 0.0 * z], axis=-1)))
    springs(tmp_path / "springs.png", opened(analysis, replace(analysis.result, snapshots=tuple(shots))))
    picture = imread(tmp_path / "springs.png")[LABELS:-BAR, :, :3]
    drawn = np.flatnonzero((picture < 0.99).any(axis=(0, 2)))
    assert drawn[0] > 10
    assert drawn[-1] < WIDTH - 10


def test_the_cross_section_is_round_and_has_its_colours_to_the_surface(analysis):
    """Its section points alone make a polygon, within which the maximum stress is not to be seen."""
    panel = shear_map(opened(analysis))
    stress, line = panel.traces[0]["z"], panel.traces[0]["x"]
    distance = np.hypot(*np.meshgrid(line, line))
    assert np.isfinite(stress[distance < 1.02 * analysis.setup.wire_radius[0]]).all()
    figure, _ = laid_out(panel)
    (shown,) = figure.axes[0].get_images()
    assert np.ma.allclose(shown.get_array(), np.ma.masked_invalid(panel.traces[-2]["z"]))  # the last state


@pytest.mark.parametrize("corner", [0.0, 0.4])
def test_a_section_with_points_on_straight_lines_has_its_map(corner):
    """Of rectangles with rounded corners matplotlib's triangulation was invalid, and no picture and no page were made.
    What is shown at a point of the section is the stress there."""
    wire = {"rectangle": {"width": 5.0, "height": 3.0, "corner": corner}}
    case = {
        "spring": {"wire": wire, "mean_diameter": 20.0, "turns": 1.0, "pitch": 6.0},
        "material": "elastic",
        "ends": "clamped",
        "mesh": {"elements_per_turn": 6, "section": {"kind": "curved"}},
        "accuracy": "none",
        "loading": [{"to": {"travel": 0.5}, "steps": 1}],
    }
    analysis = Analysis(check(case), MPI.COMM_SELF)
    analysis.run()
    run = opened(analysis)
    panel = shear_map(run)
    shown, y, z = panel.traces[-2], panel.traces[-1]["x"], panel.traces[-1]["y"]
    element = element_at(run.data["turn"].values, None)
    t12, t13 = (run.data["point_state"].sel(component=name).values[-1, element].mean(axis=0) for name in ("t12", "t13"))
    stress = inside(run).sign * np.cos(inside(run).angle) * (t13 * y - t12 * z) / np.hypot(y, z)
    pixels = RegularGridInterpolator((shown["y"], shown["x"]), shown["z"])
    inner = (np.abs(y) < 2.4) & (np.abs(z) < 1.4)  # farther out a pixel may lie beyond the edge
    found = pixels(np.stack([z, y], axis=1)[inner])
    assert np.abs(found - stress[inner]).max() < 0.03 * np.abs(stress).max()


def texts(figure, place=0):
    legend = figure.axes[place].get_legend()
    return [text.get_text() for text in legend.get_texts()]


@pytest.mark.parametrize(
    ("phases", "named", "dashed"),
    [
        (("travel 1 mm", "force 0 N") * 4, ["to travel 1 mm", "to force 0 N"], ["to travel 1 mm", "to force 0 N"]),
        (
            tuple(f"travel {k} mm" for k in range(8)),
            [*(f"to travel {k} mm" for k in range(6)), "and 2 more"],
            [*(f"to travel {k} mm" for k in range(4)), "and 4 more"],
        ),
        (("block", "block"), ["to block, first time", "to block, second time"], None),
    ],
)
def test_a_legend_names_each_target_once_and_so_many_at_most(analysis, phases, named, dashed):
    """Cycles make no legend of their own; equal phases of a short program are counted; what is not named is grey."""
    steps = [a_step(k + 1, k) for k in range(len(phases))]
    run = opened(analysis, stepped(analysis, steps, phases=phases), phases=phases)
    figure, _ = laid_out(characteristic(run))
    assert [text for text in texts(figure) if text.startswith(("to ", "and "))] == named
    for panel in (seats.eccentricity(run), seats.contact_length(run), seats.active_turns(run)):
        lines = [text for text in texts(laid_out(panel)[0]) if text.startswith(("to ", "and "))]
        assert lines == (named if dashed is None else dashed)
    colours = [trace["line"]["color"] for trace in characteristic(run).traces if trace.get("legendgroup")]
    assert (GREY in colours) == (len(set(phases)) > 6)


@pytest.mark.parametrize(("force", "word"), [(9.0, "Compressed"), (-9.0, "Pulled")])
def test_a_pulled_spring_is_not_called_pressed(analysis, force, word):
    """And the line of its initial rate goes where its force goes."""
    run = opened(analysis, stepped(analysis, [a_step(1, travel=force / 9.0, force=force)]))
    figure, _ = laid_out(characteristic(run))
    axes = figure.axes[0]
    assert axes.get_title().replace("\u00a0", " ").startswith(f"{word} with up to 9 N")
    (rate,) = (line for line in axes.get_lines() if str(line.get_label()).startswith("initial rate"))
    assert rate.get_ydata()[1] == pytest.approx(force, rel=1e-12)


def test_an_unloaded_spring_has_no_force_centre(analysis, tmp_path):
    """Its seats' records hold none: titles said `nan mm beside the axis`."""
    run = opened(analysis, stepped(analysis, [a_step(1, force=0.0)]))
    assert seats.force_centre(run) is None
    assert seats.eccentricity(run) is None


@pytest.mark.parametrize(("count", "named"), [(12, 12), (13, 9)])
def test_each_of_a_few_steps_is_named_beside_the_pressure(analysis, count, named):
    """The maximum force is that of one of them; of many steps, nine are."""
    steps = [a_step(k, travel=float(k), force=9.0 * k) for k in range(1, count + 1)]
    figure, _ = laid_out(seats.contact(opened(analysis, stepped(analysis, steps)), "bottom"))
    assert len(figure.axes[0].get_yticks()) == named


@pytest.mark.parametrize(("beyond", "title"), [(3, "At the maximum force 2.4 active turns"), (8, "Turns over travel")])
def test_active_turns_that_mean_nothing_are_counted_and_not_drawn(analysis, beyond, title):
    """Where the force hardly changes the quotient is any number; lines to it would cover the others."""
    steps = [a_step(k, travel=float(k), force=9.0 * k) for k in range(1, 9)]
    active = {step.number: {"active_turns": 4e3 if step.number == beyond else 2.4} for step in steps}
    panel = seats.active_turns(opened(analysis, stepped(analysis, steps, seats=active)))
    assert panel.title == title
    drawn = panel.traces[0]["y"]
    assert np.flatnonzero(np.isnan(drawn)).tolist() == [beyond - 1]
    assert np.nanmax(drawn) == 2.4
    most = 1.5 * analysis.setup.spring.turns
    assert texts(laid_out(panel)[0])[:2] == [f"active (beyond {most:g} turns: 1 of the steps)", "without contact"]


@pytest.mark.parametrize(("force", "text"), [(-300.0, "-300 N"), (300.0, "300 N"), (-1e-5, "0 N")])
def test_a_pulled_spring_has_a_negative_force_in_its_picture(analysis, force, text):
    first, last = analysis.result.snapshots
    first, last = replace(first, force=300.0), replace(last, force=force)
    run = opened(analysis, replace(analysis.result, snapshots=(first, last)))
    assert caption(run, 1).splitlines()[1] == f"{plain(last.height, 5)} mm, {text}"


def with_mode(analysis, direction):
    """A run with a mode that goes off as a clamped column does, in a direction across the axis."""
    x = analysis.rod.line.stations
    away = buckling.column(x[:, 2], x[0, 2], x[-1, 2])[:, None] * np.array([*direction, 0.0])
    return replace(analysis.result, mode=BucklingMode(1.0, 9.0, 0.5, x, away))


@pytest.mark.parametrize("direction", [(1.0, 0.0), (-0.6, 0.8)])
def test_a_buckling_mode_is_seen_in_its_plane_and_drawn(analysis, tmp_path, direction):
    result, turns = with_mode(analysis, direction), analysis.setup.turns
    across = buckling.plane(result.mode.displacement, turns)
    assert across == pytest.approx(direction, abs=1e-9)  # to the side where it goes
    height, aside = buckling.mode_axis(result.mode.x, result.mode.displacement, turns, across)
    ends = height[0], height[-1]
    assert aside.max() > 0.5
    assert ends[0] < ends[1]
    run = opened(analysis, result)
    write_png(tmp_path / "mode.png", [buckling.buckling_mode(run), buckling.buckling_axis(run)])
    assert (imread(tmp_path / "mode.png")[:, :, :3].min(axis=-1) < 0.9).mean() > 0.01


def test_a_checkpoint_keeps_the_buckling_mode(analysis, tmp_path):
    result = with_mode(analysis, (0.6, 0.8))
    checkpoint = Checkpoint(tmp_path, analysis.case)
    checkpoint.save(analysis.system.state, analysis.layout, analysis.program.position, result)
    found = checkpoint.load(MPI.COMM_SELF).result.mode
    for name, value in vars(result.mode).items():
        np.testing.assert_array_equal(getattr(found, name), value)


def test_all_figures_share_one_look():
    """What the file says is what they are drawn with; no figure brings parameters of its own."""
    import matplotlib as mpl

    from coilset.model.core.base.style import FILE, STYLE

    with mpl.rc_context():
        mpl.style.use(FILE)
        assert {name: mpl.rcParams[name] for name in STYLE} == dict(STYLE)
    repository = Path(__file__).resolve().parents[3]
    sources = [path for room in ("model", "verification") for path in (repository / room).rglob("*.py")]
    assert not [path for path in sources if "axes.spines" in path.read_text(encoding="utf-8")]


@pytest.mark.parametrize(
    ("summary", "said"),
    [
        ({"set_mm": 1.25}, "the spring sets 1.25 mm"),
        ({"set_mm": -1e-13}, "the spring sets 0 mm"),
        ({"set_mm": 0.006532, "estimated_set_error_mm": 0.0066}, "the spring sets 0.007 mm"),
        ({"set_mm": -0.177, "force_max_N": -9.0}, "the spring stays 0.177 mm longer"),
        (
            {"set_mm": None, "load_losses": [{"loss_percent": 17.05, "height_mm": 30.12}]},
            "the spring loses 17.05 % of its load at 30.12 mm",
        ),
    ],
)
def test_a_characteristic_names_what_becomes_of_the_spring(analysis, summary, said):
    run = opened(analysis)
    assert said in characteristic(replace(run, summary=run.summary | summary)).title


@pytest.mark.parametrize("size", [1.0, 1e3, 1e6])
def test_titles_and_legends_are_whole_and_clear_of_each_other(analysis, size):
    """Whatever the size of their numbers, and however long the names."""
    phases = ("travel 1 mm", "heat to 400 K in 1 h at constant height", *(f"travel {k} mm" for k in range(2, 6)))
    steps = [a_step(k + 1, k, force=1.23456 * size) for k in range(6)]
    result = stepped(analysis, steps, phases=phases)
    away = 0.0123456 * size
    ends = {end: replace(getattr(result.seats[0], end), eccentricity_mm=away) for end in ("bottom", "top")}
    run = opened(analysis, replace(result, seats=tuple(replace(one, **ends) for one in result.seats)), phases=phases)
    goodman_line = goodman.Line(470.0, 770.0, 1035.0, 1e7, "shot peened")
    for panels in (
        [characteristic(run)],
        [seats.force_centre(run), seats.eccentricity(run)],
        [seats.contact(run, "seat"), seats.contact_length(run), seats.active_turns(run)],
        [goodman_panel("EN 10270-2 VDSiCrV, 12.5 mm", goodman_line, goodman.Cycle(795.0, 1325.0), None)],
    ):
        figure, renderer = laid_out(*panels)
        boxes = [axes.title.get_window_extent(renderer) for axes in figure.axes if axes.get_title()]
        boxes += [axes.get_legend().get_window_extent(renderer) for axes in figure.axes if axes.get_legend()]
        assert len(boxes) > 1
        for box in boxes:
            assert figure.bbox.x0 <= box.x0
            assert box.x1 <= figure.bbox.x1
            assert figure.bbox.y0 <= box.y0
            assert box.y1 <= figure.bbox.y1
        assert not any(one.overlaps(other) for one, other in itertools.combinations(boxes, 2))


def test_drawing_loads_no_solver():
    """Nor MPI: where ranks solve, a process that draws would join them, and wait."""
    program = (
        "import sys; from coilset.model.tools.figures import pictures; [make() for make in pictures.PARTS.values()]"
    )
    program += "; print(*{'mpi4py.MPI', 'petsc4py.PETSc', 'dolfinx'}.intersection(sys.modules))"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.split() == []
