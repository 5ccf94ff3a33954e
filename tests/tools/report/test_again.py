"""The case on a page is complete without its author's folders."""

import yaml
from mpi4py import MPI

from coilset.model.core.case import check, read_case
from coilset.model.core.material import library
from coilset.model.core.results.files.opened import open_run
from coilset.model.tools.report.run_page import complete
from coilset.scripts.commands.solve import solve

PROGRAM = "loading=[{to: {travel: 2}, steps: 1}]"
SHORT = ["mesh.elements_per_turn=8", "mesh.section.rule=abramowitz9", "accuracy=none", PROGRAM]


def test_the_material_stands_beside_the_case(example, tmp_path):
    """It was named by the absolute path of its author."""
    steel = tmp_path / "author" / "steel.yaml"
    steel.parent.mkdir()
    steel.write_bytes((library.FOLDER / "ck15.yaml").read_bytes())
    solve(example, tmp_path / "run", False, [*SHORT, f"material={steel}"], comm=MPI.COMM_SELF)
    case, files = complete(open_run(tmp_path / "run"))
    assert str(tmp_path) not in yaml.safe_dump(case) + "".join(files.values())
    (tmp_path / "again.yaml").write_text(yaml.safe_dump(case))
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    steel.unlink()
    again = read_case(tmp_path / "again.yaml")
    assert again.material == str(tmp_path / "steel.yaml")
    assert library.load(again.material).content() == library.load("ck15").content()
    assert check(again.model_dump()).spring == again.spring
