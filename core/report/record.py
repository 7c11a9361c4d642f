"""What the report is made from: everything the plan knows about a run, as plain values."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from core.products.contract import Facts, Products
from core.scene.defect import DefectRecord, EventRow
from core.scene.detection import Detection, DetectionRow
from core.scene.frame import RunFrames
from core.settings import Settings
from core.states import RunState, TaskState
from core.task_key import stage_of

Cell = str | int | float | None
"""A value of a published table."""
Row = Mapping[str, Cell]
"""A row of a published table, by column."""
Item = Mapping[str, Any]
"""An object of a JSON file that a stage wrote; docs/stage-results.md says which members it has."""
Document = dict[str, Any]
"""The object of summary.json or quality.json, nested as docs/outputs.md says."""


@dataclass(frozen=True)
class TaskRecord:
    """One task of the plan, ended or not."""

    key: str
    """Name in the plan, e.g. ``coarse/seg_000_0000_0180``."""
    state: TaskState
    """`WAITING` stands for every state in which it has not ended."""
    reason: str = ""
    """Code of the error that ended it; empty when it succeeded."""
    message: str = ""
    """The error in one sentence; empty when it succeeded."""
    seconds: float = 0.0
    peak_rss_bytes: int = 0
    facts: Facts = field(default_factory=dict)

    @property
    def stage(self) -> str:
        """Name of its stage."""
        return stage_of(self.key)


@dataclass(frozen=True)
class RunTables:
    """Tables that stages left in their result folders; empty where a stage did not come to its end."""

    detections: Sequence[Detection] = ()
    """`annotations`: detections as read."""
    frames: RunFrames = field(default_factory=lambda: RunFrames(()))
    """`frames`: frame table of the run."""
    registered: Sequence[int] = ()
    """`extend`: indices of the registered frames."""
    registered_further: Mapping[int, Sequence[int]] = field(default_factory=dict)
    """The same of further models, by number."""
    mapped_rows: Sequence[DetectionRow] | None = None
    """`timeline` (else `map_defects`): rows of the detections; None = mapping was not reached."""
    timeline: Sequence[EventRow] = ()
    """`timeline`: events of all models; their ids are told apart where they are made."""
    defects: Sequence[DefectRecord] = ()
    """`timeline`: defects of all models."""


@dataclass(frozen=True)
class RunRecord:
    """A run, ended in whatever way."""

    settings: Settings
    state: RunState
    tasks: Sequence[TaskRecord]
    """Every task of the plan, in its order."""
    tables: RunTables = field(default_factory=RunTables)
    inputs: Mapping[str, str] = field(default_factory=dict)
    """SHA-256 (hex) of the input files by role: ``video``, ``annotations``, of further videos ``video_1`` and so on."""
    versions: Mapping[str, str] = field(default_factory=dict)
    """Versions of this program and of the libraries that shape results."""
    failed_stage: str = ""
    reason: str = ""
    """Code that says why the state is not ``succeeded``."""
    message: str = ""
    """The same in one sentence."""
    label: str = ""
    external_id: str = ""
    """The caller's own names of the run."""
    metadata: Mapping[str, str] = field(default_factory=dict)
    """What the caller knows of the engine and the work; see `core.metadata`."""

    @property
    def products(self) -> Products:
        """What the tasks that succeeded handed on beside their files."""
        return Products({task.key: task.facts for task in self.tasks if task.state == TaskState.SUCCEEDED})

    def of_stage(self, *stages: str) -> list[TaskRecord]:
        """Tasks of the stages, in the plan's order."""
        return [task for task in self.tasks if task.stage in stages]
