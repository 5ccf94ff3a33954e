"""Where the nodes of a line mesh stand along the wire."""

import numpy as np
from coilset.meshes import functions
from coilset.model.errors import InputError


def stations(spring, elements_per_turn=16, sagitta=None):
    """Turns at which the nodes stand.

    The number of elements in a turn is a density over the turn; its integral, rounded up, is the number of elements,
    and every element has an equal part of it.

    Args:
        spring: `Spring`.
        elements_per_turn: a number, or a `Table` of numbers over the turn.
        sagitta: if given, elements are also so short that their chord leaves the centre line by no more than this, mm.

    Returns:
        Increasing turns from 0 to the last turn, shape (elements + 1,).

    Raises:
        InputError: fewer than four elements in a turn, or no positive sagitta.
    """
    table = hasattr(elements_per_turn, "function")
    if not table and not elements_per_turn >= 4:
        raise InputError(f"must be at least 4, not {elements_per_turn:g}", "mesh.elements_per_turn")
    if sagitta is not None and not sagitta > 0:
        raise InputError(f"must be greater than 0 mm, not {sagitta:g}", "mesh.sagitta")
    given = elements_per_turn.function(spring.turns) if table else functions.constant(elements_per_turn, spring.turns)

    def density(t):
        if sagitta is None:
            return given(t)
        # sagitta = κ h²/8, h the element's length
        return np.maximum(given(t), spring.speed(t) * np.sqrt(spring.curvature(t) / (8 * sagitta)))

    breaks = np.unique(np.concatenate([spring.breaks, given.x]))
    count = np.concatenate([[0.0], np.cumsum(functions.integral(density, breaks, points=2))])
    elements = int(np.ceil(count[-1] * (1 - 1e-9)))
    if not table and sagitta is None:
        return np.linspace(0.0, spring.turns, elements + 1)
    return np.interp(np.linspace(0.0, count[-1], elements + 1), count, breaks)
