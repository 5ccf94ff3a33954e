"""Throughput of the constitutive law on one core: `scripts/coilset python -m coilset.verification.benchmarks.law`.

Ck 15, every point plastic. 4000 points (as many as fit into the cache) are strained by 0.4 % in random directions four
times, then once more in the last direction: that increment is timed. The return mapping gives its consistent tangent,
Heun that of the rate equations. Best of many repetitions, elapsed time. The error of stress is against Heun with a
tolerance of 1e-7, relative to the flow stress, root mean square of 200 points.
"""

import os
import platform
import time
from collections.abc import Callable
from functools import partial

import numpy as np
from rich.console import Console
from rich.table import Table

from coilset.model.core.material import library
from coilset.model.core.material.law.law import Law
from coilset.model.core.material.point import points
from coilset.verification.references import heun

POINTS = 4000
INCREMENTS = (1e-4, 3e-4, 1e-3)
SECONDS = 1.0  # of every line
COMPARED = 200
METHODS = (None, 1e-3, 1e-4)  # the return map, Heun with a tolerance
FORMS = {3: "rod", 6: "full stress state"}


def prepared(law: Law, components: int, increment: float) -> tuple[np.ndarray, np.ndarray]:
    """Plastic states and the increments that go on from them."""
    rng = np.random.default_rng(0)
    state = points.initial_state(law, POINTS, components)
    for _ in range(4):
        direction = rng.normal(size=(POINTS, components))
        direction /= np.linalg.norm(direction, axis=1)[:, None]
        state = points.update(law, state, 4e-3 * direction)[0]
    return state, increment * direction


def rate(
    law: Law, update: Callable[..., tuple[np.ndarray, ...]], state: np.ndarray, increments: np.ndarray
) -> tuple[float, np.ndarray, np.ndarray]:
    """Points per second, the best of `SECONDS`."""
    new, _, count = update(law, state, increments)
    best, end = np.inf, time.perf_counter() + SECONDS
    while time.perf_counter() < end:
        begin = time.perf_counter()
        update(law, state, increments)
        best = min(best, time.perf_counter() - begin)
    return POINTS / best, new, count


def processor() -> str:
    """Name of the processor where the system tells it."""
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as file:
            return next(line.split(":")[1].strip() for line in file if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor() or platform.machine()


def error(law: Law, state: np.ndarray, increments: np.ndarray, new: np.ndarray) -> float:
    """Root mean square error of the stress in `new` over the flow stress, of the first points."""
    some, components = slice(COMPARED), increments.shape[1]
    exact = heun.update(law, state[some], increments[some], tolerance=1e-7)[0]
    flow = np.sqrt(1.5 * law.functions(exact[:, 2 * components])[0])
    return np.sqrt((((new[some, :components] - exact[:, :components]) ** 2).sum(axis=1) / flow**2).mean())


def main() -> None:
    """Print the table."""
    console = Console(highlight=False, width=120)
    load, version = os.getloadavg()[0], platform.python_version()
    console.print(f"one core of {processor()}; {os.cpu_count()} cores, load {load:.1f}; Python {version}")
    table = Table(box=None, padding=(0, 2))
    for column in ("form", "method", "increment", "10⁶ points/s", "plastic", "iterations, sub-steps", "stress error"):
        table.add_column(column, justify="left" if column in ("form", "method") else "right")
    for components, form in FORMS.items():
        for tolerance in METHODS:
            law = library.load("ck15")
            update = points.update if tolerance is None else partial(heun.update, tolerance=tolerance)
            name = "return mapping" if tolerance is None else f"Heun, {tolerance:g}"
            for increment in INCREMENTS:
                state, increments = prepared(law, components, increment)
                speed, new, count = rate(law, update, state, increments)
                table.add_row(
                    form,
                    name,
                    f"{increment:g}",
                    f"{speed / 1e6:.3g}",
                    f"{100 * (count > 0).mean():.4g} %",
                    f"{count.mean():.2f}",
                    f"{error(law, state, increments, new):.1e}",
                )
    console.print(table)


if __name__ == "__main__":
    main()
