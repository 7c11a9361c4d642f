"""Weights of the confidence from scored runs: logistic regression with a little shrinkage, and its reliability."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from bench.accuracy.align import align
from bench.accuracy.confidence import N_BINS, auroc, calibration_error
from bench.accuracy.placement import place_detections
from bench.accuracy.result import load_result
from bench.accuracy.truth import load_truth
from core.mapping.confidence import Parts, model_right

F64 = NDArray[np.float64]
Flags = NDArray[np.bool_]

SHRINKAGE = 1.0
"""Variance that a weight is expected to have; the features are of order one."""
LEAST_RIGHT = 0.1
"""A scene with a smaller share of right places fits no weights: that is the model's fault and not its rows'."""
FOR = ("consensus", "support", "label", "share", "cosine", "lead", "sparse", "depth", "score", "peers")
AGAINST = ("alone", "cloud", "offset")
_STEPS = 60


@dataclass(frozen=True)
class Sample:
    """Mapped rows of one run."""

    scene: str
    features: F64
    """(n, m) in the order of `names`."""
    right: Flags
    """(n,) a true defect, not wrong."""
    names: tuple[str, ...]
    model: F64 | float = 1.0
    """(n,) probability that the model is right, by its checks; a run may have several."""


def collect(bench_folder: Path, scene: str, column: str = "default") -> Sample:
    """Rows of a kept run with their parts, and whether their places are right."""
    out = bench_folder / "runs" / column / scene
    truth, result = load_truth(bench_folder / "scenes" / scene / "truth"), load_result(out)
    alignments = {n: align(m.centers, truth.centers[m.source_indices]) for n, m in result.models.items()}
    placements = place_detections(result.detections, truth, alignments)
    known = {row["id"]: row["parts"] for row in json.loads((out / "mapping" / "confidence.json").read_text())}
    rows, right, model = [], [], []
    names: tuple[str, ...] = ()
    for row, placement in zip(result.detections, placements, strict=True):
        parts = known.get(row["id"])
        if placement.mapped and parts is not None:
            features = _parts(parts).features()
            model.append(model_right(int(parts["model_doubts"])))
            names = tuple(features)
            rows.append([features[name] for name in names])
            right.append(placement.right)
    x = np.array(rows, np.float64).reshape(len(rows), -1)
    return Sample(scene, x, np.array(right, bool), names, np.array(model, np.float64))


def _parts(row: dict[str, float | int | None]) -> Parts:
    """From the published form."""
    lead = row["lead"]
    return Parts(
        visible=int(row["views_visible"] or 0),
        support=int(row["views_support"] or 0),
        same_label=int(row["views_same_label"] or 0),
        share=float(row["pixel_share"] or 0.0),
        cosine=float(row["cosine"] or 0.0),
        lead=float("inf") if lead is None else float(lead),
        sparse=row["sparse_agreement"],
        depth=row["depth_agreement"],
        cloud_spacings=float(row["cloud_spacings"] or 0.0),
        score=row["score"],
        peers=int(row["peers"] or 0),
        offset=float(row["offset"] or 0.0),
    )


def fit(samples: Sequence[Sample]) -> dict[str, float]:
    """Weights by name, every scene counting the same: penalised maximum likelihood by Newton's method.

    What can only speak against a place never speaks for it, and the other way round (`FOR`, `AGAINST`): where the
    rows of a few scenes say so by chance, the weight is 0.
    """
    used = [sample for sample in samples if len(sample.right) and sample.right.mean() > LEAST_RIGHT]
    x = np.concatenate([sample.features for sample in used])
    y = np.concatenate([sample.right for sample in used]).astype(np.float64)
    weight = np.concatenate([np.full(len(s.right), len(y) / (len(used) * len(s.right))) for s in used])
    penalty = np.full(x.shape[1], 1.0 / SHRINKAGE)
    penalty[used[0].names.index("constant")] = 1e-3
    w, free = np.zeros(x.shape[1]), np.ones(x.shape[1], bool)
    signs = np.array([(name in FOR) - (name in AGAINST) for name in used[0].names])
    _climb(w, free, x, y, weight, penalty)
    while (strange := free & (w * signs < 0)).any():
        free &= ~strange
        w[strange] = 0.0
        _climb(w, free, x, y, weight, penalty)
    return {name: round(float(value), 3) for name, value in zip(used[0].names, w, strict=True)}


def _climb(w: F64, free: Flags, x: F64, y: F64, weight: F64, penalty: F64) -> None:
    """Newton's method in place over the free weights."""
    for _ in range(_STEPS):
        p = 1.0 / (1.0 + np.exp(-np.clip(x @ w, -30, 30)))
        gradient = x.T @ (weight * (y - p)) - penalty * w
        curvature = (x * (weight * p * (1 - p))[:, None]).T @ x + np.diag(penalty)
        step = np.linalg.solve(curvature[np.ix_(free, free)], gradient[free])
        w[free] += step
        if float(np.abs(step).max()) < 1e-9:
            break


def held_out(samples: Sequence[Sample]) -> tuple[F64, Flags]:
    """Stated confidence and rightness of every row, each scene judged by weights fitted on the others."""
    stated, right = [], []
    for k, sample in enumerate(samples):
        if not len(sample.right):
            continue
        weights = fit([other for j, other in enumerate(samples) if j != k])
        score = sample.features @ np.array([weights[name] for name in sample.names])
        stated.append(np.clip(sample.model / (1.0 + np.exp(-score)), 0.01, 0.99))
        right.append(sample.right)
    return np.concatenate(stated), np.concatenate(right)


def report(samples: Sequence[Sample]) -> str:
    """Weights, counts, and the reliability of scenes left out, as text."""
    stated, right = held_out(samples)
    lines = [f"{sample.scene}: {len(sample.right)} mapped rows, {int(sample.right.sum())} right" for sample in samples]
    lines += ["", json.dumps(fit(samples), indent=1), "", "| stated | rows | right |", "| --- | --- | --- |"]
    bins = np.clip((stated * N_BINS).astype(int), 0, N_BINS - 1)
    for b in np.unique(bins):
        own = bins == b
        lines.append(f"| {stated[own].mean():.2f} | {int(own.sum())} | {right[own].mean():.2f} |")
    area = auroc(stated, right)
    ranked = "-" if area is None else f"{area:.3f}"
    return "\n".join(
        [*lines, "", f"scenes left out: calibration error {calibration_error(stated, right):.3f}, AUROC {ranked}"]
    )
