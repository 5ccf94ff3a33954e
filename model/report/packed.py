"""Arrays as text: the bits of their single-precision numbers, which a page unpacks without parsing each number."""

import base64
from typing import Any

import numpy as np

KEY = "f4"


def packed(value: Any) -> Any:
    """Plain data with every array as `{"f4": base64, "shape": [...]}`; short ones as lists."""
    if isinstance(value, np.ndarray):
        if value.dtype.kind != "f" or value.size < 24:
            return (
                [None if isinstance(one, float) and one != one else one for one in value.tolist()]
                if value.ndim == 1
                else value.tolist()
            )
        bits = np.ascontiguousarray(value, dtype="<f4").tobytes()
        return {KEY: base64.b64encode(bits).decode("ascii"), "shape": list(value.shape)}
    if isinstance(value, dict):
        return {key: packed(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [packed(one) for one in value]
    if isinstance(value, np.generic):
        return value.item()
    return value
