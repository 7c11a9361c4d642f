"""Keys become frames by exact time; what lies outside is kept and said."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from core.annotations.masks import blade_mask, rasterise
from core.annotations.parse import parse_annotations
from core.annotations.placed import place
from core.annotations.summary import summarise
from core.errors import BadInput
from core.io.annotations import read_detections, read_looked_at, read_masks, write_annotations
from core.scene.detection import Mask
from core.scene.frame import Crop, SourceFrame
from core.video.table import FrameTable, ListedFrame, VideoInfo

DENT = {"label": "dent", "score": 0.5, "bbox": [0.2, 0.2, 0.4, 0.4]}
TRIANGLE = [[0.1, 0.1], [0.3, 0.1], [0.2, 0.3]]


def table_of(times_ms: list[int], *, truncated: bool = False) -> FrameTable:
    rate = Fraction(1000 * (len(times_ms) - 1), times_ms[-1])
    info = VideoInfo(
        100, 100, 0, False, rate, Fraction(1, 1000), float(Fraction(times_ms[-1], 1000) + 1 / rate), len(times_ms),
        "h264", "", truncated,
    )  # fmt: skip
    return FrameTable(info, tuple(ListedFrame(i, t, t / 1000, True, "") for i, t in enumerate(times_ms)))


def entries(*keys: str) -> dict[str, object]:
    return {key: {"detections": [DENT]} for key in keys}


def test_exact_times_decide() -> None:
    table = table_of([0, 100, 300, 310, 1000])
    placed = place(parse_annotations(entries("0.0", "0.1", "0.301", "0.309", "00:00:01")), table)
    assert [d.source_index for d in placed.detections] == [0, 1, 2, 3, 4]
    assert placed.convention.reading.clock == "pts"
    assert placed.flags == ()


def test_times_between_frames_mean_the_one_on_screen() -> None:
    placed = place(parse_annotations(entries("0.01", "0.199", "0.305", "0.9")), table_of([0, 100, 300, 310, 1000]))
    assert [d.source_index for d in placed.detections] == [0, 1, 2, 3]
    assert [flag.code for flag in placed.flags] == ["annotation_times_inexact"]


def test_keys_rounded_to_four_decimals_meet_their_frame() -> None:
    table = table_of(list(range(0, 8000, 83)))
    keys = [f"{row.time_s:.4f}" for row in table.rows]
    placed = place(parse_annotations(entries(*keys)), table)
    assert [d.source_index for d in placed.detections] == list(range(len(keys)))


def test_a_few_keys_beyond_the_end_are_kept_without_a_frame() -> None:
    annotations = parse_annotations(entries("0.0", "0.4", "7.0"))
    placed = place(annotations, table_of([0, 100, 200, 300, 400]))
    assert [d.source_index for d in placed.detections] == [0, 4, None]
    assert [flag.code for flag in placed.flags] == ["annotations_outside_video"]
    summary = summarise(annotations, placed)
    assert (summary.n_keys_outside_video, summary.n_annotated_frames) == (1, 2)
    assert summary.warnings == ("key '7.0' lies outside the video",)


def test_mostly_foreign_keys_mean_another_video() -> None:
    annotations = parse_annotations(entries("0.0", "7.0", "8.0"))
    with pytest.raises(BadInput, match=r'2 of 3 time keys lie beyond its end at 0.500 s \(the latest is "8.0"\)'):
        place(annotations, table_of([0, 100, 200, 300, 400]))
    assert place(annotations, table_of([0, 100, 200, 300, 400], truncated=True)).detections[2].source_index is None


@pytest.mark.parametrize(("keys", "convention"), [(["1", "3", "9"], "index"), (["100", "310", "9000"], "milliseconds")])
def test_times_are_seconds_whatever_the_keys_are(keys: list[str], convention: str) -> None:
    annotations = parse_annotations(entries(*keys))
    placed = place(annotations, table_of([0, 100, 300, 310, 1000]), convention)
    assert [(d.source_index, d.time_s) for d in placed.detections][:2] == [(1, 0.1), (3, 0.31)]
    assert placed.detections[2].source_index is None
    assert placed.detections[2].time_s == (9 / 4 if convention == "index" else 9.0)
    summary = summarise(annotations, placed)
    assert (summary.first_time_s, summary.last_time_s) == (0.1, 0.31)


def test_files_give_back_what_was_placed(tmp_path: Path) -> None:
    value = {
        "0.1": {
            "detections": [{**DENT, "polygon": TRIANGLE, "track_id": "a"}, {**DENT, "score": None}],
            "masks": [{"label": "blade", "polygon": TRIANGLE}],
        },
        "0.101": {"masks": [{"label": "blade", "polygon": TRIANGLE}]},
    }
    placed = place(parse_annotations(value), table_of([0, 100, 200]))
    write_annotations(tmp_path, placed.detections, placed.masks, placed.looked_at)
    assert tuple(read_detections(tmp_path)) == placed.detections
    assert read_masks(tmp_path) == placed.masks
    assert read_looked_at(tmp_path) == list(placed.looked_at)
    assert len(placed.masks[SourceFrame(0, 1)]) == 2, "two keys on one frame both count"


def test_a_rectangle_covers_exactly_its_pixels_of_the_crop() -> None:
    crop = Crop(10, 20, 60, 80, 100, 100)
    polygon = ((0.20, 0.30), (0.40, 0.30), (0.40, 0.50), (0.20, 0.50))
    mask = rasterise([polygon], crop)
    assert mask.shape == (60, 50)
    expected = np.zeros((60, 50), bool)
    expected[10:30, 10:30] = True
    assert np.logical_xor(mask, expected).sum() <= 2 * 21 + 2 * 21, "at most the pixels on the outline differ"
    assert mask[10:30, 10:30].all()


def test_only_blades_count_and_none_is_said() -> None:
    crop = Crop(0, 0, 100, 100, 100, 100)
    assert blade_mask([Mask("dent", ((0, 0), (1, 0), (1, 1)))], crop) is None
    upper = Mask("blade", ((0.0, 0.0), (1.0, 0.0), (1.0, 0.2), (0.0, 0.2)))
    lower = Mask("Blade", ((0.0, 0.8), (1.0, 0.8), (1.0, 1.0), (0.0, 1.0)))
    mask = blade_mask([upper, lower], crop)
    assert mask is not None
    assert mask[:20].all()
    assert mask[80:].all()
    assert not mask[22:78].any()
