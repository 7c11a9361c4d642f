"""The options of how input is read. Defaults here are the preset `default`."""

from __future__ import annotations

from typing import Literal

from core.settings.base import Group, option


class InputSettings(Group):
    """What is accepted as input."""

    allow_truncated: bool = option(False, "use the decodable part of a damaged video", source="refused by default")
    video_stream: int | None = option(
        None,
        "number of the video stream to read, among all streams of the file; none = the film, never a cover or preview",
        source="method",
        ge=0,
    )
    fps: float | None = option(
        None,
        "frames per second of a video without times: pictures, a raw stream; none = what a raw stream's header states",
        unit="1/s",
        source="user",
        ge=0.01,
        le=1000,
    )
    time_convention: Literal[
        "auto",
        "pts",
        "declared_rate",
        "average_rate",
        "index",
        "milliseconds",
        "container",
        "declared_rate+1",
        "average_rate+1",
        "index+1",
        "displayed",
    ] = option("auto", "what the time keys of the annotations mean; auto = fitted over all of them", source="method")
    annotation_format: Literal[
        "auto",
        "bladeatlas",
        "coco",
        "cvat",
        "label-studio",
        "yolo",
        "ultralytics",
        "supervisely",
        "labelme",
        "voc",
        "via",
        "roboflow",
        "datumaro",
    ] = option("auto", "the format that the annotations are of; auto = told by their content", source="method")
