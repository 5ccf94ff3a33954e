"""The case file: one YAML file that names a spring, its material, its ends, its mesh and its load program."""

from difflib import get_close_matches
from pathlib import Path
from typing import Annotated, Literal

import yaml
from pydantic import Field, ValidationError, model_validator

from coilset.meshes.spring import SpringEntry
from coilset.meshes.stations import ElementsPerTurn
from coilset.model.contact.spec import SeatsSpec
from coilset.model.errors import InputError
from coilset.model.loading.program import Phase, Strict
from coilset.model.section import rules
from coilset.model.solvers.methods import METHODS


class SectionSpec(Strict):
    """The wire's cross-section: what it may do, and its quadrature."""

    kind: Annotated[
        Literal["plane", "curved", "warping"],
        Field(description="plane as in the thesis; curved: plane, with fibres as long as the curved wire makes them; "
                          "warping: free to warp, with all six stresses"),
    ] = "plane"
    degree: Annotated[int, Field(ge=1, le=7, description="of the polynomials of a section that warps")] = 3
    rule: Annotated[
        Literal["polar", "abramowitz9"], Field(description="polar, or abramowitz9 as in the thesis")
    ] = "polar"
    radial: Annotated[int, Field(ge=1, le=64, description="rings of the polar rule")] = 4
    angular: Annotated[int, Field(ge=3, le=256, description="angles of the polar rule")] = 12

    @model_validator(mode="after")
    def _warping_is_integrated(self):
        exact = 5 if self.rule == "abramowitz9" else min(4 * self.radial, self.angular) - 1
        needed = 2 * self.degree - 2
        if self.kind == "warping" and exact < needed:
            raise ValueError(f"the rule is exact for polynomials of degree {exact}, warping of degree {self.degree} "
                             f"needs {needed}; give more points or a lower degree")
        return self

    def build(self):
        """The DiskRule."""
        return rules.abramowitz9() if self.rule == "abramowitz9" else rules.polar(self.radial, self.angular)


class MeshSpec(Strict):
    """Elements along the wire."""

    elements_per_turn: Annotated[
        ElementsPerTurn, Field(description="straight rods per turn, a number or a table over the turns")
    ] = 16
    sagitta: Annotated[
        float | None, Field(gt=0, description="greatest distance of a rod from the wire's axis, mm; makes more rods")
    ] = None
    axis: Annotated[
        Literal["curved", "chords"],
        Field(description="curved: the rods' sections lie on the true centre line; chords: the thesis's polygon"),
    ] = "curved"
    section: SectionSpec = SectionSpec()

    @model_validator(mode="after")
    def _curvature_belongs(self):
        if self.axis == "chords" and self.section.kind != "plane":
            raise ValueError(f"chords are straight; give section.kind: plane, or axis: curved for {self.section.kind}")
        return self


class FrictionSpec(Strict):
    """Coefficients of Coulomb friction; 0 is none."""

    seats: Annotated[float, Field(ge=0, lt=2, description="of the wire on the seats")] = 0.0
    coils: Annotated[float, Field(ge=0, lt=2, description="of coils on coils")] = 0.0


class ContactSpec(Strict):
    """Stiffness of seats and coils against penetration."""

    coils: Annotated[
        Literal["closest", "gaps"],
        Field(description="closest points of the wires, or the thesis's gap elements between nodes one turn apart"),
    ] = "closest"
    bedding: Annotated[
        float | None, Field(gt=0, description="force per length and penetration, N/mm per mm; default E/40")
    ] = None
    deepest: Annotated[
        float, Field(gt=0, description="penetration in wire diameters beyond which a step is no equilibrium")
    ] = 0.02
    penetration: Annotated[
        float | None, Field(gt=0, description="greatest penetration, mm, reached by augmented Lagrange; default: any")
    ] = None
    friction: FrictionSpec = FrictionSpec()

    @model_validator(mode="after")
    def _friction_belongs(self):
        if self.coils == "gaps" and self.friction.coils:
            raise ValueError("gap elements have no friction; give coils: closest, or leave friction.coils out")
        return self


class SolverSpec(Strict):
    """How equilibrium is found."""

    method: Annotated[Literal[tuple(METHODS)], Field(description="iteration method")] = "newton"
    tolerance: Annotated[float, Field(gt=0, lt=1, description="ε of (6.3.1)")] = 1e-9
    options: Annotated[
        dict[Annotated[str, Field(pattern="^[a-z]\\w*$")], bool | int | float | str | None],
        Field(default_factory=dict, description="any PETSc options, without the leading hyphen; they win"),
    ]


class Case(Strict):
    """A whole case; units mm, N, MPa, K."""

    spring: SpringEntry
    material: Annotated[str, Field(description="name in the library, or path of a material file")] = "ck15"
    temperature: Annotated[
        float | None, Field(gt=0, description="of the spring throughout, K; default: the material file's first")
    ] = None
    ends: Annotated[Literal["seats", "clamped"], Field(description="seats or clamped")] = "seats"
    seats: SeatsSpec = SeatsSpec()
    mesh: MeshSpec = MeshSpec()
    contact: ContactSpec = ContactSpec()
    solver: SolverSpec = SolverSpec()
    loading: Annotated[list[Phase], Field(min_length=1, description="targets, one after the other")]

    @model_validator(mode="after")
    def _seats_belong(self):
        if self.ends != "seats" and self.seats != SeatsSpec():
            raise ValueError("there are no seats between clamped ends; leave the seats out, or give ends: seats")
        if self.ends != "seats" and self.contact.friction.seats:
            raise ValueError("there are no seats between clamped ends; leave contact.friction.seats out")
        shapes = {self.seats.bottom.shape, self.seats.top.shape} - {"flat"}
        if shapes and any(phase.to == "block" for phase in self.loading):
            raise ValueError(f"block is known for flat seats; with {shapes.pop()} ones give height, travel or force")
        return self


class _Loader(yaml.SafeLoader):
    """Safe YAML that refuses an entry given twice."""

    def construct_mapping(self, node, deep=False):
        seen = set()
        for key, _ in node.value:
            if not isinstance(key, yaml.ScalarNode):
                raise yaml.MarkedYAMLError(problem="an entry's name must be a word", problem_mark=key.start_mark)
            if key.value in seen:
                problem = f"the entry '{key.value}' is given twice"
                raise yaml.MarkedYAMLError(problem=problem, problem_mark=key.start_mark)
            seen.add(key.value)
        return super().construct_mapping(node, deep)


def load_yaml(text, file):
    """Parse YAML safely; InputError with line and column if that fails."""
    try:
        return yaml.load(text, Loader=_Loader)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark
        place = f"line {mark.line + 1}, column {mark.column + 1}" if mark else ""
        raise InputError(f"not readable as YAML: {error.problem}", place, file) from None
    except yaml.YAMLError as error:
        raise InputError("not readable as YAML: " + " ".join(str(error).split()), "", file) from None


def assign(data, setting):
    """Carry out one `--set key=value` on nested data; the value is read as YAML.

    Raises:
        InputError: if the setting has no `=`, or its path leads through something that has no entries.
    """
    path, equals, text = setting.partition("=")
    place = f"--set {setting}"
    if not equals or not path:
        raise InputError("give it as key=value, as in mesh.elements_per_turn=32", place)
    put(data, path, load_yaml(text, place), place)


def put(data, path, value, place):
    """Replace the entry at `path`, such as `loading.0.steps`, in nested data; `place` is where the user asked for it.

    Raises:
        InputError: if the path leads through something that has no entries.
    """
    *parents, last = path.split(".")
    for part in parents:
        data = _entry(data, part, place)
    if isinstance(data, list):
        data[_index(data, last, place)] = value
    else:
        data[last] = value


def _entry(data, part, place):
    if isinstance(data, list):
        return data[_index(data, part, place)]
    child = data.setdefault(part, {})
    if child is None:
        child = data[part] = {}
    if not isinstance(child, (dict, list)):
        raise InputError(f"'{part}' is {child!r} and has no entries of its own", place)
    return child


def _index(data, part, place):
    if not part.isdigit() or int(part) >= len(data):
        raise InputError(f"'{part}' is not an entry of this list; give a number from 0 to {len(data) - 1}", place)
    return int(part)


def explain(error):
    """Place and problem of a pydantic error, in one line: the value that was given, and what would be right."""
    found = error.errors()
    # a misspelt entry first: the one that it was meant for is reported as missing besides
    first = next((one for one in found if one["type"] == "extra_forbidden"), found[0])
    # names of the alternatives that pydantic tried are no entries of the file: `target`, `block`, `(number)`
    parts = [str(part) for part in first["loc"]]
    place = ".".join(part for part in parts if part not in ("target", "block") and not part.startswith("("))
    given = "" if first["type"] in ("missing", "value_error") else f"{first['input']!r}: "
    message = first["msg"].removeprefix("Value error, ")
    if first["type"] == "extra_forbidden":
        missing = [one["loc"][-1] for one in found if one["type"] == "missing" and one["loc"][:-1] == first["loc"][:-1]]
        near = get_close_matches(str(first["loc"][-1]), map(str, missing), 1)
        message, given = f"unknown entry; is {near[0]} meant?" if near else "unknown entry; is it misspelt?", ""
    elif first["type"] == "missing":
        message = "this entry is required"
    more = f" (and {len(found) - 1} more)" if len(found) > 1 else ""
    return place, f"{given}{message}{more}"


def read_data(path, settings=(), kind="a case file holds entries such as spring:, material: and loading:"):
    """Read a YAML file of entries, unchecked.

    Args:
        path: the YAML file.
        settings: texts `key=value` that replace entries of the file.
        kind: what such a file holds, for a file that is no mapping.

    Returns:
        dict.

    Raises:
        InputError: if it cannot be read.
    """
    path = Path(path)
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is not a text file"
        raise InputError(f"the file cannot be read: {reason}", "", path) from None
    data = load_yaml(text, path)
    if not isinstance(data, dict):
        raise InputError(kind, "", path)
    for setting in settings:
        assign(data, setting)
    return data


def check(data, file="", model=Case):
    """The checked Case (or other `model`) of raw data.

    Raises:
        InputError: one line with file, place, value and what would be right.
    """
    try:
        # paths in a case count from its folder
        return model.model_validate(data, context={"folder": Path(file).parent})
    except ValidationError as error:
        place, problem = explain(error)
        raise InputError(problem, place, file) from None


def read_case(path, settings=()):
    """Read and check a case file.

    Args:
        path: the YAML file.
        settings: texts `key=value` that replace entries of the file.

    Returns:
        Case.

    Raises:
        InputError: one line with file, place, value and what would be right.
    """
    return check(read_data(path, settings), path)
