"""Webhooks of the caller's account: where its events are sent to, and what came of each."""

from __future__ import annotations

from dataclasses import asdict
from datetime import datetime, timedelta
from functools import partial
from http import HTTPStatus
from typing import Annotated, Any

from fastapi import APIRouter, Query, Request, Response
from pydantic import BaseModel, ConfigDict, Field
from starlette.concurrency import run_in_threadpool

from api.auth import Manager
from api.finding import is_id
from api.paging import next_link
from api.parameters import OneOf, Text
from api.problems import Refused, not_found, responses
from api.services import Services
from api.state import state_of
from api.threads import LimitedThreads
from store.deliveries import Deliveries, DeliveryView
from store.events import EventType
from store.integration_models import DeliveryState
from store.outbound import MAX_URL, Outbound, Unreachable
from store.webhooks import Webhooks, WebhookView

router = APIRouter(prefix="/v1/webhooks", tags=["webhooks"])

_LOOK_UP_THREADS = 4
"""A name server that does not answer holds so many threads and no more."""
_ID = "3b1e0c5f7d4f0f9a52f7f4f1f0a6c17a"
_URL = "https://hooks.example.com/bladeatlas"
_EXAMPLE: dict[str, Any] = {
    "id": _ID,
    "url": _URL,
    "description": "maintenance planning",
    "types": ["inspection.succeeded", "inspection.failed"],
    "created_at": "2026-05-04T09:30:02Z",
    "old_secret_until": None,
    "disabled_at": None,
    "failures": 0,
    "paused_until": None,
}
_DELIVERY: dict[str, Any] = {
    "id": "7d0f6b1e0c3f7d4f0f9a52f7f4f1f0a6",
    "type": "inspection.succeeded",
    "number": 7,
    "inspection_id": "0b6f1e0c3f7d4f0f9a52f7f4f1f0a6c1",
    "state": "delivered",
    "attempts": 1,
    "created_at": "2026-05-04T09:41:12Z",
    "next_at": None,
    "tried_at": "2026-05-04T09:41:13Z",
    "status": 200,
    "error": "",
}
_look_up = LimitedThreads(_LOOK_UP_THREADS).run


class WebhookItem(BaseModel):
    """An address that events are sent to."""

    model_config = ConfigDict(json_schema_extra={"example": _EXAMPLE})

    id: str
    url: str
    description: str
    types: list[Annotated[str, OneOf(EventType)]] = Field(description="events that are sent; empty = all")
    created_at: datetime
    old_secret_until: datetime | None = Field(
        description="messages are signed with the secret of before the rotation too until then"
    )
    disabled_at: datetime | None = Field(description="when its receiver answered 410: nothing is sent since")
    failures: int = Field(description="how often in a row nobody answered")
    paused_until: datetime | None = Field(description="nothing is sent before, because nobody answered")


class NewWebhookItem(WebhookItem):
    """A webhook with the secret that was just made."""

    model_config = ConfigDict(json_schema_extra={"example": {**_EXAMPLE, "secret": "whsec_C2FVsBQIhrscChlQ..."}})

    secret: str = Field(description="proves who sent a message; shown this once and never again")


class WebhookList(BaseModel):
    """Webhooks, oldest first."""

    model_config = ConfigDict(json_schema_extra={"example": {"webhooks": [_EXAMPLE]}})

    webhooks: list[WebhookItem]


class NewWebhook(BaseModel):
    """A webhook to make."""

    model_config = ConfigDict(
        extra="forbid", json_schema_extra={"example": {"url": _URL, "types": ["inspection.succeeded"]}}
    )

    url: str = Field(
        min_length=1,
        max_length=MAX_URL,
        description="where messages are posted; https, and no address that is not public unless the server allows it",
    )
    description: Annotated[Text, Field(max_length=256)] = ""
    types: list[Annotated[str, OneOf(EventType)]] = Field(
        [], max_length=len(EventType), description="events that are sent; empty = all"
    )


class SecretRotation(BaseModel):
    """How to replace a secret."""

    model_config = ConfigDict(extra="forbid", json_schema_extra={"example": {"keep_hours": 24}})

    keep_hours: float = Field(24.0, ge=0, le=720, description="so long messages are signed with the old one too")


class DeliveryItem(BaseModel):
    """An event that is sent to a webhook, and what came of it."""

    model_config = ConfigDict(json_schema_extra={"example": _DELIVERY})

    id: str = Field(description="`webhook-id` of the message is `msg_` and this")
    type: str = Field(description="of the event, or `webhook.test`")
    number: int | None = Field(description="of the event, as in `/v1/events`; null for a test")
    inspection_id: str | None
    state: Annotated[str, OneOf(DeliveryState)]
    attempts: int
    created_at: datetime
    next_at: datetime | None = Field(description="when it is sent next; null when it is over")
    tried_at: datetime | None
    status: int | None = Field(description="HTTP status of the last answer; null when there was none")
    error: str = Field(description="why the last attempt failed")


class DeliveryList(BaseModel):
    """Deliveries, newest first."""

    model_config = ConfigDict(json_schema_extra={"example": {"deliveries": [_DELIVERY], "next_cursor": None}})

    deliveries: list[DeliveryItem]
    next_cursor: str | None


@router.get("", summary="List webhooks", responses=responses(401, 503))
def listing(request: Request, caller: Manager) -> WebhookList:
    """Those of the account, without their secrets."""
    return WebhookList(webhooks=[_item(view) for view in _webhooks(request).all(caller.owner)])


@router.post("", status_code=201, summary="Make a webhook", responses=responses(401, 422, 503))
async def create(request: Request, response: Response, caller: Manager, body: NewWebhook) -> NewWebhookItem:
    """Events from now on are sent to it; where its address leads is asked now, and again at every delivery."""
    services = state_of(request).services
    await _look_up(partial(_require_allowed, services, body.url))
    make = partial(
        Webhooks(services.db).create,
        *(caller.owner, body.url, body.description, body.types, services.settings.max_webhooks_per_owner),
    )
    return _shown_once(response, *await run_in_threadpool(make))


@router.get("/{webhook_id}", summary="Look at a webhook", responses=responses(401, 404, 503))
def look(request: Request, caller: Manager, webhook_id: str) -> WebhookItem:
    """How it is, without its secret."""
    return _item(_webhooks(request).get(_id(webhook_id), caller.owner))


@router.delete(
    "/{webhook_id}",
    status_code=204,
    response_class=Response,
    summary="Remove a webhook",
    responses=responses(401, 404, 503),
)
def delete(request: Request, caller: Manager, webhook_id: str) -> Response:
    """Nothing more is sent to it, and its deliveries are forgotten."""
    _webhooks(request).delete(_id(webhook_id), caller.owner)
    return Response(status_code=HTTPStatus.NO_CONTENT)


@router.post(
    "/{webhook_id}/rotate", status_code=201, summary="Replace a secret", responses=responses(401, 404, 409, 422, 503)
)
def rotate(
    request: Request, response: Response, caller: Manager, webhook_id: str, body: SecretRotation | None = None
) -> NewWebhookItem:
    """A new secret. Messages are signed with both for a while; 409 while that is so of an older one."""
    keep = timedelta(hours=(body or SecretRotation()).keep_hours)
    return _shown_once(response, *_webhooks(request).rotate(_id(webhook_id), keep, caller.owner))


@router.post("/{webhook_id}/test", status_code=202, summary="Send a test", responses=responses(401, 404, 503))
def test(request: Request, caller: Manager, webhook_id: str) -> DeliveryItem:
    """A message `webhook.test`, signed as any other."""
    return _delivery(_deliveries(request).test(_id(webhook_id), caller.owner))


@router.get("/{webhook_id}/deliveries", summary="List deliveries", responses=responses(400, 401, 404, 422, 503))
def deliveries(
    request: Request,
    response: Response,
    caller: Manager,
    webhook_id: str,
    state: Annotated[Annotated[str, OneOf(DeliveryState)] | None, Query(description="only of this state")] = None,
    limit: Annotated[int, Query(ge=1, le=200, description="deliveries on a page")] = 50,
    cursor: Annotated[str | None, Query(max_length=500, description="`next_cursor` of the page before")] = None,
) -> DeliveryList:
    """What was sent, is being sent and was given up; kept as long as its event."""
    chosen = None if state is None else DeliveryState(state)
    page = _deliveries(request).page(_id(webhook_id), caller.owner, chosen, limit, cursor)
    if page.cursor is not None:
        response.headers["Link"] = next_link(request, page.cursor)
    return DeliveryList(deliveries=[_delivery(view) for view in page.deliveries], next_cursor=page.cursor)


@router.post(
    "/{webhook_id}/deliveries/{delivery_id}/redeliver",
    status_code=202,
    summary="Send once more",
    responses=responses(401, 404, 503),
)
def redeliver(request: Request, caller: Manager, webhook_id: str, delivery_id: str) -> DeliveryItem:
    """The same message under the same id, out of turn; one that is still to be sent is sent now."""
    return _delivery(_deliveries(request).again(_id(webhook_id), _id(delivery_id), caller.owner))


def _require_allowed(services: Services, url: str) -> None:
    """422 for an address that is unknown, or may not be called."""
    try:
        Outbound(services.settings.allowed_networks()).addresses(url)
    except Unreachable as error:
        raise Refused(HTTPStatus.UNPROCESSABLE_ENTITY, error.code, error.message, where="url") from None


def _id(text: str) -> str:
    if not is_id(text):
        raise not_found("webhook or delivery")
    return text


def _webhooks(request: Request) -> Webhooks:
    return Webhooks(state_of(request).services.db)


def _deliveries(request: Request) -> Deliveries:
    return Deliveries(_webhooks(request))


def _item(view: WebhookView) -> WebhookItem:
    return WebhookItem.model_validate(asdict(view))


def _delivery(view: DeliveryView) -> DeliveryItem:
    return DeliveryItem.model_validate(asdict(view))


def _shown_once(response: Response, view: WebhookView, secret: str) -> NewWebhookItem:
    response.headers["Cache-Control"] = "no-store"
    return NewWebhookItem.model_validate({**asdict(view), "secret": secret})
