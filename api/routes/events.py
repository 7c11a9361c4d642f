"""Events of an inspection and of an account: as a stream for who accepts one, else as pages of JSON."""

from __future__ import annotations

from collections.abc import Callable
from datetime import datetime
from functools import partial
from http import HTTPStatus
from typing import Annotated, Any

from fastapi import APIRouter, Header, Query, Request, Response
from pydantic import BaseModel, ConfigDict, Field
from starlette.concurrency import run_in_threadpool

from api.auth import Caller, Reader
from api.events import STREAM, EventStream, Reading
from api.finding import find_inspection
from api.parameters import OneOf
from api.problems import Refused, responses
from api.schemas import EXAMPLE_ID
from api.services import Services
from api.state import State, state_of
from store.events import Events, EventType, EventView
from store.keys import utc_now
from store.models import ACTIVE_INSPECTION, Inspection
from store.status import shown_state

router = APIRouter(tags=["events"])

_LARGEST = (1 << 31) - 1
_EXAMPLE: dict[str, Any] = {
    "number": 7,
    "type": EventType.RUNNING,
    "at": "2026-05-04T09:30:03Z",
    "inspection": {"id": EXAMPLE_ID, "state": "running", "stage": "probe", "attempt": 1, "metadata": {}},
}


class EventItem(BaseModel):
    """A change of an inspection."""

    number: int = Field(description="grows within the account; of one inspection with gaps")
    type: Annotated[str, OneOf(EventType)]
    at: datetime
    inspection: dict[str, Any] = Field(
        description="as it was then: id, state, stage, attempt, label, external_id, metadata, failed_stage, code"
    )


class EventPage(BaseModel):
    """Some events, in their order."""

    model_config = ConfigDict(json_schema_extra={"example": {"events": [_EXAMPLE], "last": 7}})

    events: list[EventItem]
    last: int = Field(description="`after` of the next request; ask it again later for what came meanwhile")


After = Annotated[
    int | None, Query(ge=0, le=_LARGEST, description="events behind this number; `Last-Event-ID` wins over it")
]
Limit = Annotated[int, Query(ge=1, le=1000, description="events of a JSON answer at most")]
LastId = Annotated[str | None, Header(description="sent by a client whose stream was cut off", max_length=20)]
_RESPONSES: dict[int | str, dict[str, Any]] = {
    200: {"content": {STREAM: {"schema": {"type": "string"}, "example": "id: 7\nevent: inspection.running\ndata: {}"}}}
}


@router.get(
    "/v1/inspections/{inspection_id}/events",
    response_model=EventPage,
    summary="Events of an inspection",
    responses={**_RESPONSES, **responses(400, 401, 404, 410, 422, 503)},
)
async def of_inspection(
    request: Request,
    caller: Reader,
    inspection_id: str,
    after: After = None,
    limit: Limit = 100,
    last_event_id: LastId = None,
) -> Response:
    """All events of it, then with `Accept: text/event-stream` those to come, and `end` when it is over."""
    state = state_of(request)
    await run_in_threadpool(find_inspection, state.services, inspection_id, caller.owner)
    begin = _begin(after, last_event_id) or 0
    over = partial(_is_over, state.services, inspection_id)
    return await _answer(request, _reading(state, caller, inspection_id, over), begin, limit)


@router.get(
    "/v1/events",
    response_model=EventPage,
    summary="Events of the account",
    responses={**_RESPONSES, **responses(400, 401, 422, 503)},
)
async def of_account(
    request: Request, caller: Reader, after: After = None, limit: Limit = 100, last_event_id: LastId = None
) -> Response:
    """Events of all its inspections; without a number, JSON begins with the oldest, and a stream with what is new."""
    state = state_of(request)
    begin = _begin(after, last_event_id)
    if begin is None:
        last = await run_in_threadpool(Events(state.services.db).last, (caller.owner,))
        begin = last[caller.owner] if _wants_stream(request) else 0
    return await _answer(request, _reading(state, caller, None, lambda: False), begin, limit)


def _begin(after: int | None, last_event_id: str | None) -> int | None:
    """The number to begin behind; 400 for an id that is none of ours."""
    if last_event_id is None or last_event_id == "":
        return after
    if not (last_event_id.isascii() and last_event_id.isdigit() and int(last_event_id) <= _LARGEST):
        detail = "this is no id of an event"
        raise Refused(HTTPStatus.BAD_REQUEST, "bad_event_id", detail, where="Last-Event-ID")
    return int(last_event_id)


def _wants_stream(request: Request) -> bool:
    kinds = (part.split(";")[0].strip().lower() for part in request.headers.get("accept", "").split(","))
    return STREAM in kinds


async def _answer(request: Request, reading: Reading, begin: int, limit: int) -> Response:
    if _wants_stream(request):
        reading.feed.enter(reading.owner)
        return EventStream(reading, begin)
    events = await run_in_threadpool(partial(reading.events.after, reading.owner, begin, limit, reading.inspection_id))
    page = EventPage(events=[_item(event) for event in events], last=events[-1].number if events else begin)
    return Response(page.model_dump_json(), media_type="application/json")


def _item(event: EventView) -> EventItem:
    return EventItem(number=event.number, type=event.type, at=event.at, inspection=dict(event.inspection))


def _reading(state: State, caller: Caller, inspection_id: str | None, over: Callable[[], bool]) -> Reading:
    may_go_on = partial(_may_go_on, state, caller)
    return Reading(Events(state.services.db), state.feed, caller.owner, inspection_id, may_go_on, over)


def _may_go_on(state: State, caller: Caller) -> bool:
    """False once the caller's key has ended, or a first key was made for a caller without one.

    As right as this process knows: what other requests asked of the keys.
    """
    if not caller.key_id:
        return not state.keys.ever_made
    key = state.keys.by_id(caller.key_id)
    return key is not None and key.ended(utc_now()) is None


def _is_over(services: Services, inspection_id: str) -> bool:
    """True once nothing follows: it is over, or was deleted."""
    with services.db.read() as session:
        row = session.get(Inspection, inspection_id)
    return row is None or row.deleted_at is not None or shown_state(row) not in ACTIVE_INSPECTION
