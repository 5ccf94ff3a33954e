"""What can be said of a run before it begins: its cost, by that of an element measured in docs/scaling.md."""

import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from coilset.meshes.springs.geometry import Spring
from coilset.model.core.base.errors import InputError
from coilset.model.core.base.warning import Warning
from coilset.model.physics.accuracy.contact_fineness import coarse_mesh_warnings

# Measured with 96 points per section, docs/scaling.md: 16.5 of 25.7 µs for the law, 10.8 of 26 kB for the points and
# their finer path, which tells the error of the steps.
SECONDS_OF_POINT = 16.5e-6 / 96
SECONDS_OF_ELEMENT = 9.2e-6
BYTES_OF_POINT = 5.4e3 / 96
BYTES_OF_ELEMENT = 15.2e3
BYTES_OF_PROGRAM = 0.3e9  # with all its libraries
EVALUATIONS = 6.0  # per step, mean of the example's 24 steps to block and back
LONG = 3600.0  # seconds from which a run is reported as long
CGROUP = Path("/sys/fs/cgroup/memory.max")


@dataclass(frozen=True)
class Effort:
    """An estimate, good to a factor of about two if no steps are cut; coils that touch double the cost.

    Attributes:
        elements, steps: their numbers.
        seconds: on one processor.
        memory: bytes.
    """

    elements: int
    steps: int
    seconds: float
    memory: float

    @classmethod
    def of(cls, elements: int, points: int, steps: int, estimated: bool = True) -> "Effort":
        """The effort for given numbers of elements, points per section and steps, whose errors are `estimated`."""
        once = elements * (SECONDS_OF_ELEMENT + SECONDS_OF_POINT * points)
        memory = BYTES_OF_PROGRAM + elements * (BYTES_OF_ELEMENT + (1 + estimated) * BYTES_OF_POINT * points)
        return cls(elements, steps, EVALUATIONS * steps * once, memory)

    def check_memory(self, present: float) -> None:
        """Reject a run for which the machine has not enough memory even if it does nothing else.

        Args:
            present: memory of the machine, bytes.

        Raises:
            InputError: with the numbers.
        """
        if self.memory > present:
            needed, there = (f"{size / 2**30:.3g} GiB" for size in (self.memory, present))
            raise InputError(
                f"{self.elements:,} elements need about {needed}, and this machine has {there}; "
                "give fewer elements or points in a section",
                "mesh",
            )

    def warnings(self) -> list[Warning]:
        """A run that takes long."""
        if self.seconds <= LONG:
            return []
        hours = self.seconds / 3600.0
        message = (
            f"{self.elements:,} elements in {self.steps:,} steps take about {hours:.2g} hours of one processor; "
            "fewer elements or steps take less"
        )
        return [Warning("duration", "mesh", message, hours, LONG / 3600.0, "h")]


def machine_memory() -> float:
    """Memory available to processes here, bytes: the machine's, or that of the container."""
    present = float(os.sysconf("SC_PHYS_PAGES")) * os.sysconf("SC_PAGE_SIZE")
    try:
        return min(present, float(CGROUP.read_text()))  # "max" without a limit
    except (OSError, ValueError):
        return present


def checked(spring: Spring, turns: np.ndarray, points: int, steps: int, estimated: bool) -> tuple[Warning, ...]:
    """Warnings about the mesh and about the effort.

    Args:
        spring: Spring.
        turns: of the stations, shape (n,).
        points, steps, estimated: as in `Effort.of`.

    Raises:
        InputError: if the run needs more memory than there is.
    """
    effort = Effort.of(len(turns) - 1, points, steps, estimated)
    effort.check_memory(machine_memory())
    return (*coarse_mesh_warnings(spring, turns), *effort.warnings())
