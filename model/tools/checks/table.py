"""The table of checks of a spring, which heads every output."""

from collections.abc import Callable, Iterator

from coilset.meshes.springs.geometry import Spring
from coilset.model.core.base.errors import InputError
from coilset.model.core.case import Case
from coilset.model.core.results.loading import Loading
from coilset.model.tools.checks import general
from coilset.model.tools.checks.check import Check
from coilset.model.tools.checks.compressed import compressed
from coilset.model.tools.checks.pulled import pulled
from coilset.model.tools.checks.subject import Subject, subject
from coilset.model.tools.checks.turned import turned
from coilset.model.tools.sheet.case_sheet import case_sheet
from coilset.model.tools.sheet.from_results import Found
from coilset.model.tools.sheet.sheet import Sheet

BY_LOADING: dict[Loading, Callable[[Subject], Iterator[Check]]] = {
    Loading.COMPRESSED: compressed,
    Loading.PULLED: pulled,
    Loading.TURNED: turned,
}


def checks(case: Case, spring: Spring, found: Found | None = None, made: Sheet | None = None) -> list[Check]:
    """All checks of a case's spring.

    Args:
        case, spring: the spring is built from the case.
        found: results of its run; None before one.
        made: its sheet, where there is one already.

    Raises:
        InputError: a material that cannot be read.
    """
    reason = ""
    if made is None:
        try:
            made = case_sheet(case, spring, found)
        except InputError as error:  # no cylinder of one wire
            reason = str(error.problem)
    one = subject(case, spring, made, found.summary if found else {}, reason)
    return [
        *general.limits(one),
        *BY_LOADING[one.loading](one),
        *general.guides(one),
        *general.fatigue(one),
        *general.temperature(one),
        general.index(one),
        *general.tolerance(one),
    ]
