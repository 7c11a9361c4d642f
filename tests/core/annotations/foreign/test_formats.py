"""Every format's own example is read with the right box on the right frame, and what is dropped is said."""

from __future__ import annotations

import base64
import json
import re
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any, get_args

import cv2
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from core.annotations.clocks import CLOCKS
from core.annotations.foreign.formats import FORMAT_NAMES, FORMATS
from core.annotations.foreign.sheet import Sheet, counted, number_in_name
from core.annotations.load import annotations_from, load_annotations
from core.annotations.model import Annotations
from core.annotations.placed import place
from core.errors import BadInput
from core.settings.groups import InputSettings
from core.video.probe import probe_video
from core.video.table import FrameTable
from tests.core.making_zips import zipped

ROOT = Path(__file__).parents[4]
INPUTS = ROOT / "tests" / "data" / "inputs"
FOREIGN = INPUTS / "foreign"
FRAME = (960.0, 720.0)
DENT = (438 / 960, 336 / 720, 478 / 960, 376 / 720)
CVAT = (438.1 / 960, 336.2 / 720, 478.3 / 960, 376.4 / 720)


@pytest.fixture(scope="module")
def table() -> FrameTable:
    return probe_video(ROOT / "samples" / "turbine.mp4")


def read(value: Any, frame: tuple[float, float] | None = FRAME, form: str = "auto") -> Annotations:
    data = (
        value if isinstance(value, bytes) else value.encode() if isinstance(value, str) else json.dumps(value).encode()
    )
    return annotations_from(data, frame, form)


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
    assert list(placed.looked_at) == frames
    assert {d.label for d in placed.detections} == {"dent"}
    assert placed.detections[0].source_index == frames[0]
    assert placed.detections[0].box == pytest.approx(box)
    assert not placed.flags


def test_yolo_is_a_folder_of_texts(table: FrameTable) -> None:
    text = (FOREIGN / "yolo" / "turbine_1.txt").read_text()
    annotations = read(zipped({"turbine_1.txt": text, "turbine_96.txt": ""}))
    placed = place(annotations, table)
    (detection,) = placed.detections
    assert (placed.looked_at, detection.source_index, detection.label) == ((0, 95), 0, "0")
    assert (detection.score, detection.box) == (0.91, pytest.approx((0.45665, 0.46775, 0.49875, 0.52325)))
    assert "labels are their numbers" in annotations.warnings[0]


def test_answers_for_single_pictures_are_numbered_by_their_files(table: FrameTable) -> None:
    for name in ("ultralytics.json", "roboflow.json"):
        answer = json.loads((FOREIGN / name).read_text())
        with pytest.raises(BadInput, match="of a single picture, and do not say which frame"):
            read(answer)
        placed = place(read(zipped({"frame_0.json": answer, "frame_7.json": answer})), table)
        assert [(d.source_index, d.label, d.score) for d in placed.detections] == [(0, "dent", 0.9), (7, "dent", 0.9)]
        assert placed.detections[0].box == pytest.approx(DENT)


def test_coco_tells_frames_tracks_and_masks() -> None:
    mask = {"size": [4, 6], "counts": [9, 2, 2, 2, 9]}  # columns 2 and 3, rows 1 and 2
    document = {
        "videos": [{"id": 1, "name": "a.mp4"}],
        "images": [
            {"id": 5, "video_id": 1, "frame_id": 3, "file_name": "x/000099.jpg", "width": 6, "height": 4},
            {"id": 6, "video_id": 1, "frame_id": 4, "file_name": "x/000100.jpg", "width": 6, "height": 4},
        ],
        "annotations": [
            {"image_id": 5, "category_id": 2, "segmentation": mask, "track_id": 8, "score": 0.25, "iscrowd": 1},
            {"image_id": 5, "category_id": 2, "bbox": [0, 0, 3, 2], "segmentation": [[0, 0, 3, 0, 3, 2], [0, 0, 1, 1]]},
            {"image_id": 7, "category_id": 2, "bbox": [0, 0, 3, 2], "keypoints": [1, 2, 3]},
            {"image_id": 5, "category_id": 2, "bbox": [0, 0, 3, 2], "keypoints": [1, 2, 3]},
        ],
        "categories": [{"id": 2, "name": "nick"}],
    }
    annotations = read(document, (12, 8))
    assert [entry.key for entry in annotations.entries] == ["3", "4"]
    first, second, third = annotations.detections
    assert (first.track_id, first.score, first.label) == (8, 0.25, "nick")
    assert first.box == pytest.approx((2.5 / 6, 1.5 / 4, 3.5 / 6, 2.5 / 4))
    assert (second.polygon, third.polygon) == (((0, 0), (0.5, 0), (0.5, 0.5)), None)
    assert annotations.warnings == (
        "1 further part of an outline is not read",
        "1 annotation without a picture in the file is not read",
        "1 set of keypoints is not read",
    )


def test_files_of_an_archive_that_say_the_same_are_read_once() -> None:
    coco = json.loads((FOREIGN / "coco.json").read_text())
    files = {"annotations/instances_default.json": coco, "annotations/keypoints_default.json": coco}
    annotations = read(zipped(files))
    assert (annotations.format, len(annotations.detections)) == ("coco", 1)


def test_long_texts_take_no_long_time() -> None:
    coco = json.loads((FOREIGN / "coco.json").read_text())
    coco["images"][0]["file_name"] = ".jpg" * 200_000 + "x"
    with pytest.raises(BadInput, match="has no frame number in its name"):
        read(coco)
    labelled = {"data": {"image": ".jpg?" * 200_000 + "\n"}, "annotations": [{"result": []}]}
    assert read([labelled], FRAME).entries == ()
    with pytest.raises(BadInput, match="text of another kind"):
        read("1" * 1_000_000 + "x 1 1 1 1")
    files = {"frame_1.txt": "0 " + "1" * 500_000 + "x", "data.yaml": "names: &a [b]\nx: [*a, *a]"}
    with pytest.raises(BadInput, match="holds no annotations"):
        read(zipped(files))


def test_names_of_classes_are_texts_whatever_they_look_like() -> None:
    files = {"data.yaml": "names: [no, 1.10, 2020-01-01]", "frame_1.txt": "0 0.5 0.5 0.1 0.1\n1 0.5 0.5 0.2 0.2"}
    assert [d.label for d in read(zipped(files), None).detections] == ["no", "1.10"]
    for wrong in ("names: [[a]]", "names: {x: a}", "names: 3"):
        with pytest.raises(BadInput, match="must be a list of names"):
            read(zipped({**files, "data.yaml": wrong}), None)


def test_coco_of_several_videos_is_refused_by_their_names() -> None:
    images = [{"id": i, "video_id": i, "frame_id": 0, "file_name": f"{i}.jpg", "width": 6, "height": 4} for i in (1, 2)]
    videos = [{"id": 1, "name": "a.mp4"}, {"id": 2, "name": "b.mp4"}]
    with pytest.raises(BadInput, match=r'several videos \("a.mp4", "b.mp4"\)'):
        read({"videos": videos, "images": images, "annotations": [], "categories": []})


CVAT_VIDEO = """<annotations><version>1.1</version><meta><task><size>20</size><start_frame>4</start_frame>
<frame_filter>step=2</frame_filter><original_size><width>100</width><height>50</height></original_size></task></meta>
<track id="3" label="dent">
<box frame="4" keyframe="1" outside="0" xtl="10" ytl="10" xbr="20" ybr="20"/>
<box frame="10" keyframe="1" outside="0" xtl="40" ytl="10" xbr="50" ybr="26"/>
<box frame="12" keyframe="1" outside="1" xtl="40" ytl="10" xbr="50" ybr="26"/>
<box frame="20" keyframe="1" outside="0" xtl="0" ytl="0" xbr="10" ybr="10" rotation="90"/>
</track>
<track id="4" label="crack"><polygon frame="4" outside="0" points="0,0;50,0;50,25"/><ellipse frame="4" cx="1"/></track>
<track id="5" label="nick"><mask frame="6" outside="0" left="10" top="5" width="3" height="3" rle="3,6"/></track>
</annotations>"""


def test_cvat_moves_boxes_between_keyframes_at_the_step_of_the_task() -> None:
    annotations = read(CVAT_VIDEO, (200, 100))
    dents = {int(d.key): d.box for d in annotations.detections if d.label == "dent"}
    assert sorted(dents) == [4, 6, 8, 10, 20]
    assert dents[6] == pytest.approx((0.2, 0.2, 0.3, 0.44))
    assert dents[8] == pytest.approx((0.3, 0.2, 0.4, 0.48))
    assert dents[20] == pytest.approx((0, 0, 0.1, 0.2))
    assert [entry.key for entry in annotations.entries if not entry.detections] == ["12"]
    assert {d.track_id for d in annotations.detections if d.label == "dent"} == {"3"}
    (crack,) = [d for d in annotations.detections if d.label == "crack"]
    assert crack.polygon == ((0, 0), (0.5, 0), (0.5, 0.5))
    (nick,) = [d for d in annotations.detections if d.label == "nick"]
    assert nick.box == pytest.approx((10.5 / 100, 6.5 / 50, 12.5 / 100, 7.5 / 50))
    assert (annotations.clocks, annotations.warnings) == (("index",), ("1 ellipse is not read",))


def test_a_backup_of_cvat_counts_the_pictures_of_its_task() -> None:
    box = {"type": "rectangle", "points": [0, 0, 96, 72], "outside": False, "keyframe": True}
    track = {"frame": 0, "label": "dent", "shapes": [{**box, "frame": 0}, {**box, "frame": 2, "outside": True}]}
    lasting = {"frame": 3, "label": "nick", "shapes": [{**box, "frame": 3}]}
    jobs = [{"version": 0, "tags": [{}], "shapes": [], "tracks": [track, lasting]}]
    task = {"name": "t", "jobs": [], "data": {"start_frame": 10, "stop_frame": 30, "frame_filter": "step=5"}}
    annotations = read(zipped({"task.json": task, "annotations.json": jobs}))
    assert [(e.key, [d.label for d in e.detections]) for e in annotations.entries] == [
        ("10", ["dent"]),
        ("15", ["dent"]),
        ("20", []),
        ("25", ["nick"]),
        ("30", ["nick"]),
    ]
    assert annotations.warnings == ("1 tag is not read",)
    alone = read(jobs)
    assert [e.key for e in alone.entries] == ["0", "1", "2", "3"]
    assert any("no task.json" in warning for warning in alone.warnings)
    assert any("up to their last keyframe" in warning for warning in alone.warnings)


def test_label_studio_of_another_frame_rate_is_put_on_frames_by_time(table: FrameTable) -> None:
    value = {"framesCount": 192, "duration": 8.0, "labels": ["dent"], "sequence": [
        {"frame": 1, "enabled": True, "x": 10, "y": 10, "width": 10, "height": 10},
        {"frame": 4, "enabled": False, "x": 10, "y": 10, "width": 10, "height": 10},
    ]}  # fmt: skip
    task = {"data": {"video": "a.mp4"}, "annotations": [{"result": [{"type": "videorectangle", "value": value}]}]}
    placed = place(read([task]), table)
    assert [d.source_index for d in placed.detections] == [0, 0, 1, 1]
    assert placed.convention.reading.clock == "displayed"


def test_label_studio_json_min_and_turned_boxes() -> None:
    region = {"x": 50, "y": 50, "width": 20, "height": 10, "rotation": 90, "rectanglelabels": ["dent"]}
    task = {
        "image": "/data/upload/1/ab-frame_7.png",
        "label": [{**region, "original_width": 200, "original_height": 100}],
    }
    (detection,) = read([task], (200, 100)).detections
    # 40 x 10 px, turned clockwise about its upper left corner at (100, 50).
    assert (detection.key, detection.label) == ("7", "dent")
    assert detection.box == pytest.approx((0.45, 0.5, 0.5, 0.9))


def test_supervisely_bitmaps_and_tracks() -> None:
    picture = np.zeros((4, 8, 4), np.uint8)
    picture[1:3, 2:6] = 255
    data = base64.b64encode(zlib.compress(cv2.imencode(".png", picture)[1].tobytes())).decode()
    figure = {"objectId": 9, "geometryType": "bitmap", "geometry": {"bitmap": {"data": data, "origin": [10, 20]}}}
    point = {"objectId": 9, "geometryType": "point", "geometry": {}}
    document = {
        "size": {"width": 100, "height": 50},
        "objects": [{"id": 9, "classTitle": "nick"}],
        "frames": [{"index": 4, "figures": [figure, point]}, {"index": 5, "figures": []}],
    }
    annotations = read(document, (100, 50))
    (detection,) = annotations.detections
    assert [entry.key for entry in annotations.entries] == ["4", "5"]
    assert (detection.label, detection.track_id) == ("nick", 0)
    assert detection.box == pytest.approx((0.125, 0.43, 0.155, 0.45))
    assert annotations.warnings == ("1 point is not read",)


def test_voc_takes_polygons_and_looks_at_empty_pictures() -> None:
    box = "<bndbox><xmin>0</xmin><ymin>0</ymin><xmax>48</xmax><ymax>36</ymax></bndbox>"
    polygon = "<polygon><x1>0</x1><y1>0</y1><x2>48</x2><y2>0</y2><x3>48</x3><y3>36</y3></polygon>"
    size = "<size><width>96</width><height>72</height></size>"
    xml = "<annotation><filename>{}</filename>" + size + "{}</annotation>"
    files = {
        "a.xml": xml.format("f_3_jpg.rf.0a1b2c3d.jpg", f"<object><name>nick</name>{box}{polygon}</object>"),
        "b.xml": xml.format("f_4.jpg", ""),
    }
    annotations = read(zipped(files))
    assert [(e.key, len(e.detections)) for e in annotations.entries] == [("3", 1), ("4", 0)]
    assert annotations.detections[0].polygon == ((0, 0), (0.5, 0), (0.5, 0.5))


@pytest.mark.parametrize(
    ("rows", "expected"),
    [
        (["1 0.5 0.5 0.2 0.2"], [("nick", None, None, 0)]),
        (["1 0.5 0.5 0.2 0.2 0.75"], [("nick", 0.75, None, 0)]),
        (["1 0.5 0.5 0.2 0.2 12"], [("nick", None, 12, 0)]),
        (["1 0.5 0.5 0.2 0.2 0.75 12"], [("nick", 0.75, 12, 0)]),
        (["0 0.4 0.4 0.6 0.4 0.6 0.6"], [("dent", None, None, 3)]),
        (["0 0.4 0.4 0.6 0.4 0.6 0.6 0.4 0.6"], [("dent", None, None, 4)]),
        (["0 0.4 0.4 0.6 0.4 0.6 0.6 0.4 0.6 0.5"], [("dent", 0.5, None, 4)]),
        (["0 0.4 0.4 0.6 0.4 0.6 0.6 0.4 0.6 0.5 7", "1 0.4 0.4 0.6 0.4 0.6 0.6"],
         [("dent", 0.5, 7, 4), ("nick", None, None, 3)]),
    ],
)  # fmt: skip
def test_rows_of_yolo_are_told_apart_over_the_data_set(rows: list[str], expected: list[Any]) -> None:
    names = "train: x\nnames:\n  0: dent\n  1: nick\n"
    annotations = read(zipped({"data.yaml": names, "labels/a_5.txt": "\n".join(rows)}), None)
    found = [(d.label, d.score, d.track_id, len(d.polygon or ())) for d in annotations.detections]
    assert found == expected
    for d in annotations.detections:
        assert d.box == pytest.approx((0.4, 0.4, 0.6, 0.6))


def test_yolo_looks_at_pictures_without_a_text() -> None:
    files = {
        "data.yaml": "names: ['dent']",
        "train/labels/a_5.txt": "0 0.5 0.5 0.2 0.2",
        "train/images/a_5.jpg": b"\xff\xd8\xff\xe0" + bytes(40),
        "train/images/a_6.jpg": b"\xff\xd8\xff\xe0" + bytes(40),
        "README.txt": "Exported by a tool.",
    }
    assert [(e.key, len(e.detections)) for e in read(zipped(files), None).entries] == [("5", 1), ("6", 0)]
    files["data.yaml"] = "kpt_shape: [2, 3]\nnames: ['dent']"
    files["train/labels/a_5.txt"] = "0 0.5 0.5 0.2 0.2 0.1 0.1 2 0.2 0.2 2"
    annotations = read(zipped(files), None)
    assert annotations.warnings == ("1 set of keypoints is not read",)
    assert annotations.detections[0].box == pytest.approx((0.4, 0.4, 0.6, 0.6))
    files["train/labels/a_5.txt"] = "3 0.5 0.5 0.2 0.2"
    with pytest.raises(BadInput, match=r"train/labels/a_5.txt, line 1 has the class 3, which has no name"):
        read(zipped(files), None)


def test_roboflow_takes_frame_offsets_before_times() -> None:
    answer = {"image": {"width": 96, "height": 72}, "predictions": []}
    document = {"frame_offset": [0, 18], "time_offset": [0.0, 1.5], "model": [answer, answer]}
    annotations = read(document)
    assert ([e.key for e in annotations.entries], annotations.clocks) == (["0", "18"], ("index",))


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
    assert caught.value.code in ("annotations_unknown_format", "bad_time")
    if name != "bladeatlas":
        assert f"cannot be read as {name}; it seems to be LabelMe" in caught.value.message


def test_an_unknown_format_is_answered_with_the_nearest() -> None:
    with pytest.raises(BadInput, match="did you mean 'coco'"):
        load_annotations(FOREIGN / "coco.json", FRAME, "cocoo")


EXAMPLES = [json.loads(path.read_text()) for path in sorted(FOREIGN.glob("*.json"))]
EXAMPLES += [json.loads(path.read_text()) for path in sorted((FOREIGN / "tools").glob("*.json"))]
VALUES: st.SearchStrategy[Any] = st.sampled_from(
    [None, True, -1, 0, 1.5, 1e300, float("nan"), "", "x", "9" * 30, [], {}, [[]], [None], {"a": 1}, 10**12]
)


def places(value: Any, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    inner = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    return [path] + [place for key, one in inner for place in places(one, (*path, key))]


def changed(value: Any, path: tuple[Any, ...], new: Any) -> Any:
    if not path:
        return new
    copy = value.copy()
    copy[path[0]] = changed(value[path[0]], path[1:], new)
    return copy


@settings(max_examples=300, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(st.data())
def test_any_change_of_an_example_is_read_or_refused(data: st.DataObject) -> None:
    value = data.draw(st.sampled_from(EXAMPLES))
    for _ in range(data.draw(st.integers(1, 3))):
        value = changed(value, data.draw(st.sampled_from(places(value))), data.draw(VALUES))
    read_or_refused(lambda: annotations_from(json.dumps(value).encode(), FRAME))


@settings(max_examples=150, deadline=None)
@given(st.data())
def test_any_change_of_xml_is_read_or_refused(data: st.DataObject) -> None:
    texts = [CVAT_VIDEO, (FOREIGN / "cvat.xml").read_text(), (FOREIGN / "voc.xml").read_text()]
    texts.append((FOREIGN / "tools" / "datumaro_cvat_images.xml").read_text())
    text = data.draw(st.sampled_from(texts))
    quoted = re.findall(r'(?<==)"[^"]*"', text) or ["<name>dent</name>"]
    old = data.draw(st.sampled_from(quoted))
    new = data.draw(st.sampled_from(['""', '"-1"', '"1e999"', '"NaN"', '"a,b"', '"9999999999999"', '"1,2;3"']))
    read_or_refused(lambda: annotations_from(text.replace(old, new, 1).encode(), FRAME))


def read_or_refused(attempt: Callable[[], Annotations]) -> None:
    try:
        annotations, refusal = attempt(), None
    except BadInput as error:
        annotations, refusal = Annotations(), error
    assert refusal is None or (refusal.where and len(refusal.message) < 600)
    for detection in annotations.detections:
        x1, y1, x2, y2 = detection.box
        assert 0 <= x1 < x2 <= 1
        assert 0 <= y1 < y2 <= 1
