"""Names of an inspection in requests: filters by metadata, and the change of label, external id, priority, metadata."""

from __future__ import annotations

from http import HTTPStatus
from typing import Annotated

from fastapi import Depends, Query, Request
from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError

from api.parameters import METADATA, MetadataName, Text
from api.problems import FieldError, Refused, pointer
from core.metadata import KNOWN_METADATA, MAX_ENTRIES
from store.naming import Naming

_TEXT: TypeAdapter[str] = TypeAdapter(Text)


def _described(name: str) -> str:
    return f"exactly this: {KNOWN_METADATA[name]}"


def _metadata_filter(
    request: Request,
    engine_type: Annotated[
        Text | None, Query(alias="metadata.engine_type", description=_described("engine_type"))
    ] = None,
    engine_serial: Annotated[
        Text | None, Query(alias="metadata.engine_serial", description=_described("engine_serial"))
    ] = None,
    module: Annotated[Text | None, Query(alias="metadata.module", description=_described("module"))] = None,
    stage: Annotated[Text | None, Query(alias="metadata.stage", description=_described("stage"))] = None,
    position: Annotated[Text | None, Query(alias="metadata.position", description=_described("position"))] = None,
    work_order: Annotated[Text | None, Query(alias="metadata.work_order", description=_described("work_order"))] = None,
    inspector: Annotated[Text | None, Query(alias="metadata.inspector", description=_described("inspector"))] = None,
    equipment: Annotated[Text | None, Query(alias="metadata.equipment", description=_described("equipment"))] = None,
) -> dict[str, str]:
    """Entries that inspections must have: of the query parameters ``metadata.NAME``, the free names included."""
    chosen = {
        name.removeprefix(METADATA): value for name, value in request.query_params.items() if name.startswith(METADATA)
    }
    for name, value in chosen.items():
        try:
            _TEXT.validate_python(value)
        except ValidationError as error:
            detail = error.errors(include_url=False)[0]["msg"]
            errors = [FieldError(pointer=pointer(("query", METADATA + name)), detail=detail)]
            status = HTTPStatus.UNPROCESSABLE_ENTITY
            raise Refused(status, "bad_request", detail, where=METADATA + name, errors=errors) from None
    return chosen


MetadataFilter = Annotated[dict[str, str], Depends(_metadata_filter)]
"""Parameter of a route that lists inspections."""


class Change(BaseModel):
    """What is to be changed; what is left out, or null, stays."""

    model_config = ConfigDict(
        extra="forbid",
        json_schema_extra={"example": {"label": "engine 4", "metadata": {"work_order": "WO-1187", "position": None}}},
    )

    label: Text | None = Field(None, description="free text")
    external_id: Text | None = Field(None, description="the caller's own name for it; need not be unique")
    priority: int | None = Field(None, ge=0, le=9, description="at most the account's `max_priority`")
    metadata: dict[MetadataName, Text | None] | None = Field(
        None, max_length=MAX_ENTRIES, description="entries to be set; null or an empty text removes one, others stay"
    )

    def naming(self) -> Naming:
        """The same for the store."""
        return Naming(self.label, self.external_id, self.priority, self.metadata)
