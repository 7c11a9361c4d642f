"""Tables of an inspection, from the rows that the stages wrote: JSON or CSV, filtered."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from http import HTTPStatus
from typing import Annotated, Any

from fastapi import APIRouter, Header, Query, Request, Response
from pydantic import BaseModel

from api import table_schemas as schemas
from api.auth import Reader
from api.finding import find_inspection
from api.negotiation import CSV_RESPONSE, Format, TableForm, matches, table, wants_csv
from api.paging import TABLE_RESPONSES, Asked, AskedFor, Source, paged
from api.parameters import OneOf, Seconds, Share, Text
from api.problems import Refused, not_found, responses
from api.reviewed import ReviewedSource, WithReview, reviewed_form
from api.state import state_of
from core.scene.case import CaseKind, CaseStatus
from core.scene.detection import Outcome
from store.models import ACTIVE_INSPECTION, Inspection
from store.publishing import ArtifactRows
from store.status import shown_state
from store.tables import (
    CASES,
    DEFECT_COLUMNS,
    DEFECTS,
    DETECTIONS,
    METRICS,
    TIMELINE,
    RowFilter,
    Table,
    flat_defect,
    read_rows,
)

router = APIRouter(prefix="/v1/inspections/{inspection_id}", tags=["results"])

_ERRORS = responses(401, 404, 410, 422, 503)
Label = Annotated[Text | None, Query(description="exactly this label")]
Blade = Annotated[Text | None, Query(description="exactly this blade")]
Confidence = Annotated[Share | None, Query(description="at least this confidence")]
Video = Annotated[int | None, Query(ge=0, lt=2**31, description="number of the video, from 0 in the order given")]
From = Annotated[Seconds | None, Query(description="seconds from the first frame: what ends at or after it")]
To = Annotated[Seconds | None, Query(description="seconds from the first frame: what begins at or before it")]


def _answer(
    request: Request,
    caller: Reader,
    inspection_id: str,
    what: Table,
    chosen: RowFilter,
    asked: Asked,
    reviewed: bool = False,
) -> Response:
    services = state_of(request).services
    find_inspection(services, inspection_id, caller.owner)
    as_csv = wants_csv(request, asked.format)
    columns, flat = (DEFECT_COLUMNS, flat_defect) if what is DEFECTS else (what.columns, dict)
    if reviewed:
        source: Source = ReviewedSource(services.db, inspection_id, what, chosen)
        return paged(request, source, reviewed_form(columns, flat, as_csv), asked)
    source = Source(services.db, inspection_id, what, chosen)
    return paged(request, source, TableForm(columns, as_csv=as_csv, flat=flat), asked)


@router.get(
    "/cases",
    response_model=schemas.list_of(schemas.Case),
    summary="Every reconstruction case of the window search",
    responses=TABLE_RESPONSES,
)
def cases(
    request: Request,
    caller: Reader,
    inspection_id: str,
    asked: AskedFor,
    kind: Annotated[str, OneOf(CaseKind)] | None = None,
    status: Annotated[str, OneOf(CaseStatus)] | None = None,
) -> Response:
    """Rows of cases.csv, so far as cases have ended."""
    return _answer(request, caller, inspection_id, CASES, RowFilter({"kind": kind, "status": status}), asked)


@router.get("/cases/{name}", response_model=schemas.Case, summary="One case", responses=_ERRORS)
def case(request: Request, caller: Reader, inspection_id: str, name: str) -> BaseModel:
    """One row of cases.csv by its name, e.g. `seg_000_0000_0180`."""
    services = state_of(request).services
    find_inspection(services, inspection_id, caller.owner)
    if "\0" in name:
        raise not_found("case")
    rows = read_rows(services.db, inspection_id, CASES, RowFilter({"name": name}))
    if not rows:
        raise not_found("case")
    return schemas.Case.model_validate(rows[0])


@router.get(
    "/metrics",
    response_model=schemas.list_of(schemas.Metric),
    summary="Every number that a stage found",
    responses=TABLE_RESPONSES,
)
def metrics(request: Request, caller: Reader, inspection_id: str, asked: AskedFor) -> Response:
    """Names are `<task key>.<fact>`."""
    return _answer(request, caller, inspection_id, METRICS, RowFilter({}), asked)


@router.get(
    "/detections",
    response_model=schemas.list_of(schemas.Detection),
    summary="One row per detection of the annotations",
    responses=TABLE_RESPONSES,
)
def detections(
    request: Request,
    caller: Reader,
    inspection_id: str,
    asked: AskedFor,
    outcome: Annotated[str, OneOf(Outcome)] | None = None,
    video: Video = None,
    label: Label = None,
    blade: Blade = None,
    defect_id: Annotated[int | None, Query(ge=0, lt=2**31)] = None,
    min_confidence: Confidence = None,
    from_s: From = None,
    to_s: To = None,
    reviewed: WithReview = False,
) -> Response:
    """Rows of mapping/detections.csv, none dropped unless a filter says so."""
    equal = {"outcome": outcome, "video": video, "label": label, "blade": blade, "defect_id": defect_id}
    chosen = RowFilter(equal, min_confidence, from_s, to_s)
    return _answer(request, caller, inspection_id, DETECTIONS, chosen, asked, reviewed)


@router.get(
    "/timeline",
    response_model=schemas.list_of(schemas.Event),
    summary="One row per event",
    responses=TABLE_RESPONSES,
)
def timeline(
    request: Request,
    caller: Reader,
    inspection_id: str,
    asked: AskedFor,
    video: Video = None,
    label: Label = None,
    defect_id: Annotated[int | None, Query(ge=0, lt=2**31)] = None,
    min_confidence: Confidence = None,
    from_s: From = None,
    to_s: To = None,
    reviewed: WithReview = False,
) -> Response:
    """Rows of mapping/timeline.csv, by start."""
    chosen = RowFilter({"video": video, "label": label, "defect_id": defect_id}, min_confidence, from_s, to_s)
    return _answer(request, caller, inspection_id, TIMELINE, chosen, asked, reviewed)


@router.get(
    "/defects",
    response_model=schemas.list_of(schemas.Defect),
    summary="One record per physical defect",
    responses=TABLE_RESPONSES,
)
def defects(
    request: Request,
    caller: Reader,
    inspection_id: str,
    asked: AskedFor,
    label: Label = None,
    blade: Blade = None,
    min_confidence: Confidence = None,
    reviewed: WithReview = False,
) -> Response:
    """Records of mapping/defects.json; as CSV their lists are counted.

    With the warning `several_models` two of them can be one defect: how many there are is the range
    `funnel.defects_at_least` to `funnel.defects` of quality.json.
    """
    chosen = RowFilter({"label": label, "blade": blade}, min_confidence)
    return _answer(request, caller, inspection_id, DEFECTS, chosen, asked, reviewed)


@router.get(
    "/quality",
    response_model=schemas.Quality,
    summary="How far the result can be trusted",
    responses={
        **CSV_RESPONSE,
        304: {"description": "it is the report that `If-None-Match` names"},
        **responses(401, 404, 409, 410, 503),
    },
)
def quality(
    request: Request,
    caller: Reader,
    inspection_id: str,
    format: Format = None,
    if_none_match: Annotated[str | None, Header(description="an `ETag` that is at hand")] = None,
) -> Response:
    """quality.json; as CSV its single values by dotted name. 409 until the inspection is over."""
    services = state_of(request).services
    row = find_inspection(services, inspection_id, caller.owner)
    artifact = ArtifactRows(services.db).find(inspection_id, "quality.json")
    if artifact is None:
        raise not_ready(row, "quality report")
    as_csv = wants_csv(request, format)
    headers = {"ETag": f'"{artifact.sha256}{"-csv" if as_csv else ""}"', "Vary": "Accept"}
    if matches(if_none_match, headers["ETag"]):
        return Response(status_code=HTTPStatus.NOT_MODIFIED, headers=headers)
    with services.artifacts.open(artifact.key) as stream:
        data = stream.read()
    if not as_csv:
        return Response(data, media_type="application/json", headers=headers)
    values = ({"name": name, "value": value} for name, value in flattened(json.loads(data)))
    answer = table(request, "csv", ("name", "value"), values)
    answer.headers.update(headers)
    return answer


def not_ready(row: Inspection, what: str) -> Refused:
    """409 while it may still come, 404 once it will not."""
    if shown_state(row) in ACTIVE_INSPECTION:
        headers = {"Retry-After": "5"}
        detail = f"the {what} is there when the inspection is over"
        return Refused(HTTPStatus.CONFLICT, "not_ready", detail, headers=headers, retryable=True)
    return not_found(what)


def flattened(value: Any, name: str = "") -> Iterator[tuple[str, Any]]:
    """Single values of a JSON document by dotted name; entries of lists are numbered."""
    if isinstance(value, Mapping):
        for key, inner in value.items():
            yield from flattened(inner, f"{name}.{key}" if name else str(key))
    elif isinstance(value, list):
        for number, inner in enumerate(value):
            yield from flattened(inner, f"{name}.{number}")
    else:
        yield name, value
