"""The entries of a run's summary: name, unit and meaning, from which responses of sweeps and tables derive."""

from dataclasses import MISSING, dataclass, field, fields
from types import UnionType
from typing import Any, get_args

from coilset.model.core.base.warning import Warning
from coilset.model.core.results.records.record import RunErrors


def entry(unit: str, text: str, in_slice: bool = False, default: Any = MISSING) -> Any:
    """A field of the summary.

    Args:
        unit: its unit; empty for counts, words and lists.
        text: its meaning, in Markdown.
        in_slice: whether the helical slice, a single section whose axis cannot bend, computes it too; its stresses at
            the surface are in `loaded` and `released`.
        default: of one that an optional package gives; none of the others.
    """
    return field(default=default, metadata={"unit": unit, "text": text, "in_slice": in_slice})


@dataclass(frozen=True, kw_only=True)
class Summary:
    """The main numbers of a run, in the order of summary.json; unknown entries (no release, no block) are None, as
    are those of packages that are not installed."""

    complete: bool = entry("", "whether the run went through its whole load program", in_slice=True)
    free_length_before_mm: float = entry("mm", "outer length of the unloaded spring", in_slice=True)
    free_length_after_mm: float | None = entry(
        "mm", "outer length after the last release to zero force; `null` if there was none", in_slice=True
    )
    set_mm: float | None = entry("mm", "their difference", in_slice=True)
    set_held_mm: float | None = entry(
        "mm", "the set while the ends still held the spring; `null` if they are not let go, or there is no set"
    )
    end_moment_held_Nmm: float | None = entry(
        "N mm", "the greater of the moments with which they held it, across the axis or about it; `null` likewise"
    )
    releases: tuple[dict[str, Any], ...] = entry(
        "", "after each release to zero force: its `phase` (from 1 on) and `step`, `free_length_mm` and `set_mm`"
    )
    rate_N_per_mm: float | None = entry("N/mm", "initial rate, of the unloaded spring between its ends", in_slice=True)
    rate_30_70_N_per_mm: float | None = entry(
        "N/mm",
        "of the first compression, force over travel between 30 and 70 % of the travel to block, as manufacturers "
        "measure it; `null` if the travel did not reach that far",
    )
    rate_30_70_after_N_per_mm: float | None = entry(
        "N/mm",
        "the same of the finished spring: for the compression after the last release if it reaches so far, else for "
        "the release itself; "
        "travel counts from the free length after it",
    )
    rates: tuple[dict[str, Any], ...] = entry(
        "",
        "at the travels of the case's `rates_at`: `travel_mm`, `force_N`, and `rate_N_per_mm`, the slope of the "
        "first compression there",
    )
    force_max_N: float = entry("N", "the force of largest magnitude in any step", in_slice=True)
    closing_force_N: float | None = entry(
        "N",
        "force where the coils close: at the last step before the characteristic of the last compression to block is "
        "vertical, a change of 20 % and more in force by 1 % of travel; `null` where it is not",
    )
    closing_height_mm: float | None = entry("mm", "height between the seats there")
    estimated_closing_force_error_N: float | None = entry("N", "estimated size of the error of that force")
    force_max_is_given: bool = entry("", "whether the load program gives that force, so that its height was computed")
    force_max_height_mm: float | None = entry("mm", "height between the seats under it; `null` before the first step")
    estimated_force_max_height_error_mm: float | None = entry(
        "mm", "estimated size of the error of this height, as of that force; `null` where one of its parts is not known"
    )
    block_height_mm: float = entry("mm", "height at which each coil touches the next, by geometry", in_slice=True)
    residual_shear_max_MPa: float | None = entry(
        "MPa",
        "maximum shear stress on the wire's surface after release, in the middle turns: a turn from the tips, or "
        "from the end coils of closed ends",
        in_slice=True,
    )
    residual_shear_max_turn: float | None = entry("turns", "at which turn from the bottom tip")
    residual_shear_max_angle_deg: float | None = entry("degrees", "at which angle from the inside of the coil")
    shear_max_MPa: float = entry("MPa", "the same at any of the snapshots", in_slice=True)
    residual_shear_ends_max_MPa: float | None = entry(
        "MPa", "maximum shear stress on the surface of the ends, outside the middle turns, after release"
    )
    residual_shear_ends_max_turn: float | None = entry("turns", "at which turn from the bottom tip")
    residual_shear_ends_max_angle_deg: float | None = entry("degrees", "at which angle from the inside of the coil")
    residual_shear_inside_MPa: float | None = entry(
        "MPa",
        "shear stress on the surface at the inside of the coil after release, in the middle turns; positive as in "
        "a compressed spring",
        in_slice=True,
    )
    residual_shear_inside_turn: float | None = entry("turns", "at which turn from the bottom tip")
    residual_shear_inside_median_MPa: float | None = entry(
        "MPa",
        "its median along the middle turns: that of the coil, where ends that are held or closed raise the largest",
    )
    shear_inside_max_MPa: float = entry(
        "MPa", "shear stress of largest magnitude at the inside over the snapshots", in_slice=True
    )
    residual_shear_surface_max_MPa: float | None = entry(
        "MPa", "maximum shear stress on the whole surface of the wire after release"
    )
    residual_shear_surface_max_turn: float | None = entry("turns", "at which turn from the bottom tip")
    residual_shear_surface_max_angle_deg: float | None = entry("degrees", "at which angle from the inside of the coil")
    residual_equivalent_surface_max_MPa: float | None = entry("MPa", "maximum von Mises stress there")
    residual_equivalent_surface_max_turn: float | None = entry("turns", "its turn")
    residual_equivalent_surface_max_angle_deg: float | None = entry("degrees", "its angle")
    shear_surface_max_MPa: float | None = entry("MPa", "maximum shear stress on the surface at any of the snapshots")
    shear_surface_max_turn: float | None = entry("turns", "its turn")
    shear_surface_max_angle_deg: float | None = entry("degrees", "its angle")
    equivalent_surface_max_MPa: float | None = entry(
        "MPa", "maximum von Mises stress on the surface at any of the snapshots"
    )
    equivalent_surface_max_turn: float | None = entry("turns", "its turn")
    equivalent_surface_max_angle_deg: float | None = entry("degrees", "its angle")
    residual_bending_inside_MPa: float | None = entry(
        "MPa",
        "stress along the wire on the surface at the inside of the coil after release, in the middle turns, where its "
        "magnitude is largest; positive in tension",
    )
    residual_bending_outside_MPa: float | None = entry("MPa", "the same at the outside of the coil")
    max_bending_inside_MPa: float | None = entry("MPa", "that at the inside in any snapshot")
    max_bending_outside_MPa: float | None = entry("MPa", "that at the outside in any snapshot")
    tail_stress_max_MPa: float | None = entry(
        "MPa",
        "stress along the wire of largest magnitude on the surface of hooks or arms in any snapshot; positive in "
        "tension; `null`, as the next two, without these",
    )
    tail_stress_max_turn: float | None = entry(
        "turns", "its turn: below 0 at the bottom, above the coil's last turn at the top"
    )
    residual_tail_stress_MPa: float | None = entry("MPa", "that which stays there after release")
    inner_diameter_min_mm: float = entry(
        "mm", "diameter of the largest arbor that the coils leave room for in all snapshots"
    )
    turn_max_deg: float | None = entry(
        "degrees",
        "largest rotation of the top head against the bottom one; `null`, as the next four, unless a torque loads the "
        "spring",
    )
    torque_max_Nmm: float | None = entry("N mm", "largest torque about the spring's axis")
    turn_rate_Nmm_per_deg: float | None = entry("N mm/°", "torque over rotation in the first step")
    turn_rate_after_Nmm_per_deg: float | None = entry(
        "N mm/°", "torque over the rotation that the last release gives back"
    )
    turn_set_deg: float | None = entry("degrees", "rotation that remains after the last release")
    initial_tension_given_N: float | None = entry(
        "N", "`spring.initial_tension`, with which the wire is wound; `null`, as the next five, without it"
    )
    initial_tension_N: float | None = entry(
        "N",
        "F0 at which coils open that are wound onto each other: the line of the open spring in the first pull, back to "
        "where it meets the line of the closed one, which has the initial rate; `null` where no two steps show the "
        "line",
    )
    estimated_initial_tension_error_N: float | None = entry(
        "N",
        "estimated size of its error, by that of the force and by how the line bends; `null` with fewer steps than 3",
    )
    initial_tension_after_N: float | None = entry(
        "N", "F0 by the line of the last release, and that of closed coils from where it ends; 0 if the coils stay open"
    )
    estimated_initial_tension_after_error_N: float | None = entry("N", "the same of that one")
    open_rate_N_per_mm: float | None = entry("N/mm", "rate once the coils are open, in the first pull")
    plastic_work_max_N_per_mm2: float = entry("N/mm²", "maximum plastic work b* on the surface", in_slice=True)
    plastic_work_max_turn: float | None = entry("turns", "its turn")
    plastic_work_max_angle_deg: float | None = entry("degrees", "its angle")
    plastic_work_known_to_N_per_mm2: float = entry(
        "N/mm²", "limit up to which the constants of the material are valid", in_slice=True
    )
    estimated_rate_error_N_per_mm: float | None = entry(
        "N/mm", "estimated size of the error of the initial rate, by mesh and contact; `null` where it is not known"
    )
    estimated_force_error_N: float | None = entry(
        "N",
        "estimated size of the error of the maximum force by steps, mesh, section rule, contact and warping together; "
        "`null` where one of them is not known, and with `accuracy: none`",
    )
    estimated_set_error_mm: float | None = entry("mm", "the same of the set")
    estimated_residual_shear_inside_error_MPa: float | None = entry(
        "MPa", "the same of the residual shear stress at the inside of the coil"
    )
    torque_max_is_given: bool = entry(
        "", "whether the load program gives the maximum torque; its rotation was computed"
    )
    estimated_torque_error_Nmm: float | None = entry("N mm", "the same of the maximum torque of a torsion spring")
    estimated_turn_error_deg: float | None = entry("degrees", "the same of the rotation under it")
    estimated_turn_set_error_deg: float | None = entry("degrees", "the same of its set")
    estimated_errors: RunErrors | None = entry(  # noqa: RUF009 - it is frozen
        "",
        "the parts of these by their causes `steps`, `mesh`, `section`, `contact` and `warping`: each has `force_N`, "
        "`set_mm` and `residual_shear_inside_MPa`; of a torsion spring the first two are torque over, and rotation "
        "times, the mean radius of its coil; `null` where not estimated",
    )
    working: tuple[dict[str, Any], ...] = entry(
        "",
        "the finished spring at each length or force of the case's `working`: `length_mm`, `force_N`, its "
        "`estimated_error` by all causes, the nominal `shear_MPa` and `corrected_shear_MPa` of EN 13906-1, the true "
        "maximum `shear_inside_MPa` and `shear_surface_MPa` of the middle turns with their places, `allowed_MPa` and "
        "`safety` for a wire of a standard in a compression spring, force centres; or the `reason` why the spring "
        "cannot be there",
        default=(),
    )
    working_set_mm: float | None = entry(
        "mm", "further set by going to the working lengths once; 0 of a spring that stays elastic", default=None
    )
    fatigue: tuple[dict[str, Any], ...] = entry(
        "",
        "by each criterion whose constants `endurance` gives, for the cycle between the outermost working states: the "
        "greatest fully reversed `amplitude_MPa` on the wire's surface that damages as much, its `turn` and "
        "`angle_deg` from the inside of the coil, the `endured_MPa`, their ratio `safety`, and `lives`, cycles "
        "that 10, 50 and 90 % do not survive, `null` where it endures",
        default=(),
    )
    limits: tuple[dict[str, Any], ...] = entry(
        "",
        "for each of the case's `limits`: `name` of the result, its `value`, `low`, `high`, their `source`, whether "
        "they are `met`, and the `margin` to the nearer one, negative outside",
        default=(),
    )
    load_loss_percent: float | None = entry(
        "%",
        "part of its force that the spring had lost when time last passed at constant height, of the force with which "
        "it came to that height; `null` if none did",
        in_slice=True,
    )
    load_losses: tuple[dict[str, Any], ...] = entry(
        "",
        "for each time at constant height, the last one as in `load_loss_percent`: `height_mm`, last `step`, `hours`, "
        "`temperature_before_K` and `temperature_after_K`, `force_before_N` and `force_after_N`, `loss_percent`",
    )
    coiling_diameter_mm: float | None = entry(
        "mm",
        "mean diameter to which the wire was coiled at mid-wire, before it sprang back to the drawing; `null` "
        "without `spring.made_by: coiling`",
    )
    measured_axis_offset_mm: float | None = entry(
        "mm",
        "distance of a measured spring's fitted axis from the z axis of its file, at half height; `null` for a drawn "
        "spring",
    )
    measured_axis_tilt_deg: float | None = entry("degrees", "angle between the two")
    steps: int = entry("", "converged steps", in_slice=True)
    iterations: int = entry("", "iterations of the solves that found them", in_slice=True)
    evaluations: int = entry("", "states evaluated, including those of line searches and failed solves")
    failed_solves: int = entry("", "solves without an equilibrium, which were followed by others")
    material: str = entry("", "name of the law", in_slice=True)
    ends: str = entry("", "`seats` or `clamped`", in_slice=True)
    unstable_steps: int | None = entry("", "steps that ended in an unstable state", default=None)
    buckled: bool | None = entry(
        "", "whether the spring buckled: became unstable, passed a maximum of its force, or bowed", default=None
    )
    buckling_travel_mm: float | None = entry("mm", "travel at which it did", default=None)
    buckling_force_N: float | None = entry("N", "force there", default=None)
    buckling_travel_EN_13906_1_mm: float | None = entry(
        "mm",
        "travel at which it should by EN 13906-1 with these ends, if elastic; `null` if never, or if it is not "
        "compressed",
        default=None,
    )
    elements: int = entry("", "rods along the wire", in_slice=True)
    section_kind: str = entry("", "`plane`, `curved` or `warping`")
    section_rule: str = entry("", "quadrature of the section", in_slice=True)
    lift_off_max_mm: float = entry("mm", "maximum distance between the wire and a seat it has lifted off")
    warnings: tuple[Warning, ...] = entry(
        "",
        "a list: each has a `name`, the `place` that it is about, a `message`, and `value`, `limit` and `unit` "
        "where there are numbers",
        in_slice=True,
    )


def _is_number(kind: Any) -> bool:
    """Whether a field holds a number, or one that may be missing."""
    return kind in (int, float) or (isinstance(kind, UnionType) and not {int, float}.isdisjoint(get_args(kind)))


NUMBERS = tuple(item.name for item in fields(Summary) if _is_number(item.type))
UNSEEN = tuple(item.name for item in fields(Summary) if not item.metadata["in_slice"])
"""Entries that a slice does not compute."""
