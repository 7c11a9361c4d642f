"""What each format says beyond its example: frames, tracks, masks, turns, classes."""

from __future__ import annotations

import base64
import json
import zlib
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from core.annotations.placed import place
from core.errors import BadInput
from core.video.probe import probe_video
from core.video.table import FrameTable
from tests.core.making_annotations import read, zipped
from tests.inputs import INPUTS

ROOT = Path(__file__).parents[4]
FOREIGN = INPUTS / "foreign"


@pytest.fixture(scope="module")
def table() -> FrameTable:
    return probe_video(ROOT / "samples" / "turbine.mp4")


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
    assert crack.polygon == ((0.0, 0.0), (0.5, 0.0), (0.5, 0.5))
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


def test_ultralytics_results_of_frames_in_their_order() -> None:
    one = {"name": "dent", "class": 0, "confidence": 0.5, "track_id": 4}
    shares = {**one, "box": {"x1": 0.1, "y1": 0.2, "x2": 0.3, "y2": 0.4}}
    segment = {"segments": {"x": [96, 192, 192], "y": [72, 72, 144]}, "box": {"x1": 96, "y1": 72, "x2": 192, "y2": 144}}
    turned = {"box": {"x1": 96, "y1": 72, "x2": 192, "y2": 72, "x3": 192, "y3": 144, "x4": 96, "y4": 144}}
    whole = {"name": "blade", "class": 1, "confidence": 0.9}
    annotations = read([[], [shares], [{**one, **segment, "keypoints": {"x": [1]}}, {**one, **turned}, whole]])
    assert [len(entry.detections) for entry in annotations.entries] == [0, 1, 2]
    assert annotations.clocks == ("index",)
    assert annotations.detections[0].box == pytest.approx((0.1, 0.2, 0.3, 0.4))
    for detection, corners in zip(annotations.detections[1:], (3, 4), strict=True):
        assert detection.box == pytest.approx((0.1, 0.1, 0.2, 0.2))
        assert (len(detection.polygon or ()), detection.score, detection.track_id) == (corners, 0.5, 4)
    assert annotations.warnings == ("1 set of keypoints is not read", "1 class of a whole picture is not read")


def test_via_2_takes_polygons_and_finds_the_label() -> None:
    polygon = {"name": "polygon", "all_points_x": [0, 480, 480], "all_points_y": [0, 0, 360]}
    regions = [
        {"shape_attributes": polygon, "region_attributes": {"remark": "old", "Label": {"nick": False, "dent": True}}},
        {"shape_attributes": {"name": "circle", "cx": 1, "cy": 1, "r": 1}, "region_attributes": {}},
    ]
    export = {"a": {"filename": "f1.png", "size": 1, "regions": regions}, "b": {"filename": "f2.png", "regions": {}}}
    annotations = read(export)
    (detection,) = annotations.detections
    assert (detection.label, detection.polygon) == ("dent", ((0, 0), (0.5, 0), (0.5, 0.5)))
    assert [entry.key for entry in annotations.entries] == ["1", "2"]
    assert annotations.warnings == ("1 circle is not read",)


def test_via_3_takes_chosen_options_and_pictures() -> None:
    project: dict[str, Any] = {
        "project": {},
        "attribute": {"1": {"aname": "kind", "options": {"0": "nick", "1": "dent"}}},
        "file": {"7": {"fname": "f_12.png", "type": 2}},
        "view": {"v": {"fid_list": ["7"]}},
        "metadata": {
            "a": {"vid": "v", "z": [], "xy": [7, 0, 0, 480, 0, 480, 360], "av": {"1": "1"}},
            "b": {"vid": "v", "z": [], "xy": [3, 1, 1, 1], "av": {"1": "1"}},
        },
    }
    annotations = read(project)
    (detection,) = annotations.detections
    assert (detection.key, detection.label, detection.box) == ("12", "dent", (0, 0, 0.5, 0.5))
    assert annotations.warnings == ("1 circle is not read",)
    # An attribute that the project does not declare is known by its number, in the order of these.
    spots = [{**project["metadata"]["a"], "av": values} for values in ({"9": "nick"}, {"2": "dent", "3": "nick"})]
    undeclared = {**project, "attribute": {}, "metadata": dict(zip("ab", spots, strict=True))}
    assert [one.label for one in read(undeclared).detections] == ["nick", "dent"]


def test_datumaro_counts_what_is_no_region() -> None:
    kinds = ["label", "polyline", "points", "caption", "cuboid_3d", "ellipse", "new"]
    item = {"id": "frame_4", "annotations": [{"type": kind} for kind in kinds], "image": {"size": [72, 96]}}
    document = {"categories": {"label": {"labels": [{"name": "dent"}]}}, "items": [item]}
    annotations = read(document, (96, 72))
    assert (len(annotations.warnings), annotations.entries[0].detections) == (len(kinds), ())
    wrong = {**document, "items": [{**item, "annotations": [{"type": "bbox", "bbox": [0, 0, 9, 9], "label_id": 1}]}]}
    with pytest.raises(BadInput, match="label_id is 1, which no category has"):
        read(wrong, (96, 72))


BOX = {"framesCount": 9, "labels": ["a"], "sequence": [{"frame": 1, "x": 1, "y": 1, "width": 1, "height": 1}]}
REGION = {"type": "videorectangle", "value": BOX}
TRACK = '<track id="{0}" label="a" task_id="{0}"><box frame="0" outside="0" xtl="0" ytl="0" xbr="9" ybr="9"/></track>'
SPOT = {"z": [0.5], "xy": [2, 1, 1, 9, 9], "av": {"1": "a"}}


@pytest.mark.parametrize(
    "value",
    [
        [{"data": {"video": f"/{name}.mp4"}, "annotations": [{"result": [REGION]}]} for name in "ab"],
        f"<annotations><version>1.1</version>{TRACK.format(1)}{TRACK.format(2)}</annotations>",
        {
            "project": {},
            "file": {name: {"fname": f"{name}.mp4", "type": 4} for name in "ab"},
            "metadata": {name: {**SPOT, "vid": name} for name in "ab"},
        },
    ],
)
def test_a_file_of_several_videos_is_refused(value: Any) -> None:
    with pytest.raises(BadInput) as caught:
        read(value)
    assert caught.value.code == "annotations_several_videos"


def test_what_nobody_has_looked_at_yet_is_no_empty_picture() -> None:
    tasks = [
        {"data": {"image": "/f_1.png"}, "annotations": []},
        {"data": {"image": "/f_2.png"}, "annotations": [{"result": []}]},
        {"data": {"image": "/f_3.png"}, "annotations": [{"result": [], "was_cancelled": True}], "predictions": []},
    ]
    assert [entry.key for entry in read(tasks).entries] == ["2"]
