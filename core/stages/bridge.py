"""Stage `bridge`: pairs beyond the sequence where it is thin or broken, and pairs over a jump taken out."""

from __future__ import annotations

from collections.abc import Sequence

from core.features.io import feature_files, read_features
from core.flags import Flag, Severity, between_frames
from core.io.frames import read_frames
from core.matching.bridges import Pair, agreeing, bridge_places, components_of, find_gaps, is_strong, select
from core.matching.jumps import dense_enough, find_jumps, match_density, positions, spans_any
from core.products.front import BridgeProduct
from core.stage import StageTask
from core.verification import read_camera
from core.viewgraph import PairTable, join_tables, make_table, read_pairs, table_counts, write_dropped, write_pairs


def run(task: StageTask) -> BridgeProduct:
    """Write ``pairs.npz`` with the further pairs and ``dropped.json`` with the pairs over jumps."""
    frames = read_frames(task.input("frames"))
    n_search = frames.n_search
    position = positions(frames.moments_s, n_search, frames.videos)
    files = feature_files(folder for _, folder in task.fan_in("features"))
    keypoints = [read_features(files[index]).keypoints for index in range(len(frames))]
    camera = read_camera(task.input("camera"))
    size = int(camera.width), int(camera.height)

    table = join_tables(read_pairs(folder) for _, folder in task.fan_in("matches"))
    density = match_density(table, keypoints, *size)
    jumps = find_jumps(table, density, position, n_search)
    dropped = spans_any(table, position, jumps)
    write_dropped(task.out, table.pairs[dropped])
    table = select(table, ~dropped)

    gaps = find_gaps(table, n_search)

    def tried(pairs: Sequence[Pair]) -> PairTable:
        found = _matched(task, pairs)
        usual = density * ~dropped
        return select(found, dense_enough(found, match_density(found, keypoints, *size), table, usual, position))

    places = bridge_places(table, n_search)
    probed = [tried(place.pairs[: place.probes]) for place in places]
    rest = [
        tried(place.pairs[place.probes :])
        for place, probe in zip(places, probed, strict=True)
        if len(place.pairs) > place.probes and is_strong(probe).any()
    ]
    extra = join_tables([*probed, *rest])
    extra = select(extra, agreeing(table, extra, len(frames), n_search))
    write_pairs(task.out, extra)
    spanned = _spanned(gaps, extra.pairs[extra.n_inliers > 0].tolist())
    components = components_of(join_tables([table, extra]), len(frames))
    task.report(1, 1)
    return BridgeProduct(
        **table_counts(extra),
        gaps=tuple(gaps),
        jumps=tuple((cut, cut + 1) for cut in jumps),
        dropped=int(dropped.sum()),
        spanned=tuple(spanned),
        largest_piece=int(max((components == label).sum() for label in set(components.tolist()))),
        flags=(*_jump_flags(jumps), *_gap_flags(spanned)),
    )


def _matched(task: StageTask, pairs: Sequence[Pair]) -> PairTable:
    # Most videos have no gap, and the matchers are slow to load.
    import torch

    from core.stages.matches import match_all

    torch.set_num_threads(task.threads)
    return make_table(pairs, match_all(task, pairs))


def _jump_flags(jumps: list[int]) -> list[Flag]:
    return [Flag("picture_jumps", Severity.WARNING, where=between_frames(cut, cut + 1)) for cut in jumps]


def _gap_flags(spanned: list[tuple[int, int]]) -> list[Flag]:
    return [Flag("gap_spanned", Severity.INFO, where=between_frames(before, after)) for before, after in spanned]


def _spanned(gaps: list[tuple[int, int]], pairs: list[list[int]]) -> list[tuple[int, int]]:
    return [(before, after) for before, after in gaps if any(a <= before and b >= after for a, b in pairs)]
