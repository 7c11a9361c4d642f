"""``timeline.json``, ``defects.json`` and ``confidence.json``: what the stage `timeline` says beside its rows."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from core.json_files import read_json, write_json
from core.scene.defect import DefectRecord, EventRow

_EVENTS = "timeline.json"
_DEFECTS = "defects.json"
_CONFIDENCE = "confidence.json"


def write_timeline(
    folder: Path,
    events: Iterable[EventRow],
    defects: Iterable[DefectRecord],
    confidences: Sequence[Mapping[str, Any]],
) -> None:
    """Write the events, the defects, and what the confidence of each placed detection is made of."""
    write_json(folder / _EVENTS, [event.to_dict() for event in events])
    write_json(folder / _DEFECTS, [record.to_dict() for record in defects])
    write_json(folder / _CONFIDENCE, list(confidences))


def read_events(folder: Path) -> list[EventRow]:
    """Events by start, of one model."""
    return [EventRow.from_dict(row) for row in read_json(folder / _EVENTS)]


def read_defects(folder: Path) -> list[DefectRecord]:
    """Defects by id, of one model or below ``mapping/`` of a published result."""
    return [DefectRecord.from_dict(row) for row in read_json(folder / _DEFECTS)]
