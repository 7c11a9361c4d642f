"""Table rows of a result, read from the very files that it seals."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

from core.stage import Facts
from core.task_key import piece_of, stage_of

_CASE_STAGES = ("coarse", "refine")
_TABLE_FILES: dict[str, dict[str, str]] = {
    "map_defects": {"detections": "detections.json"},
    "timeline": {"detections": "detections.json", "events": "timeline.json", "defects": "defects.json"},
}


def rows_of(key: str, facts: Facts, folder: Path) -> dict[str, Any]:
    """Rows by table: metrics of every task, cases of the search, tables of the mapping stages.

    Tables of further models are joined with the first one's when the run is published.
    """
    stage = stage_of(key)
    rows: dict[str, Any] = {"metrics": _metrics(facts)}
    if stage in _CASE_STAGES and "name" in facts:
        rows["cases"] = [facts]
    files = {} if piece_of(key) else _TABLE_FILES.get(stage, {})
    for table, name in files.items():
        path = folder / name
        if path.is_file():
            rows[table] = json.loads(path.read_text(encoding="utf-8"))
    if "defects" in rows:
        rows["defects"] = defect_rows(rows["defects"])
    return rows


def defect_rows(records: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Rows of the table of defects: the whole record, and what is asked for most as columns."""
    rows = []
    for record in records:
        x, y, z = record.get("centroid") or (None, None, None)
        rows.append({"id": record["id"], "label": record["label"], "x": x, "y": y, "z": z, "record": record})
    return rows


def _metrics(facts: Facts) -> list[dict[str, Any]]:
    numbers = {
        name: value for name, value in facts.items() if isinstance(value, int | float) and not isinstance(value, bool)
    }
    return [{"name": name, "value": float(value)} for name, value in numbers.items() if math.isfinite(value)]
