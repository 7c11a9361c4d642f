"""Tables of an inspection, from the rows that the stages wrote: JSON or CSV, filtered."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from http import HTTPStatus
from typing import Annotated, Any, Literal

from fastapi import APIRouter, Query, Request, Response

from api import table_schemas as schemas
from api.auth import CallerOf
from api.finding import find_inspection
from api.negotiation import CSV_RESPONSE, Format, table, wants_csv
from api.parameters import Seconds, Share, Text
from api.problems import Refused, not_found, responses
from api.state import state_of
from store.artifact_rows import ArtifactRows
from store.models import Inspection
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
From = Annotated[Seconds | None, Query(description="seconds from the first frame: what ends at or after it")]
To = Annotated[Seconds | None, Query(description="seconds from the first frame: what begins at or before it")]


def _answer(
    request: Request, caller: CallerOf, inspection_id: str, what: Table, chosen: RowFilter, asked: str | None
) -> Response:
    services = state_of(request).services
    find_inspection(services, inspection_id, caller.owner)
    return table(request, asked, what.columns, read_rows(services.db, inspection_id, what, chosen))


@router.get(
    "/cases",
    response_model=list[schemas.Case],
    summary="Every reconstruction case of the window search",
    responses={**CSV_RESPONSE, **_ERRORS},
)
def cases(
    request: Request,
    caller: CallerOf,
    inspection_id: str,
    kind: Literal["coarse", "refine"] | None = None,
    status: Literal["succeeded", "no_model", "failed"] | None = None,
    format: Format = None,
) -> Response:
    """Rows of cases.csv, so far as cases have ended."""
    return _answer(request, caller, inspection_id, CASES, RowFilter({"kind": kind, "status": status}), format)


@router.get("/cases/{name}", summary="One case", responses=_ERRORS)
def case(request: Request, caller: CallerOf, inspection_id: str, name: str) -> schemas.Case:
    """One row of cases.csv by its name, e.g. `seg_000_0000_0180`."""
    services = state_of(request).services
    find_inspection(services, inspection_id, caller.owner)
    if "\0" in name:
        raise not_found("case")
    row = next(read_rows(services.db, inspection_id, CASES, RowFilter({"name": name})), None)
    if row is None:
        raise not_found("case")
    return schemas.Case.model_validate(row)


@router.get(
    "/metrics",
    response_model=list[schemas.Metric],
    summary="Every number that a stage found",
    responses={**CSV_RESPONSE, **_ERRORS},
)
def metrics(request: Request, caller: CallerOf, inspection_id: str, format: Format = None) -> Response:
    """Names are `<task key>.<fact>`."""
    return _answer(request, caller, inspection_id, METRICS, RowFilter({}), format)


@router.get(
    "/detections",
    response_model=list[schemas.Detection],
    summary="One row per detection of the annotations",
    responses={**CSV_RESPONSE, **_ERRORS},
)
def detections(
    request: Request,
    caller: CallerOf,
    inspection_id: str,
    outcome: Literal["mapped", "approximate", "unplaced"] | None = None,
    label: Label = None,
    blade: Blade = None,
    defect_id: Annotated[int | None, Query(ge=0, lt=2**31)] = None,
    min_confidence: Confidence = None,
    from_s: From = None,
    to_s: To = None,
    format: Format = None,
) -> Response:
    """Rows of mapping/detections.csv, none dropped unless a filter says so."""
    equal = {"outcome": outcome, "label": label, "blade": blade, "defect_id": defect_id}
    chosen = RowFilter(equal, min_confidence, from_s, to_s)
    return _answer(request, caller, inspection_id, DETECTIONS, chosen, format)


@router.get(
    "/timeline",
    response_model=list[schemas.Event],
    summary="One row per event",
    responses={**CSV_RESPONSE, **_ERRORS},
)
def timeline(
    request: Request,
    caller: CallerOf,
    inspection_id: str,
    label: Label = None,
    defect_id: Annotated[int | None, Query(ge=0, lt=2**31)] = None,
    min_confidence: Confidence = None,
    from_s: From = None,
    to_s: To = None,
    format: Format = None,
) -> Response:
    """Rows of mapping/timeline.csv, by start."""
    chosen = RowFilter({"label": label, "defect_id": defect_id}, min_confidence, from_s, to_s)
    return _answer(request, caller, inspection_id, TIMELINE, chosen, format)


@router.get(
    "/defects",
    response_model=list[schemas.Defect],
    summary="One record per physical defect",
    responses={**CSV_RESPONSE, **_ERRORS},
)
def defects(
    request: Request,
    caller: CallerOf,
    inspection_id: str,
    label: Label = None,
    blade: Blade = None,
    min_confidence: Confidence = None,
    format: Format = None,
) -> Response:
    """Records of mapping/defects.json; as CSV their lists are counted."""
    services = state_of(request).services
    find_inspection(services, inspection_id, caller.owner)
    records = read_rows(services.db, inspection_id, DEFECTS, RowFilter({"label": label}))
    chosen = _of_blade(records, blade, min_confidence)
    if wants_csv(request, format):
        return table(request, "csv", DEFECT_COLUMNS, (flat_defect(record) for record in chosen))
    return table(request, "json", (), chosen)


def _of_blade(
    records: Iterator[dict[str, Any]], blade: str | None, min_confidence: float | None
) -> Iterator[dict[str, Any]]:
    """What no column of the table says is looked for in the record."""
    for record in records:
        confidence = flat_defect(record)["confidence"]
        sure = min_confidence is None or (confidence is not None and confidence >= min_confidence)
        if sure and blade in (None, record.get("blade")):
            yield record


@router.get(
    "/quality",
    response_model=schemas.Quality,
    summary="How far the result can be trusted",
    responses={**CSV_RESPONSE, **responses(401, 404, 409, 410, 503)},
)
def quality(request: Request, caller: CallerOf, inspection_id: str, format: Format = None) -> Response:
    """quality.json; as CSV its single values by dotted name. 409 until the inspection is over."""
    services = state_of(request).services
    row = find_inspection(services, inspection_id, caller.owner)
    artifact = ArtifactRows(services.db).find(inspection_id, "quality.json")
    if artifact is None:
        raise not_ready(row, "quality report")
    with services.artifacts.open(artifact.key) as stream:
        data = stream.read()
    if not wants_csv(request, format):
        return Response(data, media_type="application/json", headers={"Vary": "Accept"})
    values = ({"name": name, "value": value} for name, value in flattened(json.loads(data)))
    return table(request, "csv", ("name", "value"), values)


def not_ready(row: Inspection, what: str) -> Refused:
    """409 while it may still come, 404 once it will not."""
    if shown_state(row) in ("queued", "running", "cancelling"):
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
