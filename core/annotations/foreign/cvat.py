"""CVAT: its XML for videos and for pictures, and the JSON of its backups."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from xml.etree.ElementTree import Element

from core.annotations.checks import invalid, shown
from core.annotations.foreign.bitmaps import largest, row_outlines
from core.annotations.foreign.sheet import FROM_ZERO, Points, Shape, Sheet, Size, frame_number, number_in_name
from core.annotations.foreign.tracks import Keyframe, turned, unfolded
from core.annotations.foreign.values import (
    box_between,
    needed_size,
    number,
    numbers,
    objects,
    pairs,
    text,
    track_of,
    whole,
)
from core.errors import BadInput
from core.geometry.boxes import Box
from core.json_files import JsonObject

DROPS = {
    "ellipse": "ellipse",
    "polyline": "polyline",
    "points": "set of points",
    "cuboid": "cuboid",
    "skeleton": "skeleton",
    "tag": "tag",
    "mask": "mask that cannot be unpacked",
    "part": "further part of an outline",
}
_READ = ("box", "polygon", "mask")
_STEP = re.compile(r"step\s*=\s*([0-9]{1,6})")


def recognises_xml(root: Element) -> bool:
    """Whether an XML document is of CVAT."""
    return root.tag == "annotations" and any(child.tag in ("version", "meta", "track", "image") for child in root)


def read_xml(root: Element, name: str, sheet: Sheet, beside: Sequence[object] = ()) -> None:
    """Read tracks (frame numbers are those of the video, from 0) or pictures (known by their names)."""
    meta = root.find("meta")
    sizes = [] if meta is None else [_original(one) for one in meta.iter("original_size")]
    tracks, images = root.findall("track"), root.findall("image")
    tasks = {one.get("task_id") for one in (*tracks, *images)}
    if len(tasks) > 1:
        raise BadInput(
            f"the annotations are of {len(tasks)} tasks of CVAT; export one task for each video",
            code="annotations_several_videos",
            where="task_id",
        )
    for child in root:
        if child.tag == "tag":
            sheet.drop("tag")
    for image in images:
        _picture(image, sheet)
    if images:
        return
    sheet.clocks = FROM_ZERO
    found = _STEP.search("" if meta is None else meta.findtext(".//frame_filter") or "")
    step = max(1, int(found[1])) if found else 1
    size = sizes[0] if sizes else None
    for i, track in enumerate(tracks):
        where = f"track {shown(track.get('id', str(i)))}"
        label, name_of = track.get("label", ""), track_of(track.get("id"))
        _add_track(_drawn(track, where, sheet), label, name_of, step, size, sheet, where)


def _original(element: Element) -> Size:
    return needed_size(element.findtext("width"), element.findtext("height"), "original_size")


def _picture(image: Element, sheet: Sheet) -> None:
    name = image.get("name", "")
    where = f"image {shown(name)}"
    size = needed_size(image.get("width"), image.get("height"), where)
    key = number_in_name(name) if re.search(r"[0-9]", name.rpartition("/")[2]) else _frame(image.get("id"), where)
    shapes = [
        Shape(shape.get("label", ""), *_with_turn(box, outline, rotation))
        for shape, box, outline, rotation in _geometry(image, where, sheet)
    ]
    sheet.add(key, name, shapes, unit=size, size=size)


def _drawn(track: Element, where: str, sheet: Sheet) -> list[Keyframe]:
    return [
        Keyframe(
            int(_frame(shape.get("frame"), where)),
            box,
            rotation,
            outline,
            follows=shape.get("outside") != "1",
            there=shape.get("outside") != "1",
        )
        for shape, box, outline, rotation in _geometry(track, where, sheet)
    ]


def _geometry(parent: Element, where: str, sheet: Sheet) -> Iterator[tuple[Element, Box, Points | None, float]]:
    for shape in parent:
        if shape.tag not in _READ:
            if shape.tag in DROPS:
                sheet.drop(shape.tag)
            continue
        if shape.tag == "box":
            x1, y1, x2, y2 = (number(shape.get(side), f"{where}: {side}") for side in ("xtl", "ytl", "xbr", "ybr"))
            yield shape, (x1, y1, x2, y2), None, number(shape.get("rotation", "0"), f"{where}: rotation")
            continue
        outline = _mask(shape, where, sheet) if shape.tag == "mask" else _polygon(shape, where)
        box = box_between(outline)
        if box is not None:
            yield shape, box, outline, 0.0


def _polygon(shape: Element, where: str) -> Points:
    flat = re.split(r"[;,]", shape.get("points", ""))
    return pairs([number(one, f"{where}: points") for one in flat], f"{where}: points")


def _mask(shape: Element, where: str, sheet: Sheet) -> Points:
    left, top, width, height = (whole(shape.get(m), f"{where}: {m}") for m in ("left", "top", "width", "height"))
    counts = [whole(one, f"{where}: rle") for one in (shape.get("rle") or "").split(",")]
    return largest(lambda: row_outlines(counts, height, width, (left, top), sheet.spend), sheet)


def _with_turn(box: Box, outline: Points | None, rotation: float) -> tuple[Box | None, Points | None]:
    corners = turned(box, rotation)
    return (box, outline) if corners is None else (None, corners)


def _add_track(
    keyframes: Sequence[Keyframe],
    label: str,
    track_id: str | int | None,
    step: int,
    size: Size | None,
    sheet: Sheet,
    where: str,
    end: int | None = None,
) -> None:
    for one in keyframes:
        if not one.there:  # somebody looked at this frame and said that the thing is gone
            sheet.add(str(one.frame), f"frame {one.frame}", unit=size, size=size)
    for one in unfolded(keyframes, step, end, where):
        shape = Shape(label, *_with_turn(one.box, one.outline, one.rotation_deg), track_id=track_id)
        sheet.add(str(one.frame), f"frame {one.frame}", [shape], unit=size, size=size)


def _frame(value: object, where: str) -> str:
    return frame_number(whole(value, f"{where}: frame"), f"{where}: frame")


def recognises_json(document: object) -> bool:
    """Whether a JSON value is the annotations of a CVAT backup: one object for each job, or one of a task."""
    jobs = document if isinstance(document, list) else [document]
    return bool(jobs) and all(
        isinstance(job, dict) and isinstance(job.get("shapes"), list) and isinstance(job.get("tracks"), list)
        for job in jobs
    )


def read_json(
    document: JsonObject | list[JsonObject], name: str, sheet: Sheet, beside: Sequence[JsonObject] = ()
) -> None:
    """Read shapes and tracks; frames count the pictures of the task, whose first one and step its `task.json` says."""
    task: JsonObject = next((one["data"] for one in beside if _is_task(one)), {})
    start = whole(task.get("start_frame", 0), "data.start_frame")
    found = _STEP.search(text(task.get("frame_filter"), "data.frame_filter"))
    step = max(1, int(found[1])) if found else 1
    stop = task.get("stop_frame")
    end = None if not stop else whole(stop, "data.stop_frame")
    if not task:
        sheet.note("CVAT's frames were counted from the first one of the video, because no task.json is beside them")
    sheet.clocks = FROM_ZERO
    jobs = document if isinstance(document, list) else [document]
    for j, job in enumerate(jobs):
        if job.get("tags"):
            sheet.drop("tag", len(objects(job["tags"], f"[{j}].tags")))
        for i, shape in enumerate(objects(job["shapes"], f"[{j}].shapes")):
            where = f"[{j}].shapes[{i}]"
            for one in _json_keyframes([shape], start, step, where, sheet):
                drawn = Shape(text(shape.get("label"), where), *_with_turn(one.box, one.outline, one.rotation_deg))
                sheet.add(str(one.frame), f"frame {one.frame}", [drawn], unit=None)
        for i, track in enumerate(objects(job["tracks"], f"[{j}].tracks")):
            where = f"[{j}].tracks[{i}]"
            keyframes = _json_keyframes(objects(track.get("shapes"), f"{where}.shapes"), start, step, where, sheet)
            if end is None and keyframes and keyframes[-1].follows:
                sheet.note("tracks of CVAT without an end were read up to their last keyframe")
            _add_track(keyframes, text(track.get("label"), where), i, step, None, sheet, where, end)


def _is_task(value: object) -> bool:
    return isinstance(value, dict) and isinstance(value.get("data"), dict) and "jobs" in value


def _json_keyframes(shapes: Iterable[JsonObject], start: int, step: int, where: str, sheet: Sheet) -> list[Keyframe]:
    found = []
    for shape in shapes:
        kind = text(shape.get("type"), f"{where}.type")
        frame = start + step * int(_frame(shape.get("frame"), where))
        if kind not in ("rectangle", "polygon", "mask"):
            sheet.drop(kind if kind in DROPS else "points")
            continue
        flat = numbers(shape.get("points"), f"{where}.points", 4 if kind == "rectangle" else None)
        outline = _json_mask(flat, where, sheet) if kind == "mask" else pairs(flat, f"{where}.points")
        box = box_between(outline)
        if box is None:
            continue
        gone = bool(shape.get("outside"))
        rotation = number(shape.get("rotation") or 0, f"{where}.rotation")
        found.append(Keyframe(frame, box, rotation, None if kind == "rectangle" else outline, not gone, not gone))
    return found


def _json_mask(flat: list[float], where: str, sheet: Sheet) -> Points:
    """Runs by rows, then the first and last column and row that they fill."""
    if len(flat) < 5:
        raise invalid(f"{where}.points", "holds no runs and corners of a mask")
    *runs, left, top, right, bottom = (whole(one, f"{where}.points") for one in flat)
    return largest(lambda: row_outlines(runs, bottom - top + 1, right - left + 1, (left, top), sheet.spend), sheet)
