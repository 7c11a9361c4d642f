"""Region of interest: from shares of the source frame to a half-open pixel range."""

from __future__ import annotations

from core.errors import BadInput
from core.scene.frame import Crop
from core.settings.groups import RoiSettings

MIN_SIDE_PX = 64
"""A smaller crop holds too few keypoints for any of the methods here."""


def crop_of(roi: RoiSettings, width: int, height: int) -> Crop:
    """Crop of a width x height frame (px): shares times size, truncated (as in the thesis).

    960x720 with (0.04, 0.11, 0.86, 0.84) gives x 38:825, y 79:604 = 787x525.

    Raises:
        BadInput: `roi_empty` when right is not right of left or lower not below upper, `roi_outside` when
            it leaves the frame, `roi_too_small` below `MIN_SIDE_PX`.
    """
    shares = (roi.x0, roi.y0, roi.x1, roi.y1)
    text = ", ".join(f"{share:g}" for share in shares)
    if not all(0.0 <= share <= 1.0 for share in shares):
        raise BadInput(
            f"the region of interest ({text}) lies outside the frame [0, 1]", code="roi_outside", where="roi"
        )
    if roi.x1 <= roi.x0 or roi.y1 <= roi.y0:
        raise BadInput(
            f"the region of interest ({text}) is empty; it is left, upper, right, lower", code="roi_empty", where="roi"
        )
    crop = Crop(int(roi.x0 * width), int(roi.y0 * height), int(roi.x1 * width), int(roi.y1 * height), width, height)
    if min(crop.width, crop.height) < MIN_SIDE_PX:
        raise BadInput(
            f"the region of interest ({text}) is {crop.width}x{crop.height} px of a {width}x{height} px frame; "
            f"at least {MIN_SIDE_PX} px each way are needed",
            code="roi_too_small",
            where="roi",
        )
    return crop
