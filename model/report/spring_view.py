"""The spring in space, to turn and to step through its load program, coloured by the stress on its surface."""

import numpy as np

from coilset.model.report.panel import DIVERGING, Panel
from coilset.model.report.scale import round_end
from coilset.model.report.wire import tubes
from coilset.model.results.opened import Run


def spring_view(run: Run) -> Panel:
    """One tube a snapshot, all on one scale."""
    places, stress = tubes(run)
    end = round_end(float(np.abs(stress).max()))
    traces = []
    for number, (place, value) in enumerate(zip(places, stress, strict=True)):
        x, y, z = np.moveaxis(place, -1, 0)
        traces.append(
            {
                "type": "surface",
                "x": x,
                "y": y,
                "z": z,
                "surfacecolor": value,
                "cmin": -end,
                "cmax": end,
                "colorscale": DIVERGING,
                "meta": {"choice": number},
                "colorbar": {"title": {"text": "MPa"}, "thickness": 14, "len": 0.8},
                "lighting": {"ambient": 0.75, "diffuse": 0.5, "specular": 0.1},
                "hovertemplate": "%{surfacecolor:.0f} MPa<br>height %{z:.1f} mm<extra></extra>",
            }
        )
    low, high = places.reshape(-1, 3).min(axis=0), places.reshape(-1, 3).max(axis=0)
    ranges = {name: {"range": [low[k], high[k]], "title": {"text": f"{name}, mm"}} for k, name in enumerate("xyz")}
    last = run.snapshots[-1]
    scene = {f"{name}axis": value for name, value in ranges.items()}
    eye = {"x": 1.3, "y": -1.3, "z": 0.5}
    return Panel(
        "spring",
        "Red is sheared with the load, blue against it",
        f"The spring in three dimensions at {', '.join(run.snapshots)}, coloured by the shear stress about the wire's "
        f"axis on its surface from {-end:g} to {end:g} MPa. At {last} it is {stress[-1].min():.0f} to "
        f"{stress[-1].max():.0f} MPa.",
        traces,
        {"scene": {**scene, "aspectmode": "data", "camera": {"eye": eye}}, "margin": {"l": 0, "r": 0, "t": 0, "b": 0}},
        tuple(run.snapshots),
        height=520,
        note="Drag to turn, scroll or pinch to come nearer.",
    )
