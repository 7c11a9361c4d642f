"""What crosses the border of the store: frozen values, never rows that are tied to a session."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import PurePosixPath
from typing import Any

from core.products.contract import Facts
from core.states import InspectionState, TaskState


@dataclass(frozen=True)
class InputFiles:
    """A video of an inspection and its annotations, by path and by content."""

    video: str
    video_sha256: str
    annotations: str | None
    annotations_sha256: str | None


@dataclass(frozen=True)
class Lease:
    """The right to run one task and to end it, until it expires."""

    task_id: int
    fence: int
    attempt: int
    owner: str
    inspection_id: str
    key: str
    stage: str
    args: Mapping[str, Any]
    optional: bool
    fingerprint: str
    settings: Mapping[str, Any]
    files: tuple[InputFiles, ...]
    """In the order given."""
    inputs: Mapping[str, PurePosixPath]
    """Relative result path of every dependency that has a result, by task key."""
    facts: Mapping[str, Facts]
    """Facts of the same."""


@dataclass(frozen=True)
class Result:
    """A finished result: what a task hands to `Plan.complete`."""

    fingerprint: str
    stage: str
    digest: str
    facts: Facts
    path: str
    """Relative to the results' root, with ``/``."""
    seconds: float
    peak_rss_bytes: int
    rows: Mapping[str, Any] = field(default_factory=dict)
    """What table rows are made from; see `store.tables`."""


@dataclass(frozen=True)
class TaskView:
    """A task as others may see it."""

    key: str
    stage: str
    position: int
    depends: tuple[str, ...]
    optional: bool
    state: TaskState
    attempt: int
    fingerprint: str | None
    seconds: float | None
    peak_rss_bytes: int | None
    progress: float
    reused: bool
    digest: str | None
    facts: Facts | None
    error: Mapping[str, Any] | None
    path: str | None
    """Relative result path when it succeeded."""


@dataclass(frozen=True)
class InspectionView:
    """An inspection as others may see it."""

    id: str
    state: InspectionState
    files: tuple[InputFiles, ...]
    input_digest: str
    settings: Mapping[str, Any]
    out: str
    failed_stage: str | None
    error: Mapping[str, Any] | None
    label: str = ""
    external_id: str = ""
    metadata: Mapping[str, str] = field(default_factory=dict)
