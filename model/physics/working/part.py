"""What working lengths add to a run: their numbers, and warnings of lengths that the finished spring cannot have."""

from typing import Any

import numpy as np

from coilset.model.core.results.records.part import Part
from coilset.model.core.results.records.record import Result, Setup, WorkingState
from coilset.model.core.results.stresses import peak_entries, shear_inside, shear_peak
from coilset.model.physics.working.working import LINE, plastic_rise, working_warnings

CROSSINGS = tuple(name for name in LINE if name.startswith("line_"))


def _numbers(setup: Setup, result: Result) -> dict[str, Any]:
    working = result.working
    if working is None:
        return {}
    entries = tuple(_entry(setup, result, state) for state in working.states)
    return {"working": entries, "working_set_mm": working.set}


def _entry(setup: Setup, result: Result, state: WorkingState) -> dict[str, Any]:
    shot, seats = state.snapshot, state.seats
    if shot is None or seats is None:
        return {f"{state.kind}_wanted": state.value, "reason": state.reason}
    stresses = [None if factor is None else factor * state.force for factor in setup.nominal_stress]
    inside, turn = shear_inside(setup, shot)
    return {
        f"{state.kind}_wanted": state.value,
        "reason": "",
        "length_mm": state.length,
        "force_N": state.force,
        "estimated_error": state.error,
        "rate_N_per_mm": state.rate if np.isfinite(state.rate) else None,
        "shear_MPa": stresses[0],
        "corrected_shear_MPa": stresses[1],
        "shear_inside_MPa": inside,
        "shear_inside_turn": turn,
        **peak_entries("shear_surface", shear_peak(setup, shot)),
        "allowed_MPa": setup.limits.shear,
        "allowed_of": setup.limits.shear_of if setup.limits.shear else "",
        "safety": _safety(setup, *stresses),
        "plastic_work_rise_N_per_mm2": plastic_rise(result, shot),
        "bottom_centre_x_mm": _known(seats.bottom.centre_x_mm),
        "bottom_centre_y_mm": _known(seats.bottom.centre_y_mm),
        "top_centre_x_mm": _known(seats.top.centre_x_mm),
        "top_centre_y_mm": _known(seats.top.centre_y_mm),
        "side_force_N": seats.side_force_N,
        **({} if setup.force_line is None else {f"{one}_mm": _known(getattr(seats, f"{one}_mm")) for one in CROSSINGS}),
    }


def _known(value: float) -> float | None:
    return value if np.isfinite(value) else None


def _safety(setup: Setup, stress: float | None, corrected: float | None) -> float | None:
    """Allowed over nominal shear stress, whichever of the two is limited."""
    of = corrected if setup.limits.shear_of == "corrected stress" else stress
    return setup.limits.shear / abs(of) if setup.limits.shear is not None and of else None


PART = Part(numbers=_numbers, found=(working_warnings,))
