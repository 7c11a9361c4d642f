"""Events: every change of an inspection that others may wait for, written in the transaction of the change itself.

So there is no change without its event and no event without its change, whatever crashes. Events of an account are
numbered from 1 in the order in which they become visible; who has read up to a number misses nothing behind it.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum
from typing import Any

from sqlalchemy import select
from sqlalchemy.orm import Session

from store.db import Database, insert_into
from store.graph import Graph
from store.integration_models import EventCounter, InspectionEvent
from store.leasing import metadata_of
from store.models import ACTIVE_INSPECTION, OVER_TASK, Inspection, Task
from store.status import PUBLISH, shown_state


class EventType(StrEnum):
    """What an event tells of."""

    QUEUED = "inspection.queued"
    """It was made, or its next attempt begins."""
    RUNNING = "inspection.running"
    CANCELLING = "inspection.cancelling"
    CANCELLED = "inspection.cancelled"
    SUCCEEDED = "inspection.succeeded"
    """It is over, and its files can be fetched; so for the next two."""
    PARTIAL = "inspection.partial"
    FAILED = "inspection.failed"
    STAGE = "inspection.stage"
    """It has come to another stage."""
    RENAMED = "inspection.renamed"
    """Its label, external id, priority or metadata changed."""
    REVIEWED = "inspection.reviewed"
    """Somebody said something of its findings."""
    DELETED = "inspection.deleted"


@dataclass(frozen=True)
class EventView:
    """An event as others may see it."""

    number: int
    type: str
    at: datetime
    inspection: Mapping[str, Any]
    """What is told of the inspection as it was then."""


def tell_change(session: Session, graph: Graph, inspection: Inspection, now: datetime) -> None:
    """Write an event when the inspection has another state, attempt or stage than the last event said.

    Called last in a transaction that holds the inspection's row: the row that numbers events is held from here on.
    """
    session.flush()
    state, stage = shown_state(inspection), _stage(session, graph, inspection)
    said = f"{inspection.attempt}:{state}"
    told = f"{said}:{stage}"
    if told == inspection.told:
        return
    same_state = inspection.told.startswith(f"{said}:")
    inspection.told = told
    _write(session, inspection, EventType.STAGE if same_state else EventType(f"inspection.{state}"), stage, now)


def tell(session: Session, inspection: Inspection, kind: EventType, now: datetime) -> None:
    """Write an event of another kind; called as `tell_change` is."""
    _write(session, inspection, kind, inspection.told.split(":", 2)[-1], now)


def _stage(session: Session, graph: Graph, inspection: Inspection) -> str:
    """Where it is: the first stage with a task that is not over; empty when all is over."""
    if shown_state(inspection) not in ACTIVE_INSPECTION:
        return ""
    if inspection.state not in ACTIVE_INSPECTION:
        return PUBLISH
    open_tasks = (Task.inspection_id == inspection.id, Task.state.not_in(OVER_TASK))
    stages = set(session.scalars(select(Task.stage).where(*open_tasks).distinct()))
    return next((name for name in graph.stages if name in stages), "")


def _write(session: Session, inspection: Inspection, kind: EventType, stage: str, now: datetime) -> None:
    data = {
        "id": inspection.id,
        "state": shown_state(inspection),
        "stage": stage or None,
        "attempt": inspection.attempt,
        "label": inspection.label,
        "external_id": inspection.external_id,
        "metadata": metadata_of(inspection),
        "failed_stage": inspection.failed_stage,
        "code": (inspection.error or {}).get("code"),
    }
    session.add(
        InspectionEvent(
            owner=inspection.owner,
            number=_next_number(session, inspection.owner),
            inspection_id=inspection.id,
            type=kind,
            at=now,
            data=data,
        )
    )


def _next_number(session: Session, owner: str) -> int:
    """The next number of an account; others who need one wait for the end of this transaction."""
    statement = insert_into(session, EventCounter).values(owner=owner, last=1)
    statement = statement.on_conflict_do_update(
        index_elements=[EventCounter.owner], set_={"last": EventCounter.last + 1}
    )
    return int(session.execute(statement.returning(EventCounter.last)).scalar_one())


@dataclass(frozen=True)
class Events:
    """Events of all accounts in one database."""

    db: Database

    def after(self, owner: str, number: int, limit: int, inspection_id: str | None = None) -> Sequence[EventView]:
        """Events of an account, or of one inspection of it, behind a number, in their order."""
        query = select(InspectionEvent).where(InspectionEvent.owner == owner, InspectionEvent.number > number)
        if inspection_id is not None:
            query = query.where(InspectionEvent.inspection_id == inspection_id)
        with self.db.read() as session:
            rows = session.scalars(query.order_by(InspectionEvent.number).limit(limit))
            return [EventView(row.number, row.type, row.at, row.data) for row in rows]

    def last(self, owners: Collection[str]) -> dict[str, int]:
        """Number of the last event of each of these accounts; 0 for one without any."""
        query = select(EventCounter.owner, EventCounter.last).where(EventCounter.owner.in_(owners))
        with self.db.read() as session:
            found = {owner: last for owner, last in session.execute(query)}  # noqa: C416 - rows are not plain tuples
        return {owner: found.get(owner, 0) for owner in owners}
