"""What a stage is: typed input in, files below its own folder and a typed product out.

A stage is a function `run(task: StageTask) -> P`, where `P` is the `Product` that its spec names. It is deterministic
for a seed, writes only below `task.out`, reads no environment, clock or global, reports progress through
`task.progress` and stops with `Cancelled` soon after `task.cancelled()` turns true.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from core.errors import Cancelled, StageFailed
from core.products.contract import Facts, Products
from core.settings import Settings
from core.task_key import key_of, parts_of
from core.video.limits import MAX_FRAME_PIXELS
from core.videos import Recording


def _no_progress(fraction: float, message: str) -> None:
    """Discard progress; the default for direct calls and tests."""


@dataclass(frozen=True)
class StageTask:
    """One task, ready to run in any process on any machine."""

    key: str
    """Name in the plan, e.g. ``coarse/seg_000_0000_0180``."""
    args: Mapping[str, Any]
    """JSON arguments fixed by the plan (a chunk's range, a window's name)."""
    settings: Settings
    inputs: Mapping[str, Path]
    """Result folder of every finished task this one depends on, by task key."""
    facts: Mapping[str, Facts]
    """Facts of the same tasks, by task key; `products` reads them."""
    recordings: Sequence[Recording]
    """The videos of the run in the order given, each with its annotations."""
    out: Path
    """Existing empty folder; everything the stage writes lies below it."""
    threads: int = 1
    """How many threads the stage may use."""
    max_frame_pixels: int = MAX_FRAME_PIXELS
    """A limit of the deployment on the video's pictures."""
    progress: Callable[[float, str], None] = _no_progress
    """Called with a fraction in [0, 1] and a short message."""
    cancelled: Callable[[], bool] = field(default=lambda: False)

    def report(self, done: float, total: float, message: str = "") -> None:
        """Report progress and stop here when the task was cancelled."""
        if self.cancelled():
            raise Cancelled("the task was cancelled", where=self.key)
        self.progress(min(1.0, done / total) if total else 1.0, message)

    @property
    def products(self) -> Products:
        """What the tasks that it depends on handed on beside their files."""
        return Products(self.facts)

    @property
    def submodel(self) -> int:
        """Number of the model that it works on; 0 is the run's own."""
        return int(self.args.get("piece", 0))

    def input(self, *keys: str) -> Path:
        """Result folder of the first of `keys` that it depends on, that of its own model before the run's own.

        `StageFailed` when it depends on none of them.
        """
        for key in keys:
            for name in (key_of(key, self.submodel), key):
                if name in self.inputs:
                    return self.inputs[name]
        raise StageFailed(f"task {self.key} needs the result of {' or '.join(keys)}", where=self.key)

    def has(self, key: str) -> bool:
        """Whether it depends on `key`, of its own model."""
        return key_of(key, self.submodel) in self.inputs

    def fan_in(self, stage: str) -> list[tuple[str, Path]]:
        """(key, folder) of every finished task of a fanned-out stage, ordered by key."""
        return [(key, self.inputs[key]) for key in parts_of(self.inputs, stage, self.submodel)]
