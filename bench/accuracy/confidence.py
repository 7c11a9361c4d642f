"""Does a stated confidence mean what it says: calibration error and ranking."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.stats import rankdata

from bench.accuracy.placement import Placement

N_BINS = 10


def score_confidence(placements: list[Placement]) -> dict[str, Any]:
    """Expected calibration error and AUROC over `mapped` rows; `stated` has each row's confidence and 1 if it is right.

    A row without a confidence counts as 1.0 once any row has one; without any there is nothing to score.
    """
    mapped = [item for item in placements if item.mapped]
    if all(item.confidence is None for item in mapped):
        return {"rows": len(mapped), "ece": None, "auroc": None, "stated": []}
    confidence = np.array([1.0 if item.confidence is None else item.confidence for item in mapped])
    right = np.array([item.right for item in mapped])
    return {
        "rows": len(mapped),
        "ece": calibration_error(confidence, right),
        "auroc": auroc(confidence, right),
        "stated": np.column_stack([confidence.round(4), right]).tolist(),
    }


def calibration_error(confidence: NDArray[np.float64], right: NDArray[np.bool_]) -> float:
    """Mean gap between stated and observed rate over ten equal bins, weighted by their rows (Naeini 2015)."""
    bins = np.clip((confidence * N_BINS).astype(int), 0, N_BINS - 1)
    gaps = [abs(confidence[bins == b].mean() - right[bins == b].mean()) * (bins == b).sum() for b in np.unique(bins)]
    return float(sum(gaps) / len(confidence))


def auroc(confidence: NDArray[np.float64], right: NDArray[np.bool_]) -> float | None:
    """Chance that a right row is ranked above a wrong one, ties counting half; None with one kind only."""
    positives, negatives = int(right.sum()), int((~right).sum())
    if not positives or not negatives:
        return None
    rank_sum = float(rankdata(confidence)[right].sum())
    return (rank_sum - positives * (positives + 1) / 2) / (positives * negatives)
