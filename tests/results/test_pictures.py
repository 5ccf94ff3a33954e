"""All that a picture shows is in it: springs of any shape, programs of many cycles, numbers of any size."""

import itertools
from dataclasses import replace
from pathlib import Path

import matplotlib.axes
import matplotlib.figure
import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.image import imread
from mpi4py import MPI

from coilset.model.base.style import QUARTERED, round_end
from coilset.model.case import read_case
from coilset.model.figures import figures, goodman_figure, seat_figures
from coilset.model.figures.buckling_figure import axis, buckling_mode, column, plane
from coilset.model.figures.display import ensure
from coilset.model.figures.rings import ROUND
from coilset.model.figures.scene import ABOVE, BAR, COLUMN, LABELS, MOST_HEIGHT, WIDTH, Arrangement, caption, springs
from coilset.model.results.files.checkpoint import Checkpoint
from coilset.model.results.records.labels import plain
from coilset.model.results.records.record import BucklingMode, Step
from coilset.model.results.records.summary import summarise
from coilset.model.run.analysis import Analysis
from coilset.model.standards import goodman


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


@pytest.mark.parametrize("aside", [-150.0, 150.0])
def test_a_buckled_spring_is_whole_in_its_picture(analysis, tmp_path, aside):
    """It goes off its axis to one side."""
    if not ensure():
        pytest.skip("no display and no Xvfb")
    shots = []
    for shot in analysis.result.snapshots:
        z = shot.x[:, 2] / shot.x[-1, 2]
        shots.append(replace(shot, x=shot.x + np.stack([aside * z * (1.0 - z) * 4.0, 0.0 * z, 0.0 * z], axis=-1)))
    springs(tmp_path / "springs.png", shots, analysis.setup)
    picture = imread(tmp_path / "springs.png")[LABELS:-BAR, :, :3]
    drawn = np.flatnonzero((picture < 0.99).any(axis=(0, 2)))
    assert drawn[0] > 10
    assert drawn[-1] < WIDTH - 10


def test_the_cross_section_is_round_and_reaches_the_surface(analysis, tmp_path, monkeypatch):
    """Its section points alone make a polygon, within which the maximum stress is not to be seen."""
    drawn, distances = matplotlib.axes.Axes.tricontourf, []

    def keep(axes, y, z, values, **style):
        distances.append(np.hypot(y, z))
        return drawn(axes, y, z, values, **style)

    monkeypatch.setattr(matplotlib.axes.Axes, "tricontourf", keep)
    figures.cross_section(tmp_path / "a.png", analysis.setup, analysis.result.snapshots[-1], None)
    assert len(distances) == 2
    for distance in distances:
        assert np.isclose(distance, analysis.setup.wire_radius[0], rtol=1e-12).sum() >= ROUND


def test_cycles_make_no_legend_of_their_own(analysis, monkeypatch):
    """Twenty phases to two targets have two lines in the legend; twenty targets have six, and how many more."""
    steps = tuple(Step(k, k, 1.0, 35.0 - k % 2, k % 2, 9.0 * (k % 2), 1, 1, 0, 0, 0, 0.0) for k in range(20))
    result, legends = replace(analysis.result, steps=steps, seats=analysis.result.seats * 20), []

    def keep(figure: matplotlib.figure.Figure, path):
        own = [axes.get_legend() for axes in figure.axes if axes.get_legend()]
        legends.append([[text.get_text() for text in one.get_texts()] for one in [*figure.legends, *own]])

    monkeypatch.setattr(figures, "save", keep)
    monkeypatch.setattr(seat_figures, "save", keep)
    for phases in (("travel 1 mm", "force 0 N") * 10, tuple(f"travel {k} mm" for k in range(20))):
        setup = replace(analysis.setup, phases=phases)
        figures.characteristic("", setup, result, summarise(setup, result))
        seat_figures.force_centre("", setup, result)
        seat_figures.seat_pressure("", setup, result)
    texts = [[text for text in one if text.startswith(("to ", "and "))] for figure in legends for one in figure]
    few, many = texts[:5], texts[5:]
    assert few == [["to travel 1 mm", "to force 0 N"], [], *[["to travel 1 mm", "to force 0 N"]] * 3]
    assert many[0] == [*(f"to travel {k} mm" for k in range(6)), "and 14 more"]
    assert many[2:] == [[*(f"to travel {k} mm" for k in range(4)), "and 16 more"]] * 3
    assert max(len(one) for figure in legends for one in figure) <= 10


@pytest.mark.parametrize(("force", "way"), [(9.0, "Compressed"), (-9.0, "Pulled")])
def test_a_pulled_spring_is_not_called_pressed(analysis, monkeypatch, force, way):
    """And the line of its initial rate goes where its force goes."""
    steps = (Step(1, 0, 1.0, 35.0 - force / 9.0, force / 9.0, force, 1, 1, 0, 0, 0, 0.0),)
    result, drawn = replace(analysis.result, steps=steps), []
    monkeypatch.setattr(figures, "save", lambda figure, path: drawn.append(figure.axes[0]))
    figures.characteristic("", analysis.setup, result, summarise(analysis.setup, result))
    (axes,) = drawn
    assert axes.get_title().startswith(f"{way} with up to 9 N")
    (rate,) = (line for line in axes.get_lines() if str(line.get_label()).startswith("initial rate"))
    assert rate.get_ydata()[1] == pytest.approx(force, rel=1e-12)


def test_the_force_centre_of_an_unloaded_spring_has_no_numbers(analysis, monkeypatch):
    """Its seats' records hold none: titles said `nan mm beside the axis`."""
    titles = []
    monkeypatch.setattr(seat_figures, "save", lambda figure, path: titles.extend(a.get_title() for a in figure.axes))
    result, none = analysis.result, {"centre_x_mm": np.nan, "centre_y_mm": np.nan, "eccentricity_mm": np.nan}
    seats = [replace(one, bottom=replace(one.bottom, **none), top=replace(one.top, **none)) for one in result.seats]
    free = replace(result, steps=tuple(replace(one, force_N=0.0) for one in result.steps), seats=tuple(seats))
    seat_figures.force_centre("", analysis.setup, free)
    assert titles == ["No force acts on the seats", ""]


def test_each_of_a_few_steps_is_named_beside_the_pressure(analysis, monkeypatch):
    """The greatest force is that of one of them; of many steps, nine are."""
    drawn = []
    monkeypatch.setattr(seat_figures, "save", lambda figure, path: drawn.append(figure.axes[0]))
    for count in (12, 13):
        steps = tuple(Step(k, 0, 1.0, 35.0 - k, float(k), 9.0 * k, 1, 1, 0, 0, 0, 0.0) for k in range(1, count + 1))
        seats = analysis.result.seats[:1] * count
        seat_figures.seat_pressure("", analysis.setup, replace(analysis.result, steps=steps, seats=seats))
    assert [len(axes.get_yticks()) for axes in drawn] == [12, 9]


@pytest.mark.parametrize(("beyond", "title"), [(3, "Maximum force: 2.4 active turns"), (8, "Turns over travel")])
def test_active_turns_that_mean_nothing_are_told_and_not_drawn(analysis, monkeypatch, beyond, title):
    """Where the force hardly changes the quotient is any number; lines to it would cover the others."""
    steps = tuple(Step(k, 0, 1.0, 35.0 - k, float(k), 9.0 * k, 1, 1, 0, 0, 0, 0.0) for k in range(1, 9))
    seats = tuple(
        replace(analysis.result.seats[0], active_turns=4e3 if step.number == beyond else 2.4) for step in steps
    )
    drawn = []
    monkeypatch.setattr(seat_figures, "save", lambda figure, path: drawn.append(figure.axes[3]))
    seat_figures.seat_pressure("", analysis.setup, replace(analysis.result, steps=steps, seats=seats))
    (axes,) = drawn
    assert axes.get_title().startswith(title)
    active = next(line.get_ydata() for line in axes.get_lines() if len(line.get_ydata()) == len(steps))
    assert np.flatnonzero(np.isnan(active)) == [beyond - 1]
    assert np.nanmax(active) == 2.4
    words = [text.get_text() for text in axes.get_legend().get_texts()]
    most = 1.5 * analysis.setup.spring.turns
    assert words[:2] == [f"active (beyond {most:g} turns: 1 of the steps)", "without contact"]


@pytest.mark.parametrize(("force", "told"), [(-300.0, "-300 N"), (300.0, "300 N"), (-1e-5, "0 N")])
def test_a_pulled_spring_bears_less_than_nothing_in_its_picture(analysis, force, told):
    shot = replace(analysis.result.snapshots[-1], force=force)
    assert caption(shot, 300.0).splitlines()[1] == f"{plain(shot.height, 5)} mm, {told}"


def with_mode(analysis, direction):
    """A run with a mode that goes off as a clamped column does, in a direction across the axis."""
    x = analysis.rod.line.stations
    away = column(x[:, 2], x[0, 2], x[-1, 2])[:, None] * np.array([*direction, 0.0])
    return replace(analysis.result, mode=BucklingMode(1.0, 9.0, 0.5, x, away))


@pytest.mark.parametrize("direction", [(1.0, 0.0), (-0.6, 0.8)])
def test_a_buckling_mode_is_seen_in_its_plane_and_drawn(analysis, tmp_path, direction):
    result, turns = with_mode(analysis, direction), analysis.setup.turns
    across = plane(result.mode, turns)
    assert across == pytest.approx(direction, abs=1e-9)  # to the side where it goes
    height, aside = axis(result.mode, turns, across)
    ends = height[0], height[-1]
    assert aside.max() > 0.5
    assert ends[0] < ends[1]
    buckling_mode(tmp_path / "mode.png", analysis.setup, result, summarise(analysis.setup, result))
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

    from coilset.model.base.style import FILE, STYLE

    with mpl.rc_context():
        mpl.style.use(FILE)
        assert {name: mpl.rcParams[name] for name in STYLE} == dict(STYLE)
    repository = Path(__file__).resolve().parents[2]
    sources = [path for room in ("model", "verification") for path in (repository / room).rglob("*.py")]
    assert not [path for path in sources if "axes.spines" in path.read_text(encoding="utf-8")]


def drawn(monkeypatch, module, draw):
    """The figure that a function would save, laid out."""
    kept = []
    monkeypatch.setattr(module, "save", lambda figure, path: kept.append(figure))
    draw()
    FigureCanvasAgg(kept[0]).draw()
    return kept[0]


def test_more_phases_than_colours_are_grey(analysis, monkeypatch):
    """A colour of the legend belongs to one of its names, which say what is done."""
    steps = tuple(Step(k, k, 1.0, 35.0 - k, k, 9.0, 1, 1, 0, 0, 0, 0.0) for k in range(8))
    phases = ("travel 1 mm", "heat to 400 K in 1 h at constant height", *(f"travel {k} mm" for k in range(2, 8)))
    setup, result = replace(analysis.setup, phases=phases), replace(analysis.result, steps=steps)
    figure = drawn(
        monkeypatch,
        figures,
        lambda: figures.characteristic("", setup, result, summarise(setup, result) | {"load_loss_percent": 12.34}),
    )
    colours = [
        line.get_color() for line in figure.axes[0].get_lines()[:17:2]
    ]  # curves; the dots of their steps between them
    assert len(set(colours[:6])) == 6
    assert set(colours[6:]) == {figures.REST}
    texts = [text.get_text() for text in figure.legends[0].get_texts()]
    assert texts[:2] == ["to travel 1 mm", "heat to 400 K in 1 h at constant height"]
    title, legend = figure.axes[0].title.get_window_extent(), figure.legends[0].get_window_extent()
    assert all(figure.bbox.x0 <= box.x0 and box.x1 <= figure.bbox.x1 for box in (title, legend))
    assert not title.overlaps(legend)


@pytest.mark.parametrize(
    ("summary", "said"),
    [
        ({"set_mm": 1.25}, "the spring sets 1.25 mm"),
        ({"set_mm": -1e-13}, "the spring sets 0 mm"),
        ({"set_mm": -0.177, "force_max_N": -9.0}, "the spring stays 0.177 mm longer"),
        ({"set_mm": None, "load_loss_percent": 17.05}, "the spring loses 17.05 % of its load"),
    ],
)
def test_a_characteristic_says_what_becomes_of_the_spring(analysis, monkeypatch, summary, said):
    setup, result = analysis.setup, analysis.result
    found = summarise(setup, result) | summary
    figure = drawn(monkeypatch, figures, lambda: figures.characteristic("", setup, result, found))
    assert said in figure.axes[0].get_title().replace("\n", " ")


def test_the_title_of_a_goodman_diagram_is_whole(monkeypatch):
    endured = goodman.Line(470.0, 770.0, 1035.0, 1e7, "shot peened")
    figure = drawn(
        monkeypatch,
        goodman_figure,
        lambda: goodman_figure.draw("", "EN 10270-2 VDSiCrV, 12.5 mm", endured, goodman.Cycle(795.0, 1325.0), None),
    )
    title = figure.axes[0].title.get_window_extent()
    assert figure.bbox.x0 <= title.x0
    assert title.x1 <= figure.bbox.x1


@pytest.mark.parametrize("size", [1.0, 1e3, 1e6])
def test_titles_are_whole_and_clear_of_each_other(analysis, monkeypatch, size):
    """Whatever the size of their numbers."""
    step = replace(analysis.result.steps[0], force_N=1.23456 * size)
    away = 0.0123456 * size
    seats = tuple(
        replace(one, bottom=replace(one.bottom, eccentricity_mm=away), top=replace(one.top, eccentricity_mm=away))
        for one in analysis.result.seats
    )
    result, boxes = replace(analysis.result, steps=(step,), seats=seats), []

    def keep(figure: matplotlib.figure.Figure, path):
        canvas = FigureCanvasAgg(figure)
        canvas.draw()
        titles = [axes.title.get_window_extent(canvas.get_renderer()) for axes in figure.axes if axes.get_title()]
        boxes.append((figure.bbox, titles))

    monkeypatch.setattr(figures, "save", keep)
    monkeypatch.setattr(seat_figures, "save", keep)
    summary = summarise(analysis.setup, result)
    figures.characteristic("", analysis.setup, result, summary)
    seat_figures.force_centre("", analysis.setup, result)
    seat_figures.seat_pressure("", analysis.setup, result)
    assert [len(titles) for _, titles in boxes] == [1, 2, 4]
    for whole, titles in boxes:
        assert all(whole.x0 <= box.x0 and box.x1 <= whole.x1 and box.y1 <= whole.y1 for box in titles)
        assert not any(one.overlaps(other) for one, other in itertools.combinations(titles, 2))
