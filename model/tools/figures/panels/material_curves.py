"""The material of the wire: one point under reversed torsion, at the temperature of the spring."""

import json
from math import isfinite

from coilset.model.core.base.errors import InputError
from coilset.model.core.material.law.file import MaterialFile
from coilset.model.core.material.law.law import Law
from coilset.model.core.results.files.opened import Run
from coilset.model.tools.figures.panels.panel import Panel, axis, curve
from coilset.model.tools.identification.programs import History, Program, Step, run

FAR = 12.0  # yield strains of torsion to which the point is twisted
INCREMENTS = 60


def material_curve(results: Run) -> Panel | None:
    """Shear stress over shear strain, forwards and back; None of a law that never yields, or warms out of its table."""
    law = Law(MaterialFile.model_validate(json.loads(results.data.attrs["material_file"])))
    if not isfinite(law.yield_stress):
        return None
    low, high = law.temperature_range
    temperature = results.case.get("temperature") or low
    try:
        history = there_and_back(law, temperature)
    except InputError:
        return None
    far = history.strain[INCREMENTS, 1]
    at = f" at {temperature:g} K" if low < high else ""
    finding = f"{law.name}{at}: twisted to {100.0 * far:.2g} % shear, {abs(history.stress[INCREMENTS, 1]):.0f} MPa"
    return Panel(
        "material",
        finding,
        f"{finding}. Shear stress over shear strain of one point, there, back, and again.",
        [curve(100.0 * history.strain[:, 1], history.stress[:, 1], 0, showlegend=False)],
        {"xaxis": axis("shear strain, %"), "yaxis": axis("shear stress, MPa")},
        note=law.data.description + ". Source: " + law.data.source,
    )


def there_and_back(law: Law, temperature: float) -> History:
    """Twist one point to FAR yield strains, back as far, and there again.

    Args:
        law: of a material that yields.
        temperature: of the point, K.

    Raises:
        InputError: if the temperature lies outside the material's table.
    """
    far = FAR * law.yield_stress / (3.0**0.5 * law.G)
    steps = [Step(to={"gamma12": to}, increments=number * INCREMENTS) for number, to in ((1, far), (2, -far), (2, far))]
    return run(law, Program(name="there and back", temperature=temperature, steps=tuple(steps)))
