"""The stages of an inspection in full, and the logs of their tasks, which are kept after a failure."""

from __future__ import annotations

from collections import defaultdict
from datetime import datetime
from typing import Annotated, Any

from fastapi import APIRouter, Query, Request, Response
from pydantic import BaseModel, ConfigDict, Field, RootModel
from sqlalchemy import select

from api.auth import Reader
from api.finding import find_inspection
from api.negotiation import CSV_RESPONSE, Format, table
from api.parameters import Text
from api.problems import not_found, responses
from api.schemas import EXAMPLE_STAGE, StageItem
from api.services import Services
from api.state import state_of
from core.task_key import stage_of
from store.models import Attempt
from store.status import StageStatus, Statuses

router = APIRouter(prefix="/v1/inspections/{inspection_id}", tags=["inspections"])

_MORE_EXAMPLE = {"ended_at": None, "attempts": 4, "reused": 0, "seconds": 84.2, "peak_rss_bytes": 512000000}
_COLUMNS = (
    "name",
    "state",
    "done",
    "total",
    "progress",
    "started_at",
    "ended_at",
    "attempts",
    "reused",
    "seconds",
    "peak_rss_bytes",
    "workers",
)
_LINE: dict[str, Any] = {
    "task": "coarse/seg_000_0000_0180",
    "time": "2026-05-04T09:31:10.123+00:00",
    "event": "attempt_started",
    "fields": {"attempt": 1},
}


class StageDetail(StageItem):
    """One stage with what it took."""

    model_config = ConfigDict(
        json_schema_extra={"example": {**EXAMPLE_STAGE, **_MORE_EXAMPLE, "workers": ["host-a:812/0"]}}
    )

    ended_at: datetime | None
    attempts: int = Field(description="attempts of its tasks, those given back unharmed not counted")
    reused: int = Field(description="tasks whose result was already there")
    seconds: float = Field(description="summed over its tasks")
    peak_rss_bytes: int | None = Field(description="largest resident size of one task")
    workers: list[str] = Field(description="who worked on it")


StageTable = RootModel[list[StageDetail]]


@router.get(
    "/stages",
    response_model=StageTable,
    summary="Every stage: state, counts, attempts, times, memory, workers",
    responses={**CSV_RESPONSE, **responses(401, 404, 410, 503)},
)
def stages(request: Request, caller: Reader, inspection_id: str, format: Format = None) -> Response:
    """Stages in the order of the method, as JSON or CSV."""
    state = state_of(request)
    services = state.services
    find_inspection(services, inspection_id, caller.owner)
    status = Statuses(services.db, services.graph).read(inspection_id)
    if status is None:
        raise not_found("inspection")
    workers = _workers(services, inspection_id)
    by = state.resources.expectation(status.row)
    items = [(state.resources.stage(stage, by), stage) for stage in status.stages]
    rows = [_detail(item, stage, workers.get(stage.name, [])).model_dump(mode="json") for item, stage in items]
    return table(request, format, _COLUMNS, rows)


def _detail(item: StageItem, stage: StageStatus, workers: list[str]) -> StageDetail:
    more: dict[str, Any] = {
        "ended_at": stage.ended_at,
        "attempts": stage.attempts,
        "reused": stage.reused,
        "seconds": stage.seconds,
        "peak_rss_bytes": stage.peak_rss_bytes,
        "workers": workers,
    }
    return StageDetail.model_validate({**item.model_dump(), **more})


def _workers(services: Services, inspection_id: str) -> dict[str, list[str]]:
    """Who held a lease, by stage."""
    query = select(Attempt.key, Attempt.owner).where(Attempt.inspection_id == inspection_id).distinct()
    found: dict[str, set[str]] = defaultdict(set)
    with services.db.read() as session:
        for key, owner in session.execute(query):
            found[stage_of(key)].add(owner)
    return {stage: sorted(owners) for stage, owners in found.items()}


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
    caller: Reader,
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
