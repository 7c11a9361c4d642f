"""Logs of an inspection's tasks; kept on disk, and after a failure."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import APIRouter, Query, Request
from pydantic import BaseModel, ConfigDict, Field

from api.auth import CallerOf
from api.finding import find_inspection
from api.parameters import Text
from api.problems import responses
from api.state import state_of

router = APIRouter(prefix="/v1/inspections/{inspection_id}", tags=["inspections"])

_LINE: dict[str, Any] = {
    "task": "coarse/seg_000_0000_0180",
    "time": "2026-05-04T09:31:10.123+00:00",
    "event": "attempt_started",
    "fields": {"attempt": 1},
}


class LogItem(BaseModel):
    """One line."""

    task: str
    time: str | None
    event: str = Field(description="name of the event, or the line itself when it is plain text")
    fields: dict[str, Any]


class LogPage(BaseModel):
    """Some lines by time, and where to go on."""

    model_config = ConfigDict(json_schema_extra={"example": {"lines": [_LINE], "next": "eNqrVi..."}})

    lines: list[LogItem]
    next: str = Field(description="`after` of the next request; ask it again later for what was written meanwhile")


@router.get("/logs", summary="Read the logs", responses=responses(400, 401, 404, 410, 422, 503))
def logs(
    request: Request,
    caller: CallerOf,
    inspection_id: str,
    after: Annotated[str | None, Query(max_length=8000, description="`next` of the answer before")] = None,
    limit: Annotated[int, Query(ge=1, le=5000, description="lines at most")] = 500,
    task: Annotated[Text | None, Query(description="of this task only, e.g. `mesh`")] = None,
) -> LogPage:
    """Every line comes once, whichever task wrote it."""
    services = state_of(request).services
    find_inspection(services, inspection_id, caller.owner)
    page = services.logs.read(inspection_id, after, limit, task)
    lines = [LogItem(task=line.task, time=line.time, event=line.event, fields=dict(line.fields)) for line in page.lines]
    return LogPage(lines=lines, next=page.cursor)
