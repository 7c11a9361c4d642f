"""Rows of the tables as OpenAPI describes them; the columns are the contract's (docs/outputs.md)."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel, ConfigDict, Field


class Case(BaseModel):
    """A row of cases.csv."""

    model_config = ConfigDict(
        json_schema_extra={
            "example": {
                "name": "seg_000_0000_0180",
                "kind": "coarse",
                "start": 0,
                "end": 180,
                "status": "succeeded",
                "reason": None,
                "frames": 180,
                "models": 1,
                "registered_images": 171,
                "points3D": 20417,
                "mean_reprojection_error_px": 0.61,
                "median_reprojection_error_px": 0.52,
                "seconds": 48.1,
                "start_mode": "scratch",
                "selected": 1,
                "vetoed": 0,
            }
        }
    )

    name: str
    kind: str
    start: int
    end: int
    status: str
    reason: str | None
    frames: int
    models: int
    registered_images: int
    points3D: int  # noqa: N815 - the contract's column
    mean_reprojection_error_px: float | None
    median_reprojection_error_px: float | None
    seconds: float
    start_mode: str | None
    selected: int
    vetoed: int = Field(description="1: a check calls the model wrong; it wins only where model.veto is off")


class Metric(BaseModel):
    """One number."""

    model_config = ConfigDict(json_schema_extra={"example": {"name": "fuse.n_points", "value": 812345.0}})

    name: str = Field(description="`<task key>.<fact>`")
    value: float


class Detection(BaseModel):
    """A row of mapping/detections.csv."""

    model_config = ConfigDict(
        json_schema_extra={
            "example": {
                "id": 0,
                "key": "12.5",
                "time_s": 12.5,
                "label": "dent",
                "score": 0.91,
                **{"box_x1": 0.41, "box_y1": 0.38, "box_x2": 0.47, "box_y2": 0.44},
                "frame_index": 125,
                "outcome": "mapped",
                "reason": None,
                "rung": "sparse",
                "support_points": 14,
                **{"x": 0.12, "y": -0.4, "z": 2.31},
                **{"confidence": None, "blade": None, "defect_id": 3, "model": 0},
            }
        }
    )

    id: int
    key: str
    time_s: float | None
    label: str
    score: float | None
    box_x1: float
    box_y1: float
    box_x2: float
    box_y2: float
    frame_index: int | None
    outcome: str
    reason: str | None
    rung: str | None
    support_points: int | None
    x: float | None
    y: float | None
    z: float | None
    confidence: float | None
    blade: str | None
    defect_id: int | None
    model: int | None


class Event(BaseModel):
    """A row of mapping/timeline.csv."""

    model_config = ConfigDict(
        json_schema_extra={
            "example": {
                **{"event_id": 0, "defect_id": 3, "label": "dent", "start_s": 12.1, "end_s": 13.4},
                **{"n_detections": 9, "n_frames": 9, "x": 0.12, "y": -0.4, "z": 2.31},
                **{"radius": 0.03, "confidence": None},
            }
        }
    )

    event_id: int
    defect_id: int | None
    label: str
    start_s: float
    end_s: float
    n_detections: int
    n_frames: int
    x: float | None
    y: float | None
    z: float | None
    radius: float | None
    confidence: float | None


class Defect(BaseModel):
    """A record of mapping/defects.json; docs/outputs.md says what else is in it."""

    model_config = ConfigDict(
        extra="allow", json_schema_extra={"example": {"id": 3, "label": "dent", "centroid": [0.12, -0.4, 2.31]}}
    )

    id: int
    label: str
    centroid: list[float] | None = None


class Quality(BaseModel):
    """quality.json; docs/outputs.md says what else is in it."""

    model_config = ConfigDict(
        extra="allow", json_schema_extra={"example": {"schema_version": 1, "verdict": "ok", "flags": []}}
    )

    verdict: str | None = None
    flags: list[dict[str, Any]] = []
