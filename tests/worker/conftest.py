"""A workplace for runs of the fake stages."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest

from core.settings import make_settings
from core.videos import Recording
from tests.worker.fake_stages import GRAPH, SMALL, journal
from worker.events import Event, Outcome
from worker.local_run import run_inspection
from worker.results import ResultFolders


@dataclass
class Workplace:
    """A video, an output folder, and what the stages shall do."""

    root: Path
    events: list[Event] = field(default_factory=list)
    seen: int = 0
    """Lines of the journal that `started` has told of."""

    @property
    def video(self) -> Path:
        return self.root / "input" / "video.mp4"

    @property
    def out(self) -> Path:
        return self.root / "out"

    def control(self, **wishes: dict[str, Any]) -> None:
        """Keys use ``__`` for the slash."""
        named = {key.replace("__", "/"): wish for key, wish in wishes.items()}
        (self.video.parent / "control.json").write_text(json.dumps(named))

    def run(self, options: dict[str, Any] | None = None, annotations: Path | None = None, **more: Any) -> Outcome:
        settings = make_settings(options={**SMALL, **(options or {})})
        more = {"workers": 2, "graph": GRAPH, "on_event": self.events.append, **more}
        return run_inspection([Recording(self.video, annotations)], self.out, settings, **more)

    def started(self) -> list[str]:
        """Keys of the tasks that began since the last call."""
        # The file stays: a stage may be about to write into the one that it has opened.
        lines = journal(self.video)[self.seen :]
        self.seen += len(lines)
        return sorted(line.removeprefix("start ") for line in lines if line.startswith("start "))

    def digests(self) -> dict[str, str]:
        """Digest of every result by the task that made it."""
        found = ResultFolders(self.out / ".bladeatlas" / "results").all()
        return {manifest.key: manifest.digest for manifest in found}

    def temporary(self) -> list[Path]:
        """What attempts left behind."""
        hidden = self.out / ".bladeatlas"
        return [*hidden.glob("results/*/.tmp-*"), *hidden.glob("tables-*"), *self.out.rglob(".part-*")]


@pytest.fixture
def place(tmp_path: Path) -> Workplace:
    return made_below(tmp_path)


def made_below(root: Path) -> Workplace:
    """A workplace in which nothing has run."""
    made = Workplace(root)
    made.video.parent.mkdir()
    made.video.write_bytes(b"a video" * 100)
    return made
