"""Arrays as text: the bits of their single-precision numbers, which a page unpacks without parsing each number."""

import base64
import math
from typing import Any

import numpy as np

KEY = "f4"


def packed(value: Any) -> Any:
    """Plain data with every array as `{"f4": base64, "shape": [...]}`; short ones as lists.

    A number that is not finite becomes None wherever a page reads text, since JSON has none.
    """
    if isinstance(value, np.ndarray):
        if value.dtype.kind != "f" or value.size < 24:
            return packed(value.tolist())
        bits = np.ascontiguousarray(value, dtype="<f4").tobytes()
        return {KEY: base64.b64encode(bits).decode("ascii"), "shape": list(value.shape)}
    if isinstance(value, dict):
        return {key: packed(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [packed(one) for one in value]
    if isinstance(value, np.generic):
        return packed(value.item())
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
