"""What a law refuses: entries that do not go together, and functions that violate a condition of the theory."""

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from coilset.model.material.law import Law


def check_combinations(law: "Law") -> None:
    """Refuse what does not go together.

    Raises:
        InputError: with the entry of the material file.
    """
    data, at_all = law.data, law.data.temperatures
    if np.any(np.diff(law.temperatures) <= 0):
        law.refuse("temperatures", f"{list(law.temperatures)} K do not ascend; sort the entries, none twice")
    if data.heating and len(at_all) == 1:
        law.refuse("heating", "plastic work warms the material; give its constants at two temperatures at least")
    if len({at.isotropic == "none" for at in at_all}) == 2:
        law.refuse("temperatures", "isotropic is 'none' at some temperatures only; give it at all or at none")
    if len({len(at.terms) for at in at_all}) > 1:
        law.refuse("temperatures", "not all have the same number of back stresses; give as many terms at each")
    if law.n_terms:
        _check_back_stresses(law)
    if data.heating and data.creep and data.creep.hardening == "time":
        law.refuse("creep.hardening", "points that plastic work heats have no common time; give strain")
    if law.spin and data.creep:
        law.refuse("creep", "there is none with spin; leave out creep, or the spin")
    if data.rate:
        _check_rate(law)


def _check_back_stresses(law: "Law") -> None:
    """Several back stresses go with isotropic hardening alone."""
    data = law.data
    if any(at.non_normality != "none" for at in data.temperatures):
        law.refuse("temperatures", "several back stresses go with normality only; make non_normality 'none'")
    for part, word in ((data.heating, "heating"), (data.creep, "creep"), (data.rate, "rate")):
        if part:
            law.refuse(word, "goes not with several back stresses; leave it out, or give kinematic constants")
    if law.spin:
        law.refuse("temperatures.0.kinematic", "several back stresses have no spin; leave out the spin")


def _check_rate(law: "Law") -> None:
    """Yield that depends on the rate goes with hardening alone."""
    data = law.data
    for part, word in ((data.heating, "heating"), (data.creep, "creep")):
        if part:
            law.refuse("rate", f"goes not with {word}; leave one of both out")
    if any(at.isotropic == "none" for at in data.temperatures):
        law.refuse("rate", "a material that never yields has no rate-dependent yield; leave it out")
    if any(at.non_normality != "none" for at in data.temperatures):
        law.refuse("rate", "goes with normality only; make non_normality 'none', or leave rate out")


def check_functions(law: "Law") -> None:
    """k² > 0, 2ζ + k²′ ≥ 0 and κ k²′ < 2 over the range of validity: else (3.1.9) is not positive.

    Raises:
        InputError: with the entry of the material file, the value and where it is found.
    """
    work, known = np.linspace(0, law.validity.plastic_work, 2001), law.temperatures
    for i, at in enumerate(law.data.temperatures):
        if at.isotropic == "none":
            continue
        # Between two temperatures, too: the product of the interpolated κ and k²′ may be larger than at both.
        for temperature in np.unique(np.linspace(known[i], known[min(i + 1, len(known) - 1)], 5)):
            k2, dk2, zeta, _, kappa, _ = law.functions(work, temperature)
            for entry, name, unit, values, broken, rule in (
                ("isotropic", "k²", " N²/mm⁴", k2, ~(k2 > 0), "must be positive"),
                ("isotropic", "2ζ + k²′", " N/mm²", 2 * zeta + dk2, 2 * zeta + dk2 < 0, "must not be negative"),
                ("non_normality.a", "κ k²′", "", kappa * dk2, kappa * dk2 >= 2,
                 "must stay below 2, or (3.1.9) is not positive definite"),
            ):  # fmt: skip
                if broken.any():
                    first = int(np.argmax(broken))
                    where = f"at b* = {work[first]:g} N/mm² and {temperature:g} K"
                    law.refuse(f"temperatures.{i}.{entry}", f"{name} = {values[first]:.4g}{unit} {where}; it {rule}"
                               " (checked up to validity.plastic_work)")  # fmt: skip
