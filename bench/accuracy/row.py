"""The row of blades of a result against the truth: found or unknown, blade, side and span of detections, coverage."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bench.accuracy.placement import Placement, size_errors
from bench.accuracy.result import Result, ResultModel
from bench.accuracy.true_coverage import LEAST_VIEWS, TrueCoverage, true_coverage
from bench.accuracy.true_row import TrueFinding, TrueRow
from bench.accuracy.truth import Truth
from core.geometry.similarity import Similarity
from core.mapping.surface import Surface
from core.row.model import RowStatus
from core.scene.on_row import Side, blade_number

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]
Found = dict[str, Any]

PITCH_WITHIN = 0.02
AXIS_WITHIN_DEG = 2.0
SPAN_WITHIN = 0.05
COVERAGE_WITHIN = 0.05
LEAST_BLADES = 3
"""With fewer in view nobody can tell that they are a row."""
VOTES = 4000
"""Vertices of the surface that say which number is which true blade."""
NEAR_MM = 1.0
"""Only those at most so far from the true surface say it."""
_EDGES = (Side.EDGE, Side.LEADING_EDGE)


@dataclass(frozen=True)
class Numbering:
    """``number = way * blade + offset`` of the numbers that a model gives to the true blades."""

    way: int
    offset: int
    count: int | None = None
    """Where numbers go round: of the blades that the whole row has."""

    def number(self, blade: int) -> int:
        """Of a true blade."""
        value = self.way * blade + self.offset
        return value if self.count is None else (value - 1) % self.count + 1

    def blade(self, number: int) -> int:
        """The true blade that a number stands for; where numbers go round, one of those."""
        return self.way * (number - self.offset)


def score_rows(
    result: Result, truth: Truth, alignments: Mapping[int, Similarity | None], placements: Sequence[Placement]
) -> dict[str, Found]:
    """The score of every model that has a `row.json`, by number; empty where the truth tells of no row.

    Returns:
        By model {status, reason, blades_in_view, row_expected, right, sizes, pitch_deg, pitch_error, axis_error_deg,
        axis_off_mm, surface_blade_right, detections, coverage, on_first}: what cannot be measured is None. `right` is
        None where the row is unknown. `pitch_error` is a share of the true pitch; `axis_off_mm` how far from the true
        axis the one found passes at the height of the blades. `sizes` is that of the model's defects (`SizeErrors`).
        `on_first` only of further models: {same_row, reason, offset_from, right}, whether its blades have the numbers
        that they have on the row of the first; None where they have none.
    """
    if truth.row is None:
        return {}
    found: dict[str, Found] = {}
    numberings: dict[int, Numbering] = {}
    for number, model in sorted(result.models.items()):
        if model.row is None:
            continue
        score, numbering = _score(model, model.row, truth, truth.row, alignments[number], result, placements)
        own = [record for record in result.defects if int(record.get("model") or 0) == number]
        found[str(number)] = {**score, "sizes": size_errors(own, truth, alignments)}
        if numbering is not None:
            numberings[number] = numbering
        if "on_first" in model.row:
            found[str(number)]["on_first"] = _on_first(model.row["on_first"], numberings.get(0), numbering)
    return found


def _on_first(told: Found, first: Numbering | None, own: Numbering | None) -> Found:
    """Whether the blades of a further model have the numbers that they have on the row of the first."""
    right = None
    if told["names"] and first is not None and own is not None:
        right = all(int(name) == first.number(own.blade(int(number))) for number, name in told["names"].items())
    return {**{name: told[name] for name in ("same_row", "reason", "offset_from")}, "right": right}


def _score(
    model: ResultModel,
    document: Found,
    truth: Truth,
    row: TrueRow,
    sim3: Similarity | None,
    result: Result,
    placements: Sequence[Placement],
) -> tuple[Found, Numbering | None]:
    shown = true_coverage(truth, row, sorted(model.source_indices))
    score: Found = {
        "status": document["status"],
        "reason": document.get("reason"),
        "blades_in_view": len(shown),
        "row_expected": len(shown) >= LEAST_BLADES,
        "right": None,
    }
    if document["status"] == RowStatus.UNKNOWN:
        return score, None
    score |= {"pitch_deg": document["pitch_deg"], "pitch_error": _pitch_error(document, row)}
    if sim3 is None:
        return score, None
    direction = sim3.rotation @ np.asarray(document["axis"], np.float64)
    score["axis_error_deg"] = float(np.degrees(np.arccos(min(1.0, abs(float(direction[2]))))))
    score["axis_off_mm"] = _axis_off(sim3.apply(np.array([document["point"]], np.float64))[0], direction)
    score["right"] = score["pitch_error"] <= PITCH_WITHIN and score["axis_error_deg"] <= AXIS_WITHIN_DEG
    own = [
        (line, place)
        for line, place in zip(result.detections, placements, strict=True)
        if int(line.get("model") or 0) == model.number and place.mapped and place.true_defect is not None
    ]
    numbers, blades = _votes(model, document, sim3, row, truth, own)
    numbering = _numbering(document, direction, numbers, blades)
    if numbering is None:  # no place has a blade, so which number is which does not matter
        return {**score, "detections": _detections(own, document, Numbering(1, 0), row, truth, sim3.scale)}, None
    agrees = [number == numbering.number(blade) for number, blade in zip(numbers, blades, strict=True)]
    score["surface_blade_right"] = float(np.mean(agrees)) if model.blade_of_vertex is not None else None
    score["detections"] = _detections(own, document, numbering, row, truth, sim3.scale)
    score["coverage"] = _coverage(document, numbering, shown)
    return score, numbering


def _pitch_error(document: Found, row: TrueRow) -> float:
    return abs(float(np.radians(document["pitch_deg"])) / row.pitch_rad - 1.0)


def _axis_off(point: F64, direction: F64) -> float | None:
    """Distance from the z axis at height 0, which the blades of every scene reach across; None beside a flat axis."""
    if abs(direction[2]) < 0.1:
        return None
    at = point - point[2] / direction[2] * direction
    return float(np.hypot(at[0], at[1]))


def _votes(
    model: ResultModel,
    document: Found,
    sim3: Similarity,
    row: TrueRow,
    truth: Truth,
    own: Sequence[tuple[Found, Placement]],
) -> tuple[list[int], list[int]]:
    """Numbers and the true blades they stand for: of the surface's vertices, or where it has none of detections."""
    if model.blade_of_vertex is None or not len(truth.faces):
        told = [(_number(line, document), row.findings[place.true_defect or 0].blade) for line, place in own]
        pairs = [(number, blade) for number, blade in told if number is not None]
        return [number for number, _ in pairs], [blade for _, blade in pairs]
    vertices, number = model.blade_of_vertex
    rows = np.flatnonzero(number > 0)
    rows = rows[:: max(1, len(rows) // VOTES)]
    points = sim3.apply(vertices[rows])
    nearest, _ = Surface(truth.vertices, truth.faces).nearest(points)
    near = np.linalg.norm(nearest - points, axis=1) <= NEAR_MM
    return number[rows][near].tolist(), row.blade(points[near]).tolist()


def _numbering(document: Found, direction: F64, numbers: Sequence[int], blades: Sequence[int]) -> Numbering | None:
    """The offset that most agree on. Which way numbers run is not chosen to fit, but read off the angles."""
    if not numbers:
        return None
    ordered = sorted(document["blades"], key=lambda one: one["angle_deg"])
    rising = ordered[-1]["seen"] > ordered[0]["seen"]
    if document.get("direction") == "reversed":
        rising = not rising
    way = (1 if rising else -1) * (1 if direction[2] > 0 else -1)
    count = document["count"][0] if document.get("zero_blade") is not None else None
    offsets = [number - way * blade for number, blade in zip(numbers, blades, strict=True)]
    votes = Counter(offset if count is None else offset % count for offset in offsets)
    return Numbering(way, votes.most_common(1)[0][0], count)


def _number(line: Found, document: Found) -> int | None:
    """The model's own number of the blade that the column `blade` names."""
    name = line.get("blade")
    return None if name in (None, "") else blade_number(str(name), document.get("on_first"))


def _detections(
    own: Sequence[tuple[Found, Placement]],
    document: Found,
    numbering: Numbering,
    row: TrueRow,
    truth: Truth,
    mm_per_unit: float,
) -> Found:
    """Counts over the mapped placeable detections: of those with a span, or an edge, and all for blade and side."""
    blades: Counter[str] = Counter()
    sides: Counter[str] = Counter()
    errors, ends, beside, within = [], [], [], []
    for line, place in own:
        number = place.true_defect or 0
        finding = row.findings[number]
        told = _number(line, document)
        blades["unknown" if told is None else "right" if told == numbering.number(finding.blade) else "wrong"] += 1
        sides[_side(line.get("side"), finding)] += 1
        true = float(row.span(truth.defects[number].center[None])[0])
        if line.get("edge_distance") is not None:
            unit_mm = 1.0 if line.get("length_unit") == "mm" else mm_per_unit
            told_mm = float(line["edge_distance"]) * unit_mm
            # Which of its edges is the nearer one that was seen the result need not know.
            beside.append(min(abs(told_mm - true_mm) for true_mm in row.edge_distances(finding, true)))
            within.append(beside[-1] <= 2.0 * float(line["edge_distance_sigma"]) * unit_mm)
        if line.get("span") is not None:
            errors.append(abs(float(line["span"]) - true))
            if abs(true - 0.5) > SPAN_WITHIN:
                ends.append((float(line["span"]) > 0.5) == (true > 0.5))
    return {
        "count": len(own),
        **{f"blade_{name}": blades[name] for name in ("right", "wrong", "unknown")},
        **{f"side_{name}": sides[name] for name in ("right", "wrong", "unknown")},
        "span": len(errors),
        "span_within": sum(error <= SPAN_WITHIN for error in errors),
        "span_median": float(np.median(errors)) if errors else None,
        "edge_told": len(beside),
        "edge_median_mm": float(np.median(beside)) if beside else None,
        "edge_p95_mm": float(np.percentile(beside, 95)) if beside else None,
        "edge_within_2_sigma": float(np.mean(within)) if within else None,
        "end_told": len(ends),
        "end_right": sum(ends),
    }


def _side(told: str | None, finding: TrueFinding) -> str:
    if told in (None, Side.UNKNOWN):
        return "unknown"
    if finding.chord == 0.0:
        return "right" if told in _EDGES else "wrong"
    return "right" if told == (Side.CONVEX if finding.side > 0 else Side.CONCAVE) else "wrong"


def _coverage(document: Found, numbering: Numbering, shown: Mapping[int, TrueCoverage]) -> Found:
    """Every blade's coverage beside the true one, and the shares of the figures that are within the target."""
    told = {one["blade"]: one for one in document["coverage"]}
    blades, views, shares = [], [], []
    for blade, true in shown.items():
        one = told.get(numbering.number(blade))
        line: Found = {"true_blade": blade, "blade": None, "true_share": true.share, "share": None}
        line |= {f"true_views_{least}": true.by_views[least] for least in LEAST_VIEWS}
        if one is not None:
            line |= {"blade": one["blade"], "share": one["share"]}
            line |= {f"views_{least}": one[f"views_{least}"] for least in LEAST_VIEWS}
            views += [abs(one[f"views_{least}"] - true.by_views[least]) for least in LEAST_VIEWS]
            shares.append(abs(one["share"] - true.share))
        blades.append(line)
    return {
        "blades": blades,
        "seen_of_in_view": [len(shares), len(shown)],
        "views_error_median": float(np.median(views)) if views else None,
        "views_within": float(np.mean(np.array(views) <= COVERAGE_WITHIN)) if views else None,
        "share_error_median": float(np.median(shares)) if shares else None,
    }
