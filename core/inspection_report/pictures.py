"""Which pictures show a finding: the best frame, a part of it close up, and the surface.

They are files of the inspector's page. What is drawn on them is told in shares of the picture, so that every form of
the report draws it itself and no picture is changed.
"""

from __future__ import annotations

import posixpath
from collections.abc import Collection, Iterable, Sequence

from core.inspection_report.source import ReportSource
from core.json_files import JsonObject
from core.outputs import VIEWER, path_of_model

CLOSE_UP = 4.0
"""The close-up's height over the longer side of the finding's box."""
MIN_SIDE_SHARE = 0.12
"""It shows at least this share of the frame's height."""
Box = tuple[float, float, float, float]
"""x1, y1, x2, y2."""


def finding_pictures(source: ReportSource, record: JsonObject, model: int) -> JsonObject:
    """Frame, close-up and surface of a finding; null where the result keeps no such picture.

    Returns:
        ``frame`` and ``close_up`` of one file, with ``boxes`` and ``window`` (x, y, width, height) in shares of the
        picture, and ``surface``.
    """
    page = source.pages.get(model)
    if page is None:
        return {"frame": None, "close_up": None, "surface": None}
    own = next((one for one in page["defects"] if one["id"] == record["id"]), None)
    address = None if own is None else own.get("surface_picture")
    surface: JsonObject | None = (
        None if address is None else {"file": _published(address, model), "boxes": [], "window": None}
    )
    frame = None if own is None else _best_frame(page, own)
    if frame is None:
        return {"frame": None, "close_up": None, "surface": surface}
    video = page["videos"][frame["video"]]
    width, height = float(video["width"]), float(video["height"])
    boxes = [_in_shares(box, width, height) for box in _boxes(page, record["detections"], frame["index"])]
    # Further models' pictures lie with the first model's page, unless they are their own best views.
    picture = {
        "file": _published(frame["picture"], model),
        "aspect": width / height,
        "time_s": frame["time_s"],
        "source_index": frame["source_index"],
        "boxes": [list(box) for box in boxes],
    }
    at = own["best"] if own is not None and own.get("best") else {}
    known = at.get("x") is not None and at["frame"] == frame["index"]
    place = (float(at["x"]), float(at["y"])) if known else None
    window = _window(boxes, place, width / height)
    close_up = None if window is None else {**picture, "window": list(window)}
    return {"frame": {**picture, "window": None}, "close_up": close_up, "surface": surface}


def files_of(findings: Iterable[JsonObject]) -> list[str]:
    """Published paths of all pictures of findings, each once, in order."""
    shown = [picture["file"] for one in findings for picture in one["pictures"].values() if picture is not None]
    return list(dict.fromkeys(shown))


def _best_frame(page: JsonObject, own: JsonObject) -> JsonObject | None:
    """The first of its best frames that has a picture; where nothing tells where to look in that, one that shows a
    detection of it."""
    frames = {one["index"]: one for one in page["frames"] if one["picture"] is not None}
    boxed = [one["frame"] for one in page["detections"] if one["id"] in own["detections"]]
    best = [index for index in own["best_frames"] if index in frames]
    placed = (own.get("best") or {}).get("x") is not None
    wanted = best if placed else [*(index for index in best if index in boxed), *boxed, *best]
    return next((frames[index] for index in wanted if index in frames), None)


def _boxes(page: JsonObject, detections: Collection[int], frame: int) -> list[Sequence[float]]:
    """Boxes of these detections in a frame, px of the source frame.

    A row of the table names one defect alone; what two models show is in the lists of detections of both.
    """
    return [one["box"] for one in page["detections"] if one["id"] in detections and one["frame"] == frame]


def _in_shares(box: Sequence[float], width: float, height: float) -> Box:
    x1, y1, x2, y2 = (float(value) for value in box)
    return _kept(x1 / width), _kept(y1 / height), _kept(x2 / width), _kept(y2 / height)


def _kept(share: float) -> float:
    return round(min(1.0, max(0.0, share)), 5)


def _window(boxes: Sequence[Box], place: tuple[float, float] | None, aspect: float) -> Box | None:
    """The part of a picture around a finding's boxes, else its place, of the frame's own shape.

    Gives x, y, width and height in shares; None where the finding has neither.
    """
    if not boxes and place is None:
        return None
    x1, y1, x2, y2 = _around(boxes) if boxes else (*place, *place)  # type: ignore[misc]  # one of both is known
    longest = max((x2 - x1) * aspect, y2 - y1)  # in heights of the frame
    share = min(max(CLOSE_UP * longest, MIN_SIDE_SHARE), 1.0)
    left = min(max((x1 + x2 - share) / 2, 0.0), 1.0 - share)
    top = min(max((y1 + y2 - share) / 2, 0.0), 1.0 - share)
    return round(left, 5), round(top, 5), round(share, 5), round(share, 5)


def _around(boxes: Sequence[Box]) -> Box:
    return (
        min(box[0] for box in boxes),
        min(box[1] for box in boxes),
        max(box[2] for box in boxes),
        max(box[3] for box in boxes),
    )


def _published(address: str, model: int) -> str:
    """Published path of a picture by its address relative to the page of a model."""
    return posixpath.normpath(posixpath.join(path_of_model(model, VIEWER), address))
