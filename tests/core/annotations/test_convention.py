"""What time keys mean, on even and uneven video: every way of writing them finds its frames again."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from math import ceil, floor
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from core.annotations.checks import parse_time
from core.annotations.convention import Fitted, fit_convention, quantum
from core.errors import BadInput
from core.video.probe import probe_video
from core.video.table import FrameRow, FrameTable, VideoInfo
from tests.core.making_videos import make_video

EVEN = [40 * i for i in range(50)]
UNEVEN = [0]
for _i in range(1, 60):
    UNEVEN.append(UNEVEN[-1] + (33 if _i % 7 else 97))


def table_of(times_ms: list[int], first: int = 0) -> FrameTable:
    rate = Fraction(1000 * (len(times_ms) - 1), times_ms[-1])
    end = float(Fraction(times_ms[-1], 1000) + 1 / rate)
    info = VideoInfo(100, 100, 0, False, rate, Fraction(1, 1000), end, len(times_ms), "h264", "", False)
    return FrameTable(info, tuple(FrameRow(i, first + t, t / 1000, True, "") for i, t in enumerate(times_ms)))


def fit(keys: list[str], table: FrameTable, forced: str = "auto") -> Fitted:
    return fit_convention({key: parse_time(key) for key in keys}, table, forced)


def frames_of(fitted: Fitted) -> list[int | None]:
    return list(fitted.reading.frames.values())


def rounded(value: Fraction, decimals: int, way: Callable[[Fraction], int]) -> str:
    scaled = way(value * 10**decimals)
    return f"{scaled // 10**decimals}.{scaled % 10**decimals:0{decimals}d}"


WAYS: dict[str, Callable[[Fraction], int]] = {"nearest": round, "floor": floor, "ceil": ceil}


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("decimals", [2, 3, 4])
def test_times_of_frames_on_uneven_video(way: str, decimals: int) -> None:
    table = table_of(UNEVEN)
    keys = [rounded(table.time(i), decimals, WAYS[way]) for i in range(60)]
    fitted = fit(keys, table)
    assert fitted.reading.clock == "pts"
    assert frames_of(fitted) == list(range(60))
    assert fitted.reading.rounding == ("exact" if decimals > 2 else way)


@pytest.mark.parametrize("base", [0, 1])
def test_numbers_over_the_average_rate_on_uneven_video(base: int) -> None:
    table = table_of(UNEVEN)
    keys = [rounded((i + base) / table.info.average_rate, 4, round) for i in range(60)]
    fitted = fit(keys, table)
    assert fitted.reading.clock == ("average_rate+1" if base else "average_rate")
    assert frames_of(fitted) == list(range(60))
    by_pts = frames_of(fit(keys, table, "pts"))
    assert by_pts != list(range(60)), "read as presentation times the same keys mean other frames"


def test_counted_from_one_on_even_video_shows_at_the_end() -> None:
    table = table_of(EVEN)
    fitted = fit([f"{(i + 1) / 25:.4f}" for i in range(50)], table)
    assert fitted.reading.clock == "average_rate+1"
    assert frames_of(fitted) == list(range(50))


def test_a_shift_that_nothing_shows_is_said() -> None:
    fitted = fit([f"{i / 25:.4f}" for i in range(10, 20)], table_of(EVEN))
    assert fitted.reading.clock == "pts"
    assert fitted.rivals == ("average_rate+1",)
    assert [flag.code for flag in fitted.flags] == ["annotation_times_ambiguous"]
    assert fit([f"{i / 25:.4f}" for i in range(50)], table_of(EVEN)).flags == ()


def test_frame_numbers() -> None:
    assert frames_of(fit([str(i) for i in range(0, 50, 7)], table_of(EVEN))) == list(range(0, 50, 7))
    from_one = fit([str(i) for i in range(1, 51)], table_of(EVEN))
    assert from_one.reading.clock == "index+1"
    assert frames_of(from_one) == list(range(50))
    whole_seconds = fit(["0", "1"], table_of(EVEN))
    assert (whole_seconds.reading.clock, frames_of(whole_seconds)) == ("pts", [0, 25])


def test_a_video_that_does_not_start_at_zero() -> None:
    table = table_of(EVEN, first=1500)
    stored = fit([f"{1.5 + i / 25:.3f}" for i in range(50)], table)
    assert (stored.reading.clock, frames_of(stored)) == ("container", list(range(50)))
    assert frames_of(fit([f"{i / 25:.3f}" for i in range(50)], table)) == list(range(50))


def test_moments_between_frames_and_a_few_strays() -> None:
    table = table_of(EVEN)
    between = fit([f"{i / 25 + 0.0317:.4f}" for i in range(40)], table)
    assert (between.reading.clock, frames_of(between)) == ("displayed", list(range(40)))
    assert [(flag.code, flag.severity) for flag in between.flags] == [("annotation_times_inexact", "warning")]
    keys = [f"{row.time_s:.4f}" for row in table_of([40 * i for i in range(100)]).rows]
    keys[50] = "2.0131"
    one = fit(keys, table_of([40 * i for i in range(100)]))
    assert one.reading.strays == ("2.0131",)
    assert [(flag.code, flag.severity) for flag in one.flags] == [("annotation_times_inexact", "info")]


def test_keys_of_something_else_are_refused_with_a_diagnosis() -> None:
    keys = [f"{i * 0.0171:.4f}" for i in range(110)]  # 58 frames a second
    with pytest.raises(
        BadInput, match=r"by the best one, .*keys miss every frame.*set input.time_convention"
    ) as caught:
        fit(keys, table_of(EVEN))
    assert caught.value.code == "annotation_times_unclear"
    assert fit(keys, table_of(EVEN), "displayed").forced


def test_a_convention_can_be_told() -> None:
    keys = [f"{i / 25:.4f}" for i in range(1, 20)]
    assert frames_of(fit(keys, table_of(EVEN), "average_rate+1")) == list(range(19))
    with pytest.raises(BadInput, match=r"one of auto, pts"):
        fit(keys, table_of(EVEN), "sidereal")


def test_the_table_of_a_real_uneven_video(tmp_path: Path) -> None:
    times = [0, 40, 95, 120, 250, 290, 300, 455]
    make_video(tmp_path / "video.mp4", times)
    table = probe_video(tmp_path / "video.mp4")
    assert [round(1000 * row.time_s) for row in table.rows] == times
    assert len({row.sha256 for row in table.rows}) == len(times)
    fitted = fit([f"{ms / 1000:.3f}" for ms in times], table)
    assert frames_of(fitted) == list(range(len(times)))


@given(st.lists(st.integers(5, 200), min_size=3, max_size=40), st.integers(3, 6))
def test_any_video_gives_its_own_times_their_frames(steps: list[int], decimals: int) -> None:
    times = [0]
    for step in steps:
        times.append(times[-1] + step)
    table = table_of(times)
    keys = [rounded(table.time(i), decimals, round) for i in range(len(times))]
    assert frames_of(fit(keys, table)) == list(range(len(times)))


def test_the_last_decimal() -> None:
    assert [quantum(key) for key in ("3", "0.25", "00:00:01.500")] == [1, Fraction(1, 100), Fraction(1, 1000)]
