"""A detection after placement, and its files between placing detections and telling defects apart."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.io.annotations import read_rows, write_rows
from core.json_files import JsonObject, read_json, write_json
from core.mapping.confidence import Parts
from core.scene.detection import DetectionRow, Outcome

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

_PARTS = "parts.json"
_OBSERVATIONS = "observations.npz"
MAX_POINTS = 64
"""Surface points kept of an observation: enough for its extent and its colour."""


@dataclass(frozen=True)
class Observation:
    """A detection after placement: its row, and what later steps need of its surface."""

    row: DetectionRow
    points: F64
    """(n, 3) visible surface under it; empty unless it was cast."""
    normal: F64
    """(3,) unit, towards the camera; zero when unknown."""
    radius: float
    """Of the patch, scene units."""
    sigma: float | None
    """Standard deviation of the place, scene units."""
    parts: Parts | None
    point_ids: I64
    """Sparse points that support it."""
    sparse: F64
    """(n, 3) of them."""
    track_id: str | None = None


def write_observations(folder: Path, observations: Sequence[Observation]) -> None:
    """Write `detections.json` (the rows), `parts.json` and `observations.npz`."""
    write_rows(folder, [one.row for one in observations])
    rows = []
    for one in observations:
        parts = None if one.parts is None else _written(one.parts)
        rows.append({"id": one.row.id, "sigma": one.sigma, "track_id": one.track_id, "parts": parts})
    write_json(folder / _PARTS, rows)
    kept = [_thinned(one.points) for one in observations]
    np.savez(
        folder / _OBSERVATIONS,
        offsets=np.cumsum([0, *(len(points) for points in kept)]).astype(np.int64),
        points=np.concatenate([np.zeros((0, 3)), *kept]),
        normal=np.array([one.normal for one in observations], np.float64).reshape(-1, 3),
        radius=np.array([one.radius for one in observations], np.float64),
    )


def read_observations(folder: Path) -> list[Observation]:
    """What `write_observations` wrote, in input order; without the sparse points."""
    rows = read_rows(folder)
    more = read_json(folder / _PARTS)
    with np.load(folder / _OBSERVATIONS) as data:
        offsets, points, normal, radius = (data[name] for name in ("offsets", "points", "normal", "radius"))
    found = []
    for k, (row, extra) in enumerate(zip(rows, more, strict=True)):
        parts = None if extra["parts"] is None else _read(extra["parts"])
        found.append(
            Observation(
                row,
                points[offsets[k] : offsets[k + 1]],
                normal[k],
                float(radius[k]),
                extra["sigma"],
                parts,
                np.zeros(0, np.int64),
                np.zeros((0, 3)),
                extra["track_id"],
            )
        )
    return found


def _written(parts: Parts) -> JsonObject:
    """The form in the file: infinity is null, and the model's warnings bear the name that they had first."""
    row = asdict(parts)
    warnings = row.pop("model_warnings")
    return {**row, "lead": None if parts.lead == float("inf") else parts.lead, "doubts": warnings}


def _read(row: JsonObject) -> Parts:
    own = {name: value for name, value in row.items() if name != "doubts"}
    lead = float("inf") if row["lead"] is None else row["lead"]
    return Parts(**{**own, "lead": lead, "model_warnings": row["doubts"]})


def _thinned(points: F64) -> F64:
    if len(points) <= MAX_POINTS:
        return points
    thinned: F64 = points[np.linspace(0, len(points) - 1, MAX_POINTS).round().astype(int)]
    return thinned


def parts_rows(observations: Sequence[Observation]) -> list[dict[str, Any]]:
    """Records of ``mapping/confidence.json``: what each placed detection's confidence is made of."""
    return [
        {
            "id": one.row.id,
            "confidence": one.row.confidence,
            "position_sigma": one.sigma,
            "radius": one.radius,
            "parts": None if one.parts is None else one.parts.to_dict(),
        }
        for one in observations
        if one.row.outcome != Outcome.UNPLACED
    ]
