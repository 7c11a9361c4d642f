"""From shares of the frame to pixels."""

from __future__ import annotations

import pytest

from core.errors import BadInput
from core.roi import crop_of
from core.settings import make_settings
from core.settings.groups import RoiSettings


def test_the_thesis_crops_960x720_to_787x525() -> None:
    crop = crop_of(RoiSettings(), 960, 720)
    assert (crop.x0, crop.x1, crop.y0, crop.y1) == (38, 825, 79, 604)
    assert (crop.width, crop.height) == (787, 525)


def test_the_full_frame_loses_no_pixel() -> None:
    crop = crop_of(RoiSettings(x0=0, y0=0, x1=1, y1=1), 541, 363)
    assert (crop.x0, crop.y0, crop.x1, crop.y1) == (0, 0, 541, 363)


@pytest.mark.parametrize(
    ("sides", "code", "cause"),
    [
        ((0.5, 0.1, 0.5, 0.9), "roi_empty", "is empty"),
        ((0.9, 0.1, 0.1, 0.9), "roi_empty", "left, upper, right, lower"),
        ((0.1, 0.9, 0.9, 0.1), "roi_empty", "is empty"),
        ((0.5, 0.5, 0.51, 0.9), "roi_too_small", "at least 64 px"),
    ],
)
def test_regions_without_room_are_refused(sides: tuple[float, ...], code: str, cause: str) -> None:
    roi = RoiSettings(**dict(zip(("x0", "y0", "x1", "y1"), sides, strict=True)))
    with pytest.raises(BadInput, match=cause) as caught:
        crop_of(roi, 960, 720)
    assert caught.value.code == code


def test_a_region_outside_the_frame_is_refused_by_name() -> None:
    with pytest.raises(BadInput, match=r"roi\.x1"):
        make_settings("default", {"roi.x1": 1.2})
    with pytest.raises(BadInput, match="outside the frame") as caught:
        crop_of(RoiSettings.model_construct(x0=-0.1, y0=0.0, x1=0.5, y1=0.5), 960, 720)
    assert caught.value.code == "roi_outside"
