"""Processes that run tasks, as they report themselves."""

from __future__ import annotations

import platform
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import timedelta

from sqlalchemy import delete, select

from store.db import Database
from store.models import Worker


@dataclass(frozen=True)
class WorkerRegistry:
    """The table of workers. Nothing depends on it: leases say who does what."""

    db: Database

    def seen(self, name: str, queues: Sequence[str]) -> None:
        """A worker is alive."""
        with self.db.write() as session:
            now = self.db.now(session)
            row = session.get(Worker, name)
            if row is None:
                row = Worker(name=name, host=platform.node()[:128], queues=list(queues), started_at=now, seen_at=now)
                session.add(row)
            row.queues, row.seen_at = list(queues), now

    def alive(self, within_s: float) -> list[str]:
        """Names of this host's workers that were seen so lately."""
        with self.db.read() as session:
            since = self.db.now(session) - timedelta(seconds=within_s)
            query = select(Worker.name).where(Worker.host == platform.node()[:128], Worker.seen_at >= since)
            return list(session.scalars(query.order_by(Worker.name)))

    def gone(self, name: str) -> None:
        """A worker stops."""
        with self.db.write() as session:
            session.execute(delete(Worker).where(Worker.name == name))
