"""Terms of the report, each explained in a sentence that the page shows on hover or focus."""

GLOSSARY = {
    "set": "Permanent loss of length after the spring was compressed and released.",
    "free length": "Length of the spring without load.",
    "block": "The state in which all coils touch; the spring cannot be compressed further.",
    "block height": "Height of the spring at block, from its geometry.",
    "rate": "Force per millimetre of travel; the slope of the characteristic.",
    "initial rate": "Rate of the spring before anything yields or touches.",
    "residual shear stress": "Shear stress that remains in the unloaded wire. If it acts against the load, the spring "
    "can carry more, because the load must first overcome it.",
    "maximum shear stress": "Largest shear stress on the wire's surface at the inside of the coil, under load.",
    "inside of the coil": "The side of the wire that faces the spring's axis. The stress is highest there, and springs "
    "break there.",
    "travel": "Distance by which the seats have approached each other since the spring was free.",
    "steps": "Increments of the load program; an equilibrium was found at the end of each.",
    "plastic work": "Work of the plastic deformation per volume of wire; the material's data are valid up to a "
    "given limit.",
}
