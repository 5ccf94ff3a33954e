"""The kinds of warnings in words, for pages that count them."""

KINDS = {
    "active turns": "few turns are active",
    "buckled": "the spring buckles",
    "buckling": "the spring is slender and may buckle without a guide",
    "coils slipped": "coils slip past each other",
    "contact mesh": "the mesh is coarse for contact",
    "creep": "the load loss is extrapolated beyond the tests of creep",
    "duration": "the run takes long",
    "earlier name": "an entry has its earlier name",
    "elastic warping": "the warping of a wire that is not round is that of elastic wire",
    "endurance": "the stress range exceeds the fatigue data",
    "estimate": "the hardening of the wire is an estimate from its tensile strength",
    "gap": "the gaps between the coils are smaller than the standard requires",
    "fatigue": "the finished spring has no safety against fatigue, or it could not be computed",
    "ground flat": "the flat of a ground end has an unusual length",
    "error": "the estimated error exceeds the accuracy required",
    "ground tip": "the tip of a ground end has an unusual thickness",
    "hands": "both springs are wound in the same direction",
    "index": "the spring index D/d is outside the usual range",
    "initial rate": "the initial rate could not be computed",
    "lift-off": "an end lifts off its seat",
    "peened layer": "the integration points are too coarse for the peened layer",
    "measured axis": "the measured axis is away from the z axis of its file",
    "negative set": "the spring is longer after compression",
    "penetration": "contacts penetrate more than allowed",
    "plastic work": "the plastic work exceeds the range of the material's data",
    "presetting": "presetting causes little set",
    "snapped": "the spring snaps through",
    "solid coils": "coils touch before any load",
    "step error": "the error of the steps exceeds the accuracy required",
    "strength": "the stress exceeds the tensile strength",
    "stress": "the stress exceeds the permissible one of the standard",
    "support": "no spring with these ends is supported so",
    "temperature": "the strength of the warm wire is unknown",
    "limit": "a result is outside the limits of the case",
    "unknown error": "the error of the steps could not be estimated",
    "unstable": "states are unstable",
    "wall": "the coils are solid before the calculated block height is reached",
    "working length": "a working length is not reached",
    "working set": "the spring sets further at its working lengths",
    "wire": "the wire diameter is outside the usual range",
}


def in_words(kind: str) -> str:
    """A kind of warning, as `Warning.name` has it, in words."""
    return KINDS.get(kind, kind.replace("_", " "))
