"""A standard spring wire: its properties at a diameter, and where each number comes from."""

from dataclasses import dataclass

from coilset.model.core.base.errors import InputError
from coilset.model.core.material.law.steel import Elastic
from coilset.model.tools.wires.wire_file import Endurance, Sourced, WireEntry

ROOM_TEMPERATURE = 293.15  # K


@dataclass(frozen=True)
class Wire:
    """A standard wire.

    Attributes:
        name: standard and grade, such as `EN 10270-1 SH`.
        standard: the first of them, the name of its file.
        entry: its numbers with their sources.
        sources: the meaning of the keys of the sources.
    """

    name: str
    standard: str
    entry: WireEntry
    sources: dict[str, str]

    def strength(self, diameter: float) -> float:
        """Minimum tensile strength Rm at a diameter in mm, N/mm².

        Raises:
            InputError: if the diameter is outside the known ranges.
        """
        value = self.entry.strength.at(diameter)
        if value is None:
            ranges = " and ".join(f"{low:g} to {high:g}" for low, high in self.ranges)
            raise InputError(
                f"the strength of '{self.name}' is unknown at {diameter:g} mm; it is given for {ranges} mm",
                "material.wire",
            )
        return value

    @property
    def ranges(self) -> list[tuple[float, float]]:
        """Ranges of diameters for which the strength is known, mm; ranges that touch are one."""
        joined: list[tuple[float, float]] = []
        for low, high in sorted(piece.diameters for piece in self.entry.strength.pieces):
            if joined and low <= joined[-1][1]:
                joined[-1] = (joined[-1][0], max(high, joined[-1][1]))
            else:
                joined.append((low, high))
        return joined

    def elastic(self, diameter: float) -> Elastic:
        """Moduli in MPa and density in kg/mm³ at a diameter in mm, 20 °C."""
        entry = self.entry
        return Elastic(*(number.at(diameter) for number in (entry.shear_modulus, entry.young_modulus, entry.density)))

    def block_stress(self, diameter: float) -> float:
        """Shear stress allowed at block, N/mm²: of the stress that `entry.block_stress.of` names."""
        return self.entry.block_stress.at(diameter) * self.strength(diameter)

    def diameter_tolerance(self, diameter: float) -> float | None:
        """Tolerance of the wire diameter, mm; None if unknown."""
        tolerance = self.entry.diameter_tolerance
        return None if tolerance is None else tolerance.at(diameter)

    def endurance(self, surface: str = "as coiled") -> Endurance | None:
        """Line of the Goodman diagram for a surface, `as coiled` or `shot peened`; None if unknown."""
        return next((line for line in self.entry.endurance if line.surface == surface), None)

    def citation(self, entry: Sourced) -> str:
        """The certainty of a number, its sources and its remark, in one line."""
        parts = [entry.sure, "; ".join(self.sources[key] for key in entry.sources), entry.remark]
        return ": ".join(part for part in parts if part)
