"""Webhooks: addresses that the events of an account are sent to, signed as Standard Webhooks says.

The events themselves (`store.events`) are what is to be sent: written in the transaction of each change, so none is
forgotten. A webhook remembers up to which of them it has deliveries; see `store.deliveries`. Source of headers and
signature: https://www.standardwebhooks.com, version 1.
"""

from __future__ import annotations

import base64
import hashlib
import hmac
import secrets
import uuid
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta

from sqlalchemy import delete, func, select
from sqlalchemy.orm import Session

from core.errors import BadInput
from core.names import unknown_name
from store.accounts import open_account
from store.admission import LimitReached
from store.db import Database
from store.events import EventType
from store.integration_models import EventCounter, Webhook
from store.outbound import parse_url

SECRET_PREFIX = "whsec_"
_SECRET_BYTES = 32
_LOCK = 0x5745424B
_SETTING = "max_webhooks_per_owner"


@dataclass(frozen=True)
class WebhookView:
    """A webhook as others may see it: never its secrets."""

    id: str
    owner: str
    url: str
    description: str
    types: tuple[str, ...]
    """Types of events that are sent; empty = all."""
    created_at: datetime
    old_secret_until: datetime | None
    """Until then messages are signed with the secret of before the last rotation too."""
    disabled_at: datetime | None
    failures: int
    paused_until: datetime | None


def make_secret() -> str:
    """A new secret: ``whsec_`` and 256 random bits in base64."""
    return SECRET_PREFIX + base64.b64encode(secrets.token_bytes(_SECRET_BYTES)).decode()


def signed_headers(message_id: str, timestamp: int, body: bytes, keys: Sequence[str]) -> Mapping[str, str]:
    """The headers that prove who sent a message.

    Args:
        message_id: the same however often it is sent.
        timestamp: of this attempt, in seconds since 1970.
        body: as it is sent.
        keys: secrets; with each there is one signature.
    """
    signatures = [_signature(key, f"{message_id}.{timestamp}.".encode() + body) for key in keys]
    return {
        "webhook-id": message_id,
        "webhook-timestamp": str(timestamp),
        "webhook-signature": " ".join(signatures),
    }


def _signature(secret: str, content: bytes) -> str:
    key = base64.b64decode(secret.removeprefix(SECRET_PREFIX))
    return "v1," + base64.b64encode(hmac.new(key, content, hashlib.sha256).digest()).decode()


def valid_secrets(row: Webhook, now: datetime) -> list[str]:
    """The secrets that messages are signed with, the newest first."""
    old = row.old_secret if row.old_secret_until is not None and row.old_secret_until > now else None
    return [row.secret, *([old] if old else [])]


@dataclass(frozen=True)
class Webhooks:
    """All webhooks of one database."""

    db: Database
    clock: Callable[[Session], datetime] | None = None
    """What time it is; None = as the database says."""

    def create(
        self, owner: str, url: str, description: str = "", types: Collection[str] = (), most: int = 20
    ) -> tuple[WebhookView, str]:
        """A new webhook of an account, to which events from now on are sent, and the only showing of its secret.

        Whether its address may be called is asked by `store.outbound` before, and at every delivery.

        Args:
            types: of events; none = all.
            most: webhooks that an account may have.

        Raises:
            BadInput: the account is closed or not there, the URL is none, or a type is not known.
            LimitReached: it has as many as it may have.
        """
        parse_url(url)
        chosen = parse_types(types)
        with self.db.write() as session:
            self.db.lock(session, _LOCK)
            open_account(session, owner)
            count = session.scalar(select(func.count()).where(Webhook.owner == owner)) or 0
            if count >= most:
                message = f"the account has {count} webhooks already, and {_SETTING} is {most}"
                raise LimitReached(message, code="too_many_webhooks_of_owner", where=_SETTING)
            counter = session.get(EventCounter, owner)
            row = Webhook(
                id=uuid.uuid4().hex,
                owner=owner,
                url=url,
                description=description,
                types=list(chosen),
                secret=make_secret(),
                created_at=self.now(session),
                cursor=counter.last if counter is not None else 0,
                failures=0,
            )
            session.add(row)
        return _view(row), row.secret

    def all(self, owner: str | None = None) -> list[WebhookView]:
        """Every webhook, or those of an account, oldest first."""
        query = select(Webhook).order_by(Webhook.created_at, Webhook.id)
        with self.db.read() as session:
            chosen = query if owner is None else query.where(Webhook.owner == owner)
            return [_view(row) for row in session.scalars(chosen)]

    def get(self, webhook_id: str, owner: str | None = None) -> WebhookView:
        """One webhook (of an account); `BadInput` when there is none."""
        with self.db.read() as session:
            return _view(self.row(session, webhook_id, owner))

    def rotate(self, webhook_id: str, keep: timedelta, owner: str | None = None) -> tuple[WebhookView, str]:
        """Give it a new secret, which is shown this once; messages are signed with the old one too for `keep`.

        With no time to keep, every older secret ends at once.

        Raises:
            BadInput: there is no such webhook; `conflict` while the secret before the last is still to be kept.
        """
        with self.db.write() as session:
            row, now = self.row(session, webhook_id, owner, lock=True), self.now(session)
            keeps = keep > timedelta(0)
            if keeps and len(valid_secrets(row, now)) > 1:
                message = f"an older secret is valid until {row.old_secret_until}; rotate after that, or keep none"
                raise BadInput(message, code="conflict", where="keep_hours")
            row.old_secret, row.old_secret_until = (row.secret, now + keep) if keeps else (None, None)
            row.secret = make_secret()
        return _view(row), row.secret

    def delete(self, webhook_id: str, owner: str | None = None) -> None:
        """Remove a webhook and its deliveries; `BadInput` when there is none."""
        with self.db.write() as session:
            session.delete(self.row(session, webhook_id, owner, lock=True))

    def now(self, session: Session) -> datetime:
        """The time that everything about webhooks is measured with."""
        return self.db.now(session) if self.clock is None else self.clock(session)

    def row(self, session: Session, webhook_id: str, owner: str | None = None, lock: bool = False) -> Webhook:
        """The row of a webhook (of an account), held to the end of the transaction with `lock`.

        Raises:
            BadInput: there is none.
        """
        row = session.get(Webhook, webhook_id, with_for_update=lock or None)
        if row is None or owner not in (None, row.owner):
            raise BadInput(f"there is no webhook '{webhook_id}'", code="unknown_webhook", where="webhook")
        return row


def parse_types(names: Collection[str]) -> tuple[EventType, ...]:
    """Types of events in the order of their declaration; `BadInput` for a name that is none."""
    known = [kind.value for kind in EventType]
    for name in names:
        if name not in known:
            raise BadInput(unknown_name("event", name, known), where="types")
    return tuple(kind for kind in EventType if kind in names)


def delete_webhooks(session: Session, owner: str) -> None:
    """Remove all webhooks of an account."""
    session.execute(delete(Webhook).where(Webhook.owner == owner))


def _view(row: Webhook) -> WebhookView:
    return WebhookView(
        id=row.id,
        owner=row.owner,
        url=row.url,
        description=row.description,
        types=tuple(row.types),
        created_at=row.created_at,
        old_secret_until=row.old_secret_until,
        disabled_at=row.disabled_at,
        failures=row.failures,
        paused_until=row.paused_until,
    )
