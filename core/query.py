"""Questions to a finished result: what does this pixel show, and which frames see this point?

They need the published folder alone: sparse model, surface, frames, defects (`docs/outputs.md`).
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.errors import BadInput, StageFailed
from core.mapping.facing import read_surface
from core.mapping.scene import face_normals
from core.mapping.surface import Surface
from core.outputs import DEFECT_SURFACE, DEFECTS, FRAMES, SPARSE, SUMMARY, model_folder, model_numbers
from core.report.csv_form import read_csv
from core.scene.detection import Reason
from core.scene.frame import Crop
from core.scene.views import Views
from core.surface.ply import Mesh
from core.surface.support import vertex_spacing
from core.timeline.seen import views_of_place

F64 = NDArray[np.float64]

GRID = 5
"""Pixels across a drawn box, and down it, that are asked where it lies."""
TOLERANCE_SPACINGS = 5.0
FAR_SHARE = 0.1
"""A place farther from the surface than this share of its diagonal is a mistake: other units, or another model."""


@dataclass(frozen=True)
class SurfaceHit:
    """What a pixel shows. Without a point, `reason` says why: a code of the detections' table."""

    frame_index: int | None
    reason: Reason | None = None
    time_s: float | None = None
    """Of the frame, which need not be the time that was asked for; None for one that took no part."""
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
class VisibleFrame:
    """A frame that sees a point."""

    frame_index: int
    video: int
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


@dataclass(frozen=True)
class OnSurface:
    """The point of the surface nearest to a place, model units."""

    point: tuple[float, float, float]
    face: int
    """Of mapping/mesh_defects.ply."""
    distance: float
    """From the place."""
    spacing: float
    """Typical distance between neighbouring points of the surface: a shorter `distance` says nothing."""

    def to_dict(self) -> dict[str, Any]:
        """JSON form."""
        return asdict(self)


class Result:
    """One model of a published result, opened for questions."""

    def __init__(self, folder: Path, model: int = 0) -> None:
        """Open a folder; `BadInput` says which of its files or models is missing."""
        root = model_folder(folder, model)
        if model < 0 or (model and not root.is_dir()):
            raise BadInput(f"there is no model {model}; there are {_models(folder)}", where="--model")
        for name in (folder / FRAMES, folder / SUMMARY, root / SPARSE, (root / DEFECT_SURFACE).parent):
            if not name.exists():
                raise BadInput(f"{folder.name} has no {name.relative_to(folder)}: is it a result?", where=name.name)
        self._frames = _frames(folder / FRAMES)
        self._crop, self._videos = _summary(folder / SUMMARY, self._frames)
        self.mesh: Mesh
        self.views: Views
        try:
            self.mesh, self.views = read_surface(root / SPARSE, root / DEFECT_SURFACE)
        except StageFailed as error:
            raise BadInput(error.message, where=error.where) from None
        self._surface = Surface(self.mesh.vertices, self.mesh.faces)
        self._normals = face_normals(self.mesh)
        self._spacing = vertex_spacing(self.mesh)

    def _length_of(self, video: int) -> _Length:
        """The length of a video; `BadInput` when there is no such one."""
        if not 0 <= video < len(self._videos):
            raise BadInput(f"there is no video {video}: 0 to {len(self._videos) - 1}", where="--video")
        return self._videos[video]

    def frame_at(self, time_s: float, video: int = 0) -> int:
        """Source frame of the run nearest to a time of a video; `BadInput` for a time outside it."""
        length = self._length_of(video)
        if not 0 <= time_s <= length.duration_s:
            which = f"video {video}" if len(self._videos) > 1 else "the video"
            raise BadInput(f"{time_s:g} s is outside {which}: 0 to {length.duration_s:g} s", where="--time")
        own = [row for row in self._frames.values() if row["video"] == video]
        if not own:
            raise BadInput(f"no frame of video {video} took part", where="--video")
        return int(min(own, key=lambda row: abs(row["time_s"] - time_s))["source_index"])

    def point_at(self, source_index: int, x: float, y: float, video: int = 0) -> SurfaceHit:
        """What a pixel of a source frame shows.

        Args:
            source_index: decoded frame of the video, from 0.
            x: pixels from the left edge of the whole frame.
            y: from its upper edge.
            video: number of the video, from 0 in the order given.

        Raises:
            BadInput: the video has no such frame, or the frame no such pixel.
        """
        n_frames = self._length_of(video).n_frames
        if not 0 <= source_index < n_frames:
            which = f"video {video}" if len(self._videos) > 1 else "the video"
            raise BadInput(f"{which} has no frame {source_index}: 0 to {n_frames - 1}", where="--frame")
        width, height = self._crop.source_width, self._crop.source_height
        if not (0 <= x <= width and 0 <= y <= height):
            raise BadInput(f"{x:g},{y:g} is outside the frame: 0,0 to {width},{height}", where="--pixel")
        here = (video, source_index)
        row = next((row for row in self._frames.values() if (row["video"], row["source_index"]) == here), None)
        if row is None:
            return SurfaceHit(None, Reason.NO_REGISTERED_VIEW)
        index, time_s = int(row["index"]), float(row["time_s"])
        view = self.views.row(index)
        if view is None:
            return SurfaceHit(index, Reason.FRAME_NOT_REGISTERED, time_s)
        xy = np.array([[x - self._crop.x0, y - self._crop.y0]])
        if not (0 <= xy[0, 0] <= self._crop.width and 0 <= xy[0, 1] <= self._crop.height):
            return SurfaceHit(index, Reason.OUTSIDE_ROI, time_s)
        ray = self.views.rays(xy, self.views.R[view])
        hits = self._surface.cast(self.views.centers[view][None], ray)
        if not hits.hit[0]:
            return SurfaceHit(index, Reason.OFF_SURFACE, time_s)
        if hits.cosine[0] <= 0:
            return SurfaceHit(index, Reason.OCCLUDED, time_s)
        point = self.views.centers[view] + hits.distance[0] * ray[0]
        face = int(hits.face[0])
        return SurfaceHit(
            frame_index=index,
            time_s=time_s,
            point=_three(point),
            normal=_three(self._normals[face]),
            distance=float(hits.distance[0]),
            incidence_deg=float(np.degrees(np.arccos(min(1.0, hits.cosine[0])))),
            face=face,
            defect_id=self._defect_of(face),
        )

    def place_of_box(self, frame_index: int, box: Sequence[float]) -> SurfaceHit:
        """What a box that somebody drew on a frame shows: of a grid of its pixels the one at median distance.

        Args:
            frame_index: of the frame in the run.
            box: x0, y0, x1, y1 in shares of the source frame.

        Raises:
            BadInput: the run has no such frame.
        """
        row = self._frames.get(frame_index)
        if row is None:
            raise BadInput(f"the run has no frame {frame_index}", where="frame")
        width, height = self._crop.source_width, self._crop.source_height
        steps = (np.arange(GRID) + 0.5) / GRID
        pixels = [
            ((box[0] + (box[2] - box[0]) * along) * width, (box[1] + (box[3] - box[1]) * down) * height)
            for down in steps
            for along in steps
        ]
        shown = [self.point_at(int(row["source_index"]), x, y, int(row["video"])) for x, y in pixels]
        placed = sorted((one for one in shown if one.distance is not None), key=lambda one: one.distance or 0.0)
        return placed[len(placed) // 2] if placed else shown[len(shown) // 2]

    def on_surface(self, place: F64) -> OnSurface:
        """The point of the surface nearest to a (3,) place; `BadInput` when there is none or it is far away."""
        if self._surface.empty:
            raise BadInput("the result has no surface", where=_file(DEFECT_SURFACE))
        points, faces = self._surface.nearest(np.asarray(place, np.float64)[None])
        distance = float(np.linalg.norm(points[0] - place))
        if not distance <= FAR_SHARE * self.mesh.diagonal:
            low, high = self.mesh.vertices.min(axis=0), self.mesh.vertices.max(axis=0)
            ranges = ", ".join(f"{axis} {a:.4g} to {b:.4g}" for axis, a, b in zip("xyz", low, high, strict=True))
            at = ",".join(f"{value:g}" for value in place)
            raise BadInput(f"{at} is {distance:.4g} away from the surface, which spans {ranges}", where="--point")
        return OnSurface(_three(points[0]), int(faces[0]), distance, self._spacing)

    @property
    def n_videos(self) -> int:
        """Videos of the run."""
        return len(self._videos)

    def visible_frames(self, place: F64, video: int | None = None) -> list[VisibleFrame]:
        """Registered frames that see the point of the surface nearest to a (3,) place, best first.

        With `video` those of one video alone; `BadInput` when there is no such one.
        """
        if video is not None:
            self._length_of(video)
        on = self.on_surface(place)
        point, tolerance = np.array(on.point), TOLERANCE_SPACINGS * self._spacing
        normal = self._normals[on.face]
        found = views_of_place(point[None], normal, self.views, self._surface, tolerance, point, self._crop)
        visible = []
        for one in found:
            row = self._frames[one.frame_index]
            if video not in (None, row["video"]):
                continue
            x, y = one.at or (0.0, 0.0)
            pixel = (x * self._crop.source_width, y * self._crop.source_height)
            source = int(row["source_index"])
            time_s, quality = float(row["time_s"]), round(one.quality, 4)
            visible.append(VisibleFrame(one.frame_index, int(row["video"]), source, time_s, quality, *pixel))
        return visible

    def _defect_of(self, face: int) -> int | None:
        defects = self.mesh.extra.get("defect_id")
        if defects is None:
            return None
        own = defects[self.mesh.faces[face]]
        values, counts = np.unique(own[own >= 0], return_counts=True)
        return int(values[counts.argmax()]) if len(values) and counts.max() >= 2 else None


def defect_place(folder: Path, defect: int, model: int | None = None) -> tuple[F64, int]:
    """(3,) centroid of a defect of a result, and the model in whose frame it is.

    Raises:
        BadInput: there is no such defect, or it is not in `model`.
    """
    try:
        records = json.loads((folder / DEFECTS).read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise BadInput(f"{DEFECTS} cannot be read: {error}", where=_file(DEFECTS)) from None
    record = next((one for one in records if one["id"] == defect), None)
    if record is None:
        there = ", ".join(f"D{one['id']}" for one in records)
        known = f"there are {there}" if records else "the result has none"
        raise BadInput(f"there is no defect {defect}; {known}", where="--defect")
    own = int(record.get("model") or 0)
    if model is not None and model != own:
        raise BadInput(f"D{defect} is in model {own}, not in model {model}", where="--model")
    return np.asarray(record["centroid"], np.float64), own


def _models(folder: Path) -> str:
    return ", ".join(str(number) for number in model_numbers(folder))


def _file(path: str) -> str:
    """Last part of a published path."""
    return path.rsplit("/", 1)[-1]


def _three(values: F64) -> tuple[float, float, float]:
    x, y, z = (float(value) for value in values)
    return x, y, z


def _frames(path: Path) -> dict[int, Mapping[str, Any]]:
    rows = [
        {
            "index": int(r["index"]),
            "video": int(r.get("video") or 0),  # results did not always tell
            "source_index": int(r["source_index"]),
            "time_s": float(r["time_s"]),
        }
        for r in read_csv(path)
    ]
    return {int(row["index"]): row for row in rows}


@dataclass(frozen=True)
class _Length:
    """Of a video."""

    n_frames: int
    duration_s: float


def _summary(path: Path, frames: Mapping[int, Mapping[str, Any]]) -> tuple[Crop, list[_Length]]:
    """The part of the frames that was used, and the length of every video."""
    frame = json.loads(path.read_text(encoding="utf-8")).get("frame")
    if not frame or not frame.get("crop"):
        raise BadInput(f"{SUMMARY} does not say which part of the frames was used", where=SUMMARY)
    x0, y0, x1, y1 = frame["crop"]
    # Summaries did not always tell the video's length: what took part is known to be in it.
    last = max((int(row["source_index"]) for row in frames.values()), default=-1)
    end = max((float(row["time_s"]) for row in frames.values()), default=0.0)
    whole = _Length(frame.get("n_frames") or last + 1, frame.get("duration_s") or end)
    videos = [_Length(one["n_frames"], one["duration_s"]) for one in frame.get("videos", ())]
    return Crop(x0, y0, x1, y1, frame["width"], frame["height"]), videos or [whole]
