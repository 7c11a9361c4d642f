from __future__ import annotations

import numpy as np
import pytest

from core.checks.parallax import cases_parallax, largest_angle_deg, model_parallax
from core.products.contract import read_product
from core.products.search import CaseProduct
from tests.core.making_products import facts_of


def case(reason: str = "") -> CaseProduct:
    facts = facts_of(CaseProduct, status="no_model" if reason else "succeeded", reason=reason)
    return read_product(CaseProduct, facts, "coarse/x")


def test_a_clip_whose_cases_all_stand_still_has_no_parallax() -> None:
    flag = cases_parallax([case("no_parallax")] * 3 + [case("too_few_matches")])
    assert flag is not None
    assert (flag.code, flag.severity, flag.value, flag.where) == ("no_parallax", "error", 0.75, "3 of 4 cases")


@pytest.mark.parametrize(
    "cases",
    [
        [case("no_parallax"), case("no_parallax"), case()],
        [case("no_parallax"), case("no_initial_pair")],
        [case("too_few_matches")] * 4,
        [],
    ],
)
def test_a_model_or_other_reasons_speak_against_it(cases: list[CaseProduct]) -> None:
    assert cases_parallax(cases) is None


def test_a_model_of_tiny_angles_has_no_parallax() -> None:
    assert model_parallax(np.full(100, 9.0)) is None
    assert model_parallax(np.zeros(0)) is None
    flag = model_parallax(np.full(100, 1.6))
    assert flag is not None
    assert flag.code == "no_parallax"


def test_the_largest_angle_is_between_the_outermost_views() -> None:
    centers = np.array([[-1.0, 0, 0], [0, 0, 0], [1.0, 0, 0]])
    assert largest_angle_deg(np.array([0.0, 0, 1.0]), centers) == pytest.approx(90.0)
