"""The report of an inspection for people, made when it is asked for from the files that are published."""

from __future__ import annotations

from http import HTTPStatus
from pathlib import Path
from typing import Annotated, Any, Literal

from fastapi import APIRouter, Header, Query, Request, Response

from api.auth import Reader
from api.finding import find_inspection
from api.negotiation import matches
from api.parameters import Text
from api.problems import FieldError, responses
from api.routes.tables import not_ready
from api.services import Services
from api.state import state_of
from api.submit import invalid
from api.threads import LimitedThreads
from core.fingerprint import digest_of, digest_of_file
from core.inspection_report.document import Shown, is_day, report_document
from core.inspection_report.forms import MEDIA_TYPES, POLICY, Form, written
from core.inspection_report.pictures import files_of
from core.inspection_report.source import ReadFile, read_source
from core.outputs import QUALITY, SUMMARY
from core.versions import program_version
from store.publishing import ArtifactRows, ArtifactView
from store.reviews import Reviews

router = APIRouter(prefix="/v1/inspections/{inspection_id}", tags=["results"])

_SETTING = LimitedThreads(2)
"""Setting takes a core for half a second and more: many who ask for reports leave time to the rest."""
_ANSWERS: dict[int | str, dict[str, Any]] = {
    200: {"description": "the report", "content": {kind.split(";")[0]: {} for kind in MEDIA_TYPES.values()}},
    304: {"description": "it is the report that `If-None-Match` names"},
    **responses(401, 404, 409, 410, 422, 503),
}


@router.get("/report.{form}", summary="The report", response_class=Response, responses=_ANSWERS)
async def report(
    request: Request,
    caller: Reader,
    inspection_id: str,
    form: Form,
    reviewer: Annotated[Text | None, Query(description="who signs")] = None,
    date: Annotated[str | None, Query(description="day of the report, `YYYY-MM-DD`")] = None,
    units: Annotated[Literal["mm", "in"], Query(description="of the lengths in texts where a scale is known")] = "mm",
    if_none_match: Annotated[str | None, Header(description="an `ETag` that is at hand")] = None,
) -> Response:
    """Findings with pictures, places and sizes, what was not seen, and how far the result can be trusted.

    The same published files give the same bytes. The PDF is tagged (PDF/UA-1); the day of the report, that of the last
    word of a review or on which the inspection ended, makes it a PDF/A-2a too.
    """
    if date is not None and not is_day(date):
        raise invalid([FieldError(pointer="/date", detail="no day of the form YYYY-MM-DD")])
    services = state_of(request).services
    return await _SETTING.run(
        lambda: _answer(services, inspection_id, caller.owner, form, reviewer, date, units == "in", if_none_match)
    )


def _answer(
    services: Services,
    inspection_id: str,
    owner: str,
    form: Form,
    reviewer: str | None,
    date: str | None,
    inches: bool,
    known: str | None,
) -> Response:
    row = find_inspection(services, inspection_id, owner)
    views = {view.path: view for view in ArtifactRows(services.db).all(inspection_id)}
    if SUMMARY not in views or QUALITY not in views:
        raise not_ready(row, "report")
    ended = None if row.ended_at is None else row.ended_at.date().isoformat()
    source = read_source(_files(services, views))
    reviewed = Reviews(services.db).reviewed(inspection_id)
    document = report_document(source, reviewed, reviewer, date, ended, Shown(inches=inches))
    style = services.settings.report_style
    pictures = {path: views[path].sha256 for path in files_of(document["findings"]) if path in views}
    made_of = {"form": form, "document": document, "pictures": pictures, "style": _style_digests(style)}
    etag = f'"{digest_of({**made_of, "by": program_version()})}"'
    headers = {"ETag": etag, "X-Content-Type-Options": "nosniff"}
    if matches(known, etag):
        return Response(status_code=HTTPStatus.NOT_MODIFIED, headers=headers)
    headers["Content-Disposition"] = f'inline; filename="report.{form}"'
    if form == Form.HTML:
        headers["Content-Security-Policy"] = POLICY
    return Response(written(form, document, source, style), headers=headers, media_type=MEDIA_TYPES[form])


def _style_digests(style: Path | None) -> dict[str, str]:
    files = sorted(path for path in style.rglob("*") if path.is_file()) if style is not None else []
    return {str(path.relative_to(style)): digest_of_file(path) for path in files if style is not None}


def _files(services: Services, views: dict[str, ArtifactView]) -> ReadFile:
    """Reads published files of an inspection from the artifact store, by their exact names."""

    def read(path: str) -> bytes | None:
        view = views.get(path)
        if view is None or not services.artifacts.exists(view.key):
            return None
        with services.artifacts.open(view.key) as stream:
            return bytes(stream.read())

    return read
