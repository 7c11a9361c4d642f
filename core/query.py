"""Questions to a finished result: what does this pixel show, and which frames see this point?

They need the published folder alone: sparse model, surface, frames, defects (`docs/outputs.md`).
"""

from __future__ import annotations

import csv
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.errors import BadInput, StageFailed
from core.mapping.scene import face_normals, oriented
from core.mapping.support import open_model
from core.mapping.surface import Surface
from core.mapping.views import Views, views_of
from core.roi import Crop
from core.surface.ply import Mesh, read_mesh
from core.surface.support import point_spacing
from core.timeline.seen import views_of_place

F64 = NDArray[np.float64]

_SPACING_SAMPLE = 20_000
TOLERANCE_SPACINGS = 5.0


@dataclass(frozen=True)
class Shown:
    """What a pixel shows. Without a point, `reason` says why: a code of the detections' table."""

    frame_index: int | None
    reason: str | None = None
    point: tuple[float, float, float] | None = None
    normal: tuple[float, float, float] | None = None
    distance: float | None = None
    """From the camera, model units."""
    incidence_deg: float | None = None
    face: int | None = None
    """Of mapping/mesh_defects.ply."""
    defect_id: int | None = None

    def to_dict(self) -> dict[str, Any]:
        """JSON form."""
        return asdict(self)


@dataclass(frozen=True)
class Seeing:
    """A frame that sees a point."""

    frame_index: int
    source_index: int
    time_s: float
    quality: float
    """cos(incidence) / squared distance, relative to the best frame."""
    x: float
    y: float
    """Pixel of the source frame; the centre of the first is at 0.5."""

    def to_dict(self) -> dict[str, Any]:
        """JSON form."""
        return asdict(self)


class Result:
    """One model of a published result, opened for questions."""

    def __init__(self, folder: Path, model: int = 0) -> None:
        """Open a folder; `BadInput` says which of its files is missing."""
        root = folder if model == 0 else folder / "models" / str(model)
        for name in (folder / "frames.csv", folder / "summary.json", root / "sparse", root / "mapping"):
            if not name.exists():
                raise BadInput(f"{folder.name} has no {name.relative_to(folder)}: is it a result?", where=name.name)
        self._frames = _frames(folder / "frames.csv")
        self._crop = _crop(folder / "summary.json")
        self.views: Views = views_of(open_model(root / "sparse"))
        try:
            self.mesh: Mesh = oriented(read_mesh(root / "mapping" / "mesh_defects.ply"), self.views)
        except StageFailed as error:
            raise BadInput(error.message, where="mesh_defects.ply") from None
        self._surface = Surface(self.mesh.vertices, self.mesh.faces)
        self._normals = face_normals(self.mesh)
        step = max(1, len(self.mesh.vertices) // _SPACING_SAMPLE)
        # The vertices of a Poisson mesh lie about as far apart as the points that support it.
        self._tolerance = TOLERANCE_SPACINGS * point_spacing(self.mesh.vertices[::step]) / np.sqrt(step)

    def frame_at(self, time_s: float) -> int:
        """Source frame of the run nearest to a time."""
        return int(min(self._frames.values(), key=lambda row: abs(row["time_s"] - time_s))["source_index"])

    def point_at(self, source_index: int, x: float, y: float) -> Shown:
        """What a pixel of a source frame shows.

        Args:
            source_index: decoded frame of the video, from 0.
            x: pixels from the left edge of the whole frame.
            y: from its upper edge.
        """
        row = next((row for row in self._frames.values() if row["source_index"] == source_index), None)
        if row is None:
            return Shown(None, "no_registered_view")
        index = int(row["index"])
        view = self.views.row(index)
        if view is None:
            return Shown(index, "frame_not_registered")
        xy = np.array([[x - self._crop.x0, y - self._crop.y0]])
        if not (0 <= xy[0, 0] <= self._crop.width and 0 <= xy[0, 1] <= self._crop.height):
            return Shown(index, "outside_roi")
        ray = self.views.rays(xy, self.views.R[view])
        hits = self._surface.cast(self.views.centers[view][None], ray)
        if not hits.hit[0]:
            return Shown(index, "off_surface")
        if hits.cosine[0] <= 0:
            return Shown(index, "occluded")
        point = self.views.centers[view] + hits.distance[0] * ray[0]
        face = int(hits.face[0])
        return Shown(
            frame_index=index,
            point=_three(point),
            normal=_three(self._normals[face]),
            distance=float(hits.distance[0]),
            incidence_deg=float(np.degrees(np.arccos(min(1.0, hits.cosine[0])))),
            face=face,
            defect_id=self._defect_of(face),
        )

    def frames_seeing(self, point: F64) -> list[Seeing]:
        """Registered frames that see the point of the surface nearest to a given one, best first."""
        nearest, face = self._surface.nearest(np.asarray(point, np.float64)[None])
        normal = self._normals[int(face[0])]
        found = views_of_place(
            nearest, normal, self.views, self._surface, float(self._tolerance), nearest[0], self._crop
        )
        seeing = []
        for one in found:
            row = self._frames[one.frame_index]
            x, y = one.at or (0.0, 0.0)
            pixel = (x * self._crop.source_width, y * self._crop.source_height)
            source = int(row["source_index"])
            seeing.append(Seeing(one.frame_index, source, float(row["time_s"]), round(one.quality, 4), *pixel))
        return seeing

    def _defect_of(self, face: int) -> int | None:
        defects = self.mesh.extra.get("defect_id")
        if defects is None:
            return None
        own = defects[self.mesh.faces[face]]
        values, counts = np.unique(own[own >= 0], return_counts=True)
        return int(values[counts.argmax()]) if len(values) and counts.max() >= 2 else None


def defect_place(folder: Path, defect: int) -> F64:
    """(3,) centroid of a defect of a result; `BadInput` when there is no such defect."""
    try:
        records = json.loads((folder / "mapping" / "defects.json").read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise BadInput(f"mapping/defects.json cannot be read: {error}", where="defects.json") from None
    for record in records:
        if record["id"] == defect:
            return np.asarray(record["centroid"], np.float64)
    raise BadInput(f"there is no defect {defect}; there are {len(records)}, from 0", where="--defect")


def _three(values: F64) -> tuple[float, float, float]:
    x, y, z = (float(value) for value in values)
    return x, y, z


def _frames(path: Path) -> dict[int, Mapping[str, Any]]:
    with path.open(newline="", encoding="utf-8") as stream:
        rows = [
            {"index": int(r["index"]), "source_index": int(r["source_index"]), "time_s": float(r["time_s"])}
            for r in csv.DictReader(stream)
        ]
    return {int(row["index"]): row for row in rows}


def _crop(path: Path) -> Crop:
    summary = json.loads(path.read_text(encoding="utf-8"))
    frame = summary.get("frame")
    if not frame or not frame.get("crop"):
        raise BadInput("summary.json does not say which part of the frames was used", where="summary.json")
    x0, y0, x1, y1 = frame["crop"]
    return Crop(x0, y0, x1, y1, frame["width"], frame["height"])
