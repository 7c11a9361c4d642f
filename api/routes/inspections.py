"""The inspection itself: make, list, look at, delete."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from datetime import datetime
from http import HTTPStatus
from typing import Annotated

from fastapi import APIRouter, Header, Query, Request, Response
from starlette.concurrency import run_in_threadpool

from api import schemas
from api.auth import Caller, Reader, Submitter
from api.finding import find_inspection, gone, is_id
from api.naming import Change, MetadataFilter
from api.negotiation import matches
from api.paging import next_link
from api.parameters import Text, moment
from api.problems import Refused, not_found, responses
from api.sending import CREATE_BODY, asked_by_form, asked_by_json
from api.services import Services
from api.state import State, state_of
from api.submit import Asked, accept, require_priority
from api.watching import Snapshot
from store.inspections import mark_deleted
from store.listing import Filter, list_inspections
from store.models import ACTIVE_INSPECTION
from store.naming import rename
from store.status import Statuses

router = APIRouter(prefix="/v1/inspections", tags=["inspections"])

_POLL_S = 2
"""What `Retry-After` asks of a client while an inspection is active."""
_ETAG = {"ETag": {"description": "names this state of the resource", "schema": {"type": "string"}}}
_LATER = {"Retry-After": {"description": "seconds, while it is active", "schema": {"type": "integer"}}}


@router.post(
    "",
    status_code=202,
    response_model=schemas.Resource,
    summary="Start an inspection",
    openapi_extra=CREATE_BODY,
    responses={
        202: {
            "description": "accepted; poll `Location`",
            "headers": {"Location": {"schema": {"type": "string"}}, **_ETAG, **_LATER},
        },
        **responses(400, 401, 409, 413, 415, 422, 429, 503, 507),
    },
)
async def create(
    request: Request,
    caller: Submitter,
    idempotency_key: Annotated[
        str | None,
        Header(
            min_length=1,
            max_length=200,
            pattern=r"^[\x21-\x7e]+$",
            description="the same key and body have one effect, however often they are sent",
            examples=["WO-1187-1"],
        ),
    ] = None,
) -> Response:
    """Take videos, their annotations and parameters, or the names of finished uploads, and queue the work."""
    state = state_of(request)
    async with _asked(request, state, caller, idempotency_key) as asked:
        inspection_id = await accept(state, asked, request)
    state.watcher.invalidate(inspection_id)
    return await represent(state, inspection_id, caller, status=HTTPStatus.ACCEPTED)


@asynccontextmanager
async def _asked(request: Request, state: State, caller: Caller, key: str | None) -> AsyncIterator[Asked]:
    kind = request.headers.get("content-type", "").split(";")[0].strip().lower()
    if kind == "multipart/form-data":
        state.prober.turns.require_room(caller.owner)
        async with asked_by_form(request, state.services, caller.owner, key) as asked:
            yield asked
    elif kind == "application/json":
        async with asked_by_json(request, state.services, state.fetches, caller.owner, key) as asked:
            yield asked
    else:
        detail = "send multipart/form-data with the files, or application/json with finished uploads"
        raise Refused(HTTPStatus.UNSUPPORTED_MEDIA_TYPE, "content_type", detail, where="Content-Type")


async def represent(
    state: State, inspection_id: str, caller: Caller, *, status: HTTPStatus = HTTPStatus.OK
) -> Response:
    """The resource as it is now, as the answer to a change."""
    snapshot = _own(await state.watcher.look(inspection_id), caller)
    return _send(snapshot, status, {"Location": state.services.link(f"/v1/inspections/{inspection_id}")})


def _own(snapshot: Snapshot | None, caller: Caller) -> Snapshot:
    if snapshot is None or snapshot.owner != caller.owner:
        raise not_found("inspection")
    if snapshot.deleted:
        raise gone()
    return snapshot


def _send(snapshot: Snapshot, status: HTTPStatus, headers: dict[str, str]) -> Response:
    headers["ETag"] = snapshot.etag
    if snapshot.active:
        headers["Retry-After"] = str(_POLL_S)
    body = b"" if status == HTTPStatus.NOT_MODIFIED else snapshot.body
    return Response(body, status, headers, "application/json")


@router.get(
    "/{inspection_id}",
    response_model=schemas.Resource,
    summary="Look at an inspection",
    responses={
        200: {"headers": {**_ETAG, **_LATER}},
        304: {"description": "not changed since `If-None-Match`"},
        **responses(401, 404, 410, 503),
    },
)
async def look(
    request: Request,
    caller: Reader,
    inspection_id: str,
    wait: Annotated[
        float,
        Query(
            ge=0,
            le=60,
            description="seconds to wait: with `If-None-Match` until it changes, else until it is over",
            examples=[30],
        ),
    ] = 0,
    if_none_match: Annotated[str | None, Header(description="an `ETag` that was seen before")] = None,
) -> Response:
    """The resource; with `wait` a long poll."""
    if not is_id(inspection_id):
        raise not_found("inspection")
    watcher = state_of(request).watcher
    snapshot = _own(await watcher.look(inspection_id), caller)
    if wait and snapshot.active:
        # Only a tag that still holds makes a client wait for the next one.
        seen = snapshot.etag if matches(if_none_match, snapshot.etag) else None
        if if_none_match is None or seen is not None:
            snapshot = _own(await watcher.wait(inspection_id, wait, seen), caller)
    if matches(if_none_match, snapshot.etag):
        return _send(snapshot, HTTPStatus.NOT_MODIFIED, {})
    return _send(snapshot, HTTPStatus.OK, {})


@router.get("", summary="List inspections", responses=responses(400, 401, 422, 503))
def listing(
    request: Request,
    response: Response,
    caller: Reader,
    metadata: MetadataFilter,
    state: Annotated[list[schemas.State] | None, Query(description="any of these", examples=[["running"]])] = None,
    label: Annotated[Text | None, Query(description="exactly this label")] = None,
    external_id: Annotated[Text | None, Query(description="exactly this external id")] = None,
    created_after: Annotated[datetime | None, Query(description="at or after this moment (UTC if no zone)")] = None,
    created_before: Annotated[datetime | None, Query(description="before this moment")] = None,
    limit: Annotated[int, Query(ge=1, le=200, description="inspections on a page")] = 50,
    cursor: Annotated[str | None, Query(max_length=500, description="`next_cursor` of the page before")] = None,
) -> schemas.Inspections:
    """The caller's inspections, newest first."""
    here = state_of(request)
    chosen = Filter(
        owner=caller.owner,
        states=tuple(state or ()),
        label=label,
        external_id=external_id,
        created_after=moment(created_after, "created_after"),
        created_before=moment(created_before, "created_before"),
        metadata=metadata,
    )
    services = here.services
    page = list_inspections(services.db, chosen, limit, cursor)
    shown = Statuses(services.db, services.graph).read_many(page.rows)
    if page.cursor is not None:
        response.headers["Link"] = next_link(request, page.cursor)
    return schemas.Inspections(
        inspections=[here.resources.resource(status) for status in shown], next_cursor=page.cursor
    )


@router.patch(
    "/{inspection_id}",
    response_model=schemas.Resource,
    summary="Change what an inspection is named by",
    responses={200: {"headers": _ETAG}, **responses(400, 401, 404, 410, 422, 503)},
)
async def change(request: Request, caller: Submitter, inspection_id: str, body: Change) -> Response:
    """Set label, external id, priority, and single entries of the metadata; files that are published stay."""
    state = state_of(request)
    await run_in_threadpool(_change, state.services, inspection_id, caller.owner, body)
    state.watcher.invalidate(inspection_id)
    return await represent(state, inspection_id, caller)


def _change(services: Services, inspection_id: str, owner: str, body: Change) -> None:
    find_inspection(services, inspection_id, owner)
    require_priority(services, owner, body.priority or 0, "/priority")
    rename(services.db, inspection_id, body.naming())


@router.delete(
    "/{inspection_id}",
    status_code=204,
    response_class=Response,
    summary="Delete an inspection",
    responses=responses(401, 404, 410, 503),
)
async def delete(request: Request, caller: Submitter, inspection_id: str) -> Response:
    """Stop it if it is active, and remove it: from now on its id answers 410; files go soon after."""
    state = state_of(request)
    await run_in_threadpool(_delete, state, inspection_id, caller.owner)
    state.watcher.invalidate(inspection_id)
    return Response(status_code=HTTPStatus.NO_CONTENT)


def _delete(state: State, inspection_id: str, owner: str) -> None:
    services = state.services
    row = find_inspection(services, inspection_id, owner)
    if row.state in ACTIVE_INSPECTION:
        services.plan.cancel(inspection_id)
    if not mark_deleted(services.db, inspection_id):
        raise gone()
    services.wake(inspection_id)
