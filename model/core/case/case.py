"""The case file: one YAML file that names a spring, its material, its ends, its mesh and its load program."""

import math
import re
from collections.abc import Iterable
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, Self

from annotated_types import Unit
from pydantic import (
    AfterValidator,
    BeforeValidator,
    Discriminator,
    Field,
    Tag,
    ValidationInfo,
    field_validator,
    model_validator,
)
from pydantic_core import PydanticCustomError

from coilset.meshes.springs.spring import PAST, SpringEntry, SpringSpec
from coilset.meshes.springs.stations import ElementsPerTurn
from coilset.model.core.base.entry import Strict, Whole, check_entries
from coilset.model.core.base.package import Entry
from coilset.model.core.base.yaml import read_data
from coilset.model.core.case.head_freedoms import FREEDOMS, ForceLineSpec, HeadsSpec
from coilset.model.core.case.phases import AnyPhase, Phase, heads_of
from coilset.model.core.case.seats import SeatsSpec
from coilset.model.core.case.settings import assign, located
from coilset.model.core.equilibrium import petsc_options
from coilset.model.core.equilibrium.settings import CONSTANTS, MethodName, NewtonControl, StepControl
from coilset.model.core.section import rules

ANGLES, ANGLES_COILED = 20, 32
"""Angles of the polar rule where the case gives none."""
DEGREES, WITH_CORNERS, ANGLES_WITH_CORNERS = {None: 3, "oval": 5, "egg": 5, "tube": 5}, 8, 30
"""Of the polynomials of a section that warps. With 3 the rate of a rectangle 2:1 is 12 % too high, with 5 0.3 %; far
beyond yield its force is 0.4 % too high with 7, 0.2 % with 8. With fewer angles the points do not carry degree 8."""


class SectionSpec(Strict):
    """The wire's cross-section: its kinematics and its quadrature."""

    kind: Annotated[
        Literal["plane", "curved", "warping"],
        Field(
            description="plane: as in the thesis; curved: fibres of a curved wire, warping due to the transverse "
            "force; warping: free warping, all six stresses"
        ),
    ] = "curved"
    spin: Annotated[
        bool,
        Field(
            description="whether stress rotates with the material relative to the section, as in the thesis (5.2.33)"
        ),
    ] = False
    degree: Annotated[
        Whole | None,
        Field(
            ge=1,
            le=9,
            description="degree of the polynomials of a warping section, in a tube of the harmonics around it; left "
            "out: 3, of an oval, egg or tube 5, of other wire that is not round 8",
        ),
    ] = None
    rule: Annotated[Literal["polar", "abramowitz9"], Field(description="polar, or abramowitz9 as in the thesis")] = (
        "polar"
    )
    radial: Annotated[Whole, Field(ge=1, le=64, description="rings of the polar rule")] = 8
    angular: Annotated[
        Whole | None,
        Field(
            ge=3,
            le=256,
            description="angles of the polar rule; left out: 20, or 32 in wire made by coiling, or 30 in warping "
            "sections of wire that is no round, oval, egg or tube",
        ),
    ] = None
    staggered: Annotated[
        bool,
        Field(description="whether every second ring of the polar rule is offset by half the angle between its points"),
    ] = True

    @model_validator(mode="after")
    def _spin_belongs(self) -> Self:
        if self.spin and self.kind == "warping":
            raise ValueError("spin is defined for three stresses only; give kind: plane or curved, or leave spin out")
        return self

    @model_validator(mode="after")
    def _warping_is_integrated(self) -> Self:
        exact = 5 if self.rule == "abramowitz9" else min(4 * self.radial, self.angular or ANGLES) - 1
        degree = self.polynomials(None)
        needed = 2 * degree - 2
        if self.kind == "warping" and exact < needed:
            raise ValueError(
                f"the rule is exact for polynomials of degree {exact}, warping of degree {degree} "
                f"needs {needed}; give more points or a lower degree"
            )
        return self

    def polynomials(self, shape: str | None) -> int:
        """Degree of the polynomials of a section that warps, by the `shape` of the wire's entry; None: round wire."""
        return self.degree or DEGREES.get(shape, WITH_CORNERS)

    def build(self, coiled: bool = False, shape: str | None = None) -> rules.DiskRule:
        """The quadrature rule, of wire that was coiled or not, by the `shape` of the wire's entry; None: round wire.

        Coiling leaves kinks along straight lines across the section, the edges of its elastic core, which more angles
        resolve (docs/rod.md).
        """
        if self.rule == "abramowitz9":
            return rules.abramowitz9()
        cornered = self.kind == "warping" and shape not in DEGREES
        angles = ANGLES_COILED if coiled else ANGLES_WITH_CORNERS if cornered else ANGLES
        return rules.polar(self.radial, self.angular or angles, self.staggered)


class MeshSpec(Strict):
    """Elements along the wire."""

    elements_per_turn: Annotated[
        ElementsPerTurn, Field(description="straight rods per turn, a number or a table over the turns")
    ] = 16
    sagitta: Annotated[
        float | None,
        Unit("mm"),
        Field(gt=0, description="maximum distance between a rod and the wire's axis, mm; adds rods where needed"),
    ] = None
    axis: Annotated[
        Literal["curved", "chords"],
        Field(description="curved: sections are on the true centre line; chords: on the polygon of the thesis"),
    ] = "curved"
    element: Annotated[
        Literal["mixed", "thesis"],
        Field(description="mixed: section forces in equilibrium within the element, 3 sections; thesis: its own, 2"),
    ] = "mixed"
    section: SectionSpec = SectionSpec()

    @model_validator(mode="after")
    def _curvature_belongs(self) -> Self:
        if self.axis == "chords" and self.section.kind != "plane":
            raise ValueError(f"chords are straight; give section.kind: plane, or axis: curved for {self.section.kind}")
        return self


class FrictionSpec(Strict):
    """Coefficients of Coulomb friction; 0 is none."""

    seats: Annotated[float, Unit("1"), Field(ge=0, lt=2, description="friction coefficient, wire on seats")] = 0.0
    coils: Annotated[float, Unit("1"), Field(ge=0, lt=2, description="friction coefficient, coils on coils")] = 0.0
    guides: Annotated[
        float, Unit("1"), Field(ge=0, lt=2, description="friction coefficient, wire on arbor or sleeve")
    ] = 0.0


class ContactSpec(Strict):
    """Stiffness of seats and coils against penetration."""

    RENAMED: ClassVar[dict[str, str]] = {"deepest": "penetration_limit", "penetration": "augmentation_tolerance"}

    coils: Annotated[
        Literal["closest", "gaps"],
        Field(description="closest: closest points of the wires; gaps: the thesis's gap elements between coils"),
    ] = "closest"
    bedding: Annotated[
        float | None,
        Unit("N/mm²"),
        Field(gt=0, description="contact stiffness: force per length and penetration, N/mm per mm; default E/4"),
    ] = None
    arbor: Annotated[float | None, Unit("mm"), Field(gt=0, description="diameter of an arbor inside the coils, mm")] = (
        None
    )
    sleeve: Annotated[
        float | None, Unit("mm"), Field(gt=0, description="inner diameter of a sleeve around the coils, mm")
    ] = None
    penetration_limit: Annotated[
        float,
        Unit("wire diameters"),
        Field(gt=0, description="penetration, in wire diameters, above which contacts are augmented or steps rejected"),
    ] = 0.02
    augmentation_tolerance: Annotated[
        float | None,
        Unit("mm"),
        Field(gt=0, description="maximum penetration, mm, enforced by augmented Lagrangians; default: the limit"),
    ] = None
    friction: FrictionSpec = FrictionSpec()

    @model_validator(mode="after")
    def _friction_belongs(self) -> Self:
        if self.coils == "gaps" and self.friction.coils:
            raise ValueError("gap elements have no friction; give coils: closest, or leave friction.coils out")
        if self.friction.guides and self.arbor is None and self.sleeve is None:
            raise ValueError("friction.guides is that on an arbor or sleeve; give one of them, or leave it out")
        return self


def _refuse_constants(data: Any) -> None:
    """Refuse entries of the control that earlier versions had, and say where these numbers are."""
    groups = data if isinstance(data, dict) else {}
    for name in (f"{group}.{name}" for group, given in groups.items() if isinstance(given, dict) for name in given):
        where = "contact.penetration_limit, in wire diameters" if name == "newton.free_penetration" else ""
        if name in CONSTANTS:
            where = f"the constant {name.partition('.')[2].upper()} of model/{CONSTANTS[name]}"
        if where:
            problem = "this is no longer an entry, but {where}"
            raise PydanticCustomError("unknown_entry", problem, {"entry": name, "where": where})


class ControlSpec(Strict):
    """Numbers that control the iteration and the steps."""

    RENAMED: ClassVar[dict[str, str]] = {"newton.foreseen_forces": "newton.predicted_forces"}
    newton: Annotated[NewtonControl, Field(description="how one step is solved")] = NewtonControl()
    steps: Annotated[StepControl, Field(description="how steps follow each other")] = StepControl()

    @model_validator(mode="wrap")
    @classmethod
    def _earlier_names(cls, data: Any, validate: Any) -> Any:
        """Accept an entry of the plain class `NewtonControl` by its earlier name; refuse what are constants now."""
        _refuse_constants(data)
        newton = data.get("newton") if isinstance(data, dict) else None
        if not isinstance(newton, dict) or "foreseen_forces" not in newton or "predicted_forces" in newton:
            return validate(data)
        names = {"foreseen_forces": "predicted_forces"}
        group = validate(data | {"newton": {names.get(name, name): value for name, value in newton.items()}})
        group._earlier = tuple(cls.RENAMED)
        return group


def _one_value(value: Any) -> Any:
    if isinstance(value, dict | list | tuple) or (isinstance(value, float) and not math.isfinite(value)):
        raise ValueError("must be a word, a finite number, true, false or null")
    return value


Option = Annotated[bool | int | float | str | None, BeforeValidator(_one_value)]
"""Value of a PETSc option."""


def _plain(options: dict[str, Any]) -> dict[str, Any]:
    """Options as PETSc gets them, of those that a file may give."""
    found = {}
    for name, value in options.items():
        try:
            found[name] = petsc_options.plain(name, value)
        except ValueError as error:
            raise PydanticCustomError("wrong_option", "{problem}", {"entry": name, "problem": str(error)}) from None
    return found


class SolverSpec(Strict):
    """How equilibrium is found."""

    method: Annotated[MethodName, Field(description="iteration method")] = "newton"
    tolerance: Annotated[float, Unit("1"), Field(gt=0, lt=1, description="ε of the convergence test (6.3.1)")] = 1e-9
    options: Annotated[
        dict[Annotated[str, Field(pattern="^[a-z]\\w*$")], Option],
        AfterValidator(_plain),
        Unit("of the option"),
        Field(description="PETSc options of docs/methods.md, without the leading hyphen; they take precedence"),
    ] = Field(default_factory=dict)
    control: ControlSpec = ControlSpec()


class NamedWire(Strict):
    """A wire of a standard in place of a material; its diameter is that of the spring."""

    wire: Annotated[str, Field(description="name of a wire, such as EN 10270-1 SH; `coilset sheet --wires` lists them")]


Material = Annotated[
    Annotated[str, Tag("(name)")] | Annotated[NamedWire, Tag("(wire)")],
    Discriminator(lambda value: "(wire)" if isinstance(value, dict | NamedWire) else "(name)"),
]
"""A material by its name or file, or a wire by its name."""


PER_CENT = r"\d*\.?\d+(e-?\d+)?"  # a number without a sign


def _fraction(value: Any) -> Any:
    """0.002 of `0.2 %`; anything else as it is."""
    number = value.removesuffix("%").strip() if isinstance(value, str) and value.endswith("%") else ""
    return float(number) / 100.0 if re.fullmatch(PER_CENT, number) else value


Below1 = Annotated[float, Field(gt=0, lt=1)]
InPerCent = Annotated[str, Field(pattern=rf"^{PER_CENT}\s*%$")]
Part = Annotated[Below1, BeforeValidator(_fraction, json_schema_input_type=Below1 | InPerCent)]
"""A part of one, above 0 and below, as a number or in per cent."""


Loading = Annotated[
    list[AnyPhase],
    Field(strict=False, min_length=1, description="the load program: targets and waiting times, in order"),
]
"""A load program."""


class Case(Strict):
    """A case; units mm, N, MPa, K."""

    ELSEWHERE: ClassVar[dict[str, str]] = {
        "outer": "coilset nest",
        "inner": "coilset nest",
        "vary": "coilset sweep",
        "find": "coilset design",
        "case": "coilset sweep or coilset design",
        "temperatures": "the entry material",
    }
    spring: Annotated[SpringEntry, Field(description="the spring's drawing, or the file of a measured one")]
    material: Annotated[
        Material, Field(description="name of a library material, path of a material file, or {wire: name of a wire}")
    ] = "ck15"
    temperature: Annotated[
        float | None,
        Unit("K"),
        Field(gt=0, description="temperature of the whole spring, K; default: the first in the material file"),
    ] = None
    ends: Annotated[
        Literal["seats", "clamped"],
        Field(description="seats: the spring is compressed between seats; clamped: both tips of the wire are clamped"),
    ] = "seats"
    seats: SeatsSpec = SeatsSpec()
    heads: HeadsSpec = HeadsSpec()
    release: Annotated[
        Literal["free", "held"],
        Field(
            description="what holds a spring whose load has been released: free: nothing, its ends are let go as well "
            "for its free length, set and residual stress; held: its ends, as under load, where they are welded"
        ),
    ] = "free"
    mesh: MeshSpec = MeshSpec()
    contact: ContactSpec = ContactSpec()
    solver: SolverSpec = SolverSpec()
    heat: Annotated[
        Any,
        Entry("coilset.model.physics.time.heat_entries:HeatSpec"),
        Field(description="where the heat of plastic work flows; left out: it stays where it is produced"),
    ] = None
    accuracy: Annotated[
        Annotated[Literal["none"], Tag("(word)")] | Annotated[Part, Unit("1"), Tag("(part)")],
        Discriminator(lambda value: "(word)" if value == "none" else "(part)"),
        Field(
            description="allowed error of force and set, and of the force by automatic steps, relative to the maximum "
            "force, such as 0.2 %; none: errors are not estimated, and all phases give their steps"
        ),
    ] = 0.002
    loading: Loading
    rates_at: Annotated[
        list[Annotated[float, Unit("mm"), Field(gt=0)]],
        Field(
            default_factory=list, description="travels, mm, at which the rate during the first compression is reported"
        ),
    ]
    working: Annotated[
        Any,
        Entry("coilset.model.physics.working.entries:WorkingSpec"),
        Field(description="lengths or forces between which the finished spring works; left out: none are reported"),
    ] = None
    limits: Annotated[
        Any,
        Entry("coilset.model.tools.limits.limit_entries:Limits"),
        Field(
            description="between which values results must be: name, such as free_length or force_at_37, → "
            "[low, high], {nominal, tolerance}, or EN 15800 grade 2"
        ),
    ] = None
    endurance: Annotated[
        Any,
        Entry("coilset.model.physics.fatigue.entries:EnduranceSpec"),
        Field(description="fatigue strength of the wire, for its life between the outermost working states"),
    ] = None
    force_line: Annotated[
        ForceLineSpec | None,
        Field(description="planes that the force line crosses, and a damper; left out: seats.csv has no such numbers"),
    ] = None

    sheet: Annotated[
        Any,
        Entry("coilset.model.tools.document.entries:SheetSpec"),
        Field(description="head of the data sheet by `coilset sheet --out sheet.pdf`"),
    ] = None

    @field_validator("material")
    @classmethod
    def _from_folder(cls, material: str | NamedWire, info: ValidationInfo) -> str | NamedWire:
        """The path of a material file counts from the folder of the case file, where the context has one."""
        folder = (info.context or {}).get("folder")
        return material if folder is None or isinstance(material, NamedWire) else located("material", material, folder)

    @model_validator(mode="after")
    def _seats_belong(self) -> Self:
        if self.ends != "seats" and self.seats != SeatsSpec():
            raise ValueError("there are no seats between clamped ends; leave the seats out, or give ends: seats")
        if self.ends != "seats" and self.contact.friction.seats:
            raise ValueError("there are no seats between clamped ends; leave contact.friction.seats out")
        shapes = {self.seats.bottom.shape, self.seats.top.shape} - {"flat"}
        if shapes and any(phase.to == "block" for phase in self.targets):
            raise ValueError(
                f"block is defined for flat seats only; with {shapes.pop()} ones give height, travel or force"
            )
        return self

    @model_validator(mode="after")
    def _heads_belong(self) -> Self:
        if self.ends == "seats" and self.heads != HeadsSpec():
            raise ValueError("heads are those of a clamped wire; give ends: clamped, or entries of seats")
        holder: HeadsSpec | SeatsSpec = self.clamps if self.ends == "clamped" else self.seats
        given = {end: getattr(holder, end) for end in ("bottom", "top")}
        loose = {(end, name) for end, spec in given.items() for name in FREEDOMS if getattr(spec, name) == "free"}
        for number, phase in enumerate(self.loading):
            for end, target in heads_of(phase).items():
                place = f"loading.{number}.to.{end}"
                if self.ends == "seats" and self.seats.hold == "tips":
                    raise ValueError(f"{place}: tips are held in space; give seats.hold: groove, or ends: clamped")
                for name in (*target.values, *target.loaded):
                    if not isinstance(getattr(given[end], name), str):
                        raise ValueError(f"{place}: {name} is on a spring; give it as held or free, or drive another")
                loose |= {(end, name) for name in target.loaded}
                loose -= {(end, name) for name in target.values}
            for name in ("sideways", "turn"):
                if {("bottom", name), ("top", name)} <= loose:
                    raise ValueError(f"loading.{number}: {name} is free at both ends, so the spring floats; hold one")
        return self

    @model_validator(mode="after")
    def _endurance_of_cycles(self) -> Self:
        states = len(self.working.targets) if self.working else 0
        if self.endurance is not None and states < 2:
            raise ValueError("endurance is for the cycle between two working states; give working: {lengths: [47, 37]}")
        return self

    @model_validator(mode="after")
    def _past_of_fibres(self) -> Self:
        if self.past and self.mesh.section.kind == "warping":
            raise ValueError(f"spring.{self.past[0]} needs sections of fibres; give mesh.section.kind: curved or plane")
        if "made_by" in self.past and self.mesh.axis == "chords":
            raise ValueError(
                "spring.made_by: coiling bends the wire to its axis, but chords are straight; give mesh.axis: curved"
            )
        return self

    @model_validator(mode="after")
    def _tension_is_held(self) -> Self:
        if "initial_tension" in self.past and self.ends == "seats":
            raise ValueError(
                "spring.initial_tension: seats only press, but an extension spring is pulled; give ends: clamped"
            )
        return self

    @model_validator(mode="after")
    def _heat_takes_time(self) -> Self:
        if self.heat and self.mesh.section.kind == "warping":
            raise ValueError("heat needs sections of fibres; give mesh.section.kind: curved or plane")
        for number, phase in enumerate(self.loading):
            if self.heat and isinstance(phase, Phase) and phase.seconds is None:
                raise ValueError(f"loading.{number} takes no time, but heat flows; give a target and seconds")
        return self

    @model_validator(mode="after")
    def _wire_belongs(self) -> Self:
        if not isinstance(self.spring, SpringSpec) or self.spring.wire is None:
            return self
        if self.mesh.axis == "chords":
            raise ValueError("spring.wire is turned to the coil, but chords are straight; give mesh.axis: curved")
        if self.heat:
            raise ValueError("heat flows in round wire only; leave heat out, or spring.wire")
        if self.contact.arbor or self.contact.sleeve:
            raise ValueError("an arbor or sleeve is for round wire; leave it out, or spring.wire")
        if self.contact.coils == "gaps":
            raise ValueError("gap elements are for round wire; give contact.coils: closest")
        if self.contact.friction.coils:
            raise ValueError("friction of coils on coils is for round wire; leave contact.friction.coils out")
        return self

    @model_validator(mode="after")
    def _tails_are_held(self) -> Self:
        if self.ends == "seats" and self.tails:
            raise ValueError(
                f"spring.{self.tails}: seats press on coils, but these are held at their points; give ends: clamped"
            )
        if self.tails and any(phase.to == "block" for phase in self.targets):
            raise ValueError(f"spring.{self.tails}: such a spring is not pressed to block; give travel or force")
        arms = getattr(self.spring, "arms", None)
        on_points = [end for end in ("bottom", "top") if getattr(getattr(arms, end, None), "held", "") == "point"]
        if len(on_points) == 2:
            raise ValueError("spring.arms: on two points the spring turns freely about them; clamp one of the arms")
        for end in on_points:
            if getattr(self.heads, end).moves:
                raise ValueError(f"heads.{end}: the head whose point holds an arm is held; only its turn is driven")
            for number, phase in enumerate(self.loading):
                driven = heads_of(phase).get(end)
                if driven is not None and {*driven.loaded} - {"turn"}:
                    raise ValueError(f"loading.{number}.to.{end}: a head that holds a point takes a torque only")
        return self

    @property
    def tails(self) -> str:
        """Name of the entry of `spring` on wire beyond the coil, `hooks` or `arms`, or nothing."""
        given = [name for name in ("hooks", "arms") if getattr(self.spring, name, None) is not None]
        return given[0] if given else ""

    @property
    def clamps(self) -> HeadsSpec:
        """How the heads of a clamped wire are held; hooks tilt at the point where they are pulled, unless set
        in `heads`."""
        hooks = getattr(self.spring, "hooks", None)
        given = {end: getattr(self.heads, end) for end in ("bottom", "top")}
        for end, head in given.items():
            if getattr(hooks, end, None) is not None and "tilt" not in head.model_fields_set:
                given[end] = head.model_copy(update={"tilt": "free"})
        return self.heads.model_copy(update=given)

    @property
    def targets(self) -> list[Phase]:
        """The phases of `loading` that go to a travel, height or force."""
        return [phase for phase in self.loading if isinstance(phase, Phase) and phase.drives_axially]

    @property
    def ends_turn(self) -> bool:
        """Whether an end of the spring is free to turn about its axis; held tips are not."""
        return self.ends == "seats" and "free" in (self.seats.bottom.turn, self.seats.top.turn)

    @property
    def section_rule(self) -> rules.DiskRule:
        """The quadrature rule of the wire's section."""
        return self.mesh.section.build("made_by" in self.past, self.wire_shape)

    @property
    def wire_shape(self) -> str | None:
        """Name of the entry that gives the shape of a wire that is not round."""
        wire = self.spring.wire if isinstance(self.spring, SpringSpec) else None
        return None if wire is None else wire.shape

    @property
    def section_degree(self) -> int:
        """Degree of the polynomials of its sections, if these warp."""
        return self.mesh.section.polynomials(self.wire_shape)

    @property
    def steps_error(self) -> float | None:
        """`accuracy` as a part of one; None if the errors of the steps are not estimated."""
        return None if isinstance(self.accuracy, str) else self.accuracy

    @property
    def past(self) -> list[str]:
        """Entries of `spring` on the wire's manufacture; without them the wire is free of stress."""
        if not isinstance(self.spring, SpringSpec):
            return []
        return [name for name in PAST if getattr(self.spring, name) is not None]


class UnloadedCase(Case):
    """A case whose load program may be left out, for what does not load its spring, or has a program of its own."""

    loading: Loading = Field(default_factory=list)


def check(data: Any, file: str | Path = "") -> Case:
    """The checked Case of raw data; paths in it count from the folder of `file`.

    Raises:
        InputError: one line with file, place, value and what would be right.
    """
    return check_entries(data, Case, file)


def read_case_data(path: str | Path) -> dict[str, Any]:
    """The raw, unchecked data of a case file.

    Raises:
        InputError: if it cannot be read.
    """
    return read_data(path, "a case file holds entries such as spring:, material: and loading:")


def read_case(path: str | Path, settings: Iterable[str] = (), kind: type[Case] = Case) -> Case:
    """Read and check a case file.

    Args:
        path: the YAML file.
        settings: texts `key=value` that replace entries of the file; paths in them count from the working directory.
        kind: `UnloadedCase` if it need not have a load program.

    Returns:
        Case.

    Raises:
        InputError: one line with file, place, value and what would be right.
    """
    data = read_case_data(path)
    for setting in settings:
        assign(data, setting)
    return check_entries(data, kind, path)
