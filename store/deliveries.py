"""Deliveries: which event goes to which webhook next, at least once, and in order for each inspection.

Who sends holds a lease on the webhook, so that two senders do not send the same twice; a sender that dies loses it by
its time, and what it was sending is sent again. An event waits for those before it of the same inspection until they
were delivered or given up. All that is known lies in the database, so a crash at any moment costs a repetition at most.
"""

from __future__ import annotations

import json
import uuid
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta
from http import HTTPStatus

from sqlalchemy import ColumnElement, and_, exists, func, literal, or_, select, tuple_, update
from sqlalchemy.orm import Session, aliased

from core.errors import BadInput
from store.columns import UtcDateTime
from store.cursors import bad_cursor, decode_cursor, encode_cursor
from store.integration_models import DeliveryState, EventCounter, InspectionEvent, Webhook, WebhookDelivery
from store.webhooks import Webhooks, valid_secrets

TEST = "webhook.test"
"""Type of a message that tells of nothing."""
BACK_OFF_S = (5, 30, 120, 300, 900, 1800, 3600, 7200, 14_400)
"""Seconds until the next attempt after the first failure, the second and so on; the last holds for all that follow."""
_LONGEST_PAUSE_S = 3600
"""Nobody waits longer than this for a receiver that was away."""
_PAGE = 500
"""Events that are looked at in one transaction."""
_AWAY = (
    HTTPStatus.TOO_MANY_REQUESTS,
    HTTPStatus.BAD_GATEWAY,
    HTTPStatus.SERVICE_UNAVAILABLE,
    HTTPStatus.GATEWAY_TIMEOUT,
)
_LIST = "deliveries"


@dataclass(frozen=True)
class Turn:
    """A lease on a webhook: who holds it sends what is due."""

    token: str
    webhook_id: str
    url: str


@dataclass(frozen=True)
class Message:
    """What is sent next."""

    delivery_id: str
    body: bytes
    secrets: Sequence[str]
    """To sign it with."""

    @property
    def id(self) -> str:
        """The same however often it is sent, so that a receiver can tell that it had it."""
        return f"msg_{self.delivery_id}"


@dataclass(frozen=True)
class Outcome:
    """What came of an attempt."""

    status: int | None
    """Of HTTP; None when nobody answered."""
    error: str = ""

    @property
    def delivered(self) -> bool:
        """True when the receiver took it."""
        return self.status is not None and 200 <= self.status < 300

    @property
    def away(self) -> bool:
        """True when the next message would not get through either."""
        return self.status is None or self.status in _AWAY


@dataclass(frozen=True)
class DeliveryView:
    """A delivery as others may see it."""

    id: str
    type: str
    number: int | None
    inspection_id: str | None
    state: DeliveryState
    attempts: int
    created_at: datetime
    next_at: datetime | None
    tried_at: datetime | None
    status: int | None
    error: str


@dataclass(frozen=True)
class DeliveryPage:
    """Some deliveries and how to get the next."""

    deliveries: Sequence[DeliveryView]
    cursor: str | None


@dataclass(frozen=True)
class Deliveries:
    """All deliveries of one database."""

    webhooks: Webhooks
    turn_s: float = 60.0
    """A lease ends so long after its last sign of life, in seconds."""
    keep_s: float = 86_400.0
    """What was not delivered after so long is given up, in seconds."""

    def begin_turn(self) -> Turn | None:
        """Lease the webhook that waited longest of those with something to send; None when there is none."""
        with self.webhooks.db.read() as session:  # most often there is nothing: no reason to keep writers waiting
            if session.scalar(select(Webhook.id).where(*_waiting(self.webhooks.now(session))).limit(1)) is None:
                return None
        with self.webhooks.db.write() as session:
            now = self.webhooks.now(session)
            longest = select(Webhook).where(*_waiting(now)).order_by(Webhook.turn_at.asc().nulls_first(), Webhook.id)
            row = session.scalars(longest.limit(1).with_for_update(skip_locked=True)).one_or_none()
            if row is None:
                return None
            row.turn, row.turn_at = uuid.uuid4().hex, now
            row.turn_ends_at = now + timedelta(seconds=self.turn_s)
            _add_deliveries(session, row, now)
            return Turn(row.turn, row.id, row.url)

    def end_turn(self, turn: Turn) -> None:
        """Give a lease back."""
        with self.webhooks.db.write() as session:
            mine = (Webhook.id == turn.webhook_id, Webhook.turn == turn.token)
            session.execute(update(Webhook).where(*mine).values(turn=None, turn_ends_at=None))

    def next(self, turn: Turn) -> Message | None:
        """What to send now; None when nothing is due, or the lease was lost."""
        with self.webhooks.db.snapshot() as session:
            now, row = self.webhooks.now(session), session.get(Webhook, turn.webhook_id)
            if row is None or row.turn != turn.token or (row.paused_until is not None and row.paused_until > now):
                return None
            due = select(WebhookDelivery).where(WebhookDelivery.webhook_id == row.id, *_due(now))
            delivery = session.scalars(due.order_by(WebhookDelivery.next_at, WebhookDelivery.number).limit(1)).first()
            if delivery is None:
                return None
            event = None
            if delivery.number is not None:
                event = session.get_one(InspectionEvent, (delivery.owner, delivery.number))
            return Message(delivery.id, _body(delivery, event), valid_secrets(row, now))

    def note(self, turn: Turn, message: Message, outcome: Outcome) -> bool:
        """Write down what came of an attempt, and when the next one is; False when the lease was lost."""
        with self.webhooks.db.write() as session:
            now = self.webhooks.now(session)
            webhook = session.get(Webhook, turn.webhook_id, with_for_update=True)
            delivery = session.get(WebhookDelivery, message.delivery_id)
            if webhook is None or webhook.turn != turn.token or delivery is None:
                return False
            webhook.turn_ends_at = now + timedelta(seconds=self.turn_s)
            delivery.attempts += 1
            delivery.tried_at, delivery.status, delivery.error = now, outcome.status, outcome.error[:256]
            self._settle(delivery, outcome, now)
            session.flush()
            _note_health(session, webhook, outcome, now)
        return True

    def _settle(self, delivery: WebhookDelivery, outcome: Outcome, now: datetime) -> None:
        given_up = now >= delivery.due_at + timedelta(seconds=self.keep_s) or outcome.status == HTTPStatus.GONE
        if outcome.delivered or given_up:
            delivery.state = DeliveryState.DELIVERED if outcome.delivered else DeliveryState.FAILED
            delivery.next_at = None
        else:
            delivery.next_at = now + _pause(delivery.attempts)

    def page(
        self, webhook_id: str, owner: str, state: DeliveryState | None, limit: int, cursor: str | None = None
    ) -> DeliveryPage:
        """Deliveries to a webhook, newest first; `BadInput` when there is no such webhook, or for a foreign cursor."""
        self.webhooks.get(webhook_id, owner)
        place = (WebhookDelivery.created_at, func.coalesce(WebhookDelivery.number, 0), WebhookDelivery.id)
        query = select(WebhookDelivery).where(WebhookDelivery.webhook_id == webhook_id)
        if state is not None:
            query = query.where(WebhookDelivery.state == state)
        with self.webhooks.db.read() as session:
            if cursor is not None:
                last = session.get(WebhookDelivery, decode_cursor(_LIST, (str,), cursor)[0])
                if last is None or last.webhook_id != webhook_id:
                    raise bad_cursor()
                at = literal(last.created_at, UtcDateTime())
                behind = tuple_(at, literal(last.number or 0), literal(last.id))
                query = query.where(tuple_(*place) < behind)
            found = query.order_by(*(part.desc() for part in place)).limit(limit + 1)
            rows = [_view(row) for row in session.scalars(found)]
        more = len(rows) > limit
        return DeliveryPage(rows[:limit], encode_cursor(_LIST, (rows[limit - 1].id,)) if more else None)

    def test(self, webhook_id: str, owner: str | None = None) -> DeliveryView:
        """Send a message that tells of nothing; `BadInput` when there is no such webhook."""
        with self.webhooks.db.write() as session:
            webhook = self.webhooks.row(session, webhook_id, owner, lock=True)
            row = _delivery(webhook.id, webhook.owner, TEST, self.webhooks.now(session))
            session.add(row)
        return _view(row)

    def again(self, webhook_id: str, delivery_id: str, owner: str | None = None) -> DeliveryView:
        """Send an event once more, out of turn and under the same id; `BadInput` when there is no such delivery."""
        with self.webhooks.db.write() as session:
            self.webhooks.row(session, webhook_id, owner, lock=True)
            row = session.get(WebhookDelivery, delivery_id)
            if row is None or row.webhook_id != webhook_id:
                raise BadInput(f"there is no delivery '{delivery_id}'", code="unknown_delivery", where="delivery")
            if row.state != DeliveryState.PENDING:
                now = self.webhooks.now(session)
                row.state, row.again, row.attempts = DeliveryState.PENDING, True, 0
                row.due_at = row.next_at = now
            else:  # it keeps its place among those of its inspection
                row.next_at = self.webhooks.now(session)
        return _view(row)


def _waiting(now: datetime) -> tuple[ColumnElement[bool], ...]:
    """Webhooks that nobody sends to and to which something is to be sent."""
    counted = and_(EventCounter.owner == Webhook.owner, EventCounter.last > Webhook.cursor)
    due = and_(WebhookDelivery.webhook_id == Webhook.id, *_due(now))
    return (
        Webhook.disabled_at.is_(None),
        or_(Webhook.turn_ends_at.is_(None), Webhook.turn_ends_at <= now),
        or_(Webhook.paused_until.is_(None), Webhook.paused_until <= now),
        or_(exists().where(counted), exists().where(due)),
    )


def _due(now: datetime) -> tuple[ColumnElement[bool], ...]:
    """Deliveries whose time has come and that need not wait for an earlier one of their inspection."""
    earlier = aliased(WebhookDelivery)
    before = exists().where(
        earlier.webhook_id == WebhookDelivery.webhook_id,
        earlier.inspection_id == WebhookDelivery.inspection_id,
        earlier.number < WebhookDelivery.number,
        earlier.state == DeliveryState.PENDING,
        earlier.again.is_(False),
    )
    free = or_(WebhookDelivery.again.is_(True), ~before)
    return (WebhookDelivery.state == DeliveryState.PENDING, WebhookDelivery.next_at <= now, free)


def _add_deliveries(session: Session, webhook: Webhook, now: datetime) -> None:
    """Take up the events behind the webhook's cursor, those that it wants as deliveries."""
    behind = (InspectionEvent.owner == webhook.owner, InspectionEvent.number > webhook.cursor)
    events = session.scalars(select(InspectionEvent).where(*behind).order_by(InspectionEvent.number).limit(_PAGE)).all()
    for event in events:
        if not webhook.types or event.type in webhook.types:
            row = _delivery(webhook.id, webhook.owner, event.type, now)
            row.number, row.inspection_id = event.number, event.inspection_id
            session.add(row)
    if events:
        webhook.cursor = events[-1].number
        return
    # Events whose time was over before anybody looked.
    counter = session.get(EventCounter, webhook.owner)
    webhook.cursor = counter.last if counter is not None else webhook.cursor


def _delivery(webhook_id: str, owner: str, kind: str, now: datetime) -> WebhookDelivery:
    return WebhookDelivery(
        id=uuid.uuid4().hex,
        webhook_id=webhook_id,
        owner=owner,
        type=kind,
        state=DeliveryState.PENDING,
        again=False,
        attempts=0,
        created_at=now,
        due_at=now,
        next_at=now,
        error="",
    )


def _note_health(session: Session, webhook: Webhook, outcome: Outcome, now: datetime) -> None:
    """Pause a webhook that does not answer; once it does, what failed in the pause is due at once."""
    if outcome.status == HTTPStatus.GONE:
        webhook.disabled_at = now
        _give_up(session, webhook.id)
    elif outcome.away:
        webhook.failures += 1
        pause = _pause(webhook.failures)
        webhook.paused_until = now + min(pause, timedelta(seconds=_LONGEST_PAUSE_S))
    elif webhook.failures:
        webhook.failures, webhook.paused_until = 0, None
        waiting = (WebhookDelivery.webhook_id == webhook.id, WebhookDelivery.state == DeliveryState.PENDING)
        unanswered = or_(WebhookDelivery.status.is_(None), WebhookDelivery.status.in_(_AWAY))
        session.execute(update(WebhookDelivery).where(*waiting, unanswered).values(next_at=now))


def _give_up(session: Session, webhook_id: str) -> None:
    waiting = (WebhookDelivery.webhook_id == webhook_id, WebhookDelivery.state == DeliveryState.PENDING)
    values = {"state": DeliveryState.FAILED, "next_at": None, "error": "the receiver said that it is gone"}
    session.execute(update(WebhookDelivery).where(*waiting).values(**values))


def _pause(failures: int) -> timedelta:
    return timedelta(seconds=BACK_OFF_S[min(failures, len(BACK_OFF_S)) - 1])


def _body(delivery: WebhookDelivery, event: InspectionEvent | None) -> bytes:
    """What is sent; the same bytes at every attempt."""
    at = event.at if event is not None else delivery.created_at
    data = {} if event is None else {"number": event.number, "inspection": event.data}
    told = {"type": delivery.type, "timestamp": at.isoformat().replace("+00:00", "Z"), "data": data}
    return json.dumps(told, ensure_ascii=False, separators=(",", ":")).encode()


def _view(row: WebhookDelivery) -> DeliveryView:
    return DeliveryView(
        id=row.id,
        type=row.type,
        number=row.number,
        inspection_id=row.inspection_id,
        state=row.state,
        attempts=row.attempts,
        created_at=row.created_at,
        next_at=row.next_at,
        tried_at=row.tried_at,
        status=row.status,
        error=row.error,
    )
