"""Whose task is next: turns go round the accounts, and within an account priority decides, then age.

Of the accounts that have something to run, that one is next of which the fewest tasks run now; of several, the one
whose last task began first. So 20 inspections of one account do not keep a single one of another waiting.
"""

from __future__ import annotations

from collections.abc import Sequence
from datetime import datetime
from typing import Any

from sqlalchemy import ColumnElement, Select, Subquery, UnaryExpression, and_, func, or_, select, update
from sqlalchemy.orm import Session

from core.states import InspectionState, TaskState
from store.account_models import Account
from store.models import LEASABLE, Inspection, Task

_Order = tuple[ColumnElement[Any] | UnaryExpression[Any], ...]


def inspections_in_turn(*where: ColumnElement[bool]) -> Select[str]:
    """Ids of inspections whose tasks may start and that fulfil `where`, in the order in which they get a turn."""
    running = _running()
    return (
        _with_turns(select(Inspection.id), running)
        .where(Inspection.state.in_(LEASABLE), *where)
        .order_by(*_accounts_in_turn(running), *_within_account())
    )


def tasks_in_turn(announced: ColumnElement[bool], *where: ColumnElement[bool]) -> Select[Task]:
    """Runnable tasks that fulfil `where`, in the order in which they get their turns, one after the other.

    It is the order in which a single runner would lease them if none ended meanwhile: every task that an account gets
    counts before its next.

    Args:
        announced: of the runnable tasks, those that are about to start: they count as if they ran.
    """
    running = _running(and_(Task.state == TaskState.RUNNABLE, announced))
    order = (*_within_account(), Task.position.asc())
    rank = func.row_number().over(partition_by=Inspection.owner, order_by=order)
    ranked = (
        _with_turns(
            select(Task.id.label("id"), (func.coalesce(running.c.tasks, 0) + rank).label("turn"), Account.turn_at)
            .select_from(Task)
            .join(Inspection, Inspection.id == Task.inspection_id),
            running,
        )
        .where(Task.state == TaskState.RUNNABLE, Inspection.state.in_(LEASABLE), *where)
        .subquery()
    )
    query = select(Task).join(ranked, ranked.c.id == Task.id).join(Inspection, Inspection.id == Task.inspection_id)
    # The state once more: whoever locks the rows then looks at them as they are by that time.
    query = query.where(Task.state == TaskState.RUNNABLE)
    return query.order_by(ranked.c.turn, ranked.c.turn_at.asc().nulls_first(), *order)


def begin_turn(session: Session, owner: str, now: datetime) -> None:
    """Note that a task of an account is leased in this transaction."""
    session.execute(update(Account).where(Account.id == owner).values(turn_at=now))


def queued_in_turn(session: Session) -> Sequence[str]:
    """Ids of queued inspections in the order in which they will start, as far as it is known now.

    An account's first one comes before any account's second. What an account has running already counts as its first
    ones: it goes on with these before it begins another.
    """
    running = _running()
    rank = func.row_number().over(partition_by=Inspection.owner, order_by=_within_account()).label("rank")
    ranked = (
        _with_turns(
            select(
                Inspection.id.label("id"),
                Inspection.state.label("state"),
                rank,
                func.row_number().over(order_by=(*_accounts_in_turn(running), *_within_account())).label("turn"),
            ),
            running,
        )
        .where(Inspection.state.in_(LEASABLE))
        .subquery()
    )
    query = select(ranked.c.id).where(ranked.c.state == InspectionState.QUEUED)
    return session.scalars(query.order_by(ranked.c.rank, ranked.c.turn)).all()


def _running(*also: ColumnElement[bool]) -> Subquery:
    """How many tasks of each account run now, or fulfil one of the other conditions."""
    return (
        select(Inspection.owner.label("owner"), func.count().label("tasks"))
        .join(Task, Task.inspection_id == Inspection.id)
        .where(or_(Task.state == TaskState.LEASED, *also))
        .group_by(Inspection.owner)
        .subquery()
    )


def _with_turns(query: Select[Any], running: Subquery) -> Select[Any]:
    """The query with what the order of accounts is told from."""
    with_running = query.outerjoin(running, running.c.owner == Inspection.owner)
    return with_running.outerjoin(Account, Account.id == Inspection.owner)


def _accounts_in_turn(running: Subquery) -> _Order:
    return (func.coalesce(running.c.tasks, 0), Account.turn_at.asc().nulls_first())


def _within_account() -> _Order:
    return (Inspection.priority.desc(), Inspection.created_at.asc(), Inspection.id.asc())
