"""Sensitivity of a response to each input."""

from dataclasses import dataclass

import numpy as np
from scipy import stats

RESAMPLES = 200
CONFIDENCE = 0.95


@dataclass(frozen=True)
class Indices:
    """Sobol indices of one response, shape (inputs,); the intervals have shape (inputs, 2).

    Attributes:
        first: share of the variance explained by an input alone; total: including its interactions.
        first_interval, total_interval: 95 % intervals by bootstrap.
        samples: number of base samples used.
    """

    first: np.ndarray
    total: np.ndarray
    first_interval: np.ndarray
    total_interval: np.ndarray
    samples: int


def sobol_indices(values: np.ndarray, inputs: int, samples: int, seed: int = 0) -> Indices | None:
    """First-order and total Sobol indices from the cases of the design `sobol_indices`.

    Args:
        values: response of the cases in the design's order (blocks A, B, AB₁ …), shape (samples (inputs + 2),). Base
            samples in which a case has no value are left out; of the others, the largest power of 2 is used.
        inputs: number of inputs.
        samples: base samples.
        seed: of the bootstrap.

    Returns:
        Indices; None if fewer than 2 base samples are left, or the response is constant: no variance has a share.
    """
    blocks = np.asarray(values, dtype=float).reshape(inputs + 2, samples)
    good = np.flatnonzero(np.isfinite(blocks).all(axis=0))
    if len(good) < 2:
        return None
    n = 2 ** int(np.log2(len(good)))
    blocks = blocks[:, good[:n]]
    if np.ptp(blocks[:2]) == 0.0:
        return None
    rng = np.random.default_rng(seed)
    again = np.array([_shares(blocks[:, rng.integers(n, size=n)]) for _ in range(RESAMPLES)])
    ends = 0.5 - 0.5 * CONFIDENCE, 0.5 + 0.5 * CONFIDENCE
    first, total = _shares(blocks)
    first_interval, total_interval = np.quantile(again, ends, axis=0).transpose(1, 2, 0)
    return Indices(first, total, first_interval, total_interval, n)


def _shares(blocks: np.ndarray) -> np.ndarray:
    """First-order and total indices by the estimators of Saltelli et al., Comput. Phys. Commun. 181 (2010) 259.

    SciPy has them too, but fails for a single input, and its bootstrap takes no seed.

    Args:
        blocks: A, B, AB₁ …, shape (inputs + 2, samples).

    Returns:
        Shape (2, inputs); 0 where A and B are constant.
    """
    A, B, AB = blocks[0], blocks[1] - blocks[:2].mean(), blocks[2:]
    parts = np.array([np.mean(B * (AB - A), axis=1), 0.5 * np.mean((AB - A) ** 2, axis=1)])
    variance = blocks[:2].var()
    return parts / variance if variance > 0.0 else np.zeros_like(parts)


def rank_correlation(x: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Spearman's rank correlation of a response with each input, and its 95 % interval by Fisher's transformation.

    Args:
        x: inputs, shape (cases, inputs).
        values: response, shape (cases,); cases without one are left out.

    Returns:
        Correlations, shape (inputs,), and intervals, shape (inputs, 2); NaN where an input or the response is constant,
        or fewer than 4 cases are left.
    """
    good = np.isfinite(values)
    correlation = np.full(x.shape[1], np.nan)
    if good.sum() >= 4 and np.ptp(values[good]) > 0.0:
        varied = np.flatnonzero(np.ptp(x[good], axis=0) > 0.0)
        correlation[varied] = [stats.spearmanr(x[good, k], values[good]).statistic for k in varied]
    # standard error of artanh ρ for Spearman's ρ: 1.03/sqrt(n − 3) (Fieller, Hartley and Pearson, Biometrika 44 (1957))
    reach = stats.norm.ppf(0.5 + 0.5 * CONFIDENCE) * 1.03 / np.sqrt(max(good.sum() - 3, 1))
    middle = np.arctanh(np.clip(correlation, -1.0 + 1e-15, 1.0 - 1e-15))
    return correlation, np.tanh(np.stack([middle - reach, middle + reach], axis=1))
