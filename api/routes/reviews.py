"""What people say of the findings of an inspection: records that are only ever added."""

from __future__ import annotations

import uuid
from collections.abc import Sequence
from functools import partial
from http import HTTPStatus
from typing import Annotated, Any

from fastapi import APIRouter, Query, Request, Response
from starlette.concurrency import run_in_threadpool

from api.auth import Caller, Reader, Reviewer
from api.finding import find_inspection
from api.problems import FieldError, Refused, responses
from api.review_schemas import HandedOver, Handover, NewReview, ReviewedAnswer, ReviewItem, ReviewList
from api.state import State, state_of
from core.review.published import SCHEMA_VERSION, parse_review
from core.review.record import ReviewRecord
from core.review.words import Action
from store.account_models import Scope
from store.reviews import Author, Reviews

router = APIRouter(prefix="/v1/inspections/{inspection_id}", tags=["reviews"])

_UNSAID = "1970-01-01T00:00:00Z"
"""Stands for the moment of a record that has none yet: the store gives it its own."""


@router.get("/reviews", summary="Review records", responses=responses(401, 404, 410, 422, 503))
def listing(
    request: Request,
    caller: Reader,
    inspection_id: str,
    since: Annotated[int, Query(ge=0, lt=2**31, description="only records behind this revision")] = 0,
) -> ReviewList:
    """All records, in their order; as a whole the answer is a `review.json`."""
    state = state_of(request)
    find_inspection(state.services, inspection_id, caller.owner)
    records = Reviews(state.services.db).since(inspection_id, since)
    return ReviewList(
        schema_version=SCHEMA_VERSION,
        inspection=inspection_id,
        revision=records[-1].revision if records else Reviews(state.services.db).last(inspection_id),
        records=[_item(one) for one in records],
        severities=list(state.services.settings.severity_names()),
        may_review=Scope.REVIEW in caller.scopes,
        you=_author(state, caller).name,
    )


@router.post(
    "/reviews",
    status_code=201,
    response_model=ReviewItem,
    summary="Say something of a finding",
    responses=responses(400, 401, 403, 404, 409, 410, 422, 429, 503),
)
async def append(request: Request, caller: Reviewer, inspection_id: str, body: NewReview) -> Response:
    """Append a record. 409 `stale_revision` when others have written since `revision`: read theirs, then send again.

    Nothing is ever changed: an `undo` names the id of the record that shall not hold. Who and when is the account's.
    """
    state = state_of(request)
    row = {**body.model_dump(exclude={"id"}), "id": body.id or uuid.uuid4().hex, "revision": 1}
    record = ReviewRecord.parse({**row, "time": _UNSAID, "by": ""}, "record")
    _require_severity(state, [record])
    kept = await run_in_threadpool(partial(_append, state, caller, inspection_id, [record], seen=body.revision))
    answer = _item(kept[0]).model_dump_json()
    return Response(answer, HTTPStatus.CREATED, media_type="application/json")


@router.post(
    "/reviews/import",
    summary="Hand over a review",
    responses=responses(400, 401, 403, 404, 410, 422, 429, 503),
)
def hand_over(request: Request, caller: Reviewer, inspection_id: str, body: Handover) -> HandedOver:
    """Append the records of a `review.json` that was made without the service; those that are known are left.

    Each keeps as its `origin` who and when its file says. All of them are written or none.
    """
    state = state_of(request)
    records = parse_review(body.model_dump(exclude_unset=True), "review")
    _require_severity(state, records)
    before = Reviews(state.services.db).last(inspection_id)
    kept = _append(state, caller, inspection_id, records)
    added = sum(one.revision > before for one in kept)
    return HandedOver(
        added=added, known=len(kept) - added, revision=max((one.revision for one in kept), default=before)
    )


@router.get("/reviewed", summary="The findings after review", responses=responses(401, 404, 410, 503))
def reviewed(request: Request, caller: Reader, inspection_id: str) -> ReviewedAnswer:
    """Every finding with what holds of it, those that people made, and what was said of findings that are not there."""
    services = state_of(request).services
    find_inspection(services, inspection_id, caller.owner)
    return ReviewedAnswer.model_validate(Reviews(services.db).reviewed(inspection_id).to_dict())


def _append(
    state: State, caller: Caller, inspection_id: str, records: Sequence[ReviewRecord], seen: int | None = None
) -> list[ReviewRecord]:
    find_inspection(state.services, inspection_id, caller.owner)
    return Reviews(state.services.db).append(inspection_id, records, _author(state, caller), seen)


def _author(state: State, caller: Caller) -> Author:
    key = state.keys.by_id(caller.key_id) if caller.key_id else None
    return Author(key.name if key is not None and key.name else caller.owner, caller.key_id)


def _require_severity(state: State, records: Sequence[ReviewRecord]) -> None:
    """422 for a severity that is not in this deployment's list."""
    known = state.services.settings.severity_names()
    for one in records:
        if one.action == Action.SEVERITY and one.value not in known:
            detail = f"'{one.value}' is no severity here; known: {', '.join(known)}"
            errors = [FieldError(pointer="/value", detail=detail)]
            raise Refused(HTTPStatus.UNPROCESSABLE_ENTITY, "bad_severity", detail, where="value", errors=errors)


def _item(record: ReviewRecord) -> ReviewItem:
    row: dict[str, Any] = record.to_dict()
    return ReviewItem.model_validate(row)
