"""PETSc options of a case file: all that docs/methods.md lists work, and nothing else is taken."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
from mpi4py import MPI

from coilset.model.compose.analysis import Analysis
from coilset.model.core.base.errors import InputError
from coilset.model.core.case import read_case
from coilset.model.core.equilibrium.petsc_options import OPTIONS, bare, plain

PAGE = Path(__file__).resolve().parents[3] / "docs" / "methods.md"
SMALL = [
    "mesh.elements_per_turn=8",
    "mesh.section.rule=abramowitz9",
    "material=elastic",
    "ends=clamped",
    "accuracy=none",
    "loading=[{to: {travel: 2}, steps: 4}]",
]
KRYLOV = {"ksp_type": "gmres", "ksp_rtol": 1e-10, "ksp_gmres_restart": 200, "ksp_max_it": 2000}
BESIDE = {  # what a choice needs beside itself: the method, and options
    ("snes_type", "qn"): ("bfgs", {}),
    ("snes_type", "anderson"): ("modified-newton-anderson", {}),
    ("snes_type", "ngmres"): ("modified-newton-anderson", {}),
    ("snes_type", "newtonal"): ("arc-length", {}),
}
LINEAR = {"ksp_type": {"ksp_rtol": 1e-10}, "pc_type": KRYLOV}
SOLVES_NOTHING = {("pc_type", "none")}  # a rod's stiffnesses are too far apart
OF_FACTORS = ("pc_factor_mat_solver_type", "pc_factor_mat_ordering_type", "pc_factor_shift_type")
CHOICES = [
    (key, word)
    for key in ("snes_type", "snes_linesearch_type", "ksp_type", "pc_type", *OF_FACTORS)
    for word in OPTIONS[key]
    if (key, word) not in SOLVES_NOTHING
]


def analysis(example, method, options):
    given = [f"solver.options.{name}={value}" for name, value in options.items()]
    return Analysis(read_case(example, [*SMALL, f"solver.method={method}", *given]), MPI.COMM_SELF)


def positions_of(example, method, options):
    """Positions of the wire half a millimetre down."""
    made = analysis(example, method, options)
    outcome = made.newton.solve(made.control.to_height(made.control.height - 0.5))
    assert outcome.converged, outcome.reason
    return made.rod.x.copy()


@pytest.fixture(scope="module")
def positions(example):
    return positions_of(example, "newton", {})


@pytest.mark.parametrize(("key", "word"), CHOICES)
def test_each_choice_finds_the_equilibrium(example, positions, key, word):
    """The same positions to 1e-7 mm; the convergence test leaves 2e-9 of 0.5 mm."""
    method, options = BESIDE.get((key, word), ("newton", LINEAR.get(key, {})))
    try:
        found = positions_of(example, method, options | {key: word})
    except InputError as error:
        if "PETSc refuses" not in str(error):
            raise
        pytest.skip(str(error))  # a search or library that this PETSc lacks
    np.testing.assert_allclose(found, positions, rtol=0, atol=1e-7)


@pytest.mark.parametrize("name", OPTIONS)
def test_no_option_takes_any_word(name):
    with pytest.raises(ValueError, match="'python': must be"):
        plain(name, "python")


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"pc_type": "python"}, "pc_type: 'python': must be one of lu, cholesky, "),
        ({"pc_python_type": "case.yaml:Evil"}, "pc_python_type: unknown entry; "),
        ({"snes_type": "python"}, "snes_type: 'python': must be one of newtonls, "),
        ({"snes_type": "shell"}, "snes_type: 'shell': must be one of newtonls, "),
        ({"snes_python_type": "os.system"}, "snes_python_type: unknown entry; "),
        ({"ksp_type": "python"}, "ksp_type: 'python': must be one of preonly, "),
        ({"snes_linesearch_type": "shell"}, "snes_linesearch_type: 'shell': must be one of basic, "),
        ({"npc_pc_type": "python"}, "npc_pc_type: 'python': must be one of lu, "),
        ({"npc_sub_pc_python_type": "x"}, "npc_sub_pc_python_type: unknown entry; "),
        ({"snes_view": "ascii:victim.txt"}, "snes_view: unknown entry; "),
        ({"snes_monitor": "ascii:victim.txt"}, "snes_monitor: unknown entry; "),
        ({"ksp_converged_reason": "ascii:victim.txt"}, "ksp_converged_reason: unknown entry; "),
        ({"ksp_view_mat": "binary:victim.txt"}, "ksp_view_mat: unknown entry; "),
        ({"snes_monitor": "socket:5005"}, "snes_monitor: unknown entry; "),
        ({"options_file": "own.txt"}, "options_file: unknown entry; "),
        ({"dll_prepend": "own.so"}, "dll_prepend: unknown entry; "),
        ({"log_view": ":victim.txt"}, "log_view: unknown entry; "),
        ({"snes_rtol": "ascii:victim.txt"}, "snes_rtol: 'ascii:victim.txt': must be a number$"),
        ({"snes_rtol": True}, "snes_rtol: True: must be a number$"),
        ({"snes_max_it": 2.5}, "snes_max_it: 2.5: must be a whole number$"),
        ({"snes_max_it": None}, "snes_max_it: None: must be a whole number$"),
        ({"snes_ksp_ew": 3}, "snes_ksp_ew: 3: must be true or false$"),
        ({"snes_max_its": 3}, "snes_max_its: unknown entry; is snes_max_it meant?$"),
    ],
)
def test_nothing_else_is_taken(example, options, message):
    with pytest.raises(InputError) as caught:
        read_case(example, [f"solver.options={json.dumps(options)}"])
    line = str(caught.value)
    assert f"{line}$".split("solver.options.")[1].startswith(message)
    assert "\n" not in line


def test_values_are_those_that_petsc_reads(example):
    """Whole numbers of a sweep's range, words in capitals, an option without a value."""
    assert plain("snes_max_it", 12.0) == 12
    assert isinstance(plain("snes_max_it", 12.0), int)
    assert plain("npc_ksp_norm_type", "UNPRECONDITIONED") == "unpreconditioned"
    assert plain("snes_ksp_ew", None) is True
    assert plain("snes_ksp_ew", False) is False
    assert bare("npc_sub_pc_type") == "pc_type"


def test_the_page_lists_them():
    """Each row of its table: names, and the words that they take or the kind of their values."""
    found = {}
    for names, values in re.findall(r"^\| (`(?:snes|ksp|pc)_.*?) \| (.*) \|$", PAGE.read_text(encoding="utf-8"), re.M):
        for name in re.findall(r"`(\w+)`", names):
            assert name not in found
            found[name] = tuple(re.findall(r"`(\w+)`", values)) or values
    assert found == OPTIONS
