"""The warning of a spring maker about presetting."""

from coilset.model.core.base.warning import Warning

ROUNDING = 1e-6  # of the travel to block: what a spring sets by less is none
PRESETTING_LEAST = 0.1  # of the travel to block; a rule of thumb without a source


def presetting_warning(set_mm: float, travel: float) -> Warning | None:
    """Presetting that takes less than a tenth of the travel to block.

    Such a spring continues to set in service. The bound is a rule of thumb for which no source was found.

    Args:
        set_mm: shortening of the free spring by presetting, mm.
        travel: from the free length before presetting to block, mm.
    """
    if set_mm >= PRESETTING_LEAST * travel:
        return None
    share = set_mm / travel if abs(set_mm) > ROUNDING * travel else 0.0
    part = f"{abs(share) * travel:.3g} mm, {100 * abs(share):.2g} % of the travel to block"
    message = (
        f"presetting {'leaves the spring longer by' if share < 0.0 else 'takes'} {part}; "
        f"a set of {100 * PRESETTING_LEAST:g} % or more is usual"
    )
    return Warning("presetting", "loading", message, set_mm, PRESETTING_LEAST * travel, "mm")
