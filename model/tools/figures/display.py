"""An X server for pyvista where the machine has none."""

import atexit
import os
import shutil
import subprocess

from coilset.model.core.runtime.processes import end_with_parent


def ensure() -> bool:
    """Start a virtual X server if there is no display; it ends with this process, not at a Ctrl-C that this one hears.

    Returns:
        False if there is no display and none can be started.
    """
    if os.environ.get("DISPLAY"):
        return True
    if shutil.which("Xvfb") is None:
        return False
    read, write = os.pipe()
    server = subprocess.Popen(
        ["Xvfb", "-displayfd", str(write), "-screen", "0", "1280x1024x24", "-nolisten", "tcp"],
        pass_fds=[write],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
        preexec_fn=end_with_parent,
    )
    os.close(write)
    atexit.register(server.terminate)
    with os.fdopen(read) as pipe:
        number = pipe.readline().strip()
    if not number:
        return False
    os.environ["DISPLAY"] = f":{number}"
    return True
