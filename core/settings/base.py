"""How an option is declared: meaning, unit and source beside its default."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel, ConfigDict, Field

THESIS = "thesis"
"""Source mark: the value of the MSc thesis (chapter 3)."""


class Group(BaseModel):
    """A frozen group of options; unknown names and non-finite numbers are refused."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


def option(default: Any, meaning: str, *, source: str, unit: str = "", **limits: Any) -> Any:
    """Declare an option with its meaning, unit and the source of its default.

    The result has no type of its own, as that of pydantic's `Field`: it stands where a value of the option's own
    type is declared.
    """
    return Field(default, description=meaning, json_schema_extra={"unit": unit, "source": source}, **limits)
