from __future__ import annotations

from core.matching.pairs import match_pairs, pairs_of_chunk
from core.videos import moment
from core.windows import sequential_pairs


def test_search_frames_are_sequential() -> None:
    times = [i / 12 for i in range(450)]
    pairs = match_pairs(times, 450, 5)
    assert pairs == sequential_pairs(450, 5)
    assert len(pairs) == 2235


def test_added_frames_meet_their_neighbours_in_time_on_both_sides() -> None:
    times = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 2.5, 0.0]  # 6 and 7 were added
    pairs = match_pairs(times, 6, 2)
    assert [pair for pair in pairs if pair[1] == 6] == [(1, 6), (2, 6), (3, 6), (4, 6)]
    assert [pair for pair in pairs if pair[1] == 7] == [(0, 7), (1, 7), (2, 7)]
    assert (6, 7) not in pairs
    assert pairs == sorted(set(pairs))
    assert set(sequential_pairs(6, 2)) <= set(pairs)


def test_chunks_share_no_pair_and_miss_none() -> None:
    pairs = match_pairs([float(i) for i in range(20)] + [3.5, 18.9], 20, 3)
    chunks = [pairs_of_chunk(pairs, start, min(start + 8, 22)) for start in range(0, 22, 8)]
    assert [pair for chunk in chunks for pair in chunk] == pairs


def test_no_pair_reaches_over_the_cut_between_two_videos() -> None:
    videos = [0] * 5 + [1] * 5 + [0, 1]
    times = [moment(video, t) for video, t in zip(videos, [*range(5), *range(5), 3.5, 0.5], strict=True)]
    pairs = match_pairs(times, 10, 3, videos)
    assert {(videos[i], videos[j]) for i, j in pairs} == {(0, 0), (1, 1)}
    assert [pair for pair in pairs if pair[1] == 10] == [(1, 10), (2, 10), (3, 10), (4, 10)]
    assert [pair for pair in pairs if pair[1] == 11] == [(5, 11), (6, 11), (7, 11), (8, 11)]
    assert [pair for pair in pairs if pair[1] < 5] == sequential_pairs(5, 3)
