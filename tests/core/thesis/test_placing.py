"""Placement by the thesis's rules: one test per reason, and the place itself."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from core.mapping.support import Observations, SparseModel
from core.scene.detection import Detection
from core.scene.frame import Crop, RunFrames
from core.settings import make_settings
from core.settings.groups import MappingSettings
from core.thesis.placing import Placement, match_frames, place_detections
from tests.core.making_rows import detection, run_frames

CROP = Crop(100, 100, 900, 700, 1000, 800)
PTS = make_settings("default").mapping
THESIS = make_settings("thesis").mapping
# Ten frames, one every 0.2 s, source frames 0, 5, 10 ...; registered are 3, 4 and 8.
FRAMES, REGISTERED = run_frames(10, 0.2, every=5), (3, 4, 8)


def model(indices: Sequence[int]) -> SparseModel:
    xy = np.array([[400.0, 300.0], [420.0, 310.0], [10.0, 10.0]])
    seen = Observations(xy, np.array([7, 5, 6]))
    positions = {5: np.array([2.0, 0, 0]), 6: np.array([9.0, 9, 9]), 7: np.array([0.0, 4, 0])}
    return SparseModel(dict.fromkeys(indices, seen), positions)


def place(found: Detection, settings: MappingSettings = PTS) -> Placement:
    frames = FRAMES if settings.time_rule == "pts" else FRAMES.timed_by_rate([Fraction(25)])
    return place_detections([found], frames, REGISTERED, CROP, settings, model)[0]


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
    frame = RunFrames((replace(FRAMES[0], time_s=0.5),))
    near, far = detection(0, 0.75), detection(1, 1.0)
    assert match_frames([near, far], frame, [0], 0.5) == {0: 0}


def test_the_nearest_registered_image_wins_and_the_earlier_of_equals() -> None:
    wanted = [detection(0, 0.69), detection(1, 0.71), detection(2, 0.75), detection(3, 1.55)]
    assert match_frames(wanted, FRAMES, REGISTERED, 0.4) == {0: 3, 1: 4, 2: 4, 3: 8}
    halfway = FRAMES.timed_by_rate([Fraction(10)])
    assert match_frames([detection(0, 0.25)], halfway, [0, 1], 0.4) == {0: 0}


def test_average_rate_is_index_over_rate_not_presentation_time() -> None:
    assert FRAMES.timed_by_rate([Fraction(30000, 1001)])[4].time_s == pytest.approx(20 * 1001 / 30000)


def test_every_detection_has_one_placement_in_input_order() -> None:
    asked = [detection(i, t, source_index=s) for i, (t, s) in enumerate([(1.6, 40), (50.0, None), (0.6, 15)])]
    placed = place_detections(asked, FRAMES, REGISTERED, CROP, PTS, model)
    assert [p.row.id for p in placed] == [0, 1, 2]
    assert [p.row.outcome for p in placed] == ["mapped", "unplaced", "mapped"]


def test_without_registered_images_nothing_is_read() -> None:
    placed = place_detections([detection(0, 0.6, source_index=15)], FRAMES, [], CROP, PTS, model)
    assert placed[0].row.reason == "frame_not_registered"
