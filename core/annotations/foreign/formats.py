"""The formats of other tools that are read: the one table that readers, messages and the documentation share."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from core.annotations.foreign import (
    coco,
    cvat,
    datumaro,
    label_studio,
    labelme,
    roboflow,
    supervisely,
    ultralytics,
    via,
    voc,
    yolo,
)
from core.annotations.foreign.sheet import Sheet

Reader = Callable[[Any, str, Sheet, Sequence[Any]], None]
"""Takes a document, the name of its file, the sheet to fill, and the other JSON documents of the same archive."""


def _never(_: object) -> bool:
    return False


def _by_files(*_: object) -> None:
    raise TypeError("a format of many text files has no single document")


@dataclass(frozen=True)
class Format:
    """One format: how it is known, who reads it, and what a user should know of it."""

    name: str
    """As `--format` takes it; the containers of one tool share it."""
    title: str
    container: Literal["json", "xml", "texts"]
    reads: str
    """What is read, in words."""
    frames: str
    """How the frame of a picture is found, in words."""
    drops: Mapping[str, str]
    """What is not read, by kind."""
    recognises: Callable[[Any], bool] = _never
    read: Reader = _by_files


_NAMED = "last number in the picture's name, from 0 or 1 (fitted)"

FORMATS: tuple[Format, ...] = (
    Format(
        "coco",
        "COCO",
        "json",
        "boxes, polygons, masks (run lengths), categories, scores, tracks",
        f"`frame_id` or `frame_index`, else the {_NAMED}",
        coco.DROPS,
        coco.recognises,
        coco.read,
    ),
    Format(
        "cvat",
        "CVAT XML 1.1 for videos and for images",
        "xml",
        "boxes (turned ones, too), polygons, masks, tracks with linear motion between keyframes",
        f"frame number from 0; of pictures the {_NAMED}",
        cvat.DROPS,
        cvat.recognises_xml,
        cvat.read_xml,
    ),
    Format(
        "cvat",
        "CVAT JSON of a backup",
        "json",
        "the same",
        "frame number from 0, with `start_frame` and `step` of `task.json`",
        cvat.DROPS,
        cvat.recognises_json,
        cvat.read_json,
    ),
    Format(
        "label-studio",
        "Label Studio JSON and JSON-MIN",
        "json",
        "boxes of videos with lifespans, boxes (turned ones, too), polygons and brushes of pictures, scores",
        f"frame number from 1; of pictures the {_NAMED}",
        label_studio.DROPS,
        label_studio.recognises,
        label_studio.read,
    ),
    Format(
        "yolo",
        "YOLO, Ultralytics text (folder or zip)",
        "texts",
        "boxes, outlines, turned boxes, confidences, tracks, names of classes",
        _NAMED,
        yolo.DROPS,
    ),
    Format(
        "ultralytics",
        "Ultralytics results as JSON",
        "json",
        "boxes, segments, turned boxes, confidences, tracks",
        "place in a list of lists; of single pictures the last number in the file's name",
        ultralytics.DROPS,
        ultralytics.recognises,
        ultralytics.read,
    ),
    Format(
        "supervisely",
        "Supervisely videos and pictures",
        "json",
        "rectangles, polygons, bitmaps, objects as tracks",
        f"`index` from 0; of pictures the {_NAMED}",
        supervisely.DROPS,
        supervisely.recognises,
        supervisely.read,
    ),
    Format(
        "labelme",
        "LabelMe (file, folder or zip)",
        "json",
        "rectangles, polygons, masks",
        _NAMED,
        labelme.DROPS,
        labelme.recognises,
        labelme.read,
    ),
    Format(
        "voc",
        "Pascal VOC (file, folder or zip)",
        "xml",
        "boxes, polygons as Roboflow adds them, scores",
        _NAMED,
        voc.DROPS,
        voc.recognises,
        voc.read,
    ),
    Format(
        "via",
        "VGG Image Annotator 2 and 3",
        "json",
        "rectangles, polygons",
        f"time; of pictures the {_NAMED}",
        via.DROPS,
        via.recognises,
        via.read,
    ),
    Format(
        "roboflow",
        "Roboflow inference on videos and pictures",
        "json",
        "boxes, outlines, confidences, tracks",
        "`frame_offset`, else `time_offset`; of pictures the last number in the file's name",
        roboflow.DROPS,
        roboflow.recognises,
        roboflow.read,
    ),
    Format(
        "datumaro",
        "Datumaro",
        "json",
        "boxes, polygons, masks (run lengths), scores, tracks",
        f"attribute `frame` from 0, else the {_NAMED}",
        datumaro.DROPS,
        datumaro.recognises,
        datumaro.read,
    ),
)

OWN = "bladeatlas"
"""Name of our own form."""
AUTO = "auto"
FORMAT_NAMES: tuple[str, ...] = (AUTO, OWN, *dict.fromkeys(one.name for one in FORMATS))
"""What can be asked for."""
READABLE = "COCO, CVAT, Label Studio, YOLO, Ultralytics, Supervisely, LabelMe, Pascal VOC, VIA, Roboflow, Datumaro"
"""For messages."""
