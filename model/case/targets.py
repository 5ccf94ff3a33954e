"""Targets judged before a run: seats only press, and no seat comes nearer than the wires between them allow."""

from coilset.meshes.errors import InputError
from coilset.meshes.geometry import Spring
from coilset.model.case.case import Case
from coilset.model.case.phases import Target

SLACK = 1e-9  # of the free length: rounding of a height that was computed


def check_targets(case: Case, spring: Spring) -> None:
    """Refuse targets on seats that would have to pull.

    Raises:
        InputError: a negative force or travel, or a height above the free length, with the numbers.
    """
    if case.ends != "seats":
        return
    for number, phase in enumerate(case.loading):
        if isinstance(phase.to, Target):
            _only_press(phase.to, spring.free_length, f"loading.{number}.to")


def _only_press(target: Target, free_length: float, place: str) -> None:
    pull = "seats cannot pull; give 0 or more, or ends: clamped"
    if target.force is not None and target.force < 0.0:
        raise InputError(f"is {target.force:g} N, but {pull}", f"{place}.force")
    if target.travel is not None and target.travel < -SLACK * free_length:
        raise InputError(f"is {target.travel:g} mm, but {pull}", f"{place}.travel")
    if target.height is not None and target.height > (1.0 + SLACK) * free_length:
        raise InputError(f"is {target.height:g} mm, above the free length of {free_length:.6g} mm, but seats cannot "
                         "pull; give a height up to it, or ends: clamped", f"{place}.height")  # fmt: skip
