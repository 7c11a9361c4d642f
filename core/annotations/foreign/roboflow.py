"""Roboflow: answers of its inference on pictures and on videos."""

from __future__ import annotations

from collections.abc import Sequence

from core.annotations.checks import as_list, as_object
from core.annotations.foreign.sheet import FROM_ZERO, SECONDS, Shape, Sheet, frame_number, number_in_name, seconds_key
from core.annotations.foreign.values import centre_box, number, numbers, objects, points, size_of, text, track_of, whole
from core.json_files import JsonObject

DROPS = {"keypoints": "set of keypoints", "class": "class of a whole picture", "frame": "frame without a list"}
_NO_MODELS = ("time_offset", "frame_offset", "fps")


def recognises(document: object) -> bool:
    """Whether a JSON value is an answer of Roboflow's inference."""
    if not isinstance(document, dict):
        return False
    if "time_offset" in document or "frame_offset" in document:
        return any(isinstance(value, list) for name, value in document.items() if name not in _NO_MODELS)
    return isinstance(document.get("predictions"), list) and isinstance(document.get("image"), dict)


def read(document: JsonObject, name: str, sheet: Sheet, beside: Sequence[object] = ()) -> None:
    """Read the frames of a video, or one picture whose number is in the file's name. All were looked at."""
    if "predictions" in document:
        _add(number_in_name(name), name, document, name, sheet)
        return
    if document.get("frame_offset") is not None:
        sheet.clocks = FROM_ZERO
        offsets = numbers(document["frame_offset"], "frame_offset")
        keys = [frame_number(whole(one, "frame_offset"), "frame_offset") for one in offsets]
    else:
        sheet.clocks = SECONDS
        keys = [seconds_key(one) for one in numbers(document["time_offset"], "time_offset")]
    for model, frames in document.items():
        if model in _NO_MODELS or not isinstance(frames, list):
            continue
        sheet.drop("frame", max(0, len(keys) - len(frames)))
        for i, (key, frame) in enumerate(zip(keys, frames, strict=False)):
            answer = {"predictions": frame} if isinstance(frame, list) else as_object(frame, f"{model}[{i}]")
            _add(key, f"frame {key}", answer, f"{model}[{i}]", sheet)


def _add(key: str, name: str, answer: JsonObject, where: str, sheet: Sheet) -> None:
    image = as_object(answer.get("image") or {}, f"{where}.image")
    size = size_of(image.get("width"), image.get("height"), f"{where}.image")
    sheet.add(key, name, unit=size, size=size)
    predictions = as_list(answer.get("predictions") or [], f"{where}.predictions")
    for i, one in enumerate(objects(predictions, f"{where}.predictions")):
        here = f"{where}.predictions[{i}]"
        if "x" not in one:
            sheet.drop("class")
            continue
        if one.get("keypoints"):
            sheet.drop("keypoints")
        x, y, width, height = (number(one.get(member), f"{here}.{member}") for member in ("x", "y", "width", "height"))
        score = one.get("confidence")
        shape = Shape(
            text(one.get("class"), f"{here}.class"),
            centre_box(x, y, width, height),
            points(one["points"], f"{here}.points") if one.get("points") else None,
            None if score is None else number(score, f"{here}.confidence"),
            track_of(one.get("tracker_id")),
        )
        sheet.add(key, name, [shape], unit=size, size=size)
