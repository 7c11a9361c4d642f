"""Where detections and defects were placed, and how large, against the truth: right, wrong, found, split, extra."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bench.accuracy.truth import TrueBox, Truth
from core.geometry.boxes import box_iou
from core.geometry.similarity import Similarity
from core.scene.detection import Outcome
from core.scene.size import LengthUnit, SizeFrom

F64 = NDArray[np.float64]

MIN_IOU = 0.2
WRONG_CHORD_SHARE = 0.10


@dataclass(frozen=True)
class Placement:
    """One detection against the truth."""

    outcome: str
    method: str
    true_defect: int | None
    """None for a false box."""
    error_mm: float | None
    """Distance to the true place; None when unplaced or false."""
    wrong: bool
    """Placed, and farther than 10 % of the chord from every point of the true patch."""
    confidence: float | None
    defect_id: int | None

    @property
    def mapped(self) -> bool:
        """Placed with full trust, by the row's own word."""
        return self.outcome == Outcome.MAPPED

    @property
    def right(self) -> bool:
        """Placed, on a true defect, and not wrong. A false box has no right place."""
        return self.true_defect is not None and self.error_mm is not None and not self.wrong


def true_defect(box_px: F64, visible: list[TrueBox]) -> int | None:
    """The visible defect with the largest IoU, at least 0.2; None for a false box."""
    overlaps = [(box_iou(box_px, item.box_px), -i, item.defect) for i, item in enumerate(visible)]
    best = max(overlaps, default=(0.0, 0, 0))
    return best[2] if best[0] >= MIN_IOU else None


def place_detections(
    rows: list[dict[str, Any]], truth: Truth, alignments: Mapping[int, Similarity | None]
) -> list[Placement]:
    """Compare every row of `detections.json` with the truth; `alignments` by model number."""
    scale = np.array([truth.lens.width, truth.lens.height] * 2, np.float64)
    placements = []
    for row in rows:
        frame = truth.frame_at(float(row["time_s"]))
        box = np.array([row[name] for name in ("box_x1", "box_y1", "box_x2", "box_y2")], np.float64) * scale
        defect = true_defect(box, truth.boxes[frame]) if frame is not None else None
        point = aligned_point([row.get(axis) for axis in "xyz"], row.get("model"), alignments)
        error, wrong = None, False
        if defect is not None and point is not None:
            error = float(np.linalg.norm(point - truth.defects[defect].center))
            wrong = patch_distance(point, truth.defects[defect].patch) > WRONG_CHORD_SHARE * truth.chord
        confidence, record = row.get("confidence"), row.get("defect_id")
        placements.append(
            Placement(
                outcome=str(row["outcome"]),
                method=str(row.get("rung") or ""),
                true_defect=defect,
                error_mm=error,
                wrong=wrong,
                confidence=None if confidence is None else float(confidence),
                defect_id=None if record is None else int(record),
            )
        )
    return placements


def aligned_point(xyz: list[Any], model: Any, alignments: Mapping[int, Similarity | None]) -> F64 | None:
    """(3,) place in the true frame; None without coordinates or without an alignment of its model."""
    sim3 = alignments.get(0 if model in (None, "") else int(model))
    if sim3 is None or any(value is None for value in xyz):
        return None
    return np.asarray(sim3.apply(np.array([xyz], np.float64))[0])


def patch_distance(point: F64, patch: F64) -> float:
    """Distance from a point to the nearest point of a patch."""
    return float(np.linalg.norm(patch - point, axis=1).min())


def score_placements(placements: list[Placement], persistence: Mapping[int, float | None]) -> dict[str, Any]:
    """Mapped and wrong shares, errors by placement method, and what became of false boxes."""
    placeable = [item for item in placements if item.true_defect is not None]
    mapped = [item for item in placeable if item.mapped]
    methods = sorted({item.method for item in placeable if item.error_mm is not None})
    return {
        "detections": len(placements),
        "outcomes": dict(sorted(Counter(item.outcome for item in placements).items())),
        "placeable": len(placeable),
        "mapped_placeable": len(mapped),
        "mapped_share": _share(len(mapped), len(placeable)),
        "wrong_mapped": sum(item.wrong for item in mapped),
        "wrong_mapped_share": _share(sum(item.wrong for item in mapped), len(mapped)),
        **_errors(mapped),
        "by_rung": {one: _of_method([item for item in placeable if item.method == one]) for one in methods},
        "false_boxes": _false_boxes([item for item in placements if item.true_defect is None], persistence),
    }


def _of_method(items: list[Placement]) -> dict[str, Any]:
    placed = [item for item in items if item.error_mm is not None]
    wrong = sum(item.wrong for item in placed)
    return {"placed": len(placed), "wrong": wrong, "wrong_share": _share(wrong, len(placed)), **_errors(placed)}


def _errors(items: list[Placement]) -> dict[str, float | None]:
    errors = [item.error_mm for item in items if item.error_mm is not None]
    return {
        "position_median_mm": float(np.median(errors)) if errors else None,
        "position_p95_mm": float(np.percentile(errors, 95)) if errors else None,
    }


def _false_boxes(items: list[Placement], persistence: Mapping[int, float | None]) -> dict[str, Any]:
    mapped = [item for item in items if item.mapped]
    confident = [item for item in mapped if (item.confidence or 0.0) > 0.5]
    lasting = [item for item in confident if (persistence.get(item.defect_id or 0) or 0.0) > 0.5]
    lasting = [item for item in lasting if item.defect_id is not None]
    return {
        "count": len(items),
        "mapped_share": _share(len(mapped), len(items)),
        "mapped_confident_share": _share(len(confident), len(items)),
        "mapped_confident_persistent_share": _share(len(lasting), len(items)),
    }


def _share(part: int, whole: int) -> float | None:
    return part / whole if whole else None


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
        owner = owner_of(record, truth, alignments)
        if owner is None:
            extra += 1
        else:
            owners[owner] += 1
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


def owner_of(record: dict[str, Any], truth: Truth, alignments: Mapping[int, Similarity | None]) -> int | None:
    """The true defect that a record of `defects.json` belongs to; None for none."""
    point = aligned_point(list(record.get("centroid") or [None]), record.get("model"), alignments)
    if point is None:
        return None
    distances = ((patch_distance(point, defect.patch), key) for key, defect in truth.defects.items())
    near = [item for item in distances if item[0] <= WRONG_CHORD_SHARE * truth.chord]
    return min(near)[1] if near else None


def persistence_by_record(records: list[dict[str, Any]]) -> dict[int, float | None]:
    """`persistence` of every record by id, whether written as a share or as an object with `k` and `n`."""
    table: dict[int, float | None] = {}
    for record in records:
        value = record.get("persistence")
        if isinstance(value, dict):
            value = value["k"] / value["n"] if value.get("n") else None
        table[int(record["id"])] = None if value is None else float(value)
    return table


POWERS = {"length": 1, "width": 1, "area": 2, "depth": 1}
"""Measures, and the power of a length that each is."""


def score_sizes(
    records: list[dict[str, Any]], truth: Truth, alignments: Mapping[int, Similarity | None]
) -> dict[str, Any]:
    """Errors of the measures by what they are from (``mask``, ``box``), each over all defects that have one.

    Returns:
        By origin and measure what `size_figures` gives. Measures that nothing is known of are left out.
    """
    found = size_errors(records, truth, alignments)
    return {
        origin: {name: size_figures(errors) for name, errors in measures.items()} for origin, measures in found.items()
    }


SizeErrors = dict[str, dict[str, list[tuple[float, bool]]]]
"""By origin and measure, of every defect: |measured / true - 1|, and whether the true value lies within two standard
deviations of the measured one."""


def size_errors(records: list[dict[str, Any]], truth: Truth, alignments: Mapping[int, Similarity | None]) -> SizeErrors:
    """Relative errors of the measures, by what they are from.

    A size in units of the model is brought to mm by the alignment of the cameras, as if the scale were known exactly.
    """
    found: SizeErrors = {str(origin): {} for origin in SizeFrom}
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
            found[record["size_from"]].setdefault(name, []).append((abs(value / true - 1.0), inside))
    return {origin: {name: measures[name] for name in POWERS if name in measures} for origin, measures in found.items()}


def size_figures(rows: Sequence[Sequence[Any]]) -> dict[str, Any]:
    """Of pairs of `SizeErrors`: {count, median, p95, within_2_sigma}."""
    errors = np.array([error for error, _ in rows])
    return {
        "count": len(rows),
        "median": float(np.median(errors)),
        "p95": float(np.percentile(errors, 95)),
        "within_2_sigma": float(np.mean([inside for _, inside in rows])),
    }
