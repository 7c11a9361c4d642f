"""The audit log, for administrators."""

from __future__ import annotations

from dataclasses import asdict
from datetime import datetime
from typing import Annotated, Any

from fastapi import APIRouter, Query, Request, Response
from pydantic import BaseModel, ConfigDict, Field

from api.auth import Administrator
from api.negotiation import CSV_RESPONSE, Format, table, wants_csv
from api.paging import next_link
from api.parameters import Text, moment
from api.problems import responses
from api.state import state_of
from store.audit import AuditFilter, AuditLog

router = APIRouter(prefix="/v1/audit", tags=["accounts"])

_EXAMPLE: dict[str, Any] = {
    "id": 812,
    "at": "2026-05-04T09:30:02Z",
    "account_id": "line-3",
    "key_id": "0b6f1e0c3f7d4f0f9a52f7f4f1f0a6c1",
    "action": "POST /v1/inspections",
    "target": "/v1/inspections",
    "status": 202,
    "code": "",
    "request_id": "5f0c9cf5c9a14ab1a2c2e6b0c8a4b1de",
    "times": 1,
}


class AuditItem(BaseModel):
    """A request that would change something, and what came of it."""

    model_config = ConfigDict(json_schema_extra={"example": _EXAMPLE})

    id: int
    at: datetime
    account_id: str = Field(description="empty when nobody proved who asks, and for commands on the server's machine")
    key_id: str = Field(description="empty without a key")
    action: str = Field(description="method and route, or the command")
    target: str = Field(description="path of the request, or what the command was about")
    status: int = Field(description="HTTP status of the answer; of a command 200, or 422 when it was refused")
    code: str = Field(description="code of the problem; empty when it was accepted")
    request_id: str
    times: int = Field(description="requests that the entry stands for")


class Audit(BaseModel):
    """One page of the log, newest first."""

    model_config = ConfigDict(json_schema_extra={"example": {"entries": [_EXAMPLE], "next_cursor": None}})

    entries: list[AuditItem]
    next_cursor: str | None = Field(description="`cursor` of the next page; null on the last. Also in `Link: rel=next`")


@router.get(
    "", response_model=Audit, summary="Read the audit log", responses={**CSV_RESPONSE, **responses(400, 401, 422, 503)}
)
def audit(
    request: Request,
    caller: Administrator,
    account: Annotated[Text | None, Query(max_length=64, description="only of this account")] = None,
    key: Annotated[Text | None, Query(max_length=64, description="only with the key of this id")] = None,
    since: Annotated[datetime | None, Query(description="at or after this moment (UTC if no zone)")] = None,
    until: Annotated[datetime | None, Query(description="before this moment")] = None,
    format: Format = None,
    limit: Annotated[int, Query(ge=1, le=1000, description="entries on a page")] = 100,
    cursor: Annotated[str | None, Query(max_length=500, description="of the page before")] = None,
) -> Response:
    """Every accepted and refused change, newest first. For the scope `admin`."""
    chosen = AuditFilter(account, key, moment(since, "since"), moment(until, "until"))
    page = AuditLog(state_of(request).services.db).page(chosen, limit, cursor)
    items = [AuditItem.model_validate(asdict(entry)) for entry in page.entries]
    if wants_csv(request, format):
        answer = table(request, format, list(AuditItem.model_fields), [item.model_dump(mode="json") for item in items])
    else:
        body = Audit(entries=items, next_cursor=page.cursor).model_dump_json()
        answer = Response(body, media_type="application/json", headers={"Vary": "Accept"})
    if page.cursor is not None:
        answer.headers["Link"] = next_link(request, page.cursor)
    return answer
