"""Sizes of defects against the truth: how far off they are, and whether they say so."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from bench.accuracy.placement import owner_of
from bench.accuracy.truth import Truth
from core.geometry.similarity import Similarity
from core.scene.size import LengthUnit, SizeFrom

POWERS = {"length": 1, "width": 1, "area": 2, "depth": 1}
"""Measures, and the power of a length that each is."""


def score_sizes(
    records: list[dict[str, Any]], truth: Truth, alignments: Mapping[int, Similarity | None]
) -> dict[str, Any]:
    """Relative errors of the measures by what they are from (``mask``, ``box``), each over all defects that have one.

    A size in units of the model is brought to mm by the alignment of the cameras, as if the scale were known exactly.

    Returns:
        By origin and measure {count, median, p95, within_2_sigma}: of |measured / true - 1|, and the share of true
        values within two standard deviations of the measured one. Measures that nothing is known of are left out.
    """
    found: dict[tuple[str, str], list[tuple[float, bool]]] = {}
    for record in records:
        owner = owner_of(record, truth, alignments)
        sim3 = alignments.get(int(record.get("model") or 0))
        if owner is None or sim3 is None:
            continue
        factor = 1.0 if record.get("length_unit") == LengthUnit.MM else sim3.scale
        for name, true in truth.defects[owner].sizes.items():
            value, sigma = record.get(name), record.get(f"{name}_sigma")
            if value is None or sigma is None:
                continue
            value, sigma = (number * factor ** POWERS[name] for number in (value, sigma))
            inside = abs(value - true) <= 2.0 * sigma
            found.setdefault((record["size_from"], name), []).append((abs(value / true - 1.0), inside))
    return {
        str(origin): {name: _figures(found[origin, name]) for name in POWERS if (origin, name) in found}
        for origin in SizeFrom
    }


def _figures(rows: list[tuple[float, bool]]) -> dict[str, Any]:
    errors = np.array([error for error, _ in rows])
    return {
        "count": len(rows),
        "median": float(np.median(errors)),
        "p95": float(np.percentile(errors, 95)),
        "within_2_sigma": float(np.mean([inside for _, inside in rows])),
    }
