"""The material of a case: a law of the library or of a file, or that of a wire of a standard by its name."""

from types import ModuleType

from coilset.meshes.springs.geometry import Spring
from coilset.model.core.base.package import package
from coilset.model.core.case.case import Case
from coilset.model.core.case.loading import is_pressed
from coilset.model.core.case.targets import check_known
from coilset.model.core.material import library
from coilset.model.core.material.law.law import Law
from coilset.model.core.material.law.steel import STEEL, Elastic


def _wires() -> ModuleType:
    """The door to wires of standards."""
    return package("coilset.model.tools.wires.law", "a wire by its name", "material.wire")


def case_law(case: Case, spring: Spring) -> Law:
    """The law of a case's material: from the library, from a file, or of a wire by its name and the spring's wire.

    Raises:
        InputError: an unknown material or wire, a wrong file, or a wire whose diameter is not constant.
    """
    if isinstance(case.material, str):
        return library.load(case.material, spin=case.mesh.section.spin)
    wires = _wires()
    found: Law = wires.wire_law(
        case.material.wire, wires.wire_diameter(spring), case.mesh.section.spin, case.temperature
    )
    return found


def case_elastic(case: Case, law: Law) -> Elastic:
    """Moduli of a case's material at the temperature of its spring, and the density of steel.

    Raises:
        InputError: a temperature outside the material's table.
    """
    if isinstance(case.material, str):
        check_known(law, case.temperature, "temperature")
    E, G = law.moduli(law.reference_temperature if case.temperature is None else case.temperature)
    return Elastic(float(G), float(E), STEEL.density)


def case_strength(case: Case, spring: Spring) -> float | None:
    """Tensile strength Rm of a case's wire, MPa: its standard's minimum, or that of a material file; else None."""
    if isinstance(case.material, str):
        return library.load(case.material).data.tensile_strength
    wires = _wires()
    found: float = wires.wire(case.material.wire).strength(wires.wire_diameter(spring))
    return found


def case_allowed(case: Case, spring: Spring) -> tuple[float | None, str]:
    """Shear stress allowed at block for a case's wire, MPa, and which stress it limits.

    None without such a wire, and of a spring that is no compression spring.
    """
    if isinstance(case.material, str) or not is_pressed(case, spring):
        return None, ""
    wires = _wires()
    known = wires.wire(case.material.wire)
    return known.block_stress(wires.wire_diameter(spring)), known.entry.block_stress.of
