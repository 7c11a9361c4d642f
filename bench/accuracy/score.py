"""The whole score of a result folder, as `metrics` defines it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from bench.accuracy.align import align, pose_errors
from bench.accuracy.confidence import score_confidence
from bench.accuracy.placement import (
    persistence_by_record,
    place_detections,
    score_defects,
    score_placements,
    score_sizes,
)
from bench.accuracy.result import Result, ResultModel, load_result
from bench.accuracy.row import score_rows
from bench.accuracy.surface import Reference, make_reference, score_surface
from bench.accuracy.truth import Truth, load_truth
from core.errors import BadInput
from core.geometry.similarity import Similarity


def score_result(result_folder: Path, truth_folder: Path) -> dict[str, Any]:
    """Score a result folder against a truth folder; the same input gives the same numbers.

    Returns:
        {frames, cameras, mesh, cloud, placement, defects, sizes, rows, confidence, models}: the headline is model 0,
        `models` holds the further ones by number; `rows` is by number of the model (`score_rows`). What cannot be
        measured is None.
    """
    truth, result = load_truth(truth_folder), load_result(result_folder)
    _check_frames(result, truth)
    alignments = {
        number: align(model.centers, truth.centers[model.source_indices]) for number, model in result.models.items()
    }
    needs_surface = any(model.mesh or model.cloud for model in result.models.values())
    reference = make_reference(truth) if needs_surface else None
    scored = {
        number: _score_model(model, alignments[number], truth, result, reference)
        for number, model in result.models.items()
    }
    placements = place_detections(result.detections, truth, alignments)
    headline = scored.pop(0, None) or _no_model(truth, result)
    return {
        "schema_version": 1,
        **headline,
        "placement": score_placements(placements, persistence_by_record(result.defects)),
        "defects": score_defects(result.defects, placements, truth, alignments),
        "sizes": score_sizes(result.defects, truth, alignments),
        "rows": score_rows(result, truth, alignments, placements),
        "confidence": score_confidence(placements),
        "models": {str(number): model for number, model in scored.items()},
    }


def score_row_of(result_folder: Path, truth_folder: Path) -> dict[str, Any] | None:
    """The row of a result's first model alone (`score_rows`); None where it has none, or the truth tells of no row."""
    truth, result = load_truth(truth_folder), load_result(result_folder)
    _check_frames(result, truth)
    first = {number: model for number, model in result.models.items() if number == 0}
    alignments = {number: align(model.centers, truth.centers[model.source_indices]) for number, model in first.items()}
    placements = place_detections(result.detections, truth, alignments)
    return score_rows(replace(result, models=first), truth, alignments, placements).get("0")


def _check_frames(result: Result, truth: Truth) -> None:
    """A result of another clip would be scored without complaint; say so instead."""
    used = [index for model in result.models.values() for index in model.source_indices]
    if used and max(used) >= truth.n_frames:
        raise BadInput(f"the result uses frame {max(used)}, the truth has {truth.n_frames}", where="frames.csv")


def _score_model(
    model: ResultModel, sim3: Similarity | None, truth: Truth, result: Result, reference: Reference | None
) -> dict[str, Any]:
    score = {"frames": _frames(set(model.source_indices), truth, result), "cameras": None, "mesh": None, "cloud": None}
    if sim3 is None:
        return score
    index = model.source_indices
    errors = pose_errors(model.centers, model.rotations, truth.centers[index], truth.rotations[index], sim3)
    score["cameras"] = {
        "position_median_mm": float(np.median(errors.position_mm)),
        "position_p95_mm": float(np.percentile(errors.position_mm, 95)),
        "rotation_median_deg": float(np.median(errors.rotation_deg)),
        "rotation_p95_deg": float(np.percentile(errors.rotation_deg, 95)),
        "scale_mm_per_su": sim3.scale,
    }
    if reference is not None:
        for name, surface in (("mesh", model.mesh), ("cloud", model.cloud)):
            score[name] = score_surface(surface, sim3, reference) if surface else None
    return score


def _no_model(truth: Truth, result: Result) -> dict[str, Any]:
    return {"frames": _frames(set(), truth, result), "cameras": None, "mesh": None, "cloud": None}


def _frames(registered: set[int], truth: Truth, result: Result) -> dict[str, Any]:
    """Shares of all source frames of the clip and of those with at least one detection."""
    annotated = {truth.frame_at(float(row["time_s"])) for row in result.detections} - {None}
    return {
        "source_frames": truth.n_frames,
        "registered": len(registered),
        "registered_share": len(registered) / truth.n_frames,
        "annotated": len(annotated),
        "registered_annotated_share": len(registered & annotated) / len(annotated) if annotated else None,
    }
