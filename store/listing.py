"""Pages of inspections, newest first, with a cursor that stays right while new ones come in."""

from __future__ import annotations

import base64
import binascii
import json
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime

from sqlalchemy import Select, and_, func, or_, select

from core.errors import BadInput
from store.db import Database
from store.models import ACTIVE_INSPECTION, Inspection
from store.status import shown_state_column


@dataclass(frozen=True)
class Filter:
    """Which inspections; empty fields do not choose."""

    owner: str
    states: Sequence[str] = ()
    label: str | None = None
    external_id: str | None = None
    created_after: datetime | None = None
    created_before: datetime | None = None


@dataclass(frozen=True)
class Page:
    """Some inspections and how to get the next."""

    rows: Sequence[Inspection]
    cursor: str | None


def list_inspections(db: Database, chosen: Filter, limit: int, cursor: str | None) -> Page:
    """One page; `BadInput` for a cursor that is none of ours."""
    query = _chosen(chosen).order_by(Inspection.created_at.desc(), Inspection.id.desc()).limit(limit + 1)
    if cursor is not None:
        created_at, inspection_id = _decoded(cursor)
        same = and_(Inspection.created_at == created_at, Inspection.id < inspection_id)
        query = query.where(or_(Inspection.created_at < created_at, same))
    with db.read() as session:
        rows: Sequence[Inspection] = session.scalars(query).all()
    more = len(rows) > limit
    return Page(rows[:limit], _encoded(rows[limit - 1]) if more else None)


def count_active(db: Database) -> int:
    """Inspections that are queued or running, of all owners."""
    with db.read() as session:
        query = select(func.count()).select_from(Inspection).where(Inspection.state.in_(ACTIVE_INSPECTION))
        return int(session.scalar(query) or 0)


def _chosen(chosen: Filter) -> Select[Inspection]:
    query = select(Inspection).where(Inspection.owner == chosen.owner, Inspection.deleted_at.is_(None))
    if chosen.states:
        query = query.where(shown_state_column().in_(chosen.states))
    if chosen.label is not None:
        query = query.where(Inspection.label == chosen.label)
    if chosen.external_id is not None:
        query = query.where(Inspection.external_id == chosen.external_id)
    if chosen.created_after is not None:
        query = query.where(Inspection.created_at >= chosen.created_after)
    if chosen.created_before is not None:
        query = query.where(Inspection.created_at < chosen.created_before)
    return query


def _encoded(row: Inspection) -> str:
    text = json.dumps([row.created_at.isoformat(), row.id])
    return base64.urlsafe_b64encode(text.encode()).decode().rstrip("=")


def _decoded(cursor: str) -> tuple[datetime, str]:
    try:
        text = base64.urlsafe_b64decode(cursor + "=" * (-len(cursor) % 4))
        created_at, inspection_id = json.loads(text)
        moment = datetime.fromisoformat(created_at)
        if moment.tzinfo is None or not isinstance(inspection_id, str) or "\0" in inspection_id:
            raise ValueError(inspection_id)
        inspection_id.encode()
        return moment.astimezone(UTC), inspection_id
    except (ValueError, TypeError, OverflowError, RecursionError, binascii.Error):
        raise BadInput("this cursor was not given out by the service", code="bad_cursor", where="cursor") from None
