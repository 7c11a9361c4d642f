"""A service of its own for a test: database, artifact folder, and processes that are started and killed."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from sqlalchemy import select

from core.settings import make_settings
from store.db import Database
from store.files import ArtifactStore, input_key
from store.inspections import Inspections
from store.models import Artifact, Attempt, Inspection
from store.records import InputFiles
from tests.signals import heed_interrupts
from tests.waiting import wait_for
from tests.worker.fake_stages import GRAPH, SMALL, journal

ROOT = Path(__file__).resolve().parents[2]
FAST = {
    "BLADEATLAS_GRAPH": "tests.worker.fake_stages:GRAPH",
    "BLADEATLAS_HEARTBEAT_S": "0.5",
    "BLADEATLAS_LEASE_S": "2",
    "BLADEATLAS_SWEEP_S": "0.5",
    "BLADEATLAS_STALE_S": "5",
}


@dataclass
class Deployment:
    """Processes of one service, and what a test asks it."""

    root: Path
    db: Database
    environment: dict[str, str]
    remote: ArtifactStore | None = None
    """The object store, when the environment names one."""
    processes: list[subprocess.Popen[bytes]] = field(default_factory=list)

    @property
    def store(self) -> ArtifactStore:
        return self.remote or ArtifactStore(self.root / "artifacts")

    @property
    def inspections(self) -> Inspections:
        return Inspections(self.db, GRAPH)

    def video(self, name: str) -> Path:
        """Where the stages find the video of an inspection; their wishes and notes lie beside it."""
        return self.root / "artifacts" / self.inspections.get(name).files[0].video

    def create(self, name: str, options: dict[str, Any] | None = None, **wishes: dict[str, Any]) -> None:
        """An inspection as the API makes it, with a video of its own; wishes as in `Workplace.control`."""
        source = self.root / f"{name}.upload"
        source.write_bytes(name.encode() * 100)
        stored = self.store.put("upload", source)
        key = input_key(stored.sha256, "video")
        self.store.put(key, source)
        self.store.remove("upload")
        if self.remote is None:
            self._control(self.root / "artifacts" / key, wishes)
        settings = make_settings(options={**SMALL, **(options or {})})
        self.inspections.create(name, [InputFiles(key, stored.sha256, None, None)], settings, "")

    @staticmethod
    def _control(video: Path, wishes: dict[str, dict[str, Any]]) -> None:
        named = {task.replace("__", "/"): wish for task, wish in wishes.items()}
        video.with_name("control.json").write_text(json.dumps(named))

    def start(self, *arguments: str, data_dir: str = "") -> subprocess.Popen[bytes]:
        """`bladeatlas` in a process of its own; what it says goes to a file."""
        own = {"BLADEATLAS_DATA_DIR": str(self.root / data_dir)}
        with (self.root / f"process-{len(self.processes)}.log").open("wb") as log:
            process = subprocess.Popen(
                [sys.executable, "-m", "cli.main", *arguments],
                cwd=ROOT,
                env={**os.environ, **FAST, **own, **self.environment},
                stdout=log,
                stderr=subprocess.STDOUT,
                preexec_fn=heed_interrupts,
            )
        self.processes.append(process)
        return process

    def said(self, number: int = 0) -> str:
        return (self.root / f"process-{number}.log").read_text(errors="replace")

    def started(self, name: str) -> Counter[str]:
        """How often each task of an inspection began."""
        lines = journal(self.video(name))
        return Counter(line.removeprefix("start ") for line in lines if line.startswith("start "))

    def shown(self, name: str) -> str:
        """The state as the API shows it: a plan that is over counts once it is published."""
        with self.db.read() as session:
            row = session.get_one(Inspection, name)
            return row.state if row.published == row.attempt else f"{row.state}, not published"

    def wait(self, *names: str, state: str = "succeeded", seconds: float = 60.0) -> None:
        wait_for(lambda: all(self.shown(name) == state for name in names), seconds)

    def outcomes(self) -> Counter[tuple[str, str, str]]:
        with self.db.read() as session:
            rows = session.scalars(select(Attempt))
            return Counter((row.inspection_id, row.key, row.outcome) for row in rows)

    def accepted_once(self, name: str) -> bool:
        """Every task of an inspection has exactly one accepted attempt."""
        found = [count for (own, _, outcome), count in self.outcomes().items() if (own, outcome) == (name, "succeeded")]
        return found == [1] * len(self.inspections.tasks(name))

    def artifacts(self, name: str) -> dict[str, str]:
        """Hash of every artifact of an inspection."""
        with self.db.read() as session:
            return {row.path: row.sha256 for row in session.scalars(select(Artifact)) if row.inspection_id == name}

    def digests(self, name: str) -> dict[str, str | None]:
        return {task.key: task.digest for task in self.inspections.tasks(name)}

    def stop(self) -> None:
        for process in self.processes:
            if process.poll() is None:
                process.send_signal(signal.SIGCONT)
                process.kill()
            process.wait()
