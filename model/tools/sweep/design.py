"""How inputs are combined: grids of their values, or samples of the unit cube mapped to their distributions."""

import itertools
import math
from typing import Any

import numpy as np

from coilset.model.core.base.errors import InputError
from coilset.model.tools.sweep.packed import Row, Rows
from coilset.model.tools.sweep.spec import SweepSpec

MOST = 10_000_000  # cases of a grid, whose rows take a gigabyte


def rows(spec: SweepSpec, base: Any) -> Rows:
    """The inputs of all cases.

    Args:
        base: value of each input in the base case, needed by one_at_a_time only, a dict.

    Returns:
        One row per case, the values in the order of `spec.vary`.

    Raises:
        InputError: an input that the design cannot use.
    """
    if spec.design in ("grid", "together", "one_at_a_time"):
        columns = [_grid(name, vary) for name, vary in spec.vary.items()]
        return Rows.of(_combine(spec, columns, base))
    cube = unit_cube(spec)
    return Rows([vary.at(cube[:, k]) for k, vary in enumerate(spec.vary.values())])


def _grid(name: str, vary: Any) -> list[Any]:
    try:
        return vary.grid()
    except ValueError as error:
        raise InputError(str(error), f"vary.{name}") from None


def _combine(spec: SweepSpec, columns: Any, base: Any) -> list[Row]:
    names = list(spec.vary)
    if spec.design == "grid":
        if (cases := math.prod(len(column) for column in columns)) > MOST:
            raise InputError(f"its grid has {cases:,} cases; give fewer values, or a sampling design", "vary")
        return list(itertools.product(*columns))
    if spec.design == "together":
        lengths = {name: len(column) for name, column in zip(names, columns, strict=True)}
        if len(set(lengths.values())) > 1:
            found = ", ".join(f"{name} {length}" for name, length in lengths.items())
            raise InputError(
                f"'together' pairs values in their order, so all inputs need equally many, not {found}", "vary"
            )
        return list(zip(*columns, strict=True))
    middle = [base[name] for name in names]
    varied = [(k, value) for k, column in enumerate(columns) for value in column if value != middle[k]]
    return [tuple(middle)] + [(*middle[:k], value, *middle[k + 1 :]) for k, value in varied]


def unit_cube(spec: SweepSpec) -> np.ndarray:
    """Points of the unit cube, shape (cases, inputs), strictly inside it.

    For `sobol_indices` they are the blocks A, B, AB₁ … AB_d of Saltelli et al., Comput. Phys. Commun. 181 (2010) 259:
    ABᵢ is A with column i from B.
    """
    from scipy.stats import qmc

    assert spec.samples is not None  # required by SweepSpec with these designs
    d, n = len(spec.vary), spec.samples
    rng = np.random.default_rng(spec.seed)
    if spec.design == "random":
        points = rng.random((n, d))
    elif spec.design == "latin_hypercube":
        points = qmc.LatinHypercube(d, rng=rng).random(n)
    else:
        double = 2 if spec.design == "sobol_indices" else 1
        points = qmc.Sobol(double * d, rng=rng).random(n)
    if spec.design == "sobol_indices":
        A, B = points[:, :d], points[:, d:]
        mixed = np.repeat(A[None], d, axis=0)
        for i in range(d):
            mixed[i, :, i] = B[:, i]
        points = np.concatenate([A, B, mixed.reshape(-1, d)])
    return np.clip(points, 1e-12, 1.0 - 1e-12)
