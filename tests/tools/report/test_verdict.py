"""The verdict: checks that failed by their warnings, and those that could not be made."""

from coilset.model.tools.report.answer import answer
from coilset.model.tools.report.first_sheet import results
from coilset.model.tools.report.verdict import checks, verdict

GOOD = {"complete": True, "warnings": [], "material": "ck15"}


def warned(*names):
    return GOOD | {"warnings": [{"name": name, "message": f"about {name}"} for name in names]}


def test_all_checks_of_a_cylinder_of_standard_wire_are_made():
    made = checks(GOOD, True, True)
    assert {one.result for one in made} == {"met"}
    assert verdict(made) == "All checks made are met."


def test_what_cannot_be_checked_is_no_pass():
    made = {one.name: one for one in checks(GOOD, False, False)}
    assert made["gaps between the coils"].met is None
    assert made["permissible stress"].met is None
    assert verdict(list(made.values())).endswith("Not checked: gaps between the coils, permissible stress.")
    wire = {one.name: one for one in checks(GOOD, True, False)}["permissible stress"]
    assert (wire.result, wire.reason) == ("not checked", "no permissible stress of ck15 is known")


def test_formulas_of_compression_springs_are_no_check_of_others():
    for kind in ({"turn_max_deg": 200.0, "force_max_N": 0.0}, {"turn_max_deg": None, "force_max_N": -300.0}):
        made = {one.name: one for one in checks(GOOD | kind, True, True)}
        assert made["gaps between the coils"].met is made["permissible stress"].met is None
        assert made["accuracy"].met is (None if kind["turn_max_deg"] else True)


def test_a_warning_fails_its_check():
    made = {one.name: one for one in checks(warned("gap", "buckled", "index"), True, True)}
    failed = {name for name, one in made.items() if one.met is False}
    assert failed == {"gaps between the coils", "buckling", "other warnings"}
    assert made["buckling"].reason == "about buckled"
    assert verdict(list(made.values())) == "Not met: gaps between the coils, buckling, other warnings."
    assert checks(warned() | {"complete": False}, True, True)[0].result == "not met"


def test_a_mesh_that_is_coarse_for_contact_is_judged_by_the_errors():
    """It comes with the default mesh of hooks and arms, and made the verdict of every spring with them 'Not met'."""
    coarse = warned("contact mesh")
    estimated = coarse | {"estimated_force_error_N": 0.19}
    assert verdict(checks(estimated, True, True)) == "All checks made are met."
    made = {one.name: one for one in checks(estimated | {"turn_max_deg": 200.0}, True, True)}
    assert (made["accuracy"].met, made["other warnings"].met) == (None, True)
    assert made["accuracy"].reason.endswith("not estimated; about contact mesh")
    beyond = warned("contact mesh", "error") | {"estimated_force_error_N": 9.0}
    assert verdict(checks(beyond, True, True)) == "Not met: accuracy."
    assert verdict(checks(coarse, True, True)) == "Not met: other warnings."


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
