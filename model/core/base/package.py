"""The doors to optional packages: what a file names is imported when it is named, and refused where it is missing."""

import importlib
from dataclasses import dataclass
from functools import cached_property
from types import ModuleType
from typing import Any

from pydantic import GetJsonSchemaHandler, SerializationInfo, TypeAdapter, ValidationInfo
from pydantic_core import core_schema

from coilset.model.core.base.errors import InputError
from coilset.model.core.base.strict_entries import Strict


def package(module: str, purpose: str, place: str = "") -> ModuleType:
    """A module of an optional package.

    Args:
        module: its name, as in `coilset.model.physics.warping.warping`.
        purpose: what needs it, in words.
        place: entry of the case that does.

    Raises:
        InputError: if this installation does not have it, or not what it is built on.
    """
    lacked = missing(module)
    if lacked is not None:
        raise InputError(f"{purpose} needs the package {lacked}, which this installation lacks", place)
    return importlib.import_module(module)


def optional(module: str) -> ModuleType | None:
    """A module of an optional package; None if this installation does not have it, or not what it is built on."""
    return importlib.import_module(module) if missing(module) is None else None


def missing(module: str) -> str | None:
    """The package that is lacking for a module of an optional one; None if it can be imported.

    Raises:
        ModuleNotFoundError: what is lacking is none of coilset's own.
    """
    try:
        importlib.import_module(module)
    except ModuleNotFoundError as error:
        if error.name is None or not error.name.startswith("coilset."):
            raise
        return error.name
    return None


@dataclass(frozen=True)
class Entry:
    """An entry of a file whose form an optional package defines: `Annotated[Any, Entry("module:name")]`.

    The package is imported when a file has the entry; where it is missing the entry is refused.

    Args:
        form: the module and in it the name of a group of entries, or of any other type.
    """

    form: str

    @property
    def type(self) -> Any:
        """The form.

        Raises:
            InputError: if this installation does not have it.
        """
        module, _, name = self.form.partition(":")
        return getattr(package(module, "this entry"), name)

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> core_schema.CoreSchema:
        plain = core_schema.plain_serializer_function_ser_schema(self._plain, info_arg=True)
        check = core_schema.with_info_plain_validator_function(self._checked, serialization=plain)
        return core_schema.nullable_schema(check)

    def __get_pydantic_json_schema__(self, schema: Any, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        return handler(self._adapter.core_schema)

    def _checked(self, value: Any, info: ValidationInfo) -> Any:
        try:
            return self._adapter.validate_python(value, context=info.context)
        except InputError as error:
            raise ValueError(error.problem) from None

    def _plain(self, value: Any, info: SerializationInfo) -> Any:
        asked = {name: getattr(info, name) for name in ("mode", "exclude_unset", "exclude_defaults", "exclude_none")}
        return self._adapter.dump_python(value, **asked)

    @cached_property
    def _adapter(self) -> TypeAdapter[Any]:
        form = self.type
        own = isinstance(form, type) and issubclass(form, Strict)
        return TypeAdapter(form, config=None if own else Strict.model_config)
