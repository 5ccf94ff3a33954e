"""The page of a run: whole, self-contained, and with the numbers of summary.json."""

import base64
import gzip
import json
import os
import re
import resource
import shutil
import signal
from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI

from coilset.model.compose.load_history import LoadHistory
from coilset.model.core.base.errors import InputError, SolveError
from coilset.model.core.material import library
from coilset.model.core.results.files.opened import open_run
from coilset.model.tools.design.conditions import SIZE_OF_ZERO
from coilset.model.tools.figures.animation import animate
from coilset.model.tools.figures.panels.characteristic import NAMED, characteristic
from coilset.model.tools.figures.panels.material_curves import material_curve
from coilset.model.tools.figures.panels.phases import phases
from coilset.model.tools.figures.panels.seats import force_centre
from coilset.model.tools.figures.series import write_series
from coilset.model.tools.figures.wire_surface import closed, frames, inside, shear_around, tubes
from coilset.model.tools.report import design_page
from coilset.model.tools.report.render import GLOSSARY
from coilset.model.tools.report.run_page import CHAPTERS, write_report
from coilset.scripts.commands.report import report
from coilset.scripts.commands.sheet import Options, sheet
from coilset.scripts.commands.solve import solve

MOST = 15e6  # bytes of a page


@pytest.fixture(scope="module")
def page(folder):
    return write_report(open_run(folder)).read_text(encoding="utf-8")


def part(page, name):
    return re.search(rf'<script type="[^"]*" id="{name}">(.*?)</script>', page, re.S).group(1)


def data(page):
    return json.loads(gzip.decompress(base64.b64decode(part(page, "data"))))


def test_it_stands_by_itself(page):
    """No address is asked for, whatever the library's own texts say."""
    assert len(page.encode()) < MOST
    own = page.replace(part(page, "plotly"), "")
    assert not re.findall(r'(?:src|href)="(?!#|data:image)', own)
    assert b"Plotly" in gzip.decompress(base64.b64decode(part(page, "plotly")))


def test_each_figure_is_there_with_a_text(page):
    figures = data(page)["figures"]
    # rate, error, buckling and side load are not of every run
    assert len(figures) >= sum(len(draw) for _, draw in CHAPTERS) - 11
    for name in figures:
        assert re.search(rf'role="img" aria-label="[^"]{{30,}}" data-figure="{name}"', page), name


def test_numbers_are_those_of_the_summary(folder, page):
    """Other numbers in the summary, and the same fields beside it, give a page with these numbers and no older one."""
    path = folder / "summary.json"
    before = path.read_text()
    other = {
        "set_mm": 1.234567,
        "free_length_after_mm": 23.4567,
        "free_length_before_mm": 24.6913,
        "force_max_N": 345.67,
        "residual_shear_inside_MPa": -45.678,
        "residual_shear_max_MPa": 59.64,
        "shear_inside_max_MPa": 321.4,
        "rate_N_per_mm": 5.6789,
        "block_height_mm": 6.789,
        "rate_30_70_after_N_per_mm": 7.8912,
        "estimated_rate_error_N_per_mm": 0.0456,
        "estimated_force_error_N": 0.089123,
        "estimated_set_error_mm": 0.0123,
        "estimated_residual_shear_inside_error_MPa": 0.267,
        "steps": 91,
        "evaluations": 912,
    }
    shown = [
        "1.235 ± 0.013 mm",
        "23.457 ± 0.013 mm",
        "345.67 ± 0.09 N",
        "5.68 ± 0.05 N/mm",
        "7.8912 N/mm",
        "−45.7 ± 0.3 MPa",
        "59.6 MPa",
        "321.4 MPa",
        "6.789 mm",
    ]
    told = [
        "5 % of the free length",
        "24.691 mm before",
        "largest part of the errors ±: ",
        "Compressed with up to 345.7 N, the spring sets 1.235 mm",
        "The rate begins at 5.679 N/mm",
        "−46 MPa of shear remain",
        "91 steps took 912 evaluations",
        "estimated to be within 0.089 N",
    ]
    assert not any(text in page for text in (*shown, *told) if not text.startswith("largest"))
    try:
        path.write_text(json.dumps({**json.loads(before), **other}))
        changed = write_report(open_run(folder)).read_text(encoding="utf-8")
    finally:
        path.write_text(before)
    assert re.findall(r"<dd><strong>([^<]*)</strong>", changed) == shown
    assert [text for text in told if text not in changed] == []


def test_words_of_the_glossary_are_explained(page):
    for word in ("set", "initial rate", "residual shear stress"):
        assert GLOSSARY[word].replace("'", "&#39;") in page


def test_the_makers_sheet_is_that_of_the_command(folder, page, capsys):
    """Each value and what the run found, as `coilset sheet` prints them."""
    sheet(folder.parent / "spring.yaml", Options(folder, pictures=False))
    printed = capsys.readouterr().out.splitlines()
    rows = re.findall(r'<th scope="row">([^<]*)</th><td>([^<]*)</td><td>([^<]*)</td>', page)
    assert len(rows) > 20
    for label, *numbers in rows:
        (line,) = (one for one in printed if one.strip().startswith(f"{label} "))
        for number in filter(None, numbers):
            assert float(number.split()[0].replace("−", "-").replace(",", "")) in numbers_of(line), (label, number)


def numbers_of(line):
    return [float(word) for word in re.findall(r"-?\d+\.?\d*(?:e[+-]\d+)?", line)]


def test_the_tube_is_round_the_wire(folder):
    """Each point of the surface is a wire radius from the centre line, the first of a ring towards the axis."""
    run = open_run(folder)
    places, stress = tubes(run, frames(run), 81)
    centre = places[:, :, :-1].mean(axis=2)
    assert np.linalg.norm(places - centre[:, :, None], axis=-1) == pytest.approx(2.5, rel=1e-9)
    assert np.all(np.hypot(*np.moveaxis(places[:, :, 0, :2], -1, 0)) < np.hypot(*np.moveaxis(centre[..., :2], -1, 0)))
    assert np.array_equal(stress[:, :, 0], stress[:, :, -1])
    ends, shown = closed(places, stress)
    assert ends.shape[1] == shown.shape[1] == 83
    assert np.ptp(ends[:, [0, -1]], axis=2) == pytest.approx(0.0, abs=1e-12)  # a point, in the middle of the ring
    assert np.linalg.norm(ends[:, [0, -1]] - places[:, [0, -1]], axis=-1) == pytest.approx(2.5, rel=1e-9)
    assert stress[4].min() > 0.0 > stress[-1].min()  # with the load at block; against it, somewhere, after


def test_shear_with_the_load_is_positive_in_a_left_handed_coil(folder):
    """A mirror image has the mirrored wire, and the opposite shear in its sections, whose axis y points inwards."""
    run = open_run(folder)
    mirrored = run.data.assign(position=run.data["position"] * [1.0, -1.0, 1.0], surface=-run.data["surface"])
    case = {"spring": {"file": "measured.csv"}}  # which does not say the hand
    left = replace(run, data=mirrored, summary={**run.summary, "origin": {"case": case}})
    assert np.array_equal(shear_around(left), shear_around(run))
    coiled = replace(left, summary={**left.summary, "section_kind": "plane"})  # its past gives y the same direction
    assert inside(coiled) == inside(left)


def test_a_law_that_never_yields_has_no_curve(folder):
    run = open_run(folder)
    assert material_curve(run) is not None
    elastic = library.load("elastic").data.model_dump_json()
    assert material_curve(replace(run, data=run.data.assign_attrs(material_file=elastic))) is None


def test_an_unloaded_spring_has_no_force_centre(folder):
    run = open_run(folder)
    assert force_centre(run) is not None
    assert force_centre(replace(run, data=run.data.assign(force_N=0.0 * run.data["force_N"]))) is None


def test_a_law_that_warms_out_of_its_table_has_no_curve(folder):
    """A spring at the last temperature of its table that stays elastic has a page all the same."""
    run = open_run(folder)
    warming = library.load("creeping").data.model_dump(mode="json", exclude={"creep"})
    warming["heating"] = {"dissipated": 0.9, "density": 7.85e-9, "specific_heat": 4.6e8}
    warm = replace(run, data=run.data.assign_attrs(material_file=json.dumps(warming)))
    assert material_curve(warm) is not None
    case = {**run.case, "temperature": 573.15}
    hot = replace(warm, summary={**run.summary, "origin": {**run.summary["origin"], "case": case}})
    assert material_curve(hot) is None


def test_a_law_of_several_temperatures_is_drawn_at_that_of_the_spring(folder):
    """The creeping wire is softer at 373 K, by its G at the first readings."""
    run = open_run(folder)
    law = library.load("creeping")
    data = run.data.assign_attrs(material_file=law.data.model_dump_json())
    slopes = []
    for temperature in (None, 373.15):
        case = run.case | {"temperature": temperature}
        panel = material_curve(replace(run, data=data, summary={**run.summary, "origin": {"case": case}}))
        assert f" at {temperature or law.reference_temperature:g} K: twisted" in panel.title
        slopes.append(100.0 * panel.traces[0]["y"][3] / panel.traces[0]["x"][3])
    assert slopes == pytest.approx([law.moduli(T)[1] for T in (law.reference_temperature, 373.15)], rel=1e-3)
    assert " K" not in material_curve(run).title  # of constants for one temperature


def test_each_step_can_be_slid_to(folder, page):
    """As many moments as steps and the start, where phases end those of the snapshots, which are kept apart."""
    run = open_run(folder)
    shown = frames(run)
    assert len(shown.labels) == run.summary["steps"] + 1 == len(data(page)["figures"]["spring"]["frames"])
    height = [float(label.split(": ")[1].split()[0]) for label in shown.labels[1:]]
    assert height == pytest.approx(run.data["travel_mm"].values, rel=1e-3, abs=1e-3)
    around = shear_around(run).mean(axis=2)
    for moment, snapshot in ((4, 1),):  # the last one is of the spring that nothing holds
        assert np.array_equal(shown.x[moment], run.data["position"].values[snapshot])
        assert shown.shear[moment] == pytest.approx(around[snapshot], rel=1e-6, abs=1e-4)  # single precision
    few = frames(run, 4)
    assert [label.split(":")[0] for label in few.labels] == [
        "start",
        "step 1, to block",
        "step 4, to block",
        "step 6, to force 0 N",
    ]


def test_first_and_second_loading_are_distinguished(folder):
    """Phases of one name are numbered; where there is no second loading, the page says how to get it."""
    run = open_run(folder)
    assert [phase.label for phase in phases(run, NAMED)] == ["to block", "to force 0 N"]
    assert "second loading, add a phase to the load program, such as “- to: block”" in characteristic(run).note
    pulled = replace(run, summary=run.summary | {"force_max_N": -306.22})
    assert "such as “- to: {force: -306.22}”" in characteristic(pulled).note  # `to: block` is refused for hooks
    same = replace(run, data=run.data.assign_coords(snapshot=["start", "block", "block"]))
    assert [phase.label for phase in phases(same, NAMED)] == ["to block, first time", "to block, second time"]


def test_a_folder_without_a_run_is_refused(tmp_path):
    with pytest.raises(InputError, match="no results of a run"):
        open_run(tmp_path)
    (tmp_path / "summary.json").write_text("{")
    for name in ("points.nc", "history.csv", "seats.csv"):
        (tmp_path / name).touch()
    with pytest.raises(InputError, match=r"summary\.json: is not readable"):
        open_run(tmp_path)


def test_a_run_that_ends_before_its_first_step_has_no_pictures_and_no_page(folder, tmp_path, monkeypatch):
    def fail(_):
        raise SolveError("the wound coils find no equilibrium")

    class Never:
        def draw(self, _):
            raise AssertionError

    monkeypatch.setattr(LoadHistory, "settle_coils", fail)
    with pytest.raises(SolveError, match=r"^the wound coils find no equilibrium$"):
        solve(folder.parent / "spring.yaml", tmp_path, False, [], drawings=Never(), comm=MPI.COMM_SELF)
    for command in (report, lambda where: animate(open_run(where)), lambda where: write_series(open_run(where))):
        with pytest.raises(InputError, match="the run has no steps: it ended before its first one"):
            command(tmp_path)


@pytest.mark.parametrize(
    ("files", "message"),
    [
        (("summary.json", "history.csv"), "holds a slice, not a run: a slice has neither page nor modes"),
        (("summary.json", "nest.csv"), "holds a nest, not a run"),
        (("sweep.nc",), "holds a sweep, not a run"),
    ],
)
def test_results_of_other_commands_are_named(tmp_path, files, message):
    for name in files:
        (tmp_path / name).touch()
    with pytest.raises(InputError, match=f": {message}$"):
        open_run(tmp_path)


def test_a_folder_in_the_way_of_the_page_is_seen_before(tmp_path):
    (tmp_path / "report.html").mkdir()
    with pytest.raises(InputError, match="cannot be written: there is a folder of this name"):
        report(tmp_path)


@pytest.mark.parametrize("name", ["contacts", "seat_height_mm", "bottom_length_mm"])
def test_results_that_lack_a_column_are_one_line(folder, tmp_path, name):
    """Found by the fuzzer: a figure meets what is missing, and so does nothing before it."""
    shutil.copytree(folder, tmp_path / "damaged", ignore=shutil.ignore_patterns("report.html"))
    for path in (tmp_path / "damaged").glob("*.csv"):
        path.write_text(path.read_text().replace(name, "x", 1))
    with pytest.raises(InputError, match=f"damaged: is not readable: No variable named '{name}'"):
        report(tmp_path / "damaged")
    assert not (tmp_path / "damaged" / "report.html").exists()


def test_a_summary_of_other_entries_is_one_line(folder, tmp_path):
    shutil.copytree(folder, tmp_path / "damaged")
    summary = json.loads((folder / "summary.json").read_text())
    (tmp_path / "damaged" / "summary.json").write_text(json.dumps(summary | {"warnings": ["a text"]}))
    with pytest.raises(InputError, match="is not readable: it is damaged, or was written by another version"):
        report(tmp_path / "damaged")


def test_a_kill_while_it_is_written_leaves_the_page_before(folder, page):
    """The kernel kills the process in the midst of the file; the next page is whole, and removes what lay beside it."""
    path = folder / "report.html"
    path.write_text("the page before")
    run = open_run(folder)
    child = os.fork()
    if child == 0:
        signal.signal(signal.SIGXFSZ, signal.SIG_DFL)
        resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, resource.RLIM_INFINITY))
        write_report(run)
        os._exit(0)
    assert os.WTERMSIG(os.waitpid(child, 0)[1]) == signal.SIGXFSZ
    assert path.read_text() == "the page before"
    (left,) = folder.glob(".*")
    os.utime(left, (0, 0))  # as if it had happened some time ago
    write_report(open_run(folder))
    assert path.read_text(encoding="utf-8") == page
    assert not list(folder.glob(".*"))


def test_a_design_shows_what_it_found_even_of_a_finer_run(tmp_path, folder):
    """`solve` runs a case again with a finer mesh where its accuracy requires that; the spring is the same."""
    (tmp_path / design_page.FOUND).symlink_to(folder)
    case = open_run(folder).case
    coarser = case | {"mesh": case["mesh"] | {"elements_per_turn": 4.0}}
    assert design_page.found_run(tmp_path, {"origin": {"case": coarser}}) is not None
    other = case | {"spring": case["spring"] | {"turns": 3.5}}
    assert design_page.found_run(tmp_path, {"origin": {"case": other}}) is None


def test_a_design_shows_how_far_zero_was_missed():
    """Relative to no target, but to a size of its own."""
    condition = {"name": "such_that.set_mm", "words": "set", "unit": "mm", "kind": "equals", "target": 0.0}
    design = {"conditions": [condition | {"height_mm": None}], "met": False, "evaluations": 2}
    panel = design_page.search(design, [{"values": [0.5]}, {"values": [None]}])
    np.testing.assert_array_equal(panel.traces[0]["y"], [0.5 / SIZE_OF_ZERO, np.nan])
