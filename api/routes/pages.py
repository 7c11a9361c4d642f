"""The description of the API, and the pages that show it. Every byte of them comes from this server."""

from __future__ import annotations

from functools import cache
from importlib import resources
from typing import Any

from fastapi import APIRouter, Request, Response
from fastapi.responses import HTMLResponse, JSONResponse
from jinja2 import Environment, PackageLoader, StrictUndefined

from api.problems import not_found

router = APIRouter(include_in_schema=False)

_PAGES = Environment(loader=PackageLoader("api"), autoescape=True, undefined=StrictUndefined)
_PACKAGE = "fastapi_offline"
"""Ships the released bundles of Swagger UI and Redoc; nothing else of it is used."""
_KINDS = {
    "swagger-ui-bundle.js": "text/javascript",
    "swagger-ui.css": "text/css",
    "redoc.standalone.js": "text/javascript",
}
_START = "start.js"
_START_SCRIPT = """\
SwaggerUIBundle({url: "openapi.json", dom_id: "#docs", deepLinking: true, validatorUrl: null});
"""
# Both libraries write styles into the page and show pictures from data; Redoc searches in a worker made of a blob.
# Redoc would also fetch its maker's logo from elsewhere: the policy keeps the browser from asking for it.
_POLICY = "; ".join(
    (
        "default-src 'none'",
        "script-src 'self'",
        "style-src 'self' 'unsafe-inline'",
        "img-src 'self' data:",
        "font-src data:",
        "connect-src 'self'",
        "worker-src blob:",
        "base-uri 'none'",
        "form-action 'none'",
        "frame-ancestors 'none'",
    )
)


@router.get("/openapi.json")
def document(request: Request) -> Response:
    """OpenAPI 3.1; behind a prefix it says so."""
    found: dict[str, Any] = request.app.openapi()
    prefix = request.scope.get("root_path", "").rstrip("/")
    return JSONResponse({**found, "servers": [{"url": prefix}]} if prefix else found)


@router.get("/docs")
def docs(request: Request) -> Response:
    """The description to read and to try out."""
    return _page("docs.html", request.app.title)


@router.get("/redoc")
def redoc(request: Request) -> Response:
    """The description to read."""
    return _page("redoc.html", request.app.title)


@router.get("/assets/{name}")
def asset(name: str) -> Response:
    """A file of the pages."""
    if name == _START:
        return Response(_START_SCRIPT, media_type="text/javascript")
    if name not in _KINDS:
        raise not_found("file")
    return Response(_bundled(name), media_type=_KINDS[name])


@cache
def _bundled(name: str) -> bytes:
    return (resources.files(_PACKAGE) / "static" / name).read_bytes()


def _page(template: str, title: str) -> Response:
    text = _PAGES.get_template(template).render(title=title, start=_START)
    return HTMLResponse(text, headers={"Content-Security-Policy": _POLICY, "Referrer-Policy": "no-referrer"})
