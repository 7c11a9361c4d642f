"""Every format's own example is on its frame; sizes, names and forced formats; and what is dropped is said."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import get_args

import pytest

from core.annotations.clocks import CLOCKS
from core.annotations.foreign.formats import FORMAT_NAMES, FORMATS
from core.annotations.foreign.sheet import Sheet, counted, number_in_name
from core.annotations.load import load_annotations
from core.annotations.placed import place
from core.errors import BadInput
from core.scene.frame import SourceFrame
from core.settings.reading import InputSettings
from core.video.probe import probe_video
from core.video.table import FrameTable
from tests.core.making_annotations import FRAME, read, zipped
from tests.inputs import INPUTS

ROOT = Path(__file__).parents[4]
FOREIGN = INPUTS / "foreign"
DENT = (438 / 960, 336 / 720, 478 / 960, 376 / 720)
CVAT = (438.1 / 960, 336.2 / 720, 478.3 / 960, 376.4 / 720)


@pytest.fixture(scope="module")
def table() -> FrameTable:
    return probe_video(ROOT / "samples" / "turbine.mp4")


@pytest.mark.parametrize(
    ("name", "form", "frames", "box"),
    [
        ("coco.json", "coco", [0], DENT),
        ("cvat.xml", "cvat", [0], CVAT),
        ("cvat_export.zip", "cvat", [0], CVAT),
        ("cvat_task.json", "cvat", [0], CVAT),
        ("labelme.json", "labelme", [0], DENT),
        ("labelstudio.json", "label-studio", list(range(96)), (0.456, 0.467, 0.498, 0.522)),
        ("roboflow_video.json", "roboflow", [0, 1], DENT),
        ("supervisely.json", "supervisely", [0], DENT),
        ("via.json", "via", [0], DENT),
        ("via3.json", "via", [1], DENT),
    ],
)
def test_the_dent_of_every_example_is_on_its_frame(
    name: str, form: str, frames: list[int], box: tuple[float, ...], table: FrameTable
) -> None:
    annotations = load_annotations(FOREIGN / name, FRAME)
    placed = place(annotations, table)
    assert annotations.format == form
    assert [source.source_index for source in placed.looked_at] == frames
    assert {d.label for d in placed.detections} == {"dent"}
    assert placed.detections[0].source_index == frames[0]
    assert placed.detections[0].box == pytest.approx(box)
    assert {flag.code for flag in placed.flags} <= {"annotations_partly_read"}, "which frames are meant is no question"


def test_yolo_is_a_folder_of_texts(table: FrameTable) -> None:
    text = (FOREIGN / "yolo" / "turbine_1.txt").read_text()
    annotations = read(zipped({"turbine_1.txt": text, "turbine_96.txt": ""}))
    placed = place(annotations, table)
    (detection,) = placed.detections
    assert placed.looked_at == (SourceFrame(0, 0), SourceFrame(0, 95))
    assert (detection.source, detection.label) == (SourceFrame(0, 0), "0")
    assert detection.score == 0.91
    assert detection.box == pytest.approx((0.45665, 0.46775, 0.49875, 0.52325))
    assert "labels are their numbers" in annotations.warnings[0]


def test_answers_for_single_pictures_are_numbered_by_their_files(table: FrameTable) -> None:
    for name in ("ultralytics.json", "roboflow.json"):
        answer = json.loads((FOREIGN / name).read_text())
        with pytest.raises(BadInput, match="of a single picture, and do not say which frame"):
            read(answer)
        placed = place(read(zipped({"frame_0.json": answer, "frame_7.json": answer})), table)
        assert [(d.source_index, d.label, d.score) for d in placed.detections] == [(0, "dent", 0.9), (7, "dent", 0.9)]
        assert placed.detections[0].box == pytest.approx(DENT)


@pytest.mark.parametrize("frame", [(1280.0, 720.0), (720.0, 960.0)])
def test_pictures_of_another_shape_are_refused_with_both_sizes(frame: tuple[float, float]) -> None:
    with pytest.raises(BadInput, match=f"960x720.*{frame[0]:g}x{frame[1]:g}") as caught:
        load_annotations(FOREIGN / "labelme.json", frame)
    assert caught.value.code == "annotations_other_size"
    assert ("turned by 90 degrees" in caught.value.message) == (frame == (720.0, 960.0))


def test_pictures_of_the_same_shape_may_have_another_size() -> None:
    small = load_annotations(FOREIGN / "labelme.json", (480, 360)).detections
    assert small[0].box == pytest.approx(DENT)
    value = json.loads((FOREIGN / "labelme.json").read_text())
    assert read({**value, "imageWidth": 854, "imageHeight": 480}, (1920, 1080)).detections


def test_pixels_without_a_size_need_the_video() -> None:
    with pytest.raises(BadInput, match="name the video as well") as caught:
        load_annotations(FOREIGN / "cvat.xml")
    assert caught.value.code == "annotations_need_video"


def test_shapes_outside_of_their_picture_are_counted_and_cut() -> None:
    shape = {"shape_type": "rectangle", "label": "dent"}
    value = json.loads((FOREIGN / "labelme.json").read_text())
    value["shapes"] = [
        {**shape, "points": [[-96, 0], [96, 72]]},
        {**shape, "points": [[-96, 0], [-2, 72]]},
        {**shape, "points": [[10, 10], [10, 72]]},
        {**shape, "points": [[10, 10], [20, 72]], "label": ""},
    ]
    annotations = read(value)
    assert [d.box for d in annotations.detections] == [(0, 0, 0.1, 0.1)]
    assert annotations.warnings == (
        "1 shape outside of its picture is not read",
        "1 shape without area is not read",
        "1 shape without a label is not read",
        "shapes that reach beyond their picture were cut at its edge",
    )


def test_two_pictures_of_one_number_are_two_videos() -> None:
    value = json.loads((FOREIGN / "labelme.json").read_text())
    other = {**value, "imagePath": "other_0000.jpg"}
    with pytest.raises(BadInput, match=r'"0000.jpg" and "other_0000.jpg"'):
        read(zipped({"a.json": value, "b.json": other}))


@pytest.mark.parametrize(
    ("name", "key"),
    [("frame_000012.png", "12"), ("a/b2/7.jpg", "7"), ("x_0007_jpg.rf.0a1b2c9.jpg", "7"), ("C:\\p\\f3.jpeg.json", "3")],
)
def test_the_number_of_a_picture_is_the_last_one_in_its_name(name: str, key: str) -> None:
    assert number_in_name(name) == key


def test_what_is_not_read_is_said_in_the_singular_and_the_plural() -> None:
    assert counted("ellipse", 12) == "12 ellipses are"
    assert counted("set of keypoints", 2) == "2 sets of keypoints are"
    assert counted("mask that cannot be unpacked", 2) == "2 masks that cannot be unpacked are"
    assert counted("class of a whole picture", 2) == "2 classes of a whole picture are"
    assert counted("graph of keypoints", 1) == "1 graph of keypoints is"


def test_every_drop_is_in_the_table_of_its_format() -> None:
    source = ROOT / "core" / "annotations" / "foreign"
    for form in FORMATS:
        text = (
            source / (form.recognises if form.container != "texts" else form.read).__module__.rpartition(".")[2]
        ).with_suffix(".py")
        for kind in re.findall(r'sheet\.drop\("([\w ]+)"', text.read_text() if text.exists() else ""):
            assert kind in form.drops, (form.title, kind)
    with pytest.raises(KeyError):
        Sheet({}).drop("ellipse")


def test_formats_and_clocks_have_the_names_of_the_options() -> None:
    fields = InputSettings.model_fields
    assert get_args(fields["annotation_format"].annotation) == FORMAT_NAMES
    assert get_args(fields["time_convention"].annotation) == ("auto", *CLOCKS)


@pytest.mark.parametrize("name", [name for name in FORMAT_NAMES if name != "auto"])
def test_a_format_that_is_forced_is_the_only_one_tried(name: str) -> None:
    if name == "labelme":
        assert load_annotations(FOREIGN / "labelme.json", FRAME, name).format == "labelme"
        return
    with pytest.raises(BadInput) as caught:
        load_annotations(FOREIGN / "labelme.json", FRAME, name)
    assert caught.value.code == ("bad_time" if name == "bladeatlas" else "annotations_unknown_format")
    assert caught.value.where == ('key "version"' if name == "bladeatlas" else "input.annotation_format")
    if name != "bladeatlas":
        assert f"cannot be read as {name}; it seems to be LabelMe" in caught.value.message


def test_an_unknown_format_is_answered_with_the_nearest() -> None:
    with pytest.raises(BadInput, match="did you mean 'coco'"):
        load_annotations(FOREIGN / "coco.json", FRAME, "cocoo")
