"""A folder that must not be written to is refused by every command before it works, in one line; nothing is made.

Root may write everywhere; the commands are therefore run by a process that has not got this right.
"""

import ctypes
import json
import os
import subprocess
import sys

import pytest

from coilset.scripts.commands.solve import solve

PR_CAPBSET_DROP, CAP_DAC_OVERRIDE = 24, 1  # of Linux's prctl
SMALL = [
    "mesh.elements_per_turn=8",
    "mesh.section.rule=abramowitz9",
    "accuracy=none",
    "loading=[{to: {travel: 2}, steps: 1}]",
]
RUN = """
import json, sys
from coilset.model.core.base.errors import CoilsetError
from coilset.scripts.main import app

for words in json.load(sys.stdin):
    try:
        app(words, prog_name="coilset", standalone_mode=False)
        found = [0, ""]
    except CoilsetError as error:
        found = [error.exit_code, str(error)]
    print("\\n", json.dumps(found), sep="")
"""


def run(lines, folder):
    """Exit codes and messages of command lines in a folder, by a process that cannot write everywhere."""
    if not sys.platform.startswith("linux"):
        pytest.skip("needs Linux's capabilities")
    libc = ctypes.CDLL(None, use_errno=True)

    def give_up():
        if os.geteuid() == 0 and libc.prctl(PR_CAPBSET_DROP, CAP_DAC_OVERRIDE):
            os._exit(77)

    done = subprocess.run(
        [sys.executable, "-c", RUN],
        cwd=folder,
        input=json.dumps(lines),
        preexec_fn=give_up,
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode == 77:
        pytest.skip("this process may not give up a right")
    assert done.returncode == 0, done.stderr
    return [json.loads(line) for line in done.stdout.splitlines() if line.startswith("[")]


def test_no_command_works_for_a_folder_that_cannot_be_written_to(example, tmp_path):
    case = str(example)
    results, closed = tmp_path / "results", tmp_path / "closed"
    solve(example, results, False, SMALL)
    (tmp_path / "design.yaml").write_text(
        f"case: {case}\nfind: {{loading.0.to.height: [18, 34]}}\nsuch_that: {{set_mm: 1}}\nchange: {{}}\n"
    )
    closed.mkdir()
    for folder in (closed, results):
        folder.chmod(0o555)
    commands = [
        "solve CASE",
        "slice CASE",
        "mesh CASE",
        "sheet CASE",
        "sweep SWEEP",
        "verify",
        "bench",
        "material show ck15",
        "material test ck15 PROGRAM",
        "examples ck15_presetting",
        "design DESIGN",
    ]
    files = {
        "CASE": case,
        "SWEEP": str(example.parent / "sweeps" / "tolerances.yaml"),
        "DESIGN": "design.yaml",
        "PROGRAM": str(example.parent / "material" / "tension.yaml"),
    }
    lines = [
        [*(files.get(word, word) for word in command.split()), "--out", out]
        for command in commands
        for out in ("closed", "closed/below")
    ]
    lines += [["mesh", case, "--no-pictures", "--write", "closed/wire.vtu"], ["report", "results"]]
    before = sorted(results.rglob("*"))
    for words, (code, said) in zip(lines, run(lines, tmp_path), strict=True):
        assert code == 2, words
        assert "cannot be" in said, words
        assert "\n" not in said, words
    assert list(closed.iterdir()) == []
    assert sorted(results.rglob("*")) == before
