"""Figures over many scenes at once, and the half of them that is hard for the thesis's rules."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from bench.accuracy.confidence import auroc, calibration_error
from bench.scenes.spec import Scene

Found = Mapping[str, Any]


def right_share(one: Found) -> float:
    """Placeable detections that are mapped and not wrong, of all placeable ones."""
    place = one["score"]["placement"]
    right: int = place["mapped_placeable"] - place["wrong_mapped"]
    return right / place["placeable"] if place["placeable"] else 0.0


def hard_half(scenes: Sequence[Scene], thesis: Mapping[str, Found]) -> list[str]:
    """Names of the half of the scenes that can be reconstructed with the fewest right places in the thesis's column.

    Scenes of another number of detections are compared by the share of these.
    """
    names = [scene.name for scene in scenes if scene.expect == "mapped"]
    return sorted(names, key=lambda name: (right_share(thesis[name]), name))[: len(names) // 2]


def confidence_line(title: str, found: Sequence[Found]) -> str:
    """Calibration and ranking over the mapped rows of all these scenes together, false boxes counting as wrong."""
    rows = np.array([row for one in found for row in one["score"]["confidence"]["stated"]], np.float64).reshape(-1, 2)
    if not len(rows):
        return f"{title}: no mapped row has a confidence"
    stated, right = rows[:, 0], rows[:, 1] > 0.5
    area = auroc(stated, right)
    ranked = "- (no wrong row)" if area is None else f"{area:.3f}"
    return (
        f"{title}: {len(rows)} mapped rows of {len(found)} scenes, {100 * right.mean():.1f} % right; "
        f"calibration error {calibration_error(stated, right):.3f}, AUROC {ranked}"
    )


def false_boxes_line(found: Sequence[Found]) -> str:
    """What became of all false boxes together."""
    boxes = [one["score"]["placement"]["false_boxes"] for one in found]
    count = sum(box["count"] for box in boxes)
    lasting = sum(round(box["count"] * (box["mapped_confident_persistent_share"] or 0.0)) for box in boxes)
    return f"false boxes: {count}; mapped with confidence and persistence above 0.5: {lasting}"
