"""From shapes on foreign pictures to our own entries: shares of the frame, checked and cut at its edges."""

from __future__ import annotations

from fractions import Fraction

from core.annotations.checks import as_label, as_score, as_track_id, shown
from core.annotations.foreign.sheet import Picture, Shape, Sheet, Size
from core.annotations.foreign.values import box_between
from core.annotations.masks import BLADE_LABEL
from core.annotations.model import Annotations, Entry
from core.annotations.parse import has_area
from core.errors import BadInput
from core.geometry.boxes import Box
from core.scene.detection import Detection, Mask, Polygon

MAX_OFF_PX = 1.0
"""What the height of a picture may differ from that of the frame scaled to its width: sizes are whole, often even."""
_BEYOND = 0.01
"""A shape that reaches farther beyond its picture, as a share, is worth a word; less is rounding by hand."""


def annotations_of(sheet: Sheet, frame: Size | None) -> Annotations:
    """Our own entries, in the order of their keys.

    Args:
        sheet: what a reader gave. What turns out to be of no use is counted in it.
        frame: width and height of the video's frames in pixels, when the video is known.

    Raises:
        BadInput: `annotations_other_size` (the pictures have not the shape of the frames), `annotations_need_video`
            (coordinates are in pixels, and neither the file nor a video says of how many), or a label, score or
            track that our own form could not hold either.
    """
    entries: list[Entry] = []
    next_id = 0
    timed = [(_time(picture.key), picture) for picture in sheet.pictures.values()]
    for time, picture in sorted(timed, key=lambda one: one[0]):
        unit = _unit(picture, frame)
        where = f"picture {shown(picture.name)}" if picture.shapes else ""
        detections: list[Detection] = []
        masks: list[Mask] = []
        for shape in picture.shapes:
            placed = _placed(shape, unit, sheet)
            if placed is None:
                continue
            box, polygon = placed
            label = as_label(shape.label, f"{where}: a label")
            if label.casefold() == BLADE_LABEL and polygon is not None:
                masks.append(Mask(label, polygon))
                continue
            score = as_score(shape.score, f"{where}: a score")
            track = as_track_id(shape.track_id, f"{where}: a track")
            detections.append(
                Detection(
                    id=next_id,
                    key=picture.key,
                    time_s=float(time),
                    label=label,
                    score=score,
                    box=box,
                    polygon=polygon,
                    track_id=track,
                )
            )
            next_id += 1
        entries.append(Entry(picture.key, time, tuple(detections), tuple(masks)))
    return Annotations(
        tuple(entries),
        (*sheet.left_out, *sheet.notes),
        tuple(sheet.left_out),
        clocks=sheet.clocks,
        n_frames=sheet.counted_frames,
    )


def _time(key: str) -> Fraction:
    return Fraction(int(key)) if key.isdecimal() else Fraction(key)


def _unit(picture: Picture, frame: Size | None) -> Size:
    if picture.size is not None and frame is not None and not same_shape(picture.size, frame):
        turned = "; they are turned by 90 degrees" if same_shape(picture.size[::-1], frame) else ""
        raise BadInput(
            f"the annotations were made on pictures of {picture.size[0]:g}x{picture.size[1]:g} pixels "
            f"({shown(picture.name)}), the frames of the video have {frame[0]:g}x{frame[1]:g}: their shapes "
            f"differ{turned}",
            code="annotations_other_size",
            where=shown(picture.name),
        )
    unit = picture.unit or frame
    if unit is None:
        raise BadInput(
            "the annotations are in pixels, and the file does not say of which size its pictures are; name the video "
            "as well",
            code="annotations_need_video",
            where=shown(picture.name),
        )
    return unit


def same_shape(one: Size, other: Size) -> bool:
    """Whether one size is the other one scaled, both rounded to whole pixels."""
    return (
        abs(other[1] * one[0] / other[0] - one[1]) <= MAX_OFF_PX
        or abs(other[0] * one[1] / other[1] - one[0]) <= MAX_OFF_PX
    )


def _placed(shape: Shape, unit: Size, sheet: Sheet) -> tuple[Box, Polygon | None] | None:
    """Box and outline in shares; None for what encloses nothing of its picture."""
    corners = shape.outline if shape.outline is not None and len(shape.outline) >= 3 else None
    box = shape.box if shape.box is not None else box_between(corners or ())
    if not shape.label.strip():
        sheet.drop("no label")
        return None
    if box is None or not (box[0] < box[2] and box[1] < box[3]):
        sheet.drop("no area")
        return None
    whole = (box[0] / unit[0], box[1] / unit[1], box[2] / unit[0], box[3] / unit[1])
    cut = (_cut(whole[0]), _cut(whole[1]), _cut(whole[2]), _cut(whole[3]))
    if not (cut[0] < cut[2] and cut[1] < cut[3]):
        sheet.drop("outside")
        return None
    if max(abs(a - b) for a, b in zip(whole, cut, strict=True)) > _BEYOND:
        sheet.note("shapes that reach beyond their picture were cut at its edge")
    if corners is None:
        return cut, None
    polygon = tuple((_cut(x / unit[0]), _cut(y / unit[1])) for x, y in corners)
    return cut, polygon if has_area(polygon) else None


def _cut(value: float) -> float:
    return min(1.0, max(0.0, value))
