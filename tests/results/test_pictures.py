"""All that a picture shows is in it: springs of any shape, programs of many cycles, numbers of any size."""

from dataclasses import replace

import matplotlib.figure
import pytest
from mpi4py import MPI

from coilset.model.analysis import Analysis
from coilset.model.case import read_case
from coilset.model.results import figures
from coilset.model.results.record import Step
from coilset.model.results.scene import ABOVE, BAR, COLUMN, LABELS, MOST_HEIGHT, WIDTH, Frame, scale_end
from coilset.model.results.summary import summarise


@pytest.mark.parametrize("springs", [1, 2, 4])
@pytest.mark.parametrize(("across", "tall"), [(45.0, 35.0), (0.55, 0.6), (45.0, 800.0), (400.0, 10.0), (20.0, 160.0)])
def test_springs_are_whole_in_their_picture(across, tall, springs):
    frame = Frame.of(across, tall, springs)
    assert frame.scale * (frame.column * (springs - 1) + across) < WIDTH
    assert frame.scale * (tall + ABOVE * across) <= frame.height - LABELS - BAR + 1
    assert frame.height <= MOST_HEIGHT + 1
    assert frame.scale * frame.column >= min(COLUMN, WIDTH / springs) - 1e-9  # labels do not overlap
    assert frame.column > across


@pytest.mark.parametrize(("greatest", "end"), [(197.3, 200.0), (65.8, 80.0), (2.0, 2.0), (0.0, 1.0), (3.1e-7, 4e-7)])
def test_scales_end_on_few_digits(greatest, end):
    assert scale_end(greatest) == pytest.approx(end)


def test_cycles_make_no_legend_of_their_own(example, tmp_path, monkeypatch):
    """Twenty phases to two targets have two lines in the legend; twenty targets have six, and how many more."""
    settings = ["mesh.elements_per_turn=8", "mesh.section.rule=abramowitz9", "loading=[{to: {travel: 1}, steps: 1}]"]
    analysis = Analysis(read_case(example, settings), MPI.COMM_SELF)
    analysis.run()
    steps = tuple(Step(k, k, 1.0, 35.0 - k % 2, k % 2, 9.0 * (k % 2), 1, 1, 0, 0, 0, 0.0) for k in range(20))
    result, legends = replace(analysis.result, steps=steps), []

    def keep(figure: matplotlib.figure.Figure, path):
        legends.append([text.get_text() for text in figure.axes[0].get_legend().get_texts()])

    monkeypatch.setattr(figures, "save", keep)
    for phases in (("travel 1 mm", "force 0 N") * 10, tuple(f"travel {k} mm" for k in range(20))):
        figures.characteristic("", replace(analysis.setup, phases=phases), result, summarise(analysis.setup, result))
    few, many = ([text for text in one if text.startswith(("to ", "and "))] for one in legends)
    assert few == ["to travel 1 mm", "to force 0 N"]
    assert many == [*(f"to travel {k} mm" for k in range(6)), "and 14 more"]
