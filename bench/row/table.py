"""Scores of rows as a table, and what is asked of them over all cases."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from bench.accuracy.placement import size_figures
from bench.accuracy.row import COVERAGE_WITHIN
from bench.accuracy.table import ROW_SIZES, row_sizes
from bench.kept import Found, markdown_table
from bench.row.cases import Expected
from core.row.model import RowStatus
from core.scene.size import SizeFrom

HEAD = (
    "case",
    "of",
    "blades in view",
    "row",
    "pitch, % off",
    "axis, degrees / mm off",
    "blade right / wrong / unknown",
    "side right / wrong / unknown",
    "span within 0.05",
    "root or tip",
    "coverage by views, median off / within 0.05",
    "length, median / 95 % off, inside 2 sigma",
    "depth, the same",
    "s",
)


def markdown(found: Sequence[Found]) -> str:
    """The table as text."""
    return markdown_table(HEAD, [_cells(one) for one in found])


def _known(one: Found) -> bool:
    return bool(one["status"] != RowStatus.UNKNOWN)


def _cells(one: Found) -> list[str]:
    score = one["score"] or {}
    detections, coverage = score.get("detections"), score.get("coverage")
    pitch, axis = score.get("pitch_error"), score.get("axis_error_deg")
    off = score.get("axis_off_mm")
    return [
        f"`{one['name']}`",
        one["of"],
        str(score.get("blades_in_view", "-")),
        _verdict(one),
        "-" if pitch is None else f"{100 * pitch:.1f}",
        "-" if axis is None else f"{axis:.1f} / " + ("-" if off is None else f"{off:.1f}"),
        _counts(detections, "blade"),
        _counts(detections, "side"),
        "-" if not detections else f"{detections['span_within']} of {detections['span']}",
        "-" if not detections else f"{detections['end_right']} of {detections['end_told']}",
        _coverage(coverage),
        *(_sizes(score, name) for name in ROW_SIZES),
        f"{one['seconds']:.0f}",
    ]


def _verdict(one: Found) -> str:
    """What was said of the row, in bold where it should have been something else."""
    right = (one["score"] or {}).get("right")
    text = "found" if right else "**wrong**" if right is False else "found"
    if not _known(one):
        text = f"unknown ({one['reason']})"
        return text if one["expected"] == Expected.UNKNOWN else f"**{text}**"
    return text if one["expected"] == Expected.ROW else f"**{text.strip('*')}, should be unknown**"


def _counts(detections: Found | None, name: str) -> str:
    if not detections:
        return "-"
    return " / ".join(str(detections[f"{name}_{what}"]) for what in ("right", "wrong", "unknown"))


def _coverage(coverage: Found | None) -> str:
    if not coverage or coverage["views_error_median"] is None:
        return "-"
    return f"{coverage['views_error_median']:.3f} / {100 * coverage['views_within']:.0f} %"


def _sizes(score: Found, name: str) -> str:
    """By what the outlines are from."""
    told = [f"{origin} {size_text(figures)}" for origin, measure, figures in row_sizes(score) if measure == name]
    return "; ".join(told) or "-"


def size_text(figures: dict[str, Any]) -> str:
    """Median and 95 % of the errors, and how often the true value lies within two standard deviations, percent."""
    percent = (f"{100 * figures[key]:.0f}" for key in ("median", "p95", "within_2_sigma"))
    return " / ".join(percent) + f" % of {figures['count']}"


def totals(found: Sequence[Found]) -> list[str]:
    """One line for each figure that is asked for."""
    rows = [one for one in found if one["expected"] == Expected.ROW]
    others = [one for one in found if one["expected"] == Expected.UNKNOWN]
    known = [one["score"] for one in rows if _known(one) and one["score"] and one["score"].get("detections")]
    right = sum(bool((one["score"] or {}).get("right")) for one in rows)
    wrong = sum((one["score"] or {}).get("right") is False for one in rows)
    told = [score["detections"] for score in known]
    pitch = [score["pitch_error"] for score in known]
    axis = [score["axis_error_deg"] for score in known]
    views = [
        abs(blade[f"views_{least}"] - blade[f"true_views_{least}"])
        for score in known
        for blade in (score.get("coverage") or {"blades": ()})["blades"]
        if blade["blade"] is not None
        for least in (2, 3, 5)
    ]
    lines = [
        f"row found: {right} of {len(rows)} that show one, {wrong} wrong, {len(rows) - right - wrong} unknown",
        f"unknown where nothing can be known: {sum(not _known(one) for one in others)} of {len(others)}",
        f"pitch median / worst: {_ends(pitch, 100.0)} % off; axis median / worst: {_ends(axis, 1.0)} degrees off",
        f"blade right: {_share(told, 'blade_right', 'count')}",
        f"side right: {_share(told, 'side_right', 'count')}; unknown: {_share(told, 'side_unknown', 'count')}",
        f"span within 0.05: {_share(told, 'span_within', 'span')}",
        f"root or tip right: {_share(told, 'end_right', 'end_told')}",
    ]
    if views:
        within = 100.0 * float(np.mean(np.array(views) <= COVERAGE_WITHIN))
        lines.append(f"coverage by views: median {np.median(views):.3f} off, {within:.0f} % within {COVERAGE_WITHIN}")
    for origin in SizeFrom:
        for name in ROW_SIZES:
            rows_of = [(one["score"] or {}).get("sizes", {}).get(origin, {}).get(name, ()) for one in found]
            pooled = [pair for pairs in rows_of for pair in pairs]
            if pooled:
                lines.append(
                    f"{name} by {origin}: median / 95 % off, inside 2 sigma: {size_text(size_figures(pooled))}"
                )
    if found:
        seconds = [float(one["seconds"]) for one in found]
        lines.append(f"seconds: median {np.median(seconds):.0f}, most {max(seconds):.0f}")
    return lines


def _ends(values: Sequence[float], factor: float) -> str:
    return f"{factor * float(np.median(values)):.2f} / {factor * max(values):.2f}" if values else "- / -"


def _share(told: Iterable[dict[str, Any]], part: str, whole: str) -> str:
    rows = list(told)
    parts, wholes = (sum(one[name] for one in rows) for name in (part, whole))
    return f"{parts} of {wholes}" + (f" ({100 * parts / wholes:.1f} %)" if wholes else "")
