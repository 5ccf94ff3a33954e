"""A measurement in a process of its own, which ends with this one."""

import json
import subprocess
from collections.abc import Mapping, Sequence
from typing import Any

from coilset.model.core.base.errors import CoilsetError
from coilset.model.core.runtime.processes import end_with_parent


def read_json(command: Sequence[str], name: str, environment: Mapping[str, str] | None = None, text: str = "") -> Any:
    """What the last line that a process prints holds, in JSON.

    Args:
        command: to run.
        name: of the measurement, for the message.
        environment: of the process; None: this one's.
        text: that it reads.

    Raises:
        CoilsetError: if it failed, with the last line of what it complained of.
    """
    done = subprocess.run(
        command, env=environment, input=text, capture_output=True, text=True, check=False, preexec_fn=end_with_parent
    )
    if done.returncode:
        reason = (done.stderr.strip() or "no message").splitlines()[-1]
        raise CoilsetError(f"{name} failed: {reason}")
    return json.loads(done.stdout.strip().splitlines()[-1])
