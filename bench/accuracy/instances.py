"""Defect records against true defects: found, split, extra, exact."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from typing import Any

from bench.accuracy.placement import WRONG_CHORD_SHARE, Placement, aligned_point, patch_distance
from bench.accuracy.truth import Truth
from core.geometry.similarity import Similarity


def score_defects(
    records: list[dict[str, Any]],
    placements: list[Placement],
    truth: Truth,
    alignments: Mapping[int, Similarity | None],
) -> dict[str, Any]:
    """Count records of `defects.json` over the true defects that have a placeable detection.

    A record belongs to the true defect whose patch is nearest to its centroid and within 10 % of the
    chord; a further record of the same defect is split; a record that belongs to none is extra.
    """
    expected = {item.true_defect for item in placements if item.true_defect is not None}
    owners: Counter[int] = Counter()
    extra = 0
    for record in records:
        point = aligned_point(list(record.get("centroid") or [None]), record.get("model"), alignments)
        near = []
        if point is not None:
            distances = ((patch_distance(point, defect.patch), key) for key, defect in truth.defects.items())
            near = [item for item in distances if item[0] <= WRONG_CHORD_SHARE * truth.chord]
        if near:
            owners[min(near)[1]] += 1
        else:
            extra += 1
    found = sum(1 for key in expected if owners[key])
    split = sum(owners.values()) - len(owners)
    return {
        "expected": len(expected),
        "records": len(records),
        "found": found,
        "split": split,
        "extra": extra,
        "exact": found == len(expected) and not split and not extra,
    }


def persistence_by_record(records: list[dict[str, Any]]) -> dict[int, float | None]:
    """`persistence` of every record by id, whether written as a share or as an object with `k` and `n`."""
    table: dict[int, float | None] = {}
    for record in records:
        value = record.get("persistence")
        if isinstance(value, dict):
            value = value["k"] / value["n"] if value.get("n") else None
        table[int(record["id"])] = None if value is None else float(value)
    return table
