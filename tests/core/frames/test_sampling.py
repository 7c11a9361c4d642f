"""Which frames take part: the thesis's numbers, intervals, roles and budget."""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from core.errors import BadInput
from core.frames.sampling import Interval, Stretch, choose_frames, clip_interval, sample_uniformly
from core.scene.frame import Role
from core.settings import make_settings
from core.video.table import FrameTable, ListedFrame, VideoInfo


def table_of(times: list[Fraction], rate: Fraction) -> FrameTable:
    unit = Fraction(1, 90_000)
    rows = tuple(ListedFrame(i, round(t / unit), float(t), i == 0, f"{i:064x}") for i, t in enumerate(times))
    info = VideoInfo(960, 720, 0, False, rate, unit, float(times[-1] + 1 / rate), len(rows), "h264", "0" * 64, False)
    return FrameTable(info, rows)


def constant_rate(rate: Fraction, n_frames: int) -> FrameTable:
    return table_of([i / rate for i in range(n_frames)], rate)


THESIS_VIDEO = constant_rate(Fraction("29.8"), 3745)


def interval_of(table: FrameTable, preset: str, **options: float) -> Interval:
    settings = make_settings(preset, {f"frames.{name}": value for name, value in options.items()})
    return clip_interval(table, settings.frames, settings.overrides)


def test_the_thesis_samples_450_frames_from_60_to_3606() -> None:
    interval = interval_of(THESIS_VIDEO, "thesis")
    assert (interval.first, interval.last, interval.flags) == (60, 3606, ())
    chosen = choose_frames([Stretch(interval, {100, 200})], make_settings("thesis").frames)
    sources = [frame.source.source_index for frame in chosen]
    assert len(sources) == len(set(sources)) == 450
    assert (sources[0], sources[-1]) == (60, 3606)
    assert sources == [round(60 + i * 3546 / 449) for i in range(450)]
    assert {b - a for a, b in pairwise(sources)} == {7, 8}
    assert [frame.index for frame in chosen] == list(range(450))
    assert {frame.role for frame in chosen} == {"sampled"}


def test_the_average_rate_rule_differs_from_exact_times_where_the_rate_varies() -> None:
    times = [Fraction(i, 10) for i in range(100)] + [10 + Fraction(i, 30) for i in range(300)]
    table = table_of(times, Fraction(20))
    assert interval_of(table, "default", clip_start_s=5, clip_end_s=15).first == 50
    assert interval_of(table, "thesis", clip_start_s=5, clip_end_s=15).first == 100


@given(st.integers(0, 5000), st.integers(0, 5000), st.integers(2, 700))
def test_samples_are_increasing_and_reach_both_ends(first: int, length: int, count: int) -> None:
    sampled = sample_uniformly(first, first + length, count)
    assert len(sampled) == min(count, length + 1)
    assert sampled == sorted(set(sampled))
    assert sampled[0] == first
    assert length == 0 or sampled[-1] == first + length


def test_a_presets_interval_is_cut_to_the_video() -> None:
    table = constant_rate(Fraction(12), 360)
    interval = interval_of(table, "thesis")
    assert (interval.first, interval.last) == (24, 359)
    assert [flag.code for flag in interval.flags] == ["interval_clipped"]


def test_a_preset_that_leaves_under_ten_seconds_uses_the_whole_video() -> None:
    interval = interval_of(constant_rate(Fraction(12), 130), "thesis")
    assert (interval.first, interval.last) == (0, 129)
    assert [flag.code for flag in interval.flags] == ["interval_clipped"]


def test_a_presets_bound_gives_way_to_the_users() -> None:
    table = constant_rate(Fraction(10), 1300)
    late = interval_of(table, "thesis", clip_start_s=125)
    assert (late.first, late.last) == (1250, 1299)
    early = interval_of(table, "thesis", clip_end_s=1.5)
    assert (early.first, early.last) == (0, 15)
    assert early.flags


def test_the_default_takes_the_whole_video_without_a_flag() -> None:
    interval = interval_of(constant_rate(Fraction(12), 360), "default")
    assert (interval.first, interval.last, interval.flags) == (0, 359, ())


def test_a_users_short_interval_is_taken_as_it_is() -> None:
    interval = interval_of(constant_rate(Fraction(10), 360), "default", clip_start_s=3, clip_end_s=5)
    assert (interval.first, interval.last, interval.flags) == (30, 50, ())


@pytest.mark.parametrize(
    ("preset", "options", "code", "cause"),
    [
        ("default", {"clip_end_s": 31}, "interval_outside", r"clip_end_s = 31 s lies outside the video \(0 to 30"),
        ("thesis", {"clip_start_s": 30}, "interval_outside", "clip_start_s = 30 s lies outside"),
        ("default", {"clip_start_s": 20, "clip_end_s": 10}, "interval_empty", "20 to 10 s is empty"),
        ("default", {"clip_start_s": 5, "clip_end_s": 5.01}, "interval_empty", "only one frame"),
    ],
)
def test_a_users_impossible_interval_is_refused(preset: str, options: dict[str, float], code: str, cause: str) -> None:
    with pytest.raises(BadInput, match=cause) as caught:
        interval_of(constant_rate(Fraction(12), 360), preset, **options)
    assert caught.value.code == code


def test_annotated_frames_join_the_search_and_roles_say_why() -> None:
    settings = make_settings("default", {"frames.count": 4}).frames
    chosen = choose_frames([Stretch(Interval(0, 9), {3, 4, 12})], settings)
    assert [(f.index, f.source.source_index, f.role) for f in chosen] == [
        (0, 0, "sampled"),
        (1, 3, "both"),
        (2, 4, "annotated"),
        (3, 6, "sampled"),
        (4, 9, "sampled"),
    ]


def test_annotated_frames_over_the_budget_are_added_afterwards() -> None:
    settings = make_settings("default", {"frames.count": 4, "frames.max_count": 6}).frames
    annotated = {1, 2, 4, 5, 7, 8}
    chosen = choose_frames([Stretch(Interval(0, 9), annotated)], settings)
    search = [f for f in chosen if f.role != "added"]
    added = [f for f in chosen if f.role == "added"]
    assert len(search) == 6
    assert [f.index for f in chosen] == list(range(10))
    assert [f.source.source_index for f in search] == sorted(f.source.source_index for f in search)
    assert [f.source.source_index for f in added] == sorted(f.source.source_index for f in added)
    assert {f.source.source_index for f in chosen} == set(range(10))
    assert [f.source.source_index for f in search if f.role == "annotated"] == [1, 8], (
        "the budget is spread over the clip"
    )


def test_a_budget_below_the_sample_takes_no_annotated_frame_into_the_search() -> None:
    settings = make_settings("default", {"frames.count": 5, "frames.max_count": 3}).frames
    chosen = choose_frames([Stretch(Interval(0, 8), {1, 3})], settings)
    assert [f.role for f in chosen] == ["sampled"] * 5 + ["added"] * 2


def test_an_annotated_frame_far_from_the_samples_gets_neighbours_on_both_sides() -> None:
    settings = make_settings("default", {"frames.count": 5}).frames
    roles = {
        f.source.source_index: f.role
        for f in choose_frames([Stretch(Interval(0, 400), {150, 165, 205, 398}, 10)], settings)
    }
    neighbours = {source for source, role in roles.items() if role == "neighbour"}
    assert neighbours == {140, 160, 175, 215, 388}  # 165 has 160 and 205 has 200; 398 has 400 behind it


def test_neighbours_come_after_the_annotated_frames_in_the_budget() -> None:
    settings = make_settings("default", {"frames.count": 5, "frames.max_count": 8}).frames
    chosen = choose_frames([Stretch(Interval(0, 400), {150, 250}, 10)], settings)
    assert [frame.role for frame in chosen].count(Role.ANNOTATED) == 2
    assert [frame.role for frame in chosen].count(Role.NEIGHBOUR) == 1
    assert not [f for f in choose_frames([Stretch(Interval(0, 400), {150})], settings) if f.role == "neighbour"]
