"""Signed links to files and frames, for pages that can send no key with a picture."""

from __future__ import annotations

import re
from datetime import UTC, datetime, timedelta
from http import HTTPStatus
from typing import Any
from urllib.parse import quote

from fastapi import APIRouter, Request, Response
from pydantic import BaseModel, ConfigDict, Field

from api.auth import AnyCaller, Reader
from api.finding import find_inspection
from api.problems import Refused, responses
from api.routes.accounts import require_of_account
from api.state import state_of
from store.account_models import Scope
from store.links import LONGEST, Links

router = APIRouter(tags=["results"])

_CAN_BE_LINKED = re.compile(r"artifacts/.+|frames/\d{1,10}\.jpg", re.DOTALL)
_EXAMPLE: dict[str, Any] = {
    "url": "/v1/inspections/0b6f1e0c3f7d4f0f9a52f7f4f1f0a6c1/artifacts/gallery/dent.jpg"
    "?expires=1777887002&signature=9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822cd15d6c15b0f00a08",
    "expires_at": "2026-05-04T09:30:02Z",
}


class NewLink(BaseModel):
    """What shall be read, and for how long."""

    model_config = ConfigDict(
        extra="forbid", json_schema_extra={"example": {"path": "artifacts/gallery/dent.jpg", "seconds": 3600}}
    )

    path: str = Field(
        max_length=600, description="below the inspection: `artifacts/` and the name of a file, or `frames/INDEX.jpg`"
    )
    seconds: int = Field(3600, ge=1, le=int(LONGEST.total_seconds()), description="how long the link is good")


class Link(BaseModel):
    """An address that works without a key, for `GET` and `HEAD`."""

    model_config = ConfigDict(json_schema_extra={"example": _EXAMPLE})

    url: str = Field(description="path and query; of a frame `&boxes=true` may be added")
    expires_at: datetime


@router.post(
    "/v1/inspections/{inspection_id}/links",
    status_code=201,
    summary="Make a signed link",
    responses=responses(401, 404, 410, 422, 503),
)
def create(request: Request, caller: Reader, inspection_id: str, body: NewLink) -> Link:
    """An address of a file or a frame that works without a key, as in `<img src>`, until its time is over.

    Whoever has it can read that one thing. `DELETE /v1/accounts/ID/links` ends all links of an account.
    """
    services = state_of(request).services
    find_inspection(services, inspection_id, caller.owner)
    if not _CAN_BE_LINKED.fullmatch(body.path) or "\0" in body.path:
        detail = "path is `artifacts/` and the name of a file, or `frames/INDEX.jpg`"
        raise Refused(HTTPStatus.UNPROCESSABLE_ENTITY, "bad_request", detail, where="path")
    lifetime = timedelta(seconds=body.seconds)
    signed = Links(services.db).sign(caller.owner, inspection_id, body.path, lifetime)
    query = f"expires={signed.expires}&signature={signed.signature}"
    url = services.link(f"/v1/inspections/{inspection_id}/{quote(body.path)}?{query}")
    return Link(url=url, expires_at=datetime.fromtimestamp(signed.expires, UTC))


@router.delete(
    "/v1/accounts/{account_id}/links",
    status_code=204,
    response_class=Response,
    tags=["accounts"],
    summary="End all signed links of an account",
    responses=responses(401, 404, 409, 503),
)
def revoke(request: Request, caller: AnyCaller, account_id: str) -> Response:
    """Every link that was made so far is good no longer; new ones may be made. As for deleting the account."""
    require_of_account(caller, account_id, Scope.MANAGE)
    Links(state_of(request).services.db).revoke(account_id)
    return Response(status_code=HTTPStatus.NO_CONTENT)
