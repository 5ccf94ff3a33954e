"""Distributions along the wire: stress at the inside and the outside of the coil, moments of the sections."""

import numpy as np

from coilset.model.core.results.files.opened import Run
from coilset.model.core.results.records.labels import plain
from coilset.model.tools.figures.panels.panel import Panel, axis, curve, with_unit
from coilset.model.tools.figures.wire_surface import inside, loading_stress, section_turns, shear_around

SIDES = (("inside of the coil", 0.0, "solid"), ("outside", np.pi, "dash"))
SHOWN = {"Mt": "torque Mt", "M2": "bending moment M2", "M3": "bending moment M3"}


def stress_along_wire(run: Run) -> Panel:
    """Shear on the surface over the turns at all snapshots, inside and outside of the coil; of a torsion spring the
    stress along the wire."""
    turned = run.is_turned
    turns, shear, traces = section_turns(run).ravel(), loading_stress(run)[1] if turned else shear_around(run), []
    for number, name in enumerate(run.snapshots[1:], start=1):
        for side, angle, dash in SIDES:
            place = round((inside(run).angle + angle) / (2.0 * np.pi) * shear.shape[-1]) % shear.shape[-1]
            values = shear[number, ..., place].ravel()
            traces.append(curve(turns, values, number - 1, dash=dash, name=f"{name}, {side}"))
    stays = run.summary["residual_shear_inside_MPa"]
    turn = run.summary.get("residual_shear_inside_turn")
    at = "" if turn is None else f" at turn {turn:.2f}"
    finding, stress, sign = "Shear stress along the wire", "shear about the wire's axis", "as in a compressed spring"
    if turned:
        stays, stress, sign = run.summary["residual_bending_inside_MPa"], "stress along the wire", "in tension"
        finding = "Stress along the wire, by bending"
        if stays is not None:
            finding = f"{with_unit(stays, 'MPa')} of bending stress remain at the inside of the coil"
    elif stays is not None:
        finding = f"{with_unit(stays, 'MPa')} of shear remain at the inside of the coil{at}"
    return Panel(
        "along_wire",
        finding,
        f"{finding}. The {stress} on the surface over the turns from the bottom tip, at the inside and the outside of "
        f"the coil, positive {sign}.",
        traces,
        {"xaxis": axis("turn from the bottom tip"), "yaxis": axis(f"{stress}, MPa")},
        height=420,
    )


def moments_along_wire(run: Run) -> Panel:
    """Torque and bending moments in the middle of the elements over the turns, one snapshot at a time.

    Within an element, which is straight, moments vary about those of the curved wire.
    """
    turns, traces = section_turns(run).mean(axis=-1), []
    bent, resultants = run.is_turned, run.data["resultants"].mean("gauss")
    loading = resultants.sel(resultant=["M2", "M3"] if bent else ["Mt"])
    moments = np.linalg.norm(loading.transpose("resultant", ...).values, axis=0)
    moment = moments.reshape(len(run.snapshots), -1).max(axis=1)
    most = int(moment.argmax())
    order = [*(number for number in range(len(run.snapshots)) if number != most), most]  # the last is shown first
    for choice, number in enumerate(order):
        for place, (key, name) in enumerate(SHOWN.items()):
            values = resultants.sel(resultant=key).values[number]
            traces.append(curve(turns, values, place, dash="solid", name=name, meta={"choice": choice}))
    kind = "bending moment" if bent else "torque"
    finding = f"The wire carries up to {plain(moment[most])} N mm of {kind}, at {run.snapshots[most]}"
    return Panel(
        "moments",
        finding,
        f"{finding}. Torque and bending moments of the wire's sections over the turns.",
        traces,
        {"xaxis": axis("turn from the bottom tip"), "yaxis": axis("moment, N mm")},
        tuple(run.snapshots[number] for number in order),
    )
