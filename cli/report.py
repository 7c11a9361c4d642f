"""What a finished run made, in a screenful: headline numbers, the funnel, verdict and flags, paths."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from cli.progress import duration
from worker.outcome import Outcome

SHOWN_FILES = (
    ("gallery/index.html", "detections on the frames, the mesh from two sides: open this first"),
    ("mapping/mesh_defects.glb", "defect-coloured surface, for any 3D viewer"),
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
_NO_HEADLINE = {
    "schema_version", "state", "failed_stage", "reason", "parameters", "fingerprint", "versions", "scale", "stages",
}  # fmt: skip


def text(outcome: Outcome) -> str:
    """The closing report of a run."""
    summary, quality = _read(outcome.out / "summary.json"), _read(outcome.out / "quality.json")
    lines = [
        "",
        f"{outcome.state} in {duration(outcome.seconds)}"
        f" ({outcome.computed} tasks computed, {outcome.reused} already there)",
    ]
    lines += _headline(summary)
    lines += _funnel(quality)
    lines += _verdict(quality)
    lines += _files(outcome.out)
    return "\n".join(lines)


def _headline(summary: dict[str, Any]) -> list[str]:
    numbers = dict(flatten({key: value for key, value in summary.items() if key not in _NO_HEADLINE}))
    width = max((len(name) for name in numbers), default=0)
    return ["", *(f"  {name:<{width}}  {_number(value)}" for name, value in numbers.items())] if numbers else []


def _funnel(quality: dict[str, Any]) -> list[str]:
    funnel = quality.get("funnel")
    if not isinstance(funnel, dict):
        return []
    steps = [(name.replace("_", " "), value) for name, value in funnel.items() if isinstance(value, int)]
    return ["", "  " + " -> ".join(f"{name} {value}" for name, value in steps)]


def _verdict(quality: dict[str, Any]) -> list[str]:
    if not quality:
        return []
    lines = ["", f"  verdict: {quality.get('verdict')}"]
    for flag in quality.get("flags", []):
        value, threshold = _number(flag.get("value")), _number(flag.get("threshold"))
        where = f" at {flag['where']}" if flag.get("where") else ""
        lines.append(f"  flag {flag.get('code')} ({flag.get('severity')}): {value}, threshold {threshold}{where}")
    return lines


def _files(out: Path) -> list[str]:
    shown = [(out / name, meaning) for name, meaning in SHOWN_FILES if (out / name).exists()]
    width = max((len(str(path)) for path, _ in shown), default=0)
    return ["", *(f"  {path!s:<{width}}  {meaning}" for path, meaning in shown)]


def flatten(tree: dict[str, Any], prefix: str = "") -> list[tuple[str, Any]]:
    """Scalars of nested objects with dotted names; lists and empty values are left out."""
    found: list[tuple[str, Any]] = []
    for name, value in tree.items():
        if isinstance(value, dict):
            found += flatten(value, f"{prefix}{name}.")
        elif isinstance(value, bool | int | float | str) and value != "":
            found.append((prefix + name, value))
    return found


def _number(value: Any) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def _read(path: Path) -> dict[str, Any]:
    """A JSON object of the result, or nothing when the run ended before it was written."""
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return data if isinstance(data, dict) else {}
