"""Label Studio: its JSON and JSON-MIN exports of videos and pictures."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from urllib.parse import unquote

from core.annotations.checks import as_list, as_object, shown
from core.annotations.foreign.bitmaps import label_studio_outlines, largest
from core.annotations.foreign.sheet import FROM_ONE, PERCENT, Points, Shape, Sheet, Size, frame_number, number_in_name
from core.annotations.foreign.tracks import Keyframe, turned, unfolded
from core.annotations.foreign.values import (
    box_between,
    corner_box,
    number,
    objects,
    points,
    size_of,
    text,
    track_of,
    whole,
)
from core.errors import BadInput
from core.json_files import JsonObject

DROPS = {
    "ellipse": "ellipse",
    "keypoint": "keypoint",
    "vector": "vector",
    "choice": "answer without a shape",
    "mask": "mask that cannot be unpacked",
    "part": "further part of an outline",
    "annotator": "annotation of a further annotator",
    "timeline": "stretch of a timeline",
}
_BASES = {
    "videorectangle": "videorectangle",
    "rectangle": "rectangle",
    "polygon": "polygon",
    "brush": "brush",
    "ellipse": "ellipse",
    "keypoint": "keypoint",
    "vector": "vector",
    "timeline": "timeline",
}
_LABELS = re.compile(r"(.*)labels$")
_MAX_SOURCE = 4096
"""Longest address of a picture or video."""
_PICTURE = re.compile(r"\.(jpe?g|png|bmp|tiff?|webp|gif)(\?.*)?$", re.IGNORECASE)


def recognises(document: object) -> bool:
    """Whether a JSON value is an export of Label Studio, or one task of it."""
    tasks = document if isinstance(document, list) else [document]
    return bool(tasks) and all(isinstance(task, dict) and (_is_task(task) or bool(_short(task))) for task in tasks)


def _is_task(task: JsonObject) -> bool:
    if not isinstance(task.get("data"), dict):
        return False
    return isinstance(task.get("annotations"), list) or isinstance(task.get("predictions"), list)


def _short(task: JsonObject) -> list[JsonObject]:
    """Values of the regions of a task of JSON-MIN, which has them beside its data."""
    found = []
    for value in task.values():
        for one in value if isinstance(value, list) else []:
            if isinstance(one, dict) and ("sequence" in one or ("original_width" in one and _label_member(one))):
                found.append(one)
    return found


def _label_member(value: JsonObject) -> str:
    return next((name for name in value if name == "labels" or _LABELS.fullmatch(name)), "")


def read(document: JsonObject | list[JsonObject], name: str, sheet: Sheet, beside: Sequence[object] = ()) -> None:
    """Read every task: one video, or pictures with numbers in their names. A task that was done was looked at."""
    tasks = document if isinstance(document, list) else [document]
    videos = set()
    for t, task in enumerate(tasks):
        where = f"[{t}]"
        data = task["data"] if _is_task(task) else task
        source = _source(data)
        results = list(_results(task, where, sheet))
        if not _PICTURE.search(source):
            if results:
                videos.add(source)
            if len(videos) > 1:
                raise BadInput(
                    f"the annotations are of several videos ({', '.join(shown(one) for one in sorted(videos))}); "
                    "export one task for each",
                    code="annotations_several_videos",
                    where=where,
                )
            _video(results, where, sheet)
        elif _is_task(task) and not _work(task, where)[0]:
            continue  # nobody has looked at it yet, or whoever did has skipped it
        else:
            _picture(results, source, where, sheet)


def _source(data: JsonObject) -> str:
    """The file of a task: of several members the first that names a picture or a video."""
    texts = [one for one in data.values() if isinstance(one, str) and len(one) <= _MAX_SOURCE]
    named = [one for one in texts if _PICTURE.search(one) or "/" in one]
    return next(iter([*named, *texts]), "")


def _file_of(source: str) -> str:
    """The path of a picture in its address: files of the server's own disk stand after ``?d=``."""
    path, _, query = source.partition("?")
    return unquote(query.removeprefix("d=") if query.startswith("d=") else path)


def _results(task: JsonObject, where: str, sheet: Sheet) -> Iterator[tuple[JsonObject, float | None]]:
    """Regions of the first annotation that was not cancelled, else of the first prediction, with their scores."""
    if not _is_task(task):
        for value in _short(task):
            yield {"type": _label_member(value) if "sequence" not in value else "videorectangle", "value": value}, None
        return
    chosen, done = _work(task, where)
    if len(chosen) > 1:
        sheet.drop("annotator", len(chosen) - 1)
    for one in chosen[:1]:
        for region in objects(one.get("result"), f"{where}.result"):
            score = region.get("score", None if done else one.get("score"))
            yield region, None if score is None else number(score, f"{where}.score")


def _work(task: JsonObject, where: str) -> tuple[list[JsonObject], bool]:
    """Annotations that were not cancelled, and True; without any the predictions, and False."""
    annotations = objects(task.get("annotations"), f"{where}.annotations")
    done = [one for one in annotations if not one.get("was_cancelled")]
    return (done, True) if done else (objects(task.get("predictions"), f"{where}.predictions"), False)


def _kind(region: JsonObject) -> str:
    kind = text(region.get("type"), "type")
    found = _LABELS.fullmatch(kind)
    return _BASES.get(found[1] if found else kind, "" if kind == "labels" else "choice")


def _names(results: Sequence[tuple[JsonObject, float | None]]) -> dict[object, str]:
    """Labels that stand in results of their own, by the id of their region."""
    return {str(one.get("id")): _own_label(one) for one, _ in results if _own_label(one)}


def _own_label(region: JsonObject) -> str:
    value = region.get("value")
    if not isinstance(value, dict):
        return ""
    labels = value.get(_label_member(value))
    return str(labels[0]) if isinstance(labels, list) and labels and isinstance(labels[0], str) else ""


def _video(results: Sequence[tuple[JsonObject, float | None]], where: str, sheet: Sheet) -> None:
    sheet.clocks = FROM_ONE
    names = _names(results)
    for i, (region, score) in enumerate(results):
        kind, here = _kind(region), f"{where}.result[{i}]"
        if kind != "videorectangle":
            if kind:
                sheet.drop(kind if kind in DROPS else "choice")
            continue
        value = as_object(region.get("value"), f"{here}.value")
        keyframes = [_keyframe(one, here) for one in objects(value.get("sequence"), f"{here}.sequence")]
        if any(one.rotation_deg for one in keyframes):
            sheet.note("turned boxes of videos of Label Studio were read upright")
        last = value.get("framesCount")
        last = None if last is None else whole(last, f"{here}.framesCount")
        sheet.counted_frames = sheet.counted_frames or last
        track = track_of(region.get("id"))
        label = _own_label(region) or names.get(str(region.get("id")), "")
        for one in unfolded(keyframes, 1, last, here):
            drawn = Shape(label, one.box, score=score, track_id=i if track is None else track)
            sheet.add(str(one.frame), f"frame {one.frame}", [drawn], unit=PERCENT)


def _keyframe(one: JsonObject, where: str) -> Keyframe:
    x, y, width, height = (number(one.get(m), f"{where}.sequence: {m}") for m in ("x", "y", "width", "height"))
    frame = int(frame_number(whole(one.get("frame"), f"{where}.sequence: frame"), f"{where}.sequence: frame"))
    rotation = number(one.get("rotation") or 0, f"{where}.sequence: rotation")
    return Keyframe(frame, corner_box(x, y, width, height), rotation, follows=one.get("enabled") is not False)


def _picture(results: Sequence[tuple[JsonObject, float | None]], source: str, where: str, sheet: Sheet) -> None:
    key, names = number_in_name(_file_of(source)), _names(results)
    sheet.add(key, source, unit=PERCENT)
    for i, (region, score) in enumerate(results):
        kind, here = _kind(region), f"{where}.result[{i}]"
        if kind not in ("rectangle", "polygon", "brush"):
            if kind:
                sheet.drop(kind if kind in DROPS else "choice")
            continue
        value = as_object(region.get("value"), f"{here}.value")
        width, height = (region.get(m, value.get(m)) for m in ("original_width", "original_height"))
        size = size_of(width, height, here)
        label = _own_label(region) or names.get(str(region.get("id")), "")
        box, outline = _geometry(kind, value, size, here, sheet)
        picture = sheet.pictures[key]
        picture.size = picture.size or size
        sheet.add(key, source, [Shape(label, box, outline, score)], unit=PERCENT)


def _geometry(
    kind: str, value: JsonObject, size: Size | None, where: str, sheet: Sheet
) -> tuple[tuple[float, float, float, float] | None, Points | None]:
    """Box and outline in percent."""
    if kind == "polygon":
        outline = points(value.get("points"), f"{where}.points")
        return box_between(outline), outline
    if kind == "brush":
        outline = _brush(value, size, where, sheet)
        return (box_between(outline), outline) if outline else (None, None)
    x, y, width, height = (number(value.get(m), f"{where}.{m}") for m in ("x", "y", "width", "height"))
    box = corner_box(x, y, width, height)
    rotation = number(value.get("rotation") or 0, f"{where}.rotation")
    if not rotation:
        return box, None
    # A turn is one of pixels: percents of width and height are of different lengths.
    aspect = size[0] / size[1] if size else 1.0
    wide = turned((box[0] * aspect, box[1], box[2] * aspect, box[3]), rotation, (box[0] * aspect, box[1]))
    return None, tuple((cx / aspect, cy) for cx, cy in wide or ())


def _brush(value: JsonObject, size: Size | None, where: str, sheet: Sheet) -> Points:
    packed = as_list(value.get("rle"), f"{where}.rle")
    width, height = size or (0, 0)
    corners = largest(lambda: label_studio_outlines(packed, int(height), int(width), sheet.spend), sheet)
    return tuple((x * 100 / width, y * 100 / height) for x, y in corners)
