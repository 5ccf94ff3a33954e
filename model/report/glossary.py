"""Words of the report, told in a sentence; a reader meets them on the words themselves."""

GLOSSARY = {
    "set": "How much shorter the spring is for good after it was pressed and let go.",
    "free length": "Outer length of the spring without load.",
    "block": "Where each coil lies on the next; the spring cannot be pressed further.",
    "block height": "Height of the spring at block, by its geometry.",
    "rate": "Force for a millimetre of travel; the slope of the characteristic.",
    "initial rate": "Rate of the spring before anything yields or touches.",
    "residual shear stress": "Shear stress that stays in the wire when no force is on the spring. Against the load it "
    "lets the spring carry more: the load must undo it first.",
    "inside of the coil": "The side of the wire that looks at the spring's axis. There the stress is greatest, and "
    "there springs break.",
    "travel": "How far the seats have come together from where the spring was free.",
    "steps": "Pieces of the way for each of which an equilibrium was found.",
    "plastic work": "Work that deformation for good has taken in a volume of the wire; the material's data are known "
    "up to a limit of it.",
}
