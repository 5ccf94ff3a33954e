"""The `sheet` section of a case: entries for the head of the spring's data sheet."""

from datetime import date
from typing import Annotated, Any

from pydantic import BeforeValidator, Field

from coilset.model.core.base.entry import Strict


def _text(value: Any) -> Any:
    """A number or a date of a YAML file as its text."""
    return str(value) if isinstance(value, int | float | date) and not isinstance(value, bool) else value


Word = Annotated[str, BeforeValidator(_text, json_schema_input_type=str | float), Field(max_length=60)]


class SheetSpec(Strict):
    """Head of the sheet; empty entries leave room to write."""

    customer: Annotated[Word, Field(description="who ordered the spring")] = ""
    order: Annotated[Word, Field(description="number of the order or inquiry")] = ""
    part: Annotated[Word, Field(description="number or name of the part")] = ""
    date: Annotated[Word, Field(description="date of the sheet, as it is to be printed")] = ""
    revision: Annotated[Word, Field(description="revision of the sheet")] = ""
