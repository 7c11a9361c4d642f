"""Rows of the tables as OpenAPI describes them; the columns are the contract's (docs/outputs.md)."""

from __future__ import annotations

from collections.abc import Mapping
from types import GenericAlias
from typing import Any

from pydantic import BaseModel, ConfigDict, Field, create_model

from core.scene.case import CaseRow
from core.scene.columns import columns_of
from core.scene.defect import EventRow
from core.scene.detection import DetectionRow
from store.tables import CASES, DETECTIONS, TIMELINE, Table


def list_of(row: type[BaseModel]) -> Any:
    """For `response_model=`: a list of such rows. Their classes are made, so a type checker takes none for a type."""
    return GenericAlias(list, (row,))


def _row_model(name: str, doc: str, declared: type[Any], table: Table, example: Mapping[str, Any]) -> type[BaseModel]:
    """The model of a row: its columns as they are declared, empty where the database lets them be."""
    stored = table.model.__table__.columns
    fields: dict[str, Any] = {
        column.name: (
            column.kind | None if stored[column.name].nullable else column.kind,
            Field(description=column.meaning),
        )
        for column in columns_of(declared)
    }
    config = ConfigDict(json_schema_extra={"example": dict(example)})
    return create_model(name, __config__=config, __doc__=doc, __module__=__name__, **fields)


Case = _row_model(
    "Case",
    "A row of cases.csv.",
    CaseRow,
    CASES,
    {
        "name": "seg_000_0000_0180",
        **{"kind": "coarse", "start": 0, "end": 180, "status": "succeeded", "reason": None},
        **{"frames": 180, "models": 1, "registered_images": 171, "points3D": 20417},
        **{"mean_reprojection_error_px": 0.61, "median_reprojection_error_px": 0.52},
        **{"seconds": 48.1, "start_mode": "scratch", "selected": 1, "vetoed": 0},
    },
)
Detection = _row_model(
    "Detection",
    "A row of mapping/detections.csv.",
    DetectionRow,
    DETECTIONS,
    {
        **{"id": 0, "key": "12.5", "time_s": 12.5, "label": "dent", "score": 0.91},
        **{"box_x1": 0.41, "box_y1": 0.38, "box_x2": 0.47, "box_y2": 0.44},
        **{"frame_index": 125, "outcome": "mapped", "reason": None, "rung": "sparse", "support_points": 14},
        **{"x": 0.12, "y": -0.4, "z": 2.31},
        **{"confidence": None, "blade": None, "defect_id": 3, "model": 0, "video": 0},
        **{"length": 0.061, "length_sigma": 0.006, "width": 0.048, "width_sigma": 0.008},
        **{"area": 0.0022, "area_sigma": 0.0006, "length_unit": "model", "size_from": "box"},
    },
)
Event = _row_model(
    "Event",
    "A row of mapping/timeline.csv.",
    EventRow,
    TIMELINE,
    {
        **{"event_id": 0, "defect_id": 3, "label": "dent", "start_s": 12.1, "end_s": 13.4},
        **{"n_detections": 9, "n_frames": 9, "x": 0.12, "y": -0.4, "z": 2.31},
        **{"radius": 0.03, "confidence": None, "video": 0},
    },
)


class Metric(BaseModel):
    """One number."""

    model_config = ConfigDict(json_schema_extra={"example": {"name": "fuse.n_points", "value": 812345.0}})

    name: str = Field(description="`<task key>.<fact>`")
    value: float


class Defect(BaseModel):
    """A record of mapping/defects.json; docs/outputs.md says what else is in it."""

    model_config = ConfigDict(
        extra="allow", json_schema_extra={"example": {"id": 3, "label": "dent", "centroid": [0.12, -0.4, 2.31]}}
    )

    id: int | None = Field(description="null only with `reviewed=1`, for what people added")
    label: str | None
    centroid: list[float] | None = None


class Quality(BaseModel):
    """quality.json; docs/outputs.md says what else is in it."""

    model_config = ConfigDict(
        extra="allow", json_schema_extra={"example": {"schema_version": 1, "verdict": "ok", "flags": []}}
    )

    verdict: str | None = None
    flags: list[dict[str, Any]] = []
