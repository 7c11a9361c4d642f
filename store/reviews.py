"""Review records of inspections: appended one behind the other, never changed, whoever writes at the same time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime

from sqlalchemy import func, select
from sqlalchemy.orm import Session

from core.errors import BadInput
from core.review.published import MAX_RECORDS
from core.review.record import ReviewRecord
from core.review.state import Reviewed, fold
from core.review.target import Target
from core.review.words import Action
from store.db import Database
from store.events import EventType, tell
from store.leasing import lock_inspection
from store.review_models import ReviewEntry
from store.tables import DEFECTS, RowFilter, read_rows


class StaleRevision(BadInput):
    """Others have written since the revision that the writer has seen."""

    code = "stale_revision"


@dataclass(frozen=True)
class Author:
    """In whose name records are written."""

    name: str
    """As it is shown."""
    key_id: str
    """Empty without a key."""


@dataclass(frozen=True)
class Reviews:
    """The records of all inspections in one database."""

    db: Database

    def since(self, inspection_id: str, revision: int = 0) -> list[ReviewRecord]:
        """Records behind a revision, in their order."""
        query = select(ReviewEntry.record).where(
            ReviewEntry.inspection_id == inspection_id, ReviewEntry.revision > revision
        )
        with self.db.read() as session:
            return _parsed(session.scalars(query.order_by(ReviewEntry.revision)).all())

    def last(self, inspection_id: str) -> int:
        """Revision of the last record; 0 without any."""
        with self.db.read() as session:
            return _last(session, inspection_id)

    def reviewed(self, inspection_id: str) -> Reviewed:
        """The findings as the tables have them now, with what holds of them after all records."""
        defects = [Target.of_defect(one) for one in read_rows(self.db, inspection_id, DEFECTS, RowFilter({}))]
        return fold(self.since(inspection_id), defects)

    def append(
        self, inspection_id: str, records: Sequence[ReviewRecord], author: Author, seen: int | None = None
    ) -> list[ReviewRecord]:
        """Write records behind those that there are; who and when is the author's and now, whatever they say.

        Records whose ids are known are not written again. Either all others are written or none.

        Args:
            inspection_id: of the inspection.
            records: in their order; their revisions are given anew.
            author: whose records they are. What they tell of themselves becomes their origin, unless `seen` is given:
                then they are new.
            seen: the last revision that the author has seen; None for records that were made elsewhere and need
                not know of others.

        Returns:
            The records as they are kept, those that were known included.

        Raises:
            StaleRevision: there are others behind `seen`.
            BadInput: an undo names no record that it could take back, there would be too many, or there is no such
                inspection.
        """
        with self.db.write() as session:
            inspection, now = lock_inspection(session, inspection_id), self.db.now(session)
            known = _known(session, inspection_id, [one.id for one in records])
            new = [one for one in {one.id: one for one in records}.values() if one.id not in known]
            last = _last(session, inspection_id)
            if new and seen is not None and seen != last:
                raise StaleRevision(
                    f"others have written since revision {seen}; the last one is {last}", where="revision"
                )
            if last + len(new) > MAX_RECORDS:
                raise BadInput(f"an inspection has at most {MAX_RECORDS} review records", code="too_many_reviews")
            if seen is not None:
                _require_undone(session, inspection_id, new)
            for number, one in enumerate(new, last + 1):
                kept = _kept(one, number, author, now, is_new=seen is not None)
                known[one.id] = kept
                session.add(_entry(inspection_id, kept, author, now))
            if new:
                tell(session, inspection, EventType.REVIEWED, now)
        return [known[name] for name in dict.fromkeys(one.id for one in records)]


def _kept(one: ReviewRecord, number: int, author: Author, now: datetime, *, is_new: bool) -> ReviewRecord:
    kept = one.kept(number, stamp(now), author.name)
    return ReviewRecord(**{**kept.__dict__, "origin": None}) if is_new else kept


def _entry(inspection_id: str, record: ReviewRecord, author: Author, now: datetime) -> ReviewEntry:
    return ReviewEntry(
        inspection_id=inspection_id,
        revision=record.revision,
        record_id=record.id,
        at=now,
        key_id=author.key_id,
        record=record.to_dict(),
    )


def _require_undone(session: Session, inspection_id: str, records: Sequence[ReviewRecord]) -> None:
    for one in records:
        if one.action != Action.UNDO:
            continue
        found = _known(session, inspection_id, [str(one.value)]).get(str(one.value))
        if found is None or found.action == Action.UNDO:
            message = "there is no record of this id that could be taken back"
            raise BadInput(message, code="bad_review", where="value")


def _known(session: Session, inspection_id: str, ids: Sequence[str]) -> dict[str, ReviewRecord]:
    query = select(ReviewEntry.record).where(ReviewEntry.inspection_id == inspection_id)
    if len(ids) <= _FEW:
        query = query.where(ReviewEntry.record_id.in_(ids))
    found = {one.id: one for one in _parsed(session.scalars(query).all())}
    return {name: found[name] for name in ids if name in found}


_FEW = 500
"""Ids that one statement may name on every database."""


def _last(session: Session, inspection_id: str) -> int:
    query = select(func.max(ReviewEntry.revision)).where(ReviewEntry.inspection_id == inspection_id)
    return session.scalar(query) or 0


def _parsed(rows: Sequence[object]) -> list[ReviewRecord]:
    return [ReviewRecord.parse(row, "record") for row in rows]


def stamp(moment: datetime) -> str:
    """A moment as records tell it: UTC, to the millisecond."""
    return moment.astimezone(UTC).isoformat(timespec="milliseconds").replace("+00:00", "Z")
