"""Stage `bridge`: pairs beyond the sequence, where it is thin or broken."""

from __future__ import annotations

import json

import torch

from core.flags import Flag
from core.matching.bridges import agreeing, bridge_pairs, find_gaps, find_pieces, select
from core.stage import StageResult, StageTask
from core.stages.matches import match_all
from core.viewgraph import join_tables, make_table, read_table, table_facts, write_table


def run(task: StageTask) -> StageResult:
    """Write ``pairs.npz`` with the further pairs, and say which gaps they span."""
    torch.set_num_threads(task.threads)
    rows = json.loads((task.input("frames") / "frames.json").read_text(encoding="utf-8"))
    n_search = sum(row["role"] != "added" for row in rows)
    table = join_tables(read_table(folder / "pairs.npz") for _, folder in task.fan_in("matches"))
    gaps = find_gaps(table, n_search)
    pairs = bridge_pairs(table, n_search)
    extra = make_table(pairs, match_all(task, pairs))
    believed = agreeing(table, extra, len(rows))
    extra = select(extra, believed)
    write_table(task.out / "pairs.npz", extra)
    spanned = _spanned(gaps, extra.pairs[believed].tolist())
    pieces = find_pieces(join_tables([table, extra]), len(rows))
    task.report(1, 1)
    return StageResult(
        {
            **table_facts(extra),
            "gaps": [list(gap) for gap in gaps],
            "spanned": [list(gap) for gap in spanned],
            "largest_piece": int(max((pieces == label).sum() for label in set(pieces.tolist()))),
            "flags": [
                Flag("gap_spanned", "info", where=f"between frames {before} and {after}").to_dict()
                for before, after in spanned
            ],
        }
    )


def _spanned(gaps: list[tuple[int, int]], pairs: list[list[int]]) -> list[tuple[int, int]]:
    return [(before, after) for before, after in gaps if any(a <= before and b >= after for a, b in pairs)]
