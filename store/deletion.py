"""Deleting an inspection: its row stays, so that its id answers 410; its files go with the sweeper."""

from __future__ import annotations

from sqlalchemy import update

from store.db import Database
from store.leasing import changed
from store.models import Inspection


def mark_deleted(db: Database, inspection_id: str) -> bool:
    """Mark an inspection as deleted; False when it was already."""
    with db.write() as session:
        where = (Inspection.id == inspection_id, Inspection.deleted_at.is_(None))
        return changed(session, update(Inspection).where(*where).values(deleted_at=db.now(session)))
