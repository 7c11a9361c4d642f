"""Accounts: for administrators all of them, for a key its own."""

from __future__ import annotations

from dataclasses import asdict
from datetime import datetime
from http import HTTPStatus
from typing import Any

from fastapi import APIRouter, Request, Response
from pydantic import BaseModel, ConfigDict, Field

from api.auth import Administrator, AnyCaller, Caller
from api.parameters import Text
from api.problems import not_found, responses
from api.state import state_of
from store.account_data import AccountData
from store.account_models import Scope
from store.accounts import HIGHEST_PRIORITY, Accounts, AccountView

router = APIRouter(prefix="/v1/accounts", tags=["accounts"])

_USUAL: dict[str, Any] = {
    "retention_days": None,
    "max_active": None,
    "max_open_uploads": None,
    "max_promised_bytes": None,
    "max_kept_bytes": None,
    "max_requests_per_minute": None,
}
_EXAMPLE: dict[str, Any] = {
    "id": "line-3",
    "name": "Overhaul, line 3",
    "created_at": "2026-05-04T09:30:02Z",
    "closed_at": None,
    "max_priority": 5,
    **_USUAL,
}


class AccountChange(BaseModel):
    """What can be set of an account; fields that are not given stay as they are, null is as for every account."""

    model_config = ConfigDict(extra="forbid", json_schema_extra={"example": {"max_priority": 5}})

    name: Text | None = Field(None, description="free text")
    retention_days: float | None = Field(
        None,
        ge=0,
        le=36_525,
        allow_inf_nan=False,
        description="an inspection is removed so long after its publication; 0 = never",
    )
    max_priority: int | None = Field(
        None, ge=0, le=HIGHEST_PRIORITY, description="highest priority of its inspections; null = 9"
    )
    max_active: int | None = Field(None, ge=1, le=1 << 30, description="inspections queued or running at once")
    max_open_uploads: int | None = Field(None, ge=1, le=1 << 30, description="unfinished uploads and forms at once")
    max_promised_bytes: int | None = Field(
        None, ge=0, le=1 << 60, description="bytes that open uploads may still send; 0 = no limit"
    )
    max_kept_bytes: int | None = Field(
        None, ge=0, le=1 << 60, description="bytes of uploads, inputs and published files; 0 = no limit"
    )
    max_requests_per_minute: int | None = Field(None, ge=0, le=1 << 30, description="0 = no limit")


class NewAccount(AccountChange):
    """An account to make."""

    model_config = ConfigDict(json_schema_extra={"example": {"id": "line-3", "max_priority": 5}})

    id: str = Field(pattern=r"^[a-z0-9][a-z0-9-]{0,63}$", description="never given to another account again")


class AccountItem(BaseModel):
    """An account and what is set of it; null is as for every account, see `/v1/limits`."""

    model_config = ConfigDict(json_schema_extra={"example": _EXAMPLE})

    id: str
    name: str
    created_at: datetime
    closed_at: datetime | None = Field(description="when all that it had was deleted")
    retention_days: float | None
    max_priority: int
    max_active: int | None
    max_open_uploads: int | None
    max_promised_bytes: int | None
    max_kept_bytes: int | None
    max_requests_per_minute: int | None


class AccountList(BaseModel):
    """All accounts, oldest first."""

    model_config = ConfigDict(json_schema_extra={"example": {"accounts": [_EXAMPLE]}})

    accounts: list[AccountItem]


@router.get("", summary="List accounts", responses=responses(401, 503))
def listing(request: Request, caller: Administrator) -> AccountList:
    """Every account, those that were closed included. For the scope `admin`."""
    return AccountList(accounts=[_item(view) for view in _accounts(request).all()])


@router.post("", status_code=201, summary="Make an account", responses=responses(401, 409, 422, 503))
def create(request: Request, caller: Administrator, body: NewAccount) -> AccountItem:
    """For the scope `admin`. A key of it is made with `POST /v1/keys`."""
    return _item(_accounts(request).create(body.id, body.name or "", **_limits(body)))


@router.get("/{account_id}", summary="Look at an account", responses=responses(401, 404, 503))
def look(request: Request, caller: AnyCaller, account_id: str) -> AccountItem:
    """The caller's own with the scope `read`, any with `admin`."""
    require_of_account(caller, account_id, Scope.READ)
    return _item(_accounts(request).get(account_id))


@router.patch("/{account_id}", summary="Change an account", responses=responses(401, 404, 409, 422, 503))
def change(request: Request, caller: Administrator, account_id: str, body: AccountChange) -> AccountItem:
    """Set its name and limits. For the scope `admin`."""
    return _item(_accounts(request).change(account_id, body.name, **_limits(body)))


@router.delete(
    "/{account_id}",
    status_code=204,
    response_class=Response,
    summary="Delete all that an account has, and close it",
    responses=responses(401, 404, 409, 503),
)
def delete(request: Request, caller: AnyCaller, account_id: str) -> Response:
    """Stop and delete its inspections, remove its uploads and revoke its keys, the one that is used for this included.

    The caller's own account with the scope `manage`, any with `admin`. The account `default` stays open.
    """
    require_of_account(caller, account_id, Scope.MANAGE)
    state = state_of(request)
    for inspection_id in AccountData(state.services.db, account_id).delete(state.services.plan):
        state.watcher.invalidate(inspection_id)
        state.services.wake(inspection_id)
    state.keys.outdate()
    return Response(status_code=HTTPStatus.NO_CONTENT)


def require_of_account(caller: Caller, account_id: str, scope: Scope) -> None:
    """404 for somebody else's account, as if there were none; 403 without the scope for the own one."""
    if Scope.ADMIN in caller.scopes:
        return
    if account_id != caller.owner:
        raise not_found("account")
    caller.require(scope)


def _accounts(request: Request) -> Accounts:
    return Accounts(state_of(request).services.db)


def _limits(body: AccountChange) -> dict[str, float | None]:
    return {name: getattr(body, name) for name in body.model_fields_set - {"id", "name"}}


def _item(view: AccountView) -> AccountItem:
    return AccountItem.model_validate(asdict(view))
