"""A finished run as input of the comparisons: its settings and what its stages wrote."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from core.errors import BadInput
from core.features.io import FrameFeatures, feature_name, read_features
from core.io.frames import images_folder, read_frames
from core.products.contract import Facts
from core.scene.frame import RunFrames
from core.settings import Settings
from core.task_key import stage_of
from store.db import open_sqlite
from store.graph import CORE_GRAPH
from store.inspections import Inspections
from worker.local_run import RunFolder


@dataclass(frozen=True)
class FinishedRun:
    """Result folders and facts by task key."""

    out: Path
    settings: Settings
    folders: dict[str, Path]
    facts: dict[str, Facts]

    def folder(self, key: str) -> Path:
        """Result folder of a task; `BadInput` when the run did not get there."""
        if key not in self.folders:
            raise BadInput(f"the run in '{self.out}' has no result of {key}", where="RESULT")
        return self.folders[key]

    def images(self) -> list[Path]:
        """Exported frames in order of time."""
        return sorted(images_folder(self.folder("frames")).glob("*.jpg"))

    def frames(self) -> RunFrames:
        """The frame table."""
        return read_frames(self.folder("frames"))

    def features(self, frame: int) -> FrameFeatures:
        """Features of one frame."""
        for key, folder in self.folders.items():
            path = folder / feature_name(frame)
            if stage_of(key) == "features" and path.exists():
                return read_features(path)
        raise BadInput(f"the run in '{self.out}' has no features of frame {frame}", where="RESULT")


@contextmanager
def open_run(out: Path) -> Iterator[FinishedRun]:
    """Open the folder of a `bladeatlas run`; `BadInput` when it is none."""
    folder = RunFolder(out.resolve())
    if not folder.database.exists():
        raise BadInput(f"'{out}' is not the result folder of a run", where="RESULT")
    database = open_sqlite(folder.database)
    try:
        inspections = Inspections(database, CORE_GRAPH)
        inspection = next(iter(inspections.find()), None)
        if inspection is None:
            raise BadInput(f"'{out}' holds no run", where="RESULT")
        tasks = inspections.tasks(inspection.id)
    finally:
        database.close()
    done = [task for task in tasks if task.path is not None]
    yield FinishedRun(
        out=out,
        settings=Settings.model_validate(inspection.settings),
        folders={task.key: folder.results / str(task.path) for task in done},
        facts={task.key: dict(task.facts or {}) for task in done},
    )
