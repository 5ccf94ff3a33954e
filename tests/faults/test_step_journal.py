"""Steps of a checkpoint: each written once; what lies behind the last state does not count."""

from dataclasses import fields

import numpy as np
import pytest

from coilset.model.core.results.files.step_journal import StepJournal
from coilset.model.core.results.records.frame import Frame
from coilset.model.core.results.records.record import WHOLE, SeatReaction, SeatReactions, Step

NONE = SeatReaction(*[float("nan")] * len(fields(SeatReaction)))


def steps(count):
    return [Step(k, 0, 0.1 * k, 30.0 / 7.0 * k, 0.0, 1e-300 * k, 3, 4, 0, 0, 2, 0.0) for k in range(1, count + 1)]


def seats(count):
    rng = np.random.default_rng(1)
    rows = [dict.fromkeys(WHOLE, np.nan) | {"step": k, "active_turns": 2.5} for k in range(1, count + 1)]
    return [SeatReactions(**row, bottom=NONE, top=NONE, pressure=rng.random((row["step"] - 1, 3))) for row in rows]


def frames(count):
    rng = np.random.default_rng(2)
    return [Frame(rng.random((4, 3)), rng.random((3, 24)).astype(np.float32)) for _ in range(count)]


def test_steps_come_back_to_the_bit(tmp_path):
    StepJournal(tmp_path / "steps").append(steps(4), seats(4), frames(4))
    found, reactions, wires = StepJournal(tmp_path / "steps").read(4)
    for one, other in zip(wires, frames(4), strict=True):
        assert one.x.tobytes() == other.x.tobytes()
        assert one.shear.tobytes() == other.shear.tobytes()
        assert one.shear.shape == (3, 24)
    assert list(found) == steps(4)
    for one, other in zip(reactions, seats(4), strict=True):
        np.testing.assert_array_equal(one.pressure, other.pressure)
        assert one.bottom.force_N is not None


def test_a_step_writes_none_before_it(tmp_path):
    """The cost of a step must not grow with their number."""
    journal = StepJournal(tmp_path / "steps")
    journal.append(steps(2), seats(2), frames(2))
    before = (tmp_path / "steps").read_bytes()
    marked = before.replace(b'"iterations": 3', b'"iterations": 7')
    (tmp_path / "steps").write_bytes(marked)
    journal.append(steps(3), seats(3), frames(3))
    assert (tmp_path / "steps").read_bytes().startswith(marked)
    assert (tmp_path / "steps").read_bytes().count(b"\n") == 3


@pytest.mark.parametrize("rest", [b"", b'{"step": {"numb'])
def test_what_a_killed_run_wrote_behind_its_state_is_written_again(tmp_path, rest):
    path = tmp_path / "steps"
    StepJournal(path).append(steps(5), seats(5), frames(5))
    undisturbed = path.read_bytes()
    path.write_bytes(undisturbed + rest)
    journal = StepJournal(path)
    journal.read(3)
    journal.append(steps(5), seats(5), frames(5))
    assert path.read_bytes() == undisturbed
    with pytest.raises(ValueError, match="5 steps of 6"):
        journal.read(6)
