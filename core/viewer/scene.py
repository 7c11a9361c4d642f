"""What the stages `pictures` and `viewer` leave for the document that the page reads, and the names of their files."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

from core.json_files import JsonObject, read_json, write_json
from core.scene.defect import DefectRecord

FRAMES = "frames"
"""Folder of the pictures that are published."""
FULL = "full"
"""Folder of the pictures at the source's size of the frames that are published at half of it."""
PICTURES_FILE = "pictures.json"
SCENE_FILE = "scene.json"
BEST_FRAMES = 3
"""Views of a defect whose pictures are kept at the source's size."""


@dataclass(frozen=True)
class Sprite:
    """Thumbnails in one picture, row by row."""

    width: int
    """Of one tile, px."""
    height: int
    columns: int
    count: int


@dataclass(frozen=True)
class DrawnDetection:
    """Where a detection of the input is drawn."""

    frame: int | None
    """Frame of the run; None where none shows it."""
    polygon: tuple[tuple[float, float], ...] | None
    """Its outline in shares of the source frame."""


@dataclass(frozen=True)
class Pictures:
    """What `pictures` made: the pictures, by frame index, and where the detections are drawn."""

    width: int
    """Of a source frame, px."""
    height: int
    scales: Mapping[int, float]
    """Size of the published picture over that of the source frame."""
    tiles: Mapping[int, int]
    """Position in the sprite."""
    sprite: Sprite | None
    damaged: tuple[int, ...]
    detections: Mapping[int, DrawnDetection]

    def with_full(self, frames: Collection[int]) -> Pictures:
        """The same where the pictures of some frames were replaced by those at the source's size."""
        return replace(self, scales={**self.scales, **dict.fromkeys(frames, 1.0)})

    def write(self, folder: Path) -> None:
        """Write the form that `read` reads."""
        write_json(folder / PICTURES_FILE, asdict(self))

    @classmethod
    def read(cls, folder: Path) -> Pictures:
        """Read what `write` wrote."""
        row: JsonObject = read_json(folder / PICTURES_FILE)
        return cls(
            width=row["width"],
            height=row["height"],
            scales={int(index): scale for index, scale in row["scales"].items()},
            tiles={int(index): tile for index, tile in row["tiles"].items()},
            sprite=None if row["sprite"] is None else Sprite(**row["sprite"]),
            damaged=tuple(row["damaged"]),
            detections={int(number): _drawn(one) for number, one in row["detections"].items()},
        )


def _drawn(row: JsonObject) -> DrawnDetection:
    polygon = row["polygon"]
    return DrawnDetection(row["frame"], None if polygon is None else tuple((x, y) for x, y in polygon))


@dataclass(frozen=True)
class SurfaceFacts:
    """Of the surface that the page shows."""

    faces: int
    published_faces: int
    """Of the published surface that it was made from."""
    spacing: float
    """Typical distance between neighbouring points of the published surface, scene units."""


@dataclass(frozen=True)
class ViewerScene:
    """One model as the page shows it."""

    camera: JsonObject
    """COLMAP's model and parameters for pixels of the whole source frame, and the part of it that was used."""
    poses: Mapping[int, Sequence[float]]
    """cam_from_world by frame index: 12 numbers, row by row."""
    up: Sequence[float] | None
    surface: SurfaceFacts
    nodes: tuple[int, ...]
    """Defects that have a node of their own."""
    portraits: tuple[int, ...]
    """Defects that have a picture of the surface."""
    full: tuple[int, ...]
    """Frames whose pictures lie beside this model's surface, at the source's size."""

    def write(self, folder: Path) -> None:
        """Write the form that `read` reads."""
        write_json(folder / SCENE_FILE, asdict(self))

    @classmethod
    def read(cls, folder: Path) -> ViewerScene:
        """Read what `write` wrote."""
        row: JsonObject = read_json(folder / SCENE_FILE)
        return cls(
            camera=row["camera"],
            poses={int(index): pose for index, pose in row["poses"].items()},
            up=row["up"],
            surface=SurfaceFacts(**row["surface"]),
            nodes=tuple(row["nodes"]),
            portraits=tuple(row["portraits"]),
            full=tuple(row["full"]),
        )


def best_frames(record: DefectRecord) -> list[int]:
    """Indices of the views that show a defect best: those that detected it first, at most `BEST_FRAMES`."""
    detected = [view.frame_index for view in record.frames if view.detected]
    other = [view.frame_index for view in record.frames if not view.detected]
    return [*detected, *other][:BEST_FRAMES]
