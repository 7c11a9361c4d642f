from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from core.checks.lens import check_left, check_lens, check_shift
from core.checks.model import check_coverage, check_points, check_reprojection
from core.flags import Flag
from core.geometry.fisheye import fisheye_radius, viewing_angle
from core.geometry.lens import LensModel, make_lens

FISHEYE = LensModel.OPENCV_FISHEYE


def codes(flags: Sequence[Flag]) -> list[str]:
    return [flag.code for flag in flags]


def raised(flag: Flag | None) -> Flag:
    assert flag is not None
    return flag


def test_limits_of_what_a_model_holds() -> None:
    assert check_points(54478, 180) is None
    assert raised(check_points(100, 60)).code == "few_points"
    assert check_coverage(180, 360) is None
    assert raised(check_coverage(179, 360)).code == "coverage_low"
    assert raised(check_coverage(0, 0)).code == "coverage_low"
    assert check_reprojection(1.1958) is None
    assert raised(check_reprojection(2.5)).value == 2.5


def test_the_lens_of_a_borescope_is_plausible() -> None:
    assert check_lens(787, 525, make_lens(FISHEYE, [520, 520, 442, 281, 0.04, 0.005, 0, 0])) == []


@pytest.mark.parametrize(
    ("focal", "code"), [(4000.0, ["focal_implausible"]), (150.0, ["focal_implausible"]), (520.0, [])]
)
def test_field_of_view_outside_of_15_to_200_degrees(focal: float, code: list[str]) -> None:
    assert codes(check_lens(787, 525, make_lens(FISHEYE, [focal, focal, 393, 262, 0, 0, 0, 0]))) == code


def test_a_polynomial_that_turns_back_inside_the_image_is_flagged() -> None:
    flags = check_lens(540, 360, make_lens(FISHEYE, [566, 558, 270, 180, 0.6, -0.55, -8.8, 5]))
    assert codes(flags) == ["distortion_implausible"]


def test_a_perspective_lens_is_judged_by_its_own_polynomial() -> None:
    # 500 px see 90 degrees over 1000 px; as a fisheye it would be 115 degrees.
    assert check_lens(1000, 600, make_lens("PINHOLE", [500, 500, 500, 300])) == []
    assert codes(check_lens(1000, 600, make_lens("PINHOLE", [4500, 4500, 500, 300]))) == ["focal_implausible"]
    assert check_lens(1000, 600, make_lens("OPENCV", [500, 500, 500, 300, -0.1, 0.02, 0, 0])) == []
    # 1 - 0.9 t^2 is 0 at t = 1.05, and the polynomial reaches no farther than 0.70 focal lengths.
    folded = check_lens(1000, 600, make_lens("SIMPLE_RADIAL", [500, 500, 300, -0.3]))
    assert codes(folded) == ["distortion_implausible"]


def test_a_focal_length_that_moves_with_the_choice_of_tracks_is_flagged() -> None:
    assert check_shift(0.05) is None
    assert check_shift(-0.05) is None
    flag = raised(check_shift(-0.2))
    assert (flag.code, flag.severity, flag.value) == ("lens_unsettled", "warning", 0.2)


def test_a_focal_length_that_left_what_a_span_said_is_flagged() -> None:
    assert check_left(520.0, []) is None
    assert check_left(520.0, [600.0, 460.0]) is None
    assert check_left(298.7, [253.3, 276.4]) is None, "right, though its clip has hardly any texture to say so"
    assert raised(check_left(280.0, [404.0])).code == "lens_unsettled"
    flag = raised(check_left(802.0, [790.0, 444.0]))
    assert flag.code == "lens_unsettled"
    assert flag.value == pytest.approx(802 / 444 - 1)


DIFFER = ["focal_lengths_differ"]


@pytest.mark.parametrize(("aspect", "code"), [(0.98, []), (1.02, []), (0.65, DIFFER), (1.04, DIFFER)])
def test_pixels_are_square(aspect: float, code: list[str]) -> None:
    assert codes(check_lens(787, 525, make_lens(FISHEYE, [520 * aspect, 520, 393, 262, 0, 0, 0, 0]))) == code


def test_viewing_angle_inverts_the_polynomial() -> None:
    distortion = np.array([0.04, 0.005, -0.002, 0.0])
    for theta in (0.0, 0.3, 0.9):
        radius = float(fisheye_radius(np.array([theta]), distortion)[0])
        assert viewing_angle(radius, distortion) == pytest.approx(theta, abs=1e-5)
    assert viewing_angle(3.0, np.array([-0.5, 0, 0, 0.0])) is None
