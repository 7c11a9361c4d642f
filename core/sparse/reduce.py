"""The reducer's rule: which case wins, and why there may be none.

Trust comes first: a case that a check vetoed loses against any that none did. Then the detections that its points
verify count (`core.mapping.verified`; the final choice only), then the thesis's score (3.3.3).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

from core.errors import NoReconstruction, StageFailed
from core.flags import error_codes
from core.scene.case import CaseStatus
from core.task_key import parts_of

Row = Mapping[str, Any]

WINNER_FIELDS = ("start", "end", "kind", "registered_images", "points3D", "start_mode")
RANKING_FIELDS = ("name", "verified_detections", "registered_images", "points3D")


def score(row: Row) -> tuple[int, int]:
    """S(M) = (registered images, 3D points), compared lexicographically; of the row of a case."""
    return int(row["registered_images"]), int(row["points3D"])


Standing = tuple[bool, int, tuple[int, int]]


def standing(row: Row, veto: bool = True) -> Standing:
    """What cases are ranked by: not vetoed before vetoed (unless `veto` is off), `verified_detections`, `score`."""
    return not (veto and row.get("vetoed", False)), int(row.get("verified_detections", 0)), score(row)


def rank(rows: Sequence[Row], veto: bool = True) -> list[Row]:
    """Cases that have a model, best first; equal ones keep the order of their names."""
    with_model = [row for row in rows if row["status"] == CaseStatus.SUCCEEDED]
    by_name = sorted(with_model, key=lambda row: str(row["name"]))
    return sorted(by_name, key=lambda row: standing(row, veto), reverse=True)


def reduce_cases(rows: Sequence[Row], veto: bool = True) -> dict[str, Any]:
    """Facts of the reducer over the cases that ended.

    A vetoed case can win here when all are: refinement may still find a model to trust around it.
    Raises `NoReconstruction` with the reasons counted when no case has a model.
    """
    ranking = rank(rows, veto)
    if not ranking:
        raise NoReconstruction(f"no case has a model: {_reasons(rows)}", where="search")
    return _facts(ranking[0], ranking)


def reduce_refined(coarse_best: Row, refined: Sequence[Row], veto: bool = True) -> dict[str, Any]:
    """Facts over the best coarse case and the refined ones: a refined case wins only if strictly better.

    Rows may have `verified_detections`, all of them or none.
    Raises `NoReconstruction` when the winner is vetoed, which with `veto` means that every candidate is.
    """
    ranking = rank(refined, veto)
    better = ranking and standing(ranking[0], veto) > standing(coarse_best, veto)
    winner = ranking[0] if better else coarse_best
    others = [row for row in (*ranking, coarse_best) if row["name"] != winner["name"]]
    if not standing(winner, veto)[0]:
        codes = error_codes(winner["checks"])
        raise NoReconstruction(
            f"every model was vetoed by the checks; the largest, {winner['name']}: {codes}", where="search"
        )
    return _facts(winner, [winner, *sorted(others, key=lambda row: standing(row, veto), reverse=True)])


def case_rows(facts: Mapping[str, Mapping[str, Any]], stage: str) -> list[Row]:
    """Rows of the cases of `stage` among a task's facts, ordered by key."""
    return [facts[key] for key in parts_of(facts, stage)]


def find_row(rows: Sequence[Row], name: str) -> Row:
    """The row of the case `name`; `StageFailed` when it is missing."""
    for row in rows:
        if row["name"] == name:
            return row
    raise StageFailed(f"the case {name} has no row", where="search")


def _facts(winner: Row, ranking: Sequence[Row]) -> dict[str, Any]:
    return {
        "best": winner["name"],
        **{field: winner[field] for field in WINNER_FIELDS},
        "ranking": [{field: row[field] for field in RANKING_FIELDS if field in row} for row in ranking],
    }


def _reasons(rows: Sequence[Row]) -> str:
    if not rows:
        return "every case failed"
    counts = Counter(str(row["reason"]) for row in rows)
    return ", ".join(f"{reason} in {count} of {len(rows)} cases" for reason, count in sorted(counts.items()))
