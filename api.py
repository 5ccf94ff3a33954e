"""coilset from Python: a case, its run and results, the slice, sweeps, designs and materials.

These names, their arguments and units are stable; modules under `coilset.model` may change with every version.
Units are N, mm, MPa and K. Wrong input raises `InputError` in one line; a run that finds no equilibrium raises
`SolveError`, whose `result` holds the steps before.

>>> from coilset.api import Case, solve
>>> case = Case(
...     {
...         "spring": {"wire_diameter": 5.0, "mean_diameter": 40.0, "turns": 2.5, "pitch": 12.0},
...         "material": "ck15",
...         "loading": [{"to": "block"}, {"to": {"force": 0}}],
...     }
... )
>>> result = solve(case)
>>> print(f"set {result.set:.1f} mm, {result.force_at(10):.0f} N at 10 mm")
set 13.1 mm, 179 N at 10 mm
"""

import copy
import json
import os
import shutil
import tempfile
import weakref
from collections.abc import Callable, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

import numpy as np
import xarray as xr
import yaml
from mpi4py import MPI

from coilset.model.compose.analysis import Analysis, FurtherContacts, run_within_accuracy
from coilset.model.compose.run_files import write_run
from coilset.model.compose.summary import summarise
from coilset.model.core.base.agreement import on_first_rank
from coilset.model.core.base.entry import shortened
from coilset.model.core.base.errors import CoilsetError, InputError, SolveError, reading
from coilset.model.core.case.case import Case as CheckedCase
from coilset.model.core.case.case import check, read_case
from coilset.model.core.case.settings import put
from coilset.model.core.equilibrium.path.step_sizes import StepSizes
from coilset.model.core.material import library
from coilset.model.core.material.law.condense import condense as _condense
from coilset.model.core.material.law.law import Law as _LibraryLaw
from coilset.model.core.results.characteristic import place_at
from coilset.model.core.results.files.folder import make, refuse_results, write_history, write_summary
from coilset.model.core.results.files.labelled import labelled
from coilset.model.core.results.records.provenance import origin
from coilset.model.core.results.records.record import Step
from coilset.model.core.runtime.processes import usable_cores
from coilset.model.core.runtime.threads import usual
from coilset.model.physics.own_laws.own import OwnLaw
from coilset.model.tools.identification.programs import Program
from coilset.model.tools.identification.programs import run as run_program
from coilset.model.tools.sweep.study import Study as _Study

if TYPE_CHECKING:
    from coilset.model.physics.vibration.driven import Surge
    from coilset.model.physics.vibration.modes import Modes

__all__ = [
    "Case",
    "CoilsetError",
    "Design",
    "InputError",
    "Law",
    "Material",
    "Result",
    "SolveError",
    "Step",
    "Study",
    "condense",
    "design",
    "material",
    "modes",
    "slice_",
    "solve",
    "surge",
    "sweep",
]

SEGMENTS = 100  # increments of a segment of a material test


class Case:
    """A spring, its material and its load program, checked.

    Args:
        entries: nested entries, as in a case file.
        folder: what relative paths in them count from; default is the working directory.

    Raises:
        InputError: an entry is missing, unknown or wrong.

    >>> case = Case(
    ...     {
    ...         "spring": {"wire_diameter": 5.0, "mean_diameter": 40.0, "turns": 2.5, "pitch": 12.0},
    ...         "material": "ck15",
    ...         "loading": [{"to": {"travel": 10}}],
    ...     }
    ... )
    >>> case.entries["mesh"]["elements_per_turn"]
    16.0
    """

    def __init__(self, entries: Mapping[str, Any], folder: str | Path = ".") -> None:
        self._case: CheckedCase = check(copy.deepcopy(dict(entries)), Path(folder) / "case")

    @classmethod
    def _of(cls, case: CheckedCase) -> Self:
        made = cls.__new__(cls)
        made._case = case
        return made

    @classmethod
    def read(cls, path: str | Path, settings: Sequence[str] = ()) -> Self:
        """Read a case file.

        Args:
            path: the YAML file.
            settings: texts `entry=value` that replace entries, as `--set` does.

        Raises:
            InputError: the file cannot be read, or an entry is wrong.

        >>> Case.read("examples/ck15_presetting.yaml", ["spring.pitch=11"]).entries["spring"]["pitch"]
        11.0
        """
        return cls._of(read_case(path, settings))

    @classmethod
    def _given(cls, case: object) -> CheckedCase:
        """What a Case checked.

        Raises:
            InputError: it is none.
        """
        if not isinstance(case, cls):
            raise InputError(f"must be a Case, as Case.read('case.yaml') gives one, not {type(case).__name__}", "case")
        return case._case

    @property
    def entries(self) -> dict[str, Any]:
        """All entries with their defaults, as plain data."""
        return self._case.model_dump(mode="json")

    def change(self, entries: Mapping[str, Any]) -> Self:
        """The case with other values of some entries, by their paths.

        Raises:
            InputError: an entry is wrong.

        >>> case = Case.read("examples/ck15_presetting.yaml")
        >>> case.change({"spring.wire_diameter": 4.5}).entries["spring"]["wire_diameter"]
        4.5
        """
        data = self.entries
        for entry, value in entries.items():
            put(data, entry, value, entry)
        return self._of(check(data))

    def save(self, path: str | Path) -> None:
        """Write the case, with all its defaults, as a YAML file.

        >>> import tempfile
        >>> file = tempfile.mkdtemp() + "/case.yaml"
        >>> Case.read("examples/ck15_presetting.yaml").save(file)
        >>> Case.read(file).entries["material"]
        'ck15'
        """
        Path(path).write_text(yaml.safe_dump(self.entries, sort_keys=False, allow_unicode=True), encoding="utf-8")


class Law(OwnLaw):
    """A law of one's own for the points of the wire's section, given to `solve`.

    Args:
        update: function of plain Python that numba can compile,

                update(stress, state, strain, parameters, new_stress, new_state, tangent) -> bool

            It reads stress (σ11, τ12, τ13), MPa, and state at the start, the increment of (ε11, γ12, γ13) and the
            parameters; writes stress and state at the end and the consistent tangent, shape (3, 3); and returns whether
            it found a solution. The first four numbers of the state are reported as back stress B11, B12, B13 and
            plastic work b; they begin at zero.
        parameters: passed on.
        variables: names of the numbers of the state beyond these four.
        name: in results.

    Raises:
        InputError: numba cannot compile it; it writes into its arguments, leaves results unset, remembers something
            outside of the state, or changes stress without strain; or its tangent fails the Taylor test.

    >>> def hooke(stress, state, strain, parameters, new_stress, new_state, tangent):
    ...     new_state[:] = state
    ...     tangent[:] = 0.0
    ...     for i in range(3):
    ...         tangent[i, i] = parameters[min(i, 1)]
    ...         new_stress[i] = stress[i] + tangent[i, i] * strain[i]
    ...     return True
    >>> law = Law(hooke, [206e3, 79.3e3])
    >>> case = Case.read("examples/ck15_presetting.yaml", ["loading=[{to: {travel: 1}, steps: 1}]", "accuracy=none"])
    >>> print(f"{solve(case, law=law).force[0]:.1f} N")
    39.4 N
    """


def condense(law3d: Callable[..., bool]) -> Callable[..., bool]:
    """The law of a point in the wire from a three-dimensional one: the stresses across the wire are brought to zero.

    Args:
        law3d: as `update` of `Law`, with the six components 11, 22, 33, 12, 13, 23 and engineering shear strains.

    >>> def hooke(stress, state, strain, parameters, new_stress, new_state, tangent):
    ...     new_state[:] = state
    ...     tangent[:] = 0.0
    ...     for i in range(3):
    ...         tangent[i, :3] = 121e3
    ...         tangent[i, i] += 2.0 * 81e3
    ...         tangent[i + 3, i + 3] = 81e3
    ...     new_stress[:] = stress + tangent @ strain
    ...     return True
    >>> law = Law(condense(hooke))
    >>> print(f"E = {law.E:.0f} MPa, G = {law.G:.0f} MPa")
    E = 210520 MPa, G = 81000 MPa
    """
    return _condense(law3d)


@dataclass(frozen=True)
class Result:
    """Results of a run or of a slice.

    Attributes:
        folder: where its files are; temporary until it is saved.
        summary: numbers of summary.json; units are in the names.
        data: labelled arrays with `units`: columns of history.csv and seats.csv over `step`, section points and the
            wire's surface at the snapshots, numbers of the summary as `summary_…`.

    >>> result = solve(Case.read("examples/ck15_presetting.yaml", ["loading=[{to: {travel: 5}}, {to: {force: 0}}]"]))
    >>> result.data["force_N"].attrs["units"]
    'N'
    >>> print(f"{result.summary['force_max_N']:.0f} N")
    161 N
    """

    folder: Path
    summary: dict[str, Any] = field(repr=False)

    @cached_property
    def data(self) -> xr.Dataset:
        """Labelled arrays, read when they are first used."""
        return labelled(self.folder)

    def __getstate__(self) -> dict[str, Any]:
        """With the data, as the folder may be gone where this is read."""
        return {**self.__dict__, "data": self.data}

    @classmethod
    def open(cls, folder: str | Path) -> Self:
        """Open the results that a run has written.

        Raises:
            InputError: the folder holds no results, or a file cannot be read.

        >>> import tempfile
        >>> folder = tempfile.mkdtemp() + "/pressed"
        >>> case = Case.read("examples/ck15_presetting.yaml", ["loading=[{to: {travel: 5}}]"])
        >>> solve(case).save(folder)
        >>> round(float(Result.open(folder).travel[-1]), 9)
        5.0
        """
        data, result = labelled(folder), cls._of(Path(folder))
        result.__dict__["data"] = data  # read at once, to refuse here what cannot be read
        return result

    @classmethod
    def _of(cls, folder: Path) -> Self:
        with reading(folder / "summary.json"):
            return cls(folder, json.loads((folder / "summary.json").read_text(encoding="utf-8")))

    def save(self, folder: str | Path, overwrite: bool = False) -> None:
        """Write all files of the results into a folder.

        Raises:
            InputError: it already holds results and `overwrite` is not given.

        >>> import os, tempfile
        >>> folder = tempfile.mkdtemp() + "/pressed"
        >>> solve(Case.read("examples/ck15_presetting.yaml", ["loading=[{to: {travel: 5}}]"])).save(folder)
        >>> sorted(os.listdir(folder))
        ['fields', 'history.csv', 'points.nc', 'seats.csv', 'summary.json']
        """
        if not overwrite and Path(folder, "summary.json").exists():
            raise InputError("already holds results; overwrite=True replaces them", "", folder)
        refuse_results(folder, overwrite)
        shutil.copytree(self.folder, folder, dirs_exist_ok=True)

    @property
    def set(self) -> float | None:
        """Loss of free length by the load program, mm; None if the spring was not released."""
        return self.summary["set_mm"]

    @property
    def free_length(self) -> float | None:
        """Free length after the load program, mm; None if the spring was not released."""
        return self.summary["free_length_after_mm"]

    @property
    def travel(self) -> np.ndarray:
        """Shortening at the end of each step, mm, shape (steps,)."""
        return self.data["travel_mm"].to_numpy()

    @property
    def force(self) -> np.ndarray:
        """Axial force at the end of each step, N, compression positive, shape (steps,)."""
        return self.data["force_N"].to_numpy()

    def force_at(self, travel: float, phase: int | None = None) -> float:
        """Axial force at a travel, N; between steps a cubic, or lines that meet where coils close or open.

        Args:
            travel: shortening of the unloaded spring as wound, mm.
            phase: number of the phase of the load program, from 0 on; default is the first that reaches the travel.

        Raises:
            InputError: the spring does not reach the travel in that phase.

        >>> result = solve(Case.read("examples/ck15_presetting.yaml"))
        >>> print(f"{result.force_at(10):.0f} N when pressed, {result.force_at(15, phase=1):.0f} N on release")
        179 N when pressed, 71 N on release
        """
        return place_at(self.data, travel, phase).force

    def rate_at(self, travel: float, phase: int | None = None) -> float:
        """Slope of the characteristic at a travel, N/mm; arguments as of `force_at`.

        Raises:
            InputError: the spring does not reach the travel in that phase.

        >>> result = solve(Case.read("examples/ck15_presetting.yaml"))
        >>> f"{result.rate_at(1):.0f} N/mm" == f"{result.summary['rate_N_per_mm']:.0f} N/mm"
        True
        """
        return place_at(self.data, travel, phase).rate

    def force_error_at(self, travel: float, phase: int | None = None) -> float:
        """Estimated size of the error of `force_at`, N; not a number where it is not known.

        Raises:
            InputError: the spring does not reach the travel in that phase.

        >>> result = solve(Case.read("examples/ck15_presetting.yaml"))
        >>> result.force_error_at(10) < 0.02 * result.force_at(10)
        True
        """
        return place_at(self.data, travel, phase).error


def solve(
    case: Case,
    report: Callable[[Step], object] = lambda step: None,
    threads: int | None = None,
    comm: Any = None,
    law: "Law | None" = None,
    contacts: FurtherContacts | None = None,
    steps: type[StepSizes] = StepSizes,
) -> Result:
    """Run the load program of a case, and again finer where its errors exceed its accuracy; collective.

    Args:
        case: Case.
        report: called with each converged Step, of each run.
        threads: of each rank; default is as `coilset solve`. No number depends on it.
        comm: MPI communicator whose ranks share the spring; default is all.
        law: Law of one's own, in the place of the case's material.
        contacts: function of the wire's points and the stations' positions that makes further kinds of contact, see
            examples/own/contact.py.
        steps: class that decides how long steps are, see examples/own/steps.py.

    Raises:
        InputError: the spring cannot be built, or cannot do what its load program requires.
        SolveError: no equilibrium was found; its `result` is the Result up to there, None if no step was.

    >>> case = Case.read("examples/ck15_presetting.yaml")
    >>> result = solve(case)
    >>> print(f"set {result.set:.2f} mm of {result.summary['free_length_before_mm']:.0f} mm")
    set 13.08 mm of 35 mm
    """
    comm = MPI.COMM_WORLD if comm is None else comm
    checked = Case._given(case)
    if law is not None and not isinstance(law, OwnLaw):
        raise InputError(f"must be a Law, as Law(update) makes one of a function, not {type(law).__name__}", "law")
    if contacts is not None and not callable(contacts):
        problem = "must be a function of the wire's points and the stations that gives contacts"
        raise InputError(f"{problem}, not {type(contacts).__name__}", "contacts")
    if not (isinstance(steps, type) and issubclass(steps, StepSizes)):
        raise InputError(f"must be a class made from StepSizes, not {shortened(repr(steps))}", "steps")
    first = Analysis(checked, comm, threads=threads or usual(comm.size), law=law, contacts=contacts, steps=steps)
    try:
        return _result(run_within_accuracy(first, lambda one, _: one.run(report)))
    except SolveError as error:
        error.result = _result(first) if first.result.steps else None
        raise


def _result(analysis: Analysis) -> Result:
    """The Result of an analysis; collective."""

    def write(folder: Path) -> None:
        summary = summarise(analysis.setup, analysis.result)
        write_run(folder, analysis.setup, analysis.result, summary, origin(analysis.case))

    result = on_first_rank(analysis.comm, lambda: _temporary(write))
    if result is not None and analysis.comm.size == 1:  # a broadcast to nobody would read and copy all of it
        return result
    copied = analysis.comm.bcast(result)
    return result or copied  # the folder is removed with rank 0's


def _temporary(write: Callable[[Path], object]) -> Result:
    """The results that `write` puts into a folder, which is removed with the last reference to them."""
    folder = Path(tempfile.mkdtemp(prefix="coilset-"))
    try:
        write(folder)
        result = Result._of(folder)
    except BaseException:
        shutil.rmtree(folder, ignore_errors=True)
        raise
    weakref.finalize(result, shutil.rmtree, folder, ignore_errors=True)
    return result


def slice_(case: Case, section: str | None = None) -> Result:
    """Run the slice of a cylindrical spring: one section of its wire as a 3D body, without ends and seats.

    Args:
        case: Case; its mesh, seats and solver are not used.
        section: cross-section in words or the CSV file of its outline, as for `coilset slice --section`; default is
            round wire.

    Raises:
        InputError: the spring is not cylindrical, or its load program is one in time or goes below block.
        SolveError: no equilibrium was found.

    >>> case = Case.read("examples/ck15_presetting.yaml", ["loading=[{to: {travel: 5}, steps: 4}]"])
    >>> print(f"{slice_(case).force[-1]:.0f} N")
    162 N
    """
    from coilset.meshes.sections.shapes import parse
    from coilset.model.physics.slice.analysis import SliceAnalysis, SliceStep
    from coilset.model.tools.studies.slice_output import write_fields
    from coilset.model.tools.studies.slice_summary import summarise as summarise_slice

    analysis = SliceAnalysis(Case._given(case), parse(section) if section else None)
    analysis.run()

    def write(folder: Path) -> None:
        write_history(folder, analysis.result.steps, SliceStep)
        write_fields(folder, analysis)
        write_summary(folder, {**summarise_slice(analysis), "origin": origin(case._case)})

    return _temporary(write)


def modes(run: Case | str | Path, at: str = "end", count: int = 10, glued: bool = False) -> "Modes":
    """Natural frequencies and modes of a spring after its load program, or at another load from there on; collective.

    Args:
        run: a Case, whose load program is run, or a results folder of `coilset solve` with its checkpoint.
        at: `end`, or where the spring goes from there: `block`, `block-3mm`, `height=30`, `travel=5`, `force=100`.
        count: of modes.
        glued: whether coils that touch cannot slide on each other.

    Returns:
        Modes, with `frequencies`, Hz, `shapes`, `masses` and `eigenvalues` ω².

    Raises:
        InputError: there is no such run, or the state has no meaning.
        SolveError: no equilibrium was found, or too few modes.

    >>> case = Case.read("examples/ck15_presetting.yaml", ["loading=[{to: {travel: 5}, steps: 2}]", "accuracy=none"])
    >>> print(f"{modes(case, count=1).frequencies[0]:.0f} Hz")
    428 Hz
    """
    from coilset.model.physics.vibration.modes import loaded_modes
    from coilset.model.tools.studies.loaded_spring import after_results, after_run

    analysis = after_run(run._case, at) if isinstance(run, Case) else after_results(run, at)
    return loaded_modes(analysis, count, glued)


def surge(
    run: Case | str | Path,
    height: Callable[[float], float],
    seconds: float,
    step: float,
    spectral_radius: float = 0.8,
) -> "Surge":
    """Drive the top head of a spring over time, from rest at the end of its load program; collective.

    The mass of the wire takes part; yield, contact and friction are as in `solve`. Nothing damps but these and the
    method, which is implicit and of second order in the step (generalised-α).

    Args:
        run: a Case, whose load program is run, or a results folder of `coilset solve` with its checkpoint.
        height: between the heads or seats, mm, at a time, s; it should begin where the load program ends.
        seconds: duration; step: of time, s.
        spectral_radius: what a step leaves of an oscillation that it does not resolve; 1: all of it.

    Returns:
        Surge over time: `height`, forces `top` and `bottom`, `level` of the wire's stations, `contacts` and energies,
        and `force_error` from a second run with steps twice as long.

    Raises:
        InputError: there is no such run, or a number has no meaning.
        SolveError: no equilibrium was found.

    >>> case = Case.read("examples/ck15_presetting.yaml", ["loading=[{to: {travel: 5}, steps: 2}]", "accuracy=none"])
    >>> ringing = surge(case, lambda time: 30.0 - 500.0 * time, 0.001, 0.0005)  # at 0.5 m/s
    >>> print(f"{ringing.height[-1]:.1f} mm")
    29.5 mm
    """
    from coilset.model.physics.vibration.driven import surge as drive
    from coilset.model.tools.studies.loaded_spring import after_results, after_run

    analysis = after_run(run._case) if isinstance(run, Case) else after_results(run)
    return drive(analysis, height, seconds, step, spectral_radius)


def sweep(
    plan: str | Path | Mapping[str, Any], folder: str | Path, jobs: int | None = None, overwrite: bool = False
) -> xr.Dataset:
    """Run the cases of a sweep file that its folder does not hold yet, in processes of this machine.

    Args:
        plan: the sweep file, or its entries; paths in these count from the working directory.
        folder: the sweep's folder: journal and data set; cases that it holds already are not run again.
        jobs: number of processes; default is one for each core.
        overwrite: discard the cases that the folder holds.

    Returns:
        Inputs, responses, characteristic and status over `case`, with `units`; failed cases have a `reason`.

    Raises:
        InputError: a file is wrong; then nothing is run.

    >>> import os, tempfile
    >>> folder = Path(tempfile.mkdtemp())
    >>> wires = "{case: %s/examples/ck15_presetting.yaml, vary: {spring.wire_diameter: [4.9, 5.1]}}"
    >>> _ = (folder / "wires.yaml").write_text(wires % os.getcwd())
    >>> data = sweep(folder / "wires.yaml", folder / "wires")
    >>> bool((data["status"] == "done").all())
    True
    """
    from coilset.model.tools.sweep import dataset
    from coilset.model.tools.sweep.engines.processes import Workers
    from coilset.model.tools.sweep.journal import Journal
    from coilset.model.tools.sweep.plan import Plan
    from coilset.model.tools.sweep.run import finished, missing, run

    checked, folder = Plan(plan), Path(folder)
    make(folder)
    path = folder / "journal.jsonl"
    if overwrite:
        path.unlink(missing_ok=True)
    with (
        Workers(jobs or usable_cores(), dict(os.environ)) as workers,
        workers.pool(folder / "workers.log") as pool,
        closing(Journal(path)) as journal,
    ):
        run(checked, checked.work(missing(checked, finished(folder, retry=False))), pool, journal)
    data = dataset.collect(checked, folder)
    dataset.write(folder / "sweep.nc", data)
    return data


class Study(_Study):
    """A sweep whose cases another program chooses or computes: ask for cases, tell their results.

    Results are kept in a journal as `sweep` keeps them, so that an interrupted study goes on. `ask` gives cases of the
    plan, or those with given inputs; `evaluate` computes them in processes of this machine; `tell` keeps results from
    elsewhere; `results` is the data set of all. Release the folder by `close`.

    >>> import tempfile
    >>> study = Study("examples/sweeps/preset_height.yaml", tempfile.mkdtemp())
    >>> trial = study.ask()[0]
    >>> study.tell(trial.key, {"set_mm": 12.5})
    >>> float(study.results()["set_mm"][0])
    12.5
    >>> study.close()
    """


@dataclass(frozen=True)
class Design:
    """What a design has found.

    Attributes:
        case: the case found; `solve` computes all of its results.
        found: each unknown by its entry, in the unit of the entry.
        met: whether all conditions are met; otherwise the case is as close as possible.
        summary: numbers of the found spring, as in summary.json.

    >>> found = design("examples/design/length_and_force.yaml")
    >>> found.met
    True
    """

    case: Case
    found: dict[str, float]
    met: bool
    summary: dict[str, Any] = field(repr=False)


def design(file: str | Path, threads: int | None = None) -> Design:
    """Find entries of a case for which its run meets conditions.

    Args:
        file: the design file.
        threads: as for `solve`.

    Raises:
        InputError: the file is wrong, or its conditions cannot be met.
        SolveError: the search does not converge.

    >>> found = design("examples/design/length_and_force.yaml")
    >>> sorted(found.found)
    ['loading.0.to.height', 'spring.wire_diameter']
    """
    from coilset.model.tools.design.design import make_search
    from coilset.model.tools.design.design import solve as search_for
    from coilset.model.tools.design.file import read_design_file
    from coilset.model.tools.design.output import found_data

    wanted = read_design_file(file)
    found = search_for(make_search(wanted, threads=threads or usual(1))).found
    unknowns = dict(zip(found.search.evaluator.names, found.x.tolist(), strict=True))
    return Design(Case._of(wanted.check(found_data(found))), unknowns, found.met, dict(found.best.summary))


@dataclass(frozen=True)
class Material:
    """A material of the library, of a file or a named wire.

    Attributes:
        name, source: as its file gives them.
        E, G, nu: Young's modulus and shear modulus, MPa, and Poisson's ratio, at the first temperature.

    >>> print(f"G = {material('ck15').G:.0f} MPa")
    G = 84000 MPa
    """

    name: str
    source: str
    E: float
    G: float
    nu: float
    _law: _LibraryLaw = field(repr=False, compare=False)

    def tension(self, strain: Sequence[float]) -> np.ndarray:
        """Stress at the end of each segment of a uniaxial test, MPa.

        Args:
            strain: logarithmic strains that the bar is driven to, one after the other, shape (n,).

        >>> ck15 = material("ck15")
        >>> ck15.tension([0.0008, 0.001]).round(1).tolist()  # it yields at sqrt(1.5 · 22480) = 183.6 MPa
        [173.4, 184.9]
        """
        return self._driven("eps11", "stress", strain, 0)

    def torsion(self, shear: Sequence[float]) -> np.ndarray:
        """Shear stress at the end of each segment of a torsion test of a thin tube, MPa.

        Args:
            shear: engineering shear strains, shape (n,).

        >>> material("ck15").torsion([0.001]).round(1).tolist()
        [84.0]
        """
        return self._driven("gamma12", "stress", shear, 1)

    def _driven(self, strain: str, name: str, values: Sequence[float], component: int) -> np.ndarray:
        steps = [{"to": {strain: float(value)}, "increments": SEGMENTS} for value in values]
        history = run_program(self._law, Program.model_validate({"name": "test", "steps": steps}))
        return getattr(history, name)[SEGMENTS::SEGMENTS, component]


def material(name: str | Path) -> Material:
    """A material by the name of the library or the path of its file.

    Raises:
        InputError: there is no such material, or its file is wrong.

    >>> material("voce").name
    'voce'
    """
    law = library.load(name)
    return Material(law.name, law.data.source, law.E, law.G, law.nu, law)
