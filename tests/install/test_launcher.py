"""scripts/coilset remembers the environment it has found, and says how to get one where there is none."""

import json
import os
import pwd
import re
import subprocess
import sys
from pathlib import Path

import pytest

from coilset.model.core.base.version import __version__, _first

LAUNCHER = Path(__file__).resolve().parents[2] / "scripts" / "coilset"


def launch(*arguments, **environment):
    command = [str(LAUNCHER), *arguments]
    return subprocess.run(command, env=os.environ | environment, capture_output=True, text=True, check=False)


@pytest.fixture
def counted(tmp_path):
    """A Python of its own that counts its starts, and the environment that has the launcher use it."""
    python, log = tmp_path / "python3", tmp_path / "starts"
    python.write_text(f'#!/bin/sh\necho start >> {log}\nexec {sys.executable} "$@"\n')
    python.chmod(0o755)
    environment = {"COILSET_PYTHON": str(python), "COILSET_CACHE": str(tmp_path / "cache"), "COILSET_RELEASE": ""}

    def starts():
        before = len(log.read_text().splitlines()) if log.exists() else 0
        done = launch("--version", **environment)
        assert done.stdout.startswith("coilset "), done.stderr
        return len(log.read_text().splitlines()) - before

    return python, starts


def test_an_environment_is_looked_for_once(counted):
    python, starts = counted
    assert starts() == 2  # looked for, and run
    assert starts() == 1
    later = max(path.stat().st_mtime for path in python.parent.rglob("found-*")) + 10.0
    os.utime(python, (later, later))
    assert starts() == 1  # a script that starts Python is none of the facts, what it starts is
    record = next(python.parent.rglob("found-*"))
    earlier = 0.0
    os.utime(record, (earlier, earlier))
    assert starts() == 2  # the folders of modules are newer than the record
    assert starts() == 1


def test_a_record_of_what_is_gone_is_not_believed(counted):
    python, starts = counted
    assert starts() == 2
    record = next(python.parent.rglob("found-*"))
    record.write_text(record.read_text() + f"{python.parent / 'gone'}\n")
    assert starts() == 2


@pytest.mark.parametrize("arguments", [["--help"], ["-h"], ["--version"], []])
def test_without_an_environment_help_names_the_ways_and_makes_none(tmp_path, arguments):
    done = launch(*arguments, COILSET_RELEASE="nowhere", COILSET_CACHE=str(tmp_path))
    assert done.returncode == 0
    first, *ways = done.stdout.splitlines()
    assert all(way in first for way in ("conda", "pip", "no root needed", "as root from Debian"))
    for way in ("conda env create", "Miniforge", "pip", "Debian 13, Ubuntu 25.04", "older Debian and Ubuntu"):
        assert way in "\n".join(ways)
    assert not list(tmp_path.glob("debian*"))


def test_without_root_nothing_is_made_and_the_ways_are_listed(tmp_path):
    """As a user who is not root, which `id` tells the launcher."""
    (tmp_path / "id").write_text("#!/bin/sh\necho 1000\n")
    (tmp_path / "id").chmod(0o755)
    path = f"{tmp_path}{os.pathsep}{os.environ['PATH']}"
    cache = tmp_path / "cache"
    done = launch("solve", "case.yaml", COILSET_RELEASE="nowhere", COILSET_CACHE=str(cache), PATH=path)
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr.startswith("coilset needs DOLFINx >= 0.9, from conda or pip (no root needed)")
    assert not list(cache.glob("debian*"))


def test_a_python_that_is_named_is_not_replaced_by_another(tmp_path):
    named = tmp_path / "python3"
    named.write_text(f'#!/bin/sh\nexec {sys.executable} -S "$@"\n')  # without the packages of its site
    named.chmod(0o755)
    done = launch("examples", COILSET_PYTHON=str(named), COILSET_RELEASE="", COILSET_CACHE=str(tmp_path / "cache"))
    assert done.returncode == 2
    assert done.stderr == f"coilset: COILSET_PYTHON: {named} is no Python with DOLFINx >= 0.9\n"


def test_what_a_python_with_dolfinx_lacks_is_named(tmp_path):
    """Its metadata is there, and nothing else."""
    packages = tmp_path / "packages"
    (packages / "fenics_dolfinx-0.10.0.dist-info").mkdir(parents=True)
    (packages / "fenics_dolfinx-0.10.0.dist-info" / "METADATA").write_text("Name: fenics-dolfinx\nVersion: 0.10.0\n")
    (packages / "dolfinx").mkdir()
    named = tmp_path / "python3"
    named.write_text(f"""#!/bin/sh
exec {sys.executable} -S -c 'import sys; del sys.argv[0]; sys.path.append("{packages}"); exec(sys.stdin.read())' "$@"
""")
    named.chmod(0o755)
    done = launch("examples", COILSET_PYTHON=str(named), COILSET_RELEASE="", COILSET_CACHE=str(tmp_path / "cache"))
    assert done.returncode == 2
    assert done.stderr.startswith(f"coilset: COILSET_PYTHON: {named} has DOLFINx, but not petsc4py, mpi4py, gmsh, ")


def test_version_names_what_the_numbers_rest_on():
    words = launch("--version").stdout
    assert all(f"{name} " in words for name in ("coilset", "DOLFINx", "petsc4py", "numba", "Python"))


def test_a_package_without_metadata_has_its_version_in_code():
    assert _first(("coilset.model.core.base.version",)) == __version__
    assert _first(("no-package", "of-this-name")) == ""


def test_each_environment_has_a_log_of_its_own(tmp_path):
    """As root of a Debian where the tool fails that makes a private root."""
    for name, script in {"id": "echo 0", "mmdebstrap": "echo broken; exit 1", "bwrap": "exit 1"}.items():
        (tmp_path / name).write_text(f"#!/bin/sh\n{script}\n")
        (tmp_path / name).chmod(0o755)
    cache = tmp_path / "cache"
    done = launch(
        "examples",
        COILSET_RELEASE="nowhere",
        COILSET_CACHE=str(cache),
        COILSET_PYTHON="",
        PATH=f"{tmp_path}{os.pathsep}{os.environ['PATH']}",
    )
    assert done.returncode == 2
    if not done.stderr.startswith("coilset needs DOLFINx"):  # no Debian or Ubuntu
        log = cache / "debian-nowhere.log"
        assert done.stderr.endswith(f"broken\ncoilset: that failed; the whole log is {log}\n")
        assert log.read_text() == "broken\n"


def shell(script, **variables):
    """What bash prints with the launcher's functions."""
    sources = f"scripts={LAUNCHER.parent}; source $scripts/environment.sh; source $scripts/private_root.sh; {script}"
    given = os.environ | {"COILSET_CACHE": "none"} | variables
    return subprocess.run(["bash", "-c", sources], env=given, capture_output=True, text=True, check=True).stdout


def test_wheels_are_installed_by_their_digests():
    """As they were when they were chosen, and none that would be built."""
    lines = (LAUNCHER.parent / "wheels.txt").read_text().splitlines()
    assert [line.partition("==")[0] for line in lines] == ["pyarrow", "SALib", "multiprocess", "dill"]
    for line in lines:
        assert re.fullmatch(r"\w+==[\d.]+( --hash=sha256:[0-9a-f]{64})+", line)
    assert "--only-binary :all: --require-hashes" in shell("echo ${wheels[@]}")
    assert {"dill", "pyarrow", "python3-dolfinx"} <= set(shell("listed").splitlines())
    assert "--require-hashes" in (LAUNCHER.parents[1] / ".ci" / "Containerfile").read_text()


@pytest.mark.parametrize(("release", "seconds"), [("", 0), ("trixie", 0), ("sid", 30 * 24 * 3600)])
def test_lists_of_packages_are_not_older_than_they_may_be(release, seconds):
    """A week by their own date, and a month for a release in the making, whose mirrors are often old."""
    assert int(shell("echo $least_validity", COILSET_RELEASE=release)) == seconds
    said = shell("in_root() { echo $*; }; add_all", COILSET_RELEASE=release)
    assert f"apt-get update -o Acquire::Check-Valid-Until=true -o Acquire::Min-ValidTime={seconds}" in said


def test_what_a_killed_making_of_the_environment_left_mounted_is_no_obstacle(tmp_path):
    apart = ["unshare", "--user", "--map-root-user", "--mount"]
    if subprocess.run([*apart, "true"], capture_output=True, check=False).returncode:
        pytest.skip("mounting is not permitted here")
    left, beside = tmp_path / "a folder" / "debian.partial", tmp_path / "a folder" / "debian"
    mounts = [
        f"mkdir -p '{place}' && mount -t tmpfs none '{place}'"
        for place in (beside, left / "proc", left / "dev", left / "dev" / "shm")
    ]
    script = f"""set -eu; {"; ".join(mounts)}
        COILSET_CACHE=unused; source {LAUNCHER.parent / "private_root.sh"}; discard '{left}'
        grep -c debian /proc/mounts"""
    done = subprocess.run([*apart, "bash", "-c", script], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (0, "1\n", "")
    assert beside.exists()
    assert not left.exists()


WHERE = "import os, sys, json; print(json.dumps([sys.path, os.environ.get('COILSET_STARTED'), os.environ['HOME']]))"


@pytest.fixture
def started(tmp_path):
    """What a Python that the launcher starts has, with variables of the environment; `-` takes one away."""
    (tmp_path / "work").mkdir()

    def start(**environment):
        chosen = {"COILSET_PYTHON": sys.executable, "COILSET_RELEASE": "", "COILSET_CACHE": str(tmp_path / "cache")}
        given = {name: value for name, value in (os.environ | chosen | environment).items() if value != "-"}
        done = subprocess.run(
            [str(LAUNCHER), "python", "-c", WHERE],
            env=given,
            cwd=tmp_path / "work",
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stderr
        return json.loads(done.stdout)

    return start


def test_a_locale_with_a_decimal_comma_is_no_obstacle(tmp_path, started):
    """Bash writes EPOCHREALTIME as the locale does, also where it then reads it."""
    comma = tmp_path / "comma"
    comma.write_text("unset EPOCHREALTIME COILSET_STARTED; EPOCHREALTIME=1795852767,644523\n")
    assert started(BASH_ENV=str(comma))[1] == "1795852767.644523"


@pytest.mark.parametrize("time", ["1795852767,644523", "", "soon"])
def test_a_time_that_is_no_number_ends_no_command(time):
    program = "from coilset.scripts.commands.solve import STARTED; assert STARTED > 1e9"
    subprocess.run([sys.executable, "-c", program], env=os.environ | {"COILSET_STARTED": time}, check=True)


@pytest.mark.parametrize("home", ["-", ""])
def test_without_a_home_it_is_that_of_the_user(home, started):
    expected = pwd.getpwuid(os.getuid()).pw_dir
    assert started(HOME=home)[2] == expected


@pytest.mark.parametrize("names", ["", ":", "/somewhere:", "::/somewhere"])
def test_an_empty_name_in_the_path_of_modules_is_not_the_working_directory(tmp_path, started, names):
    """`-c` puts the working directory first by itself, as an empty name."""
    found = started(PYTHONPATH=names)[0]
    assert str(tmp_path / "work") not in found
    assert found.count("") == 1
    assert ("/somewhere" in found) is ("/somewhere" in names)


def test_a_module_beside_the_case_is_not_run(tmp_path):
    """Neither by the command nor while an environment is looked for; `coilset python` runs a script with its folder."""
    for name in ("yaml.py", "csv.py", "statistics.py"):
        (tmp_path / name).write_text("raise SystemExit(7)\n")
    (tmp_path / "own.py").write_text("import yaml\n")
    chosen = {"COILSET_PYTHON": sys.executable, "COILSET_RELEASE": "", "COILSET_CACHE": str(tmp_path / "cache")}
    for arguments, code in ((["examples"], 0), (["mesh", "none.yaml"], 2), (["python", "own.py"], 7)):
        command = [str(LAUNCHER), *arguments]
        done = subprocess.run(command, env=os.environ | chosen, cwd=tmp_path, capture_output=True, check=False)
        assert done.returncode == code, done.stderr
