"""The numbers of a wire in words, each with its certainty and its sources."""

from collections.abc import Sequence

from coilset.model.tools.wires.wire import Wire
from coilset.model.tools.wires.wire_file import (
    TESTED,
    Endurance,
    Logarithm,
    Number,
    Power,
    Sourced,
    Steps,
    Strength,
    Table,
    Tolerance,
)

LABELS = {
    "young_modulus": ("Young's modulus E", "MPa"),
    "shear_modulus": ("shear modulus G", "MPa"),
    "density": ("density", "kg/mm³"),
    "shear_modulus_decrease": ("decrease of G over its value", "1/K"),
    "highest_temperature": ("highest temperature of use", "K"),
    "strength": ("minimum tensile strength Rm", "MPa"),
    "block_stress": ("shear stress allowed at block", "Rm"),
    "elastic_limit": ("elastic limit in tension", "Rm"),
    "proof_stress": ("0.2 % proof stress", "Rm"),
    "diameter_tolerance": ("tolerance of the diameter ±", "mm"),
}


WIRE_COLUMNS = (
    "wire",
    "d, mm",
    "Rm, MPa",
    "G, GPa",
    "E, GPa",
    "dG, ‰/K",
    "block/Rm",
    "limit/Rm",
    "Rp0.2/Rm",
    "endurance",
)
MARKS = {"checked against a second source": "", "one source": "'", "estimate": "~"}


def table_row(wire: Wire) -> list[str]:
    """What is known of a wire, under WIRE_COLUMNS, from its least to its greatest diameter, with marks of certainty."""
    entry, (low, high) = wire.entry, (wire.ranges[0][0], wire.ranges[-1][1])

    def ends(known: Sourced | None, first: float, last: float, digits: int) -> str:
        if known is None:
            return "–"
        texts = dict.fromkeys(f"{value:.{digits}g}" for value in (first, last))
        return "–".join(texts) + MARKS[known.sure]

    def over(number: Number | None, digits: int, factor: float = 1.0) -> str:
        return "–" if number is None else ends(number, factor * number.at(low), factor * number.at(high), digits)

    lines = ", ".join(f"{line.surface}{MARKS[line.sure]}" for line in entry.endurance)
    return [
        wire.name,
        f"{low:.3g}–{high:.3g}",
        ends(entry.strength, wire.strength(low), wire.strength(high), 4),
        over(entry.shear_modulus, 3, 1e-3),
        over(entry.young_modulus, 3, 1e-3),
        over(entry.shear_modulus_decrease, 2, 1e3),
        ends(entry.block_stress, entry.block_stress.at(low), entry.block_stress.at(high), 2),
        over(entry.elastic_limit, 2),
        over(entry.proof_stress, 2),
        lines or "–",
    ]


def described(wire: Wire) -> list[tuple[str, str, str]]:
    """All data of a wire: quantity, value over the diameter d in mm, and certainty with sources."""
    found = []
    for name, entry in wire.entry.sourced():
        label, unit = LABELS.get(name, (name, "MPa"))
        found.append((label, f"{_number(entry)} {unit}{_which(entry)}", wire.citation(entry)))
    return found


def _which(entry: Sourced) -> str:
    of = getattr(entry, "of", None)
    return f", {of}" if of else ""


def _number(entry: Sourced) -> str:
    match entry:
        case Number(value=None, up_to=tuple() as ends, values=tuple() as values):
            return _over(ends, values)
        case Number():
            return f"{entry.value:g}"
        case Tolerance():
            return _over(entry.up_to, entry.plus_minus)
        case Strength():
            most = f", at most {entry.greatest:g}" if entry.greatest else ""
            return "; ".join(_piece(piece) for piece in entry.pieces) + most
        case Endurance():
            points = {"0": entry.at_zero, _lg(entry.knee): entry.limit}
            cycle = ", ".join(f"{_lg(upper)} over {lower}" for lower, upper in points.items())
            return f"{entry.cycles:g} times, {TESTED[entry.springs]}: upper stress {cycle}"
    raise TypeError(type(entry))


def _piece(piece: Logarithm | Power | Table | Steps) -> str:
    low, high = piece.diameters
    match piece:
        case Logarithm():
            text = _lg((piece.at_1_mm, piece.per_decade))
        case Power():
            text = f"{piece.at_1_mm:g}/d^{piece.exponent:g}"
        case Table():
            text = f"table from {piece.values[0]:g} to {piece.values[-1]:g}"
        case Steps():
            text = f"steps from {piece.values[0]:g} to {piece.values[-1]:g}"
    return f"d = {low:g} to {high:g}: {text}"


def _lg(pair: tuple[float, float]) -> str:
    return f"{pair[0]:g} − {pair[1]:g} lg d"


def _over(ends: Sequence[float], values: Sequence[float]) -> str:
    return ", ".join(f"to d = {end:g}: {value:g}" for end, value in zip(ends, values, strict=True))
