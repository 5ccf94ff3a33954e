"""What a law refuses: entries that do not go together, other units, and functions that violate the theory."""

from collections.abc import Callable
from typing import NoReturn

import numpy as np

from coilset.model.core.material.law.file import MaterialFile

Refuse = Callable[[str, str], NoReturn]  # raises InputError about an entry of the file, with the problem
Functions = Callable[[np.ndarray, float], np.ndarray]  # of b*, N/mm², and a temperature, K; see `Law.functions`


def check_combinations(data: MaterialFile, refuse: Refuse) -> None:
    """Refuse what does not go together.

    Args:
        data: the material file.
        refuse: Refuse.
    """
    at_all, known = data.temperatures, [at.temperature for at in data.temperatures]
    if np.any(np.diff(known) <= 0):
        refuse("temperatures", f"{known} K do not ascend; sort the entries, none twice")
    if data.heating and len(at_all) == 1:
        refuse("heating", "plastic work warms the material; give its constants at two temperatures at least")
    if len({at.isotropic == "none" for at in at_all}) == 2:
        refuse("temperatures", "isotropic is 'none' at some temperatures only; give it at all or at none")
    if len({len(at.terms) for at in at_all}) > 1:
        refuse("temperatures", "not all have the same number of back stresses; give as many terms at each")
    if data.rate:
        _check_rate(data, refuse)


def _check_rate(data: MaterialFile, refuse: Refuse) -> None:
    """Overstress needs a yield surface, and flow that it limits as a whole."""
    if any(at.isotropic == "none" for at in data.temperatures):
        refuse("rate", "a material that never yields has no rate-dependent yield; leave it out")
    if data.deviates_from_normality:
        refuse(
            "rate",
            "cannot be combined with non_normality: overstress sets the rate of all plastic strain, κ ties a part "
            "of it to the rate of stress, so that none or two rates satisfy both while a point beyond the yield "
            "surface is unloaded; make non_normality 'none', or remove rate",
        )


# Numbers outside of these are in Pa, GPa or psi. The softest solids of which springs are made are plastics, G of 700
# N/mm² and more, the stiffest is diamond with 540,000. No solid yields above an ideal strength of about G/4 (Frenkel),
# and pure, soft metals harden to several 1e-4 G. Back stresses begin with slopes of up to a hundred times G.
SHEAR_MODULI = (500.0, 600e3)  # N/mm²
STRESSES = (1e-4, 1.0)  # of G
STEEPEST = 1e3  # of G


def check_moduli(data: MaterialFile, refuse: Refuse) -> None:
    """Refuse a file with a shear modulus that no solid has, as it is not in N/mm²."""
    for i, at in enumerate(data.temperatures):
        _within(at.elasticity.G, *SHEAR_MODULI, f"temperatures.{i}.elasticity.G", "the shear modulus", refuse)


def check_stresses(data: MaterialFile, functions: Functions, refuse: Refuse) -> None:
    """Refuse a file with a stress that no solid has, beside its shear modulus.

    Args:
        data: the material file.
        functions: Functions of its law.
        refuse: Refuse.
    """
    for i, at in enumerate(data.temperatures):
        G, place = at.elasticity.G, f"temperatures.{i}"
        slopes = [(f"kinematic.terms.{k}.C", one.C) for k, one in enumerate(at.terms)]
        if at.isotropic != "none":
            with np.errstate(all="ignore"):
                k2, _, zeta, *_ = functions(np.linspace(0.0, data.validity.plastic_work, 201), at.temperature)
            _stress(float(np.sqrt(1.5 * k2.max())), G, f"{place}.isotropic", "the greatest yield stress", refuse)
            slopes += [("kinematic", float(zeta.max()))]
        for entry, slope in slopes:
            _within(slope, 0.0, STEEPEST * G, f"{place}.{entry}", "the slope of a back stress", refuse)
    G = data.temperatures[0].elasticity.G
    if data.tensile_strength is not None:
        _stress(data.tensile_strength, G, "tensile_strength", "the strength", refuse)
    if data.creep is not None:
        _within(data.creep.stress, 0.0, STRESSES[1] * G, "creep.stress", "the reference stress", refuse)
        if data.creep.tests is not None:
            _stress(data.creep.tests.stress[1], G, "creep.tests.stress", "the greatest stress", refuse)


def _stress(value: float, G: float, place: str, name: str, refuse: Refuse) -> None:
    _within(value, STRESSES[0] * G, STRESSES[1] * G, place, name, refuse)


def _within(value: float, low: float, high: float, place: str, name: str, refuse: Refuse) -> None:
    if np.isfinite(value) and not low <= value <= high:  # what overflows is refused by `check_functions`
        unit = "Pa" if value > high else "GPa"
        beyond = f"above {high:.3g}" if value > high else f"below {low:.3g}"
        refuse(place, f"{name} is {value:.4g} N/mm², {beyond} N/mm², as in {unit}; give all stresses in N/mm² = MPa")


ROUNDING = 1e-12  # of G, in the slope of a curve that has saturated


def check_functions(data: MaterialFile, functions: Functions, refuse: Refuse) -> None:
    """k² > 0, 2ζ + k²′ ≥ 0 and κ k²′ < 2 over the range of validity: else (3.1.9) is not positive.

    Args:
        data: the material file.
        functions: Functions of its law.
        refuse: Refuse; told the value and where it is found.
    """
    work, known = np.linspace(0, data.validity.plastic_work, 2001), [at.temperature for at in data.temperatures]
    for i, at in enumerate(data.temperatures):
        if at.isotropic == "none":
            continue
        # Between two temperatures, too: the product of the interpolated κ and k²′ may be larger than at both.
        for temperature in np.unique(np.linspace(known[i], known[min(i + 1, len(known) - 1)], 5)):
            with np.errstate(all="ignore"):  # what overflows is refused below
                k2, dk2, zeta, _, kappa, _ = values_at = functions(work, temperature)
                product, slopes = kappa * dk2, 2 * zeta + dk2
                falling = slopes < -ROUNDING * at.elasticity.G
            for entry, name, unit, values, broken, rule in (
                ("isotropic", "k²", " N²/mm⁴", k2, ~(k2 > 0), "must be positive"),
                ("isotropic", "2ζ + k²′", " N/mm²", slopes, falling, "must not be negative"),
                (
                    "non_normality.a",
                    "κ k²′",
                    "",
                    product,
                    product >= 2,
                    "must stay below 2, or (3.1.9) is not positive definite",
                ),
            ):
                if broken.any():
                    first = int(np.argmax(broken))
                    where = f"at b* = {work[first]:g} N/mm² and {temperature:g} K"
                    refuse(
                        f"temperatures.{i}.{entry}",
                        f"{name} = {values[first]:.4g}{unit} {where}; it {rule} (checked up to validity.plastic_work)",
                    )
            if not np.isfinite(values_at).all():
                refuse(f"temperatures.{i}", f"its functions overflow at {temperature:g} K; are the units N and mm?")
