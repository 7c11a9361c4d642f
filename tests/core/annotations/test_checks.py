"""Limits of single values, from both sides, and how a message shows what it refuses."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest

from core.annotations.checks import as_box, as_polygon, as_share, as_track_id, parse_time, shown
from core.errors import BadInput
from core.geometry.boxes import bounding_box, box_iou


@pytest.mark.parametrize(("value", "kept"), [("7", "7"), (7, 7), (None, None)])
def test_a_track_is_named_by_a_text_or_a_whole_number(value: object, kept: object) -> None:
    assert as_track_id(value, "here") == kept


@pytest.mark.parametrize("value", [True, 1.0, ["7"], {}])
def test_nothing_else_names_a_track(value: object) -> None:
    with pytest.raises(
        BadInput, match=f"here must be a text or a whole number, not {shown(value)}".replace("[", r"\[")
    ):
        as_track_id(value, "here")


@pytest.mark.parametrize(("value", "kept"), [(-1e-6, 0.0), (0.0, 0.0), (0.25, 0.25), (1.0, 1.0), (1.0 + 9e-7, 1.0)])
def test_a_share_may_be_rounded_over_the_edge(value: float, kept: float) -> None:
    assert as_share(value, "here", "box_outside") == kept


@pytest.mark.parametrize(
    ("value", "code", "pixels"),
    [(-1.1e-6, "box_outside", False), (1.0 + 1.1e-6, "box_outside", False), (2, "box_outside", False),
     (2.01, "box_outside", True), (640, "bad_score", False)],
)  # fmt: skip
def test_a_share_beyond_the_edge_is_refused_and_pixels_are_guessed(value: float, code: str, pixels: bool) -> None:
    with pytest.raises(BadInput) as caught:
        as_share(value, "here", code)
    assert (caught.value.code, caught.value.where) == (code, "here")
    assert ("pixels?" in caught.value.message) == pixels


@pytest.mark.parametrize(
    "box", [[0.2, 0.2, 0.2, 0.4], [0.2, 0.4, 0.4, 0.4], [0.4, 0.2, 0.2, 0.4], [0.2, 0.4, 0.4, 0.2]]
)
def test_a_box_has_a_width_and_a_height(box: list[float]) -> None:
    with pytest.raises(BadInput) as caught:
        as_box(box, "here")
    assert caught.value.code == "box_inverted"


def test_a_wrong_value_is_named_by_its_place() -> None:
    for value, where in (
        [[0.1, 0.2, 0.3, 7], "here[3]"],
        [[0.1, None, 0.3, 0.4], "here[1]"],
        [[0.1, 0.2, 0.3], "here"],
    ):
        with pytest.raises(BadInput) as caught:
            as_box(value, "here")
        assert caught.value.where == where
    for corners, where in ([[[0.1, 0.2], [0.3]], "here[1]"], [[[0.1, 0.2], [0.3, 7]], "here[1][1]"]):
        with pytest.raises(BadInput) as caught:
            as_polygon(corners, "here")
        assert caught.value.where == where


@pytest.mark.parametrize(
    ("value", "text"),
    [
        ({"a": 1}, "an object"),
        ([1, 2.5, 3, 4], "[1, 2.5, 3, 4]"),
        ([1, 2, 3, 4, 5], "a list"),
        ([1, "2"], "a list"),
        ("x" * 60, '"' + "x" * 60 + '"'),
        ("x" * 61, '"' + "x" * 60 + '..."'),
        (10**119, "1" + "0" * 119),
        (10**120, "1" + "0" * 119 + "..."),
        (None, "null"),
        (b"", "a value of type bytes"),
    ],
)
def test_a_message_shows_short_values(value: Any, text: str) -> None:
    assert shown(value) == text


def test_a_time_has_at_most_forty_characters() -> None:
    assert parse_time(f"  1.{'0' * 38}  ") == 1
    with pytest.raises(BadInput, match="is not a time"):
        parse_time(f"1.{'0' * 39}")
    assert parse_time("01:01:01.5") == Fraction(7323, 2)
    for negative in ("-1", "-00:00:01"):
        with pytest.raises(BadInput, match="is a negative time"):
            parse_time(negative)


def test_overlap_of_boxes_by_hand() -> None:
    assert box_iou((0, 0, 2, 2), (1, 1, 3, 3)) == pytest.approx(1 / 7)
    assert box_iou((0, 0, 4, 2), (1, 0, 3, 1)) == pytest.approx(2 / 8)
    assert box_iou((0.1, 0.2, 0.5, 0.4), (0.1, 0.2, 0.5, 0.4)) == pytest.approx(1)
    assert box_iou((0, 0, 2, 2), (2, 0, 3, 2)) == box_iou((0, 0, 2, 2), (0, 3, 2, 4)) == 0.0
    assert bounding_box(((0.3, 0.6), (0.1, 0.5), (0.2, 0.9))) == (0.1, 0.5, 0.3, 0.9)
