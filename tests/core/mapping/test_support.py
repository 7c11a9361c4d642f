from __future__ import annotations

import numpy as np
import pytest

from core.mapping.support import Observations, box_in_crop_px, overlaps_crop
from core.scene.frame import Crop

CROP = Crop(38, 79, 825, 604, 960, 720)


def test_a_source_box_is_shifted_by_the_crop_exactly() -> None:
    box = box_in_crop_px((38 / 960, 79 / 720, 825 / 960, 604 / 720), CROP, "source")
    assert box == pytest.approx((0, 0, 787, 525))


def test_a_crop_box_is_scaled_to_the_crop() -> None:
    assert box_in_crop_px((0.0, 0.25, 0.5, 1.0), CROP, "crop") == pytest.approx((0, 131.25, 393.5, 525))


def test_the_two_readings_differ_by_many_pixels_off_centre() -> None:
    source, crop = (box_in_crop_px((0.7, 0.7, 0.75, 0.75), CROP, frame) for frame in ("source", "crop"))
    assert abs(source[0] - crop[0]) > 80


@pytest.mark.parametrize(
    ("box", "inside"),
    [((-9, -9, -1, 50), False), ((-9, -9, 1, 1), True), ((787, 0, 900, 50), False), ((10, 524, 20, 700), True)],
)
def test_overlap_with_the_crop(box: tuple[float, float, float, float], inside: bool) -> None:
    assert overlaps_crop(box, CROP) is inside


def test_points_inside_a_box_are_unique_sorted_and_include_the_border() -> None:
    xy = np.array([[5.0, 5.0], [10.0, 10.0], [10.1, 5.0], [7.0, 7.0], [4.9, 5.0]])
    seen = Observations(xy, np.array([9, 2, 4, 9, 1]))
    assert seen.inside((5.0, 5.0, 10.0, 10.0)).tolist() == [2, 9]
