from __future__ import annotations

import numpy as np
import pytest

from core.checks.parallax import cases_parallax, largest_angle_deg, model_parallax


def case(reason: str = "", status: str = "no_model") -> dict[str, str]:
    return {"status": "succeeded" if not reason else status, "reason": reason}


def test_a_clip_whose_cases_all_stand_still_has_no_parallax() -> None:
    flag = cases_parallax([case("no_parallax")] * 3 + [case("too_few_matches")])
    assert flag is not None
    assert (flag.code, flag.severity, flag.value, flag.where) == ("no_parallax", "error", 0.75, "3 of 4 cases")


@pytest.mark.parametrize(
    "rows",
    [
        [case("no_parallax"), case("no_parallax"), case()],
        [case("no_parallax"), case("no_initial_pair")],
        [case("too_few_matches")] * 4,
        [],
    ],
)
def test_a_model_or_other_reasons_speak_against_it(rows: list[dict[str, str]]) -> None:
    assert cases_parallax(rows) is None


def test_a_model_of_tiny_angles_has_no_parallax() -> None:
    assert model_parallax(np.full(100, 9.0)) is None
    assert model_parallax(np.zeros(0)) is None
    flag = model_parallax(np.full(100, 1.6))
    assert flag is not None
    assert flag.code == "no_parallax"


def test_the_largest_angle_is_between_the_outermost_views() -> None:
    centers = np.array([[-1.0, 0, 0], [0, 0, 0], [1.0, 0, 0]])
    assert largest_angle_deg(np.array([0.0, 0, 1.0]), centers) == pytest.approx(90.0)
