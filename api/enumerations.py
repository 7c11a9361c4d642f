"""Enumerations of the code as the API takes and gives them: plain strings, listed in place in its schema."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import Any

from pydantic import GetCoreSchemaHandler
from pydantic_core import CoreSchema, core_schema


@dataclass(frozen=True)
class OneOf:
    """Stands in ``Annotated[str, ...]``: the string is the value of a member of `kind`."""

    kind: type[StrEnum]

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """The values as literals, so that the schema needs no component of its own."""
        values = core_schema.literal_schema([member.value for member in self.kind])
        return core_schema.no_info_before_validator_function(_plain, values)


def _plain(value: Any) -> Any:
    return value.value if isinstance(value, StrEnum) else value
