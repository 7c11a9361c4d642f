"""What a foreign file must hold: a wrong number of values is refused with its place, limits are where they are said."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any
from xml.etree.ElementTree import Element

import pytest

from core.annotations.foreign.bitmaps import row_outlines
from core.annotations.foreign.formats import FORMATS
from core.annotations.foreign.sheet import seconds_key
from core.annotations.foreign.unreadable import looks_like_video
from core.errors import BadInput
from tests.core.making_annotations import read, zipped


def via_2(xs: list[float], ys: list[float]) -> dict[str, Any]:
    drawn = {"name": "polygon", "all_points_x": xs, "all_points_y": ys}
    return {"f": {"filename": "f_1.png", "regions": [{"shape_attributes": drawn, "region_attributes": {"a": "dent"}}]}}


def cvat(kind: str, points: list[float]) -> list[dict[str, Any]]:
    shape = {"type": kind, "points": points, "frame": 3, "label": "dent"}
    return [{"version": 0, "tags": [], "shapes": [shape], "tracks": []}]


def datumaro(size: list[float]) -> dict[str, Any]:
    item = {"id": "frame_4", "annotations": [], "image": {"size": size}}
    return {"categories": {"label": {"labels": [{"name": "dent"}]}}, "items": [item]}


@pytest.mark.parametrize(
    ("value", "place", "what"),
    [
        (via_2([1, 9, 9], [1, 1]), "all_points_y", "3 numbers, not 2 values"),
        (via_2([1, 9], [1, 1, 9]), "all_points_y", "2 numbers, not 3 values"),
        (cvat("rectangle", [0, 0, 9, 9, 5, 5]), "points", "4 numbers, not 6 values"),
        (cvat("rectangle", [0, 0]), "points", "4 numbers, not 2 values"),
        (cvat("polygon", [0, 0, 9, 9, 5]), "points", "5 numbers, which are no pairs"),
        (cvat("mask", [4, 0, 0, 1]), "points", "no runs and corners"),
        (datumaro([720]), "items[0].image.size", "2 numbers, not 1 values"),
        (datumaro([720, 960, 3]), "items[0].image.size", "2 numbers, not 3 values"),
    ],
)
def test_a_wrong_number_of_values_is_refused_with_its_place(value: object, place: str, what: str) -> None:
    with pytest.raises(BadInput) as caught:
        read(value)
    assert place in caught.value.message
    assert what in caught.value.message


def test_a_mask_of_cvat_lies_between_its_corners() -> None:
    """Runs by rows of the picture between the first and the last column and row."""
    runs = [1, 2, 1, 2]  # a column of two pixels is empty on its left: 3 wide, 2 high
    (detection,) = read(cvat("mask", [*runs, 30, 40, 32, 41]), (96, 72)).detections
    assert detection.box == pytest.approx((31 / 96, 40 / 72, 33 / 96, 42 / 72), abs=0.51 / 72)
    assert detection.polygon is not None


def test_unpacking_a_mask_costs_its_pixels() -> None:
    spent: list[int] = []
    row_outlines([7, 3, 11], 3, 7, (0.0, 0.0), spent.append)
    assert spent == [21]


@pytest.mark.parametrize("value", [None, [], {}, 12, "text", [[]], {"a": {}}, [{"a": 1}]])
def test_whether_a_format_knows_a_document_is_yes_or_no(value: object) -> None:
    for one in FORMATS:
        if one.container != "xml":
            assert one.recognises(value) is False, one.name


def test_formats_of_xml_do_not_know_any_document() -> None:
    for one in FORMATS:
        if one.container == "xml":
            assert one.recognises(Element("kml")) is False, one.name


def named(length: int) -> str:
    """A list of classes in YAML of so many characters."""
    begin = "names: [dent]\n#"
    return begin + "x" * (length - len(begin))


def test_a_list_of_classes_is_no_longer_than_it_needs_to_be() -> None:
    texts = {"frame_1.txt": "0 0.5 0.5 0.1 0.1"}
    (detection,) = read(zipped({"data.yaml": named(1 << 18), **texts})).detections
    assert detection.label == "dent"
    with pytest.raises(BadInput, match="too long for a list of classes") as caught:
        read(zipped({"data.yaml": named((1 << 18) + 1), **texts}))
    assert (caught.value.code, caught.value.where) == ("annotations_too_large", "data.yaml")


def test_names_in_an_archive_are_no_longer_than_1024_characters() -> None:
    texts = {"classes.txt": "dent"}
    name = "x" * (1024 - len("/frame_1.txt")) + "/frame_1.txt"
    assert [one.key for one in read(zipped({name: "0 0.5 0.5 0.1 0.1", **texts})).entries] == ["1"]
    with pytest.raises(BadInput, match="is no plain name"):
        read(zipped({f"x{name}": "0 0.5 0.5 0.1 0.1", **texts}))


def test_an_archive_may_hold_all_that_is_read(monkeypatch: pytest.MonkeyPatch) -> None:
    texts = {"classes.txt": "dent", "frame_1.txt": "0 0.5 0.5 0.1 0.1"}
    total = sum(map(len, texts.values()))
    monkeypatch.setattr("core.annotations.foreign.archive.MAX_BYTES", total)
    assert len(read(zipped(texts)).detections) == 1
    monkeypatch.setattr("core.annotations.foreign.archive.MAX_BYTES", total - 1)
    with pytest.raises(BadInput, match="holds more than") as caught:
        read(zipped(texts))
    assert caught.value.code == "annotations_too_large"


@pytest.mark.parametrize(
    ("head", "video"),
    [
        (b"RIFF\0\0\0\0AVI LIST", True),
        (b"RIFF\0\0\0\0WEBPVP8 ", False),
        (b"\0\0\0\x20ftypisom", True),
        (b"G" + bytes(187) + b"G" + bytes(9), True),
        (b"G" + bytes(187) + b"H" + bytes(9), False),
        (b"GIF89a", False),
    ],
)
def test_videos_are_known_by_how_they_begin(head: bytes, video: bool) -> None:
    assert looks_like_video(head) is video


@pytest.mark.parametrize(
    ("seconds", "key"),
    [(1.0, "1.000"), (2.5, "2.500"), (1 / 3, "0.333333333"), (1e-4, "0.0001"), (2e-5, "0.000020"), (0.0, "0.000000")],
)
def test_the_key_of_a_time_keeps_its_nanoseconds(seconds: float, key: str) -> None:
    assert seconds_key(seconds) == key


@pytest.mark.parametrize("make", [lambda: datumaro([0, 0]), lambda: via_2([], [])])
def test_nothing_on_a_picture_is_a_picture_without_detections(make: Callable[[], object]) -> None:
    annotations = read(make())
    assert [len(entry.detections) for entry in annotations.entries] == [0]


@pytest.mark.parametrize("labels", [[], [5], None, "x", [[]]])
def test_a_region_without_a_label_is_counted(labels: object) -> None:
    region = {"x": 50, "y": 50, "width": 20, "height": 10, "rectanglelabels": labels}
    size = {"original_width": 96, "original_height": 72}
    annotations = read([{"image": "/data/upload/1/ab-frame_7.png", "label": [{**region, **size}]}], (96, 72))
    assert annotations.detections == ()
    assert annotations.warnings == ("1 shape without a label is not read",)
