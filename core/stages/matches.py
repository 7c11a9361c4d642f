"""Stage `matches`: the pairs of a chunk of frames, matched and verified."""

from __future__ import annotations

from collections.abc import Sequence

import torch

from core.features.io import FrameFeatures, feature_files, read_features
from core.io.frames import read_frames
from core.matched_pair import MatchedPair
from core.matching.auto import PairMatcher, RematchPolicy
from core.matching.keyframes import keyframe_pairs, read_keyframes
from core.matching.pairs import match_pairs, pairs_of_chunk
from core.products.front import MatchesProduct
from core.stage import StageTask
from core.verification import Verifier, read_camera
from core.viewgraph import make_table, table_counts, write_pairs


def run(task: StageTask) -> MatchesProduct:
    """Match and verify the pairs whose first frame lies in [start, end)."""
    torch.set_num_threads(task.threads)
    pairs = pairs_of_chunk(_all_pairs(task), int(task.args["start"]), int(task.args["end"]))
    n_search = read_frames(task.input("frames")).n_search
    table = make_table(pairs, match_all(task, pairs, RematchPolicy(n_search)))
    write_pairs(task.out, table)
    task.report(1, 1)
    return MatchesProduct(**table_counts(table))


def match_all(
    task: StageTask, pairs: Sequence[tuple[int, int]], policy: RematchPolicy | None = None
) -> list[MatchedPair]:
    """Outcomes of `pairs` in their order, the nearest frames matched first; all under a new policy unless one is given.

    Features are read when first needed and let go after their last use.
    """
    settings = task.settings
    camera = read_camera(task.input("camera"))
    verifier = Verifier(camera, settings.verification, settings.seed)
    matcher = PairMatcher(settings.matching, verifier, settings.features.method)
    files = feature_files(folder for _, folder in task.fan_in("features"))
    order = sorted(pairs, key=lambda pair: (pair[1] - pair[0], pair))
    last_use = {frame: row for row, pair in enumerate(order) for frame in pair}
    loaded: dict[int, FrameFeatures] = {}
    matched: dict[tuple[int, int], MatchedPair] = {}
    policy = policy or RematchPolicy()
    for row, pair in enumerate(order):
        task.report(row, len(pairs), f"frames {pair[0]} and {pair[1]}")
        for frame in pair:
            if frame not in loaded:
                loaded[frame] = read_features(files[frame])
        found = matcher.match(loaded[pair[0]], loaded[pair[1]], rematch=not policy.gives_up(pair))
        policy.note(pair, found)
        matched[pair] = found
        for frame in pair:
            if last_use[frame] == row:
                del loaded[frame]
    return [matched[pair] for pair in pairs]


def _all_pairs(task: StageTask) -> list[tuple[int, int]]:
    frames = read_frames(task.input("frames"))
    near = match_pairs(frames.moments_s, frames.n_search, task.settings.matching.window, frames.videos)
    if not task.has("motion"):
        return near
    far, video_of = keyframe_pairs(read_keyframes(task.input("motion")).frames), frames.videos
    return sorted({*near, *((a, b) for a, b in far if video_of[a] == video_of[b])})
