"""A law of one's own: a function of a section point in Python, compiled, in the place of a material of the library.

The function integrates one increment of the three stresses (σ11, τ12, τ13) of a fibre, whose other stresses are zero:

    update(stress, state, strain, parameters, new_stress, new_state, tangent) -> bool

reads stress and state at the start (shapes (3,) and (s,)), the increment of (ε11, γ12, γ13) and the parameters, writes
both at the end and the consistent tangent ∂new_stress/∂strain, shape (3, 3), and returns whether it found a solution.
numba compiles it together with a loop over the points of a section, to which the program gets a pointer: the sections'
own loops are compiled once for all such laws. The first four numbers of the state are reported as the back stress B11,
B12, B13 and the plastic work b; a law without them leaves them at zero.
"""

import hashlib
import inspect
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numba import cfunc

from coilset.model.core.material import library
from coilset.model.core.material.law.file import MaterialFile
from coilset.model.core.material.law.law import Law
from coilset.model.core.material.law.loop import LOOP, PointLaw
from coilset.model.core.material.law.parts import simple
from coilset.model.core.runtime.kernels import njit
from coilset.model.physics.own_laws.checks import check_law

Update = Callable[..., bool]
REPORTED = 4  # B11, B12, B13 and b
OPTIONS: dict[str, Any] = {"error_model": "numpy"}


class OwnLaw(Law):
    """A Law whose points are integrated by a function of one's own.

    Args:
        update: the function, of plain Python that numba can compile, or a compiled one.
        parameters: passed to it at every point.
        variables: names of the numbers of the state beyond the first four.
        name: in results.

    Raises:
        InputError: numba cannot compile it, or it is no law: see `coilset.model.physics.own_laws.checks`.

    Attributes:
        update: the compiled function, to be called from Python.
        values: the parameters as an array.
        variables: as given.
        keeps_direction: whether the law is the same for all directions across the wire.
    """

    def __init__(
        self, update: Update, parameters: Sequence[float] = (), variables: Sequence[str] = (), name: str = "own law"
    ) -> None:
        self.values, self.variables = np.array(parameters, float), tuple(variables)
        self.update: Update = update if hasattr(update, "py_func") else njit(**OPTIONS)(update)
        self.width = REPORTED + len(self.variables)
        self._moduli, self.keeps_direction = check_law(self.update, self.values, self.width)
        data = library.load("elastic").data.model_dump()
        E, G = self._moduli
        data |= {"name": name, "description": "a law given from Python", "source": "coilset.api.Law"}
        data["temperatures"][0]["elasticity"] |= {"G": G, "nu": min(max(0.5 * E / G - 1.0, 0.0), 0.49)}
        super().__init__(MaterialFile.model_validate(data))
        self._loop = _loop(self.update)

    @property
    def E(self) -> float:
        """∂σ11/∂ε11 of the unstressed point, MPa."""
        return self._moduli[0]

    def moduli(self, temperature: Any) -> tuple[np.ndarray, np.ndarray]:
        """E and G, MPa, whatever the temperature is."""
        like = np.ones_like(np.asarray(temperature, float))
        return self.E * like, self.G * like

    def columns(self, components: int) -> int:
        """Length of the state of a point with 3 stresses.

        Raises:
            InputError: with 6 stresses.
        """
        if components != 3:
            self.refuse("law", "a law of one's own has three stresses; give mesh.section.kind: curved or plane")
        return components + self.width

    @property
    def returns_cold(self) -> bool:
        """No: the exponential return map is another law."""
        return False

    def parts(self, parameters: np.ndarray | None = None) -> Any:
        """What the compiled loops take as the law."""
        return PointLaw(self._loop.address, simple(self.values))

    def content(self) -> bytes:
        """The function's text and its parameters, for a digest."""
        return hashlib.sha256("".join(_texts(self.update)).encode()).digest() + self.values.tobytes()


def _texts(function: Any) -> list[str]:
    """The text of a function, and of the compiled ones that it holds, as a condensed law holds its own."""
    plain = function.py_func
    try:
        texts = [inspect.getsource(plain)]
    except OSError:  # typed in at a prompt
        texts = [plain.__code__.co_code.hex()]
    held = (cell.cell_contents for cell in plain.__closure__ or ())
    return texts + [text for one in held if hasattr(one, "py_func") for text in _texts(one)]


def _loop(update: Update) -> Any:
    """A compiled loop over points, as `flow_points`."""

    @cfunc(LOOP, **OPTIONS)
    def loop(law: Any, n: int, old: Any, strain: Any, new: Any, tangent: Any, with_tangent: bool, count: Any) -> bool:
        one, C, good = np.empty(3), np.empty((3, 3)), True
        for k in range(len(count)):
            one[0], one[1], one[2] = strain[0, k], strain[1, k], strain[2, k]
            solved = update(old[k, :3], old[k, 3:], one, law.plastic, new[k, :3], new[k, 3:], C)
            count[k] = 1 if solved else -1
            good = good and solved
            for i in range(3):
                for j in range(3):
                    tangent[3 * i + j, k] = C[i, j]
        return good

    return loop
