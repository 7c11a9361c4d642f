"""Stamps to times: what is missing, double or starts again."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

import pytest

from core.video.clock import PresentationClock


def times(stamps: Sequence[int | None], duration: int = 0) -> tuple[list[int], int, list[int]]:
    """Times in ms at 25 frames/s, frames repaired, frames at which a recording begins."""
    clock = PresentationClock(Fraction(1, 1000), Fraction(25))
    found = [clock.time(stamp, duration) for stamp in stamps]
    clock.finish()
    return found, clock.repaired, clock.joined


@pytest.mark.parametrize(
    ("stamps", "expected", "repaired", "joined"),
    [
        ([1400, 1440, 1480], [1400, 1440, 1480], 0, []),
        ([0, 40, None, 120], [0, 40, 80, 120], 1, []),
        ([None, None, None], [0, 40, 80], 3, []),
        ([0, 40, 40, 80], [0, 40, 41, 80], 1, []),
        ([0, 40, 80, 0, 40, 80], [0, 40, 80, 120, 160, 200], 0, [3]),
        ([500, 540, 90, 130, 10, 50], [500, 540, 580, 620, 660, 700], 0, [2, 4]),
        # One stamp that slipped, between others that go on.
        ([0, 40, 20, 120, 160], [0, 40, 80, 120, 160], 1, []),
        ([0, 40, 80, 30], [0, 40, 80, 120], 1, []),
        # A pause of the recorder is no join.
        ([0, 40, 9000, 9040], [0, 40, 9000, 9040], 0, []),
    ],
)
def test_times_ascend_and_say_what_was_done(
    stamps: Sequence[int | None], expected: list[int], repaired: int, joined: list[int]
) -> None:
    assert times(stamps) == (expected, repaired, joined)


def test_a_frame_that_says_how_long_it_lasts_is_followed_after_that_long() -> None:
    assert times([0, 100, 0, 100], duration=100) == ([0, 100, 200, 300], 0, [2])
