"""Files that other tools' own libraries wrote of the sample's annotations come back as these annotations.

`tests/data/inputs/foreign/README.md` says which library wrote which file, and how.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

import pytest

from core.annotations.load import load_annotations
from core.annotations.model import Annotations
from core.geometry.boxes import Box, bounding_box
from tests.inputs import INPUTS

ROOT = Path(__file__).parents[4]
TOOLS = INPUTS / "foreign" / "tools"
SAMPLE = load_annotations(ROOT / "samples" / "turbine.json").entries
FRAME = (960.0, 720.0)
N_FRAMES = 12
PIXEL = 1 / 720
MASK = (240.5 / 960, 360.5 / 720, 359.5 / 960, 419.5 / 720)
"""Of pixels 240 to 359 and 360 to 419, which the files with a mask have on top."""


def boxes(annotations: Annotations, base: int = 0) -> dict[int, list[tuple[str, float | None, Box]]]:
    """Labels, scores and boxes by the frame of the video."""
    return {
        int(entry.key) - base: [(d.label, d.score, d.box) for d in entry.detections] for entry in annotations.entries
    }


def agree(
    found: Mapping[int, list[tuple[str, float | None, Box]]], within: float, *, scores: bool, frames: int = N_FRAMES
) -> None:
    """Every frame of the sample is there, those without a detection, too, and nothing else."""
    assert sorted(found) == list(range(frames))
    assert sum(map(len, found.values())) >= 14
    for i in range(N_FRAMES):
        wanted = sorted(SAMPLE[i].detections, key=lambda d: d.box)
        got = sorted(found[i], key=lambda one: one[2])
        assert [one[0] for one in got] == [d.label for d in wanted]
        for (_, score, box), detection in zip(got, wanted, strict=True):
            assert box == pytest.approx(detection.box, abs=within)
            assert score == (detection.score if scores else None)


def without_mask(annotations: Annotations) -> dict[int, list[tuple[str, float | None, Box]]]:
    """Boxes by frame, after the frame that only holds the mask was looked at."""
    found = boxes(annotations)
    ((label, _, box),) = found[N_FRAMES]
    assert label == "dent"
    assert box == pytest.approx(MASK, abs=1.01 * PIXEL)
    polygon = annotations.entries[N_FRAMES].detections[0].polygon
    assert polygon is not None
    assert bounding_box(polygon) == pytest.approx(MASK)
    del found[N_FRAMES]
    return found


def blade_is_there(annotations: Annotations) -> None:
    (mask,) = annotations.entries[0].masks
    assert mask.label == "blade"
    sample = SAMPLE[0].masks[0].polygon[:40]
    assert len(mask.polygon) == len(sample)
    for corner, wanted in zip(mask.polygon, sample, strict=True):
        assert corner == pytest.approx(wanted, abs=1e-4)


def test_datumaro() -> None:
    annotations = load_annotations(TOOLS / "datumaro.json", FRAME)
    assert (annotations.format, annotations.clocks, annotations.warnings) == ("datumaro", ("index",), ())
    agree(without_mask(annotations), 1e-5, scores=True)
    blade_is_there(annotations)


def test_coco_of_datumaro() -> None:
    annotations = load_annotations(TOOLS / "datumaro_coco.json", FRAME)
    assert (annotations.format, annotations.clocks, annotations.warnings) == ("coco", ("index", "index+1"), ())
    agree(without_mask(annotations), 1e-5, scores=True)
    blade_is_there(annotations)


def test_coco_of_supervision() -> None:
    annotations = load_annotations(TOOLS / "supervision_coco.json", FRAME)
    assert (annotations.format, annotations.warnings) == ("coco", ())
    agree(boxes(annotations, base=1), 1e-6, scores=False)


def test_cvat_for_images_of_datumaro() -> None:
    annotations = load_annotations(TOOLS / "datumaro_cvat_images.xml", FRAME)
    assert (annotations.format, annotations.clocks) == ("cvat", ("index", "index+1"))
    found = boxes(annotations)
    assert found.pop(N_FRAMES, []) is not None
    agree(found, 1e-5, scores=False)
    blade_is_there(annotations)


@pytest.mark.parametrize(
    ("name", "base", "frames"),
    [
        ("datumaro_voc.zip", 0, [i for i in range(N_FRAMES) if SAMPLE[i].detections]),
        ("supervision_voc.zip", 1, list(range(N_FRAMES))),
    ],
)
def test_pascal_voc(name: str, base: int, frames: list[int]) -> None:
    """Datumaro writes no file for a picture without an object, so nobody says that it was looked at."""
    annotations = load_annotations(TOOLS / name, FRAME)
    assert annotations.format == "voc"
    found = boxes(annotations, base)
    assert sorted(found) == frames
    empty: dict[int, list[tuple[str, float | None, Box]]] = {i: [] for i in range(N_FRAMES)}
    agree(empty | found, 2 * PIXEL, scores=False)


@pytest.mark.parametrize(("name", "base", "last"), [("datumaro_yolo.zip", 0, 1), ("supervision_yolo.zip", 1, 0)])
def test_yolo(name: str, base: int, last: int) -> None:
    annotations = load_annotations(TOOLS / name)
    assert (annotations.format, annotations.clocks, annotations.warnings) == ("yolo", ("index", "index+1"), ())
    agree(boxes(annotations, base), 1e-4, scores=False, frames=N_FRAMES + last)


def test_labelme_of_supervision() -> None:
    annotations = load_annotations(TOOLS / "supervision_labelme.zip", FRAME)
    assert (annotations.format, annotations.warnings) == ("labelme", ())
    agree(boxes(annotations, base=1), 1e-6, scores=False)


def test_labelme() -> None:
    annotations = load_annotations(TOOLS / "labelme_frame_0003.json", FRAME)
    (entry,) = annotations.entries
    assert (entry.key, annotations.warnings) == ("3", ("1 circle is not read",))
    rectangle, masked = entry.detections
    assert rectangle.box == pytest.approx((438 / 960, 336 / 720, 479 / 960, 377 / 720))
    assert masked.box == pytest.approx((240 / 960, 360 / 720, 359 / 960, 419 / 720))
    assert masked.polygon is not None
    assert bounding_box(masked.polygon) == pytest.approx((260.5 / 960, 370.5 / 720, 339.5 / 960, 409.5 / 720))
    assert [one for corner in entry.masks[0].polygon for one in corner] == pytest.approx([0.1, 0.1, 0.5, 0.1, 0.5, 0.9])


def test_label_studio_pictures() -> None:
    annotations = load_annotations(TOOLS / "label_studio_images.json", FRAME)
    assert (annotations.format, annotations.clocks, annotations.warnings) == ("label-studio", ("index", "index+1"), ())
    found = boxes(annotations)
    (brush,) = [one for one in found[3] if one[2] == pytest.approx(MASK)]
    assert brush[0] == "dent"
    found[3].remove(brush)
    found[0] = [one for one in found[0] if one[0] != "blade"]  # the converter adds a box to every polygon
    agree(found, 1e-5, scores=False)
    blade_is_there(annotations)


def test_label_studio_video_is_unfolded_as_its_own_library_does() -> None:
    annotations = load_annotations(TOOLS / "label_studio_video.json")
    assert (annotations.format, annotations.clocks, annotations.n_frames) == ("label-studio", ("index+1",), 96)
    wanted = json.loads((TOOLS / "label_studio_video_frames.json").read_text())
    for track, frames in wanted.items():
        found = {int(d.key): d.box for d in annotations.detections if d.track_id == track}
        assert sorted(found) == [frame for frame, _ in frames]
        for frame, (x, y, width, height) in frames:
            assert found[frame] == pytest.approx((x / 100, y / 100, (x + width) / 100, (y + height) / 100))
    assert {d.label for d in annotations.detections if d.track_id == "track_b"} == {"coating_loss"}


def test_every_file_of_a_tool_is_named_in_the_readme() -> None:
    page = (TOOLS.parent / "README.md").read_text(encoding="utf-8")
    assert [path.name for path in sorted(TOOLS.iterdir()) if f"`{path.name}`" not in page] == []
