"""What a finished run made, in a screenful: headline numbers, the funnel, verdict and flags, paths."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from cli.row import row_lines
from cli.terminal import duration
from core.outputs import ROW, VIEWER_PAGE
from worker.events import Outcome

SHOWN_FILES = (
    (VIEWER_PAGE, "findings, surface, frames and timeline in one page: open this first"),
    ("gallery/index.html", "detections on the frames, the mesh from two sides"),
    ("mapping/mesh_defects.glb", "defect-coloured surface, for any 3D viewer"),
    ("row_map.svg", "blades seen, their coverage, and the findings on them"),
    ("mapping/defects.json", "one record per physical defect"),
    ("mapping/detections.csv", "one row per input detection"),
    ("mapping/timeline.csv", "one row per event"),
    ("dense/mesh_poisson.ply", "surface mesh"),
    ("dense/fused.ply", "point cloud"),
    ("sparse", "camera poses and sparse points (COLMAP)"),
    ("cases.csv", "every reconstruction case"),
    ("quality.json", "how far the result can be trusted"),
    ("summary.json", "parameters, stages, headline numbers"),
)


def lines(outcome: Outcome) -> list[str]:
    """The closing report of a run."""
    summary, quality = _read(outcome.out / "summary.json"), _read(outcome.out / "quality.json")
    found = [
        "",
        f"{outcome.state} in {duration(outcome.seconds)}"
        f" ({outcome.computed} tasks computed, {outcome.reused} already there)",
    ]
    row = _read(outcome.out / ROW)
    last = ["", *row_lines(row)[-1:]] if row else []
    return [*found, *_headline(summary), *_funnel(quality), *_verdict(quality), *_files(outcome.out), *last]


def _headline(summary: dict[str, Any]) -> list[str]:
    numbers = {name: value for name, value in summary.get("headline", {}).items() if value is not None}
    width = max((len(name) for name in numbers), default=0)
    return ["", *(f"  {name.replace('_', ' '):<{width}}  {_number(value)}" for name, value in numbers.items())]


def _funnel(quality: dict[str, Any]) -> list[str]:
    steps = {name: value for name, value in quality.get("funnel", {}).items() if value is not None}
    # Approximate places are no step on the way to a defect: they stand beside the mapped ones.
    beside = f" (and {steps.pop('approximate')} approximate)" if steps.get("approximate") else ""
    steps.pop("approximate", None)
    least = steps.pop("defects_at_least", None)
    if least not in (None, steps.get("defects")):
        steps["defects"] = f"{least} to {steps['defects']}"
    denied = steps.pop("unconfirmed", 0)
    extra = {"mapped": beside, "defects": f" (and {denied} detections that other frames deny)" if denied else ""}
    texts = [f"{name.replace('_', ' ')} {value}{extra.get(name, '')}" for name, value in steps.items()]
    return ["", "  " + " -> ".join(texts)] if texts else []


def _verdict(quality: dict[str, Any]) -> list[str]:
    if not quality:
        return []
    lines = ["", f"  verdict: {quality.get('verdict')}"]
    for flag in quality.get("flags", []):
        measured = (
            "" if flag["value"] is None else f": {_number(flag['value'])}, threshold {_number(flag['threshold'])}"
        )
        where = f" ({flag['where']})" if flag["where"] else ""
        lines.append(f"  {flag['severity']} {flag['code']}{measured}{where}: {flag['meaning']}")
    return lines


def _files(out: Path) -> list[str]:
    shown = [(out / name, meaning) for name, meaning in SHOWN_FILES if (out / name).exists()]
    width = max((len(str(path)) for path, _ in shown), default=0)
    page = out / VIEWER_PAGE
    last = ["", f"open {page} in a browser, or: bladeatlas view {out}"] if page.exists() else []
    return ["", *(f"  {path!s:<{width}}  {meaning}" for path, meaning in shown), *last]


def _number(value: Any) -> str:
    return f"{value:.4g}" if isinstance(value, float) else f"{value:,}" if isinstance(value, int) else str(value)


def _read(path: Path) -> dict[str, Any]:
    """A JSON object of the result, or nothing when the run ended before it was written."""
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return data if isinstance(data, dict) else {}
