"""Stage `bridge`: pairs beyond the sequence where it is thin or broken, and pairs over a jump taken out."""

from __future__ import annotations

import json

from core.features.io import feature_files, read_features
from core.flags import Flag, Severity
from core.matching.bridges import PROBES, Pair, agreeing, bridge_pairs, components_of, find_gaps, is_strong, select
from core.matching.jumps import dense_enough, find_jumps, match_density, positions, spans_any
from core.stage import StageResult, StageTask
from core.verification import read_camera
from core.viewgraph import PairTable, join_tables, make_table, read_table, table_facts, write_table


def run(task: StageTask) -> StageResult:
    """Write ``pairs.npz`` with the further pairs and ``dropped.json`` with the pairs over jumps."""
    rows = sorted(
        json.loads((task.input("frames") / "frames.json").read_text(encoding="utf-8")), key=lambda row: row["index"]
    )
    n_search = sum(row["role"] != "added" for row in rows)
    position = positions([float(row["time_s"]) for row in rows], n_search)
    files = feature_files(folder for _, folder in task.fan_in("features"))
    keypoints = [read_features(files[index]).keypoints for index in range(len(rows))]
    camera = read_camera(task.input("camera") / "camera.json")
    size = int(camera.width), int(camera.height)

    table = join_tables(read_table(folder / "pairs.npz") for _, folder in task.fan_in("matches"))
    density = match_density(table, keypoints, *size)
    jumps = find_jumps(table, density, position, n_search)
    dropped = spans_any(table, position, jumps)
    (task.out / "dropped.json").write_text(json.dumps(table.pairs[dropped].tolist()))
    table = select(table, ~dropped)

    gaps = find_gaps(table, n_search)

    def tried(pairs: list[Pair]) -> PairTable:
        found = _matched(task, pairs)
        usual = density * ~dropped
        return select(found, dense_enough(found, match_density(found, keypoints, *size), table, usual, position))

    places = bridge_pairs(table, n_search)
    probes = [tried(place[:PROBES]) for place in places]
    rest = [tried(place[PROBES:]) for place, probe in zip(places, probes, strict=True) if is_strong(probe).any()]
    extra = join_tables([*probes, *rest])
    extra = select(extra, agreeing(table, extra, len(rows)))
    write_table(task.out / "pairs.npz", extra)
    spanned = _spanned(gaps, extra.pairs[extra.n_inliers > 0].tolist())
    pieces = components_of(join_tables([table, extra]), len(rows))
    task.report(1, 1)
    return StageResult(
        {
            **table_facts(extra),
            "gaps": [list(gap) for gap in gaps],
            "jumps": [[cut, cut + 1] for cut in jumps],
            "dropped": int(dropped.sum()),
            "spanned": [list(gap) for gap in spanned],
            "largest_piece": int(max((pieces == label).sum() for label in set(pieces.tolist()))),
            "flags": [flag.to_dict() for flag in (*_jump_flags(jumps), *_gap_flags(spanned))],
        }
    )


def _matched(task: StageTask, pairs: list[Pair]) -> PairTable:
    # Most videos have no gap, and the matchers are slow to load.
    import torch

    from core.stages.matches import match_all

    torch.set_num_threads(task.threads)
    return make_table(pairs, match_all(task, pairs))


def _jump_flags(jumps: list[int]) -> list[Flag]:
    return [Flag("picture_jumps", Severity.WARNING, where=f"between frames {cut} and {cut + 1}") for cut in jumps]


def _gap_flags(spanned: list[tuple[int, int]]) -> list[Flag]:
    return [
        Flag("gap_spanned", Severity.INFO, where=f"between frames {before} and {after}") for before, after in spanned
    ]


def _spanned(gaps: list[tuple[int, int]], pairs: list[list[int]]) -> list[tuple[int, int]]:
    return [(before, after) for before, after in gaps if any(a <= before and b >= after for a, b in pairs)]
