"""A score as a table for people."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from bench.accuracy.placement import size_figures


def format_score(score: dict[str, Any]) -> str:
    """Lines of name and value; a dash is what could not be measured."""
    rows = list(_model_rows(score, ""))
    rows += _placement_rows(score["placement"])
    defects = score["defects"]
    rows.append(("defects found / expected", f"{defects['found']} / {defects['expected']}"))
    rows.append(("defects split, extra, exact", f"{defects['split']}, {defects['extra']}, {_text(defects['exact'])}"))
    for origin, measures in score["sizes"].items():
        for name, one in measures.items():
            texts = " / ".join(_text(one[key]) for key in ("median", "p95", "within_2_sigma", "count"))
            rows.append((f"{name} by {origin}: error median / 95 %, within 2 sigma, count", texts))
    confidence = score["confidence"]
    rows.append(("confidence ECE, AUROC", f"{_text(confidence['ece'])}, {_text(confidence['auroc'])}"))
    for number, model in score["models"].items():
        rows += _model_rows(model, f"model {number}: ")
    return "\n\n".join([_lines(rows), *(_lines(list(_row_rows(n, one))) for n, one in score["rows"].items())])


def _lines(rows: Sequence[tuple[str, str]]) -> str:
    width = max(len(name) for name, _ in rows)
    return "\n".join(f"{name:<{width}}  {value}" for name, value in rows)


def _row_rows(number: str, row: dict[str, Any]) -> Iterator[tuple[str, str]]:
    """The table of its own that the row of a model has."""
    known = row["reason"] is None
    yield f"row of blades, model {number}", row["status"] if known else f"{row['status']} ({row['reason']})"
    yield "blades in view, a row was to be found", f"{row['blades_in_view']}, {_text(row['row_expected'])}"
    for origin, name, figures in row_sizes(row):
        texts = " / ".join(_text(figures[key]) for key in ("median", "p95", "within_2_sigma", "count"))
        yield f"{name} by {origin}: error median / 95 %, within 2 sigma, count", texts
    if not known:
        return
    yield "right (pitch within 2 %, axis within 2 degrees)", _text(row["right"])
    yield "pitch (degrees), error (%)", f"{_text(row['pitch_deg'])}, {_text(100.0 * row['pitch_error'])}"
    axis = (_text(row.get(name)) for name in ("axis_error_deg", "axis_off_mm"))
    yield "axis: error (degrees), off (mm)", " / ".join(axis)
    if "on_first" in row:
        yield "on the row of the first model; its blades' numbers right", _on_first(row["on_first"])
    yield "surface with its right blade", _text(row.get("surface_blade_right"))
    one = row.get("detections")
    if one is None:
        return
    for name in ("blade", "side"):
        counts = " / ".join(str(one[f"{name}_{what}"]) for what in ("right", "wrong", "unknown"))
        yield f"{name} right / wrong / unknown, of mapped detections", f"{counts} of {one['count']}"
    yield "span within 0.05; median error", f"{one['span_within']} of {one['span']}; {_text(one['span_median'])}"
    edges = " / ".join(_text(one[name]) for name in ("edge_median_mm", "edge_p95_mm", "edge_within_2_sigma"))
    yield "distance to an edge: told; error median / 95 % (mm), within 2 sigma", f"{one['edge_told']}; {edges}"
    yield "root or tip right", f"{one['end_right']} of {one['end_told']}"
    seen = row.get("coverage")
    if seen is None:
        return
    yield "coverage: blades seen of those in view", " of ".join(str(count) for count in seen["seen_of_in_view"])
    within = f"{_text(seen['views_within'])}; {_text(seen['views_error_median'])}"
    yield "coverage by views: share within 0.05; median error", within
    yield "coverage: median error of the share reconstructed", _text(seen["share_error_median"])
    for blade in seen["blades"]:
        told = " ".join(_text(blade.get(name)) for name in ("share", "views_2", "views_3", "views_5"))
        true = " ".join(_text(blade[f"true_{name}"]) for name in ("share", "views_2", "views_3", "views_5"))
        yield f"  blade {_text(blade['blade'])}: share, by 2, 3, 5 views (true)", f"{told} ({true})"


ROW_SIZES = ("length", "depth")
"""Measures that are asked of a row."""


def row_sizes(row: dict[str, Any]) -> Iterator[tuple[str, str, dict[str, Any]]]:
    """Origin, measure and `size_figures` of what is known of the sizes of a model's defects."""
    for origin, measures in row.get("sizes", {}).items():
        for name in ROW_SIZES:
            if measures.get(name):
                yield origin, name, size_figures(measures[name])


def _on_first(told: dict[str, Any]) -> str:
    which = "yes" if told["same_row"] else f"no ({told['reason']})"
    how = told["reason"] if told["offset_from"] is None else f"by {told['offset_from']}"
    return f"{which}; {_text(told['right'])}" + (f" ({how})" if told["same_row"] else "")


def _model_rows(model: dict[str, Any], prefix: str) -> Iterator[tuple[str, str]]:
    frames = model["frames"]
    yield f"{prefix}frames registered", f"{frames['registered']} of {frames['source_frames']}"
    yield f"{prefix}registered_share", _text(frames["registered_share"])
    yield f"{prefix}registered_annotated_share", _text(frames["registered_annotated_share"])
    cameras = model["cameras"] or {}
    for what, unit in (("position", "mm"), ("rotation", "deg")):
        values = (_text(cameras.get(f"{what}_{rank}_{unit}")) for rank in ("median", "p95"))
        yield f"{prefix}camera {what} median / 95 % ({unit})", " / ".join(values)
    for name in ("mesh", "cloud"):
        surface = model[name] or {}
        yield (
            f"{prefix}{name} accuracy median / 95 % (mm)",
            " / ".join(_text(surface.get(key)) for key in ("accuracy_median_mm", "accuracy_p95_mm")),
        )
        yield f"{prefix}{name} completeness median (mm)", _text(surface.get("completeness_median_mm"))
        for tau in ("0.25%", "0.5%", "1%"):
            scores = surface.get(tau) or {}
            values = (_text(scores.get(key)) for key in ("precision", "recall", "f1"))
            yield f"{prefix}{name} precision / recall / F1 at {tau} of chord", " / ".join(values)


def _placement_rows(placement: dict[str, Any]) -> list[tuple[str, str]]:
    false = placement["false_boxes"]
    rows = [
        ("detections", f"{placement['detections']} ({placement['placeable']} placeable, {false['count']} false boxes)"),
        ("outcomes", ", ".join(f"{key} {count}" for key, count in placement["outcomes"].items()) or "-"),
        ("mapped_share", _text(placement["mapped_share"])),
        ("wrong_mapped_share", _text(placement["wrong_mapped_share"])),
        (
            "mapped position median / 95 % (mm)",
            f"{_text(placement['position_median_mm'])} / {_text(placement['position_p95_mm'])}",
        ),
    ]
    for method, scores in placement["by_rung"].items():
        rows.append(
            (
                f"  rung {method or '-'}: placed, wrong, median / 95 % (mm)",
                f"{scores['placed']}, {scores['wrong']}, "
                f"{_text(scores['position_median_mm'])} / {_text(scores['position_p95_mm'])}",
            )
        )
    shares = ("mapped_share", "mapped_confident_share", "mapped_confident_persistent_share")
    rows.append(("false boxes mapped / confident / persistent", " / ".join(_text(false[key]) for key in shares)))
    return rows


def _text(value: Any) -> str:
    if value is None:
        return "-"
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:.4g}" if isinstance(value, float) else str(value)
