"""What every group of entries of an input file is built on: unknown names are refused, values do not change."""

from pydantic import BaseModel, ConfigDict


class Strict(BaseModel):
    """Unknown entries are refused, numbers must be finite."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)
