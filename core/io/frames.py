"""The result of `frames` (images and three JSON files), and which of the frames `extend` registered."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

from core.json_files import read_json
from core.scene.frame import Crop, RunFrames, frames_of, image_name
from core.videos import unless_first

_FRAMES = "frames.json"
_DAMAGED = "damaged.json"
_CROP = "crop.json"
_IMAGES = "images"
_REGISTERED = "registered.json"


def write_frames(folder: Path, frames: RunFrames, crop: Crop, damaged: Sequence[int] = ()) -> None:
    """Write the frame table of the run, the indices of its damaged pictures and the part that was exported."""
    rows = [unless_first(frame.to_dict()) for frame in frames]
    (folder / _DAMAGED).write_text(json.dumps(list(damaged)) + "\n", encoding="utf-8")
    (folder / _FRAMES).write_text(json.dumps(rows, indent=1) + "\n", encoding="utf-8")
    (folder / _CROP).write_text(json.dumps(crop.to_dict()) + "\n", encoding="utf-8")


def read_frames(folder: Path) -> RunFrames:
    """The frame table of the run."""
    return frames_of(read_json(folder / _FRAMES))


def read_damaged(folder: Path) -> list[int]:
    """Indices of the frames whose pictures are damaged."""
    return [int(index) for index in read_json(folder / _DAMAGED)]


def read_crop(folder: Path) -> Crop:
    """The part of every frame that was exported."""
    return Crop(**read_json(folder / _CROP))


def images_folder(folder: Path) -> Path:
    """Folder of the exported images."""
    return folder / _IMAGES


def image_path(folder: Path, index: int) -> Path:
    """Exported image of a frame."""
    return images_folder(folder) / image_name(index)


def write_registered(folder: Path, indices: Sequence[int]) -> None:
    """Write which frames the final model has, in the result of `extend`."""
    (folder / _REGISTERED).write_text(json.dumps(list(indices)), encoding="utf-8")


def read_registered(folder: Path) -> list[int]:
    """Indices of the frames that the final model has, from the result of `extend`."""
    return [int(index) for index in read_json(folder / _REGISTERED)]
