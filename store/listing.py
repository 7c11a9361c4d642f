"""Pages of inspections, newest first, with a cursor that stays right while new ones come in."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from datetime import datetime

from sqlalchemy import Select, and_, func, or_, select

from store.cursors import moment_cursor, read_moment_cursor
from store.db import Database
from store.integration_models import MetadataEntry
from store.models import ACTIVE_INSPECTION, Inspection
from store.status import shown_state_column

_NAME = "inspections"


@dataclass(frozen=True)
class Filter:
    """Which inspections; empty fields do not choose."""

    owner: str
    states: Sequence[str] = ()
    label: str | None = None
    external_id: str | None = None
    created_after: datetime | None = None
    created_before: datetime | None = None
    metadata: Mapping[str, str] = field(default_factory=dict)
    """Exactly these entries."""


@dataclass(frozen=True)
class Page:
    """Some inspections and how to get the next."""

    rows: Sequence[Inspection]
    cursor: str | None


def list_inspections(db: Database, chosen: Filter, limit: int, cursor: str | None) -> Page:
    """One page; `BadInput` for a cursor that is none of ours."""
    query = _chosen(chosen).order_by(Inspection.created_at.desc(), Inspection.id.desc()).limit(limit + 1)
    if cursor is not None:
        created_at, inspection_id = read_moment_cursor(_NAME, cursor)
        same = and_(Inspection.created_at == created_at, Inspection.id < inspection_id)
        query = query.where(or_(Inspection.created_at < created_at, same))
    with db.read() as session:
        rows: Sequence[Inspection] = session.scalars(query).all()
    last = rows[limit - 1] if len(rows) > limit else None
    return Page(rows[:limit], None if last is None else moment_cursor(_NAME, last.created_at, last.id))


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
    for name, value in chosen.metadata.items():
        entry = (MetadataEntry.inspection_id == Inspection.id, MetadataEntry.name == name, MetadataEntry.value == value)
        query = query.where(select(MetadataEntry.name).where(*entry).exists())
    return query
