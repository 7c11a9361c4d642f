"""Kinds of values that come in queries, and enumerations of the code as the API takes and gives them."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import UTC, datetime
from enum import StrEnum
from http import HTTPStatus
from typing import Annotated, Any

from pydantic import AfterValidator, Field, GetCoreSchemaHandler
from pydantic_core import CoreSchema, core_schema

from api.problems import Refused
from core.metadata import NAME_PATTERN, is_metadata_name

Seconds = Annotated[float, Field(ge=0, le=1e9, allow_inf_nan=False)]
"""A time in the video."""
Share = Annotated[float, Field(ge=0, le=1, allow_inf_nan=False)]
"""A number in [0, 1]."""


def _without_nul(text: str) -> str:
    """PostgreSQL keeps no NUL in a text, so no row can have one."""
    if "\0" in text:
        raise ValueError("must not hold the character NUL")
    return text


Text = Annotated[str, Field(max_length=256), AfterValidator(_without_nul)]
"""A text to compare with a column."""


def _metadata_name(name: str) -> str:
    if not is_metadata_name(name):
        raise ValueError("must be small letters, digits and _, beginning with a letter")
    return name


METADATA = "metadata."
"""Begins the name of a query parameter that chooses by metadata."""
MetadataName = Annotated[str, Field(max_length=64, pattern=NAME_PATTERN), AfterValidator(_metadata_name)]
"""Name of an entry of an inspection's metadata."""


def moment(value: datetime | None, name: str) -> datetime | None:
    """A moment of the parameter `name` in UTC, which is meant when it has no zone; 422 outside the calendar."""
    if value is None:
        return None
    try:
        return value.replace(tzinfo=UTC) if value.tzinfo is None else value.astimezone(UTC)
    except OverflowError:
        detail = "this moment is outside the calendar"
        raise Refused(HTTPStatus.UNPROCESSABLE_ENTITY, "bad_request", detail, where=name) from None


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
