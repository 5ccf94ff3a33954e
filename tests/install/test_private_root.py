"""What the private Debian sees of this machine, and what is refused because it has its own."""

import os
import subprocess
from pathlib import Path

import pytest

LAUNCHER = Path(__file__).resolve().parents[2] / "scripts" / "coilset"
CACHE = Path(os.environ.get("COILSET_CACHE", Path.home() / ".cache" / "coilset"))
CASE = LAUNCHER.parents[1] / "examples" / "ck15_presetting.yaml"

in_private_root = pytest.mark.skipif(
    not (CACHE / "debian-13" / "usr").is_dir()
    or os.geteuid() != 0
    or not any(os.access(Path(folder) / "bwrap", os.X_OK) for folder in os.environ["PATH"].split(":")),
    reason="no private Debian here",
)
SEEN = [
    *("/var/elsewhere/out", "/run/media/stick/case.yaml", "/data", "/home/me", "/tmp", "/usr/local/share/springs"),
    *("/usr/local/springs", "/dev/shm/out", "/dev/stdin", "/dev/fd/63", "/proc/self/fd/3", "case.yaml", "/opt"),
]
HIDDEN = [
    *("/usr", "/usr/share/case.yaml", "/usr/local", "/usr/local/lib/springs", "/usr/local/lib64", "/usr/local/bin"),
    *("/etc/coilset", "/lib/x", "/lib64", "/bin", "/sbin/x", "/boot", "/sys/x", "/proc", "/dev", "/lost+found"),
]


@pytest.mark.parametrize(("place", "hidden"), [*((one, False) for one in SEEN), *((one, True) for one in HIDDEN)])
def test_which_folders_are_hidden(place, hidden):
    script = f"COILSET_CACHE=unused; source {LAUNCHER.parent / 'private_root.sh'}; hidden {place}"
    assert (subprocess.run(["bash", "-c", script], check=False).returncode == 0) is hidden


def launch(*arguments, folder, **environment):
    command = [str(LAUNCHER), *map(str, arguments)]
    chosen = {"COILSET_RELEASE": "trixie"} | environment
    return subprocess.run(command, env=os.environ | chosen, cwd=folder, capture_output=True, text=True, check=False)


@pytest.fixture
def var():
    folder = Path("/var/tmp") / f"coilset-test-{os.getpid()}"
    folder.mkdir()
    yield folder
    subprocess.run(["rm", "-r", str(folder)], check=True)


@in_private_root
def test_var_is_that_of_this_machine(var):
    """Read from there, work there, write there."""
    (var / "case.yaml").write_bytes(CASE.read_bytes())
    done = launch("mesh", "case.yaml", "--write", var / "made.vtu", "--no-pictures", folder=var)
    assert (done.returncode, done.stderr) == (0, "")
    assert (var / "made.vtu").exists()


@in_private_root
@pytest.mark.parametrize(
    "option", ["--out=/usr/local/lib/coilset-test", "/etc/coilset-test.yaml", "--set=material=/usr/x"]
)
def test_what_is_hidden_is_refused(tmp_path, option):
    done = launch("solve", CASE, option, folder=tmp_path)
    assert done.returncode == 2
    assert done.stderr.startswith(f"coilset: /{option.partition('/')[2]}: cannot be seen from the private Debian")
    assert done.stderr.count("\n") == 1


@in_private_root
def test_a_hidden_working_directory_is_refused():
    done = launch("solve", CASE, folder="/usr/local/lib")
    assert done.returncode == 2
    assert done.stderr.startswith("coilset: /usr/local/lib: cannot be seen")


@in_private_root
def test_nothing_is_written_into_its_own_folders(tmp_path):
    """Such as exist on both sides, which are not refused as hidden."""
    done = launch("mesh", CASE, "--out", "/usr/share", folder=tmp_path)
    assert done.returncode == 2
    assert done.stderr == "coilset: /usr/share: --out: /usr/share cannot be written to; give another\n"


@in_private_root
def test_the_modules_of_this_machine_do_not_reach_it(tmp_path):
    (tmp_path / "numpy.py").write_text("raise SystemExit(7)\n")
    (tmp_path / "libm.so.6").write_text("none\n")
    place = str(tmp_path)
    done = launch("examples", folder=tmp_path, PYTHONPATH=place, PYTHONHOME=place, LD_LIBRARY_PATH=place)
    assert (done.returncode, done.stderr) == (0, "")
    words = ("python", "-c", "import sys, site; print(sys.path, site.ENABLE_USER_SITE)")
    found = launch(*words, folder=tmp_path, PYTHONPATH=place).stdout
    assert place not in found
    assert "False" in found
