"""Clean pictures of the frames of a run: what is drawn on them, the page draws itself.

They are written as shown (fields joined, pixels square), uncropped. A frame with a detection has its picture at the
source's size, any other at half of it; `full` keeps those too, for the stage that knows which views show a defect best.
A sprite has a thumbnail of every frame.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from core.errors import DiskFull, StageFailed
from core.outputs import SPRITE
from core.scene.detection import Detection
from core.scene.frame import RunFrames, image_name
from core.viewer.scene import FRAMES, FULL, DrawnDetection, Pictures, Sprite

U8 = NDArray[np.uint8]

HALF = 0.5
"""Scale of the picture of a frame without a detection."""
_TILE_WIDTH_PX = 96
_COLUMNS = 12
_MAX_SPRITE_PX = 65_500
"""JPEG knows no longer side than 65535 px."""
_QUALITY = 85
_SPRITE_QUALITY = 70


def drawn_detections(detections: Sequence[Detection], frames: RunFrames) -> dict[int, DrawnDetection]:
    """Frame and outline of every detection by its id."""
    return {
        one.id: DrawnDetection(None if one.source is None else frames.index_of_source.get(one.source), one.polygon)
        for one in detections
    }


def write_pictures(
    folder: Path,
    pictures: Iterator[tuple[int, U8]],
    detections: Mapping[int, DrawnDetection],
    damaged: Collection[int] = (),
) -> Pictures:
    """Write every picture, the sprite and `pictures.json`.

    Args:
        folder: existing; gets `frames/`, `full/` and the sprite.
        pictures: (index, (h, w, 3) RGB) of every frame of the run, in any order; all of one size.
        detections: where they are drawn.
        damaged: indices of frames whose pictures are damaged.

    Raises:
        StageFailed: there is no picture.
        DiskFull: one could not be written.
    """
    marked = {one.frame for one in detections.values()}
    (folder / FRAMES).mkdir()
    (folder / FULL).mkdir()
    scales: dict[int, float] = {}
    thumbnails: dict[int, U8] = {}
    width = height = 0
    for index, rgb in pictures:
        height, width = rgb.shape[:2]
        name = image_name(index)
        if index in marked:
            write_jpeg(folder / FRAMES / name, rgb)
            scales[index] = 1
        else:
            write_jpeg(folder / FULL / name, rgb)
            write_jpeg(folder / FRAMES / name, _resized(rgb, (max(1, width // 2), max(1, height // 2))))
            scales[index] = HALF
        thumbnails[index] = _resized(rgb, (_TILE_WIDTH_PX, max(1, round(_TILE_WIDTH_PX * height / width))))
    if not thumbnails:
        raise StageFailed("the run has no frame to show", where="pictures")
    tiles = {index: tile for tile, index in enumerate(sorted(thumbnails))}
    sprite = _write_sprite(folder / SPRITE, [thumbnails[index] for index in tiles])
    made = Pictures(
        width,
        height,
        dict(sorted(scales.items())),
        tiles if sprite is not None else {},
        sprite,
        tuple(sorted(damaged)),
        detections,
    )
    made.write(folder)
    return made


def _write_sprite(path: Path, thumbnails: Sequence[U8]) -> Sprite | None:
    """All thumbnails in one picture; None where it would be longer than a JPEG can be."""
    height, width = thumbnails[0].shape[:2]
    rows = -(-len(thumbnails) // _COLUMNS)
    if rows * height > _MAX_SPRITE_PX:
        return None
    sheet = np.zeros((rows * height, _COLUMNS * width, 3), np.uint8)
    for tile, thumbnail in enumerate(thumbnails):
        top, left = tile // _COLUMNS * height, tile % _COLUMNS * width
        sheet[top : top + height, left : left + width] = thumbnail
    write_jpeg(path, sheet, _SPRITE_QUALITY)
    return Sprite(width, height, _COLUMNS, len(thumbnails))


def _resized(rgb: U8, size: tuple[int, int]) -> U8:
    return np.asarray(cv2.resize(rgb, size, interpolation=cv2.INTER_AREA), np.uint8)


def write_jpeg(path: Path, rgb: U8, quality: int = _QUALITY) -> None:
    """Write (h, w, 3) RGB as JPEG, encoded in memory, because OpenCV's own file writing hides a full disk.

    Raises:
        DiskFull: it could not be encoded.
    """
    done, data = cv2.imencode(".jpg", np.ascontiguousarray(rgb[..., ::-1]), [cv2.IMWRITE_JPEG_QUALITY, quality])
    if not done:
        raise DiskFull(f"{path.name} could not be encoded", where="pictures")
    path.write_bytes(bytes(data))
