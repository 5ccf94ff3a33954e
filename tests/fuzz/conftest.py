"""The fuzzer's modules, and how many files it had read."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))


def pytest_terminal_summary(terminalreporter):
    """What became of the files of each kind."""
    judge = sys.modules.get("fuzz_judge")
    if judge and judge.COUNTED:
        counts = ", ".join(f"{count:,} {what}" for what, count in sorted(judge.COUNTED.items()))
        terminalreporter.write_line(f"{sum(judge.COUNTED.values()):,} spoilt files: {counts}")
