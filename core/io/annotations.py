"""``detections.json``, ``masks.json`` and ``looked_at.json``: detections of the input, and the rows of placed ones."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from core.json_files import read_json, write_json
from core.scene.detection import Detection, DetectionRow, Mask
from core.scene.frame import SourceFrame
from core.videos import count_videos, folder_of_video, unless_first

_DETECTIONS = "detections.json"
"""Of `annotations` the detections as read, of `map_defects` and `timeline` the rows of the published table."""
_MASKS = "masks.json"
_LOOKED_AT = "looked_at.json"


def write_annotations(
    folder: Path,
    detections: Iterable[Detection],
    masks: Mapping[SourceFrame, Sequence[Mask]],
    looked_at: Iterable[SourceFrame],
    n_videos: int = 1,
) -> None:
    """Write the result of `annotations`.

    Args:
        folder: of the result.
        detections: by id.
        masks: by source frame.
        looked_at: source frames that have a key, with detections or without.
        n_videos: videos of the run.
    """
    _write(folder / _DETECTIONS, [unless_first(detection.to_dict()) for detection in detections])
    seen = sorted(looked_at)
    for video in range(n_videos):
        own = folder_of_video(folder, video)
        own.mkdir(exist_ok=True)
        marked = sorted(source for source in masks if source.video == video)
        _write(own / _MASKS, {str(s.source_index): [dict(mask.__dict__) for mask in masks[s]] for s in marked})
        _write(own / _LOOKED_AT, [source.source_index for source in seen if source.video == video])


def read_detections(folder: Path) -> list[Detection]:
    """Detections of the input by id, from the result of `annotations`."""
    return [Detection.from_dict(row) for row in read_json(folder / _DETECTIONS)]


def read_masks(folder: Path) -> dict[SourceFrame, tuple[Mask, ...]]:
    """Masks by source frame, from the result of `annotations`."""
    return {
        SourceFrame(video, int(index)): tuple(
            Mask(mask["label"], tuple((x, y) for x, y in mask["polygon"])) for mask in masks
        )
        for video in range(count_videos(folder))
        for index, masks in read_json(folder_of_video(folder, video) / _MASKS).items()
    }


def read_looked_at(folder: Path) -> list[SourceFrame]:
    """Source frames that the detector saw, from the result of `annotations`."""
    return [
        SourceFrame(video, int(index))
        for video in range(count_videos(folder))
        for index in read_json(folder_of_video(folder, video) / _LOOKED_AT)
    ]


def write_rows(folder: Path, rows: Iterable[DetectionRow]) -> None:
    """Write the rows of all detections, of `map_defects` or `timeline`."""
    write_json(folder / _DETECTIONS, [row.to_dict() for row in rows])


def read_rows(folder: Path) -> list[DetectionRow]:
    """Read what `write_rows` wrote."""
    return [DetectionRow.from_dict(row) for row in read_json(folder / _DETECTIONS)]


def _write(path: Path, value: Any) -> None:
    """Compact JSON: an annotation file with masks has megabytes of corners."""
    path.write_text(json.dumps(value, separators=(",", ":"), allow_nan=False) + "\n", encoding="utf-8")
