"""Logs of tasks: one file per task, JSON lines of this program and whatever the stage printed."""

from __future__ import annotations

import json
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from core.states import AttemptOutcome
from core.task_key import file_stem
from store.files import ArtifactStore
from store.records import Lease


@dataclass(frozen=True)
class TaskLogs:
    """Logs below one local folder; with an object store they are copied there after every attempt."""

    folder: Path
    by_inspection: bool = False
    """One folder per inspection, as a server needs; the folder of a local run has only one."""
    mirror: ArtifactStore | None = None

    def begin(self, lease: Lease) -> Path:
        """The task's log; a first attempt begins it anew. Who writes to it is said in its own lines."""
        path = self.folder / self._name(lease)
        path.parent.mkdir(parents=True, exist_ok=True)
        if lease.attempt == 1:
            path.unlink(missing_ok=True)
        elif self.mirror is not None and not path.is_file():
            self._continue(self.mirror, f"logs/{self._name(lease)}", path)
        self.note(lease, "attempt_started", {"fingerprint": lease.fingerprint, "owner": lease.owner})
        return path

    def note(self, lease: Lease, event: str, more: Mapping[str, object]) -> None:
        """Add one line."""
        line = {"time": datetime.now(UTC).isoformat(timespec="milliseconds"), "event": event}
        names = ("inspection_id", "key", "attempt", "fence")
        line |= {name: getattr(lease, name) for name in names}
        with (self.folder / self._name(lease)).open("a", encoding="utf-8") as stream:
            stream.write(json.dumps({**line, **more}) + "\n")

    def end(self, lease: Lease, outcome: AttemptOutcome) -> None:
        """Say how the attempt ended, and let others read it."""
        path = self.folder / self._name(lease)
        if path.is_file():
            self.note(lease, "attempt_ended", {"outcome": outcome})
            if self.mirror is not None:
                self.mirror.put(f"logs/{self._name(lease)}", path)

    def _name(self, lease: Lease) -> str:
        name = f"{file_stem(lease.key)}.log"
        return f"{lease.inspection_id}/{name}" if self.by_inspection else name

    @staticmethod
    def _continue(mirror: ArtifactStore, stored: str, path: Path) -> None:
        """Earlier attempts ran on other machines: their lines stay."""
        with suppress(FileNotFoundError), mirror.open(stored) as stream:
            path.write_bytes(stream.read())
