"""viewer.json: everything that the page shows of one model, in one object (docs/viewer.md says what its members mean).

It repeats what the tables say and computes nothing that they do not; texts come from the annotation file or the caller
and are not cleaned here: the page shows them as text.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum

from core.advice import FLAG_ADVICE
from core.flags import Verdict
from core.json_files import JsonObject
from core.outputs import PORTRAITS, SPRITE, SURFACE_GLB, VIEWER, VIEWER_PAGE, path_of_model, portrait_name
from core.report.build import Report
from core.report.record import Item
from core.scene.defect import MODEL_UNIT, DefectRecord, least_defects
from core.scene.detection import REASONS, Outcome
from core.scene.frame import image_name
from core.scene.on_row import blade_name
from core.viewer.scene import FRAMES, Pictures, ViewerScene, best_frames

SCHEMA_VERSION = 1
_TIME_DECIMALS = 4
"""Of the time of a frame in seconds, which the page shows to the hundredth."""
UNKNOWN_ROW: JsonObject = {"status": "unknown", "reason": "not_computed"}


class FrameReason(StrEnum):
    """Why a frame has no pose in the model that the page shows."""

    NOT_REGISTERED = "not_registered"
    IN_ANOTHER_MODEL = "in_another_model"
    DAMAGED_PICTURE = "damaged_picture"
    NO_MODEL = "no_model"


FRAME_REASONS: Mapping[FrameReason, str] = {
    FrameReason.NOT_REGISTERED: "the frame took part and could not be registered in the model",
    FrameReason.IN_ANOTHER_MODEL: "the frame is registered in another model of this result",
    FrameReason.DAMAGED_PICTURE: "the decoder complains of the picture; it gives no keypoints",
    FrameReason.NO_MODEL: "the run has no model that can be trusted",
}
"""What each reason means, for people."""


@dataclass(frozen=True)
class ViewerSource:
    """What the page of one model is made of."""

    report: Report
    scene: ViewerScene | None
    """None = the model has no surface to show."""
    pictures: Pictures | None
    """None = there are no clean pictures."""
    model: int = 0
    models: tuple[int, ...] = (0,)
    """Numbers of all models that have a page."""
    row: Item | None = None
    """The object of row.json."""
    sigmas: Mapping[int, float | None] | None = None
    """Standard deviation of the place of a detection, by id, model units."""
    no_pictures: str | None = None
    """A sentence that says why there are none."""

    @property
    def trusted(self) -> bool:
        """Whether places may be shown."""
        return self.report.verdict != Verdict.REFUSED

    @property
    def shown_scene(self) -> ViewerScene | None:
        """The scene, unless the run was refused."""
        return self.scene if self.trusted else None


def page_of(model: int, seen_from: int) -> str:
    """Address of the page of a model relative to that of another."""
    up = "../../../" if seen_from else "../"
    return up + path_of_model(model, VIEWER_PAGE)


def viewer_document(source: ViewerSource) -> JsonObject:
    """The object of viewer.json."""
    report, scene = source.report, source.shown_scene
    frame = report.summary.get("frame") or {}
    size = _size(source, frame)
    scale = _scale(source)
    own = [record for record in report.defects if int(record.get("model") or 0) == source.model]
    ids = {record["id"] for record in own}
    limits = {one["defect"]: one for one in (report.limits or {}).get("findings", ())}
    return {
        "schema_version": SCHEMA_VERSION,
        "title": report.summary.get("label") or report.summary.get("external_id") or "Inspection",
        "fingerprint": report.summary.get("fingerprint"),
        "model": {
            "index": source.model,
            "count": len(source.models),
            "unit": scale.get("unit") or MODEL_UNIT,
            "scale": scale.get("value"),
            "findings": _in_all(report),
            "scale_sigma": scale.get("sigma"),
        },
        "models": [
            {"index": other, "href": page_of(other, source.model)} for other in source.models if other != source.model
        ],
        "videos": _videos(frame),
        "camera": None if scene is None else dict(scene.camera),
        "frames": [_frame(row, source) for row in report.frames],
        "sprite": _sprite(source),
        "detections": [_detection(row, source, size) for row in report.detections],
        "defects": [_defect(record, scene, limits.get(record["id"])) for record in own],
        "events": [event for event in report.timeline if event["defect_id"] in ids],
        "row": _row(source),
        "verdict": report.verdict,
        "state": report.summary.get("state"),
        "message": report.summary.get("message"),
        "flags": [_flag(flag) for flag in report.quality.get("flags", ())],
        "reasons": {**{str(code): text for code, text in REASONS.items()}, **_frame_words()},
        "surface": _surface(scene),
        "surface_reason": None if scene is not None else _why_no_surface(source),
        "pictures_reason": source.no_pictures if source.pictures is None else None,
        "up": None if scene is None else scene.up,
    }


def _row(source: ViewerSource) -> Item:
    """The object of row.json, with the names that the tables give to the blades whose coverage it tells."""
    row = source.row
    if not row:
        return UNKNOWN_ROW
    on_first = row.get("on_first")
    seen = [{**one, "name": blade_name(one["blade"], source.model, on_first)} for one in row.get("coverage") or ()]
    return {**row, "coverage": seen} if seen else row


def _in_all(report: Report) -> list[int] | None:
    """At least and at most how many findings all models hold; None where one model holds all that there are."""
    least = least_defects(int(record.get("model") or 0) for record in report.defects)
    return None if least == len(report.defects) else [least, len(report.defects)]


def _scale(source: ViewerSource) -> JsonObject:
    """The scale of the model: by its row.json; that of the summary is the first model's alone."""
    of_run: JsonObject = source.report.summary.get("scale") or {}
    own: JsonObject | None = (source.row or {}).get("scale")
    return own if own is not None else of_run if source.model == 0 else {}


def _frame_words() -> dict[str, str]:
    return {str(code): text for code, text in FRAME_REASONS.items()}


def _shared(source: ViewerSource) -> str:
    """Folder of the pictures that all models share, relative to the page."""
    return f"../../../{VIEWER}/" if source.model else ""


def _size(source: ViewerSource, frame: Item) -> tuple[float, float]:
    """Width and height of a source frame, px."""
    if frame.get("width") and frame.get("height"):
        return float(frame["width"]), float(frame["height"])
    if source.pictures is not None:
        return float(source.pictures.width), float(source.pictures.height)
    return 1.0, 1.0


def _videos(frame: Item) -> list[JsonObject]:
    lengths = frame.get("videos") or [frame]
    return [
        {
            "name": f"video {number}" if len(lengths) > 1 else "video",
            "width": frame.get("width"),
            "height": frame.get("height"),
            "frames": one.get("n_frames"),
            "duration_s": one.get("duration_s"),
        }
        for number, one in enumerate(lengths)
    ]


def _sprite(source: ViewerSource) -> JsonObject | None:
    sprite = None if source.pictures is None else source.pictures.sprite
    if sprite is None:
        return None
    return {"file": f"{_shared(source)}{SPRITE}", **sprite.__dict__}


def _frame(row: Item, source: ViewerSource) -> JsonObject:
    index, pictures, scene = int(row["index"]), source.pictures, source.shown_scene
    pose = None if scene is None else scene.poses.get(index)
    full = scene is not None and index in scene.full
    scale = None if pictures is None else 1 if full else pictures.scales.get(index)
    below = "" if full else _shared(source)
    return {
        "index": index,
        "video": row.get("video") or 0,
        "source_index": row["source_index"],
        "time_s": round(row["time_s"], _TIME_DECIMALS),
        "name": image_name(index),
        "registered": pose is not None,
        **({} if pose is not None else {"reason": _frame_reason(row, source)}),
        "cam_from_world": pose,
        "picture": None if scale is None else f"{below}{FRAMES}/{image_name(index)}",
        "picture_scale": scale,
        "tile": None if pictures is None else pictures.tiles.get(index),
    }


def _frame_reason(row: Item, source: ViewerSource) -> FrameReason:
    if not source.trusted:
        return FrameReason.NO_MODEL
    if row.get("model") not in (None, source.model):
        return FrameReason.IN_ANOTHER_MODEL
    if source.pictures is not None and int(row["index"]) in source.pictures.damaged:
        return FrameReason.DAMAGED_PICTURE
    return FrameReason.NOT_REGISTERED


_RENAMED = ("box_x1", "box_y1", "box_x2", "box_y2", "outcome", "rung", "defect_id", "x", "y", "z", "frame_index")
"""Columns of a detection that have another form here."""


def _detection(row: Item, source: ViewerSource, size: tuple[float, float]) -> JsonObject:
    width, height = size
    known = None if source.pictures is None else source.pictures.detections.get(row["id"])
    here = row["outcome"] != Outcome.UNPLACED and row.get("model") in (None, source.model)
    point = [row["x"], row["y"], row["z"]] if here and row["x"] is not None else None
    polygon = None if known is None or known.polygon is None else known.polygon
    return {
        **{name: value for name, value in row.items() if name not in _RENAMED},
        "frame": row["frame_index"] if known is None else known.frame,
        "box": [row["box_x1"] * width, row["box_y1"] * height, row["box_x2"] * width, row["box_y2"] * height],
        "polygon": None if polygon is None else [[x * width, y * height] for x, y in polygon],
        "state": row["outcome"],
        "method": row["rung"],
        "point": point,
        "sigma": (source.sigmas or {}).get(row["id"]) if point is not None else None,
        "defect": row["defect_id"],
        "video": row.get("video") or 0,
    }


def _defect(record: Item, scene: ViewerScene | None, limits: JsonObject | None) -> JsonObject:
    extent = record.get("extent") or {}
    views = record.get("frames") or ()
    best = next((view for view in views if view.get("detected")), next(iter(views), None))
    at = None if best is None else {"frame": best["frame_index"], "x": best.get("x"), "y": best.get("y")}
    return {
        **{name: value for name, value in record.items() if name != "faces"},
        "node": f"defect_{record['id']}" if scene is not None and record["id"] in scene.nodes else None,
        "surface_picture": _portrait(record, scene),
        "best_frames": best_frames(DefectRecord.from_dict(dict(record))),
        "best": at,
        **_measured(record, extent),
        **({} if limits is None else {"limits": {"verdict": limits["verdict"], "reason": limits["reason"]}}),
    }


def _portrait(record: Item, scene: ViewerScene | None) -> str | None:
    """Address of the picture of the surface at a defect, relative to the page."""
    drawn = scene is not None and record["id"] in scene.portraits
    return f"{PORTRAITS}/{portrait_name(record['id'])}" if drawn else None


def _measured(record: Item, extent: Item) -> JsonObject:
    """The size that findings are ranked by: the length where it was measured, else the extent."""
    if record.get("length") is not None:
        unit = record.get("length_unit") or MODEL_UNIT
        return {"size": record["length"], "size_sigma": record.get("length_sigma"), "size_unit": unit}
    unit = extent.get("unit") or MODEL_UNIT
    return {"size": extent.get("value"), "size_sigma": extent.get("sigma"), "size_unit": unit}


def _flag(flag: Item) -> JsonObject:
    return {
        "code": flag["code"],
        "severity": flag["severity"],
        "text": flag.get("meaning") or flag["code"],
        "advice": FLAG_ADVICE.get(flag["code"]),
        "where": flag.get("where") or "",
        "value": flag.get("value"),
        "threshold": flag.get("threshold"),
    }


def _surface(scene: ViewerScene | None) -> JsonObject | None:
    return None if scene is None else {"file": SURFACE_GLB, **scene.surface.__dict__}


def _why_no_surface(source: ViewerSource) -> str:
    report = source.report
    if not source.trusted:
        told = report.summary.get("message")
        return f"The run has no model that can be trusted: {told}." if told else FRAME_REASONS[FrameReason.NO_MODEL]
    failed = report.summary.get("failed_stage")
    told = report.summary.get("message")
    if failed:
        return f"The stage {failed} did not come to its end, so there is no surface to show" + (
            f": {told}." if told else "."
        )
    return "The result has no surface that the page can show."
