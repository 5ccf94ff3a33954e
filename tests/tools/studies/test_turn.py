"""`coilset solid`: a turn as solid and rod from one case, what it writes, and one line for what it refuses."""

import csv
import json

import pytest

from coilset.model.compose.examples import EXAMPLES
from coilset.model.core.base.errors import InputError
from coilset.model.core.case import read_case
from coilset.model.physics.solid.points import MaterialPoints
from coilset.model.tools.studies.turn import TurnAnalysis
from coilset.scripts.commands.solid import solid_case
from coilset.scripts.interrupt import Interrupt

CASE = EXAMPLES / "time" / "relaxation.yaml"
PRESETTING = EXAMPLES / "ck15_presetting.yaml"
SHORT = ["spring.mean_diameter=30", "spring.pitch=12", "mesh.section={radial: 4, angular: 8}", "accuracy=none"]
PROGRAM = "loading=[{to: {travel: 14}, steps: 2}, {hold: {hours: 10}, steps: 1}, {to: {force: 0}, steps: 1}]"


def test_a_turn_presses_creeps_and_is_released_like_the_rod(tmp_path):
    solid_case(CASE, tmp_path, settings=[*SHORT, PROGRAM], across=2, layers=12, pictures=False)
    summary = json.loads((tmp_path / "summary.json").read_text())
    rows = list(csv.DictReader((tmp_path / "history.csv").read_text().splitlines()))
    rod = summary["rod"]
    assert summary["complete"]
    assert [float(row["travel_mm"]) for row in rows[1:3]] == pytest.approx([14.0] * 2)
    assert float(rows[2]["hours"]) == pytest.approx(10.0)
    assert abs(float(rows[-1]["force_N"])) < 1e-4 * summary["force_max_N"]
    held = float(rows[-1]["travel_mm"])  # at which the ends are let go: one turn springs back by a part of its set
    assert 0.005 < abs(summary["set_mm"] - held) / held < 0.1
    assert summary["load_loss_percent"] > 0.5
    for name, tolerance in (
        ("rate_N_per_mm", 0.02),
        ("force_max_N", 0.02),
        ("set_mm", 0.03),
        ("load_loss_percent", 0.03),
        ("shear_inside_max_MPa", 0.06),
    ):
        assert rod[name] == pytest.approx(summary[name], rel=tolerance), name
    assert summary["residual_shear_inside_MPa"] < 0.0 < summary["shear_inside_max_MPa"]
    assert sorted(path.name for path in (tmp_path / "fields").glob("*.vtu"))[0] == "01_travel_14_mm.vtu"


def test_an_interrupted_run_keeps_its_steps(tmp_path, monkeypatch):
    def stop(_interrupt):
        raise KeyboardInterrupt

    monkeypatch.setattr(Interrupt, "check", stop)
    small = ["mesh={elements_per_turn: 4, section: {radial: 2, angular: 8}}", "loading=[{to: {travel: 2}, steps: 2}]"]
    with pytest.raises(KeyboardInterrupt):
        solid_case(PRESETTING, tmp_path, settings=[*small, "accuracy=none"], across=1, layers=4, pictures=False)
    summary = json.loads((tmp_path / "summary.json").read_text())
    assert not summary["complete"]
    assert summary["steps"] == len((tmp_path / "history.csv").read_text().splitlines()) - 1 == 1


@pytest.mark.parametrize(
    ("setting", "place"),
    [
        ("spring.wire={oval: {width: 5.5, height: 5.0}}", "wire"),
        ("spring.mean_diameter=[[0, 30], [2.5, 31]]", "mean_diameter"),
        ("loading=[{to: {travel: 18}}]", "loading.0.to"),
        ("loading=[{heat: {to: 373, minutes: 20}}]", "loading.0.heat"),
    ],
)
def test_what_the_solid_cannot_do_is_refused(setting, place, monkeypatch):
    monkeypatch.setattr(MaterialPoints, "__init__", lambda *_: pytest.fail("the solid was built"))
    with pytest.raises(InputError, match=place.replace(".", r"\.")):
        TurnAnalysis(read_case(CASE, [*SHORT, setting]))
