"""How an option is declared: meaning, unit and source beside its default."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pydantic import BaseModel, ConfigDict, Field

THESIS = "thesis"
"""Source mark: the value of the MSc thesis (chapter 3)."""


class UndeclaredOption(AttributeError):
    """A stage read an option that its spec does not declare, so that its result would not be named by it."""


class Group(BaseModel):
    """A frozen group of options; unknown names and non-finite numbers are refused."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    if not TYPE_CHECKING:  # a type checker would take it for any name

        def __getattr__(self, name: str) -> Any:
            """Called only for what is not there: say so clearly where it is a declared option that was left out."""
            if name in type(self).model_fields:
                raise UndeclaredOption(f"the stage does not declare that it reads {type(self).__name__}.{name}")
            return super().__getattr__(name)


def option(default: Any, meaning: str, *, source: str, unit: str = "", **limits: Any) -> Any:
    """Declare an option with its meaning, unit and the source of its default.

    The result has no type of its own, as that of pydantic's `Field`: it stands where a value of the option's own
    type is declared.
    """
    return Field(default, description=meaning, json_schema_extra={"unit": unit, "source": source}, **limits)
