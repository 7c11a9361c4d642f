"""VGG Image Annotator: projects and exports of its versions 2 (pictures) and 3 (videos and pictures)."""

from __future__ import annotations

from collections.abc import Sequence

from core.annotations.checks import as_list, as_object, shown
from core.annotations.foreign.sheet import SECONDS, Points, Shape, Sheet, number_in_name, seconds_key
from core.annotations.foreign.values import box_between, corner_box, number, numbers, pairs, text
from core.errors import BadInput
from core.geometry.boxes import Box
from core.json_files import JsonObject

DROPS = {
    "circle": "circle",
    "ellipse": "ellipse",
    "point": "point",
    "line": "line",
    "polyline": "polyline",
    "segment": "stretch of time",
    "other": "shape of an unknown kind",
}
_SHAPES_3 = {1: "point", 2: "rect", 3: "circle", 4: "ellipse", 5: "line", 6: "polyline", 7: "polygon", 8: "rect"}
"""Numbers of shapes in version 3; the extreme rectangle (8) is written as a rectangle."""
_LABELS = ("label", "labels", "class", "name", "type", "category", "defect")
_VIDEO = 4


def recognises(document: object) -> bool:
    """Whether a JSON value is a project or an export of VIA."""
    if not isinstance(document, dict):
        return False
    if "_via_img_metadata" in document or {"project", "file", "metadata"} <= set(document):
        return True
    return bool(document) and all(
        isinstance(one, dict) and "filename" in one and "regions" in one for one in document.values()
    )


def read(document: JsonObject, name: str, sheet: Sheet, beside: Sequence[object] = ()) -> None:
    """Read all pictures of a project, or the times of its video. Coordinates are pixels; VIA names no sizes."""
    if "metadata" in document and "file" in document:
        _read_3(document, sheet)
        return
    pictures = as_object(document.get("_via_img_metadata", document), "_via_img_metadata")
    for where, one in pictures.items():
        picture = as_object(one, shown(where))
        known = text(picture.get("filename"), f"{shown(where)}.filename")
        regions = picture.get("regions") or []
        regions = list(regions.values()) if isinstance(regions, dict) else as_list(regions, f"{shown(where)}.regions")
        shapes = (_shape_2(one, f"{shown(where)}.regions[{i}]", sheet) for i, one in enumerate(regions))
        sheet.add(number_in_name(known), known, [one for one in shapes if one is not None], unit=None)


def _shape_2(value: object, where: str, sheet: Sheet) -> Shape | None:
    region = as_object(value, where)
    drawn = as_object(region.get("shape_attributes"), f"{where}.shape_attributes")
    kind = text(drawn.get("name"), f"{where}.name")
    label = _label(as_object(region.get("region_attributes") or {}, f"{where}.region_attributes"))
    if kind == "rect":
        sides = [number(drawn.get(member), f"{where}.{member}") for member in ("x", "y", "width", "height")]
        return Shape(label, corner_box(*sides))
    if kind == "polygon":
        xs = numbers(drawn.get("all_points_x"), f"{where}.all_points_x")
        ys = numbers(drawn.get("all_points_y"), f"{where}.all_points_y", len(xs))
        return Shape(label, None, tuple(zip(xs, ys, strict=True)))
    sheet.drop(kind if kind in DROPS else "other")
    return None


def _label(attributes: JsonObject) -> str:
    """The attribute that is the label by its name, else the only or first one that says something."""
    names = sorted(attributes, key=lambda name: _LABELS.index(name.lower()) if name.lower() in _LABELS else 99)
    for name in names:
        value = attributes[name]
        if isinstance(value, dict):  # boxes to tick: the ones that are
            value = next((one for one, ticked in value.items() if ticked), "")
        if isinstance(value, str | int | float) and not isinstance(value, bool) and str(value).strip():
            return str(value).strip()
    return ""


def _read_3(document: JsonObject, sheet: Sheet) -> None:
    files = as_object(document["file"], "file")
    views = as_object(document.get("view") or {}, "view")
    attributes = as_object(document.get("attribute") or {}, "attribute")
    videos = set()
    for where, value in as_object(document["metadata"], "metadata").items():
        one = as_object(value, f"metadata.{where}")
        file = _file(text(one.get("vid"), f"metadata.{where}.vid"), files, views)
        known = text(file.get("fname"), "fname") or where
        moments = numbers(one.get("z") or [], f"metadata.{where}.z")
        drawn = numbers(one.get("xy") or [], f"metadata.{where}.xy")
        if file.get("type") == _VIDEO:
            videos.add(known)
            if len(videos) > 1:
                raise BadInput(
                    f"the annotations are of several videos ({', '.join(shown(one) for one in sorted(videos))}); "
                    "write one project for each",
                    code="annotations_several_videos",
                    where="file",
                )
            sheet.clocks = SECONDS
        if not drawn or (file.get("type") == _VIDEO and len(moments) != 1):
            sheet.drop("segment")
            continue
        key = seconds_key(moments[0]) if file.get("type") == _VIDEO else number_in_name(known)
        box, outline = _geometry_3(drawn, f"metadata.{where}.xy", sheet)
        if box is not None:
            label = _label_3(as_object(one.get("av") or {}, f"metadata.{where}.av"), attributes)
            sheet.add(key, f"{known} at {key}" if moments else known, [Shape(label, box, outline)], unit=None)


def _file(view: str, files: JsonObject, views: JsonObject) -> JsonObject:
    ids = as_object(views.get(view) or {"fid_list": [view]}, f"view.{view}").get("fid_list")
    found: object = next((files[str(one)] for one in as_list(ids, "fid_list") if str(one) in files), {})
    return as_object(found, "file")


def _geometry_3(drawn: Sequence[float], where: str, sheet: Sheet) -> tuple[Box | None, Points | None]:
    kind = _SHAPES_3.get(int(drawn[0]), "other")
    if kind == "rect" and len(drawn) == 5:
        return corner_box(drawn[1], drawn[2], drawn[3], drawn[4]), None
    if kind == "polygon":
        corners = pairs(drawn[1:], where)
        return box_between(corners), corners
    sheet.drop(kind if kind in DROPS else "other")
    return None, None


def _label_3(values: JsonObject, attributes: JsonObject) -> str:
    """The value of an attribute; one that was chosen from a list is the number of its option."""
    plain: JsonObject = {}
    for number_of, value in values.items():
        declared = attributes.get(number_of)
        declared = declared if isinstance(declared, dict) else {}
        options = declared.get("options")
        chosen = options.get(str(value), value) if isinstance(options, dict) else value
        plain[str(declared.get("aname", number_of))] = chosen
    return _label(plain)
