"""The inspection as clients see it."""

from __future__ import annotations

from datetime import datetime
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field

from api.parameters import MetadataName, OneOf, Text
from core.metadata import KNOWN_METADATA, MAX_ENTRIES
from core.settings import PRESET_NAMES
from core.states import InspectionState, StageState

Interval = tuple[float, float]
State = Annotated[str, OneOf(InspectionState)]

EXAMPLE_ID = "0b6f1e0c3f7d4f0f9a52f7f4f1f0a6c1"
_SHA = "9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822cd15d6c15b0f00a08"

PARAMETERS_EXAMPLE: dict[str, Any] = {
    "preset": "draft",
    "options": {"matching.window": 8},
    "label": "engine 4, stage 2",
}
EXAMPLE_STAGE: dict[str, Any] = {
    "name": "coarse",
    "state": StageState.RUNNING,
    "done": 3,
    "total": 7,
    "progress": 0.47,
    "started_at": "2026-05-04T09:31:10Z",
    "eta_s": [40.0, 95.5],
}
EXAMPLE: dict[str, Any] = {
    "id": EXAMPLE_ID,
    "state": InspectionState.RUNNING,
    "stage": "coarse",
    "attempt": 1,
    "progress": 0.515,
    "eta_s": [310.0, 640.0],
    "stages": [EXAMPLE_STAGE],
    "queue": None,
    "cancellable": True,
    "label": "engine 4, stage 2",
    "external_id": "WO-1187",
    "priority": 0,
    "metadata": {"engine_serial": "V12345", "module": "HPT"},
    "parameters": {"preset": "draft", "options": {"matching.window": 8}},
    "created_at": "2026-05-04T09:30:02Z",
    "started_at": "2026-05-04T09:30:03Z",
    "ended_at": None,
    "expires_at": None,
    "selected_case": None,
    "warnings": [],
    "error": None,
    "input_sha256": {"video": _SHA, "annotations": None},
    "videos": [{"video": 0, "sha256": _SHA, "annotations_sha256": None}],
    "params_digest": _SHA,
    "versions": {"bladeatlas": "0.1.0"},
    "links": {"self": f"/v1/inspections/{EXAMPLE_ID}"},
}


class StageItem(BaseModel):
    """One stage of the plan."""

    model_config = ConfigDict(json_schema_extra={"example": EXAMPLE_STAGE})

    name: str
    state: Annotated[str, OneOf(StageState)]
    done: int = Field(description="tasks that ended")
    total: int = Field(description="tasks known so far")
    progress: float = Field(ge=0, le=1, description="share of this stage, running tasks included")
    started_at: datetime | None
    eta_s: Interval | None = Field(description="[low, high] seconds left, from former inspections or a guess")


class Queue(BaseModel):
    """Where a queued inspection stands."""

    position: int = Field(ge=1, description="1 = next")
    eta_s: Interval | None = Field(description="[low, high] seconds until it starts; null = not known")


class Warned(BaseModel):
    """A flag of quality.json that a reader of the result must know."""

    model_config = ConfigDict(extra="allow")

    code: str = Field(description="from the list in docs/flags.md")
    severity: str


class JobProblem(BaseModel):
    """Why an inspection did not end well; a problem object (RFC 9457)."""

    model_config = ConfigDict(json_schema_serialization_defaults_required=True)

    type: str = "about:blank"
    title: str
    detail: str = Field(description="one sentence")
    code: str = Field(
        description="`bad_input`, `no_reconstruction`, `oom`, `timeout`, `disk_full`, `worker_lost`, or another code"
    )
    reason: str = Field(description="the exact code, e.g. `truncated_video`")
    stage: str | None = Field(description="the stage that failed")
    where: str = ""
    retryable: bool = Field(description="a retry with the same parameters may succeed")


class InputSha256(BaseModel):
    """Content of the input; of several videos the first, `videos` has all."""

    video: str
    annotations: str | None


class InputVideo(BaseModel):
    """A video of an inspection."""

    video: int = Field(ge=0, description="its number in the tables, from 0 in the order given")
    sha256: str
    annotations_sha256: str | None = Field(description="null for a video without annotations")


class Resource(BaseModel):
    """An inspection: its videos, their annotations, its parameters, its result."""

    model_config = ConfigDict(json_schema_extra={"example": EXAMPLE})

    id: str
    state: State
    stage: str | None = Field(description="where it is; `publish` while the files are put in place; null when over")
    attempt: int = Field(ge=1, description="grows with every retry")
    progress: float = Field(ge=0, le=1, description="never backwards within an attempt")
    eta_s: Interval | None = Field(description="[low, high] seconds left in all; null = it is over, or about to be")
    stages: list[StageItem]
    queue: Queue | None = Field(description="null unless queued")
    cancellable: bool
    label: str
    external_id: str
    priority: int = Field(description="0 to 9; of the inspections of an account higher ones go first")
    metadata: dict[str, str] = Field(description="what is known of the engine and the work")
    parameters: dict[str, Any] = Field(description="as they were asked for")
    created_at: datetime
    started_at: datetime | None
    ended_at: datetime | None
    expires_at: datetime | None = Field(description="when it is removed; null while it is active or kept for ever")
    selected_case: str | None
    warnings: list[Warned]
    error: JobProblem | None
    input_sha256: InputSha256
    videos: list[InputVideo]
    params_digest: str = Field(description="SHA-256 of all options as used")
    versions: dict[str, str] = Field(description="programs that made the result")
    links: dict[str, str] = Field(description="paths of everything that belongs to it")


class Inspections(BaseModel):
    """One page, newest first."""

    model_config = ConfigDict(json_schema_extra={"example": {"inspections": [EXAMPLE], "next_cursor": None}})

    inspections: list[Resource]
    next_cursor: str | None = Field(description="`cursor` of the next page; null on the last. Also in `Link: rel=next`")


class Parameters(BaseModel):
    """What an inspection is asked for: the document of `bladeatlas run --parameters`."""

    model_config = ConfigDict(
        extra="forbid", json_schema_extra={"example": {"preset": "draft", "options": {"matching.window": 8}}}
    )

    preset: str = Field("default", description="where the values start: " + ", ".join(PRESET_NAMES))
    options: dict[str, Any] = Field({}, description="values by dotted name; `GET /v1/options` lists them")
    label: Text = Field("", description="free text")
    external_id: Text = Field("", description="the caller's own name for it; need not be unique")
    priority: int = Field(
        0, ge=0, le=9, description="higher ones of the account go first; at most the account's `max_priority`"
    )
    metadata: dict[MetadataName, Text] = Field(
        {},
        max_length=MAX_ENTRIES,
        description="what is known of the engine and the work: "
        + ", ".join(KNOWN_METADATA)
        + ", or any other name; an empty text is none",
    )
