"""API keys of the caller's account, and of any account for administrators."""

from __future__ import annotations

from dataclasses import asdict
from datetime import datetime, timedelta
from http import HTTPStatus
from typing import Annotated, Any

from fastapi import APIRouter, Query, Request, Response
from pydantic import BaseModel, ConfigDict, Field

from api.auth import AnyCaller, Caller
from api.finding import is_id
from api.parameters import Text, moment
from api.problems import Refused, not_found, responses
from api.state import state_of
from store.account_models import USUAL_SCOPES, Scope
from store.keys import Keys, KeyView

router = APIRouter(prefix="/v1/keys", tags=["accounts"])

_EXAMPLE: dict[str, Any] = {
    "id": "0b6f1e0c3f7d4f0f9a52f7f4f1f0a6c1",
    "account": "line-3",
    "name": "borescope station",
    "scopes": ["read", "submit"],
    "created_at": "2026-05-04T09:30:02Z",
    "expires_at": None,
    "revoked_at": None,
    "last_used_at": None,
}


class KeyItem(BaseModel):
    """A key, without what opens anything."""

    model_config = ConfigDict(json_schema_extra={"example": _EXAMPLE})

    id: str
    account: str = Field(description="id of the account that it belongs to")
    name: str
    scopes: list[Scope]
    created_at: datetime
    expires_at: datetime | None
    revoked_at: datetime | None
    last_used_at: datetime | None = Field(description="right to a minute")


class NewKeyItem(KeyItem):
    """A key that was just made."""

    model_config = ConfigDict(json_schema_extra={"example": {**_EXAMPLE, "key": "ba_0b6f1e0c..._..."}})

    key: str = Field(description="shown this once and never again")


class KeyList(BaseModel):
    """Keys, oldest first."""

    model_config = ConfigDict(json_schema_extra={"example": {"keys": [_EXAMPLE]}})

    keys: list[KeyItem]


class NewKey(BaseModel):
    """A key to make."""

    model_config = ConfigDict(
        extra="forbid", json_schema_extra={"example": {"name": "borescope station", "scopes": ["read", "submit"]}}
    )

    name: Annotated[Text, Field(min_length=1, max_length=128)] = Field(description="who it is for")
    account: Text | None = Field(None, max_length=64, description="null = the caller's")
    scopes: list[Scope] = Field(list(USUAL_SCOPES), min_length=1, max_length=16, description="what it is good for")
    expires_at: datetime | None = Field(None, description="UTC if no zone; null = never")


class Rotation(BaseModel):
    """How to replace a key."""

    model_config = ConfigDict(extra="forbid", json_schema_extra={"example": {"keep_hours": 24}})

    keep_hours: float = Field(0.0, ge=0, le=8760, description="the old key ends after so long")


@router.get("", summary="List keys", responses=responses(401, 404, 422, 503))
def listing(
    request: Request,
    caller: AnyCaller,
    account: Annotated[Text | None, Query(max_length=64, description="of this account; empty = the caller's")] = None,
) -> KeyList:
    """Keys of the caller's account with the scope `manage`, of any with `admin`."""
    owner = _account(caller, account)
    return KeyList(keys=[KeyItem.model_validate(_values(view)) for view in _keys(request).all(owner)])


@router.post("", status_code=201, summary="Make a key", responses=responses(401, 404, 409, 422, 503))
def create(request: Request, response: Response, caller: AnyCaller, body: NewKey) -> NewKeyItem:
    """For the caller's account with the scope `manage`, for any with `admin`. None has a scope that its maker lacks."""
    owner = _account(caller, body.account)
    _require_own(caller, body.scopes)
    view, key = _keys(request).create(body.name, owner, body.scopes, moment(body.expires_at, "expires_at"))
    state_of(request).keys.outdate()
    return _shown_once(response, view, key)


@router.post("/{key_id}/rotate", status_code=201, summary="Replace a key", responses=responses(401, 404, 409, 422, 503))
def rotate(
    request: Request, response: Response, caller: AnyCaller, key_id: str, body: Rotation | None = None
) -> NewKeyItem:
    """A new key of the same account and scopes; nothing that was made with the old one is lost."""
    _require_own(caller, _find(request, caller, key_id).scopes)
    keep = timedelta(hours=(body or Rotation()).keep_hours)
    view, key = _keys(request).rotate(key_id, keep)
    state_of(request).keys.outdate()
    return _shown_once(response, view, key)


@router.delete(
    "/{key_id}", status_code=204, response_class=Response, summary="End a key", responses=responses(401, 404, 503)
)
def revoke(request: Request, caller: AnyCaller, key_id: str) -> Response:
    """It ends within a second, on every server; its sessions too. What was made with it stays with its account."""
    _find(request, caller, key_id)
    _keys(request).revoke(key_id)
    state_of(request).keys.outdate()
    return Response(status_code=HTTPStatus.NO_CONTENT)


def _account(caller: Caller, asked: str | None) -> str:
    """The account that is meant; 403 without the scope for it, 404 for somebody else's."""
    if Scope.ADMIN not in caller.scopes:
        caller.require(Scope.MANAGE)
        if asked is not None and asked != caller.owner:
            raise not_found("account")
    return asked or caller.owner


def _find(request: Request, caller: Caller, key_id: str) -> KeyView:
    own = _account(caller, None)
    if not is_id(key_id):
        raise not_found("key")
    view = _keys(request).get(key_id)
    if view.account_id != own and Scope.ADMIN not in caller.scopes:
        raise not_found("key")
    return view


def _require_own(caller: Caller, scopes: list[Scope] | tuple[Scope, ...]) -> None:
    """403 when a key would get a scope that its maker lacks; who has `admin` may give any."""
    lacking = [scope for scope in scopes if scope not in caller.scopes]
    if lacking and Scope.ADMIN not in caller.scopes:
        detail = f"your key lacks the scope '{lacking[0]}', so it can make no key that has it"
        raise Refused(HTTPStatus.FORBIDDEN, "missing_scope", detail, where="scopes")


def _keys(request: Request) -> Keys:
    return Keys(state_of(request).services.db)


def _values(view: KeyView) -> dict[str, Any]:
    values = asdict(view)
    return {**values, "account": values.pop("account_id")}


def _shown_once(response: Response, view: KeyView, key: str) -> NewKeyItem:
    response.headers["Cache-Control"] = "no-store"
    return NewKeyItem.model_validate({**_values(view), "key": key})
