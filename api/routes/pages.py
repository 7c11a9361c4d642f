"""The service's pages: inspections of the account, and the description of the API; all bytes come from this server."""

from __future__ import annotations

from functools import cache
from importlib import resources
from importlib.resources.abc import Traversable
from typing import Any

from fastapi import APIRouter, Request, Response
from fastapi.responses import HTMLResponse, JSONResponse
from jinja2 import Environment, PackageLoader, StrictUndefined

from api.prefix import prefix_of
from api.problems import not_found
from core.metadata import KNOWN_METADATA
from core.settings import PRESET_NAMES

router = APIRouter(include_in_schema=False)

_PAGES = Environment(loader=PackageLoader("api"), autoescape=True, undefined=StrictUndefined)
_PACKAGE = "fastapi_offline"
"""Ships the released bundles of Swagger UI and Redoc; nothing else of it is used."""
_KINDS = {
    "swagger-ui-bundle.js": "text/javascript",
    "swagger-ui.css": "text/css",
    "redoc.standalone.js": "text/javascript",
}
_OWN = {"inspections.js": "text/javascript", "inspections.css": "text/css"}
"""Lie beside the templates."""
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


_INSPECTIONS_POLICY = "; ".join(
    (
        "default-src 'none'",
        "script-src 'self'",
        "style-src 'self'",
        "img-src 'self' data:",
        "media-src blob:",  # the length of a video is read before it is sent
        "connect-src 'self'",
        "base-uri 'none'",
        "form-action 'none'",
        "frame-ancestors 'none'",
    )
)


@router.get("/")
def inspections(request: Request) -> Response:
    """Inspections of the account, and the form that makes one; what it shows it asks for as any client does."""
    return _page("inspections.html", _INSPECTIONS_POLICY, presets=PRESET_NAMES, metadata=KNOWN_METADATA)


@router.get("/openapi.json")
def document(request: Request) -> Response:
    """OpenAPI 3.1; behind a prefix it says so."""
    found: dict[str, Any] = request.app.openapi()
    prefix = prefix_of(request.scope)
    return JSONResponse({**found, "servers": [{"url": prefix}]} if prefix else found)


@router.get("/docs")
def docs(request: Request) -> Response:
    """The description to read and to try out."""
    return _page("docs.html", _POLICY, title=request.app.title, start=_START)


@router.get("/redoc")
def redoc(request: Request) -> Response:
    """The description to read."""
    return _page("redoc.html", _POLICY, title=request.app.title)


@router.get("/assets/{name}")
def asset(name: str) -> Response:
    """A file of the pages."""
    if name == _START:
        return Response(_START_SCRIPT, media_type="text/javascript")
    if name in _OWN:
        return Response(_templates().joinpath(name).read_bytes(), media_type=_OWN[name])
    if name not in _KINDS:
        raise not_found("file")
    return Response(_bundled(name), media_type=_KINDS[name])


@cache
def _bundled(name: str) -> bytes:
    return (resources.files(_PACKAGE) / "static" / name).read_bytes()


def _templates() -> Traversable:
    return resources.files("api") / "templates"


def _page(template: str, policy: str, **values: Any) -> Response:
    text = _PAGES.get_template(template).render(**{"title": "Inspections", **values})
    return HTMLResponse(text, headers={"Content-Security-Policy": policy, "Referrer-Policy": "no-referrer"})
