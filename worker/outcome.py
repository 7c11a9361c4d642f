"""What a caller of `worker.run.run_inspection` sees: events while it runs, one outcome at the end."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

from core.errors import BladeAtlasError
from core.states import RunState, StageState

EventKind = Literal["opened", "started", "progress", "retry", "ended", "published", "finished"]


@dataclass(frozen=True)
class Event:
    """One step of a run, for a progress display or as a JSON line."""

    kind: EventKind
    """``opened`` once at the start; ``started``/``progress``/``retry``/``ended`` of a task; ``published``,
    ``finished`` once at the end."""
    fraction: float
    """Share of the whole run in [0, 1]; never falls within a run."""
    eta_s: float | None = None
    """Estimated seconds left; None until something was measured."""
    stage: str = ""
    key: str = ""
    """Task key, e.g. ``coarse/seg_000_0000_0180``; empty for events of the run."""
    state: str = ""
    """Of the task (``succeeded``, ``failed``, ``skipped`` ...) or, in ``finished``, of the run."""
    done: int = 0
    """Ended tasks of this stage."""
    total: int = 0
    """Tasks of this stage known so far."""
    stage_fraction: float = 0.0
    """Share of this stage in [0, 1], running tasks included."""
    seconds: float | None = None
    """What the task took, when it ended."""
    reused: bool = False
    """The task's result was already there."""
    message: str = ""


OnEvent = Callable[[Event], None]


@dataclass(frozen=True)
class StageOutcome:
    """One stage of a run, summed over its tasks."""

    name: str
    state: StageState
    done: int
    total: int
    reused: int
    seconds: float
    """Summed over tasks, whenever they were computed."""
    peak_rss_bytes: int


@dataclass(frozen=True)
class Outcome:
    """How a run ended. Exit codes are the command line's."""

    state: RunState
    out: Path
    seconds: float
    """Wall time of this call."""
    computed: int
    """Tasks that ran in this call."""
    reused: int
    """Tasks whose result was already there."""
    failed_stage: str = ""
    error: BladeAtlasError | None = None
    """Set for ``partial``, ``failed`` and ``cancelled``; its `code` says why."""
    stages: tuple[StageOutcome, ...] = field(default_factory=tuple)
