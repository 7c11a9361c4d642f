"""The publisher of a server: plans that are over become artifacts in the store and rows in the database.

A crash at any point leaves an inspection that is still to be published, and files that the next publisher
writes again, byte for byte, under the same names.
"""

from __future__ import annotations

import threading
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from core.errors import Cancelled
from store.artifacts import ArtifactStore, Stored
from store.inspections import Inspections
from store.json_log import logger
from store.publishing import Publishing, Ticket
from worker.periodic import Periodic
from worker.publish import Collection, collected, record_of, report_rows
from worker.results import ResultFolders

_log = logger("bladeatlas.publisher")


@dataclass(frozen=True)
class Publisher:
    """Publishes one inspection after the other."""

    publishing: Publishing
    inspections: Inspections
    results: ResultFolders
    store: ArtifactStore
    scratch: Path
    """Local folder for tables until they are stored."""
    owner: str
    heartbeat_s: float = 10.0

    def publish_all(self) -> int:
        """Publish whatever is due; returns how many inspections."""
        done = 0
        while (ticket := self.publishing.take(self.owner)) is not None:
            try:
                done += self.publish(ticket)
            except Exception:  # noqa: BLE001 - whatever is wrong with one must not stop the others
                # Its lease runs out by itself: the others first, then this one again.
                _log.exception("publishing_failed", inspection=ticket.inspection_id)
        return done

    def publish(self, ticket: Ticket) -> bool:
        """Publish one attempt; False when its lease was lost on the way."""
        view, tasks = self.inspections.get(ticket.inspection_id), self.inspections.tasks(ticket.inspection_id)
        try:
            with self._kept(ticket) as lost:
                record, folders = record_of(view, tasks, self.results)
                with collected(record, folders, self.scratch) as wanted:
                    stored = self._store_files(ticket, wanted, lost)
            accepted = self.publishing.finish(ticket, stored, report_rows(wanted.report))
        except Cancelled:
            accepted = False
        if accepted:
            self._sweep(ticket, stored)
        _log.info(
            "published" if accepted else "publishing_refused",
            inspection=ticket.inspection_id,
            inspection_attempt=ticket.attempt,
            state=view.state,
        )
        return accepted

    @contextmanager
    def _kept(self, ticket: Ticket) -> Iterator[threading.Event]:
        """The lease, renewed in the background; the event says that it was lost."""
        lost = threading.Event()

        def renew() -> None:
            if not self.publishing.renew(ticket):
                lost.set()

        keeper = Periodic("publish lease", renew, self.heartbeat_s)
        keeper.start()
        try:
            yield lost
        finally:
            keeper.stop()

    def _store_files(self, ticket: Ticket, wanted: Collection, lost: threading.Event) -> list[Stored]:
        known = self._manifests(wanted.files.values())
        stored = []
        for path, source in (*wanted.files.items(), *wanted.tables.items()):
            if lost.is_set():
                raise Cancelled("somebody else publishes this", where=ticket.inspection_id)
            key = f"{ticket.prefix}/{path}"
            kept = self.store.link(key, source, known[source]) if source in known else self.store.put(key, source)
            stored.append(Stored(path, kept.size, kept.sha256))
        return stored

    def _manifests(self, sources: Iterable[Path]) -> dict[Path, Stored]:
        """Size and hash of files of results, from their manifests."""
        folders = {Path(*source.relative_to(self.results.root).parts[:2]) for source in sources}
        known = {}
        for folder in folders:
            manifest = self.results.find(folder.parent.name, folder.name)
            for name, entry in manifest.files.items() if manifest is not None else ():
                known[self.results.path(folder) / name] = Stored(name, int(entry["size"]), str(entry["sha256"]))
        return known

    def _sweep(self, ticket: Ticket, stored: list[Stored]) -> None:
        """Remove what earlier attempts, or a publisher that was cut off, put into the inspection's folder."""
        shown = {f"{ticket.prefix}/{file.path}" for file in stored}
        for key in self.store.list(f"inspections/{ticket.inspection_id}"):
            if key not in shown:
                self.store.remove(key)
