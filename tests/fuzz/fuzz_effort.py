"""How long the fuzzer looks: COILSET_FUZZ files of all kinds together, and a tenth of it command lines.

Without it a few, the same ones each time; with it others each time, and how to see a finding again is printed.
"""

import os

from hypothesis import HealthCheck, settings

FILES = int(os.environ.get("COILSET_FUZZ", "300"))
SEARCHED = "COILSET_FUZZ" in os.environ


def looks(share: float) -> settings:
    """Settings of a test that looks at a share of the files."""
    return settings(
        max_examples=max(int(share * FILES), 1),
        deadline=None,
        database=None,
        derandomize=not SEARCHED,
        print_blob=SEARCHED,
        suppress_health_check=list(HealthCheck),
    )
