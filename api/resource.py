"""From what the database knows to the resource that clients see."""

from __future__ import annotations

import hashlib
import json
import time
from collections import OrderedDict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from api.schemas import Interval, JobProblem, Queue, Resource, StageItem
from api.services import Services
from api.watching import Snapshot
from core.errors import BadInput, NoReconstruction, error_from_dict
from core.fingerprint import digest_of
from core.flags import Severity
from core.outputs import VIEWER_PAGE
from core.states import InspectionState
from core.versions import all_versions
from store.leasing import input_files, metadata_of
from store.models import LEASABLE, Inspection
from store.publishing import ArtifactRows
from store.status import PUBLISH, InspectionStatus, StageStatus, Statuses
from store.timings import Expectation, Timings, expected_frames, learn_timings, plan_eta, stage_eta

_LEARN_EVERY_S = 60.0
_REMEMBERED = 512
_SHOWN_SEVERITIES = (Severity.WARNING, Severity.ERROR)
_TITLES = {
    "bad_input": "The input cannot be used",
    "no_reconstruction": "The video gave no model that can be trusted",
    "oom": "Not enough memory",
    "timeout": "A stage took too long",
    "disk_full": "No space left",
    "worker_lost": "The worker was lost",
}
_LINKS = (
    "stages",
    "cases",
    "metrics",
    "quality",
    "detections",
    "timeline",
    "defects",
    "reviews",
    "reviewed",
    "events",
    "logs",
    "artifacts",
    "archive.zip",
    "cancel",
    "retry",
    "row",
)


@dataclass(frozen=True)
class Published:
    """What the published report says that the tables do not."""

    warnings: Sequence[Mapping[str, Any]]
    versions: Mapping[str, str]


@dataclass
class Resources:
    """Builds the resources of inspections and caches what takes long to read and does not change."""

    services: Services
    _timings: Timings = field(default_factory=dict)
    _learnt_at: float = float("-inf")
    _frames: OrderedDict[str, tuple[float, float]] = field(default_factory=OrderedDict)
    _published: OrderedDict[tuple[str, int], Published] = field(default_factory=OrderedDict)
    _versions: Mapping[str, str] = field(default_factory=all_versions)

    def snapshot(self, inspection_id: str) -> Snapshot | None:
        """One inspection, ready to be sent; None when there is none."""
        status = Statuses(self.services.db, self.services.graph).read(inspection_id)
        if status is None:
            return None
        body = self.resource(status).model_dump_json().encode()
        etag = f'"{hashlib.sha256(body).hexdigest()[:32]}"'
        return Snapshot(status.row.owner, status.row.deleted_at is not None, status.active, body, etag)

    def resource(self, status: InspectionStatus) -> Resource:
        """The resource of one inspection."""
        row, by = status.row, self.expectation(status.row)
        left = self._eta(status, by)
        published = self._report(row) if row.published else Published((), self._versions)
        return Resource.model_validate(
            {
                "id": row.id,
                "state": status.state,
                "stage": status.stage,
                "attempt": row.attempt,
                "progress": round(status.progress, 4),
                "eta_s": left,
                "stages": [self.stage(stage, by) for stage in status.stages],
                "queue": _queue(status, left),
                "cancellable": row.state in LEASABLE,
                "label": row.label,
                "external_id": row.external_id,
                "priority": row.priority,
                "metadata": metadata_of(row),
                "parameters": row.parameters or {},
                "created_at": row.created_at,
                "started_at": row.started_at,
                "ended_at": None if status.active else row.ended_at,
                "expires_at": row.expires_at,
                "selected_case": status.selected_case,
                "warnings": [] if status.active else published.warnings,
                "error": None if status.active or not row.error else job_problem(row.error, row.failed_stage),
                "input_sha256": {"video": row.video_sha256, "annotations": row.annotations_sha256},
                "videos": [
                    {"video": number, "sha256": one.video_sha256, "annotations_sha256": one.annotations_sha256}
                    for number, one in enumerate(input_files(row))
                ],
                "params_digest": digest_of(row.settings),
                "versions": published.versions,
                "links": _links(self.services.link(f"/v1/inspections/{row.id}")),
            }
        )

    def expectation(self, row: Inspection) -> Expectation:
        """What the time that an inspection still needs is told from."""
        frames = self._frames.get(row.id)
        if frames is None:
            frames = expected_frames(self.services.db, row)
            if frames[0] == frames[1]:  # they are counted
                self._frames[row.id] = frames
                if len(self._frames) > _REMEMBERED:
                    self._frames.popitem(last=False)
        return Expectation(self.services.graph, self._learnt(), self.services.settings.worker_count(), frames)

    def stage(self, stage: StageStatus, by: Expectation) -> StageItem:
        """One stage."""
        return StageItem(
            name=stage.name,
            state=stage.state,
            done=stage.count.over,
            total=stage.count.total,
            progress=round(stage.count.share, 4),
            started_at=stage.started_at,
            eta_s=stage_eta(stage, by),
        )

    def _eta(self, status: InspectionStatus, by: Expectation) -> Interval | None:
        if not status.active or status.state == InspectionState.CANCELLING or status.stage == PUBLISH:
            return None
        return plan_eta(status.stages, by)

    def _learnt(self) -> Timings:
        if time.monotonic() - self._learnt_at > _LEARN_EVERY_S:
            self._learnt_at = time.monotonic()
            self._timings = learn_timings(self.services.db)
        return self._timings

    def _report(self, row: Inspection) -> Published:
        """Read once for every publication: published files do not change until the next attempt."""
        name = (row.id, row.published)
        found = self._published.get(name)
        if found is None:
            flags = self._json(row.id, "quality.json").get("flags", ())
            versions = self._json(row.id, "summary.json").get("versions") or self._versions
            found = Published([flag for flag in flags if flag.get("severity") in _SHOWN_SEVERITIES], versions)
            self._published[name] = found
            if len(self._published) > _REMEMBERED:
                self._published.popitem(last=False)
        return found

    def _json(self, inspection_id: str, path: str) -> dict[str, Any]:
        artifact = ArtifactRows(self.services.db).find(inspection_id, path)
        if artifact is None:
            return {}
        try:
            with self.services.artifacts.open(artifact.key) as stream:
                data = json.load(stream)
        except (OSError, ValueError):  # retention may remove it at any moment
            return {}
        return data if isinstance(data, dict) else {}


def job_problem(error: Mapping[str, Any], failed_stage: str | None) -> JobProblem:
    """The problem object of an inspection that did not end well."""
    known = error_from_dict(error)
    kind = next((base.code for base in (BadInput, NoReconstruction) if isinstance(known, base)), known.code)
    return JobProblem(
        title=_TITLES.get(kind, "A stage failed"),
        detail=known.message,
        code=kind,
        reason=known.code,
        stage=failed_stage,
        where=known.where,
        retryable=kind in ("oom", "timeout", "disk_full", "worker_lost") or known.retryable,
    )


def _queue(status: InspectionStatus, plan: Interval | None) -> Queue | None:
    """Those ahead take as long as this one may; who runs now has between nothing and all of it left."""
    position = status.queue_position
    if position is None:
        return None
    eta = None if plan is None else (round((position - 1) * plan[0], 1), round(position * plan[1], 1))
    return Queue(position=position, eta_s=eta)


def _links(own: str) -> dict[str, str]:
    page = {"viewer": f"{own}/{VIEWER_PAGE}", "report": f"{own}/report.pdf"}
    return {"self": own, **page, **{name.removesuffix(".zip"): f"{own}/{name}" for name in _LINKS}}
