"""The page of an inspection: findings, surface, frames and timeline in the browser, served as it was published."""

from __future__ import annotations

from http import HTTPStatus
from typing import Annotated, Any

from fastapi import APIRouter, Header, Path, Request, Response
from fastapi.responses import StreamingResponse

from api.auth import Reader
from api.negotiation import Span, accepts_gzip, matches
from api.problems import not_found, responses
from api.routes.artifacts import find_file, stream_bytes
from api.state import state_of
from core.outputs import VIEWER, path_of_model
from core.viewer.policy import POLICY
from store.files import ArtifactStore
from store.publishing import ArtifactView, compressed_key

router = APIRouter(prefix="/v1/inspections/{inspection_id}", tags=["results"])

_ANSWERS: dict[int | str, dict[str, Any]] = {
    200: {"description": "the file", "content": {"text/html": {}, "application/octet-stream": {}}},
    304: {"description": "it is the file that `If-None-Match` names"},
    **responses(401, 404, 409, 410, 503),
}
_Path = Annotated[str, Path(description="`index.html` is the page", examples=["index.html"])]
_Known = Annotated[str | None, Header(description="an `ETag` that is at hand")]
_Encoding = Annotated[str | None, Header(description="`gzip`: large files come compressed")]


@router.get(
    "/viewer/{path:path}", summary="The page of the result", response_class=StreamingResponse, responses=_ANSWERS
)
@router.head("/viewer/{path:path}", include_in_schema=False)
def page(
    request: Request,
    caller: Reader,
    inspection_id: str,
    path: _Path,
    if_none_match: _Known = None,
    accept_encoding: _Encoding = None,
) -> Response:
    """A file of the page. Open `viewer/index.html` in a browser; it loads the others from beside it.

    Every answer has a content security policy: the page runs its own scripts, asks nobody else and is in no frame.
    """
    return _file(request, caller.owner, inspection_id, f"{VIEWER}/{path}", if_none_match, accept_encoding)


@router.get(
    "/models/{model}/viewer/{path:path}",
    summary="The page of a further model",
    response_class=StreamingResponse,
    responses={**_ANSWERS, **responses(422)},
)
@router.head("/models/{model}/viewer/{path:path}", include_in_schema=False)
def page_of_model(
    request: Request,
    caller: Reader,
    inspection_id: str,
    model: Annotated[int, Path(ge=1, le=10**6, description="number of the model")],
    path: _Path,
    if_none_match: _Known = None,
    accept_encoding: _Encoding = None,
) -> Response:
    """A file of the page of a further model; its pictures are those of the first model's page."""
    name = path_of_model(model, f"{VIEWER}/{path}")
    return _file(request, caller.owner, inspection_id, name, if_none_match, accept_encoding)


def _file(
    request: Request, owner: str, inspection_id: str, path: str, known: str | None, encoding: str | None
) -> Response:
    services = state_of(request).services
    view = find_file(services, inspection_id, owner, path)
    store = services.artifacts
    key, etag, headers = view.key, f'"{view.sha256}"', _headers()
    packed = _packed(store, view) if accepts_gzip(encoding) else None
    if packed is not None:
        # Another form of the file: whoever has one of them must not take it for the other.
        key, etag = packed, f'"{view.sha256}-gzip"'
        headers["Content-Encoding"] = "gzip"
    headers["ETag"] = etag
    if matches(known, etag):
        return Response(status_code=HTTPStatus.NOT_MODIFIED, headers=headers)
    if packed is None and not store.exists(key):  # a packed form was looked for above
        raise not_found("file")
    size = store.size(key) if packed is not None else view.size
    headers["Content-Length"] = str(size)
    if request.method == "HEAD":
        return Response(headers=headers, media_type=view.media_type)
    return StreamingResponse(stream_bytes(store, key, Span(0, size)), headers=headers, media_type=view.media_type)


def _headers() -> dict[str, str]:
    return {
        "Content-Security-Policy": POLICY,
        "Cross-Origin-Resource-Policy": "same-origin",
        "Referrer-Policy": "no-referrer",
        "Vary": "Accept-Encoding",
    }


def _packed(store: ArtifactStore, view: ArtifactView) -> str | None:
    """Where the gzipped form of a file lies; None when there is none, as of results before there were pages."""
    key = compressed_key(view.key)
    return key if key is not None and store.exists(key) else None
