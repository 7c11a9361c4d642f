"""What is not read gets one message: what it seems to be, what is read, and where our own form is described."""

from __future__ import annotations

import gzip
import json
from pathlib import Path

import pytest

from core.annotations.foreign.archive import MAX_RATIO, packed_folder
from core.annotations.load import annotations_from, load_annotations
from core.errors import BadInput
from core.intake import answer, check_input
from core.scene.detection import DETECTION_COLUMNS
from core.settings import make_settings
from core.videos import Recording
from core.xml_tree import MAX_DEPTH, parse_xml
from tests.core.making_annotations import zipped
from tests.inputs import INPUTS

ROOT = Path(__file__).parents[4]
FOREIGN = INPUTS / "foreign"
SAMPLE = ROOT / "samples" / "turbine.json"
VIDEO = ROOT / "samples" / "turbine.mp4"
CREATE_ML = FOREIGN / "tools" / "supervision_createml.json"
PUBLISHED = [dict.fromkeys(DETECTION_COLUMNS)]
PLACED = [{"id": 0, "key": "0.0", "time_s": 0.0, "label": "dent", "box": [0, 0, 1, 1], "source_index": 0}]


@pytest.mark.parametrize(
    ("data", "seems", "advice"),
    [
        (CREATE_ML.read_bytes(), "a file of CreateML", "export COCO"),
        ((FOREIGN / "coco_results.json").read_bytes(), "results of COCO alone", "add `images` and `categories`"),
        (b"1,1,10,10,20,20,1,-1,-1,-1\n2,1,10,10,20,20,1,-1,-1,-1\n", "a text of the MOT challenge", "COCO"),
        (b"1,1,10,10,20,20,1\nframe,x,y,w,h,label\n1,1,2,3,4,dent\n", "a table (CSV)", "export JSON"),
        ((FOREIGN / "yolo.txt").read_bytes(), "a text of YOLO for a single picture", "folder"),
        ((FOREIGN / "via.csv").read_bytes(), "a table (CSV)", "export JSON"),
        (b"<kml><a/></kml>", "XML of another kind, with the root <kml>", ""),
        (VIDEO.read_bytes()[:4096], "a video", "wrong order"),
        (gzip.compress(SAMPLE.read_bytes()[:2000]), "a file packed by gzip", "unpack it"),
        (b"7z\xbc\xaf\x27\x1c" + bytes(40), "an archive of a kind that is not read", "zip"),
        (b"\x80\x04\x95\0\0\0", "a binary file", ""),
        (json.dumps(PUBLISHED).encode(), "the table detections.json of a result", "made from"),
        (json.dumps(PLACED).encode(), "the table detections.json of a result", "made from"),
        (b'{"preset": "draft", "options": {}}', "a file of parameters", "--parameters"),
        (b'{"videos": [], "annotations": []}', "a file of YouTube-VIS", "COCO"),
        (b'{"frame_12": {}}', 'JSON of another kind: key "frame_12" is not a time', ""),
        (b'[{"a": 1}]', "a JSON list of another kind", ""),
        (b"12", "JSON that is neither an object nor a list, but 12", ""),
        (b"A letter.", "text of another kind, no JSON and no XML", ""),
        (zipped({"a.md": "text", "b.txt": "A letter."}), "an archive that holds no annotations (1 md, 1 txt)", ""),
        (zipped({"a.md": "text", "b.md": "text"}), "an archive that holds no annotations (2 md)", ""),
    ],
)
def test_what_it_seems_to_be_is_said(data: bytes, seems: str, advice: str) -> None:
    with pytest.raises(BadInput) as caught:
        annotations_from(data, (960, 720))
    message = caught.value.message
    assert f"seem to be {seems}" in message
    assert advice in message
    for part in ("COCO", "CVAT", "Label Studio", "YOLO", "Datumaro", "our own form (docs/annotations.md)"):
        assert part in message
    assert len(message) < 400


@pytest.mark.parametrize(
    ("data", "part"),
    [
        (SAMPLE.read_bytes()[:4000], "cut off"),
        (b'{"1.0": {"detections": [', "cut off"),
        (b'{"1.0": {}}\n{"2.0": {}}\n', "one JSON value for each line"),
        (b"<annotations><track>", "not valid XML"),
        ((FOREIGN / "voc.xml").read_bytes(), "names no size of its picture"),
    ],
)
def test_what_is_wrong_with_a_known_form_is_said(data: bytes, part: str) -> None:
    with pytest.raises(BadInput, match=part):
        annotations_from(data, (960, 720))


def test_a_video_and_annotations_in_the_wrong_order_are_told_apart() -> None:
    with pytest.raises(BadInput, match="in the wrong order") as caught:
        check_input([Recording(SAMPLE, VIDEO)], make_settings())
    assert caught.value.code == "swapped_files"
    roi = {"x0": 0.0, "y0": 0.0, "x1": 1.0, "y1": 1.0}
    found = answer({"recordings": [{"video": str(SAMPLE), "annotations": str(VIDEO)}], "roi": roi})
    assert found["error"]["code"] == "swapped_files"


BOMB = '<!DOCTYPE x [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;">]><annotations>&b;</annotations>'
FETCH = '<!DOCTYPE x SYSTEM "file:///etc/hostname"><annotations/>'


@pytest.mark.parametrize("text", [BOMB, FETCH])
def test_xml_declares_nothing(text: str) -> None:
    with pytest.raises(BadInput) as caught:
        annotations_from(text.encode())
    assert caught.value.code == "annotations_xml_declares"


def test_xml_has_limits(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(BadInput, match="nests them deeper"):
        parse_xml(b"<a>" * (MAX_DEPTH + 1))
    monkeypatch.setattr("core.xml_tree.MAX_ELEMENTS", 3)
    assert len(parse_xml(b"<a><b/><b/></a>")) == 2
    with pytest.raises(BadInput, match="more than 3 elements"):
        parse_xml(b"<a><b/><b/><b/></a>")
    with pytest.raises(BadInput, match="encoding that is not read"):
        parse_xml(b'<?xml version="1.0" encoding="utf-99"?><a/>')


@pytest.mark.parametrize("name", ["../a.json", "/a.json", "a\\b.json", "C:/a.json", "x/../../a.json"])
def test_names_in_an_archive_stay_in_it(name: str) -> None:
    with pytest.raises(BadInput, match="is no plain name"):
        annotations_from(zipped({name: "{}"}))


def test_an_archive_has_limits(monkeypatch: pytest.MonkeyPatch) -> None:
    bomb = zipped({"a.json": b" " * (2 << 20)})
    assert len(bomb) * MAX_RATIO < 2 << 20
    with pytest.raises(BadInput, match=f"more than {MAX_RATIO} times its size"):
        annotations_from(bomb)
    with pytest.raises(BadInput, match=r"cut off|damaged"):
        annotations_from(zipped({"a.json": "{}"})[:-4])
    damaged = bytearray(zipped({"a.json": '{"0.0": {}}' * 20}))
    damaged[45] ^= 0xFF
    with pytest.raises(BadInput) as caught:
        annotations_from(bytes(damaged))
    assert caught.value.code in ("annotations_archive", "annotations_malformed")
    monkeypatch.setattr("core.annotations.foreign.archive.MAX_FILES", 2)
    with pytest.raises(BadInput, match="holds 3 files; at most 2"):
        annotations_from(zipped({"a": "1", "b": "2", "c": "3"}))
    monkeypatch.setattr("core.annotations.foreign.archive.MAX_BYTES", 5)
    with pytest.raises(BadInput, match="holds more than"):
        annotations_from(zipped({"a": "1234", "b": "56"}))
    monkeypatch.setattr("core.annotations.foreign.archive.MAX_DIRECTORY", 50)
    with pytest.raises(BadInput, match="too long a table of contents"):
        annotations_from(zipped({"a": "1", "b": "2"}))


def test_an_archive_may_hold_our_own_form_but_not_two_kinds() -> None:
    own = SAMPLE.read_text()
    assert len(annotations_from(zipped({"turbine.json": own, "key_id_map.json": "{}"})).detections) == 90
    with pytest.raises(BadInput, match="several files of annotations"):
        annotations_from(zipped({"a.json": own, "b.json": (FOREIGN / "coco.json").read_text()}))
    with pytest.raises(BadInput, match=r"a\.json: the annotations are not valid JSON"):
        annotations_from(zipped({"a.json": "{1"}))


def test_a_folder_is_packed_to_the_same_archive_every_time(tmp_path: Path) -> None:
    folder = tmp_path / "labels"
    (folder / "sub").mkdir(parents=True)
    (folder / "sub" / "frame_1.txt").write_text("0 0.5 0.5 0.1 0.1")
    (folder / "classes.txt").write_text("dent\n")
    (folder / "frame_2.png").write_bytes(b"\x89PNG" + bytes(9000))
    (folder / ".hidden").write_text("x")
    (folder / "link").symlink_to(SAMPLE)
    packed_folder(folder, tmp_path / "a.zip")
    packed_folder(folder, tmp_path / "b.zip")
    assert (tmp_path / "a.zip").read_bytes() == (tmp_path / "b.zip").read_bytes()
    annotations = load_annotations(tmp_path / "a.zip")
    assert [(e.key, [d.label for d in e.detections]) for e in annotations.entries] == [("1", ["dent"]), ("2", [])]
    assert (tmp_path / "a.zip").stat().st_size < 2000, "pictures are left out"
