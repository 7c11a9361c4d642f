"""Placement by the thesis's rules: one test per reason, and the place itself."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from core.mapping.rows import Detection
from core.mapping.support import Observations, SparseModel
from core.mapping.thesis import FrameTimes, Placement, match_frames, place_detections
from core.roi import Crop
from core.settings import make_settings
from core.settings.groups import MappingSettings
from tests.core.making_rows import detection

CROP = Crop(100, 100, 900, 700, 1000, 800)
PTS = make_settings("default").mapping
THESIS = make_settings("thesis").mapping
# Ten frames, one every 0.2 s, source frames 0, 5, 10 ...; registered are 3, 4 and 8.
ROWS = [{"index": i, "source_index": 5 * i, "time_s": 0.2 * i} for i in range(10)]


def frames(rule: str = "pts", rate: str = "25/1") -> FrameTimes:
    return FrameTimes.from_rows(ROWS, [3, 4, 8], rule, rate)


def model(indices: Sequence[int]) -> SparseModel:
    xy = np.array([[400.0, 300.0], [420.0, 310.0], [10.0, 10.0]])
    seen = Observations(xy, np.array([7, 5, 6]))
    positions = {5: np.array([2.0, 0, 0]), 6: np.array([9.0, 9, 9]), 7: np.array([0.0, 4, 0])}
    return SparseModel(dict.fromkeys(indices, seen), positions)


def place(found: Detection, settings: MappingSettings = PTS) -> Placement:
    return place_detections([found], frames(settings.time_rule), CROP, settings, model)[0]


def test_the_place_is_the_centroid_of_the_points_in_the_box() -> None:
    placed = place(detection(time_s=0.6, source_index=15))
    assert placed.point_ids.tolist() == [5, 7]
    row = placed.row
    assert (row.outcome, row.rung, row.reason, row.support_points, row.model) == ("mapped", "sparse", None, 2, 0)
    assert (row.x, row.y, row.z) == pytest.approx((1.0, 2.0, 0.0))
    assert row.frame_index == 3
    assert row.confidence is None


@pytest.mark.parametrize(
    ("found", "reason", "frame"),
    [
        (detection(time_s=99.0, source_index=None), "no_frame", None),
        (detection(time_s=0.0, source_index=0), "frame_not_registered", 0),
        (detection(time_s=0.1, source_index=2), "no_registered_view", None),
        (detection(time_s=0.6, source_index=15, box=(0.0, 0.0, 0.09, 0.1)), "outside_roi", 3),
        (detection(time_s=0.6, source_index=15, box=(0.8, 0.7, 0.85, 0.8)), "no_support", 3),
    ],
)
def test_reasons(found: Detection, reason: str, frame: int | None) -> None:
    placed = place(found)
    assert (placed.row.outcome, placed.row.reason, placed.row.frame_index) == ("unplaced", reason, frame)
    assert (placed.row.x, placed.row.rung, placed.row.model, placed.row.support_points) == (None, None, None, 0)
    assert not len(placed.point_ids)


def test_the_thesis_says_only_that_no_view_is_near() -> None:
    placed = place(detection(time_s=0.0, source_index=0), THESIS)
    assert (placed.row.reason, placed.row.frame_index) == ("no_registered_view", None)


def test_an_image_exactly_at_the_tolerance_is_too_far() -> None:
    table = FrameTimes.from_rows([{"index": 0, "source_index": 0, "time_s": 0.5}], [0], "pts", "25/1")
    near, far = detection(0, 0.75), detection(1, 1.0)
    assert match_frames([near, far], table, 0.5) == {0: 0}


def test_the_nearest_registered_image_wins_and_the_earlier_of_equals() -> None:
    wanted = [detection(0, 0.69), detection(1, 0.71), detection(2, 0.75), detection(3, 1.55)]
    assert match_frames(wanted, frames(), 0.4) == {0: 3, 1: 4, 2: 4, 3: 8}
    halfway = FrameTimes.from_rows(ROWS, [0, 1], "average_rate", "10/1")
    assert match_frames([detection(0, 0.25)], halfway, 0.4) == {0: 0}


def test_average_rate_is_index_over_rate_not_presentation_time() -> None:
    table = frames("average_rate", "30000/1001")
    assert table.time_s[4] == pytest.approx(20 * 1001 / 30000)


def test_every_detection_has_one_placement_in_input_order() -> None:
    asked = [detection(i, t, source_index=s) for i, (t, s) in enumerate([(1.6, 40), (50.0, None), (0.6, 15)])]
    placed = place_detections(asked, frames(), CROP, PTS, model)
    assert [p.row.id for p in placed] == [0, 1, 2]
    assert [p.row.outcome for p in placed] == ["mapped", "unplaced", "mapped"]


def test_without_registered_images_nothing_is_read() -> None:
    table = FrameTimes.from_rows(ROWS, [], "pts", "25/1")
    placed = place_detections([detection(0, 0.6, source_index=15)], table, CROP, PTS, model)
    assert placed[0].row.reason == "frame_not_registered"
