"""Why conditions are not met: the range reached within its bounds, from runs, and the reason if it is known."""

import itertools

import numpy as np
from scipy.optimize import minimize

from coilset.model.core.base.errors import InputError
from coilset.model.tools.design.conditions import Condition
from coilset.model.tools.design.evaluation import Evaluation
from coilset.model.tools.design.search import Found, Search

LOOKS = {1: 7, 2: 3}  # runs along each unknown, by the number of unknowns
SAMPLES = 200  # corners evaluated by the surrogate for more unknowns
WINDING = ("spring.pitch", "spring.free_length")  # entries that determine the length of the spring as wound
BACK = 0.05  # of the bounds' width, step of the finite difference
STIFF = 0.2  # mm of final length per mm of length as wound, below which winding longer no longer helps
FULLY_PLASTIC = 4.0 / 3.0  # of the yield torque of a round wire: ∫ τ r 2π r dr = (2π/3) r³ τ over (π/2) r³ τ
DEAD = 1e-4  # singular value over the largest one, below which no condition depends on a direction


def look_around(search: Search, found: Found) -> None:
    """Run springs over all the bounds, and where the mapped surrogate is lowest and highest for each condition."""
    n = len(search.width)
    if n in LOOKS:
        for place in itertools.product(np.linspace(0.0, 1.0, LOOKS[n]), repeat=n):
            search.full(np.array(place))
    else:
        answer = search.mapped(found.error)
        for number, sign in itertools.product(range(len(search.conditions)), (1.0, -1.0)):
            places = np.random.default_rng(0).random((SAMPLES, n)).round()  # corners
            search.full(min(places, key=lambda place: sign * answer(place)[number]))


def nearest_seen(search: Search) -> Evaluation:
    """The run with the smallest deviation."""
    good = [one for one in search.evaluations if not one.failed]
    return min(good, key=lambda one: float(np.linalg.norm(search.missed(search.off(one.values)))))


def refuse(search: Search, found: Found) -> None:
    """Explain why the conditions cannot be met, from all runs.

    Raises:
        InputError: always.
    """
    good = [one for one in search.evaluations if not one.failed]
    for number, one in enumerate(search.conditions):
        values = np.array([run.values[number] for run in good])
        low, high = good[int(values.argmin())], good[int(values.argmax())]
        least, most = float(values.min()), float(values.max())
        if all(one.missed(one.off(value)) for value in (least, most)) and not least <= one.target <= most:
            near, end = (high, "maximum") if one.target > most else (low, "minimum")
            reason = plastic_reason(search, near) if one.target > most and "free_length_after" in one.name else ""
            raise InputError(
                f"{one.wanted} is out of reach{_at(one)}: between the bounds it goes from about {least:.6g} "
                f"to {most:.6g} {one.unit}, the {end} with {search.words(near.x)}{reason}",
                one.name,
            )
    worst = int(np.abs(search.missed(found.off)).argmax())
    one = search.conditions[worst]
    nearest = ", ".join(
        f"{other.words} {value:.6g} for {other.wanted}"
        for other, value in zip(search.conditions, found.best.values, strict=True)
    )
    raise InputError(
        f"{one.wanted}{_at(one)} cannot be met together with the other conditions between "
        f"these bounds{_with_others_met(search, found, worst)}; the nearest found is {nearest}, with "
        f"{search.words(found.best.x)}{unfelt(search, found)}",
        one.name,
    )


def unfelt(search: Search, found: Found) -> str:
    """Names of unknowns on which no condition depends where the search ended; empty if there are none."""
    _, sizes, directions = np.linalg.svd(found.slopes)
    if sizes[-1] > DEAD * sizes[0]:
        return ""
    names = [name for name, part in zip(search.names, directions[len(sizes) - 1], strict=True) if abs(part) > 0.3]
    return f"; no condition depends on {' with '.join(names)} there"


def plastic_reason(search: Search, near: Evaluation) -> str:
    """Whether longer winding does not help because the wire is fully plastic, in words; empty if it does."""
    names = search.names
    column = next((names.index(name) for name in WINDING if name in names), None)
    torque = search.evaluator.guess(near.x).torque
    if torque <= 1.0:
        return ""
    said = f"; the torque of its wire comes to {torque:.3g} times that at which the surface yields"
    if column is None:
        return said
    back = search.part(near.x)
    back[column] -= BACK if back[column] > 0.0 else -BACK
    other = search.full(back)
    if other.failed:
        return said
    change = near.summary["free_length_before_mm"] - other.summary["free_length_before_mm"]
    slope = (near.summary["free_length_after_mm"] - other.summary["free_length_after_mm"]) / change
    if slope > STIFF:
        return said
    return (
        f"{said}, and it is fully plastic at {FULLY_PLASTIC:.3g} times without hardening: beyond that no longer "
        f"winding makes a longer spring ({slope:.2g} mm for each mm here)"
    )


def _with_others_met(search: Search, found: Found, worst: int) -> str:
    """The range of a condition where the others are met, by the mapped surrogate; empty if there is no such point."""
    answer, others = search.mapped(found.error), np.arange(len(found.off)) != worst

    def missed(u: np.ndarray) -> np.ndarray:
        return search.missed(answer(u))[others]

    values = []
    for sign in (1.0, -1.0):
        end = minimize(
            lambda u, sign=sign: sign * answer(u)[worst],
            found.error.about,
            method="SLSQP",
            bounds=[(0.0, 1.0)] * len(search.width),
            options={"maxiter": 40},
            constraints={"type": "eq", "fun": missed},
        )
        if np.abs(missed(end.x)).max(initial=0.0) > 1e-3:
            return ""
        one = search.conditions[worst]
        values.append(one.target + one.size * float(answer(end.x)[worst]))
    return f": with these met it goes from about {min(values):.4g} to {max(values):.4g} {search.conditions[worst].unit}"


def _at(one: Condition) -> str:
    return f" at {one.height:g} mm" if one.height is not None else ""
