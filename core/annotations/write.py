"""Our own form of annotations, written: what `parse_annotations` reads back as the same entries."""

from __future__ import annotations

from fractions import Fraction

from core.annotations.clocks import FRAME_NUMBERS
from core.annotations.model import Annotations
from core.annotations.placed import PlacedAnnotations
from core.errors import BadInput
from core.json_files import JsonObject
from core.scene.detection import Detection, Mask
from core.video.table import FrameTable

_DECIMALS = 6
"""Of times: a millionth of a second is beyond every camera."""


def own_form(annotations: Annotations) -> JsonObject:
    """The entries under their own keys.

    Raises:
        BadInput: the keys are frame numbers, which mean a time only together with a video.
    """
    if any(clock in FRAME_NUMBERS for clock in annotations.clocks):
        raise BadInput(
            "the annotations name frames by their numbers; which times these are depends on the video, so name it, too",
            code="annotations_need_video",
            where="annotations",
        )
    return {entry.key: _entry(entry.detections, entry.masks) for entry in annotations.entries}


def own_form_on_frames(annotations: Annotations, placed: PlacedAnnotations, table: FrameTable) -> JsonObject:
    """The entries under the times of their frames, in seconds from the first frame.

    Two keys of one frame become one entry; keys outside the video are left out.
    """
    joined: dict[int, tuple[tuple[Detection, ...], tuple[Mask, ...]]] = {}
    for entry in annotations.entries:
        frame = placed.convention.reading.frames[entry.key]
        if frame is not None:
            detections, masks = joined.get(frame, ((), ()))
            joined[frame] = ((*detections, *entry.detections), (*masks, *entry.masks))
    return {_time(table.time(frame)): _entry(*joined[frame]) for frame in sorted(joined)}


def _time(seconds: Fraction) -> str:
    return f"{float(seconds):.{_DECIMALS}f}"


def _entry(detections: tuple[Detection, ...], masks: tuple[Mask, ...]) -> JsonObject:
    return {
        "detections": [_detection(one) for one in detections],
        "masks": [{"label": one.label, "polygon": _corners(one.polygon)} for one in masks],
    }


def _detection(one: Detection) -> JsonObject:
    found: JsonObject = {"label": one.label, "bbox": list(one.box)}
    for name, value in (("score", one.score), ("track_id", one.track_id)):
        if value is not None:
            found[name] = value
    if one.polygon is not None:
        found["polygon"] = _corners(one.polygon)
    return found


def _corners(polygon: tuple[tuple[float, float], ...]) -> list[list[float]]:
    return [[x, y] for x, y in polygon]
