"""Windows and pairs: the thesis's names and counts."""

from __future__ import annotations

from core.settings import make_settings
from core.windows import coarse_windows, refined_windows, sequential_pairs

THESIS = make_settings("thesis").windows


def test_450_frames_have_the_thesiss_22_coarse_cases() -> None:
    names = [window.name for window in coarse_windows(450, THESIS)]
    assert len(names) == 22
    assert names[0] == "seg_000_0000_0180"
    assert names[6] == "seg_006_0120_0300"
    assert names[13] == "seg_013_0260_0440"
    assert names[14] == "seg_014_0280_0450"
    assert names[-1] == "seg_021_0420_0450"


def test_the_best_coarse_case_gives_13_refined_ones() -> None:
    names = [window.name for window in refined_windows((120, 300), 450, THESIS)]
    assert names == [f"refine_{i:03d}_{40 + 10 * i:04d}_{260 + 10 * i:04d}" for i in range(13)]
    assert names[5] == "refine_005_0090_0310"
    assert names[10] == "refine_010_0140_0360"
    assert names[12] == "refine_012_0160_0380"


def test_a_short_clip_is_one_window_of_each_kind() -> None:
    assert [w.name for w in coarse_windows(25, THESIS)] == ["seg_000_0000_0025"]
    assert [w.name for w in refined_windows((0, 96), 96, THESIS)] == ["refine_000_0000_0096"]
    assert refined_windows((0, 40), 40, THESIS) == []


def test_scratch_windows_start_from_nothing_and_warm_ones_from_an_earlier_anchor() -> None:
    assert all(window.warm_from == "" for window in coarse_windows(450, THESIS))
    warm = coarse_windows(450, make_settings("default").windows)
    anchors = [window for window in warm if not window.warm_from]
    assert 1 < len(anchors) < len(warm)
    starts = {window.name: window.start for window in anchors}
    assert all(starts[window.warm_from] <= window.start for window in warm if window.warm_from)


def test_450_frames_have_2235_sequential_pairs() -> None:
    pairs = sequential_pairs(450, 5)
    assert len(pairs) == len(set(pairs)) == 2235
    assert all(0 < j - i <= 5 for i, j in pairs)
    assert sequential_pairs(3, 5) == [(0, 1), (0, 2), (1, 2)]
