"""The X server that is started where there is no display."""

import os
import shutil
import subprocess
import sys

import pytest

# Python hands on the default action of a signal that it handles itself, as in a command.
PRESSED = """
import os, signal, time
from coilset.model.tools.figures.display import ensure
signal.signal(signal.SIGINT, lambda *_: None)
assert ensure()
os.killpg(0, signal.SIGINT)
time.sleep(1)
import pyvista
plotter = pyvista.Plotter(off_screen=True, window_size=(40, 30))
plotter.add_mesh(pyvista.Sphere())
print(plotter.screenshot(return_img=True).shape)
plotter.close()
"""


@pytest.mark.skipif(shutil.which("Xvfb") is None, reason="no Xvfb")
def test_it_goes_on_after_ctrl_c():
    environment = {name: value for name, value in os.environ.items() if name != "DISPLAY"}
    done = subprocess.run(
        [sys.executable, "-c", PRESSED],
        capture_output=True,
        text=True,
        check=False,
        env=environment,
        start_new_session=True,
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout == "(30, 40, 3)\n"
