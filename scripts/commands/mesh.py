"""`coilset mesh`: the data of a case's spring, its drawing, and its mesh as a file."""

import os
from collections.abc import Sequence
from pathlib import Path

from mpi4py import MPI

from coilset.meshes.springs.spring import Spring
from coilset.model.core.base.errors import CoilsetError, InputError, naming
from coilset.model.core.case import UnloadedCase, read_case
from coilset.model.core.case.loading import is_turned
from coilset.model.core.case.material import case_elastic, case_law
from coilset.model.core.results.files.folder import DRAWN, make, refuse_to_replace, whole
from coilset.model.tools.checks.check import Verdict
from coilset.model.tools.checks.table import checks
from coilset.model.tools.limits.spring_warnings import spring_warnings
from coilset.model.tools.sheet.spring_data import spring_data
from coilset.scripts.terminal.console import Console
from coilset.scripts.terminal.target import results_folder


def mesh(
    case_file: str | Path,
    out: str | Path | None = None,
    force: bool = False,
    settings: Sequence[str] = (),
    write: Sequence[str] = (),
    pictures: bool = True,
    height: float | None = None,
) -> None:
    """Print the data of a spring, draw it, and write its mesh; see `coilset mesh --help`.

    Raises:
        InputError: wrong input, or files that exist already.
    """
    if MPI.COMM_WORLD.rank:
        return  # too little work to be worth distributing
    console = Console()
    case = read_case(case_file, settings, UnloadedCase)
    if write:
        from coilset.meshes.drawings.export import check_format, write_mesh

        for path in write:
            if not _is_body(path):
                check_format(path)
    folder = results_folder(out, Path(case_file).stem)
    with naming(case_file):
        spring = case.spring.build()
        turned = is_turned(case, spring)
        turns = spring.stations(case.mesh.elements_per_turn, case.mesh.sagitta)
        elastic = case_elastic(case, case_law(case, spring))
        drawn, spring = spring, spring if height is None else spring.at_height(height)
    refuse_to_replace([folder / name for name in DRAWN if pictures] + [Path(path) for path in write], force)
    rows = ((label, f"{value} {unit}".strip()) for label, value, unit in spring_data(spring, elastic, turned))
    console.pairs([*rows, ("elements", str(len(turns) - 1))])
    for warning in spring_warnings(spring):
        console.warn(warning.message)
    for one in checks(case, drawn):
        if one.verdict is Verdict.NOT_PERMITTED:
            console.warn(one.message, "not permitted")
    for path in write:
        make(Path(path).parent)
        try:
            with whole(path) as partial:
                if _is_body(path):
                    from coilset.meshes.drawings.step import step

                    partial.write_bytes(step(spring)[0])
                else:
                    write_mesh(spring, turns, partial)
        except InputError as error:
            raise InputError(error.problem, error.place, path) from None
        console.say(f"{'solid body' if _is_body(path) else 'mesh'} in {path}")
    if pictures:
        make(folder)
        _draw(spring, folder, Path(case_file).stem, console)
        console.say(f"pictures in {folder}{os.sep}")


def _is_body(path: str | Path) -> bool:
    return Path(path).suffix.lower() == ".step"


def _draw(spring: Spring, out: Path, name: str, console: Console) -> None:
    import matplotlib as mpl

    from coilset.meshes.drawings import drawing, view
    from coilset.model.core.base.style import STYLE
    from coilset.model.core.results.records.labels import plain
    from coilset.model.tools.figures import display
    from coilset.model.tools.figures.pictures import not_drawn
    from coilset.model.tools.figures.png import save

    def side_view(path: Path) -> None:
        size = f"{plain(spring.turns)} turns, {plain(spring.free_length)} mm long"
        with mpl.rc_context(STYLE):
            save(drawing.drawing(spring, f"{name}: {size}"), path)

    def in_3d(path: Path) -> None:
        if not display.ensure():
            console.warn(f"{DRAWN[1]} is not drawn: there is no display and no Xvfb")
            return
        with whole(path) as partial:
            view.picture(spring, partial)

    for file, draw in zip(DRAWN, (side_view, in_3d), strict=True):
        try:
            draw(out / file)
        except (CoilsetError, OSError):  # of writing it
            raise
        except Exception as error:  # of the libraries that draw
            console.warn(not_drawn(f"{file} is not drawn", error))
