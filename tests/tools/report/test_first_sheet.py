"""The first sheet of a page: its results, and the checks that head it."""

from coilset.model.tools.report.answer import answer
from coilset.model.tools.report.first_sheet import results

GOOD = {"complete": True, "warnings": [], "material": "ck15"}


def test_the_free_length_after_each_release_is_given():
    """As the summary lists them; without a list only the last one."""
    numbers = dict.fromkeys(
        (
            "set_mm",
            "block_height_mm",
            "force_max_N",
            "rate_N_per_mm",
            "rate_30_70_after_N_per_mm",
            "shear_inside_max_MPa",
            "residual_shear_inside_MPa",
            "estimated_force_error_N",
        ),
        1.0,
    )
    summary = GOOD | numbers | {"free_length_before_mm": 50.0, "free_length_after_mm": 45.0}
    assert ("free length", "45 mm") in results(summary)
    releases = [{"free_length_mm": 46.5, "step": 4}, {"free_length_mm": 45.0, "step": 8}]
    twice = summary | {"releases": releases, "steps": 8}
    card = next(one for one in answer(twice) if one.term == "free length")
    assert card.remark == "50 mm before, 46.5 mm after release 1"
    assert next(one for one in answer(summary) if one.term == "free length").remark == "50 mm before"
