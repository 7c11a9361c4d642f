"""What time keys mean, on even and uneven video: every way of writing them finds its frames again."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from math import ceil, floor
from pathlib import Path
from typing import get_args

import pytest
from hypothesis import given
from hypothesis import strategies as st

from core.annotations.checks import parse_time
from core.annotations.clocks import CLOCKS, MEANINGS
from core.annotations.convention import Fitted, fit_convention
from core.annotations.reading import quantum
from core.annotations.summary import advice
from core.errors import BadInput
from core.settings.reading import InputSettings
from core.video.probe import probe_video
from core.video.table import FrameTable, ListedFrame, VideoInfo
from tests.core.making_videos import make_video
from tests.inputs import INPUTS

EVEN = [40 * i for i in range(50)]
UNEVEN = [0]
for _i in range(1, 60):
    UNEVEN.append(UNEVEN[-1] + (33 if _i % 7 else 97))


def table_of(times_ms: list[int], first: int = 0) -> FrameTable:
    rate = Fraction(1000 * (len(times_ms) - 1), times_ms[-1])
    end = float(Fraction(times_ms[-1], 1000) + 1 / rate)
    info = VideoInfo(100, 100, 0, False, rate, Fraction(1, 1000), end, len(times_ms), "h264", "", False)
    return FrameTable(info, tuple(ListedFrame(i, first + t, t / 1000, True, "") for i, t in enumerate(times_ms)))


def replace_rate(table: FrameTable, declared: Fraction) -> FrameTable:
    return replace(table, info=replace(table.info, declared_rate=declared))


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


def test_a_tenth_of_the_keys_may_share_frames_and_no_more() -> None:
    """Moments between frames, in seconds: of 40 keys 4 fall on the frame of another one, then 5 of 41."""
    keys = [f"{i / 25 + 0.0317:.4f}" for i in range(36)]
    shared = [f"{i / 25 + 0.0251:.4f}" for i in range(5)]
    assert fit([*keys, *shared[:4]], table_of(EVEN)).reading.clock == "displayed"
    with pytest.raises(BadInput) as caught:
        fit([*keys, *shared], table_of(EVEN))
    assert caught.value.code == "annotation_times_unclear"


def test_the_refusal_names_the_first_key_that_misses() -> None:
    keys = ["0.0000", *(f"{0.04 * (i // 2) + 0.013 + 0.011 * (i % 2):.4f}" for i in range(20))]
    with pytest.raises(BadInput) as caught:
        fit(keys, table_of(EVEN))
    assert caught.value.where == '"0.0130"'


def test_the_largest_miss_is_told_without_the_strays() -> None:
    fitted = fit([f"{i / 25 + (0.001 if i == 3 else 0):.4f}" for i in range(49)] + ["1.9750"], table_of(EVEN))
    assert fitted.reading.strays == ("1.9750",)
    assert fitted.reading.max_miss == Fraction(1, 1000)
    assert fitted.to_dict()["max_miss_s"] == 0.001


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


def test_the_last_digit() -> None:
    assert [quantum(key) for key in ("3", "0.25", "00:00:01.500")] == [1, Fraction(1, 100), Fraction(1, 1000)]
    assert [quantum(key) for key in ("1e1", "1.50E-3 ", "2.", "00:00:07")] == [10, Fraction(1, 100_000), 1, 1]


def test_a_tick_as_long_as_a_frame_excuses_nothing() -> None:
    table = probe_video(INPUTS / "m96.avi")
    assert table.info.time_base == 1 / table.info.average_rate
    with pytest.raises(BadInput) as caught:
        fit(list(json.loads((INPUTS / "k25.json").read_text())), table)
    assert caught.value.code == "annotation_times_unclear"


@pytest.mark.parametrize("off_ms", [3, 5])
def test_a_tenth_of_the_shortest_frame_is_excused(off_ms: int) -> None:
    keys = [f"{i / 25 + off_ms / 1000:.6f}" for i in range(40)]
    assert bool(fit(keys, table_of(EVEN)).flags) == (off_ms > 4)


def test_ticks_of_a_millisecond_do_not_hide_a_constant_rate() -> None:
    rate = Fraction(30000, 1001)
    table = table_of([floor(1000 * i / rate) for i in range(300)])
    fitted = fit([f"{float(i / rate):.6f}" for i in range(300)], table)
    assert (frames_of(fitted), fitted.flags) == (list(range(300)), ())


def test_numbers_below_the_length_in_seconds_may_be_frames() -> None:
    keys = list(json.loads((INPUTS / "frames_few.json").read_text()))
    table = probe_video(INPUTS / "m96.avi")
    fitted = fit(keys, table)
    assert (fitted.reading.clock, fitted.rivals) == ("pts", ("index",))
    assert [(flag.code, flag.severity) for flag in fitted.flags] == [("annotation_times_ambiguous", "warning")]
    where = fitted.flags[0].where
    for part in ("pts (seconds from the first frame)", "index (frame numbers from 0)", "input.time_convention"):
        assert part in where
    (said,) = advice(fitted)
    assert "frame 84" in said
    assert "frame 7)" in said
    for forced, frames in (("pts", list(range(0, 96, 12))), ("index", list(range(8)))):
        told = fit(keys, table, forced)
        assert (frames_of(told), told.flags, advice(told)) == (frames, (), [])


@pytest.mark.parametrize(
    "keys", [["0.0", "1.0"], ["0.00", "0.52", "1.48"], ["00:00:01"], ["0"], ["1.2", "0.4", "1"], ["0.480000"]]
)
def test_seconds_at_constant_rate_leave_no_other_reading(keys: list[str]) -> None:
    fitted = fit(keys, table_of(EVEN))
    assert frames_of(fitted) == [round(25 * parse_time(key)) for key in keys]
    assert all(flag.severity == "info" for flag in fitted.flags)


def test_one_key_at_the_end_may_come_from_a_player() -> None:
    some = fit([f"{i / 25:.4f}" for i in (10, 20, 50)], table_of(EVEN))
    assert (some.reading.clock, some.rivals) == ("average_rate+1", ("pts",))
    assert [flag.severity for flag in some.flags] == ["warning"]
    assert fit([f"{i / 25:.4f}" for i in range(1, 51)], table_of(EVEN)).flags == (), "all frames, and none twice"


def test_frame_numbers_without_the_first_may_count_from_one() -> None:
    fitted = fit(["3", "17", "40"], table_of(EVEN))
    assert (frames_of(fitted), fitted.rivals) == ([3, 17, 40], ("index+1",))
    assert [flag.severity for flag in fitted.flags] == ["warning"]


def test_sparse_keys_of_a_video_with_gaps_are_ambiguous_where_the_readings_part() -> None:
    times = [40 * i for i in range(60) if i not in (20, 30)]
    table = replace_rate(table_of(times), Fraction(25))
    late, early = fit(["0.0000", "0.1600", "2.0000"], table), fit(["0.0000", "0.1600", "0.7200"], table)
    assert (frames_of(late), late.rivals) == ([0, 4, 48], ("declared_rate",))
    assert [flag.severity for flag in late.flags] == ["warning"]
    assert (frames_of(early), early.flags) == ([0, 4, 18], ()), "before the gaps they agree"
    assert frames_of(fit(["0.0000", "0.8000", "2.0000"], table)) == [0, 20, 50], "no frame was shown at 0.8 s"


def test_milliseconds() -> None:
    keys = list(json.loads((INPUTS / "ms.json").read_text()))
    fitted = fit(keys, probe_video(INPUTS / "m96.avi"))
    assert (fitted.reading.clock, frames_of(fitted), fitted.flags) == ("milliseconds", list(range(96)), ())


def test_a_rate_that_is_not_declared_cannot_be_told() -> None:
    with pytest.raises(BadInput, match="declares no frame rate"):
        fit(["0.04"], table_of(EVEN), "declared_rate")


@pytest.mark.parametrize(("way", "frames"), [("floor", list(range(12, 120, 7))), ("nearest", list(range(12, 120, 7)))])
def test_two_decimals_of_a_fast_video(way: str, frames: list[int]) -> None:
    rate = Fraction(60000, 1001)
    table = table_of([round(1000 * i / rate) for i in range(120)])
    fitted = fit([rounded(i / rate, 2, WAYS[way]) for i in frames], table)
    assert frames_of(fitted) == frames


def test_keys_too_coarse_for_the_frames_are_said() -> None:
    rate = Fraction(30000, 1001)
    table = table_of([round(1000 * i / rate) for i in range(600)])
    fitted = fit(["00:00:07", "00:00:16"], table)
    assert [(flag.code, flag.severity) for flag in fitted.flags][:1] == [("annotation_times_inexact", "warning")]
    assert "too few decimals" in advice(fitted)[0]


def test_every_clock_that_is_tried_can_be_told() -> None:
    names = get_args(InputSettings.model_fields["time_convention"].annotation)
    assert names == ("auto", *CLOCKS)
    assert set(MEANINGS) == set(CLOCKS)


@pytest.mark.parametrize(
    ("numbers", "clock", "severity"),
    [
        (range(1, 21), "index+1", "info"),
        (range(1, 51), "index+1", None),  # the last frame of the video: from 0 it would lie outside
        (range(20), "index", None),
        (range(1, 6), "index", "warning"),  # so few may be chance
        ([*range(1, 15), 16], "index", "warning"),
        (range(2, 22), "index", "warning"),
    ],
)
def test_pictures_that_are_numbered_from_1_without_a_gap_count_from_1(
    numbers: list[int], clock: str, severity: str | None
) -> None:
    keys = {str(number): Fraction(number) for number in numbers}
    fitted = fit_convention(keys, table_of(EVEN), among=("index", "index+1"))
    assert fitted.reading.clock == clock
    first = next(iter(keys))
    assert fitted.reading.frames[first] == int(first) - (clock == "index+1")
    assert [flag.severity for flag in fitted.flags] == ([] if severity is None else [severity])
    # Keys of our own form are times first; nothing changes for them.
    assert fit([f"{number / 25:.2f}" for number in range(1, 21)], table_of(EVEN)).reading.clock == "pts"
